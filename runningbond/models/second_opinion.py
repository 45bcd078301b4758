"""Whether the way in which soft blocks deform decides where a wall falls: rigid blocks and a finer mesh are asked.

Without dilatancy a wall has more than one collapse load, and blocks as soft as stone may lead it to another one, for
how they deform or for how coarsely that is meshed. On a wall of 55 blocks of 10 GPa one cell in half a block ends 3 %
above three cells and above rigid blocks. Rigid blocks cost a fraction of deformable ones; only where they fall at
another load a finer mesh says which of both is at fault.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from runningbond.joints.stiffness import block_compliance
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene

SOFT = 0.05
"""Share of the blocks in the compliance of a wall from which they are soft."""

FINER = 3
"""Cells of the finer mesh in each of the usual one."""

USUAL: dict[str, Any] = {
    "cells": 1,
    "modes": None,
    "rule": None,
    "points": "elements",
    "cracks": "joints",
    "displacements": "small",
}
"""Settings of `fem` by which nobody has chosen how blocks deform, where they touch, and how far they go."""

Solver: TypeAlias = Callable[[], Outcome]


def asks_others(scene: Scene, settings: Mapping[str, Any]) -> bool:
    """Whether others are asked where a wall falls: where blocks of some material are soft, and meshed as usual.

    Where supports or a beam are led, or the ground moves, there is no bracket of loads to compare.
    """
    materials = [scene.block_materials[k] for k in np.unique(scene.material_of_block[scene.wall & ~scene.is_beam])]
    moduli = [each.young for each in materials if each.young is not None]
    if not moduli or scene.is_led or scene.history or any(settings.get(key, of) != of for key, of in USUAL.items()):
        return False
    softest = tuple(replace(each, young=min(moduli)) for each in scene.block_materials)
    return block_compliance(replace(scene, block_materials=softest)) > SOFT


def beside_others(outcome: Outcome, rigid_blocks: Solver, finer_mesh: Solver) -> Outcome:
    """A collapse of soft blocks, with what rigid blocks and those of a finer mesh make of it where they differ.

    Parameters
    ----------
    outcome
        That of deformable blocks.
    rigid_blocks, finer_mesh
        Find the collapse of the same wall by those, without arguments.

    Returns
    -------
    Outcome
        As it was where rigid blocks fall at a load that its bracket has as well; else the bracket takes in that of
        the finer mesh, its multiplier is the smaller of both, and the message has all three; arrays stay as they were.
        Steps and seconds are those of all that were asked.
    """
    if outcome.status != "collapse":
        return outcome
    rigid = rigid_blocks()
    asked = _with_effort(outcome, rigid)
    if rigid.status != "collapse":
        return replace(
            asked, message=f"{outcome.message}; with blocks that do not deform {rigid.status}: {rigid.message}"
        )
    if share_loads(outcome, rigid):
        return asked
    finer = finer_mesh()
    found = [outcome, finer] if finer.status == "collapse" else [outcome]
    asked, told = _with_effort(asked, finer), _loads(finer) if len(found) > 1 else finer.status
    (lower, *_), (*_, upper) = (sorted(ends) for ends in zip(*map(_bracket, found), strict=True))
    multiplier = min(each.multiplier for each in found if each.multiplier is not None)
    message = f"{outcome.message}; how blocks deform decides where this wall falls: as they are {_loads(outcome)}"
    message += f", on a mesh {FINER} times as fine {told}, without deforming {_loads(rigid)}"
    message += "; mechanism, curve and forces are those of blocks as they are"
    return replace(asked, multiplier=multiplier, lower=lower, upper=upper, message=message)


def share_loads(one: Outcome, other: Outcome) -> bool:
    """Whether the brackets of two collapses have a load in common."""
    (low, high), (lower, upper) = _bracket(one), _bracket(other)
    return low <= upper and lower <= high


def _with_effort(outcome: Outcome, other: Outcome) -> Outcome:
    """An outcome with the steps and seconds of another one besides its own."""
    steps = (outcome.steps or 0) + (other.steps or 0)
    return replace(outcome, steps=steps, seconds=outcome.seconds + other.seconds)


def _bracket(outcome: Outcome) -> tuple[float, float]:
    """Bracket of a collapse, which has both ends."""
    assert outcome.lower is not None
    assert outcome.upper is not None
    return outcome.lower, outcome.upper


def _loads(outcome: Outcome) -> str:
    return "–".join(map(number, _bracket(outcome)))
