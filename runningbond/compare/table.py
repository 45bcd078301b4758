"""Tables of a campaign: printed values beside every model's bracket, for the terminal, Markdown and CSV."""

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
ALIKE = 1e-3  # relative width below which a bracket is printed as one number


@dataclass(frozen=True)
class Comparison:
    """Scenes by name, the models run on them, what came out, and the published cases by the names of their scenes."""

    scenes: Mapping[str, Scene]
    models: Sequence[Model]
    campaign: Campaign
    published: Mapping[str, PublishedCase] = field(default_factory=dict)

    def groups(self) -> dict[str, list[str]]:
        """Names of scenes by the table they stand in: one a source, and λ and newtons apart."""
        groups: dict[str, list[str]] = {}
        for name, scene in self.scenes.items():
            own = f"{OWN}: load [N]" if is_force(scene) else OWN
            groups.setdefault(self.published[name].source if name in self.published else own, []).append(name)
        return groups

    def outcome(self, name: str, model: Model) -> Outcome | None:
        """The outcome of a model on a scene."""
        return self.campaign.outcomes.get((name, model.name))

    def cell(self, name: str, model: Model, text: Callable[[Outcome], str]) -> str:
        """A cell of a table: the text of an outcome, or why there is none."""
        if (outcome := self.outcome(name, model)) is not None:
            return text(outcome)
        return "n/a" if (name, model.name) in self.campaign.inapplicable else "not run"

    def printed(self, name: str) -> dict[str, float]:
        """Values printed for a scene, and the homogenised one as its formula should read."""
        if (case := self.published.get(name)) is None:
            return {}
        return case.printed | ({CORRECTED: corrected_homo(self.scenes[name])} if case.source == BARALDI else {})

    def labels(self, names: Iterable[str]) -> list[str]:
        """What the values printed for some scenes are called."""
        return list(dict.fromkeys(label for name in names for label in self.printed(name)))

    def only_published(self) -> "Comparison":
        """The part of it that is about published scenes."""
        scenes = {name: scene for name, scene in self.scenes.items() if name in self.published}
        outcomes = {cell: outcome for cell, outcome in self.campaign.outcomes.items() if cell[0] in scenes}
        return replace(self, scenes=scenes, campaign=Campaign(outcomes))


def multiplier_sheets(comparison: Comparison) -> list[Sheet]:
    """Printed values and brackets, one table a group of scenes."""
    sheets = []
    for title, names in comparison.groups().items():
        labels = comparison.labels(names)
        heads = ["title", *(x if x == CORRECTED else f"printed {x}" for x in labels)]
        cells = {name: [comparison.scenes[name].title, *_printed(comparison, name, labels)] for name in names}
        sheets.append(_sheet(comparison, title, heads, cells, answer))
    return sheets


def cost_sheets(comparison: Comparison) -> list[Sheet]:
    """Degrees of freedom, steps and seconds, one table a group of scenes."""
    sheets = []
    for title, names in comparison.groups().items():
        cells = {name: [str(int(comparison.scenes[name].wall.sum()))] for name in names}
        title += ": degrees of freedom / steps / seconds"
        sheets.append(_sheet(comparison, title, ["blocks"], cells, _cost))
    return sheets


def _sheet(
    comparison: Comparison, title: str, heads: list[str], cells: Mapping[str, list[str]], text: Callable[[Outcome], str]
) -> Sheet:
    """A row a scene: its name, the cells that are its own, and the text of each model's outcome."""
    models = comparison.models
    rows = [[name, *own, *(comparison.cell(name, model, text) for model in models)] for name, own in cells.items()]
    return Sheet(title, ["scene", *heads, *(model.name for model in models)], rows)


def csv_text(comparison: Comparison) -> str:
    """One row a scene and model, with the unit of its multiplier and the printed values of the scene."""
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
            own = [name, scene.title, source, int(scene.wall.sum()), model.name, "N" if is_force(scene) else "1"]
            rows.append([*own, *map(values.get, scalars), *map(printed.get, labels)])
    return csv_lines(rows)


def corrected_homo(scene: Scene) -> float:
    """Homogenised multiplier by the corrected Eq. (6), with the tan 30° the paper's column was computed with."""
    multiplier = homog(scene.with_joint(friction=math.tan(math.radians(30)))).multiplier
    assert multiplier is not None  # it answers or refuses
    return multiplier


def _printed(comparison: Comparison, name: str, labels: Iterable[str]) -> list[str]:
    """Values printed for a scene, by label, with the three decimals that papers give; empty where there is none."""
    values = {x: number(y) if x == CORRECTED else f"{y:.3f}" for x, y in comparison.printed(name).items()}
    return [values.get(label, "") for label in labels]


def answer(outcome: Outcome) -> str:
    """Answer of an outcome as tables print it: the bracket of a collapse, any other status before its bounds."""
    return bracket(outcome) if outcome.status == "collapse" else f"{outcome.status} {bracket(outcome)}".strip()


def bracket(outcome: Outcome) -> str:
    """Bracket of an outcome as tables print it, as one number where it is that narrow; empty without one."""
    lower, upper, multiplier = outcome.lower, outcome.upper, outcome.multiplier
    if lower is not None and upper is not None and upper - lower > ALIKE * abs(upper):
        return f"{number(lower)} – {number(upper)}"
    if multiplier is not None:
        return number(multiplier)
    if upper is not None:
        return f"≤ {number(upper)}"
    return "" if lower is None else f"≥ {number(lower)}"


def _cost(outcome: Outcome) -> str:
    dofs, steps = ("–" if count is None else str(count) for count in (outcome.dofs, outcome.steps))
    return f"{dofs} / {steps} / {two_digits(outcome.seconds)}"
