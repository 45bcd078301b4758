"""Warnings about likely slips in a scene: wrong units, courses that do not line up, blocks that touch nowhere.

None of this is an error in itself, and nothing is refused. A warning is one line that names the key, its value, and
what may have been meant.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
import shapely

from .arrays import Array, Mask
from .blocks import touching_boxes
from .history import STANDARD_GRAVITY
from .materials import BlockMaterial, JointMaterial, Mortar, Stiffness, table_of
from .scene import Scene
from .ties import ANCHOR


@dataclass(frozen=True)
class Plausible:
    """Usual range of a number in its unit, and factors of other units in which it may have been given by mistake."""

    least: float
    most: float
    unit: str
    others: Mapping[str, float] = field(default_factory=dict)

    def doubts(self, key: str, value: float) -> Iterator[str]:
        """Yield a warning for a number outside the range; 0 is not warned about, because it means none."""
        if value == 0 or self.least <= value <= self.most:
            return
        unit, meant = self.likely(value, self.others)
        hint = f"; is {value:g} {unit} meant, which is {meant:.4g} {self.unit}?" if unit else ""
        yield f"{key} = {value:g}: is not within {self.least:g} … {self.most:g} {self.unit}{hint}"

    def likely(self, value: float, others: Mapping[str, float]) -> tuple[str, float]:
        """The most likely of other units, by their factors, and what the number is in it; empty and 0 if none is."""
        middle = math.sqrt(self.least * self.most)
        meant = {unit: value * factor for unit, factor in others.items()}
        likely = {unit: one for unit, one in meant.items() if self.least <= one <= self.most}
        unit = min(likely, key=lambda unit: abs(math.log(likely[unit] / middle)), default="")
        return unit, likely.get(unit, 0.0)


PRESSURES = {"GPa": 1e9, "MPa": 1e6, "kPa": 1e3}
STRENGTH = Plausible(100.0, 1e8, "Pa", PRESSURES)
ENERGY = Plausible(0.5, 1e5, "J/m²", {"N/mm": 1e3})
STIFFNESS = Plausible(1e6, 1e16, "Pa/m", {"N/mm³": 1e9, "MPa/m": 1e6})
OF_MATERIALS = {
    "density": Plausible(200.0, 8000.0, "kg/m³", {"kN/m³": 1000 / 9.81, "t/m³": 1000.0}),
    "young": Plausible(1e7, 1e13, "Pa", PRESSURES),
    "cohesion": STRENGTH,
    "tensile_strength": STRENGTH,
    "compressive_strength": Plausible(1e4, 1e10, "Pa", PRESSURES),
    "fracture_energy_1": ENERGY,
    "fracture_energy_2": ENERGY,
    "compressive_fracture_energy": ENERGY,
}
OF_MORTAR = {
    "young": Plausible(1e6, 1e13, "Pa", PRESSURES),
    "thickness": Plausible(2e-4, 0.2, "m", {"mm": 1e-3, "cm": 1e-2}),
}
OF_TIES = Plausible(1e8, 1e12, "Pa", PRESSURES)
AREA = Plausible(1e-8, 0.1, "m²", {"mm²": 1e-6, "cm²": 1e-4})
UNREAL_YIELD_STRESS = 5e9
"""Stress [Pa] that no real tie reaches: if yield force / area is above it, a stress was probably given as `yield`."""
LOW_YIELD_STRESS = 1e6
"""Stress [Pa] at which no real tie yields: if yield force / area is below it, `yield` was probably given in kN."""

LEAST_FORCES, LEAST_SHARE = 1e3, 0.1
"""Sum of all constant forces [N], and its share of the wall's weight, below both of which they were probably given in
kN."""

SIZE = Plausible(0.05, 200.0, "m", {"mm": 1e-3, "cm": 1e-2, "km": 1e3})
GRAVITY = Plausible(9.3, 10.3, "m/s²")
SHAKING = Plausible(0.01, 50.0, "m/s²")
RECORDED_IN = {
    "acceleration": {"cm/s²": 1e-2},
    "g": {"cm/s²": 1e-2 / STANDARD_GRAVITY, "m/s²": 1 / STANDARD_GRAVITY},
    "velocity": {"cm/s": 1e-2},
    "displacement": {"mm": 1e-3, "cm": 1e-2},
}
"""Factors on the acceleration if the values of a record, by its quantity, are in another unit than was said."""

SAMPLING = Plausible(1e-5, 0.5, "s", {"ms": 1e-3})
FRICTION = (0.1, 1.5)
ANGLES = (5.0, 60.0)
"""Range of numbers given as tan φ that are more likely the angle itself in degrees."""

THICKNESS = (0.02, 50.0)
"""Usual thickness of the wall, as a multiple of its median block size."""

LARGEST_SETTLEMENT = 0.1
"""Largest usual displacement of a support, as a share of the wall's longer side."""

