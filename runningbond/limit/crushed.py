"""Limit analysis of joints that crush: points on the boundary of what they carry, more of them where they are needed.

Forces of a joint are mixes of resultants that it carries, and of none: a polyhedron inside the true set, so that
multipliers of the program are proved from below. Its mechanism, put into the true set's support function, proves a
multiplier from above; where that function takes its value is a resultant that the program had not known. It is added,
and the program solved again, until the two are as close as asked for (Dantzig & Wolfe 1960).
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import block_array, csc_array, eye_array

from runningbond.joints import PointStrength
from runningbond.scene import Array, Indices

from .crushing import Crushing
from .equilibrium import Equilibrium
from .force_program import STATUS, Aim, ForceSet, ForceSolution, coulomb, force_program, solution_of

ROUNDS = 60
"""Programs after which the bracket is left as wide as it is."""

FINER = 4.0
"""Ratio of the shares of a joint that the first stress blocks take."""

SMALLEST = 0.02
"""Force, in force units, on the smallest of the first stress blocks."""

NEW = 1e-9
"""Power, relative, that a new resultant must have before those known."""


@dataclass(frozen=True, eq=False)
class Resultants:
    """Forces N₁, N₂ and V ``(3, n)`` on the boundary of what joints ``(n,)`` of a `Crushing` carry."""

    owner: Indices
    forces: Array

    def more(self, owner: Indices, forces: Array) -> "Resultants":
        """These and others."""
        return Resultants(np.append(self.owner, owner), np.hstack([self.forces, forces]))

    @property
    def size(self) -> Array:
        """Largest force of each, ``(n,)``."""
        return np.asarray(np.abs(self.forces).max(axis=0))


def first_resultants(joints: Crushing) -> Resultants:
    """Stress blocks from either end, with and without shear, down to those of small forces."""
    levels = int(np.ceil(np.log(max(joints.strength.max() / SMALLEST, 1.0)) / np.log(FINER)))
    shares = np.append(FINER ** -np.arange(levels + 1.0), 0.0)
    forces = joints.blocks(shares)
    found = Resultants(np.repeat(np.arange(len(joints)), forces.shape[1] // len(joints)), forces)
    used = found.size > 1e-3 * SMALLEST
    return Resultants(found.owner[used], found.forces[:, used])


def _without(system: Equilibrium, joints: Crushing) -> tuple[Equilibrium, ForceSet]:
    """The system and its forces while joints that crush carry nothing."""
    carries = np.ones(len(system.points))
    carries[2 * joints.joint] = carries[2 * joints.joint + 1] = 0.0
    strength = system.strength
    others = PointStrength(strength.friction, strength.tension * carries, strength.shear * carries)
    rays = coulomb(others)
    return replace(system, strength=others), replace(rays, most=[np.where(carries > 0, np.inf, 0.0)] * 2)


def inner_program(system: Equilibrium, known: Resultants, aim: Aim = "largest") -> dict:
    """Arguments of `linprog`: unknowns are the shares of resultants, of none of them, and those of `force_program`."""
    joints = system.crushing
    program = force_program(*_without(system, joints), aim)
    first = 2 * joints.joint[known.owner]
    n1, n2, v = known.forces / known.size
    columns = system.opening[:, first] * n1[None] + system.opening[:, first + 1] * n2[None]
    columns = csc_array(columns + system.slip[:, first] * v[None])
    rows = (known.owner, np.arange(len(known.owner)))
    shares = csc_array((1 / known.size, rows), shape=(len(joints), len(known.owner)))
    matrix = block_array([[columns, None, program["A_eq"]], [shares, eye_array(len(joints)), None]], format="csc")
    n = len(known.owner) + len(joints)
    bounds = np.vstack([np.tile([0.0, np.inf], (n, 1)), program["bounds"]])
    right = np.append(program["b_eq"], np.ones(len(joints)))
    return {"c": np.append(np.zeros(n), program["c"]), "A_eq": matrix, "b_eq": right, "bounds": bounds}


def inner_solution(system, known, status, found, marginals, iterations) -> ForceSolution:
    joints, n = system.crushing, len(known.owner)
    others, rays = _without(system, joints)
    solution = solution_of(
        others, rays, status, found[n + len(joints) :], marginals[: system.freedoms], iterations
    )
    n1, n2, v = (
        np.bincount(known.owner, part * found[:n] / known.size, len(joints)) for part in known.forces
    )
    pressure, tangential = solution.pressure.copy(), solution.tangential.copy()
    first, second = 2 * joints.joint, 2 * joints.joint + 1
    pressure[first], pressure[second] = system.strength.tension[first] - n1, system.strength.tension[second] - n2
    most = system.strength.shear + system.strength.friction * pressure
    share = most[first] / np.maximum(most[first] + most[second], np.finfo(float).tiny)
    tangential[first], tangential[second] = share * v, (1 - share) * v
    return replace(solution, pressure=pressure, tangential=tangential)


def solve_inner(system: Equilibrium, known: Resultants, aim: Aim = "largest") -> ForceSolution:
    result = linprog(**inner_program(system, known, aim), method="highs-ds" if aim == "zero" else "highs-ipm")
    status = STATUS[int(result.status)]
    if result.x is None or status != "optimal":
        none = np.zeros(0)
        return ForceSolution(status, np.nan, none, none, none, none, int(result.nit))
    return inner_solution(system, known, status, result.x, result.eqlin.marginals, int(result.nit))


def closer(system: Equilibrium, known: Resultants, motion: Array) -> Resultants:
    jumps = system.crushed_jumps(motion)
    forces = system.crushing.forces(jumps)
    power = (forces * jumps).sum(axis=0)
    best = np.zeros(len(power))
    np.maximum.at(best, known.owner, (known.forces * jumps[:, known.owner]).sum(axis=0))
    new = np.flatnonzero(power - best > NEW * max(power.sum(), 1e-300)/len(power))
    return known.more(new, forces[:, new])
