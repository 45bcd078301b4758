"""State of a system: its motion, and its history."""

from dataclasses import dataclass, field, replace

import numpy as np

from runningbond.contacts.search import Contacts
from runningbond.joints.law import COMMON_ROWS, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE
from runningbond.scene import Array, Mask

from .system import BlockSystem, Interface

PLASTIC_SLIP = "plastic slip"
"""Name of the row of a law's history with the slip [m] at which a point is free of shear."""


@dataclass(eq=False)
class State:
    """State of a system, integrated in place."""

    # (nd,) modal displacement, and velocity half a step behind
    motion: Array
    velocity: Array
    history: Array  # (rows, np) history variables of the joint points, as their law defines them
    damped: Array  # (nd,) work of damping [J], mode by mode
    unbalanced: Array  # (nd,) unbalanced force of the last step
    # the contacts to which the columns of the history belong; None at small displacements, where contacts do not change
    contacts: Contacts | None = None
    bears: Mask = field(default_factory=lambda: np.zeros(0, dtype=bool))  # (nc,) the contacts' frames (`joints.frames`)
    external: float = 0.0  # work of the loads [J]
    # part of it: by how much the work of dead loads exceeds that of the same loads constant as at rest [J] (`rig`,
    # `turning_loads`)
    turned: float = 0.0
    multiplier: float = 0.0  # of the live load, if it drives: its mean over the last steps
    steps: int = 0  # steps taken
    time: float = 0.0  # time since the start [s]
    # (1,) largest energy supplied at any energy check [J]
    supplied: Array = field(default_factory=lambda: np.zeros(1))
    stretch: Array = field(default_factory=lambda: np.zeros(0))  # (nt,) plastic elongation of the ties [m]
    # on earlier contacts: work of friction, cracking and crushing [J]; work of their viscosity and of the damping of
    # modes held since, and work that the dead load and preloads of ties did not do because they came slowly [J]
    friction: float = 0.0
    absorbed: float = 0.0

    @classmethod
    def at_rest(cls, system: BlockSystem, motion: Array | None = None) -> "State":
        """A system without velocity and free of shear: undeformed, or after a motion ``(nd,)``."""
        search, interface, contacts = system.contacts, system.interface, None
        if search is not None:
            contacts = search.undeformed
            if motion is not None:
                contacts = search.find(motion, search.outline.margin)
                interface = search.interface_on(contacts, system)
        nd = len(system.mass)
        motion = np.zeros(nd) if motion is None else motion.copy()
        history = history_free_of_shear(interface, motion)
        stretch = np.zeros(len(system.ties))
        bears = frames_of(interface, contacts)
        return cls(motion, np.zeros(nd), history, np.zeros(nd), np.zeros(nd), contacts, bears, stretch=stretch)

    def copy(self) -> "State":
        """An independent copy of the state."""
        arrays = ("motion", "velocity", "history", "damped", "unbalanced", "bears", "supplied", "stretch")
        return replace(self, **{name: getattr(self, name).copy() for name in arrays})

    def has_lost_nothing_since(self, before: "State") -> bool:
        """Whether no joint point and no tie has yielded since: the system would return, as elastic bodies do."""
        kept = [FRICTION_WORK, *range(len(COMMON_ROWS), len(self.history))]
        same = np.array_equal(self.history[kept], before.history[kept])
        return same and np.array_equal(self.stretch, before.stretch)


def frames_of(interface: Interface, contacts: Contacts | None) -> Mask:
    """Frames ``(nc,)`` in which the jumps of an interface on contacts were last expressed."""
    bears = np.zeros(0 if contacts is None else len(contacts), dtype=bool)
    history = np.zeros((interface.law.rows, interface.law.points))
    interface.reframe(tuple(interface.geometry), (bears, -1), history)
    return bears


def history_free_of_shear(interface: Interface, motion: Array) -> Array:
    """History ``(rows, np)`` of points that are free of shear after a motion ``(nd,)``."""
    history = np.zeros((interface.law.rows, interface.law.points))
    history[OPENING_BEFORE], history[SLIP_BEFORE] = interface.jumps(motion)
    law = interface.law.law
    if PLASTIC_SLIP in law.history:
        history[law.row(PLASTIC_SLIP)] = history[SLIP_BEFORE]
    return history
