"""Blocks in motion: the system, its integration, its load controls and its verdict."""

from .controls import Drive, LoadSteps, drive, load_steps, ramp, settled_drive
from .run import Criteria, Ledger, Run, Verdict, moved_by, settle
from .system import BlockSystem, Restraint, State
from .time_step import block_frequency_squared, mass_factor, stable_step

__all__ = [
    "BlockSystem",
    "Criteria",
    "Drive",
    "Ledger",
    "LoadSteps",
    "Restraint",
    "Run",
    "State",
    "Verdict",
    "block_frequency_squared",
    "drive",
    "load_steps",
    "mass_factor",
    "moved_by",
    "ramp",
    "settle",
    "settled_drive",
    "stable_step",
]
