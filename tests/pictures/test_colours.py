"""Colours differ in grey print, and for eyes without red or green cones."""

from collections.abc import Callable, Sequence
from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from runningbond.laboratory.ladder import LADDER
from runningbond.models import MODELS
from runningbond.pictures.response import ENERGY_COLOURS
from runningbond.pictures.style import (
    BEAM,
    BLOCK_COLOURS,
    CHART_COLOURS,
    CRUSHED,
    DARK,
    DEAD,
    HELD,
    JOINT_COLOURS,
    MOTION,
    STATE_COLOURS,
    block_colour,
    joint_colour,
    tint,
)
from runningbond.scene import Array
from runningbond.studies.stability.material_edges import WORTH

TO_XYZ = np.array([[0.41246, 0.35758, 0.18044], [0.21267, 0.71515, 0.07218], [0.01933, 0.11919, 0.95030]])
PROTANOPIA = np.array([[0.1523, 1.0526, -0.2049], [0.1145, 0.7863, 0.0992], [-0.0039, -0.0481, 1.0520]])
DEUTERANOPIA = np.array([[0.3673, 0.8607, -0.2280], [0.2801, 0.6725, 0.0474], [-0.0118, 0.0429, 0.9689]])
"""Matrices for linear RGB at full severity, by Machado, Oliveira & Fernandes (2009)."""

EYES: dict[str, Callable[[Array], Array]] = {
    "all cones": lambda rgb: rgb,
    "grey": lambda rgb: np.repeat(rgb @ TO_XYZ[1:2].T, 3, axis=1),
    "protanopia": lambda rgb: rgb @ PROTANOPIA.T,
    "deuteranopia": lambda rgb: rgb @ DEUTERANOPIA.T,
}
"""Linear RGB ``(n, 3)`` as it is seen."""

MODEL_COLOURS = [model.colour for model in MODELS.values()]
RUNGS = [rung.model.colour for rung in LADDER.values() if not rung.is_by_hand]
TINTS = [tint(state) for state in STATE_COLOURS]
JOINT_STATES = list(STATE_COLOURS.values())
LINES = {"models": MODEL_COLOURS, "joints": [*JOINT_STATES, CRUSHED], "loads": [DARK, DEAD, MOTION]}
PALETTES: dict[str, tuple[Sequence[object], float, float]] = {
    "models": (MODEL_COLOURS, 8.5, 20.0),
    "rungs of the laboratory": (RUNGS, 7.5, 7.5),
    "series": (CHART_COLOURS, 10.0, 20.0),
    "what joints do": (JOINT_STATES, 20.0, 30.0),
    "crosses and lines": ([CRUSHED, *JOINT_STATES], 9.0, 30.0),
    "gaps of joints": (TINTS, 8.0, 10.0),
    "joints by material": (JOINT_COLOURS, 10.0, 20.0),
    "blocks by material": ([*BLOCK_COLOURS, HELD, BEAM], 3.5, 8.0),
    "blocks of many materials": ([*map(block_colour, range(13)), HELD, BEAM], 1.5, 7.0),
    "joints of many materials": ([*map(joint_colour, range(12))], 1.0, 10.0),
    "loads": ([DARK, DEAD, MOTION], 3.0, 35.0),
    "energies": (list(ENERGY_COLOURS.values()), 10.0, 15.0),
    "what answers are worth": ([colour for colour, _ in WORTH.values()], 9.0, 9.0),
}
"""Colours, smallest allowed difference of lightness, and smallest allowed distance for eyes with two or three cones."""


def lab(rgb: Array) -> Array:
    """CIE L*a*b* of linear RGB ``(n, 3)``, relative to white of D65."""
    share = np.clip(rgb, 0, 1) @ TO_XYZ.T / TO_XYZ.sum(axis=1)
    x, y, z = np.where(share > 216 / 24389, np.cbrt(share), (24389 / 27 * share + 16) / 116).T
    return np.column_stack([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def linear(colours: Sequence[object]) -> Array:
    """Linear RGB ``(n, 3)`` of colours."""
    rgb = np.array([to_rgb(colour) for colour in colours])  # type: ignore[arg-type]
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def apart(colours: Sequence[object], eyes: str) -> float:
    """Smallest distance between two of the colours, as seen by some eyes."""
    seen = lab(EYES[eyes](linear(colours)))
    return min(float(np.linalg.norm(one - other)) for one, other in combinations(seen, 2))


def test_distances_are_those_of_cie() -> None:
    """Black and white are 100 apart; a red and a green of equal lightness are nearly the same without green cones."""
    assert apart(["black", "white"], "grey") == pytest.approx(100.0, abs=0.01)
    assert apart(["#d55e00", "#009e73"], "all cones") > 100
    assert apart(["#c0504d", "#6d8a2f"], "deuteranopia") < 0.4 * apart(["#c0504d", "#6d8a2f"], "all cones")


@pytest.mark.parametrize("name", PALETTES)
def test_colours_are_distinguishable(name: str) -> None:
    colours, lightness, distance = PALETTES[name]
    assert apart(colours, "grey") >= lightness
    assert min(apart(colours, eyes) for eyes in EYES if eyes != "grey") >= distance


@pytest.mark.parametrize(
    "colours", [MODEL_COLOURS, [*JOINT_STATES, CRUSHED], [DARK, DEAD, MOTION]], ids=["models", "joints", "loads"]
)
def test_lines_have_contrast_to_paper(colours: list[str]) -> None:
    """Contrast of 3 : 1 with white, which the W3C requires of the parts of a picture needed to understand it."""
    luminance = linear(colours) @ TO_XYZ[1]
    assert (1.05 / (luminance + 0.05) >= 3.0).all()
