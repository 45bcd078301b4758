"""The outcome that every model returns, and how it is stored on disk and read back.

ParaView files and pictures are written by separate modules that are imported by name and cannot change any number.
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
