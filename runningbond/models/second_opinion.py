"""Check whether the collapse load of a wall depends on how soft blocks deform, with rigid blocks and a finer mesh.

Without dilatancy a wall has more than one collapse load, and blocks as soft as stone may lead it to another one,
because of their deformation or because of a coarse mesh. For a wall of 55 blocks of 10 GPa, one cell per half block
ends 3 % above three cells and above rigid blocks. Rigid blocks cost a fraction of deformable ones; only if they
collapse at another load is a finer mesh run, to show which of the two is at fault.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from runningbond.joints.stiffness import block_compliance
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene

SOFT_SHARE = 0.05
"""Share of the blocks in the compliance of a wall above which the blocks are soft."""

REFINEMENT = 3
"""Refinement of the finer mesh: its value of ``cells``, which is 1 by default."""

DEFAULTS: dict[str, Any] = {
    "cells": 1,
    "modes": None,
    "rule": None,
    "points": "elements",
    "cracks": "joints",
    "displacements": "small",
}
"""Default settings of `fem` for the deformation of blocks, their joint points, and the size of displacements."""

Solver: TypeAlias = Callable[[], Outcome]


def asks_others(scene: Scene, settings: Mapping[str, Any]) -> bool:
    """Whether other models are run: if a wall of only the softest blocks is soft, and all settings are `DEFAULTS`.

    With prescribed displacements of supports or a beam, or with ground motion, there is no bracket to compare.
    """
    materials = [scene.block_materials[k] for k in np.unique(scene.material_of_block[scene.wall & ~scene.is_beam])]
    moduli = [each.young for each in materials if each.young is not None]
    chosen = any(settings.get(key, of) not in (of, None) for key, of in DEFAULTS.items())
    if not moduli or scene.is_led or scene.history or chosen:
        return False
    softest = tuple(replace(each, young=min(moduli)) for each in scene.block_materials)
    return block_compliance(replace(scene, block_materials=softest)) > SOFT_SHARE


def beside_others(outcome: Outcome, rigid_blocks: Solver, finer_mesh: Solver) -> Outcome:
    """Compare a collapse of soft blocks with rigid blocks and, if these differ, with a finer mesh.

    Parameters
    ----------
    outcome
        Outcome of deformable blocks.
    rigid_blocks, finer_mesh
        Functions without arguments that compute the collapse of the same wall with these.

    Returns
    -------
    Outcome
        Unchanged if its bracket and that of rigid blocks have a load in common. Otherwise the bracket is extended to
        include that of the finer mesh, the multiplier is the smaller of the two, and the message states all three
        brackets; arrays are unchanged. Steps and seconds are the sums over all runs.
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
    message += f", on a mesh {REFINEMENT} times as fine {told}, without deforming {_loads(rigid)}"
    message += "; mechanism, curve and forces are those of blocks as they are"
    return replace(asked, multiplier=multiplier, lower=lower, upper=upper, message=message)


def share_loads(one: Outcome, other: Outcome) -> bool:
    """Whether the brackets of two collapses have a load in common."""
    (low, high), (lower, upper) = _bracket(one), _bracket(other)
    return low <= upper and lower <= high


def _with_effort(outcome: Outcome, other: Outcome) -> Outcome:
    """An outcome with the steps and seconds of another one added."""
    steps = (outcome.steps or 0) + (other.steps or 0)
    return replace(outcome, steps=steps, seconds=outcome.seconds + other.seconds)


def _bracket(outcome: Outcome) -> tuple[float, float]:
    """Bracket of a collapse, which always has both ends."""
    assert outcome.lower is not None
    assert outcome.upper is not None
    return outcome.lower, outcome.upper


def _loads(outcome: Outcome) -> str:
    return "–".join(map(number, _bracket(outcome)))
