"""One traverse of a path of prescribed displacements: what is observed along it, and its answer."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from runningbond.scene import Array, Indices

from .collapse import Verdict
from .state import State

TOE = "broken toe [m]"
BEAM = ("beam rotation [rad]", "beam uplift [m]", "work spent in joints [J]", TOE)
"""Further columns for each row of a beam's path."""


class Place(NamedTuple):
    """Place on the path of a settlement."""

    way: float  # length of the path up to there, as a fraction of the settlement
    settled: float  # fraction of the settlement


class TraverseRow(NamedTuple):
    """Observations at one place of the path."""

    moved: float  # displacement [m], or fraction of the settlement
    force: float  # reaction [N], or share of the dead load
    carried: Array  # (np, 2) forces of joint points [N], or, at finite displacements, (n, 3) `Run.resultants`
    tie: Array  # (nt,) forces of the ties [N]
    works: tuple[float, float]  # work of the dead load, and of the prescribed displacement or the live load [J]
    beam: tuple[float, ...]  # `BEAM` if the beam is driven, otherwise empty


@dataclass
class Traverse:
    """One traverse of the path from a state at rest: its observations and its answer."""

    best: State  # state at which the answer is reached
    motion: Array  # (nd,) motion of the wall at the farthest displacement, or where it fails
    moves: bool  # whether forces are means during motion, not values at rest
    rows: list[TraverseRow] = field(default_factory=list)
    verdict: Verdict = "stable"
    unseen: float = 0.0  # by how much the answer may be larger: means over windows flatten peaks
    inertia: float = 0.0  # by how much smaller, as bodies accelerate; in settlements both are due to loosened friction
    spent: float = 0.0  # part of the answer whose work becomes kinetic energy or is damped, of a driven beam
    drag: float = 0.0  # part of the answer of a push that damping takes
    late_drag: float = 0.0  # largest part of the force that damping takes as a pushed wall loses half of its answer
    crushed: Array = field(default_factory=lambda: np.zeros((0, 2)))  # permanent closure at the joints' ends there [m]
    is_shape: bool = False  # whether the motion is the wall's deformed shape, far from that as built
    gone: float = 0.0  # sum over the rows of a push of how far the farthest blocks moved [m]
    elsewhere: tuple[Indices, Array, Array] | None = None  # where displacements are read if the control point stays
    lasting: float = 0.0  # largest mean force over a whole row during motion
    fall: tuple[Place, Place] | None = None  # of the last rest, and of the fall, on supports that move
    resolved: bool = True  # whether means over shorter and shorter windows add almost nothing to the answer

    @property
    def curve(self) -> Array:
        """Displacement [m] and force, ``(n, 2)``."""
        return np.array([(row.moved, row.force) for row in self.rows])

    @property
    def answer(self) -> float:
        """The force at the end of a path from rest to rest, or the largest force during a motion."""
        return float(self.curve[:, 1].max() if self.moves else self.curve[-1, 1])

    @property
    def still(self) -> float:
        """The answer without the part whose work sets bodies in motion or is damped; it may be too small."""
        return self.answer - max(0.0, self.spent)

    @property
    def largest(self) -> int:
        """Number of the row with the largest force."""
        return int(np.argmax([row.force for row in self.rows]))

    def calm(self) -> None:
        """Replace the force of each row of a motion, except the first and last, by the median of three, in place."""
        force = np.array([row.force for row in self.rows])
        for k in range(1, len(force) - 1) if self.moves else ():
            self.rows[k] = self.rows[k]._replace(force=float(np.median(force[k - 1 : k + 2])))
