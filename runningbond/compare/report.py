"""The report of a comparison: verdict, coloured tables, charts, one card per wall, and the versions used."""

import platform
import statistics
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from importlib.metadata import version
from typing import Any

from markupsafe import Markup
from matplotlib.figure import Figure

from runningbond.campaigns.fingerprint import LIBRARIES, code_digest
from runningbond.pictures.captions import is_force, load_symbol, multiplier_text
from runningbond.pictures.deformed_shape import common_extent, undeformed_shape
from runningbond.pictures.inline import inline_mechanism, inline_wall
from runningbond.pictures.mechanism import mechanism_shape, mechanism_warning
from runningbond.pictures.moments import farthest_shape, moving_wall
from runningbond.pictures.quantities import counted
from runningbond.pictures.sheet import Sheet
from runningbond.results import Outcome
from runningbond.results.outcome import joined, number, two_digits

from .figures import wall_curves
from .page import inline_svg, templates
from .table import CORRECTED, Comparison, answer, cost_sheets, multiplier_sheets

DRAWN_WITH = ("pyvista", "vtk", "matplotlib", "jinja2")
FULL_COLOUR, OPACITY, AGREEMENT, LISTED = 0.3, 0.55, 0.05, 4
"""Relative deviation with the strongest colour, opacity of that colour, largest relative spread that counts as
agreement, and number of the largest disagreements that are listed."""

CONTENTS = (
    ("verdict", "Verdict"),
    ("multipliers", "Collapse multipliers"),
    ("charts", "Charts"),
    ("walls", "Wall by wall"),
)
CLOSING = ("cost", "Cost"), ("provenance", "What was run")


class Cell(str):
    """A table cell: its text, a number to sort by, the opacity of its colour (negative below a median), its link."""

    value: float | None = None
    heat = 0.0
    link = ""


def report_html(comparison: Comparison, charts: Mapping[str, Figure], tolerance: float) -> str:
    """Render the page; `charts` are keyed by file name without suffix."""
    drawn = {name: inline_svg(figure, name) for name, figure in charts.items()}
    walls = [(f"wall-{name}", name) for name in comparison.scenes]
    contents = [entry for entry in CONTENTS if entry[0] != "charts" or drawn]
    page = templates().get_template("report.html")
    return page.render(
        subject="comparison",
        contents=[*contents, *walls, *CLOSING],
        verdict=verdict(comparison),
        full=f"{FULL_COLOUR:.0%}",
        multipliers=[_coloured(comparison, sheet) for sheet in multiplier_sheets(comparison)],
        charts=drawn,
        cards=[_card(comparison, name) for name in comparison.scenes],
        costs=cost_sheets(comparison),
        provenance=Sheet("Versions", ("what", "which"), _versions(comparison, tolerance)),
    )


def loads(comparison: Comparison, name: str) -> dict[str, float]:
    """Collapse loads of a wall by model name, for models of blocks (no estimates) that found one."""
    outcomes = {x.name: comparison.outcome(name, x) for x in comparison.models if x.kind != "estimate"}
    return {model: x.multiplier for model, x in outcomes.items() if x is not None and x.multiplier is not None}


def verdict(comparison: Comparison) -> list[str]:
    """Summarise the campaign: number of decided cases, where models agree, and where they differ most."""
    said = Counter(outcome.status for outcome in comparison.campaign.outcomes.values())
    rest = "".join(f", {count} {status}" for status, count in said.most_common() if status != "collapse")
    rest += f", {k} have a model that does not apply" if (k := len(comparison.campaign.inapplicable)) else ""
    sizes = (len(comparison.campaign), "case"), (len(comparison.scenes), "wall"), (len(comparison.models), "model")
    cases, walls, models = (counted(*size) for size in sizes)
    sentences = [f"{cases}: {walls} by {models}. {said['collapse']} end in a collapse load{rest}."]
    found = {name: own for name in comparison.scenes if len(own := loads(comparison, name)) > 1 and min(own.values())}
    spread = {name: max(own.values()) / min(own.values()) - 1 for name, own in found.items()}
    if spread:
        near = sum(x <= AGREEMENT for x in spread.values())
        sentences.append(f"Models of blocks agree within {AGREEMENT:.0%} on {near} of {counted(len(spread), 'wall')}.")
        worst = [_apart(found[x], x) for x in _largest(spread) if spread[x] > AGREEMENT]
        sentences[-1] += f" They differ most on {'; '.join(worst)}." if worst else ""
    printed = {
        f"{name}: {label} printed as {number(x)}, median {number(median)}": abs(x / median - 1)
        for name, own in found.items()
        for label, x in comparison.printed(name).items()
        if label != CORRECTED and (median := statistics.median(own.values()))
    }
    if printed:
        sentences.append(
            f"Printed values lie farthest from the median of the models on {'; '.join(_largest(printed))}."
        )
    return sentences


