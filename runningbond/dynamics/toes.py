"""The toes of a wall, which break where a pushed wall turns over them."""

from functools import cached_property

import numpy as np

from runningbond.joints import JointPoints
from runningbond.scene import Array, Mask, Scene


class Toes:
    """The lower halves of the outer quarters of a wall.

    Parameters
    ----------
    scene
        The scene.
    points
        Its joint points, and those between triangles.
    """

    def __init__(self, scene: Scene, points: JointPoints) -> None:
        self.scene, self.points = scene, points

    def broken(self, opening: Array, damage: Array, crushed: Array, *, right: bool) -> float:
        """Depth to which the right or left toe has been crushed, or opening of cracks within its blocks [m].

        The larger one; from the opening, damage, and permanent closure of all joint points, ``(np,)`` each.
        """
        split = np.where(self.is_inner & (damage >= 1), np.maximum(opening, 0.0), 0.0)
        return float(np.maximum(crushed, split)[self._points_of_toes[int(right)]].max(initial=0.0))

    @cached_property
    def is_inner(self) -> Mask:
        """Whether a joint point lies within a block ``(np,)``."""
        inner, joint = self.scene.joints.inner, self.points.joint
        return np.append(inner, True)[np.minimum(joint, len(inner))]  # higher numbers are joints between triangles

    @cached_property
    def _points_of_toes(self) -> tuple[Mask, Mask]:
        """The points of the left and of the right toe."""
        (left, bottom), (right, top) = self.scene.blocks.extent(self.scene.masonry)
        x, y = self.points.position.T
        # Joints at half the height and points at the quarters belong to the toe in spite of rounding in a sum of sizes.
        reach = self.scene.blocks.tolerance
        low, width = y <= (bottom + top) / 2 + reach, (right - left) / 4 + reach
        return low & (x <= left + width), low & (x >= right - width)
