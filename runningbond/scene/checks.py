"""Whether a scene can be analysed: its blocks stand on something, and its loads act on something that moves."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import shapely

from .actions import Action
from .arrays import Mask, components
from .errors import SceneError, keys_of
from .forces import Forces
from .materials import table_of
from .scene import Scene
from .settlement import Settlement

CANCELLATION = 1e-12
"""Sum of the live loads on a block, relative to the largest of one load on any block, up to which it counts as 0."""

SMALL_GAP = 0.3
"""Largest gap, in block sizes, that may be a survey inaccuracy or a mortar joint left out of the drawing."""


def check_built(scene: Scene) -> None:
    """Raise a `SceneError` for a scene that cannot be analysed."""
    if scene.fixed.all():
        raise SceneError("support.kind", "holds every block; give the wall more than one course", "fixed-first-course")
    _refuse_floating_blocks(scene)
    for k, material in enumerate(scene.joint_materials):
        too_short = scene.joints.too_short_for(material.inset) & (scene.material_of_joint == k)
        too_short &= ~scene.joints.at_corner
        if too_short.any():
            length = scene.joints.length[too_short].min()
            what = f"must be less than half the shortest joint, {length:.4g} m long"
            raise SceneError(f"{table_of(material)}.inset", what, material.inset)
    if not scene.load.live:
        raise SceneError("load.live", "is missing: nothing is multiplied by λ")
    if scene.is_led and len(scene.load.live) > 1:
        driven = scene.beam is not None and scene.beam.drive is not None
        what = "be left out where the beam is moved by a" if driven else "be the settlement alone, for it is a"
        raise SceneError("load.live", f"must {what} displacement")
    if scene.history and len(scene.load.live) > 1:
        raise SceneError("load.live", "does not go with load.history, which is what λ multiplies; leave one out")
    for key, load in scene.load.named():
        load.check(scene, key)
        if isinstance(load, Settlement):
            continue
        with keys_of(key, "load.live"), _own_errors(f"{key}: {type(load).__name__}.forces"):
            forces = load.forces(scene)
        _check_forces(scene, key, load, forces)
    if len(scene.load.live) > 1 and _cancel(scene):
        raise SceneError("load.live", "must not cancel out on every block: nothing is multiplied by λ")


@contextmanager
def _own_errors(key: str) -> Iterator[None]:
    """Convert errors in the code of a user's load into a `SceneError` under a key: only that load is at fault."""
    try:
        yield
    except SceneError:
        raise
    except Exception as error:
        raise SceneError(key, f"raises {type(error).__name__}: {error}") from error


def _check_forces(scene: Scene, key: str, load: Action, forces: object) -> None:
    """Refuse a load whose forces are not of type `Forces`, not finite, or all zero on movable blocks."""
    own = f"{key}: {type(load).__name__}.forces"
    if not isinstance(forces, Forces):
        raise SceneError(own, "must return Forces", forces)
    count, points = len(scene.blocks), np.size(forces.block)
    expected = [(count, 2), (count,), (points,), (points, 2), (points, 2)]
    parts = forces.acceleration, forces.moment, forces.block, forces.at, forces.force
    if [part.shape for part in parts] != expected:
        raise SceneError(own, f"must return Forces.on the scene: of {count} blocks, and as many points as forces")
    if points and not 0 <= forces.block.min() <= forces.block.max() < count:
        raise SceneError(own, f"must name blocks by numbers, 0 … {count - 1}", forces.block.tolist())
    moves = ~scene.fixed
    felt = forces.acceleration[moves], forces.moment[moves], forces.force[moves[forces.block]]
    if not 0 < sum(float(np.abs(part).sum()) for part in felt) < np.inf:
        raise SceneError(key, "must put finite forces on the blocks, not all of them zero on those that move", load)


def _cancel(scene: Scene) -> bool:
    """Whether the live loads cancel out: no resulting force and no moment on any movable block."""
    each = [load.forces(scene).resultants(scene) for load in scene.load.live]
    most = np.max(np.abs(each), axis=(0, 1))
    return bool((np.abs(np.sum(each, axis=0)) <= CANCELLATION * most)[~scene.fixed].all())


def _refuse_floating_blocks(scene: Scene) -> None:
    """Refuse movable blocks that no chain of joints connects to anything fixed or pinned."""
    component = components(scene.joints.block, len(scene.blocks))
    held = np.union1d(np.flatnonzero(scene.fixed), scene.pins.block[scene.pins.direction.any(axis=1)])
    floating = ~np.isin(component, component[held])
    if floating.any():
        remedy = "is a floating block: no joint joins it to the support"
        raise SceneError(scene.blocks.name(int(np.argmax(floating))), remedy + _gap_to(scene, floating))


def _gap_to(scene: Scene, floating: Mask) -> str:
    """Part of an error message on the gap between floating blocks ``(nb,)`` and the others; empty if it is wide."""
    free, standing = (shapely.union_all(scene.blocks.shapes(np.flatnonzero(which))) for which in (floating, ~floating))
    gap = float(shapely.distance(free, standing))
    if not 0 < gap < SMALL_GAP * scene.block_size:
        return ""
    bridged = f"joints bridge {scene.blocks.tolerance:.2g} m"
    remedy = "in drawings and outlines wall.heal closes gaps, and wall.expand fills those with mortar in them"
    return f" over a gap of {gap:.3g} m, and {bridged}; {remedy}"
