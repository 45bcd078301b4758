"""What every model returns, and its round trip to disk."""

from .outcome import Outcome, Status
from .store import StoreError, load_outcome, save_outcome, write_atomically

__all__ = ["Outcome", "Status", "StoreError", "load_outcome", "save_outcome", "write_atomically"]
