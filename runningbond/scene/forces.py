"""Forces of loads on the blocks of a scene, and the arrows that represent them in drawings."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array, Indices, frozen
from .errors import SceneError

if TYPE_CHECKING:
    from .scene import Scene


@dataclass(frozen=True, eq=False)
class Forces:
    """Forces and moments of loads on the blocks of a scene.

    Parameters
    ----------
    acceleration : (nb, 2) float
        Force on each block per unit mass [m/s²].
    moment : (nb,) float
        Moment on each block [N m], counter-clockwise.
    block : (n,) int
        Block that each point force acts on.
    at, force : (n, 2) float
        Points of action [m] and point forces [N].
    """

    acceleration: Array
    moment: Array
    block: Indices
    at: Array
    force: Array

    def __post_init__(self) -> None:
        for name in ("acceleration", "moment", "at", "force"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        object.__setattr__(self, "block", frozen(self.block, np.int64))

    @classmethod
    def on(
        cls,
        scene: "Scene",
        acceleration: ArrayLike = (0.0, 0.0),
        moment: ArrayLike = 0.0,
        *,
        block: ArrayLike = (),
        at: ArrayLike = (),
        force: ArrayLike = (),
    ) -> "Forces":
        """Forces on a scene's blocks; a single acceleration or moment applies to all of them.

        Raises a `SceneError` for block numbers that the scene does not have and for points that are not finite.
        """
        nb, block = len(scene.blocks), _numbers(block, len(scene.blocks))
        at, force = (np.broadcast_to(np.reshape(x, (-1, 2)), (len(block), 2)) for x in (at, force))
        if not np.isfinite(at).all():
            raise SceneError("load.live.at", "must be finite", at.tolist())
        return cls(np.broadcast_to(acceleration, (nb, 2)), np.broadcast_to(moment, nb), block, at, force)

    def __add__(self, other: "Forces") -> "Forces":
        joined = (np.concatenate([getattr(each, name) for each in (self, other)]) for name in ("block", "at", "force"))
        return Forces(self.acceleration + other.acceleration, self.moment + other.moment, *joined)

    def resultants(self, scene: "Scene") -> Array:
        """Resultant forces on the blocks and moments about their centroids, ``(nb, 3)`` [N, N, N m]."""
        arm = self.at - scene.blocks.centroid[self.block]
        moment = arm[:, 0] * self.force[:, 1] - arm[:, 1] * self.force[:, 0]
        result = np.zeros((len(scene.blocks), 3))
        np.add.at(result, self.block, np.column_stack([self.force, moment]))
        return result + np.column_stack([scene.mass[:, None] * self.acceleration, self.moment])

    @property
    def on_mass_alone(self) -> bool:
        """Whether all forces are proportional to mass: no point force and no moment."""
        return len(self.block) == 0 and not self.moment.any()

    @property
    def at_points_alone(self) -> bool:
        """Whether all forces are point forces: no acceleration and no moment."""
        return not self.acceleration.any() and not self.moment.any()


def _numbers(block: ArrayLike, count: int) -> Indices:
    """Block numbers ``(n,)``; anything else, such as a mask or a number outside 0 … `count` - 1, is refused."""
    numbers = np.reshape(block, -1)
    if len(numbers) and not (numbers.dtype.kind in "iu" and numbers.min() >= 0 and numbers.max() < count):
        raise SceneError("load.live.block", f"must be numbers of blocks, 0 … {count - 1}", block)
    return frozen(numbers, np.int64)


@dataclass(frozen=True, eq=False)
class Arrow:
    """An arrow that represents a load in drawings.

    Parameters
    ----------
    direction : (2,) float
        Unit vector.
    at : (2,) float or None
        Position of its tip [m]; None is a row of arrows along the side of the wall that the load pushes.
    block : (n,) int
        Blocks that the tip moves with.
    """

    direction: Array
    at: Array | None
    block: Indices
