"""A wall at rest under its weight, from which any number of ground motions can start."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from runningbond.dynamics import (
    U_CRIT,
    BlockSystem,
    Criteria,
    Run,
    State,
    fall_under_dead_load,
    put_on_dead_load,
)
from runningbond.dynamics.collapse import Verdict
from runningbond.dynamics.run import CALMING
from runningbond.limit import bears_dead_load
from runningbond.scene import Array, History, Lateral, Scene, SceneError

VISCOUS = 1.0
"""Damping ratio of joints at the highest frequency: impacting corners do not bounce, and lose energy as in Housner's
model."""


@dataclass(frozen=True, eq=False)
class Resting:
    """A wall that has been brought to rest.

    Parameters
    ----------
    scene, model
        The wall, with a ground motion, and the name of the model.
    system
        Its blocks at finite displacements.
    state, verdict
        Its state, and ``stable`` if it is at rest there.
    viscous
        Damping ratio of its joints during the ground motion.
    """

    scene: Scene
    model: str
    system: BlockSystem
    state: State
    verdict: Verdict
    viscous: float = VISCOUS

    @classmethod
    def of(cls, scene: Scene, model: str, system: BlockSystem) -> "Resting":
        """Bring a wall to rest under its dead load."""
        criteria = Criteria(collapse=U_CRIT * scene.block_sizes[system.owner])
        loaded = put_on_dead_load(Run(system, local=CALMING), criteria)
        loaded.state.velocity[:] = 0.0
        return cls(scene, model, system, loaded.state, loaded.verdict)

    @property
    def trouble(self) -> tuple[Literal["infeasible", "undecided"], str] | None:
        """Status and message if the wall does not come to rest, and so cannot be shaken; else None."""
        if self.verdict == "collapse":
            return fall_under_dead_load(self.system.interface.law, self._bears_dead_load)
        if self.verdict == "undecided":
            return "undecided", "the budget ran out before the wall came to rest under its dead load"
        return None

    def _bears_dead_load(self) -> bool:
        pushed = replace(self.scene.load, live=(Lateral(),))  # limit analysis does not include ground motion
        return bears_dead_load(replace(self.scene, load=pushed))

    @property
    def history(self) -> History:
        """Ground motion of the scene; a scene without one is refused."""
        if self.scene.history is None:
            raise SceneError("load.history", "is missing: the motion of the ground that the wall is to follow")
        return self.scene.history

    @property
    def height(self) -> float:
        """Height of the wall [m]."""
        low, high = self.scene.blocks.extent(self.scene.wall)
        return float(high[1] - low[1])

    @property
    def gravity(self) -> float:
        """Gravity [m/s²]."""
        return float(np.hypot(*self.scene.load.gravity))

    @property
    def swing(self) -> float:
        """Time [s] within which a rocking wall passes through its upright position, unless it barely moves."""
        return 2 * math.sqrt(self.height / (self.gravity or 1.0))

    @property
    def top(self) -> Array:
        """Upper corners of the wall, left and right, ``(2, 2)`` [m]."""
        blocks = self.scene.blocks
        corners = blocks.vertices[self.scene.wall[blocks.owner]]
        highest = corners[corners[:, 1] >= corners[:, 1].max() - blocks.tolerance]
        return np.asarray(highest[[highest[:, 0].argmin(), highest[:, 0].argmax()]])

    def block_at(self, point: Array) -> int:
        """Movable block that contains a point ``(2,)`` [m]; if several or none do, the one with the nearest corner."""
        blocks, can_move = self.scene.blocks, ~self.scene.fixed
        holding = blocks.containing(point)
        if can_move[holding].any():
            can_move &= np.isin(np.arange(len(blocks)), holding)
        corners = np.flatnonzero(can_move[blocks.owner])
        return int(blocks.owner[corners[np.hypot(*(blocks.vertices[corners] - point).T).argmin()]])
