"""The ladder that walls are predicted with: two formulas worked out by hand, and models with ever more in them."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from runningbond.joints.compiled import compilation
from runningbond.models import MODELS, Model
from runningbond.models.registry import EXTRAS, STIFFNESS
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError
from runningbond.scene.ranges import suggestion

from .rig import Features, pressed

PUSHED = Features(driven=False)
FORMULAS = ("rocking", "sliding")
"""Names of the two formulas that are worked out by hand."""

WHOLE = 0.5
"""Length of a bed, in lengths of the longest one, from which on a wall slides along it: openings part it."""


@dataclass(frozen=True, eq=False)
class Rung:
    """A model, with the features of a wall that it is handed."""

    model: Model
    features: Features
    base: str = ""  # the model of the package that it is; empty for what is worked out by hand
    is_finite: bool = False
    is_by_hand: bool = False

    @property
    def name(self) -> str:
        """What tables call it."""
        return self.model.name

    def leaves_out(self, scene: Scene, *, is_cyclic: bool) -> str:
        """Why a wall is not predicted with it; empty where it is."""
        if self.base != "fem":
            return ""
        if is_cyclic:
            return "left out: walls that are pushed to and fro take it too long"
        rocks = scene.beam is not None and scene.beam.condition == "free"
        return "left out: a wall that rocks goes beyond small displacements" if rocks and not self.is_finite else ""


def by_hand(scene: Scene) -> dict[str, float]:
    """What is worked out by hand: the forces [N] of `FORMULAS`."""
    beam = scene.beam
    if beam is None or beam.drive is None:
        raise SceneError("beam.drive", "is missing; the formulas are of walls that are pushed at a beam")
    (left, bottom), (right, _) = scene.blocks.extent(scene.wall)
    length, force = right - left, pressed(scene)
    height = scene.blocks.centroid[beam.block, 1] - bottom if beam.drive.at is None else beam.drive.at
    # A beam that does not turn bends the wall doubly: it presses on one corner of its top.
    lever = length / (2 * height) if beam.condition == "free" else length / height
    return dict(zip(FORMULAS, (force * lever, _sliding(scene, force)), strict=True))


def _sliding(scene: Scene, force: float) -> float:
    """N tan φ + c L t [N] of the bed along which that is least; of several materials each has its share of N."""
    joints, tolerance = scene.joints, scene.blocks.tolerance
    (x0, y0), (x1, y1) = joints.ends[:, 0].T, joints.ends[:, 1].T
    flat = np.flatnonzero(np.abs(y1 - y0) <= tolerance)
    order = flat[np.argsort(y0[flat], kind="stable")]
    beds = np.split(order, np.flatnonzero(np.diff(y0[order]) > tolerance) + 1)
    length = np.abs(x1 - x0)
    longest = max(float(length[bed].sum()) for bed in beds)
    friction, cohesion = np.array([(each.friction, each.cohesion) for each in scene.joint_materials]).T
    found = []
    for bed in beds:
        share, material = length[bed], scene.material_of_joint[bed]
        if share.sum() >= WHOLE * longest:
            mean = float(friction[material] @ share / share.sum())
            found.append(force * mean + float(cohesion[material] @ share) * scene.thickness)
    return min(found)


def _formula(scene: Scene, tolerance: float, *, what: str) -> Outcome:
    loads = by_hand(scene)
    load = loads.get(what, min(loads.values()))
    return Outcome(scene.title, what, "collapse", load, load, load, message="worked out by hand")


def _run(
    scene: Scene,
    tolerance: float,
    *,
    base: str,
    settings: Mapping[str, Any],
    observe: Callable[..., None] | None = None,
) -> Outcome:
    """Run a model of the package with some settings, and an observer if there is one, by the processor's clock.

    That stands still while kernels are compiled, which they are once on a machine.
    """
    watched = {} if observe is None else {"observe": observe}
    for key in settings:
        if key not in MODELS[base].parameters:
            raise SceneError(f"model {base}: {key}", "is not a parameter of it")
    with compilation() as compiled:
        start = time.process_time()
        outcome = MODELS[base].solve(scene, tolerance, **settings, **watched)
        return replace(outcome, seconds=time.process_time() - start - compiled.seconds)


def _hand(name: str, title: str) -> Rung:
    model = Model(name, title, partial(_formula, what=name), STIFFNESS, takes=EXTRAS, colour="0.45", marker="_")
    return Rung(model, PUSHED, is_by_hand=True)


def _rung(
    name: str, title: str, base: str, features: Features, colour: str, marker: str, line: Any = "-", **settings: Any
) -> Rung:
    solve = partial(_run, base=base, settings=settings)
    looks: dict[str, Any] = {"colour": colour, "marker": marker, "line": line}
    model = replace(MODELS[base], name=name, title=title, solve=solve, parameters=(), **looks)
    return Rung(model, features, base, settings.get("displacements") == "finite")


FINITE: dict[str, Any] = {"displacements": "finite"}
CRUSHES, SPLITS = Features(closes=True, crushes=True), Features(closes=True, crushes=True, splits=True)
CAPPED, DOTTED = replace(PUSHED, crushes=True), (0, (5, 1, 1, 1, 1, 1))

LADDER: dict[str, Rung] = {
    rung.name: rung
    for rung in (
        _hand("rocking", "the wall turns as one block: N L / (2 H₀)"),
        _hand("sliding", "it slides on a bed joint: N tan φ"),
        _hand("by-hand", "the smaller of the two"),
        _rung("limit", "limit analysis", "limit", PUSHED, "#606fc6", "o", "-."),
        _rung("limit-crushing", "limit analysis, toes crush", "limit", CAPPED, "#420697", "s", DOTTED),
        _rung("rigid", "rigid blocks, small displacements", "dem-dynamic", Features(), "#7cc7ba", "v", ":"),
        _rung("rigid-finite", "rigid blocks", "dem-dynamic", CRUSHES, "#349f8a", "^", **FINITE),
        _rung("rigid-splitting", "rigid blocks that split", "dem-dynamic", SPLITS, "#9b471c", "P", DOTTED, **FINITE),
        _rung(
            "fem-small",
            "deformable blocks that split, small displacements",
            "fem",
            replace(SPLITS, deformable=True),
            "#d08fb8",
            "d",
            "--",
            cells=2,
            modes=20,
        ),
        _rung(
            "fem-splitting",
            "deformable blocks that split",
            "fem",
            replace(SPLITS, deformable=True),
            "#7e2a55",
            "D",
            **FINITE,
        ),
        _rung(
            "fem-cracking",
            "deformable blocks that crack between all of their triangles, small displacements",
            "fem",
            replace(SPLITS, deformable=True, parts=4),
            "#12240a",
            "X",
            "-.",
            cells=4,
            cracks="blocks",
        ),
    )
}
"""Every rung by its name, the cheapest first."""


def find_rungs(names: str | None) -> list[Rung]:
    """Rungs by their names, separated by commas; all of them where none is given."""
    if names is None:
        return list(LADDER.values())
    found = []
    for name in dict.fromkeys(each.strip() for each in names.split(",")):
        if name not in LADDER:
            raise SceneError("--models", f"must be of {', '.join(LADDER)}{suggestion(name, list(LADDER))}", name)
        found.append(LADDER[name])
    return found
