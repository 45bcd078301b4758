"""The ladder of predictions: two hand formulas, and models that include more and more features."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from runningbond.joints.compiled import compilation
from runningbond.models import MODELS, Model
from runningbond.models.registry import EXTRAS, STIFFNESS
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError
from runningbond.scene.ranges import suggestion

from .formulas import formula
from .rig import Features
from .scores import has_cycles

PUSHED = Features(driven=False)


@dataclass(frozen=True, eq=False)
class Rung:
    """A model, and the features of walls that its scenes include."""

    model: Model
    features: Features
    base: str = ""  # name of the package's model; empty for hand formulas
    is_by_hand: bool = False

    @property
    def name(self) -> str:
        """Its name in tables."""
        return self.model.name

    def leaves_out(self, scene: Scene) -> str:
        """Why a wall is not predicted with this rung; empty if it is."""
        if self.base != "fem":
            return ""
        if has_cycles(scene.drive_path):
            return "left out: walls that are pushed to and fro take too long with it"
        rocks = scene.beam is not None and scene.beam.condition == "free"
        return (
            "left out: a wall that rocks goes beyond small displacements" if rocks and not self.model.is_finite else ""
        )


def _run(
    scene: Scene,
    tolerance: float,
    *,
    base: str,
    settings: Mapping[str, Any],
    observe: Callable[..., None] | None = None,
) -> Outcome:
    """Run a model of the package with given settings, and an observer if there is one, and measure the CPU time.

    The time excludes the compilation of kernels, which happens once per machine.
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
    model = Model(name, title, partial(formula, what=name), STIFFNESS, takes=EXTRAS, colour="0.45", marker="_")
    return Rung(model, PUSHED, is_by_hand=True)


def _rung(
    name: str, title: str, base: str, features: Features, colour: str, marker: str, line: Any = "-", **settings: Any
) -> Rung:
    solve = partial(_run, base=base, settings=settings)
    own: dict[str, Any] = {"colour": colour, "marker": marker, "line": line}
    own["is_finite"] = settings.get("displacements") == "finite"
    model = replace(MODELS[base], name=name, title=title, solve=solve, parameters=(), **own)
    return Rung(model, features, base)


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
    """Rungs by their names, separated by commas; all rungs if no names are given."""
    if names is None:
        return list(LADDER.values())
    found = []
    for name in dict.fromkeys(each.strip() for each in names.split(",")):
        if name not in LADDER:
            raise SceneError("--models", f"must be of {', '.join(LADDER)}{suggestion(name, list(LADDER))}", name)
        found.append(LADDER[name])
    return found
