"""What every model returns, and its round trip to disk."""

from .mechanism import fastest_corner_by_one
from .outcome import Outcome, Status
from .store import StoreError, load_outcome, save_outcome, write_atomically

__all__ = [
    "Outcome",
    "Status",
    "StoreError",
    "fastest_corner_by_one",
    "load_outcome",
    "save_outcome",
    "write_atomically",
]
