"""A linear program that is solved again and again with other bounds and costs, each time from the last one's corner.

Where bounds change, a corner stays optimal but for them, and the dual simplex method goes on from it; where costs
change it stays admissible, and the primal one does. Beside a cold start with presolve, interior point and crossover
that is two to ten times cheaper up to some hundred blocks (`scipy.optimize.linprog` has no such entry, hence highspy).
"""

import highspy
import numpy as np
from scipy.sparse import csc_array

from runningbond.scene import Array

from .force_program import ProgramStatus

DUAL, PRIMAL = 1, 4
"""HiGHS's numbers of the simplex methods."""

INTERIOR = 0
"""Interior point and crossover instead, which start from no corner but end at one."""

OPTIONS: dict[str, bool | int | float | str] = {
    "threads": 1,
    "parallel": "off",
    "presolve": "off",
    "solver": "simplex",
    "simplex_scale_strategy": 0,  # `Equilibrium` has scaled the equations; scaled again, infeasibility stays unseen
    "primal_simplex_bound_perturbation_multiplier": 0.0,  # or corners on the way are not within bounds
}

WIDE, FINE = 1e4, 1e-9
"""Largest coefficient above which HiGHS's tolerance, else 1e-7, is finer: forces of a small block on a huge one."""

_STATUS: dict[highspy.HighsModelStatus, ProgramStatus] = {
    highspy.HighsModelStatus.kOptimal: "optimal",
    highspy.HighsModelStatus.kIterationLimit: "budget",
    highspy.HighsModelStatus.kInfeasible: "infeasible",
    highspy.HighsModelStatus.kUnbounded: "unbounded",
}


class _Quiet(highspy.Highs):
    """HiGHS that prints nothing: 1.16 announces itself to standard output before an option can be set."""

    def enableCallbacks(self) -> None:  # noqa: N802 - HiGHS's own name, of the last call that its making takes
        self.setOptionValue("output_flag", False)
        super().enableCallbacks()  # type: ignore[no-untyped-call]


class Simplex:
    """min c·x, A x = b, low ≤ x ≤ high, with the matrix ``(m, n)`` and right-hand side ``(m,)`` of all programs."""

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
        if np.abs(matrix.data).max(initial=0.0) > WIDE:
            self._highs.setOptionValue("primal_feasibility_tolerance", FINE)
            self._highs.setOptionValue("dual_feasibility_tolerance", FINE)
        self._highs.passModel(program)

    @property
    def corner(self) -> highspy.HighsBasis:
        """The last program's corner."""
        return self._highs.getBasis()

    def go_to(self, corner: highspy.HighsBasis | None) -> None:
        """Start the next program from a corner, or from nothing, so that it does not depend on those before."""
        self._highs.clearSolver()
        if corner is not None and corner.valid:
            self._highs.setBasis(corner)

    def solve(
        self, low: Array, high: Array, cost: Array, method: int = DUAL, pivots: int | None = None
    ) -> tuple[ProgramStatus, Array, Array]:
        """Status, x ``(n,)`` and multipliers of equations ``(m,)`` of a program.

        After so many `pivots` the status is ``budget``, and x a corner but not the best, if the method is primal.
        """
        highs = self._highs
        highs.setOptionValue("solver", "ipm" if method == INTERIOR else "simplex")
        highs.setOptionValue("presolve", "on" if method == INTERIOR else "off")
        highs.setOptionValue("simplex_strategy", method or DUAL)
        highs.setOptionValue("simplex_iteration_limit", highspy.kHighsIInf if pivots is None else pivots)
        highs.changeColsBounds(self._size, self._every, low, high)
        highs.changeColsCost(self._size, self._every, cost)
        highs.run()
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
