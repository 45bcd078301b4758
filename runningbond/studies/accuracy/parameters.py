"""The knobs of each model, and what they are turned to: one thing at a time, beside the model as it is."""

from dataclasses import dataclass, field
from typing import Any

from runningbond.joints import gauss, lobatto

VARIED = ("stack-of-5", "wall-w1-inset", "wall-w3-inset", "panel-02")
"""Walls on which knobs are turned."""

COLLAPSE = ("limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem")
"""Models that answer for any wall, in the order of their cost."""

MODES: dict[str, dict[str, Any]] = {str(count): {"modes": count} for count in (3, 6, 20, "all")}
"""Rigid blocks, uniform strains, all displacements up to third degree, and all of the constant-strain triangles."""


@dataclass(frozen=True)
class Knob:
    """A knob of some models.

    Parameters
    ----------
    name
        What it is called in tables and charts.
    models
        Models that have it.
    settings
        Arguments of the model by the name of each setting.
    walls
        Walls on which it is turned.
    dear
        Settings that are too dear for walls other than those of `cheap`.
    """

    name: str
    models: tuple[str, ...]
    settings: dict[str, dict[str, Any]]
    walls: tuple[str, ...] = VARIED
    dear: tuple[str, ...] = field(default=())

    @property
    def cheap(self) -> tuple[str, ...]:
        """Walls that dear settings are tried on."""
        return self.walls[:2]


KNOBS = (
    Knob("joint rule", ("fem",), {"Simpson": {"rule": lobatto(3)}, "Gauss 2": {"rule": gauss(2)}}),
    Knob("cells", ("fem",), {"2": {"cells": 2}, "4": {"cells": 4}}, dear=("4",)),
    Knob("modes", ("fem",), MODES),
    Knob("mass scaling", ("fem",), {"off": {"mass_scaling": False}}, dear=("off",)),
    Knob(
        "tolerance",
        ("dem-static", "dem-dynamic", "fem"),
        {"5 %": {"tolerance": 0.05}, "2 %": {"tolerance": 0.02}, "0.5 %": {"tolerance": 0.005}},
    ),
    Knob("first step", ("dem-static",), {"half": {"first_step": 0.015}, "double": {"first_step": 0.06}}),
    Knob("first step", ("dem-dynamic", "fem"), {"half": {"first_step": 0.025}, "double": {"first_step": 0.1}}),
    Knob(
        "driven, steps",
        ("dem-dynamic", "fem"),
        {"25,000": {"drive": 25_000}, "100,000": {"drive": 100_000}, "400,000": {"drive": 400_000}},
        dear=("400,000",),
    ),
    Knob(
        "speed",
        ("dem-dynamic", "fem"),
        {"4 mm/s": {"speed": 4e-3}, "16 mm/s": {"speed": 1.6e-2}},
        walls=("turned-block",),
    ),
    Knob("displacements", ("dem-dynamic", "fem"), {"small": {"drive": 100_000}}, walls=("turned-block",)),
    Knob("modes", ("fem",), MODES, walls=("cell-1e10", "cell-1e11", "cell-1e12")),
    Knob("modes", ("fem",), {"3": {"modes": 3}}, walls=("cell-shear",)),
    Knob(
        "mass scaling",
        ("fem",),
        {"off": {"mass_scaling": False}},
        walls=("stiff-1e9", "stiff-1e10", "stiff-1e11", "stiff-1e12", "stiff-1e13"),
    ),
)
"""What is turned, and where. As they are, blocks of `fem` have two Lobatto points an element, one cell and ten modes.

Three Lobatto points are Simpson's rule.
"""


def settings_of(model: str, knob: str, setting: str) -> dict[str, Any]:
    """Arguments that turn a knob of a model to a setting; none where no knob is named."""
    if not knob:
        return {}
    for found in KNOBS:
        if found.name == knob and model in found.models and setting in found.settings:
            return found.settings[setting]
    raise KeyError(f"{model} has no knob {knob!r} with {setting!r}")
