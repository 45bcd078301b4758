"""Bodies in motion: their system and its integration, load controls, rest and collapse."""

from .collapse import U_CRIT, Criteria, settle
from .collapse_load import collapse_by_steps
from .dead_load import fall_under_dead_load, put_on_dead_load
from .growth import ramp
from .highest_frequency import with_highest_frequency
from .inertia import CALMER, beam_note, inertia_factors, inertia_note, largest_scaling
from .load_stepping import LoadSteps, load_steps
from .run import Observer, Run, Unstable, no_observer
from .state import State
from .system import (
    NOTHING_CARRIED,
    BlockSystem,
    Carried,
    ContactSearch,
    Interface,
    Restraint,
    force_unit,
    moving_far,
    restrain,
)
from .ties import tie_rows
from .time_step import (
    block_frequency_squared,
    joint_shares,
    mass_factor,
    rigid_frequency_squared,
    stable_step,
)

__all__ = [
    "CALMER",
    "NOTHING_CARRIED",
    "U_CRIT",
    "BlockSystem",
    "Carried",
    "ContactSearch",
    "Criteria",
    "Interface",
    "LoadSteps",
    "Observer",
    "Restraint",
    "Run",
    "State",
    "Unstable",
    "beam_note",
    "block_frequency_squared",
    "collapse_by_steps",
    "fall_under_dead_load",
    "force_unit",
    "inertia_factors",
    "inertia_note",
    "joint_shares",
    "largest_scaling",
    "load_steps",
    "mass_factor",
    "moving_far",
    "no_observer",
    "put_on_dead_load",
    "ramp",
    "restrain",
    "rigid_frequency_squared",
    "settle",
    "stable_step",
    "tie_rows",
    "with_highest_frequency",
]
