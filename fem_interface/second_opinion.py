"""Whether the way in which soft blocks deform decides where a wall falls: rigid blocks and a finer mesh are asked.

Without dilatancy a wall has more than one collapse load, and blocks as soft as stone may lead it to another one, for
how they deform or for how coarsely that is meshed. On a wall of 55 blocks of 10 GPa one cell in half a block ends 3 %
above three cells and above rigid blocks. Rigid blocks cost a fraction of deformable ones; only where they fall at
another load a finer mesh says which of both is at fault.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from runningbond.joints.stiffness import block_compliance
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene

SOFT = 0.05
"""Share of the blocks in the compliance of a wall from which they are soft."""

FINER = 3
"""Cells of the finer mesh in each of the usual one."""

Solver: TypeAlias = Callable[[], Outcome]


def is_soft(scene: Scene) -> bool:
    """Whether blocks of any material are so soft that others are asked where the wall falls."""
    moduli = [each.young for each in scene.block_materials if each.young is not None]
    return bool(moduli) and block_compliance(scene.with_block(young=min(moduli))) > SOFT


def beside_others(outcome: Outcome, without: Solver, finer_by: Solver) -> Outcome:
    """A collapse of soft blocks, with what rigid blocks and those of a finer mesh make of it where they differ.

    Parameters
    ----------
    outcome
        That of deformable blocks.
    without, finer_by
        Find the collapse of the same wall of rigid blocks, and on the finer mesh.

    Returns
    -------
    Outcome
        As it was where rigid blocks fall at a load that its bracket has as well; else the bracket takes in that of
        the finer mesh, and the message has all three.
    """
    if outcome.status != "collapse":
        return outcome
    rigid = without()
    steps = (outcome.steps or 0) + (rigid.steps or 0)
    if rigid.status != "collapse":
        unknown = f"{outcome.message}; with blocks that do not deform {rigid.status}: {rigid.message}"
        return replace(outcome, steps=steps, message=unknown)
    if _share_loads(outcome, rigid):
        return replace(outcome, steps=steps)
    finer = finer_by()
    fell = finer.status == "collapse"
    told = _loads(finer) if fell else finer.status
    message = f"{outcome.message}; how blocks deform decides where this wall falls: as they are {_loads(outcome)}"
    message += f", on a mesh {FINER} times as fine {told}, without deforming {_loads(rigid)}"
    brackets = [outcome, finer] if fell else [outcome]
    lower, upper = min(each.lower or 0.0 for each in brackets), max(each.upper or 0.0 for each in brackets)
    multiplier = (lower + upper) / 2
    steps += finer.steps or 0
    return replace(outcome, multiplier=multiplier, lower=lower, upper=upper, steps=steps, message=message)


def _share_loads(one: Outcome, other: Outcome) -> bool:
    """Whether two brackets have a load in common."""
    if one.lower is None or one.upper is None or other.lower is None or other.upper is None:
        return False
    return one.lower <= other.upper and other.lower <= one.upper


def _loads(outcome: Outcome) -> str:
    assert outcome.lower is not None
    assert outcome.upper is not None
    return f"{number(outcome.lower)}–{number(outcome.upper)}"
