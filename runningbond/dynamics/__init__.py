"""Blocks in motion: the system, its integration, its load controls and its verdict."""

from .controls import Drive, drive, ramp, settled_drive
from .finite_run import FiniteRun, FiniteState, finite_curve
from .loading import LoadSteps, load_steps
from .run import Criteria, Ledger, Observer, Run, Unstable, Verdict, moved_by, nobody, settle
from .system import BlockSystem, Restraint, State, force_unit
from .time_step import block_frequency_squared, joint_shares, mass_factor, stable_step
from .verdict import collapse_by_steps

__all__ = [
    "BlockSystem",
    "Criteria",
    "Drive",
    "FiniteRun",
    "FiniteState",
    "Ledger",
    "LoadSteps",
    "Observer",
    "Restraint",
    "Run",
    "State",
    "Unstable",
    "Verdict",
    "block_frequency_squared",
    "collapse_by_steps",
    "drive",
    "finite_curve",
    "force_unit",
    "joint_shares",
    "load_steps",
    "mass_factor",
    "moved_by",
    "nobody",
    "ramp",
    "settle",
    "settled_drive",
    "stable_step",
]
