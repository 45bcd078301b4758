"""Scatter: random variants of a wall that differ in last bits, in the sizes of blocks or in the friction of joints."""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from runningbond.scene import Action, Array, GivenForces, Indices, JointMaterial, Scene, SceneError
from runningbond.scene.arrays import components
from runningbond.scene.materials import LEAST_FRICTION, MOST_FRICTION
from runningbond.scene.ranges import Range, suggestion

SEED = 20
"""Seed of all draws: a draw with a given number is the same on every machine and for any number of draws."""

BITS = 1e-12
"""Relative change of densities and frictions that affects only their last bits."""

LARGEST_SHIFT = 0.45
"""Largest shift of a line, per length of joints that end at it: two that approach each other leave a tenth of it."""

KEY = "scatter"
RANGES = {"size": Range(above=0.0, most=0.1), "friction": Range(above=0.0, most=0.5)}


@dataclass(frozen=True)
class Scatter:
    """What varies from draw to draw, in addition to the last bits.

    Parameters
    ----------
    size
        Tolerance of block widths and heights, relative to the smallest: lines of joints shift by half of it at most.
    friction
        Standard deviation of the logarithm of each joint's friction.
    """

    size: float = 0.0
    friction: float = 0.0

    @classmethod
    def read(cls, text: str) -> "Scatter":
        """Parse a scatter: ``bits``, or ``size=0.01,friction=0.05``, or one of these two.

        Raises
        ------
        SceneError
            For any other text.
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
            with suppress(ValueError):  # text that is no number is refused by `take`
                given = float(value)
            values[name] = RANGES[name].take(f"{KEY} {name}", given)
        return cls(**values)

    def __str__(self) -> str:
        given = (("size", self.size), ("friction", self.friction))
        return ",".join(f"{name}={value:g}" for name, value in given if value) or "bits"

    def draw(self, scene: Scene, number: int) -> Scene:
        """Random variant of a wall with a given number; 0 is the wall as given.

        Raises
        ------
        SceneError
            If sizes are to vary and sides are neither horizontal nor vertical, or joints do not end at corners.
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
    """A material with its friction times `by`, and a tensile strength of at most cohesion over friction."""
    friction, tension = material.friction * by, material.tensile_strength
    if friction > 0:  # values at the limits stay admissible
        friction = min(max(friction, LEAST_FRICTION), MOST_FRICTION)
    if tension is not None and friction > 0:
        tension = min(tension, material.cohesion / friction)
    return replace(material, friction=friction, tensile_strength=tension)


def _with_friction(scene: Scene, factors: Array) -> Scene:
    """A wall with a separate material for each joint, whose friction is multiplied by one of the factors ``(nj,)``."""
    own = [
        _rougher(scene.joint_materials[k], by) for k, by in zip(scene.material_of_joint, factors.tolist(), strict=True)
    ]
    number = len(scene.joint_materials) + np.arange(len(own))
    return replace(scene, joint_materials=(*scene.joint_materials, *own), material_of_joint=number)


def _resized(scene: Scene, size: float, random: np.random.Generator) -> Scene:
    """A wall with randomly shifted lines of joints; a line is straight and as long as sides of blocks continue it.

    The outer sides of the wall stay, and so do a beam, the ground and lines that continue them. Shifts are reduced if a
    joint between two lines would vanish. Point loads, pins and ties stay on their blocks, and move with them.
    """
    blocks, corners, ends = scene.blocks, scene.blocks.vertices.copy(), scene.joints.ends.copy()
    place, place_of_end = np.split(_places(scene), [len(corners)])
    along = np.abs(np.diff(corners[np.column_stack([np.arange(len(corners)), blocks.successor])], axis=1)[:, 0])
    corner_at = {(int(x), int(y)): k for k, (x, y) in enumerate(place)}
    corner_of_end = np.array([corner_at.get((int(x), int(y)), -1) for x, y in place_of_end]).reshape(-1, 2)
    if (along.min(axis=1) > blocks.tolerance).any() or (corner_of_end < 0).any():
        raise SceneError(
            KEY, "size is taken by walls of level and upright joints alone; leave it out", f"size={size:g}"
        )
    low, high = blocks.extent(scene.masonry)
    sides = np.subtract(*blocks.boxes[::-1])[scene.masonry]
    for axis in (0, 1):
        line, at = _lines(scene, place, axis), blocks.vertices[:, axis]
        shift = random.uniform(-0.5, 0.5, line.max() + 1) * size * sides[:, axis].min()
        most, length = np.full(len(shift), np.inf), np.abs(np.diff(scene.joints.ends[..., axis], axis=1))
        np.minimum.at(most, line[corner_of_end], np.where(length > blocks.tolerance, LARGEST_SHIFT * length, np.inf))
        outer = (at < low[axis] + blocks.tolerance) | (at > high[axis] - blocks.tolerance)
        most[line[outer | ~scene.masonry[blocks.owner]]] = 0.0
        moved = np.clip(shift, -most, most)[line]
        corners[:, axis] += moved
        ends[..., axis] += moved[corner_of_end]
    drawn = replace(scene, blocks=replace(blocks, vertices=corners), joints=replace(scene.joints, ends=ends))
    return _carried(scene, drawn)


