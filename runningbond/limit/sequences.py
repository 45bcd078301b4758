"""Sequences of programs that end at a mechanism which can be certified, after Gilbert, Casapulla & Ahmed (2006).

Each program freezes every point's shear resistance at μ times a pressure that is brought up to date between programs:
averaged with weights (k + 1)^(−1/2) in program k, which settles where fixed weights keep wandering, or with fixed ones,
which settle elsewhere. What a sequence settles at depends on the pressure that it starts from.
"""

from collections.abc import Iterator

from runningbond.scene import Array

from .certificates import Certificate, certify
from .descent import Descent
from .force_program import Aim, ForceSet, ForceSolution
from .simplex import PRIMAL

SHORT = 16
"""Programs after which a short sequence ends without a certificate."""

WEIGHTS = (0.6, 1.0, None, 0.3)
"""Fixed weights of a new pressure in short sequences, in turn; None is (k + 1)^(−1/2)."""


def short_sequence(descent: Descent, pressure: Array, weight: float | None) -> Iterator[Certificate]:
    """Run a short sequence from a first pressure ``(np,)`` to its first certificate."""
    for k in range(SHORT):
        program = descent.programs.frozen(pressure)
        if program.status != "optimal":
            return
        known = len(descent.known)
        if descent.least(program.motion) is not None:
            if len(descent.known) > known:  # or it was gone on from before
                certificate = certified(descent, program.motion)
                if certificate is not None:
                    yield certificate
            return
        pressure = averaged(pressure, program.pressure, weight or (k + 1.0) ** -0.5)


def certified(descent: Descent, motion: Array) -> Certificate | None:
    """The loads that drive a mechanism ``(nd,)``; None where there are none. Of loads without end, the least counts."""

    def extreme(forces: ForceSet, aim: Aim) -> ForceSolution | None:
        return descent.least(motion) if aim == "smallest" else descent.programs.extreme(forces, -1.0, PRIMAL)

    return certify(descent.system, motion, extreme)


def averaged(pressure: Array, new: Array, weight: float) -> Array:
    """Pressures ``(np,)`` for the next program, from those before and those found."""
    return (1 - weight) * pressure + weight * new
