"""Sequences of programs that end at a mechanism which can be certified, after Gilbert, Casapulla & Ahmed (2006).

Each program freezes the shear resistance of every point at μ times a pressure, which is updated between programs. The
update averages old and new pressures, with weights (k + 1)^(−1/2) in program k, which converge where fixed weights may
oscillate, or with fixed weights, which converge to other mechanisms. The result depends on the initial pressure.
"""

from collections.abc import Iterator

from runningbond.scene import Array

from .certificates import Certificate, certify
from .descent import Descent
from .force_program import Aim, ForceSet, ForceSolution
from .simplex import PRIMAL

SHORT = 16
"""Largest number of programs of a short sequence."""

WEIGHTS = (0.6, 1.0, None, 0.3)
"""Weights of the new pressure in short sequences, used in turn; None stands for (k + 1)^(−1/2)."""


def short_sequence(descent: Descent, pressure: Array, weight: float | None) -> Iterator[Certificate]:
    """Run a short sequence from a first pressure ``(np,)`` to its first certificate."""
    for k in range(SHORT):
        program = descent.programs.frozen(pressure)
        if program.status != "optimal":
            return
        known = len(descent.known)
        if descent.least(program.motion) is not None:
            if len(descent.known) > known:  # otherwise the search has already continued from this mechanism
                certificate = certified(descent, program.motion)
                if certificate is not None:
                    yield certificate
            return
        pressure = averaged(pressure, program.pressure, weight or (k + 1.0) ** -0.5)


def certified(descent: Descent, motion: Array) -> Certificate | None:
    """Find the loads that drive a mechanism ``(nd,)`` as `certify` does, by programs of the search."""

    def extreme(forces: ForceSet, aim: Aim) -> ForceSolution | None:
        return descent.least(motion) if aim == "smallest" else descent.programs.extreme(forces, -1.0, PRIMAL)

    return certify(descent.system, motion, extreme)


def averaged(pressure: Array, new: Array, weight: float) -> Array:
    """Weighted mean of old and new pressures ``(np,)``, for the next program."""
    return (1 - weight) * pressure + weight * new
