"""Model ``dem-dynamic``: explicit dynamics of rigid blocks, each load held until the wall rests or falls.

The paper's first solver (Sec. 3, molecular dynamics): explicit central differences of every block's motion, Coulomb's
law on the joint forces. Damping only serves to bring the wall to rest: local damping, which does not depend on the
wall's frequencies, and a little stiffness-proportional viscosity. Without the latter, sliding contacts chatter, and
local damping acts on the chatter until a collapse looks like creep.
"""

import time
from dataclasses import replace
from typing import Any

import numpy as np

from runningbond.dynamics import (
    CALMER,
    U_CRIT,
    Observer,
    Run,
    collapse_by_steps,
    inertia_note,
    no_observer,
    with_highest_frequency,
)
from runningbond.dynamics.collapse_load import BUDGET, FIRST_STEP
from runningbond.dynamics.displacements import Displacements, are_finite
from runningbond.dynamics.push import finite_run
from runningbond.joints.wall_law import with_impacts
from runningbond.limit import bears_dead_load, given_displacement, is_self_locking, proved_bound
from runningbond.response import Response, Resting, Vibration, critical_scale, follow, vibration_at_rest
from runningbond.results import Outcome
from runningbond.scene import Scene, check_scene

from .finite_system import finite_system
from .rigid_system import contact_points, rigid_system, with_fictitious_inertia


def dem_dynamic(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    collapse: float = U_CRIT,
    first_step: float = FIRST_STEP,
    budget: int = BUDGET,
    displacements: Displacements = "small",
    distance: float | None = None,
    observe: Observer = no_observer,
) -> Outcome:
    """Find the collapse load of a scene by rigid-block dynamics; if its ground moves, the scale by `critical_scale`.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness, which barely affects the collapse load.
    tolerance, collapse, first_step, budget, distance, observe
        As in `collapse_by_steps`.
    displacements
        Whether a wall that is driven by its beam or by a support, or pushed by live loads, is followed through finite
        displacements: blocks rotate, slide off their neighbours and come to rest on others, and softening joints break
        (`finite_system`). A push continues past its peak.

    Returns
    -------
    Outcome
        As returned by `collapse_by_steps`.
    """
    check_scene(scene)
    finite = are_finite(displacements, "dem-dynamic", scene, distance)
    if scene.history:
        return critical_scale(scene, "dem-dynamic", finite_system(with_impacts(scene)), tolerance, observe=observe)
    start = time.perf_counter()
    points = contact_points(scene)
    run = finite_run(finite_system(scene), scene) if finite else quasi_static_run(scene)
    outcome = collapse_by_steps(
        scene,
        "dem-dynamic",
        run,
        tolerance,
        points=points,
        point_order=np.argsort(points.joint, kind="stable"),
        is_self_locking=lambda: is_self_locking(scene),
        bound=lambda: proved_bound(scene),
        bears=lambda: bears_dead_load(scene),
        gives=lambda multiplier: given_displacement(scene.with_rigid_blocks(), multiplier),
        note=inertia_note(run.system.inertia_scaling),
        collapse=collapse,
        first_step=first_step,
        budget=budget,
        distance=distance,
        observe=observe,
    )
    return replace(outcome, seconds=time.perf_counter() - start)


def quasi_static_run(scene: Scene) -> Run:
    """Set up rigid blocks at small displacements under slowly growing loads, for which their inertia does not matter.

    The speed of a driven beam or support follows from the usual time step: such a wall keeps its true masses and step.
    """
    system = rigid_system(scene)
    if scene.is_led:
        return Run(system)
    return Run(with_highest_frequency(with_fictitious_inertia(scene, system)), viscous=CALMER)


def dem_response(scene: Scene, scale: float = 1.0, **settings: Any) -> Response:
    """Response of a scene's rigid blocks to its ground motion times `scale`; settings as for `follow`."""
    return follow(Resting.of(scene, "dem-dynamic", finite_system(with_impacts(scene))), scale, **settings)


def dem_vibration(scene: Scene, count: int = 10) -> Vibration:
    """Natural vibrations of a scene's rigid blocks at rest under their dead load."""
    check_scene(scene)
    return vibration_at_rest(scene, Run(rigid_system(scene)), count)
