"""Scatter: walls that differ from one in their last bits, their blocks' sizes or their joints' friction."""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from runningbond.scene import Array, Indices, JointMaterial, Scene, SceneError
from runningbond.scene.arrays import components
from runningbond.scene.ranges import Range, suggestion

SEED = 20
"""Seed of all draws: a draw of a number is the same wherever and beside however many others it is made."""

BITS = 1e-12
"""Relative change of densities and frictions that changes nothing but their last bits."""

KEY = "scatter"
RANGES = {"size": Range(above=0.0, most=0.1), "friction": Range(above=0.0, most=0.5)}


@dataclass(frozen=True)
class Scatter:
    """What differs from draw to draw, besides the last bits.

    Parameters
    ----------
    size
        Tolerance of the blocks' widths and heights, relative: the lines of joints move within half of it.
    friction
        Standard deviation of the logarithm of each joint's friction.
    """

    size: float = 0.0
    friction: float = 0.0

    @classmethod
    def read(cls, text: str) -> "Scatter":
        """Scatter as it is asked for: ``bits``, or ``size=0.01,friction=0.05`` or one of them.

        Raises
        ------
        SceneError
            For anything else.
        """
        if not isinstance(text, str):
            raise SceneError(KEY, "must be bits, or size and friction as in size=0.01,friction=0.05", text)
        values: dict[str, float] = {}
        for part in [] if text.strip() == "bits" else text.split(","):
            name, _, value = (word.strip() for word in part.partition("="))
            if name not in RANGES or name in values:
                remedy = "must be bits, or size and friction, each once, as in size=0.01,friction=0.05"
                raise SceneError(KEY, f"{remedy}{suggestion(name, list(RANGES))}", text)
            given: float | str = value
            with suppress(ValueError):  # what is no number is refused as out of range
                given = float(value)
            values[name] = RANGES[name].take(f"{KEY} {name}", given)
        return cls(**values)

    def __str__(self) -> str:
        given = (("size", self.size), ("friction", self.friction))
        return ",".join(f"{name}={value:g}" for name, value in given if value) or "bits"

    def draw(self, scene: Scene, number: int) -> Scene:
        """A wall drawn at random by its number; 0 is the wall as it is.

        Raises
        ------
        SceneError
            Where blocks with other than level and upright sides are to differ in size.
        """
        random = np.random.default_rng([SEED, number])
        blocks = tuple(replace(each, density=each.density * _bit(random)) for each in scene.block_materials)
        joints = tuple(_rougher(each, _bit(random)) for each in scene.joint_materials)
        drawn = replace(scene, block_materials=blocks, joint_materials=joints)
        shifts = np.exp(self.friction * random.standard_normal(len(scene.joints)))
        drawn = _resized(drawn, self.size, random) if self.size else drawn
        drawn = _with_friction(drawn, shifts) if self.friction else drawn
        return drawn if number else scene


def _bit(random: np.random.Generator) -> float:
    return 1.0 + BITS * float(random.uniform(-1.0, 1.0))


def _rougher(material: JointMaterial, by: float) -> JointMaterial:
    """A material of so many times the friction, whose tensile strength is at most what its cohesion leaves it."""
    friction, tension = material.friction * by, material.tensile_strength
    if tension is not None and friction > 0:
        tension = min(tension, material.cohesion / friction)
    return replace(material, friction=friction, tensile_strength=tension)


def _with_friction(scene: Scene, factors: Array) -> Scene:
    """A wall each of whose joints has its own friction, times one of the factors ``(nj,)``."""
    own = [
        _rougher(scene.joint_materials[k], by) for k, by in zip(scene.material_of_joint, factors.tolist(), strict=True)
    ]
    number = len(scene.joint_materials) + np.arange(len(own))
    return replace(scene, joint_materials=(*scene.joint_materials, *own), material_of_joint=number)


def _resized(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    """A wall whose lines of joints, each straight and as long as it goes, have moved; its outer sides stay."""
    corners = scene.blocks.vertices.copy()
    along = np.abs(np.diff(corners[np.column_stack([np.arange(len(corners)), scene.blocks.successor])], axis=1)[:, 0])
    places, ends_at = _places(scene, scene.blocks.vertices), _places(scene, scene.joints.ends.reshape(-1, 2))
    if (along.min(axis=1) > scene.blocks.tolerance).any() or not {*ends_at} <= {*places}:
        raise SceneError(
            KEY, "size is taken by walls of level and upright joints alone; leave it out", f"size={size:g}"
        )
    low, high = scene.blocks.extent(scene.wall)
    sides = np.subtract(*scene.blocks.boxes[::-1])[scene.wall]
    ends = scene.joints.ends.copy()
    for axis in (0, 1):
        line = _lines(scene, axis)
        shift = random.uniform(-0.5, 0.5, line.max() + 1) * size * sides[:, axis].min()
        at = scene.blocks.vertices[:, axis]
        inside = (at > low[axis] + scene.blocks.tolerance) & (at < high[axis] - scene.blocks.tolerance)
        moved = np.where(inside, shift[line], 0.0)
        corners[:, axis] += moved
        by_place = dict(zip(places, moved, strict=True))
        ends[..., axis] += np.reshape([by_place[place] for place in ends_at], ends.shape[:2])
    return replace(scene, blocks=replace(scene.blocks, vertices=corners), joints=replace(scene.joints, ends=ends))


def _places(scene: Scene, points: Array) -> list[tuple[int, int]]:
    """Where points are, to the tolerance of contacts."""
    return [(int(x), int(y)) for x, y in np.rint(points / scene.blocks.tolerance)]


def _lines(scene: Scene, axis: int) -> Indices:
    """Number of the straight line across an axis that each corner lies on, ``(nv,)``.

    A line is made up of sides of blocks that share a corner or lie on one another, at one place along the axis.
    """
    place = np.array(_places(scene, scene.blocks.vertices))
    start, end = np.arange(len(place)), scene.blocks.successor
    across = place[start, axis] == place[end, axis]
    order = np.lexsort((place[:, 1 - axis], place[:, axis]))
    # Corners at one place along the axis, one after the other: joined where a side covers the way between them.
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    covered = np.zeros(len(order) + 1, dtype=np.int64)
    first, last = np.sort([rank[start[across]], rank[end[across]]], axis=0)
    np.add.at(covered, first, 1)
    np.add.at(covered, last, -1)
    same = (np.diff(place[order], axis=0) == 0).all(axis=1)
    joined = np.flatnonzero((np.cumsum(covered)[:-2] > 0) | same)
    return components(np.column_stack([order[joined], order[joined + 1]]), len(order))
