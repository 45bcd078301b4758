"""What the study runs: cases, in the order in which they are measured."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Literal, TypeAlias

from .parameters import COLLAPSE, KNOBS, settings_of
from .walls import Wall, accuracy_walls, growth_walls, stiffness_walls

Part: TypeAlias = Literal["accuracy", "growth", "stiffness"]

ASKED = {
    "collapse": ("homog", *COLLAPSE),
    "turned block": ("dem-dynamic", "fem"),
    "compression": ("homog", "dem-static", "fem"),
    "shear": ("homog", "dem-static", "fem"),
    "physical second": ("dem-dynamic", "fem"),
}
"""Models that are asked each question."""


@dataclass(frozen=True)
class Case:
    """One model on one wall, as it is or with one of its knobs turned.

    Parameters
    ----------
    part
        Part of the study.
    wall, model
        Their names.
    knob, setting
        What is turned, and to what; empty where nothing is.
    """

    part: Part
    wall: str
    model: str
    knob: str = ""
    setting: str = ""

    def __str__(self) -> str:
        turned = f", {self.knob} {self.setting}" if self.knob else ""
        return f"{self.wall}, {self.model}{turned}"


def walls_of(part: Part) -> dict[str, Wall]:
    """Walls of a part of the study, by name."""
    return {"accuracy": accuracy_walls, "growth": growth_walls, "stiffness": stiffness_walls}[part]()


def wall_of(case: Case) -> Wall:
    """The wall that a case is about."""
    return walls_of(case.part)[case.wall]


@cache
def all_cases() -> tuple[Case, ...]:
    """The whole study: every model on every wall, what is dear last, and every knob that it has there."""
    return (*_accuracy(), *_stiffness(), *_growth())


def _accuracy() -> Iterator[Case]:
    for name, wall in accuracy_walls().items():
        for model in ASKED[wall.question]:
            if model == "homog" and wall.question == "collapse" and wall.known != "certified":
                continue  # a continuum of one block, or one that is no running bond, says nothing
            if name != "cell-shear" or model != "fem":  # deformable blocks have no closed form
                yield Case("accuracy", name, model)
            yield from _turned("accuracy", name, model)


def _growth() -> Iterator[Case]:
    for name in growth_walls():
        for model in COLLAPSE:
            yield Case("growth", name, model)


def _stiffness() -> Iterator[Case]:
    for name in stiffness_walls():
        yield Case("stiffness", name, "fem")
        yield from _turned("stiffness", name, "fem")
    yield Case("stiffness", name, "dem-dynamic")


def _turned(part: Part, wall: str, model: str) -> Iterator[Case]:
    for knob in KNOBS:
        if model in knob.models and wall in knob.walls:
            for setting in knob.settings:
                if setting not in knob.dear or wall in knob.cheap:
                    settings_of(model, knob.name, setting)
                    yield Case(part, wall, model, knob.name, setting)
