"""Plates of a campaign: collapse mechanisms, walls by models; the paper's Figures 8 to 10 and 12."""

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from runningbond.pictures.captions import multiplier_text, show_extent, to_png
from runningbond.pictures.deformed_shape import DeformedShape, Extent, common_extent, undeformed_shape
from runningbond.pictures.flat import line_width, mechanism_key, paint_mechanism
from runningbond.pictures.joint_state import JointState
from runningbond.pictures.mechanism import mechanism_shape, mechanism_warning
from runningbond.results import Outcome, write_atomically

from .figures import SLENDERNESS, TEXTURES
from .model import Model
from .published import BARALDI, CONCENTRATED, FERRIS, cases_of
from .table import Comparison

WIDTH, NARROWEST, TALLEST, DPI = 7.2, 5.4, 9.6, 250  # of a plate: that of a page, the least; height [in]; dots an inch
TITLES, LINE = 0.85, 0.11  # height of its titles and its key, and of a line under a wall [in]
LETTER, GAP = 0.06, 0.1  # width of a letter, and of a gap between walls [in]
OWN_WALLS = 12  # largest number of walls on the plate of one's own


@dataclass(frozen=True)
class Plate:
    """Walls whose mechanisms stand side by side."""

    name: str  # of the file
    title: str
    walls: dict[str, str]  # and what each is called


def plates(comparison: Comparison) -> list[Plate]:
    """Plates that a comparison has anything for: the paper's, and one of walls that are in no figure of it."""
    textures = [f"b/a = {label}" for label, _ in TEXTURES]
    panels, loaded, ferris = ([case.name for case in cases_of(x)] for x in (BARALDI, CONCENTRATED, FERRIS))
    lateral, concentrated = "Mechanisms under self-weight and lateral load", "Mechanisms under a concentrated load"
    own = [name for name in comparison.scenes if name not in comparison.published][:OWN_WALLS]
    paper = []
    for k, (label, _) in enumerate(SLENDERNESS):
        title = f"{lateral}, H/L = {label} (cf. Baraldi et al., Fig. {8 + k})"
        paper.append(Plate(f"figure-{8 + k}", title, dict(zip(panels[4 * k : 4 * k + 4], textures, strict=True))))
    title = f"{concentrated} (cf. Baraldi et al., Fig. 12)"
    paper.append(Plate("figure-12", title, dict(zip(loaded, textures, strict=True))))
    names = {name: name.removeprefix("wall-").upper() for name in ferris}
    paper.append(Plate("mechanisms-ferris", "Mechanisms of Ferris & Tin-Loi's walls", names))
    present = [replace(p, walls={n: w for n, w in p.walls.items() if n in comparison.published}) for p in paper]
    present.append(Plate("mechanisms", "Mechanisms", {name: name for name in own}))
    return [plate for plate in present if _models(comparison, plate)]


def draw_plates(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw every plate that a comparison has anything for."""
    written = []
    for plate in plates(comparison):
        write_atomically(folder / f"{plate.name}.png", _draw(comparison, plate))
        written.append(folder / f"{plate.name}.png")
    return written


def _models(comparison: Comparison, plate: Plate) -> list[Model]:
    """Models that have a mechanism of any wall of a plate."""
    outcomes = {model: [comparison.outcome(name, model) for name in plate.walls] for model in comparison.models}
    return [model for model, own in outcomes.items() if any(x is not None and len(x.motion) for x in own)]


def _draw(comparison: Comparison, plate: Plate) -> bytes:
    models = _models(comparison, plate)
    rows = [_row(comparison, name, models) for name in plate.walls]
    below = LINE * max(2, *(text.count("\n") + 1 for _, captions, _ in rows for text in captions)) + 0.08
    ratios = [(top - bottom) / (right - left) for _, _, (left, right, bottom, top) in rows]
    room = TALLEST - TITLES - below * len(rows)
    labels = [textwrap.wrap(label, 16) or [""] for label in plate.walls.values()]
    side = 0.1 + LETTER * max(len(line) for label in labels for line in label)
    width = min((WIDTH - side) / max(len(models), 3) - GAP, room / sum(ratios))
    total = max(NARROWEST, side + (width + GAP) * len(models))
    figure = Figure((total, TALLEST - room + sum(ratios) * width), DPI, layout="constrained")
    figure.suptitle(plate.title, fontsize=8, fontweight="bold")
    grid = figure.subplots(len(rows), len(models), squeeze=False, height_ratios=ratios)
    for axes, model in zip(grid[0], models, strict=True):
        axes.set_title(model.name, fontsize=8)
    for line, (shapes, captions, extent), label, ratio in zip(grid, rows, labels, ratios, strict=True):
        _write(line[0], -0.04, 0.5, "\n".join(label), ha="right", va="center", fontsize=7.5)
        for axes, shape, caption in zip(line, shapes, captions, strict=True):
            show_extent(axes, extent)
            paint_mechanism(axes, shape, line_width(shape.scene, extent, (width, ratio * width)))
            _write(axes, 0.5, -0.02, caption, ha="center", va="top", fontsize=6.3)
    handles = mechanism_key((JointState.SLIDE, JointState.OPEN), hinges=True)
    figure.legend(handles=handles, loc="outside lower center", ncols=5, frameon=False, fontsize=7, handlelength=1.6)
    return to_png(figure, DPI)


def _write(axes: Axes, x: float, y: float, text: str, **style: Any) -> None:
    """Text at shares of the width and height of some axes."""
    axes.text(x, y, text, transform=axes.transAxes, parse_math=False, **style)


def _row(comparison: Comparison, name: str, models: Sequence[Model]) -> tuple[list[DeformedShape], list[str], Extent]:
    """One wall by all models: what is drawn, its captions, and an extent that shows all of it."""
    scene = comparison.scenes[name]

    def caption(outcome: Outcome) -> str:  # the load, its bracket, and what is wrong with the mechanism, if anything
        lines = [*multiplier_text(scene, outcome), *textwrap.wrap(mechanism_warning(scene, outcome), 26)]
        return "\n".join(filter(None, lines))

    outcomes = [comparison.outcome(name, model) for model in models]
    mechanisms = [None if outcome is None else mechanism_shape(scene, outcome) for outcome in outcomes]
    shapes = [mechanism or undeformed_shape(scene) for mechanism in mechanisms]
    captions = [comparison.cell(name, model, caption) for model in models]
    return shapes, captions, common_extent(shapes)
