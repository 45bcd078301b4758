"""Plates of a campaign: collapse mechanisms, walls by models; the paper's Figures 8 to 10 and 12."""

import textwrap
from collections.abc import Sequence
from contextlib import closing
from dataclasses import astuple, dataclass, replace
from pathlib import Path

from runningbond.pictures.frame import State
from runningbond.pictures.mechanisms import draw_wall, key, multiplier_text, png, show_mechanism, show_undeformed
from runningbond.pictures.moment import Shown
from runningbond.pictures.painting import Painter, View
from runningbond.results import write_atomically

from .figures import SLENDERNESS, TEXTURES
from .model import Model
from .published import BARALDI, CONCENTRATED, FERRIS, cases_of
from .table import Comparison

WIDTH, NARROWEST, TALLEST, DPI = 7.2, 5.4, 9.6, 250
"""Width of a plate, that of a page, and the least; its largest height [in]; and dots per inch."""

TITLES, CAPTION, LETTER, GAP = 0.85, 0.33, 0.06, 0.1
"""Height of its titles and its key, and of the caption of a wall; width of a letter and of a gap between walls [in]."""

PIXELS = 640
"""Longer side of the image of one wall."""

OWN_WALLS = 12
"""Largest number of walls on the plate of one's own."""


@dataclass(frozen=True)
class Plate:
    """Walls whose mechanisms stand side by side: the name of the file, a title, and what each wall is called."""

    name: str
    title: str
    walls: dict[str, str]


def plates(comparison: Comparison) -> list[Plate]:
    """Plates that a comparison has anything for: the paper's, and one of the walls that are nobody's figure."""
    textures = [f"b/a = {label}" for label, _ in TEXTURES]
    panels = _names(BARALDI)
    drawn = [
        Plate(
            f"figure-{8 + k}",
            f"Mechanisms under self-weight and lateral load, H/L = {label} (cf. Baraldi et al., Fig. {8 + k})",
            dict(zip(panels[4 * k : 4 * k + 4], textures, strict=True)),
        )
        for k, (label, _) in enumerate(SLENDERNESS)
    ]
    title = "Mechanisms under a concentrated load (cf. Baraldi et al., Fig. 12)"
    drawn.append(Plate("figure-12", title, dict(zip(_names(CONCENTRATED), textures, strict=True))))
    labels = {name: name.removeprefix("wall-").upper() for name in _names(FERRIS)}
    drawn.append(Plate("mechanisms-ferris", "Mechanisms of Ferris & Tin-Loi's walls", labels))
    present = [replace(p, walls={n: w for n, w in p.walls.items() if n in comparison.published}) for p in drawn]
    own = [name for name in comparison.scenes if name not in comparison.published][:OWN_WALLS]
    present.append(Plate("mechanisms", "Mechanisms", {name: name for name in own}))
    return [plate for plate in present if _models(comparison, plate)]


def _names(source: str) -> list[str]:
    return [case.name for case in cases_of(source)]


def draw_plates(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw every plate that a comparison has anything for."""
    written = []
    with closing(Painter(PIXELS)) as painter:
        for plate in plates(comparison):
            write_atomically(folder / f"{plate.name}.png", _draw(comparison, plate, painter))
            written.append(folder / f"{plate.name}.png")
    return written


def _models(comparison: Comparison, plate: Plate) -> list[Model]:
    """Models that have a mechanism of any wall of a plate."""
    outcomes = {model: [comparison.outcome(name, model) for name in plate.walls] for model in comparison.models}
    return [model for model, found in outcomes.items() if any(out is not None and len(out.motion) for out in found)]


def _draw(comparison: Comparison, plate: Plate, painter: Painter) -> bytes:
    from matplotlib.figure import Figure

    models = _models(comparison, plate)
    rows = [_row(comparison, name, models) for name in plate.walls]
    ratios = [(row.view.top - row.view.bottom) / (row.view.right - row.view.left) for row in rows]
    room = TALLEST - TITLES - CAPTION * len(rows)
    labels = [textwrap.wrap(label, 16) or [""] for label in plate.walls.values()]
    side = 0.1 + LETTER * max(len(line) for label in labels for line in label)
    width = min((WIDTH - side) / max(len(models), 3) - GAP, room / sum(ratios))
    total = max(NARROWEST, side + (width + GAP) * len(models))
    figure = Figure((total, TALLEST - room + sum(ratios) * width), DPI, layout="constrained")
    figure.suptitle(plate.title, fontsize=8, fontweight="bold")
    grid = figure.subplots(len(rows), len(models), squeeze=False, height_ratios=ratios)
    for axes, model in zip(grid[0], models, strict=True):
        axes.set_title(model.name, fontsize=8)
    for line, row, label in zip(grid, rows, labels, strict=True):
        line[0].text(
            -0.04,
            0.5,
            "\n".join(label),
            transform=line[0].transAxes,
            ha="right",
            va="center",
            fontsize=7.5,
            parse_math=False,
        )
        for axes, moment, caption in zip(line, row.drawn, row.captions, strict=True):
            draw_wall(axes, moment, painter, row.view, signs=False)
            axes.text(0.5, -0.02, caption, transform=axes.transAxes, ha="center", va="top", fontsize=6.3)
    handles = key((State.SLIDE, State.OPEN))
    figure.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=7, handlelength=1.6)
    return png(figure, DPI)


@dataclass(frozen=True)
class Row:
    """One wall by all models: what is drawn, its captions, and a view that shows all of it."""

    drawn: list[Shown]
    captions: list[str]
    view: View


def _row(comparison: Comparison, name: str, models: Sequence[Model]) -> Row:
    scene = comparison.scenes[name]
    outcomes = (comparison.outcome(name, model) for model in models)
    mechanisms = (None if outcome is None else show_mechanism(scene, outcome) for outcome in outcomes)
    drawn = [mechanism or show_undeformed(scene) for mechanism in mechanisms]
    left, right, bottom, top, _ = zip(*(astuple(each.view(PIXELS)) for each in drawn), strict=True)
    view = View(min(left), max(right), min(bottom), max(top), PIXELS)
    captions = [comparison.cell(name, model, lambda out: "\n".join(multiplier_text(scene, out))) for model in models]
    return Row(drawn, captions, view)
