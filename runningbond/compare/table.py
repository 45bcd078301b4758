"""Tables of a campaign: published values beside the bracket of every model, for the terminal, Markdown and CSV."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from homog import homog
from runningbond.campaigns import Campaign
from runningbond.models import Model
from runningbond.pictures.captions import is_force
from runningbond.pictures.sheet import Sheet, csv_lines
from runningbond.results import Outcome
from runningbond.results.outcome import SCALARS, number, two_digits
from runningbond.scene import Scene

from .published import BARALDI, PublishedCase

OWN = "Your scenes"
CORRECTED = "HOMO corrected, tan 30°"
ONE_NUMBER = 1e-3  # relative width up to which a bracket is printed as one number


@dataclass(frozen=True)
class Comparison:
    """Scenes by name, the models run on them, their outcomes, and the published cases by scene name."""

    scenes: Mapping[str, Scene]
    models: Sequence[Model]
    campaign: Campaign
    published: Mapping[str, PublishedCase] = field(default_factory=dict)

    def groups(self) -> dict[str, list[str]]:
        """Names of scenes by table title: one table per source, for own scenes one with λ and one with newtons."""
        groups: dict[str, list[str]] = {}
        for name, scene in self.scenes.items():
            own = f"{OWN}: load [N]" if is_force(scene) else OWN
            groups.setdefault(self.published[name].source if name in self.published else own, []).append(name)
        return groups

    def outcome(self, name: str, model: Model) -> Outcome | None:
        """The outcome of a model on a scene; None if there is none."""
        return self.campaign.outcomes.get((name, model.name))

    def cell(self, name: str, model: Model, text: Callable[[Outcome], str]) -> str:
        """Text of a table cell: `text` of the outcome, or "n/a" or "not run" if there is none."""
        if (outcome := self.outcome(name, model)) is not None:
            return text(outcome)
        return "n/a" if (name, model.name) in self.campaign.inapplicable else "not run"

    def printed(self, name: str) -> dict[str, float]:
        """Published values of a scene, and for Baraldi's panels the homogenised multiplier by the corrected formula."""
        if (case := self.published.get(name)) is None:
            return {}
        return case.printed | ({CORRECTED: corrected_homo(self.scenes[name])} if case.source == BARALDI else {})

    def labels(self, names: Iterable[str]) -> list[str]:
        """Labels of the published values of some scenes, without repetition."""
        return list(dict.fromkeys(label for name in names for label in self.printed(name)))

    def only_published(self) -> "Comparison":
        """The part of this comparison that concerns published scenes."""
        scenes = {name: scene for name, scene in self.scenes.items() if name in self.published}
        outcomes = {cell: outcome for cell, outcome in self.campaign.outcomes.items() if cell[0] in scenes}
        return replace(self, scenes=scenes, campaign=Campaign(outcomes))


def multiplier_sheets(comparison: Comparison) -> list[Sheet]:
    """Published values and brackets, one table per group of scenes."""
    sheets = []
    for title, names in comparison.groups().items():
        labels = comparison.labels(names)
        heads = ["title", *(x if x == CORRECTED else f"printed {x}" for x in labels)]
        cells = {name: [comparison.scenes[name].title, *_printed(comparison, name, labels)] for name in names}
        sheets.append(_sheet(comparison, title, heads, cells, answer))
    return sheets


def cost_sheets(comparison: Comparison) -> list[Sheet]:
    """Degrees of freedom, steps and seconds, one table per group of scenes."""
    sheets = []
    for title, names in comparison.groups().items():
        cells = {name: [str(comparison.scenes[name].count_blocks())] for name in names}
        title += ": degrees of freedom / steps / seconds"
        sheets.append(_sheet(comparison, title, ["blocks"], cells, _cost))
    return sheets


def _sheet(
    comparison: Comparison, title: str, heads: list[str], cells: Mapping[str, list[str]], text: Callable[[Outcome], str]
) -> Sheet:
    """Make a sheet with one row per scene: its name, its `cells`, and the text of each model's outcome."""
    models = comparison.models
    rows = [[name, *own, *(comparison.cell(name, model, text) for model in models)] for name, own in cells.items()]
    return Sheet(title, ["scene", *heads, *(model.name for model in models)], rows)


def csv_text(comparison: Comparison) -> str:
    """CSV table with one row per scene and model, the unit of the multiplier, and the published values of the scene."""
    labels = comparison.labels(comparison.scenes)
    scalars = [key for key in SCALARS if key not in ("scene", "model")]
    heads = ["scene", "title", "source", "blocks", "model", "unit", *scalars, *(f"printed {label}" for label in labels)]
    rows: list[Sequence[object]] = [heads]
    for source, names in comparison.groups().items():
        for (name, printed), model in product(((x, comparison.printed(x)) for x in names), comparison.models):
            scene, outcome = comparison.scenes[name], comparison.outcome(name, model)
            values: Mapping[str, object] = {"status": "not run"}
            if outcome is not None:
                values = outcome.summary()
            elif (reason := comparison.campaign.inapplicable.get((name, model.name))) is not None:
                values = {"status": "not applicable", "message": reason}
            own = [name, scene.title, source, scene.count_blocks(), model.name, "N" if is_force(scene) else "1"]
            rows.append([*own, *map(values.get, scalars), *map(printed.get, labels)])
    return csv_lines(rows)


def corrected_homo(scene: Scene) -> float:
    """Homogenised multiplier by the corrected Eq. (6), with tan 30°, as used for the paper's column."""
    multiplier = homog(scene.with_joint(friction=math.tan(math.radians(30)))).multiplier
    assert multiplier is not None  # homog returns a multiplier or raises SceneError
    return multiplier


def _printed(comparison: Comparison, name: str, labels: Iterable[str]) -> list[str]:
    """Published values of a scene by label, with three decimals as in the papers; empty if there is none."""
    values = {x: number(y) if x == CORRECTED else f"{y:.3f}" for x, y in comparison.printed(name).items()}
    return [values.get(label, "") for label in labels]


def answer(outcome: Outcome) -> str:
    """Result of an outcome for tables: the bracket if it is a collapse, otherwise the status followed by its bounds."""
    return bracket(outcome) if outcome.status == "collapse" else f"{outcome.status} {bracket(outcome)}".strip()


def bracket(outcome: Outcome) -> str:
    """Bracket of an outcome for tables, as one number if not wider than `ONE_NUMBER`; empty if there is none."""
    lower, upper, multiplier = outcome.lower, outcome.upper, outcome.multiplier
    if lower is not None and upper is not None and upper - lower > ONE_NUMBER * abs(upper):
        return f"{number(lower)} – {number(upper)}"
    if multiplier is not None:
        return number(multiplier)
    if upper is not None:
        return f"≤ {number(upper)}"
    return "" if lower is None else f"≥ {number(lower)}"


def _cost(outcome: Outcome) -> str:
    dofs, steps = ("–" if count is None else str(count) for count in (outcome.dofs, outcome.steps))
    return f"{dofs} / {steps} / {two_digits(outcome.seconds)}"
