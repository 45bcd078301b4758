"""Linear programs of forces by Clarabel's interior point, stated over mechanisms (Goulart & Chen 2024).

The dual of `force_program` has three unknowns a block in place of some twelve; its conic multipliers are the forces:

    min −b·y + (u − l)·w,   a_j·y ≤ c_j,   a_j·y − w_j ≤ c_j with w ≥ 0 for forces bounded on both sides.

What comes back is near an optimum and inside all bounds, but balances and obeys nothing exactly; `repair` makes a proof
of it. No vertex is looked for: of several mechanisms that collapse at the same load, and of several states of force,
it leaves a mix of all.
"""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from types import FrameType
from typing import Any

import clarabel
import numpy as np
from scipy.sparse import block_array, csc_array, csc_matrix, eye_array

from runningbond.scene import Array

from .equilibrium import Equilibrium
from .force_program import Aim, ForceSet, ForceSolution, ProgramStatus, force_program, solution_of

FARTHEST = 1e4
"""Largest and smallest stiffness of a force in `InteriorPoint.compliance`, relative; farther apart rounding wins."""

ROUGH = 1e-6
"""Relative tolerance of programs that only bring pressures up to date, and of whether there are forces."""

SUPERNODAL = 20_000
"""Equations above which dense blocks of the factors pay (faer): a third of the time of a simple one on 60 000."""


@dataclass(frozen=True, eq=False)
class InteriorPoint:
    """Where the interior point came to rest, in the unknowns of a `force_program` with n forces and m equations.

    Parameters
    ----------
    status, iterations
        What Clarabel thinks of it.
    forces, motion : (n,) float, (m,) float
        Approximate optimum, and its multipliers of equations.
    slack : (n,) float
        Reduced costs c − Aᵀ y that the solver means to have; of forces within bounds they are not negative.
    compliance : (n,) float
        How far each force is from its bounds beside how far its point is from closing, relative: 1 in the middle.
    interrupted
        Whether Ctrl-C ended it on the way.
    """

    status: ProgramStatus
    iterations: int
    forces: Array
    motion: Array
    slack: Array
    compliance: Array
    interrupted: bool = False


def interior_point(program: dict[str, Any], tolerance: float, *, unfinished: bool = False) -> InteriorPoint:
    """Solve a `force_program` to a relative tolerance; Ctrl-C raises, or leaves what is `unfinished`."""
    matrix, (low, high) = program["A_eq"], program["bounds"].T
    m, free, boxed = matrix.shape[0], np.isinf(low), np.isfinite(high) & (low < high)
    half = ~free & np.isinf(high)
    # Free ones first, for their rows are equations; what is boxed last. What is fixed is no unknown.
    order = np.concatenate([np.flatnonzero(kind) for kind in (free, half, boxed)])
    n, n_boxed, n_free = len(order), int(boxed.sum()), int(free.sum())
    least = np.where(free, 0.0, low)
    at_least = csc_array((-np.ones(n_boxed), (np.arange(n - n_boxed, n), np.arange(n_boxed))), shape=(n, n_boxed))
    rows = block_array([[matrix[:, order].T, at_least], [csc_array((n_boxed, m)), -eye_array(n_boxed)]])
    range_ = (high - low)[boxed]
    cost = np.concatenate([matrix @ least - program["b_eq"], range_])
    right = np.concatenate([program["c"][order], np.zeros(n_boxed)])
    cones = [clarabel.ZeroConeT(n_free), clarabel.NonnegativeConeT(n + n_boxed - n_free)]
    nothing = csc_matrix((len(cost), len(cost)))
    solver = clarabel.DefaultSolver(nothing, cost, csc_matrix(rows), right, cones, _settings(tolerance, m))
    with _ended_by_signals(solver) as interruptions:
        solution = solver.solve()
    if interruptions and not unfinished:
        raise KeyboardInterrupt

    dual, slacks = np.array(solution.z), np.array(solution.s)
    forces, slack, compliance = least.copy(), np.zeros(len(low)), np.zeros(len(low))
    forces[order] += dual[:n]
    slack[order] = slacks[:n]
    slack[boxed] -= slacks[n:]
    motion = np.array(solution.x)[:m]
    unit = (np.abs(motion).max() or 1.0) / (dual[:n].max(initial=0.0) or 1.0)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        stiffness = slacks[:n] / dual[:n]
        stiffness[n - n_boxed :] += slacks[n:] / dual[n:]
        stiffness[np.isnan(stiffness)] = unit  # 0 / 0: neither bears anything nor moves
        compliance[order] = (unit / stiffness).clip(1 / FARTHEST, FARTHEST)
    compliance[free] = FARTHEST
    return InteriorPoint(
        _status(str(solution.status)), solution.iterations, forces, motion, slack, compliance, bool(interruptions)
    )


def near(system: Equilibrium, forces: ForceSet, aim: Aim = "largest") -> ForceSolution:
    """Forces of a set near those at the largest or smallest load, and near balance."""
    point = interior_point(force_program(system, forces, aim), ROUGH)
    return replace(solution_of(system, forces, "optimal", point.forces, point.motion, 0), status=point.status)


def _listeners() -> dict[int, Callable[[int, FrameType | None], Any]]:
    """Who listens for Ctrl-C and SIGTERM; nobody in a thread, where no other may be put in their place."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    found = {int(number): signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    return {number: listener for number, listener in found.items() if callable(listener)}


@contextmanager
def _ended_by_signals(solver: Any) -> Iterator[list[int]]:
    """Let Ctrl-C and SIGTERM, from which it would not look up, end a solver after its iteration.

    Who listens for them hears of it.
    """
    received, listeners = list[int](), _listeners()
    if not listeners:
        yield received
        return
    solver.set_termination_callback(lambda _: bool(received))
    for number in listeners:
        signal.signal(number, lambda number, _: received.append(number))
    try:
        yield received
    finally:
        for number, listener in listeners.items():
            signal.signal(number, listener)
    if received:
        with suppress(KeyboardInterrupt):
            listeners[received[0]](received[0], None)


@contextmanager
def finishing() -> Iterator[list[int]]:
    """Finish what takes seconds and makes a proof of hours although Ctrl-C or SIGTERM comes, once.

    Who listens for them hears of it at once, without an end to this; a second one ends it.
    """
    received, listeners = list[int](), _listeners()

    def hear(number: int, frame: FrameType | None) -> None:
        received.append(number)
        try:
            listeners[number](number, frame)
        except KeyboardInterrupt:
            if len(received) > 1:
                raise

    for number in listeners:
        signal.signal(number, hear)
    try:
        yield received
    finally:
        for number, listener in listeners.items():
            if signal.getsignal(number) is hear:  # who has heard may have let go of it
                signal.signal(number, listener)


def _settings(tolerance: float, equations: int) -> Any:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.equilibrate_enable = False  # `Equilibrium` has scaled the equations, and more takes more iterations
    settings.direct_solve_method = "faer" if equations > SUPERNODAL else "qdldl"
    settings.iterative_refinement_enable = False  # a quarter of the time, for what is repaired afterwards
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    return settings


def _status(status: str) -> ProgramStatus:
    """Status of the program of forces; that of mechanisms is its dual."""
    if "PrimalInfeasible" in status:
        return "unbounded"
    if "DualInfeasible" in status:
        return "infeasible"
    if "Callback" in status:
        return "budget"
    return "optimal" if "Solved" in status else "numerical"
