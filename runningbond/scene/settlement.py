"""Settlement: prescribed motion of a part of the ground."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from shapely.geometry.polygon import orient

from .actions import Action
from .arrays import Array, Mask
from .errors import SceneError
from .forces import Arrow, Forces
from .protocol import read_protocol, turning_points
from .ranges import Range, vector
from .table import Table

if TYPE_CHECKING:
    from .scene import Scene

LARGEST_ANGLE = 10.0
"""Largest rotation of a support, at λ = 1 and along a path [degrees]: up to it rotations count as small."""

STATIONARY = 1e-3
"""Displacement of a point up to which it counts as at rest, relative to the largest of the support's joint ends."""


@dataclass(frozen=True)
class Settlement(Action):
    """Prescribed motion of ground, or fixed blocks, inside a box.

    In limit analysis, λ is the share of the reaction of the moving support that remains.

    Parameters
    ----------
    box
        Lower left and upper right corner [m]. Ground is cut at the sides and the top of the box; the part inside moves.
    by
        Displacement [m] at λ = 1.
    rotation_angle
        Rotation [degrees] at λ = 1, counter-clockwise.
    about
        Centre of rotation [m]; None for the middle of the box.
    path
        Multiples of this motion that the support is moved to, one after the other.
    """

    box: tuple[tuple[float, float], tuple[float, float]]
    by: tuple[float, float] = (0.0, 0.0)
    rotation_angle: float = 0.0
    about: tuple[float, float] | None = None
    path: tuple[float, ...] = (1.0,)

    def __post_init__(self) -> None:
        object.__setattr__(self, "box", read_box("load.live.box", self.box))
        object.__setattr__(self, "by", vector("load.live.by", self.by))
        angle = Range(least=-LARGEST_ANGLE, most=LARGEST_ANGLE).take("load.live.rotation_angle", self.rotation_angle)
        object.__setattr__(self, "rotation_angle", angle)
        if self.about is not None:
            object.__setattr__(self, "about", vector("load.live.about", self.about))
            if not self.rotation_angle:
                raise SceneError("load.live.rotation_angle", "is missing; about is the point that it turns about")
        object.__setattr__(self, "path", turning_points("load.live.path", self.path))
        if abs(angle) * self.farthest > LARGEST_ANGLE * (1 + 1e-9):
            what = f"must turn the support by at most {LARGEST_ANGLE:g} degrees"
            raise SceneError("load.live.rotation_angle", f"{what}; its path multiplies it by {self.farthest:g}", angle)
        if not any(self.by) and not self.rotation_angle:
            raise SceneError("load.live.by", "must move the support, or rotation_angle must turn it", list(self.by))

    @property
    def centre(self) -> Array:
        """Centre of rotation [m]."""
        return np.asarray(np.mean(self.box, axis=0) if self.about is None else self.about, dtype=float)

    @property
    def farthest(self) -> float:
        """Largest multiple of the motion along the path, regardless of its sign."""
        return max(map(abs, self.path))

    @classmethod
    def read(cls, table: Table) -> "Settlement":
        """Read the load from a table with a box, and a displacement or a rotation."""
        box = table.required("box", "two corners [[x0, y0], [x1, y1]]")
        if "by" not in table and "rotation_angle" not in table:
            what = "is missing: the displacement [x, y] in m; or give rotation_angle in degrees"
            raise SceneError(table.key("by"), what)
        by = table.vector("by") if "by" in table else (0.0, 0.0)
        angle = table.optional_number("rotation_angle", Range())
        about = table.vector("about") if "about" in table else None
        path, to_and_fro = table.value("path"), read_protocol(table)
        if path is not None and to_and_fro is not None:
            raise SceneError(table.name, "must have one of path and amplitudes, not both")
        return cls(box, by, angle or 0.0, about, to_and_fro or ((1.0,) if path is None else path))

    def forces(self, scene: "Scene") -> Forces:
        """No forces: the load moves the ground."""
        return Forces.on(scene)

    def moving(self, scene: "Scene") -> Mask:
        """Mask of fixed blocks that move, ``(nb,)``; the halves of a block that may crack move together."""
        # Blocks that only touch the box, or have their middle on a side of it, stay, however coordinates are rounded.
        low, high = np.array(self.box) + [[scene.blocks.tolerance], [-scene.blocks.tolerance]]
        number = np.arange(len(scene.blocks))
        _, body = np.unique(np.where(scene.part_of < 0, len(number) + number, scene.part_of), return_inverse=True)
        area = scene.blocks.area
        middle = (np.bincount(body, area * scene.blocks.centroid[:, 0]) / np.bincount(body, area))[body]
        bottom, top = (ends[:, 1] for ends in scene.blocks.boxes)
        level = (np.bincount(body, (bottom < high[1]) & (top > low[1])) > 0)[body]
        # Ground is cut at the top of the box as well: ground that rises above it is the rest, which may bridge the box.
        inside = scene.wall | (top < self.box[1][1] + 2 * scene.blocks.tolerance)
        moving: Mask = scene.fixed & level & inside & (middle > low[0]) & (middle < high[0])
        return moving

    def motion(self, scene: "Scene") -> Array:
        """Motion of each block's centroid [m] and its rotation [rad] at λ = 1, ``(nb, 3)``; zero for blocks at rest."""
        turn = math.radians(self.rotation_angle)
        arm = scene.blocks.centroid - self.centre
        motion = np.column_stack(
            [self.by[0] - turn * arm[:, 1], self.by[1] + turn * arm[:, 0], np.full(len(arm), turn)]
        )
        return np.where(self.moving(scene)[:, None], motion, 0.0)

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse pinned supports, and a box that holds no moving body in contact with a movable block."""
        if len(scene.pins) and not scene.fixed.any():
            raise SceneError(key, 'needs support.kind "base" or "fixed-first-course": a ground that moves')
        moving = self.moving(scene)
        borne = (moving[scene.joints.block] & ~scene.fixed[scene.joints.block[:, ::-1]]).any()
        if not borne:
            raise SceneError(f"{key}.box", "holds no ground that bears a block", [list(corner) for corner in self.box])

    def control(self, scene: "Scene") -> Any:
        """First moving block, the middle of its top, and the direction in which this point moves.

        If the support turns about that point, the end of a joint on the support that moves farthest takes its place.
        """
        moving = self.moving(scene)
        first = np.flatnonzero(moving)[0]
        low, high = scene.blocks.extent(int(first))
        joint, side = np.nonzero(moving[scene.joints.block])
        block = np.append(first, np.repeat(scene.joints.block[joint, side], 2))
        at = np.vstack([[(low[0] + high[0]) / 2, high[1]], scene.joints.ends[joint].reshape(-1, 2)])
        x, y = (at - scene.blocks.centroid[block]).T
        dx, dy, turn = self.motion(scene)[block].T
        move = np.column_stack([dx - turn * y, dy + turn * x])
        size = np.hypot(*move.T)
        share = np.round(size / size.max(), 9)  # of ends that move equally far, rounding errors do not choose
        k = 0 if share[0] > STATIONARY else int(share.argmax())
        return block[[k]], at[[k]], move[[k]] / size[k]

    def arrows(self, scene: "Scene") -> tuple[Arrow, ...]:
        """An arrow at the moving ground."""
        block, (at,), (direction,) = self.control(scene)
        return (Arrow(direction, at, block),)


def cut_ground(grounds: Sequence[Array], settlements: Sequence[Settlement], reach: float) -> list[Array]:
    """Cut grounds ``(n, 2)`` [m] at the sides and tops of the boxes of settlements.

    A cut within the contact tolerance `reach` [m] of a corner is moved to that corner; thinner pieces are dropped.
    """
    pieces = [shapely.Polygon(ground) for ground in grounds]
    corners = np.concatenate([np.zeros((0, 2)), *grounds])
    for settlement in settlements:
        (x0, _), (x1, y1) = settlement.box
        x0, x1, y1 = (_at_corner(x, corners[:, axis], reach) for x, axis in ((x0, 0), (x1, 0), (y1, 1)))
        deep = min((piece.bounds[1] for piece in pieces), default=0.0) - 1.0
        inside = shapely.box(x0, deep, x1, max(y1, deep))
        parts = [part for piece in pieces for part in (piece.intersection(inside), piece.difference(inside))]
        found = [one for part in parts for one in shapely.get_parts(part)]
        pieces = [one for one in found if not one.buffer(-reach / 2).is_empty]
    return [np.array(orient(piece).exterior.coords)[:-1] for piece in pieces]


def _at_corner(place: float, corners: Array, reach: float) -> float:
    """The coordinate of the nearest corner if it is within reach of `place`, else `place`."""
    apart = np.abs(corners - place)
    return float(corners[apart.argmin()]) if apart.min(initial=np.inf) <= reach else place


def read_box(key: str, value: Any, *, flat: bool = False) -> tuple[tuple[float, float], tuple[float, float]]:
    """Check the two corners of a box: lower left, then upper right; the box may be `flat`, a line or a point."""
    corners = list(value) if isinstance(value, (list, tuple, np.ndarray)) else []
    if len(corners) != 2:
        raise SceneError(key, "must be two corners [[x0, y0], [x1, y1]]", value)
    low, high = (vector(f"{key}[{k}]", corner) for k, corner in enumerate(corners))
    if not (low[0] <= high[0] and low[1] <= high[1]):
        raise SceneError(key, "must have its lower left corner first, then the upper right one", value)
    if not flat and (low[0] == high[0] or low[1] == high[1]):
        raise SceneError(key, "must have a width and a height", value)
    return low, high
