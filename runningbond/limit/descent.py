"""From one certificate of collapse to one at a smaller load.

The forces of a certificate drive not one mechanism but a cone of them: all that open only where they vanish and slide
only where they are at the limit. Of another mechanism of that cone the same forces are a certificate as well, and its
smallest load is as small or smaller. Mechanisms at the cone's edges move least points, and leave the forces freest.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from runningbond.scene import Array

from .certificates import NO_JUMP, Certificate, driving_forces
from .equilibrium import Equilibrium
from .force_program import ForceSolution
from .programs import Programs

IN_VAIN = 3
"""Mechanisms of a certificate that bring nothing lower, after which it is left."""

WALK = 12
"""Steps of a walk that bring nothing lower, after which it ends."""

PIVOTS = 200
"""Corners that a step of a walk over forces passes at most."""

LOWER = 1e-7
"""Multiplier, relative to itself and 1, by which a certificate has to be lower to count as lower."""


@dataclass(eq=False)
class Descent:
    """Programs over a wall, and the mechanisms that they have been solved for, by their patterns."""

    programs: Programs
    known: dict[bytes, ForceSolution | None] = field(default_factory=dict)

    @property
    def system(self) -> Equilibrium:
        """The wall's equations."""
        return self.programs.system

    def least(self, motion: Array) -> ForceSolution | None:
        """Forces at the least load that drives a mechanism ``(nd,)``; None where there are none."""
        pattern = jump_pattern(self.system, motion)
        if pattern not in self.known:
            forces = driving_forces(self.system, motion)
            found = None if forces is None else self.programs.extreme(forces)
            self.known[pattern] = found if found is not None and found.status == "optimal" else None
        return self.known[pattern]

    def around(self, best: Certificate, rng: np.random.Generator) -> Iterator[Certificate]:
        """Certificates at ever smaller loads, by a walk over mechanisms that forces on the last one drive."""
        motion, in_vain = best.motion, 0
        while in_vain < WALK:
            in_vain += 1
            stepped, forces = self._stepped(motion, rng)
            found = None if stepped is None else self.least(stepped)
            if forces is None or stepped is None or found is None:
                motion = best.motion
            elif is_lower(found.multiplier, best.least.multiplier):
                best, in_vain = Certificate(stepped, found, forces), 0
                yield best
                for best in self.below(stepped, found, rng):
                    yield best
                motion = best.motion
            else:
                motion = stepped

    def _stepped(self, motion: Array, rng: np.random.Generator) -> tuple[Array | None, ForceSolution | None]:
        """A mechanism that random forces on another one ``(nd,)`` drive, and the forces."""
        driving = driving_forces(self.system, motion)
        if driving is None:
            return None, None
        forces = self.programs.corner(driving, random_weights(len(self.system.points), rng), pivots=PIVOTS)
        if forces.status != "optimal":
            return None, None
        return self.programs.mechanism(forces, self._weights(rng)), forces

    def _weights(self, rng: np.random.Generator) -> Array:
        return random_weights(2 * len(self.system.points), rng)

    def below(self, motion: Array, forces: ForceSolution, rng: np.random.Generator) -> Iterator[Certificate]:
        """Certificates at ever smaller loads, from a mechanism and the forces at its least load."""
        in_vain = 0
        while in_vain < IN_VAIN:
            moved = self.programs.mechanism(forces, self._weights(rng))
            found = None if moved is None else self.least(moved)
            if moved is not None and found is not None and is_lower(found.multiplier, forces.multiplier):
                # The forces drive the new mechanism too: every load in between is certified.
                yield Certificate(moved, found, forces)
                forces, in_vain = found, 0
            else:
                in_vain += 1


def jump_pattern(system: Equilibrium, motion: Array) -> bytes:
    """Where a mechanism ``(nd,)`` opens and slides, which is all that its loads depend on."""
    least = NO_JUMP * float(np.abs(motion).max(initial=0.0))
    jumps = np.concatenate([*system.jumps(motion), system.elongation(motion)])
    return bytes((np.sign(jumps) * (np.abs(jumps) > least)).astype(np.int8))


def is_lower(multiplier: float, than: float) -> bool:
    """Whether a multiplier is smaller than another, which may be infinite, by more than rounding."""
    return multiplier < than and (np.isinf(than) or multiplier < than - LOWER * max(1.0, abs(than)))


def random_weights(n: int, rng: np.random.Generator) -> Array:
    """Random positive weights ``(n,)`` of very different size."""
    return rng.lognormal(0.0, 2.0, n)
