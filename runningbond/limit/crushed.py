"""Limit analysis of joints that crush, by column generation over resultants on the boundary of their strength domain.

Forces of a joint are convex combinations of zero and known resultants that it carries. They form a polyhedron inside
the true domain, so the program's multiplier is a lower bound. Its mechanism, inserted into the support function of the
true domain, yields an upper bound. The point at which that function takes its value is a new resultant. It is added and
the program solved again, until the bounds are as close as required (Dantzig & Wolfe 1960).
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.sparse import block_array, csc_array, eye_array

from runningbond.joints import PointStrength
from runningbond.scene import Array, Indices

from .crushing import STRONGEST, Crushing, may_crush
from .equilibrium import Equilibrium
from .force_program import (
    STATUS,
    Aim,
    ForceSet,
    ForceSolution,
    ProgramStatus,
    coulomb,
    force_program,
    solution_of,
    solve_program,
)
from .interior_point import InteriorPoint, finishing, interior_point
from .proved import CLOSE, ROUGH, WIDE, is_large, loaded
from .repair import admissible, balanced

BETWEEN = 0.25, 0.5, 0.75
"""Shares of the way from the best mechanism so far to that of a program, at which resultants are sought as well.

Mechanisms of early programs are far from the final one: resultants between them spare programs (in-out separation,
Ben-Ameur & Neto 2007).
"""

STALLED, STALLS = 0.9, 2
"""Ratio of the widths of two successive brackets above which the next program is solved as accurately as the last one,
and number of times in a row that it may be exceeded before forces and mechanism are repaired to see how wide their
bracket is: with strong joints, errors of a mechanism that is not repaired keep it wide, whatever resultants are added.
"""

ROUNDS = 60
"""Largest number of programs; after them the bracket keeps the width that it has."""

SHARE_RATIO, SMALLEST_FORCE = 16.0, 0.1
"""Ratio of successive shares of a joint that the first stress blocks occupy, and smallest force, in force units."""

MIN_POWER_GAIN = 1e-10
"""Excess of a new resultant's power over that of the known ones, relative to that of all joints, for it to be added."""

ZERO_MULTIPLIER = 1e-3
"""Multiplier below which the width of the bracket is relative to this value."""

HINGE_SHARE, LISTED_HINGES = 1e-3, 3
"""Share of the dissipation of crushing joints from which a hinge counts, and number of hinges that a message lists."""

IDLE_FORCE = 1e-5
"""Force of a resultant, relative to the largest, below which repair also tries zero, and the compliance factor then."""

NO_FORCE = 1e-9
"""Force, in force units, that counts as zero."""


@dataclass(frozen=True, eq=False)
class Resultants:
    """Forces N₁, N₂ and V ``(3, n)`` on the boundary of the strength domain of joints ``(n,)`` of a `Crushing`."""

    owner: Indices
    forces: Array

    @property
    def size(self) -> Array:
        """Largest force of each resultant, ``(n,)``."""
        return np.asarray(np.abs(self.forces).max(axis=0))

    def nearer(self, joints: Crushing, jumps: Array) -> "Resultants":
        """These resultants and, where they dissipate more on jumps ``(3, nc)``, those of the true domain."""
        forces = joints.forces(jumps)
        power, best = (forces * jumps).sum(axis=0), np.zeros(len(joints))
        np.maximum.at(best, self.owner, (self.forces * jumps[:, self.owner]).sum(axis=0))
        new = np.flatnonzero(power - best > MIN_POWER_GAIN * power.sum())
        return Resultants(np.append(self.owner, new), np.hstack([self.forces, forces[:, new]]))


