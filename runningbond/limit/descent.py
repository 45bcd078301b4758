"""From one certificate of collapse to one at a smaller load.

The forces of a certificate drive not one mechanism but a cone of them: all that open only where they vanish and slide
only where they are at the limit. Of another mechanism of that cone the same forces are a certificate as well, and its
smallest load is as small or smaller. Mechanisms at the cone's edges move least points, and leave the forces freest.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import csc_array, hstack

from runningbond.scene import Array

from .certificates import NO_JUMP, Certificate, driving_forces
from .equilibrium import Equilibrium
from .force_program import ForceSet, ForceSolution, force_program, solve_forces

NO_FORCE = 1e-7
"""Force, in force units, that counts as none, and distance from the limit that counts as at it."""

IN_VAIN = 3
"""Mechanisms of a certificate that bring nothing lower, after which it is left."""

WALK = 12
"""Steps of a walk that bring nothing lower, after which it ends."""

LOWER = 1e-7
"""Multiplier, relative to itself and 1, by which a certificate has to be lower to count as lower."""


@dataclass(eq=False)
class Descent:
    """Programs over the equations of a wall, counted, and the mechanisms that they have been solved for."""

    system: Equilibrium
    programs: int = 0
    known: dict[bytes, ForceSolution | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        system = self.system
        parts = [system.opening, system.slip, system.tie, system.reaction, csc_array(-system.live[:, None])]
        self._matrix = csc_array(hstack(parts, format="csc"))
        self._power = float(np.abs(system.live).sum()) or 1.0

    def least(self, motion: Array) -> ForceSolution | None:
        """Forces at the least load that drives a mechanism ``(nd,)``; None where there are none."""
        pattern = self._pattern(motion)
        if pattern not in self.known:
            forces = driving_forces(self.system, motion)
            self.programs += forces is not None
            found = None if forces is None else solve_forces(self.system, forces, "smallest")
            self.known[pattern] = found if found is not None and found.status == "optimal" else None
        return self.known[pattern]

    def _pattern(self, motion: Array) -> bytes:
        """Where a mechanism opens and slides, which is all that its loads depend on."""
        system, least = self.system, NO_JUMP * float(np.abs(motion).max(initial=0.0))
        jumps = np.concatenate([system.opening.T @ motion, system.slip.T @ motion, system.elongation(motion)])
        return bytes((np.sign(jumps) * (np.abs(jumps) > least)).astype(np.int8))

    def random_forces(
        self, forces: ForceSet, rng: np.random.Generator, multiplier: float | None = None
    ) -> ForceSolution | None:
        """Forces of a set at a corner of it, balanced under a load or, of none, under any; None where there are none.

        They minimise a random sum of pressures.
        """
        system, n, rays = self.system, len(self.system.points), len(forces.slopes)
        self.programs += 1
        program = force_program(system, forces, "smallest")
        program["c"][:] = 0.0
        program["c"][: rays * n] = np.tile(_weights(n, rng), rays)
        if multiplier is not None:
            program["bounds"][-1] = multiplier
        result = linprog(**program, method="highs-ds")
        if result.x is None or result.status:
            return None
        parts = result.x[: rays * n].reshape(rays, n)
        tangential = (np.asarray(forces.slopes) * parts).sum(axis=0)
        if forces.has_shear:
            tangential = tangential + result.x[rays * n : (rays + 1) * n]
        sizes = np.array([len(system.tie_yield), system.reaction.shape[1], 1])
        tie, reaction, last = np.split(result.x[-sizes.sum() :], np.cumsum(sizes)[:-1])
        none = np.zeros(0)
        return ForceSolution("optimal", float(last[0]), parts.sum(axis=0), tangential, reaction, none, 0, tie)

    def mechanism(self, forces: ForceSolution, rng: np.random.Generator) -> Array | None:
        """A random extreme mechanism ``(nd,)`` that forces of a certificate drive, f_live · q = 1.

        It minimises a random sum of its jumps; the program is its dual, whose forces stay below the sum's weights.
        """
        system, n, ties = self.system, len(self.system.points), len(self.system.tie_yield)
        limit = system.strength.shear + system.strength.friction * forces.pressure
        weights = _weights(2 * n, rng)
        least, most = np.full(self._matrix.shape[1], -np.inf), np.full(self._matrix.shape[1], np.inf)
        most[:n][forces.pressure <= NO_FORCE] = weights[:n][forces.pressure <= NO_FORCE]
        forward, backward = forces.tangential >= limit - NO_FORCE, forces.tangential <= NO_FORCE - limit
        most[n : 2 * n][forward] = weights[n:][forward]
        least[n : 2 * n][backward] = -weights[n:][backward]
        least[2 * n : 2 * n + ties][forces.tie <= NO_FORCE] = 0.0
        most[2 * n : 2 * n + ties][forces.tie >= system.tie_yield - NO_FORCE] = 0.0
        cost = np.zeros(len(least))
        cost[-1] = -self._power
        self.programs += 1
        bounds = np.column_stack([least, most])
        program = {"c": cost, "A_eq": self._matrix, "b_eq": np.zeros(system.freedoms), "bounds": bounds}
        result = linprog(**program, method="highs-ds")  # type: ignore[call-overload]
        return None if result.status else np.asarray(result.eqlin.marginals) / self._power

    def around(self, best: Certificate, rng: np.random.Generator) -> list[Certificate]:
        """Certificates at ever smaller loads, by a walk over mechanisms that random forces on the last one drive."""
        lower: list[Certificate] = []
        motion, in_vain = best.motion, 0
        while in_vain < WALK:
            in_vain += 1
            driving = driving_forces(self.system, motion)
            forces = None if driving is None else self.random_forces(driving, rng)
            stepped = None if forces is None else self.mechanism(forces, rng)
            found = None if stepped is None else self.least(stepped)
            if forces is None or stepped is None or found is None:
                motion = best.motion
            elif is_lower(found.multiplier, best.least.multiplier):
                lower += [Certificate(stepped, found, forces), *self.below(stepped, found, rng)]
                best, in_vain = lower[-1], 0
                motion = best.motion
            else:
                motion = stepped
        return lower

    def below(self, motion: Array, forces: ForceSolution, rng: np.random.Generator) -> list[Certificate]:
        """Certificates at ever smaller loads, from a mechanism and the forces at its least load."""
        lower: list[Certificate] = []
        in_vain = 0
        while in_vain < IN_VAIN:
            moved = self.mechanism(forces, rng)
            found = None if moved is None else self.least(moved)
            if moved is not None and found is not None and is_lower(found.multiplier, forces.multiplier):
                # The forces drive the new mechanism too: every load in between is certified.
                lower.append(Certificate(moved, found, forces))
                forces, in_vain = found, 0
            else:
                in_vain += 1
        return lower


def is_lower(multiplier: float, than: float) -> bool:
    """Whether a multiplier is smaller than another by more than rounding."""
    return multiplier < than - LOWER * max(1.0, abs(than))


def _weights(n: int, rng: np.random.Generator) -> Array:
    """Random positive weights ``(n,)`` of very different size."""
    return np.exp(rng.normal(0.0, 2.0, n))