LEVEL_DIFFERENCE = 0.1
"""Difference between two bed levels, as a share of the smallest block height, below which one level was meant."""

RECTANGULAR_SHARE = 0.8
"""Least share of rectangular blocks for which a wall is taken to have courses."""

UNINTENDED_GAP = 0.1
"""Largest gap between blocks side by side, as a share of the median block width, that is probably unintended."""


def warnings(scene: Scene) -> tuple[str, ...]:
    """All warnings about a scene, one line each."""
    # Corners without the strength of their joint have a material of the same name.
    return tuple(dict.fromkeys(line for check in CHECKS for line in check(scene)))


def _materials(scene: Scene) -> Iterator[str]:
    """Warn about unusual material parameters."""
    materials: tuple[BlockMaterial | JointMaterial, ...] = (*scene.block_materials, *scene.joint_materials)
    for material in materials:
        table = table_of(material)
        for name in (entry.name for entry in fields(material)):
            value: Any = getattr(material, name)
            if name in OF_MATERIALS and value is not None:
                yield from OF_MATERIALS[name].doubts(f"{table}.{name}", value)
            elif isinstance(value, Mortar):
                for own, usual in OF_MORTAR.items():
                    yield from usual.doubts(f"{table}.mortar.{own}", getattr(value, own))
            elif isinstance(value, Stiffness):
                for own in ("normal", "shear"):
                    yield from STIFFNESS.doubts(f"{table}.{own}_stiffness", getattr(value, own))
            elif name == "friction":
                yield from _friction(f"{table}.friction", value)


def _stones(scene: Scene) -> Iterator[str]:
    """Warn about joints that bear more tension than stones, which in most models crack on their axes only.

    Also about named materials, such as a lintel's steel, whose blocks crack with the strength of stones.
    """
    stone = scene.inner_joint
    if stone is None:
        return
    for material in scene.materials_of_joints:
        if material.tension > stone.tension:
            more = f"{material.tension:.4g} Pa is above that of inner_joint, {stone.tension:.4g} Pa"
            only = 'only fem with cracks = "blocks" lets stones crack right beside it'
            yield f"{table_of(material)}: its tensile strength of {more}; {only}"
    own = scene.material_of_block
    for k in np.unique(own[scene.joints.block[scene.joints.inner]]):
        if k and (own[scene.masonry] != k).any():
            which = "its blocks, also lintels, may crack like all others, with the strength of inner_joint"
            yield f"{table_of(scene.block_materials[k])}: {which}"


def _friction(key: str, friction: float) -> Iterator[str]:
    """Warn about an unusual tan φ; 0 is intended: a joint without friction."""
    least, most = FRICTION
    if friction > most:
        angle = ANGLES[0] <= friction <= ANGLES[1]
        hint = f"; is friction_angle = {friction:g} meant, tan φ = {math.tan(math.radians(friction)):.3g}?"
        yield f"{key} = {friction:.4g}: is tan φ, and above {most:g}{hint if angle else ''}"
    elif 0 < friction < least:
        given = math.degrees(math.atan(friction))
        hint = "an angle is friction_angle, in degrees"
        if ANGLES[0] <= math.degrees(given) <= ANGLES[1]:
            hint += f"; is {math.degrees(given):.3g} meant, which is {given:.3g} in radians?"
        yield f"{key} = {friction:.4g}: is tan φ, and below {least:g}; {hint}"


def _thicknesses(scene: Scene) -> Iterator[tuple[str, float]]:
    """Thicknesses of the wall's blocks, each with its key."""
    for k in np.unique(scene.material_of_block[scene.masonry]):
        material = scene.block_materials[k]
        own = material.thickness
        yield ("wall.thickness", scene.thickness) if own is None else (f"{table_of(material)}.thickness", own)


