"""Verdicts on a moving support: what share of the dead load it still carries, or that the wall stands without it.

As the support moves away, its reaction falls to the smallest value that admissible forces balance, with the mechanism
of that minimum (Portioli & Cascini 2017). The theorems hold with exchanged roles: admissible forces bound the smallest
reaction from above, mechanisms from below.
"""

import numpy as np

from runningbond.joints import PointStrength
from runningbond.results import Status
from runningbond.scene import Scene

from .equilibrium import Equilibrium
from .force_program import coulomb, frozen_friction, solve_forces
from .settlement import largest_displacement, reaction_unit

ZERO_SHARE = 1e-6
"""Share of the dead load that counts as zero, and closing per displacement of a support that counts as none."""

BRIDGED = "it bridges the support, without which forces balance the dead load"

HOLDS_SUPPORT = "the wall holds the support against any force that drives it"


def may_leave(system: Equilibrium, *, dilates: bool) -> bool:
    """Whether the support can leave the wall at rest, without moving any block.

    This is so if it closes no joint, opens the joints that it slides on with friction, and breaks neither joints nor
    ties. Associated joints, which dilate, must open by tan φ times their slip; with true friction any opening will do.
    """
    opening, slip = (rows[[-1]].toarray()[0] for rows in (system.opening, system.slip))
    drag = system.strength.friction * np.abs(slip)
    least = drag - ZERO_SHARE if dilates else np.where(drag > ZERO_SHARE, ZERO_SHARE, -ZERO_SHARE)
    if (opening < least).any():
        return False
    alone = np.zeros(len(system.live))
    alone[-1] = 1.0
    return system.load(system.kinematic_multiplier(alone)) >= -ZERO_SHARE


def is_bridged(system: Equilibrium, share: float, *, dilates: bool) -> bool:
    """Whether a wall stands without its support, from the smallest share of the dead load on that support."""
    if share > ZERO_SHARE or not may_leave(system, dilates=dilates):
        return False
    return solve_forces(system, coulomb(system.strength), "zero").status == "optimal"


def bridges_without_friction(system: Equilibrium) -> bool:
    """Whether frictionless forces balance the dead load without the support; such a wall stands with any friction."""
    nothing = np.zeros(len(system.points))
    dry = PointStrength(nothing, nothing, nothing)
    return solve_forces(system, frozen_friction(dry, nothing), "zero").status == "optimal"


def bridged_message(system: Equilibrium, otherwise: str) -> str:
    """Message on a wall that bridges its support: no settlement causes collapse or, with friction, `otherwise`."""
    if bridges_without_friction(system):
        return f"no settlement brings it down: {BRIDGED}, by normal forces alone"
    return f"{BRIDGED}, {otherwise}"


def support_verdict(system: Equilibrium, share: float) -> tuple[Status, str]:
    """Status and message of an associated limit analysis, from the smallest share that the support can carry."""
    if is_bridged(system, share, dilates=True):
        return "unbounded", bridged_message(system, "with associated joints; true friction may give way")
    message = "kinematic and static bound, associated joints; true friction may give way at a larger reaction"
    return "collapse", f"{message}; {reaction_note(system.scene, share)}"


def reaction_note(scene: Scene, share: float) -> str:
    """Note that states a share of the dead load as the force on a moving support."""
    weight = reaction_unit(scene) / largest_displacement(scene)
    where = ", as if where it moves most" if scene.settlement and scene.settlement.rotation_angle else ""
    if abs(share) <= ZERO_SHARE:
        return f"the support bears nothing of a dead load of {weight:.6g} N against its motion"
    if share < 0:
        return f"the support has to be driven along its motion with {-share * weight:.6g} N{where}"
    return f"the support bears {share * weight:.6g} N of a dead load of {weight:.6g} N against its motion{where}"
