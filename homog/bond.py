"""Check whether a wall's blocks are laid in running bond, from its joints."""

import numpy as np

from runningbond.scene import Bond, Mask, Scene

PLACE_TOLERANCE = 1e-3
"""Tolerance, in half blocks, on the horizontal positions of head joints and on the lengths of bed joints."""


def between_blocks(scene: Scene) -> Mask:
    """Mask ``(nj,)`` of joints between two blocks of the wall: none on its ground, under its beam or inside a block."""
    return np.asarray(scene.masonry[scene.joints.block].all(axis=1) & ~scene.joints.inner)


def head_places(scene: Scene, bond: Bond, heads: Mask, among: Mask) -> set[tuple[int, int]] | None:
    """Positions of the head joints `heads`, in half blocks from the left and courses from the bottom of blocks `among`.

    None if the middle of a head joint lies horizontally off the half-block grid.
    """
    low, _ = scene.blocks.extent(among)
    middle = (scene.joints.ends[heads].mean(axis=1) - low) / np.array([bond.width / 2, bond.height])
    column, course = np.rint(middle[:, 0]).astype(int), np.floor(middle[:, 1]).astype(int)
    if not np.allclose(column, middle[:, 0], rtol=0, atol=PLACE_TOLERANCE):
        return None
    return set(zip(column.tolist(), course.tolist(), strict=True))


def is_running_bond(scene: Scene, bond: Bond) -> bool:
    """Whether blocks overlap by half a block everywhere: heads shifted by that much, no bed joint longer than that.

    Ends may be toothed and openings cut out.
    """
    between, beds = between_blocks(scene), scene.joints.is_bed
    places = head_places(scene, bond, between & ~beds, scene.masonry)
    overlaps = scene.joints.length[between & beds] / (bond.width / 2)
    if not places or not len(overlaps):
        return False
    return len({sum(place) % 2 for place in places}) == 1 and bool(overlaps.max() < 1 + PLACE_TOLERANCE)
