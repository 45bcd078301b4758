"""The programs of the search over one wall: each kind one model, solved from corner to corner (`simplex`)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from threading import Event
from typing import TypeAlias

import highspy
import numpy as np
from scipy.sparse import csc_array, hstack

from runningbond.scene import Array

from .equilibrium import Equilibrium
from .force_program import (
    Aim,
    ForceSet,
    ForceSolution,
    bounds_of,
    frozen_friction,
    mechanism_scale,
    solution_of,
    solve_forces,
)
from .interior_point import near
from .simplex import DUAL, INTERIOR, PRIMAL, Simplex

NO_FORCE = 1e-7
"""Force, in force units, that counts as none, and distance from the limit that counts as at it."""


MOST_PIVOTS = 800
"""Corners after which loads that drive a mechanism are given up, or taken as they are."""

FARTHEST = 5_000
"""Corners between two programs of a sequence beyond which interior point and crossover take over: in walls of 600
blocks so many take longer than they."""

Corners: TypeAlias = "Sequence[highspy.HighsBasis | None]"
"""Corners from which the models of `Programs` start; None is nothing."""


@dataclass(eq=False)
class Programs:
    """Programs over the equations of a wall, and how many were solved; once `stopped` no other is."""

    system: Equilibrium
    stopped: Event = field(default_factory=Event)
    solved: int = 0
    asks_interior_point: bool = True
    _power: float = field(init=False)

    def __post_init__(self) -> None:
        system, friction = self.system, self.system.strength.friction
        right = system.dead - system.opening @ system.strength.tension
        live = csc_array(-system.live[:, None])
        others = [system.slip, system.tie, system.reaction, live]
        rays = [system.slip.multiply(slope).tocsc() - system.opening for slope in (friction, -friction)]

        def model(*parts: csc_array, right: Array) -> Simplex:
            return Simplex(csc_array(hstack([*parts, *others], format="csc")), right)

        self._driven = model(*rays, right=right)
        self._frozen = model(-system.opening, right=right)
        self._moved = model(system.opening, right=np.zeros(system.freedoms))
        self._models = self._driven, self._frozen, self._moved
        self._power = mechanism_scale(system)

    @property
    def corners(self) -> Corners:
        """The last corners of all models."""
        return [each.corner for each in self._models]

    def go_to(self, corners: Corners) -> None:
        """Start from such corners, and depend on nothing that was solved before."""
        for model, corner in zip(self._models, corners, strict=True):
            model.go_to(corner)

    def frozen(self, pressure: Array) -> ForceSolution:
        """Forces at the largest load if shear resistances are those of a pressure ``(np,)``."""
        forces = frozen_friction(self.system.strength, pressure)
        found = self._solved(self._frozen, forces, sense=-1.0, pivots=FARTHEST)
        return found if found.status != "numerical" else self._solved(self._frozen, forces, sense=-1.0, method=INTERIOR)

    def extreme(self, forces: ForceSet, sense: float = 1.0, method: int = PRIMAL) -> ForceSolution:
        """Forces of a set of two rays a point at the least load, or with a `sense` of −1 at the most.

        Where the simplex method has passed so many corners without any such forces, it has not shown that there are
        none: the interior point says so, if it is to be asked.
        """
        found = self._solved(self._driven, forces, sense=sense, method=method, pivots=MOST_PIVOTS)
        if found.status != "numerical" or not self.asks_interior_point:
            return found
        aim: Aim = "smallest" if sense > 0 else "largest"
        rough = near(self.system, forces, aim)
        return rough if rough.status != "optimal" else solve_forces(self.system, forces, aim)

    def corner(
        self, forces: ForceSet, weights: Array, multiplier: float | None = None, pivots: int | None = None
    ) -> ForceSolution:
        """The corner of a set with the least sum of pressures, with weights ``(np,)``, or one on the way there.

        Balanced under a load or, of none, from the last load on under any.
        """
        return self._solved(self._driven, forces, weights=weights, multiplier=multiplier, method=PRIMAL, pivots=pivots)

    def mechanism(self, forces: ForceSolution, weights: Array) -> Array | None:
        """An extreme mechanism ``(nd,)`` that forces drive, f_live · q = 1; None where there is none.

        It minimises the sum of its jumps with weights ``(2 np,)``; the program is its dual, whose forces stay below
        the weights.
        """
        system, n, ties = self.system, len(self.system.points), len(self.system.tie_yield)
        limit = system.strength.shear + system.strength.friction * forces.pressure
        size = 2 * n + ties + system.reaction.shape[1] + 1
        low, high = np.full(size, -np.inf), np.full(size, np.inf)
        high[:n] = np.where(forces.pressure <= NO_FORCE, weights[:n], np.inf)
        high[n : 2 * n] = np.where(forces.tangential >= limit - NO_FORCE, weights[n:], np.inf)
        low[n : 2 * n] = np.where(forces.tangential <= NO_FORCE - limit, -weights[n:], -np.inf)
        low[2 * n : 2 * n + ties][forces.tie <= NO_FORCE] = 0.0
        high[2 * n : 2 * n + ties][forces.tie >= system.tie_yield - NO_FORCE] = 0.0
        cost = np.zeros(size)
        cost[-1] = -self._power
        self._count()
        status, _, motion = self._moved.solve(low, high, cost)
        return motion / self._power if status == "optimal" else None

    def _count(self) -> None:
        if self.stopped.is_set():
            raise KeyboardInterrupt
        self.solved += 1

    def _solved(
        self,
        model: Simplex,
        forces: ForceSet,
        *,
        sense: float = 0.0,
        weights: Array | None = None,
        multiplier: float | None = None,
        method: int = DUAL,
        pivots: int | None = None,
    ) -> ForceSolution:
        low, high = bounds_of(self.system, forces, has_shear=True).T.copy()
        if multiplier is not None:
            low[-1] = high[-1] = multiplier
        cost = np.zeros(len(low))
        cost[-1] = sense * self._power
        if weights is not None:
            pressures = np.tile(weights, len(forces.slopes))
            cost[: len(pressures)] = pressures
        self._count()
        status, found, motion = model.solve(low, high, cost, method, pivots)
        if status not in ("optimal", "budget"):
            return ForceSolution.none(status)
        return solution_of(self.system, forces, "optimal", found, motion, 0)
