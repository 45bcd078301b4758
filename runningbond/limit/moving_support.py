"""Verdicts on a support that moves: what it still bears of the wall, or that the wall does without it.

As the support gives way its reaction falls to the least that admissible forces balance, and the mechanism that this
least belongs to goes with it (Portioli & Cascini 2017). The theorems hold with their roles exchanged: admissible
forces bear no less than the least, and no mechanism proves more.
"""

import numpy as np

from runningbond.joints import PointStrength
from runningbond.results import Status
from runningbond.scene import Scene

from .equilibrium import Equilibrium
from .force_program import coulomb, frozen_friction, solve_forces
from .settlement import largest_displacement, reaction_unit

NOTHING = 1e-6
"""Share of the dead load that counts as none, and opening per displacement of a support that counts as no closing."""

BRIDGED = "it bridges the support, without which forces balance the dead load"

JAMMED = "self-locking: the wall holds the support against any force that drives it"


def may_leave(system: Equilibrium) -> bool:
    """Whether the support can leave the wall at rest, and drags nothing along.

    It runs into no block, opens the joints that it slides on, and breaks neither joints nor ties.
    """
    opening, slip = (rows[[-1]].toarray()[0] for rows in (system.opening, system.slip))
    if (opening < system.strength.friction * np.abs(slip) - NOTHING).any():
        return False
    alone = np.zeros(len(system.live))
    alone[-1] = 1.0
    return system.load(system.kinematic_multiplier(alone)) >= -NOTHING


def is_bridged(system: Equilibrium, share: float) -> bool:
    """Whether a wall whose support bears no more than a share of the dead load at the least stands without it."""
    if share > NOTHING or not may_leave(system):
        return False
    return solve_forces(system, coulomb(system.strength), "zero").status == "optimal"


def bridges_without_friction(system: Equilibrium) -> bool:
    """Whether normal forces alone balance the dead load without the support; then no friction upsets it."""
    nothing = np.zeros(len(system.points))
    dry = PointStrength(nothing, nothing, nothing)
    return solve_forces(system, frozen_friction(dry, nothing), "zero").status == "optimal"


def bridged_message(system: Equilibrium, otherwise: str) -> str:
    """What is said of a wall that bridges its support: that nothing upsets it or, where friction helps, otherwise."""
    if bridges_without_friction(system):
        return f"no settlement brings it down: {BRIDGED}, by normal forces alone"
    return f"{BRIDGED}, {otherwise}"


def support_verdict(system: Equilibrium, share: float) -> tuple[Status, str]:
    """Status and message of an associated limit analysis, by the least share that the support can bear."""
    if is_bridged(system, share):
        return "unbounded", bridged_message(system, "with associated joints; true friction may give way")
    message = "kinematic and static bound, associated joints; true friction may give way at a larger reaction"
    return "collapse", f"{message}; {reaction_note(system.scene, share)}"


def reaction_note(scene: Scene, share: float) -> str:
    """A share of the dead load as the force on a moving support."""
    weight = reaction_unit(scene) / largest_displacement(scene)
    where = ", as if where it moves most" if scene.settlement and scene.settlement.rotation_angle else ""
    if abs(share) <= NOTHING:
        return f"the support bears nothing of a dead load of {weight:.6g} N against its motion"
    if share < 0:
        return f"the support has to be driven along its motion with {-share * weight:.6g} N{where}"
    return f"the support bears {share * weight:.6g} N of a dead load of {weight:.6g} N against its motion{where}"