def _sizes(scene: Scene) -> Iterator[str]:
    """Warn about unusual wall sizes, gravity and settlements."""
    low, high = scene.blocks.extent(scene.masonry)
    longest = float(max(high - low))
    side = "length" if longest == (high - low)[0] else "height"
    yield from SIZE.doubts(f"wall{': ' if scene.bond is None else '.'}{side}", longest)  # outlines have no such key
    middling = float(np.median(np.sqrt(scene.blocks.area[scene.masonry])))
    least, most = (share * middling for share in THICKNESS)
    for key, thickness in dict(_thicknesses(scene)).items():
        if not least <= thickness <= most:
            what = f"is odd for blocks of about {middling:.3g} m"
            hint = f"; are {thickness:g} mm meant?" if least <= 1e-3 * thickness <= most else ""
            yield f"{key} = {thickness:g}: {what}{hint}"
    yield from GRAVITY.doubts("load.gravity", float(np.hypot(*scene.load.gravity)))
    farthest = 1.0 if scene.settlement is None else scene.settlement.farthest
    moved = farthest * float(np.hypot(*scene.support_motion[:, :2].T).max())
    if moved > LARGEST_SETTLEMENT * longest:
        along = "" if farthest == 1 else ", largest along path"
        yield f"load.live.by{along} = {moved:g}: moves a support by more than a tenth of the wall's size; are mm meant?"


def _constant_forces(scene: Scene) -> Iterator[str]:
    """Warn about forces on the wall that are small beside its weight; accelerations and moments are no forces."""
    forces = {key: load.forces(scene).force for key, load in replace(scene.load, live=()).named()}
    forces = {key: force for key, force in forces.items() if force.any()}
    total = sum(float(np.hypot(*force.T).sum()) for force in forces.values())
    weight = float(scene.mass[scene.masonry].sum() * np.hypot(*scene.load.gravity))
    if 0 < total < min(LEAST_FORCES, LEAST_SHARE * weight):
        yield f"{' and '.join(forces)}: {total:.3g} N is only {total / weight:.1%} of the wall's weight; are kN meant?"


def _ties(scene: Scene) -> Iterator[str]:
    """Warn about unusual tie parameters, and about ends fixed in space just beside the wall or in its openings."""
    ties = scene.ties
    for k, (young, area, most) in enumerate(zip(ties.young, ties.area, ties.yield_force, strict=True)):
        yield from OF_TIES.doubts(f"tie[{k}].young", young)
        yield from AREA.doubts(f"tie[{k}].area", area)
        if most / area > UNREAL_YIELD_STRESS and AREA.least <= area <= AREA.most:
            yield f"tie[{k}].yield = {most:g}: is a force, {most / area:.3g} Pa on the tie's area; is a stress meant?"
        elif most / area < LOW_YIELD_STRESS and AREA.least <= area <= AREA.most:
            yield f"tie[{k}].yield = {most:g}: is only {most / area:.3g} Pa on the tie's area; are {most:g} kN meant?"
    anchors = np.argwhere(ties.block == ANCHOR).tolist()
    wall = [shapely.Polygon(scene.blocks.polygon(int(b))) for b in np.flatnonzero(scene.wall)] if anchors else []
    for k, side in anchors:
        at = shapely.Point(ties.ends[k, side])
        away = float(shapely.distance(wall, at).min())
        if away > 0 and (away <= scene.block_size or shapely.GeometryCollection(wall).convex_hull.contains(at)):
            end = f"tie[{k}].{('from', 'to')[side]} = {ties.ends[k, side].tolist()}"
            yield f"{end}: is an anchor fixed in space, {away:.3g} m beside the wall; is a point on the wall meant?"


def _beam(scene: Scene) -> Iterator[str]:
    """Warn about a beam height or a prescribed beam displacement larger than the wall."""
    if scene.beam is None:
        return
    low, high = scene.blocks.extent(scene.masonry)
    longest, sizes = float(max(high - low)), {"beam.height": scene.beam.height}
    if scene.drive_path:
        sizes["beam.drive.displacement"] = max(map(abs, scene.drive_path))
    for key, size in sizes.items():
        if size > longest:
            yield f"{key} = {size:g}: is more than the wall's size, {longest:.3g} m; are mm meant?"


