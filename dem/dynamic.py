"""Model ``dem-dynamic``: rigid blocks by molecular dynamics, each load held until the wall rests or falls.

The paper's first solver (Sec. 3): explicit central differences of every block's motion, Coulomb's law on the joint
forces. Damping only serves to come to rest: local damping, which does not know the wall's frequencies, and a little
stiffness-proportional viscosity, without which sliding contacts chatter and local damping drags on the chatter
until a collapse looks like creep.
"""

import time
from dataclasses import replace

import numpy as np

from dynamics import Criteria, LoadSteps, Run, State, drive, load_steps, settle
from results import Outcome
from scene import Array, Scene

from .equilibrium import equilibrium
from .finite_system import finite_system
from .kinematics import fastest_corner_by_one, lowest_block
from .limit import FALLS, locks
from .rigid_system import rigid_system

LOCAL, VISCOUS = 0.5, 0.1
"""Local damping α, and the joints' viscous damping ratio at the highest frequency."""

COLLAPSE = 0.05
"""Displacement that counts as collapse, in heights of the lowest block."""

FIRST_STEP = 0.1
"""First load step, in live loads as large as the largest dead one (for a weightless wall, as the strongest joint)."""

UNACCOUNTED = 0.01
"""Share of the work of the loads that may be missing from the energy ledger before a run is not believed."""

MOST = 1e6
"""Multiplier, in first steps, beyond which no collapse is looked for."""


def dem_dynamic(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    collapse: float = COLLAPSE,
    first_step: float = FIRST_STEP,
    budget: int = 2_000_000,
) -> Outcome:
    """Collapse of a scene by the motion of its rigid blocks, at small displacements.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness, on which the collapse load hardly depends.
    tolerance
        Relative width of the bracket.
    collapse
        Displacement of a block that counts as collapse, in heights of the lowest block.
    first_step
        First load step; steps grow while they are borne and are bisected once one is not.
    budget
        Time steps after which a load is left undecided.

    Returns
    -------
    Outcome
        `lower` is the largest multiplier under which the wall came to rest, `upper` the smallest under which
        it fell. `curve` has every state at rest, and ends in the fall.
    """
    start = time.perf_counter()
    system = rigid_system(scene)
    run = Run(system, local=LOCAL, viscous=VISCOUS)
    criteria = Criteria(collapse=collapse * lowest_block(scene), budget=budget)
    unit = system.force_unit / float(np.abs(system.live).max())
    found = load_steps(run, first_step * unit, tolerance, criteria, most=first_step * unit * MOST)
    outcome = Outcome(scene.title, "dem-dynamic", "undecided", dofs=system.freedoms, steps=found.taken)
    outcome = _judge(outcome, scene, run, found)
    return replace(outcome, seconds=time.perf_counter() - start)


def finite_pushover(scene: Scene, distance: float, *, steps: int = 2_000_000, local: float = 0.2) -> Array:
    """Pushover curve of a dry scene at finite displacements, past its peak.

    Blocks turn, and with them the faces that corners rest on. The wall is pushed at a constant work-conjugate
    speed; slower pushes (more `steps`) lower the peak until it settles.

    Parameters
    ----------
    scene
        The scene: dry joints with a stiffness, on a base or a fixed first course.
    distance
        Displacement of the control point at which to stop [m].
    steps
        Time steps of the push, if everything moves as far as the control point.
    local
        Local damping; less than at rest, for it drags on what moves.

    Returns
    -------
    (n, 2) float
        Displacement of the control point [m] and λ.

    Raises
    ------
    SceneError
        For a scene that is not of this kind.
    """
    run = Run(finite_system(scene), local=local, viscous=VISCOUS)
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=COLLAPSE * lowest_block(scene)))
    return drive(run, state, distance, steps, pieces=400).curve


def _judge(outcome: Outcome, scene: Scene, run: Run, found: LoadSteps) -> Outcome:
    if found.borne is None:
        if found.verdict == "collapse":
            return replace(outcome, status="infeasible", message=FALLS)
        return replace(outcome, message="the budget ran out before the wall came to rest under its dead load")
    if found.upper is None or found.lower is None or found.fallen is None:
        if found.verdict != "undecided" or not locks(equilibrium(scene)):
            message = "the budget ran out: the wall neither rested nor fell"
            return replace(outcome, lower=found.lower, message=message)
        return replace(
            outcome,
            status="unbounded",
            message="self-locking: borne up to every load tried, and joint forces balance any multiple of it",
        )
    outcome = replace(
        outcome,
        lower=found.lower,
        upper=found.upper,
        curve=_curve(run, found),
        motion=_mechanism(scene, run, found),
        force=_forces(run, found.borne),
    )
    lost = _unaccounted(run, found.fallen)
    if lost > UNACCOUNTED:
        return replace(outcome, status="failed", message=f"{lost:.1%} of the work of the loads is unaccounted for")
    if found.verdict == "undecided":
        return replace(outcome, message="the budget ran out inside this bracket: the wall neither rested nor fell")
    return replace(
        outcome,
        status="collapse",
        multiplier=(found.lower + found.upper) / 2,
        message="largest load at rest and smallest in collapse, small displacements; "
        f"work accounted for to {max(lost, 1e-6):.0e} of it",
    )


def _unaccounted(run: Run, state: State) -> float:
    """Share of the work of the loads that the energy ledger misses."""
    ledger = run.ledger(state)
    return abs(ledger.residual) / abs(ledger.external) if ledger.external else 0.0


def _curve(run: Run, found: LoadSteps) -> Array:
    """Control displacement and multiplier of the states at rest, then of the fall."""
    rows = [(run.system.control @ state.motion, multiplier) for multiplier, state in found.rests]
    if found.fallen is not None and found.upper is not None:
        rows.append((run.system.control @ found.fallen.motion, found.upper))
    return np.array(rows)


def _mechanism(scene: Scene, run: Run, found: LoadSteps) -> Array:
    """What moved between the last rest and the fall, its fastest corner by one metre."""
    if found.fallen is None or found.borne is None:
        return np.zeros((0, 3))
    moved = run.motion_of_blocks(found.fallen) - run.motion_of_blocks(found.borne)
    return fastest_corner_by_one(scene.blocks, moved.reshape(-1, 3))


def _forces(run: Run, state: State) -> Array:
    """Forces at the contact points in the order of `Equilibrium.points`, ``(np, 2)`` [N]."""
    forces = np.column_stack(run.forces(state))
    n = len(forces) // 2
    return np.stack([forces[:n], forces[n:]], axis=1).reshape(-1, 2)
