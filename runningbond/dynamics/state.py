"""Where a system is, and what it has been through."""

from dataclasses import dataclass, field, replace

import numpy as np

from runningbond.contacts.search import Contacts
from runningbond.joints.law import COMMON_ROWS, FRICTION_WORK, OPENING_BEFORE, SLIP_BEFORE
from runningbond.scene import Array, Mask

from .system import BlockSystem, Interface

PLASTIC_SLIP = "plastic slip"
"""Name of the row of a law's history that holds the slip [m] at which a point would be free of shear."""


@dataclass(eq=False)
class State:
    """Where a system is: brought forward in place by the integrator."""

    # (nd,) modal displacement, and velocity half a step behind
    motion: Array
    velocity: Array
    history: Array  # (rows, np) history of the joint points, as their law keeps it
    damped: Array  # (nd,) work done against damping [J], mode by mode
    unbalanced: Array  # (nd,) force of the last step
    # the contacts that the history is of, a column each; None at small displacements, which know but one set
    contacts: Contacts | None = None
    bears: Mask = field(default_factory=lambda: np.zeros(0, dtype=bool))  # (nc,) the contacts' frames (`joints.frames`)
    external: float = 0.0  # work of the loads [J]
    # part of it: what dead loads do beyond the work that they would do constant, as they act at rest [J] (`rig`)
    turned: float = 0.0
    multiplier: float = 0.0  # of the live load, where that drives: its mean over the last steps
    steps: int = 0  # steps taken
    time: float = 0.0  # time since the start [s]
    # (1,) largest energy that was supplied at any look at it [J]
    supplied: Array = field(default_factory=lambda: np.zeros(1))
    stretch: Array = field(default_factory=lambda: np.zeros(0))  # (nt,) plastic elongation of the ties [m]
    # work spent on earlier contacts, and on their viscosity or that of modes that are held since, or that preloads of
    # ties did not do, for they came slowly [J]
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
        """A state that goes its own way from here."""
        arrays = ("motion", "velocity", "history", "damped", "unbalanced", "bears", "supplied", "stretch")
        return replace(self, **{name: getattr(self, name).copy() for name in arrays})

    def has_lost_nothing_since(self, before: "State") -> bool:
        """Whether no joint point and no tie has yielded since: it would come back, as elastic bodies do."""
        kept = [FRICTION_WORK, *range(len(COMMON_ROWS), len(self.history))]
        same = np.array_equal(self.history[kept], before.history[kept])
        return same and np.array_equal(self.stretch, before.stretch)


def frames_of(interface: Interface, contacts: Contacts | None) -> Mask:
    """Frames ``(nc,)`` that the jumps of an interface on contacts were last told in."""
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
