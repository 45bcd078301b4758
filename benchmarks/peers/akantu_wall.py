"""Akantu: triangles and cohesive joint elements with friction, by explicit central differences.

The cost of a step, and the difference of the two programs, are measured by ``akantu_step.py``; this module measures
the cost of a load. With stiff blocks (1000 GPa, as in the paper) the stable step is a microsecond; the suite scales
masses, and its steps are longer by an order of magnitude. No bracket is computed, because that would take from five
minutes to hours. Instead the cost of the motion between two looks (`load_steps`) is measured, and the same for `fem`,
in one process. A load takes at least eight such intervals, from rest to rest.
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
from akantu_step import LOAD, AkantuWall, as_in_akantu, free_run, read_materials
from load_steps import LOOK, Bracket
from peer import Peer

from fem_interface.modal_wall import modal_wall
from fem_interface.system import system_of
from runningbond.dynamics import Run, State
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.scene import Scene

SHARE = 10
"""Akantu runs 1 / `SHARE` of the time between two looks; the measured cost is multiplied by `SHARE`."""

PEER = Peer(
    name="Akantu",
    package="akantu",
    kind="deformable blocks",
    rivals=("fem",),
    does="cracks through blocks, in two and three dimensions, on clusters; many materials",
    does_not="scale masses for stiff blocks; friction without a little tensile strength; pressed joints that have not "
    "slipped (NaN)",
)


def bracket(scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Measure the cost of motion between two looks; no bracket is computed."""
    import akantu

    read_materials(akantu, scene)
    free = free_run(as_in_akantu(scene))
    wall = modal_wall(scene)
    theirs = AkantuWall(akantu, wall, free.dt)
    run = Run(system_of(wall), local=LOCAL, viscous=VISCOUS)
    state = State.at_rest(run.system)
    run.hold(state, LOAD, 1)  # compiled before it is timed
    spent = SHARE * seconds(partial(theirs.advance, round(LOOK / SHARE / free.dt)))
    ours = seconds(partial(run.hold, state, LOAD, round(LOOK / run.dt)))
    if not np.isfinite(theirs.displacement).all():
        raise RuntimeError("Akantu's motion is not finite")
    message = f"{LOOK} s of motion take it {spent:.1f} s of processor time, `fem` {ours:.2f} s"
    return Bracket(None, None, "cost only", 0, message, ratio=spent / ours)


def seconds(call: Callable[[], None]) -> float:
    """Processor time of a call."""
    start = time.process_time()
    call()
    return time.process_time() - start
