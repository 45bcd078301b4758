"""Plates of a campaign: collapse mechanisms, walls by models; the paper's Figures 8 to 10 and 12."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from runningbond.pictures.frame import State
from runningbond.pictures.mechanisms import draw_wall, key, multiplier_text, png, show_mechanism, show_undeformed
from runningbond.pictures.moment import Shown
from runningbond.pictures.painting import Painter, View
from runningbond.results import write_atomically

from .figures import SLENDERNESS, TEXTURES
from .published import BARALDI, CONCENTRATED, FERRIS, PUBLISHED
from .table import OWN, Comparison

WIDTH, NARROWEST, TALLEST, DPI = 7.2, 5.4, 9.6, 250
"""Width of a plate, that of a page, and the least; its largest height [in]; and dots per inch."""

PIXELS = 640
"""Longer side of the image of one wall."""

SIDE, HEAD, FOOT, CAPTION = 0.62, 0.46, 0.34, 0.3
"""Room for the names of walls, for those of models, for the key and under each wall [in]."""

MOST_OWN = 12
"""Walls of one's own that go on a plate."""


@dataclass(frozen=True)
class Plate:
    """Walls whose mechanisms stand side by side: the name of the file, a title, and what each wall is called."""

    name: str
    title: str
    walls: dict[str, str]


def plates(comparison: Comparison) -> list[Plate]:
    """Plates that a comparison has anything for."""
    panels = [case.name for case in PUBLISHED if case.source == BARALDI]
    textures = [f"b/a = {label}" for label, _ in TEXTURES]
    found = [
        Plate(
            f"figure-{8 + k}",
            f"Mechanisms under self-weight and lateral load, H/L = {label} (cf. Baraldi et al., Fig. {8 + k})",
            dict(zip(panels[4 * k : 4 * k + 4], textures, strict=True)),
        )
        for k, (label, _) in enumerate(SLENDERNESS)
    ]
    concentrated = [case.name for case in PUBLISHED if case.source == CONCENTRATED]
    title = "Mechanisms under a concentrated load (cf. Baraldi et al., Fig. 12)"
    found.append(Plate("figure-12", title, dict(zip(concentrated, textures, strict=True))))
    walls = [case.name for case in PUBLISHED if case.source == FERRIS]
    labels = [name.removeprefix("wall-").upper() for name in walls]
    found.append(
        Plate("mechanisms-ferris", "Mechanisms of Ferris & Tin-Loi's walls", dict(zip(walls, labels, strict=True)))
    )
    own = comparison.by_source().get(OWN, [])[:MOST_OWN]
    found.append(Plate("mechanisms", "Mechanisms", {name: name for name in own}))
    present = [Plate(p.name, p.title, {n: w for n, w in p.walls.items() if n in comparison.scenes}) for p in found]
    return [plate for plate in present if _models(comparison, plate)]


def draw_plates(comparison: Comparison, folder: Path) -> list[Path]:
    """Draw every plate that a comparison has anything for."""
    written = []
    with closing(Painter(PIXELS)) as painter:
        for plate in plates(comparison):
            write_atomically(folder / f"{plate.name}.png", _draw(comparison, plate, painter))
            written.append(folder / f"{plate.name}.png")
    return written


def _models(comparison: Comparison, plate: Plate) -> list[str]:
    """Models that have a mechanism of any wall of a plate."""
    outcomes = comparison.campaign.outcomes
    return [
        model
        for model in comparison.models
        if any(len(outcomes[name, model].motion) for name in plate.walls if (name, model) in outcomes)
    ]


def _draw(comparison: Comparison, plate: Plate, painter: Painter) -> bytes:
    from matplotlib.figure import Figure

    models = _models(comparison, plate)
    rows = [_row(comparison, name, models) for name in plate.walls]
    aspect = [(row.view.top - row.view.bottom) / (row.view.right - row.view.left) for row in rows]
    room = TALLEST - HEAD - FOOT - CAPTION * len(rows)
    width = min((WIDTH - SIDE) / max(len(models), 3), room / sum(aspect))
    heights = [width * ratio + CAPTION for ratio in aspect]
    total_width, total = max(SIDE + width * len(models), NARROWEST), sum(heights) + HEAD + FOOT
    width = (total_width - SIDE) / len(models)
    figure = Figure(figsize=(total_width, total), dpi=DPI)
    figure.text(0.5, 1 - 0.06 / total, plate.title, ha="center", va="top", fontsize=8, fontweight="bold")
    middles = [(SIDE + (column + 0.5) * width) / total_width for column in range(len(models))]
    for middle, model in zip(middles, models, strict=True):
        figure.text(middle, 1 - (HEAD - 0.06) / total, model, ha="center", va="bottom", fontsize=8)
    top = total - HEAD
    for row, label, height in zip(rows, plate.walls.values(), heights, strict=True):
        bottom = top - height + CAPTION
        figure.text(0.08 / total_width, (top + bottom) / 2 / total, label, va="center", fontsize=7.5)
        for middle, shown, caption in zip(middles, row.shown, row.captions, strict=True):
            left = middle - width / 2 / total_width
            axes = figure.add_axes((left, bottom / total, width / total_width, (top - bottom) / total))
            draw_wall(axes, shown, painter, row.view, signs=False)
            figure.text(middle, (bottom - 0.03) / total, caption, ha="center", va="top", fontsize=6.3)
        top -= height
    figure.legend(
        handles=key((State.SLIDE, State.OPEN)),
        loc="lower center",
        bbox_to_anchor=(0.5, 0.02 / total),
        ncols=4,
        frameon=False,
        fontsize=7,
        handlelength=1.6,
    )
    return png(figure, DPI)


@dataclass(frozen=True)
class Row:
    """One wall by all models: what is drawn, its captions, and a view that shows all of it."""

    shown: list[Shown]
    captions: list[str]
    view: View


def _row(comparison: Comparison, name: str, models: list[str]) -> Row:
    scene = comparison.scenes[name]
    outcomes = [comparison.campaign.outcomes.get((name, model)) for model in models]
    mechanisms = [None if outcome is None else show_mechanism(scene, outcome) for outcome in outcomes]
    shown = [found or show_undeformed(scene) for found in mechanisms]
    views = [each.view(PIXELS) for each in shown]
    view = View(
        min(view.left for view in views),
        max(view.right for view in views),
        min(view.bottom for view in views),
        max(view.top for view in views),
        PIXELS,
    )
    captions = ["n/a" if outcome is None else "\n".join(multiplier_text(scene, outcome)) for outcome in outcomes]
    return Row(shown, captions, view)