def _carried(scene: Scene, drawn: Scene) -> Scene:
    """The drawn wall, with the loads, pins and ties of the original scene moved along with their blocks."""
    (low, high), (drawn_low, drawn_high) = scene.blocks.boxes, drawn.blocks.boxes
    shift, growth = drawn_low - low, (drawn_high - drawn_low) / (high - low) - 1.0

    def moved(block: Indices, at: Array) -> Array:
        """Points after the change of their blocks' bounding boxes; points of block -1 are fixed in space."""
        there = at + shift[block] + (at - low[block]) * growth[block]
        return np.where((block < 0)[..., None], at, there)

    def on_blocks(load: Action) -> Action:
        forces = load.forces(scene)
        there = moved(forces.block, forces.at)
        if not forces.moment.any() and np.array_equal(there, forces.at):
            return load
        block, at, direction = load.control(scene)
        return GivenForces(replace(forces, at=there), (block, moved(block, at), direction))

    live, dead = (tuple(map(on_blocks, loads)) for loads in (scene.load.live, scene.load.dead))
    return replace(
        drawn,
        load=replace(scene.load, live=live, dead=dead),
        pins=replace(scene.pins, point=moved(scene.pins.block, scene.pins.point)),
        ties=replace(scene.ties, ends=moved(scene.ties.block, scene.ties.ends)),
    )


def _places(scene: Scene) -> Indices:
    """Numbers of distinct x and y coordinates of all corners, then of the joints' ends, ``(nv + 2 nj, 2)``.

    Coordinates closer than the contact tolerance have the same number.
    """
    points = np.concatenate([scene.blocks.vertices, scene.joints.ends.reshape(-1, 2)])
    order = np.argsort(points, axis=0)
    apart = np.diff(np.take_along_axis(points, order, axis=0), axis=0, prepend=-np.inf) > scene.blocks.tolerance
    place = np.empty_like(order)
    np.put_along_axis(place, order, np.cumsum(apart, axis=0), axis=0)
    return place


def _lines(scene: Scene, place: Indices, axis: int) -> Indices:
    """Number of the straight line perpendicular to an axis that each corner lies on, ``(nv,)``.

    A line consists of sides of blocks with the same coordinate along the axis that share a corner or overlap.
    """
    start, end = np.arange(len(place)), scene.blocks.successor
    across = place[start, axis] == place[end, axis]
    order = np.lexsort((place[:, 1 - axis], place[:, axis]))
    # Successive corners with the same coordinate along the axis are connected if a side covers the stretch between.
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    covered = np.zeros(len(order) + 1, dtype=np.int64)
    first, last = np.sort([rank[start[across]], rank[end[across]]], axis=0)
    np.add.at(covered, first, 1)
    np.add.at(covered, last, -1)
    same = (np.diff(place[order], axis=0) == 0).all(axis=1)
    joined = np.flatnonzero((np.cumsum(covered)[:-2] > 0) | same)
    return components(np.column_stack([order[joined], order[joined + 1]]), len(order))
