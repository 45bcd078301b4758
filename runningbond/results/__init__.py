"""What every model returns, and its round trip to disk.

Files for ParaView and pictures are made by modules of their own, imported by name: none of them can change a number.
"""

from .mechanism import MechanismCheck, check_mechanism, fastest_corner_by_one
from .outcome import Outcome, Status
from .reactions import Supports, collapse_state
from .store import StoreError, load_outcome, load_scene, make_folder, save_outcome, write_atomically

__all__ = [
    "MechanismCheck",
    "Outcome",
    "Status",
    "StoreError",
    "Supports",
    "check_mechanism",
    "collapse_state",
    "fastest_corner_by_one",
    "load_outcome",
    "load_scene",
    "make_folder",
    "save_outcome",
    "write_atomically",
]