def _shaking(scene: Scene) -> Iterator[str]:
    """Warn about an unusual peak ground acceleration, or time step of a record."""
    if scene.history is not None:
        peak = float(np.hypot(*scene.history.peak))
        unit, meant = SHAKING.likely(peak, RECORDED_IN[scene.history.quantity])
        hint = f"; are its values in {unit}, which makes it {meant:.4g} {SHAKING.unit}?" if unit else ""
        yield from (line + hint for line in SHAKING.doubts("load.history, peak acceleration", peak))
        if scene.history.interval is None:
            yield from SAMPLING.doubts("load.history, time step", float(np.median(np.diff(scene.history.time))))


def _courses(scene: Scene) -> Iterator[str]:
    """Warn about blocks of a course at different levels, and a course that ends short of those above and below it."""
    own = scene.masonry
    low, high = (corner[own] for corner in scene.blocks.boxes)
    size = high - low
    full = scene.blocks.area[own] >= (1 - 1e-6) * size.prod(axis=1)
    levels = _distinct(low[:, 1], scene.blocks.tolerance)
    if full.mean() < RECTANGULAR_SHARE or 2 * len(levels) > max(len(full), 4):
        return
    beds = _distinct(low[full, 1], scene.blocks.tolerance)  # not of arch stones: their lowest corner lies on no bed
    gaps = np.diff(beds)
    close = np.flatnonzero(gaps < LEVEL_DIFFERENCE * size[full, 1].min())
    if len(close):
        gap, two = gaps[close[0]], beds[close[0] :][:2]
        low_y, high_y = (scene.blocks.coordinate(float(y), 6) for y in two)
        yield f"wall: courses do not line up: blocks stand at y = {low_y} and {high_y} m, {1e3 * gap:.3g} mm apart"
        return
    middle = (levels + np.append(levels[1:], high[:, 1].max())) / 2
    half = float(np.median(size[:, 0])) / 2 * (1 + 1e-6)
    there = [(low[:, 1] < y) & (y < high[:, 1]) for y in middle]
    for side, ends, sign in (("left", -low[:, 0], -1.0), ("right", high[:, 0], 1.0)):
        reach = np.array([ends[here].max(initial=-np.inf) for here in there])
        for k in np.flatnonzero(_short(reach, half)):
            x, y = (scene.blocks.coordinate(float(value)) for value in (sign * reach[k], middle[k]))
            what = f"the course there ends at x = {x} m on the {side}"
            yield f"wall: at y = {y} m: {what}, more than half a block short of its neighbours"


def _distinct(values: Array, tolerance: float) -> Array:
    """Values in ascending order; values that differ by at most a tolerance from the one before are dropped."""
    values = np.sort(values)
    return np.asarray(values[np.append(True, np.diff(values) > tolerance)])


def _short(reach: Array, half: float) -> Mask:
    """Mask of courses ``(n,)`` that end more than half a block short of both neighbours.

    The top and bottom course have one neighbour; they count only if all other courses end at about the same place.
    Gables, steps and openings at the side are several courses high, and therefore do not count.
    """
    if len(reach) < 3:
        return np.zeros(len(reach), dtype=np.bool_)
    inner = np.minimum(reach[:-2], reach[2:]) - reach[1:-1] > half
    first, last = (
        min(rest) - end > half and np.ptp(rest) <= half
        for rest, end in ((reach[1:], reach[0]), (reach[:-1], reach[-1]))
    )
    return np.concatenate([[first], inner, [last]])


def _head_joints(scene: Scene) -> Iterator[str]:
    """Warn if blocks stand side by side, but no two of them touch."""
    ends, own = scene.joints.ends, scene.masonry
    run = np.abs(ends[:, 1] - ends[:, 0])
    if (run[:, 1] > run[:, 0])[own[scene.joints.block].all(axis=1)].any():
        return
    low, high = (corner[own] for corner in scene.blocks.boxes)
    reach = UNINTENDED_GAP * np.median((high - low)[:, 0]) / 2 * np.array([1.0, 0.0])
    a, b = touching_boxes(low - reach, high + reach)
    beside = np.minimum(high[a], high[b]) - np.maximum(low[a], low[b])
    lower = np.minimum((high - low)[a, 1], (high - low)[b, 1])
    near = (a < b) & (beside[:, 1] > lower / 2) & (beside[:, 0] <= 0)
    if near.any():
        gap = f"{1e3 * float((-beside[near, 0]).max()):.3g} mm"
        yield f"wall: no head joint: blocks that stand side by side are up to {gap} apart, and nowhere touch"


CHECKS = (_sizes, _materials, _stones, _constant_forces, _ties, _beam, _shaking, _courses, _head_joints)
