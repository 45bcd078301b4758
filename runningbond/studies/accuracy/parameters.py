"""The parameters of each model that are varied, one at a time, in comparison with its defaults."""

from dataclasses import dataclass
from typing import Any

from runningbond.joints import gauss, lobatto
from runningbond.models import MODELS

VARIED = ("stack-of-5", "wall-w1-inset", "wall-w3-inset", "panel-02")  # walls on which parameters are varied
COLLAPSE = tuple(name for name in MODELS if name != "homog")  # models for any wall, the cheapest first
# rigid blocks, uniform strains, displacements up to the third degree, and all modes of constant-strain triangles
MODES: dict[str, dict[str, Any]] = {str(count): {"modes": count} for count in (3, 6, 20, "all")}


@dataclass(frozen=True)
class Parameter:
    """A parameter that is varied, with the models that have it."""

    name: str
    models: tuple[str, ...]
    settings: dict[str, dict[str, Any]]  # arguments of the model, by name of the setting
    walls: tuple[str, ...] = VARIED
    expensive: tuple[str, ...] = ()  # settings that are tried only on the first two walls


IN_MOTION = ("dem-dynamic", "fem")
OFF: dict[str, dict[str, Any]] = {"off": {"mass_scaling": False}}
STEPS = {f"{steps:,}": {"drive": steps} for steps in (25_000, 100_000, 400_000)}
BRACKETS = {f"{100 * width:g} %": {"tolerance": width} for width in (0.05, 0.02, 0.005)}
STIFF = tuple(f"stiff-1e{power}" for power in range(9, 14))

PARAMETERS = (  # what is varied, and where; three Lobatto points are Simpson's rule
    Parameter("joint rule", ("fem",), {"Simpson": {"rule": lobatto(3)}, "Gauss 2": {"rule": gauss(2)}}),
    Parameter("cells", ("fem",), {"2": {"cells": 2}, "4": {"cells": 4}}, expensive=("4",)),
    Parameter("modes", ("fem",), MODES),
    Parameter("mass scaling", ("fem",), OFF, expensive=("off",)),
    Parameter("tolerance", ("dem-static", *IN_MOTION), BRACKETS),
    Parameter("first step", ("dem-static",), {"half": {"first_step": 0.015}, "double": {"first_step": 0.06}}),
    Parameter("first step", IN_MOTION, {"half": {"first_step": 0.025}, "double": {"first_step": 0.1}}),
    Parameter("driven, steps", IN_MOTION, STEPS, expensive=("400,000",)),
    Parameter("displacements", IN_MOTION, {"small": {"drive": 100_000}}, walls=("turned-block",)),
    Parameter("modes", ("fem",), MODES, walls=("cell-1e10", "cell-1e11", "cell-1e12")),
    Parameter("modes", ("fem",), {"3": {"modes": 3}}, walls=("cell-shear",)),
    Parameter("mass scaling", ("fem",), OFF, walls=STIFF),
)


def settings_of(model: str, parameter: str, setting: str) -> dict[str, Any]:
    """Arguments of a model for a setting of a parameter; empty if no parameter is named."""
    for each in PARAMETERS if parameter else ():
        if each.name == parameter and model in each.models and setting in each.settings:
            return each.settings[setting]
    if parameter:
        raise KeyError(f"{model} has no parameter {parameter!r} with {setting!r}")
    return {}
