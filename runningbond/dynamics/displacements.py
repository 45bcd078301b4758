"""Small or finite displacements, and what models do not support at finite ones."""

from typing import Literal, TypeAlias, get_args

from runningbond.scene import ANCHOR, Scene, SceneError
from runningbond.scene.ranges import ABOVE_ZERO, one_of

Displacements: TypeAlias = Literal["small", "finite"]
"""Whether equilibrium is that of the undeformed wall, or of the deformed wall."""


def are_finite(displacements: str, model: str, scene: Scene, distance: float | None = None) -> bool:
    """Whether displacements are finite.

    Raises a `SceneError` for an unknown kind of displacements, for finite ones together with ground motion, and for a
    `distance` [m] unless the live load pushes the wall at finite displacements.
    """
    key = f"model {model}: displacements"
    finite = one_of(key, displacements, get_args(Displacements)) == "finite"
    if finite and scene.history:
        raise SceneError(key, "is not supported where the ground moves, which walls follow far anyway", displacements)
    if distance is not None:
        key = f"model {model}: distance"
        ABOVE_ZERO.take(key, distance)
        if not finite or scene.is_led:
            what = "goes with finite displacements of a wall that its live load pushes alone; leave it out"
            raise SceneError(key, what, distance)
    return finite


def check_finite(scene: Scene) -> None:
    """Raise a `SceneError` for keys of the scene that models do not support at finite displacements."""
    for key in scene.extras:
        is_known = key in ("load.history", "tie") or key.startswith("load.live settlement")
        if not is_known and not ((scene.history or scene.drive_path) and key.startswith("beam")):
            leads = "a support settles" if scene.settlement else "live loads push a wall"
            where = f" where {leads}" if key.startswith("beam") else ""
            raise SceneError(key, f"is not supported at finite displacements{where}; leave it out")
    turns = scene.support_motion[:, 2] != 0
    if turns.any() and (scene.ties.block == ANCHOR).any() and (turns | ~scene.fixed).all():
        what = "is anchored while all of the ground turns, which is not supported at finite displacements; leave it out"
        raise SceneError("tie", what)
    if not scene.is_beam[scene.pins.block].all():
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
