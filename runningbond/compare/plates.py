"""Plates of a campaign: collapse mechanisms, walls by models; the paper's Figures 8 to 10 and 12."""

import textwrap
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from runningbond.pictures.captions import colour_key, multiplier_text, to_png
from runningbond.pictures.deformed_shape import DeformedShape, Extent, undeformed_shape
from runningbond.pictures.joint_state import JointState
from runningbond.pictures.mechanism import mechanism_shape, mechanism_warning
from runningbond.pictures.pyvista_figure import draw_painted
from runningbond.pictures.pyvista_painter import Painter
from runningbond.results import Outcome, write_atomically
from runningbond.scene import Scene

from .figures import SLENDERNESS, TEXTURES
from .model import Model
from .published import BARALDI, CONCENTRATED, FERRIS, cases_of
from .table import Comparison

WIDTH, NARROWEST, TALLEST, DPI = 7.2, 5.4, 9.6, 250
"""Width of a plate, that of a page, and the least; its largest height [in]; and dots per inch."""

PIXELS = 640
"""Longer side of the image of one wall."""

SIDE, HEAD, FOOT, LINE = 0.62, 0.46, 0.34, 0.11
"""Room for the names of walls, for those of models, for the key and for a line under a wall [in]."""

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
    captions = LINE * max(2, *(text.count("\n") + 1 for row in rows for text in row.captions)) + 0.08
    aspect = [(top - bottom) / (right - left) for left, right, bottom, top in (row.extent for row in rows)]
    room = TALLEST - HEAD - FOOT - captions * len(rows)
    width = min((WIDTH - SIDE) / max(len(models), 3), room / sum(aspect))
    heights = [width * ratio + captions for ratio in aspect]
    total_width, total = max(SIDE + width * len(models), NARROWEST), sum(heights) + HEAD + FOOT
    width = (total_width - SIDE) / len(models)
    figure = Figure(figsize=(total_width, total), dpi=DPI)
    figure.text(0.5, 1 - 0.06 / total, plate.title, ha="center", va="top", fontsize=8, fontweight="bold")
    middles = [(SIDE + (column + 0.5) * width) / total_width for column in range(len(models))]
    for middle, model in zip(middles, models, strict=True):
        figure.text(middle, 1 - (HEAD - 0.06) / total, model.name, ha="center", va="bottom", fontsize=8)
    top = total - HEAD
    for row, label, height in zip(rows, plate.walls.values(), heights, strict=True):
        bottom = top - height + captions
        figure.text(0.08 / total_width, (top + bottom) / 2 / total, label, va="center", fontsize=7.5)
        for middle, shape, caption in zip(middles, row.shapes, row.captions, strict=True):
            left = middle - width / 2 / total_width
            axes = figure.add_axes((left, bottom / total, width / total_width, (top - bottom) / total))
            draw_painted(axes, shape, painter, row.extent, annotated=False)
            figure.text(middle, (bottom - 0.03) / total, caption, ha="center", va="top", fontsize=6.3)
        top -= height
    figure.legend(
        handles=colour_key((JointState.SLIDE, JointState.OPEN)),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.02 / total),
        ncols=4,
        frameon=False,
        fontsize=7,
        handlelength=1.6,
    )
    return to_png(figure, DPI)


@dataclass(frozen=True)
class Row:
    """One wall by all models: what is drawn, its captions, and an extent that shows all of it."""

    shapes: list[DeformedShape]
    captions: list[str]
    extent: Extent


def _row(comparison: Comparison, name: str, models: Sequence[Model]) -> Row:
    scene = comparison.scenes[name]
    outcomes = [comparison.outcome(name, model) for model in models]
    mechanisms = [None if outcome is None else mechanism_shape(scene, outcome) for outcome in outcomes]
    shapes = [mechanism or undeformed_shape(scene) for mechanism in mechanisms]
    lefts, rights, bottoms, tops = zip(*(shape.extent for shape in shapes), strict=True)
    extent = min(lefts), max(rights), min(bottoms), max(tops)
    captions = [comparison.cell(name, model, lambda outcome: _caption(scene, outcome)) for model in models]
    return Row(shapes, captions, extent)


def _caption(scene: Scene, outcome: Outcome) -> str:
    """The load, its bracket, and what is wrong with the mechanism where something is."""
    lines = [*multiplier_text(scene, outcome), *textwrap.wrap(mechanism_warning(scene, outcome), 34)]
    return "\n".join(filter(None, lines))
