"""Linear programs over forces by Clarabel's interior point, in their dual form over mechanisms (Goulart & Chen 2024).

The dual of `force_program` has three unknowns per block instead of about twelve; its conic multipliers are the forces:

    min −b·y + (u − l)·w,   a_j·y ≤ c_j,   a_j·y − w_j ≤ c_j with w ≥ 0 for forces bounded on both sides.

The result is near an optimum and inside all bounds, but it satisfies equilibrium and flow rule only approximately;
`repair` turns it into a proof. It is no vertex: if several mechanisms collapse at the same load, or several states of
force exist, the result is a mix of them.
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

COMPLIANCE_BOUND = 1e4
"""Bound of `InteriorPoint.compliance` and of its inverse; beyond it rounding errors dominate."""

ROUGH_TOLERANCE = 1e-6
"""Relative tolerance of programs that only update pressures, and of those that check whether forces exist."""

FAER_EQUATIONS = 20_000
"""Number of equations above which supernodal factorisation (faer) is used; for 60 000 it takes a third of the time of a
simple one."""


@dataclass(frozen=True, eq=False)
class InteriorPoint:
    """Final iterate of the interior point, in the unknowns of a `force_program` with n forces and m equations.

    Parameters
    ----------
    status, iterations
        Status reported by Clarabel, and number of iterations.
    forces, motion : (n,) float, (m,) float
        Approximate optimum, and its multipliers of equations.
    slack : (n,) float
        Reduced costs c − Aᵀ y according to the solver; not negative for forces within bounds.
    compliance : (n,) float
        Distance of each force from its bounds over that of its point from closing, scaled by largest force and motion.
    interrupted
        Whether Ctrl-C ended the iteration.
    """

    status: ProgramStatus
    iterations: int
    forces: Array
    motion: Array
    slack: Array
    compliance: Array
    interrupted: bool = False


def interior_point(program: dict[str, Any], tolerance: float, *, unfinished: bool = False) -> InteriorPoint:
    """Solve a `force_program` to a relative tolerance; Ctrl-C raises, or returns the last iterate if `unfinished`."""
    matrix, (low, high) = program["A_eq"], program["bounds"].T
    m, free, boxed = matrix.shape[0], np.isinf(low), np.isfinite(high) & (low < high)
    half = ~free & np.isinf(high)
    # Free unknowns come first, because their rows are equations; those with two bounds last. Fixed ones are left out.
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
        stiffness[np.isnan(stiffness)] = unit  # 0 / 0: neither force nor motion
        compliance[order] = (unit / stiffness).clip(1 / COMPLIANCE_BOUND, COMPLIANCE_BOUND)
    compliance[free] = COMPLIANCE_BOUND
    return InteriorPoint(
        _status(str(solution.status)), solution.iterations, forces, motion, slack, compliance, bool(interruptions)
    )


def near(system: Equilibrium, forces: ForceSet, aim: Aim = "largest") -> ForceSolution:
    """Approximate forces of a set at the largest or smallest load; they are only nearly balanced."""
    point = interior_point(force_program(system, forces, aim), ROUGH_TOLERANCE)
    return replace(solution_of(system, forces, "optimal", point.forces, point.motion, 0), status=point.status)


def _listeners() -> dict[int, Callable[[int, FrameType | None], Any]]:
    """Handlers of Ctrl-C and SIGTERM; none outside the main thread, where handlers cannot be replaced."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    found = {int(number): signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    return {number: listener for number, listener in found.items() if callable(listener)}


@contextmanager
def _ended_by_signals(solver: Any) -> Iterator[list[int]]:
    """Let Ctrl-C and SIGTERM, which the solver would ignore, end it after its current iteration.

    The replaced handler of the first signal is called afterwards; its KeyboardInterrupt is suppressed.
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
    """Finish a proof, which takes seconds after hours of solving, although Ctrl-C or SIGTERM comes once.

    The replaced handlers are called at once, but their KeyboardInterrupt is suppressed; a second signal raises it.
    """
    received, listeners = list[int](), _listeners()

    def handle(number: int, frame: FrameType | None) -> None:
        received.append(number)
        try:
            listeners[number](number, frame)
        except KeyboardInterrupt:
            if len(received) > 1:
                raise

    for number in listeners:
        signal.signal(number, handle)
    try:
        yield received
    finally:
        for number, listener in listeners.items():
            if signal.getsignal(number) is handle:  # the replaced handler may have installed another one
                signal.signal(number, listener)


def _settings(tolerance: float, equations: int) -> Any:
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.equilibrate_enable = False  # `Equilibrium` has scaled the equations; more scaling costs iterations
    settings.direct_solve_method = "faer" if equations > FAER_EQUATIONS else "qdldl"
    settings.iterative_refinement_enable = False  # saves a quarter of the time, and the result is repaired anyway
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
    return settings


def _status(status: str) -> ProgramStatus:
    """Status of the program of forces, whose dual is the program of mechanisms that Clarabel solves."""
    if "PrimalInfeasible" in status:
        return "unbounded"
    if "DualInfeasible" in status:
        return "infeasible"
    if "Callback" in status:
        return "budget"
    return "optimal" if "Solved" in status else "numerical"
