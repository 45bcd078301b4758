"""Certificates of collapse with true Coulomb friction.

A mechanism is certified by balanced forces that obey Coulomb's law, vanish where the mechanism opens and, where it
slides, are at the limit and oppose the slip. The multipliers of such forces form an interval; the wall can
collapse at every load in it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from runningbond.scene import Array

from .equilibrium import Equilibrium
from .force_program import Aim, ForceSet, ForceSolution, coulomb, solve_forces
from .interior_point import near
from .proved import nearly_extreme

NO_JUMP = 1e-7
"""Jump rate, relative to the mechanism's largest motion, that counts as zero."""

PENETRATION = 1e-6
"""Closing rate, relative to the mechanism's largest motion, above which a mechanism is rejected."""

REPAIR_FREEDOMS = 700
"""Degrees of freedom from which interior point and repair find the loads that drive a mechanism faster than HiGHS."""

TOUCHING = 1e-9
"""Relative distance up to which two intervals of loads count as touching."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proof that a wall can collapse: scaled mechanism ``(nd,)``, and forces at its smallest and largest known load.

    A wedged wall may be pressed together by any force, and then collapse at any larger load as well: it is `endless`,
    and its smallest load stands for the largest, which does not exist.
    """

    motion: Array
    least: ForceSolution
    most: ForceSolution
    endless: bool = False


def least_multiplier(certificate: Certificate) -> float:
    """The smallest multiplier at which a certificate proves collapse."""
    return certificate.least.multiplier


def driving_forces(system: Equilibrium, motion: Array, still: float = NO_JUMP) -> ForceSet | None:
    """Set of forces that obey Coulomb's law on a mechanism ``(nd,)``: zero where it opens, limiting where it slides.

    A tie that lengthens is at yield, and one that shortens is slack. The reaction that holds a beam at its height only
    presses it down: how much of the beam it lifts off a wall that sinks as it slides depends on the history, and if it
    could lift all, every wall would slide under no load. None for a mechanism whose blocks interpenetrate. Jumps up to
    `still` times the largest motion count as zero.
    """
    opening, slip = system.jumps(motion)
    largest = float(np.abs(motion).max(initial=0.0))
    if largest == 0.0 or opening.min(initial=0.0) < -max(PENETRATION, still) * largest:
        return None
    least = still * largest
    opens, forward, backward = opening > least, slip > least, slip < -least
    longer = system.elongation(motion)
    cone = coulomb(system.strength)
    up, down = cone.most
    return ForceSet(
        cone.slopes,
        (np.where(opens | backward, 0.0, up), np.where(opens | forward, 0.0, down)),
        np.where(forward, cone.shear_high, cone.shear_low),
        np.where(backward, cone.shear_low, cone.shear_high),
        np.where(longer > least, system.tie_yield, 0.0),
        np.where(longer < -least, 0.0, system.tie_yield),
        late_least=0.0,
    )


def certify(
    system: Equilibrium, motion: Array, extreme: Callable[[ForceSet, Aim], ForceSolution | None] | None = None
) -> Certificate | None:
    """Find the smallest and largest load that drive a mechanism; None if there are none.

    `extreme` finds the forces for the aims ``smallest`` and ``largest``, which are as exact as its results; without
    `extreme` they are proved.
    """
    forces = driving_forces(system, motion)
    if forces is None:
        return None
    find = partial(_extreme_forces, system) if extreme is None else extreme
    least = find(forces, "smallest")
    if least is None or least.status != "optimal":
        return None
    most = find(forces, "largest")
    if most is not None and most.status == "unbounded":
        return Certificate(motion, least, least, endless=True)
    return Certificate(motion, least, most) if most is not None and most.status == "optimal" else None


def roughly_certified(system: Equilibrium, motion: Array, count: Callable[[int], None]) -> Certificate | None:
    """Approximate loads that drive a mechanism, by interior points, counted by `count`; `certify` proves loads."""

    def extreme(forces: ForceSet, aim: Aim) -> ForceSolution:
        count(1)
        return near(system, forces, aim)

    return certify(system, motion, extreme)


def _extreme_forces(system: Equilibrium, forces: ForceSet, aim: Aim) -> ForceSolution:
    """Forces at an extreme load; for large walls they are near the extreme, but still proved.

    In that case the load is rounded to twelve digits, as the balance of forces; more differ from machine to machine.
    """
    found = nearly_extreme(system, forces, aim) if system.freedoms >= REPAIR_FREEDOMS else None
    if found is None:
        return solve_forces(system, forces, aim)
    return replace(found, multiplier=float(f"{found.multiplier:.12g}"))


def certified_loads(
    certificates: Sequence[Certificate], load: Callable[[float], float], *, falling: bool = False
) -> list[tuple[float, float]]:
    """Loads at which collapse is certified, as disjoint intervals in ascending order.

    `load` converts multipliers to loads; `falling` if the load decreases as the multiplier grows.
    """
    ends = [(load(c.least.multiplier), load(c.most.multiplier)) for c in certificates]
    pairs = sorted((min(pair), max(pair)) if falling else pair for pair in ends)
    merged = [pairs[0]]
    for low, high in pairs[1:]:
        if low <= merged[-1][1] + TOUCHING * abs(merged[-1][1]):
            merged[-1] = merged[-1][0], max(high, merged[-1][1])
        else:
            merged.append((low, high))
    return merged