def _largest(sizes: Mapping[str, float]) -> list[str]:
    return sorted(sizes, key=lambda name: -sizes[name])[:LISTED]


def _apart(found: Mapping[str, float], name: str) -> str:
    low, high = min(found, key=lambda x: found[x]), max(found, key=lambda x: found[x])
    return f"{name} ({low} {number(found[low])}, {high} {number(found[high])})"


def _coloured(comparison: Comparison, sheet: Sheet) -> Sheet:
    """Convert the entries of a sheet of multipliers to cells, coloured by the deviation from the wall's median."""
    rows = []
    for row in sheet.rows:
        name, found = row[0], loads(comparison, row[0])
        values = {x.name: o.multiplier for x in comparison.models if (o := comparison.outcome(name, x)) is not None}
        values |= {x if x == CORRECTED else f"printed {x}": y for x, y in comparison.printed(name).items()}
        median = statistics.median(found.values()) if found else 0.0
        cells = [Cell(text) for text in row]
        cells[0].link = f"wall-{name}"
        for head, cell in zip(sheet.heads[1:], cells[1:], strict=True):
            cell.value = values.get(head)
            off = (cell.value / median - 1) / FULL_COLOUR if cell.value is not None and median else 0.0
            cell.heat = max(-1.0, min(off, 1.0)) * OPACITY
        rows.append(cells)
    return replace(sheet, rows=rows)


def _card(comparison: Comparison, name: str) -> dict[str, Any]:
    """Template variables of a wall's card: mechanisms side by side, curves, and result and cost of each model."""
    scene = comparison.scenes[name]

    def said(outcome: Outcome) -> str:
        return joined(outcome.message, mechanism_warning(scene, outcome))

    outcomes = {x.name: outcome for x in comparison.models if (outcome := comparison.outcome(name, x)) is not None}
    shapes = {model: shape for model, x in outcomes.items() if (shape := mechanism_shape(scene, x)) is not None}
    moved = [x for x in outcomes.values() if len(x.moments)]
    extent = common_extent([undeformed_shape(scene), *shapes.values(), *(farthest_shape(scene, x) for x in moved)])
    rest = f"rest-{list(comparison.scenes).index(name)}"  # a wall may have any name
    told = {model: " ".join(multiplier_text(scene, outcomes[model])).strip() for model in shapes}
    mechanisms = [(x, Markup(inline_mechanism(shape, extent, rest)), told[x]) for x, shape in shapes.items()]
    figure = wall_curves(comparison, name)
    load = f"{load_symbol(scene)} [N]" if is_force(scene) else load_symbol(scene)
    heads = ("model", load, "freedoms", "steps", "seconds", "message")
    rows = [
        (model, answer(x), *("–" if k is None else k for k in (x.dofs, x.steps)), two_digits(x.seconds), said(x))
        for model, x in outcomes.items()
    ]
    refused = [(model, why) for (wall, model), why in comparison.campaign.inapplicable.items() if wall == name]
    rows += [(model, "n/a", "", "", "", why) for model, why in refused]
    curve = inline_svg(figure, f"curves of {name}") if figure else ""
    return {
        "name": name,
        "title": scene.title,
        "mechanisms": mechanisms,
        "rest": Markup(inline_wall(scene, extent, rest)),
        "moments": [moving_wall(scene, x, extent, rest) for x in moved],
        "curve": curve,
        "heads": heads,
        "rows": rows,
    }


def _versions(comparison: Comparison, tolerance: float) -> list[tuple[str, str]]:
    return [
        ("models", ", ".join(model.name for model in comparison.models)),
        ("tolerance", f"{tolerance:g}"),
        ("written", datetime.now(UTC).isoformat(timespec="seconds")),
        ("runningbond", f"{version('runningbond')}, sources {code_digest()[:16]}"),
        ("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}"),
        *((name, version(name)) for name in (*LIBRARIES, *DRAWN_WITH)),
    ]
