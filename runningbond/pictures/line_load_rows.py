"""Rows of arrows of line loads, and chains of loads whose rows are drawn as one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
import shapely.affinity

from runningbond.scene import Array, LineLoad, Scene
from runningbond.scene.actions import unit_vector
from runningbond.scene.arrays import components

from .deformed_shape import DeformedShape

MIN_ARROW = 0.4
"""Arrow length of a vanishing line load relative to that of the largest line load; linear in between."""

CHAIN_COSINE = 0.5
"""Cosine of the largest angle between two line loads with a common end, and between their forces, in one chain."""

SHEAR_COSINE = 0.97
"""Cosine of the angle between a line and its force from which on the arrows lie beside the line."""


@dataclass(frozen=True, eq=False)
class Row:
    """The arrows of a line load under a bar, or along the line if the force is parallel to it."""

    tails: Array  # (n, 2) ends of the arrows [m],
    tips: Array  # (n, 2)
    strip: shapely.Geometry  # the area that they cover
    away: Array  # (2,) directions away from the wall: that of the label,
    outward: Array  # and that across the line, in which the row may be moved
    is_shear: bool
    outside: bool  # on a face of the wall, and not in its middle

    def overlaps(self, strip: shapely.Geometry) -> bool:
        """Whether the arrows cover a part of another strip."""
        return bool(shapely.area(self.strip & strip) > 1e-9 * self.strip.area)

    def moved(self, way: float) -> "Row":
        """The row, moved outwards by a way [m] if it is outside the wall."""
        by = way * self.outward * self.outside
        return replace(
            self, tails=self.tails + by, tips=self.tips + by, strip=shapely.affinity.translate(self.strip, *by)
        )


def row_of(load: LineLoad, shape: DeformedShape, a: float, largest: float) -> Row:
    """The arrows of a line load on a shape, where they are drawn if nothing is in their way.

    Their size goes by the unit `a` of the drawing [m], and by the largest line load [N/m].
    """
    scene, direction = shape.scene, unit_vector(np.array(load.force))
    block, parts = load.parts(scene)
    run = np.subtract(load.end, load.start)
    along = run / np.hypot(*run)
    share = MIN_ARROW + (1 - MIN_ARROW) * math.hypot(*load.force) / largest
    n = int(np.clip(np.hypot(*run) / (1.5 * a) + 1, 2, 60))
    places = np.linspace(0.0, 1.0, n)
    of = block[np.minimum(np.searchsorted(parts[:, 1], places), len(block) - 1)]
    tips = np.array([shape.drawn_at(*at) for at in zip(np.array(load.start) + places[:, None] * run, of, strict=True)])
    middle = np.add(load.start, load.end) / 2
    is_shear = abs(along @ direction) > SHEAR_COSINE
    across = np.array([-along[1], along[0]])
    away = across if is_shear else -direction
    beyond, before = (is_in_wall(scene, middle + side * 0.5 * a * away) for side in (1, -1))
    if beyond and not before:
        away = -away
    outside = not (beyond and before)
    if is_shear and outside:
        tips = tips + 0.6 * a * away
    elif not is_shear and away @ direction > 0:  # it pulls
        tips = tips + 1.5 * share * a * direction
    tails = tips - (0.9 if is_shear else 1.5) * share * a * direction
    both = np.concatenate([tails, tips])
    air = 0.35 * a * away if is_shear else np.zeros(2)
    inner = 1e-3 * (np.mean(both @ along) - both @ along)[:, None] * along  # so that rows of two chains may adjoin
    strip = shapely.MultiPoint(np.concatenate([both - air, both + air]) + np.tile(inner, (2, 1))).convex_hull
    outward = math.copysign(1.0, across @ away) * across
    return Row(tails, tips, strip, away, outward, is_shear, outside)


def is_in_wall(scene: Scene, at: Array) -> bool:
    """Whether a point lies in the undeformed wall: the outer side of a face stays the same as the wall moves."""
    found = scene.blocks.containing(at)
    return bool(scene.wall[found].any())


def chains_of(loads: Sequence[LineLoad], reach: float) -> list[list[int]]:
    """Numbers of the line loads of each chain: loads that adjoin end to end, to within `reach` [m].

    Neither the line nor the force turns sharply, and loads along the same line are in different chains.
    """
    if not loads:
        return []
    ends = np.array([(each.start, each.end) for each in loads]).reshape(-1, 2, 2)
    away = (ends[:, ::-1] - ends) / np.hypot(*(ends[:, 1] - ends[:, 0]).T)[:, None, None]
    apart = np.abs(ends[:, None, :, None] - ends[None, :, None, :]).max(axis=4)
    straight = np.einsum("aik,bjk->abij", away, away) < -CHAIN_COSINE
    force = np.array([unit_vector(np.array(each.force)) for each in loads])
    adjoin = ((apart <= reach) & straight).any(axis=(2, 3)) & (force @ force.T > CHAIN_COSINE)
    number = components(np.argwhere(adjoin), len(loads))
    lines = [shapely.LineString(each) for each in ends]
    return [
        chain for each in np.unique(number) for chain in _apart(np.flatnonzero(number == each).tolist(), lines, reach)
    ]


def _apart(numbers: Sequence[int], lines: Sequence[shapely.LineString], reach: float) -> list[list[int]]:
    """Numbers of lines in as few groups as it takes so that none run along each other for more than `reach` [m]."""
    groups = list[list[int]]()
    for k in numbers:
        free = (group for group in groups if all(shapely.length(lines[k] & lines[m]) <= reach for m in group))
        group = next(free, None)
        if group is None:
            groups.append(group := [])
        group.append(k)
    return groups
