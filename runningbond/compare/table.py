"""Tables of a campaign: printed values beside every model's bracket, for the terminal, Markdown and CSV."""

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from rich.table import Table as RichTable
from rich.text import Text

from homog import homog
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene, SceneError

from .campaign import Campaign
from .published import BARALDI, PublishedCase

OWN = "Your scenes"
CORRECTED = "HOMO corrected, tan 30°"
ALIKE = 1e-3
"""Relative width below which a bracket is printed as one number."""


@dataclass(frozen=True)
class Sheet:
    """One table: a title, column heads and rows of cells."""

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]

    def markdown(self) -> str:
        """The table in Markdown, under its title."""
        lines = [f"### {self.title}", "", _line(self.heads), _line(["---"] * len(self.heads))]
        return "\n".join([*lines, *map(_line, self.rows), ""])

    def terminal(self) -> RichTable:
        """The table for rich's console."""
        table = RichTable(title=Text(self.title), title_justify="left")
        for head in self.heads:
            table.add_column(Text(head))
        for row in self.rows:
            table.add_row(*map(Text, row))
        return table


@dataclass(frozen=True)
class Comparison:
    """Scenes, the models run on them, what came out, and which of the scenes are published ones.

    Parameters
    ----------
    scenes
        Scenes by name.
    models
        Names of the models.
    campaign
        Their outcomes.
    published
        Published cases by the names of their scenes.
    """

    scenes: Mapping[str, Scene]
    models: Sequence[str]
    campaign: Campaign
    published: Mapping[str, PublishedCase] = field(default_factory=dict)

    def by_source(self) -> dict[str, list[str]]:
        """Names of scenes by where they were published."""
        groups: dict[str, list[str]] = {}
        for name in self.scenes:
            source = self.published[name].source if name in self.published else OWN
            groups.setdefault(source, []).append(name)
        return groups

    def printed(self, name: str) -> dict[str, float]:
        """Values printed for a scene, and the homogenised one as its formula should read."""
        case = self.published.get(name)
        if case is None:
            return {}
        corrected = {CORRECTED: corrected_homo(self.scenes[name])} if case.source == BARALDI else {}
        return {**case.printed, **corrected}


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def multiplier_sheets(comparison: Comparison) -> list[Sheet]:
    """Printed values and brackets, one table a source."""
    scenes, models, campaign = comparison.scenes, comparison.models, comparison.campaign
    sheets = []
    for source, names in comparison.by_source().items():
        labels = _labels(comparison, names)
        heads = ["scene", "title", *(x if x == CORRECTED else f"printed {x}" for x in labels), *models]
        rows = []
        for name in names:
            values = comparison.printed(name)
            cells = [_printed_number(label, values) for label in labels]
            rows.append([name, scenes[name].title, *cells, *(_cell(campaign, name, model) for model in models)])
        sheets.append(Sheet(source, heads, rows))
    return sheets


def cost_sheets(comparison: Comparison) -> list[Sheet]:
    """Degrees of freedom, steps and seconds, one table a source."""
    scenes, models, campaign = comparison.scenes, comparison.models, comparison.campaign
    return [
        Sheet(
            f"{source}: degrees of freedom / steps / seconds",
            ["scene", "blocks", *models],
            [
                [name, str(int(scenes[name].wall.sum())), *(_cost(campaign, name, model) for model in models)]
                for name in names
            ],
        )
        for source, names in comparison.by_source().items()
    ]


def csv_text(comparison: Comparison) -> str:
    """One row a scene and model, with the printed values of the scene."""
    scenes, models, campaign = comparison.scenes, comparison.models, comparison.campaign
    labels = _labels(comparison, list(scenes))
    scalars = [key for key in Outcome("", "", "undecided").summary() if key not in ("scene", "model")]
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(["scene", "title", "source", "blocks", "model", *scalars, *(f"printed {x}" for x in labels)])
    for source, names in comparison.by_source().items():
        for name in names:
            scene, printed = scenes[name], comparison.printed(name)
            for model in models:
                outcome = campaign.outcomes.get((name, model))
                found = outcome.summary() if outcome else _nothing(campaign, name, model)
                writer.writerow(
                    [name, scene.title, source, int(scene.wall.sum()), model]
                    + [found.get(key) for key in scalars]
                    + [printed.get(label) for label in labels]
                )
    return buffer.getvalue()


def _labels(comparison: Comparison, names: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(label for name in names for label in comparison.printed(name)))


def _nothing(campaign: Campaign, name: str, model: str) -> dict[str, str]:
    reason = campaign.inapplicable.get((name, model))
    return {"status": "not run"} if reason is None else {"status": "not applicable", "message": reason}


def corrected_homo(scene: Scene) -> float:
    """Homogenised multiplier by the corrected Eq. (6), with the tan 30° the paper's column was computed with."""
    friction = math.tan(math.radians(30))
    multiplier = homog(replace(scene, joint=replace(scene.joint, friction=friction))).multiplier
    if multiplier is None:  # pragma: no cover - homog answers or refuses
        raise SceneError("model homog", "found no multiplier")
    return multiplier


def _printed_number(label: str, values: Mapping[str, float]) -> str:
    """A printed value with the three decimals that papers give, or nothing."""
    if label not in values:
        return ""
    return number(values[label]) if label == CORRECTED else f"{values[label]:.3f}"


def _cell(campaign: Campaign, name: str, model: str) -> str:
    if (name, model) in campaign.inapplicable:
        return "n/a"
    outcome = campaign.outcomes.get((name, model))
    if outcome is None:
        return "not run"
    return answer(outcome)


def answer(outcome: Outcome) -> str:
    """Answer of an outcome as tables print it: the bracket of a collapse, any other status before what is known."""
    found = bracket(outcome)
    return found if outcome.status == "collapse" else f"{outcome.status} {found}".strip()


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


def _cost(campaign: Campaign, name: str, model: str) -> str:
    outcome = campaign.outcomes.get((name, model))
    if outcome is None:
        return "n/a" if (name, model) in campaign.inapplicable else "not run"
    dofs = "–" if outcome.dofs is None else str(outcome.dofs)
    steps = "–" if outcome.steps is None else str(outcome.steps)
    return f"{dofs} / {steps} / {float(f'{outcome.seconds:.2g}'):g}"
