"""A linear program that is solved repeatedly with other bounds and costs, each time from the last vertex.

If bounds change, the last vertex stays dual feasible, and the dual simplex method continues from it; if costs change,
it stays primal feasible, and the primal method does. Up to some hundred blocks this costs two to ten times less than a
cold start with presolve, interior point and crossover (`scipy.optimize.linprog` has no warm start, hence highspy).
"""

import highspy
import numpy as np
from scipy.sparse import csc_array

from runningbond.scene import Array

from .force_program import ProgramStatus

DUAL, PRIMAL = 1, 4
"""HiGHS's numbers of the dual and primal simplex method."""

INTERIOR = 0
"""Method number for interior point and crossover, which start from no vertex but end at one."""

OPTIONS: dict[str, bool | int | float | str] = {
    "threads": 1,
    "parallel": "off",
    "presolve": "off",
    "solver": "simplex",
    "simplex_scale_strategy": 0,  # `Equilibrium` has scaled the equations; more scaling hides infeasibility
    "primal_simplex_bound_perturbation_multiplier": 0.0,  # otherwise intermediate vertices violate bounds
}

LEAST_SECONDS, SECONDS = 5.0, 1e-5
"""Time after which a program is given up: at least so long, and so long times the square of its number of columns.

Programs take far less. HiGHS 1.16 may never end on one, without counting any iterations.
"""

LARGE_COEFFICIENT, FINE_TOLERANCE = 1e4, 1e-9
"""Coefficient above which this tolerance replaces HiGHS's 1e-7, to resolve a small block's forces on a huge one."""

_STATUS: dict[highspy.HighsModelStatus, ProgramStatus] = {
    highspy.HighsModelStatus.kOptimal: "optimal",
    highspy.HighsModelStatus.kIterationLimit: "budget",
    highspy.HighsModelStatus.kInfeasible: "infeasible",
    highspy.HighsModelStatus.kUnbounded: "unbounded",
}


class _Quiet(highspy.Highs):
    """HiGHS without output: version 1.16 prints a banner to standard output before an option can be set."""

    def enableCallbacks(self) -> None:  # noqa: N802 - HiGHS's own name; its constructor calls this last
        self.setOptionValue("output_flag", False)
        super().enableCallbacks()  # type: ignore[no-untyped-call]


class Simplex:
    """min c·x, A x = b, low ≤ x ≤ high; all programs have the same matrix ``(m, n)`` and right-hand side ``(m,)``."""

    def __init__(self, matrix: csc_array, right: Array) -> None:
        rows, self._size = matrix.shape
        self._every = np.arange(self._size, dtype=np.int32)
        program = highspy.HighsLp()
        program.num_col_, program.num_row_ = self._size, rows
        program.col_cost_ = program.col_lower_ = program.col_upper_ = np.zeros(self._size)
        program.row_lower_ = program.row_upper_ = right
        program.a_matrix_.num_col_, program.a_matrix_.num_row_ = self._size, rows
        program.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        program.a_matrix_.start_, program.a_matrix_.index_ = matrix.indptr, matrix.indices
        program.a_matrix_.value_ = matrix.data
        self._highs = _Quiet()  # type: ignore[no-untyped-call]
        for name, value in OPTIONS.items():
            self._highs.setOptionValue(name, value)
        if np.abs(matrix.data).max(initial=0.0) > LARGE_COEFFICIENT:
            self._highs.setOptionValue("primal_feasibility_tolerance", FINE_TOLERANCE)
            self._highs.setOptionValue("dual_feasibility_tolerance", FINE_TOLERANCE)
        self._highs.passModel(program)
        self._seconds = max(LEAST_SECONDS, SECONDS * self._size**2)

    @property
    def vertex(self) -> highspy.HighsBasis:
        """Final vertex of the last program."""
        return self._highs.getBasis()

    def start_from(self, vertex: highspy.HighsBasis | None) -> None:
        """Start the next program from a vertex, or from none, so that it does not depend on earlier programs."""
        self._highs.clearSolver()
        if vertex is not None and vertex.valid:
            self._highs.setBasis(vertex)

    def solve(
        self, low: Array, high: Array, cost: Array, method: int = DUAL, pivots: int | None = None
    ) -> tuple[ProgramStatus, Array, Array]:
        """Return status, x ``(n,)`` and multipliers of equations ``(m,)`` of a program.

        After `pivots` iterations the status is ``budget``; with the primal method x is then a feasible vertex, but not
        optimal. A program that does not end is ``numerical``, and the next one starts from no vertex.
        """
        highs = self._highs
        highs.setOptionValue("solver", "ipm" if method == INTERIOR else "simplex")
        highs.setOptionValue("presolve", "on" if method == INTERIOR else "off")
        highs.setOptionValue("simplex_strategy", method or DUAL)
        highs.setOptionValue("simplex_iteration_limit", highspy.kHighsIInf if pivots is None else pivots)
        highs.changeColsBounds(self._size, self._every, low, high)
        highs.changeColsCost(self._size, self._every, cost)
        highs.setOptionValue("time_limit", highs.getRunTime() + self._seconds)  # HiGHS adds up the times of all runs
        highs.run()
        if highs.getModelStatus() == highspy.HighsModelStatus.kTimeLimit:
            highs.clearSolver()
            return "numerical", np.zeros(0), np.zeros(0)
        status = _STATUS.get(highs.getModelStatus(), "numerical")
        if (
            status == "budget"
            and highs.getInfo().primal_solution_status != highspy.SolutionStatus.kSolutionStatusFeasible
        ):
            status = "numerical"
        if status not in ("optimal", "budget"):
            return status, np.zeros(0), np.zeros(0)
        solution = highs.getSolution()
        return status, np.array(solution.col_value), np.array(solution.row_dual)