def first_resultants(joints: Crushing) -> Resultants:
    """Resultants of stress blocks from either end, with and without shear, down to small forces."""
    levels = int(np.ceil(np.log(max(joints.strength.max() / SMALLEST_FORCE, 1.0)) / np.log(SHARE_RATIO)))
    forces = joints.blocks(np.append(SHARE_RATIO ** -np.arange(levels + 1.0), 0.0))
    found = Resultants(np.repeat(np.arange(len(joints)), forces.shape[1] // len(joints)), forces)
    used = found.size > NO_FORCE
    return Resultants(found.owner[used], forces[:, used])


def without_crushing(system: Equilibrium, joints: Crushing) -> tuple[Equilibrium, ForceSet]:
    """A system and its set of forces in which crushing joints carry nothing."""
    carries = np.ones(len(system.points))
    carries[joints.ends] = 0.0
    strength = system.strength
    strength = PointStrength(strength.friction, strength.tension * carries, strength.shear * carries)
    rays = replace(coulomb(strength), most=[np.where(carries > 0, np.inf, 0.0)] * 2)
    return replace(system, strength=strength), rays


@dataclass(frozen=True, eq=False)
class InnerProgram:
    """A `force_program` whose crushing joints carry convex combinations of known resultants.

    Its unknowns are their forces, the unused share of each joint, and the unknowns of the program without these joints.
    """

    system: Equilibrium
    joints: Crushing
    known: Resultants

    @cached_property
    def others(self) -> tuple[Equilibrium, ForceSet]:
        """The system and its set of forces without the joints that crush."""
        return without_crushing(self.system, self.joints)

    def arguments(self, aim: Aim = "largest") -> dict[str, Any]:
        """Arguments of `scipy.optimize.linprog`."""
        system, known, size, n = self.system, self.known, self.known.size, len(self.joints)
        program = force_program(*self.others, aim)
        first, second = self.joints.ends[:, known.owner]
        operators = system.opening[:, first], system.opening[:, second], system.slip[:, first]
        columns = sum(each * part[None] for each, part in zip(operators, known.forces / size, strict=True))
        of_joint = csc_array((1 / size, (known.owner, np.arange(len(size)))), shape=(n, len(size)))
        parts = [[csc_array(columns), None, program["A_eq"]], [of_joint, eye_array(n), None]]
        bounds = np.tile([0.0, np.inf], (len(size) + n, 1))
        return {
            "c": np.append(np.zeros(len(bounds)), program["c"]),
            "A_eq": csc_array(block_array(parts)),
            "b_eq": np.append(program["b_eq"], np.ones(n)),
            "bounds": np.vstack([bounds, program["bounds"]]),
        }

    def solution(self, status: ProgramStatus, found: Array, multipliers: Array, iterations: int) -> ForceSolution:
        """Convert unknowns and multipliers of rows; a joint's shear is split as its ends' shear strength is."""
        system, known, ends, n = self.system, self.known, self.joints.ends, len(self.joints)
        rest = found[len(known.owner) + n :]
        solution = solution_of(*self.others, status, rest, multipliers[: system.freedoms], iterations)
        shares = found[: len(known.owner)] / known.size
        *normal, shear = (np.bincount(known.owner, part * shares, n) for part in known.forces)
        pressure, tangential = solution.pressure.copy(), solution.tangential.copy()
        pressure[ends] = system.strength.tension[ends] - normal
        # A joint without pressure may carry tension of the size of rounding errors.
        most = (system.strength.shear + system.strength.friction * pressure)[ends].clip(min=0.0)
        tangential[ends] = shear * (most / np.maximum(most.sum(axis=0), np.finfo(float).tiny))
        return replace(solution, pressure=pressure, tangential=tangential, motion=self.mechanism(multipliers))

    def mechanism(self, multipliers: Array) -> Array:
        """Motion ``(nd,)`` from multipliers of rows ``(m,)``, scaled to f_live · q = 1 if the live load does work."""
        motion = multipliers[: self.system.freedoms]
        return np.asarray(motion / (float(self.system.live @ motion) or 1.0))

    def vertex(self) -> ForceSolution:
        """Solution found by HiGHS."""
        result = solve_program(self.arguments(), "highs-ipm")
        status = STATUS[int(result.status)]
        if result.x is None or status != "optimal":
            return ForceSolution.none(status, int(result.nit))
        return self.solution(status, np.asarray(result.x), np.asarray(result.eqlin.marginals), int(result.nit))


def target_width(system: Equilibrium) -> float:
    """Target for the relative width of the bracket; wider for large walls, whose programs would take too long."""
    return WIDE if is_large(system) else CLOSE


def crushed(system: Equilibrium, joints: Crushing) -> tuple[ForceSolution, bool | None]:
    """Forces and mechanism of a system with crushing joints, and whether it rests under its dead load.

    Their bracket is at most `target_width` wide, or as wide as after `ROUNDS` programs. Ctrl-C returns that of the
    last program, if one was solved, with status ``budget``.
    """
    dead = system.under_dead_load()
    rests, known = _resting(dead, joints)
    if not rests:
        return ForceSolution.none("numerical" if rests is None else "infeasible"), rests
    program, point, iterations = _narrowed(system, dead, joints, known)
    if point is None or point.status != "optimal":
        return ForceSolution.none("budget" if point is None else point.status, iterations), True
    with finishing() as interruptions:
        forces, motion = _repaired(program, point, dead)
    found = _solution(program, forces, motion)
    is_interrupted = point.interrupted or bool(interruptions)
    if found is None or not (is_interrupted or _width(system, found) <= target_width(system)):
        try:
            found = _best_bounds(program, forces, motion) or found
        except KeyboardInterrupt:
            is_interrupted = True
    status: ProgramStatus = "budget" if is_interrupted else "optimal"
    if found is None:
        return ForceSolution.none("numerical" if status == "optimal" else status, iterations), True
    return replace(found, status=status, iterations=iterations), True


def _width(system: Equilibrium, found: ForceSolution) -> float:
    """Relative width of the bracket proved by forces and a mechanism."""
    bounds = found.multiplier, system.kinematic_multiplier(found.motion)
    return float(abs(bounds[1] - bounds[0]) / max(*np.abs(bounds), ZERO_MULTIPLIER))


def _best_bounds(program: InnerProgram, forces: Array | None, motion: Array | None) -> ForceSolution | None:
    """The better of HiGHS's bounds and those of repaired forces and mechanism, if any; None if HiGHS fails."""
    system, found = program.system, program.vertex()
    if found.status != "optimal":
        return None
    motions = [found.motion] if motion is None else [found.motion, program.mechanism(motion)]
    if forces is not None and forces[-1] > found.multiplier:
        found = program.solution("optimal", forces, np.zeros(system.freedoms), 0)
    return replace(found, motion=min(motions, key=system.kinematic_multiplier))


def _repaired(program: InnerProgram, point: InteriorPoint, dead: Equilibrium) -> tuple[Array | None, Array | None]:
    """Exact forces ``(n,)`` and mechanism ``(m,)``, unknowns and multipliers of the program; None if not found.

    Forces are balanced with and without resultants of nearly zero force; the larger multiplier counts. `dead` is the
    system under its dead load.
    """
    arguments, n = program.arguments(), len(program.known.owner)
    resting = _rest(replace(program, system=dead))
    within = None if resting is None else loaded(program.system, arguments, resting)
    idle = np.arange(len(point.forces)) < n
    idle &= point.forces < IDLE_FORCE * point.forces[:n].max()
    without = replace(
        point, forces=np.where(idle, 0.0, point.forces), compliance=np.where(idle, IDLE_FORCE, 1.0) * point.compliance
    )
    motion = admissible(arguments, point)
    tried = [balanced(arguments, each, within) for each in (point, without)]
    forces = max((each for each in tried if each is not None), key=lambda each: float(each[-1]), default=None)
    if motion is not None and program.system.live @ motion[: program.system.freedoms] <= 0:
        motion = None
    return forces, motion


def _solution(program: InnerProgram, forces: Array | None, motion: Array | None) -> ForceSolution | None:
    """Solution with repaired forces and mechanism; None if either was not found."""
    return None if forces is None or motion is None else program.solution("optimal", forces, motion, 0)


def _narrowed(
    system: Equilibrium, dead: Equilibrium, joints: Crushing, known: Resultants
) -> tuple[InnerProgram, InteriorPoint | None, int]:
    """Solve programs with more and more resultants; return the last one, its interior point, and all iterations.

    After Ctrl-C the last program that was solved counts, and its point is marked `interrupted`; None if there was none.
    """
    aim, iterations, nearest, best, stalls = target_width(system), 0, 1.0, list[Array](), 0
    finest = aim / 1e3
    program, point = InnerProgram(system, joints, known), None
    try:
        for _ in range(ROUNDS):
            following = InnerProgram(system, joints, known)
            accuracy = finest if stalls else min(max(nearest / 1e3, finest), ROUGH)
            program, point = following, interior_point(following.arguments(), accuracy)
            iterations += point.iterations
            if point.status != "optimal":
                break
            found = program.solution("optimal", point.forces, point.motion, iterations)
            motions = [found.motion, *(each + share * (found.motion - each) for each in best for share in BETWEEN)]
            for motion in motions:
                known = known.nearer(joints, system.crushed_jumps(motion))
            best = [min(best + motions, key=system.kinematic_multiplier)]
            before, nearest = nearest, _width(system, replace(found, motion=best[0]))
            stalls = stalls + 1 if nearest > STALLED * before else 0
            if accuracy <= finest and _width(system, found) <= aim / 2:
                break
            if accuracy <= finest and stalls > STALLS:
                if _is_proved(program, point, dead):
                    break
                stalls = 1
    except KeyboardInterrupt:
        return program, point and replace(point, interrupted=True), iterations
    return program, point, iterations


def _is_proved(program: InnerProgram, point: InteriorPoint, dead: Equilibrium) -> bool:
    """Whether repaired forces and mechanism of a program are within `target_width`."""
    found = _solution(program, *_repaired(program, point, dead))
    return found is not None and _width(program.system, found) <= target_width(program.system)


def _rest(program: InnerProgram) -> Array | None:
    """Forces strictly within all bounds that balance the dead load, as unknowns of the program; None if not found."""
    arguments = program.arguments("zero")
    point = interior_point(arguments, ROUGH)
    return balanced(arguments, point, None) if point.status == "optimal" else None


def _resting(dead: Equilibrium, joints: Crushing) -> tuple[bool | None, Resultants]:
    """Whether forces balance the dead load, and resultants that do; None if that cannot be decided.

    If the first resultants do not suffice, the largest multiple of the dead load that can be balanced decides.
    """
    known = first_resultants(joints)
    multiple = replace(dead, live=dead.dead, dead=np.zeros_like(dead.dead))
    for _ in range(ROUNDS):
        if _rest(InnerProgram(dead, joints, known)) is not None:
            return True, known
        program = InnerProgram(multiple, joints, known)
        point = interior_point(arguments := program.arguments(), CLOSE / 1e3)
        if point.status != "optimal":
            return (True if point.status == "unbounded" else None), known
        found = program.solution("optimal", point.forces, point.motion, 0)
        motion = admissible(arguments, point)
        if motion is not None and multiple.kinematic_multiplier(motion[: dead.freedoms]) < 1 - CLOSE:
            return False, known
        more = known.nearer(joints, dead.crushed_jumps(found.motion))
        if len(more.owner) == len(known.owner):
            break
        known = more
    return None, known


def crushing_note(system: Equilibrium, forces: ForceSolution) -> str:
    """Note on a mechanism's crushing joints, and on the hinges inside joints that dissipate most."""
    joints = system.crushing
    assert joints is not None
    jumps = system.crushed_jumps(forces.motion)
    spent = joints.dissipation(jumps)
    first, second, _ = jumps
    turns = np.flatnonzero((first * second < 0) & (spent > HINGE_SHARE * spent.sum()))
    most = turns[np.argsort(-spent[turns], kind="stable")][:LISTED_HINGES]
    run = np.diff(system.points.position[joints.ends[:, most]], axis=0)[0]
    at = system.points.position[joints.ends[0, most]] + (first[most] / (first - second)[most])[:, None] * run
    places = ", ".join(system.scene.blocks.place(p, 6) for p in at)
    hinges = f"; turning about points inside them: {len(turns)}, foremost about {places}" if len(most) else ""
    return f"joints with a compressive strength: {len(joints)}, plastic within p² + C_ss τ² ≤ f_m²{hinges}"


def beyond_note(system: Equilibrium) -> str:
    """Note on joints that are too strong to be modelled as crushing."""
    left_out = len(may_crush(system.scene)) - (0 if system.crushing is None else len(system.crushing))
    limit = f"a compressive strength beyond {STRONGEST:g} times the largest load on a block"
    return f"; {left_out} with {limit} are taken not to crush" if left_out else ""
