"""Plates of a campaign: collapse mechanisms, walls by models, with the paper's Figures 8 to 10 and 12."""

import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from runningbond.models import Model
from runningbond.pictures.captions import multiplier_text
from runningbond.pictures.deformed_shape import undeformed_shape
from runningbond.pictures.mechanism import mechanism_shape, mechanism_warning
from runningbond.pictures.plate import PlateRow, draw_plate
from runningbond.results import Outcome

from .figures import SLENDERNESS, TEXTURES
from .published import BARALDI, CONCENTRATED, FERRIS, cases_of
from .table import Comparison

OWN_WALLS = 12  # largest number of walls on the plate of the user's own walls


@dataclass(frozen=True)
class Plate:
    """Walls whose mechanisms are drawn side by side."""

    name: str  # file name without suffix
    title: str
    walls: dict[str, str]  # labels of the walls by their names


def _published_plates() -> list[Plate]:
    """The plates of the papers, with all their walls."""
    textures = [f"b/a = {label}" for label, _ in TEXTURES]
    panels, loaded, ferris = ([case.name for case in cases_of(x)] for x in (BARALDI, CONCENTRATED, FERRIS))
    paper = []
    for k, (label, _) in enumerate(SLENDERNESS):
        title = f"Mechanisms under self-weight and lateral load, H/L = {label} (cf. Baraldi et al., Fig. {8 + k})"
        paper.append(Plate(f"figure-{8 + k}", title, dict(zip(panels[4 * k : 4 * k + 4], textures, strict=True))))
    title = "Mechanisms under a concentrated load (cf. Baraldi et al., Fig. 12)"
    paper.append(Plate("figure-12", title, dict(zip(loaded, textures, strict=True))))
    names = {name: name.removeprefix("wall-").upper() for name in ferris}
    return [*paper, Plate("mechanisms-ferris", "Mechanisms of Ferris & Tin-Loi's walls", names)]


PAPER, OWN = _published_plates(), Plate("mechanisms", "Mechanisms", {})
FILES = tuple(f"{plate.name}.png" for plate in (*PAPER, OWN))
"""File names of all plates."""


def plates(comparison: Comparison) -> list[Plate]:
    """Plates for which a comparison has a mechanism: those of the papers, and one of the user's own walls."""
    own = [name for name in comparison.scenes if name not in comparison.published][:OWN_WALLS]
    present = [replace(p, walls={n: w for n, w in p.walls.items() if n in comparison.published}) for p in PAPER]
    present.append(replace(OWN, walls={name: name for name in own}))
    return [plate for plate in present if _models(comparison, plate)]


def plate_drawings(comparison: Comparison) -> dict[str, Callable[[], bytes]]:
    """Drawing of every plate for which a comparison has a mechanism, by file name: a call that returns the content."""
    calls: dict[str, Callable[[], bytes]] = {}
    for plate in plates(comparison):
        models = _models(comparison, plate)
        rows = [_row(comparison, name, label, models) for name, label in plate.walls.items()]
        calls[f"{plate.name}.png"] = partial(draw_plate, plate.title, [model.name for model in models], rows)
    return calls


def _models(comparison: Comparison, plate: Plate) -> list[Model]:
    """Models that found a mechanism for at least one wall of a plate."""
    outcomes = {model: [comparison.outcome(name, model) for name in plate.walls] for model in comparison.models}
    return [model for model, own in outcomes.items() if any(x is not None and len(x.motion) for x in own)]


def _row(comparison: Comparison, name: str, label: str, models: Sequence[Model]) -> PlateRow:
    """Row of a plate: the shape of one wall by each model, with captions."""
    scene = comparison.scenes[name]

    def caption(outcome: Outcome) -> str:  # load, bracket, and a warning about the mechanism, if any
        lines = [*multiplier_text(scene, outcome), *textwrap.wrap(mechanism_warning(scene, outcome), 26)]
        return "\n".join(filter(None, lines))

    outcomes = [comparison.outcome(name, model) for model in models]
    mechanisms = [None if outcome is None else mechanism_shape(scene, outcome) for outcome in outcomes]
    shapes = [mechanism or undeformed_shape(scene) for mechanism in mechanisms]
    return PlateRow(label, shapes, [comparison.cell(name, model, caption) for model in models])
