"""Linear programs of the search over one wall: one model of each kind, solved from vertex to vertex (`simplex`)."""

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
"""Force, and distance of a force from its limit, in force units, that counts as zero."""


MOST_PIVOTS = 800
"""Simplex pivots after which the search for loads that drive a mechanism ends, with the forces found so far, if any."""

SEQUENCE_PIVOTS = 5_000
"""Simplex pivots in one program of a sequence after which interior point and crossover solve it; in walls of 600 blocks
they take less time than so many pivots."""

Vertices: TypeAlias = "Sequence[highspy.HighsBasis | None]"
"""Vertices from which the models of `Programs` start; None starts without one."""


@dataclass(eq=False)
class Programs:
    """Programs over the equations of a wall, with a count of those solved; no more are solved once `stopped` is set."""

    system: Equilibrium
    stopped: Event = field(default_factory=Event)
    solved: int = 0
    asks_interior_point: bool = True
    _power: float = field(init=False)
    _has_shear: bool = field(init=False)

    def __post_init__(self) -> None:
        system, friction = self.system, self.system.strength.friction
        right = system.dead - system.opening @ system.strength.tension
        live = csc_array(-system.live[:, None])
        slip, others = system.slip, [system.tie, system.reaction, live]
        rays = [system.slip.multiply(slope).tocsc() - system.opening for slope in (friction, -friction)]

        def model(*parts: csc_array, right: Array) -> Simplex:
            return Simplex(csc_array(hstack([*parts, *others], format="csc")), right)

        self._has_shear = bool(np.any(system.strength.shear))
        self._driven = model(*rays, *([slip] if self._has_shear else []), right=right)
        self._frozen = model(-system.opening, slip, right=right)
        self._moved = model(system.opening, slip, right=np.zeros(system.freedoms))
        self._models = self._driven, self._frozen, self._moved
        self._power = mechanism_scale(system)

    @property
    def vertices(self) -> Vertices:
        """The last vertices of all models."""
        return [each.vertex for each in self._models]

    def start_from(self, vertices: Vertices) -> None:
        """Start from these vertices, independently of all programs solved before."""
        for model, vertex in zip(self._models, vertices, strict=True):
            model.start_from(vertex)

    def frozen(self, pressure: Array) -> ForceSolution:
        """Forces at the largest load with shear resistances frozen at those of a pressure ``(np,)``."""
        forces = frozen_friction(self.system.strength, pressure)
        found = self._solved(self._frozen, forces, sense=-1.0, pivots=SEQUENCE_PIVOTS)
        return found if found.status != "numerical" else self._solved(self._frozen, forces, sense=-1.0, method=INTERIOR)

    def extreme(self, forces: ForceSet, sense: float = 1.0, method: int = PRIMAL) -> ForceSolution:
        """Forces of a set with two rays per point at the smallest load, or with a `sense` of −1 at the largest.

        If the simplex method reaches its limit of pivots without finding such forces, this does not prove that there
        are none; the interior point decides if `asks_interior_point`.
        """
        found = self._solved(self._driven, forces, sense=sense, method=method, pivots=MOST_PIVOTS)
        if found.status != "numerical" or not self.asks_interior_point:
            return found
        aim: Aim = "smallest" if sense > 0 else "largest"
        rough = near(self.system, forces, aim)
        return rough if rough.status != "optimal" else solve_forces(self.system, forces, aim)

    def vertex(
        self, forces: ForceSet, weights: Array, multiplier: float | None = None, pivots: int | None = None
    ) -> ForceSolution:
        """Vertex of a set with the smallest sum of weighted pressures, weights ``(np,)``, or one on the way there.

        The forces balance the load at the given `multiplier` or, without one, at any; it starts from the last vertex.
        """
        return self._solved(self._driven, forces, weights=weights, multiplier=multiplier, method=PRIMAL, pivots=pivots)

    def mechanism(self, forces: ForceSolution, weights: Array) -> Array | None:
        """An extreme mechanism ``(nd,)`` that forces drive, f_live · q = 1; None if there is none.

        It minimises the sum of its jumps with weights ``(2 np,)``. The program solved is its dual, whose forces are
        bounded by the weights.
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
        has_shear = model is not self._driven or self._has_shear
        low, high = bounds_of(self.system, forces, has_shear=has_shear).T.copy()
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
