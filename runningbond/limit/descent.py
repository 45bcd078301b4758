"""Descent from one certificate of collapse to certificates at smaller loads.

The forces of a certificate drive not only its mechanism but a cone of them: all that open only where the forces vanish
and slide only where they are at the limit. With another mechanism of that cone, whose smallest load is not larger, they
are a certificate as well. Mechanisms at the cone's edges move the fewest points and constrain forces least.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .certificates import NO_JUMP, Certificate, driving_forces
from .equilibrium import Equilibrium
from .force_program import ForceSolution
from .programs import Programs

MAX_FAILURES = 3
"""Number of consecutive mechanisms without a lower load after which the descent from a certificate ends."""

MAX_WALK_FAILURES = 12
"""Number of consecutive steps without a lower load after which a walk ends."""

WALK_PIVOTS = 200
"""Largest number of simplex pivots in one step of a walk over forces."""

LOWER_TOLERANCE = 1e-7
"""Difference, relative to the larger of the multiplier and 1, above which a certificate counts as lower."""


@dataclass(eq=False)
class Descent:
    """Programs over a wall, and the forces at the smallest load of mechanisms already solved, by jump pattern."""

    programs: Programs
    known: dict[bytes, ForceSolution | None] = field(default_factory=dict)

    @property
    def system(self) -> Equilibrium:
        """Equilibrium equations of the wall."""
        return self.programs.system

    def least(self, motion: Array) -> ForceSolution | None:
        """Forces at the smallest load that drives a mechanism ``(nd,)``; None if there are none."""
        pattern = jump_pattern(self.system, motion)
        if pattern not in self.known:
            forces = driving_forces(self.system, motion)
            found = None if forces is None else self.programs.extreme(forces)
            self.known[pattern] = found if found is not None and found.status == "optimal" else None
        return self.known[pattern]

    def around(self, best: Certificate, rng: np.random.Generator) -> Iterator[Certificate]:
        """Certificates at ever smaller loads, by a walk; random forces on one mechanism drive the next one, too."""
        motion, failures = best.motion, 0
        while failures < MAX_WALK_FAILURES:
            failures += 1
            stepped, forces = self._stepped(motion, rng)
            found = None if stepped is None else self.least(stepped)
            if forces is None or stepped is None or found is None:
                motion = best.motion
            elif is_lower(found.multiplier, best.least.multiplier):
                best, failures = Certificate(stepped, found, forces), 0
                yield best
                for best in self.below(stepped, found, rng):
                    yield best
                motion = best.motion
            else:
                motion = stepped

    def _stepped(self, motion: Array, rng: np.random.Generator) -> tuple[Array | None, ForceSolution | None]:
        """A mechanism driven by random forces that also drive the given one ``(nd,)``, and these forces."""
        driving = driving_forces(self.system, motion)
        if driving is None:
            return None, None
        forces = self.programs.vertex(driving, random_weights(len(self.system.points), rng), pivots=WALK_PIVOTS)
        if forces.status != "optimal":
            return None, None
        return self.programs.mechanism(forces, self._weights(rng)), forces

    def _weights(self, rng: np.random.Generator) -> Array:
        return random_weights(2 * len(self.system.points), rng)

    def below(self, motion: Array, forces: ForceSolution, rng: np.random.Generator) -> Iterator[Certificate]:
        """Certificates at ever smaller loads, from a mechanism and the forces at its smallest load."""
        failures = 0
        while failures < MAX_FAILURES:
            moved = self.programs.mechanism(forces, self._weights(rng))
            found = None if moved is None else self.least(moved)
            if moved is not None and found is not None and is_lower(found.multiplier, forces.multiplier):
                # The forces drive the new mechanism too, so every load in between is certified.
                yield Certificate(moved, found, forces)
                forces, failures = found, 0
            else:
                failures += 1


def jump_pattern(system: Equilibrium, motion: Array) -> bytes:
    """Signs of a mechanism's ``(nd,)`` jumps and tie elongations; its loads depend on nothing else."""
    least = NO_JUMP * float(np.abs(motion).max(initial=0.0))
    jumps = np.concatenate([*system.jumps(motion), system.elongation(motion)])
    return bytes((np.sign(jumps) * (np.abs(jumps) > least)).astype(np.int8))


def is_lower(multiplier: float, than: float) -> bool:
    """Whether a multiplier is smaller, by more than rounding, than another one, which may be infinite."""
    return multiplier < than and (np.isinf(than) or multiplier < than - LOWER_TOLERANCE * max(1.0, abs(than)))


def random_weights(n: int, rng: np.random.Generator) -> Array:
    """Random positive weights ``(n,)`` of very different magnitude."""
    return rng.lognormal(0.0, 2.0, n)
