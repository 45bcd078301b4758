"""Model ``fem``: deformable blocks of triangles with interfaces between them, after the paper's FEM/DEM model.

This is the paper's second model (Secs. 4–5): blocks of stiff constant-strain triangles, zero-thickness joint elements
with Coulomb's law, explicit central differences. Blocks are described in modal coordinates, which with all modes are
equivalent to nodal ones, and in which stiff deformations can be slowed down one by one.
"""

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, get_args

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.dynamics import (
    CALMER,
    U_CRIT,
    BlockSystem,
    Observer,
    Run,
    collapse_by_steps,
    inertia_note,
    largest_scaling,
    no_observer,
)
from runningbond.dynamics.collapse_load import BUDGET, FIRST_STEP
from runningbond.dynamics.displacements import Displacements, are_finite
from runningbond.dynamics.push import finite_run
from runningbond.dynamics.run import CALMING
from runningbond.joints import JointPoints, Rule, listed_points, wall_points
from runningbond.joints.wall_law import with_impacts
from runningbond.joints.wall_points import spread_rule
from runningbond.limit import bears_dead_load, given_displacement, is_self_locking, proved_bound
from runningbond.response import Response, Resting, Vibration, critical_scale, follow, vibration_at_rest
from runningbond.results import Outcome
from runningbond.results.outcome import joined
from runningbond.scene import Array, Scene, SceneError, check_scene
from runningbond.scene.ranges import one_of

from .coupled_masses import with_coupled_masses
from .cracks import Cracks, added_compliance, has_weaker_stone
from .fictitious_inertia import with_fictitious_inertia
from .finite_system import finite_system
from .fracture import Energies
from .joint_elements import PointsOn
from .loads import Loads
from .modal_wall import ModalWall, modal_wall
from .modes import ModeCount
from .node_outline import node_outline
from .piece_masses import with_heavier_pieces
from .system import system_of

WORDS = {
    "points": get_args(PointsOn),
    "cracks": get_args(Cracks),
    "loads": get_args(Loads),
    "energies": get_args(Energies),
}
"""The words of each setting, the default first."""

REPORTED_COMPLIANCE = 0.15
"""Compliance of inner joints, relative to that of the triangles, above which the outcome's message reports it."""


def fem(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    cells: int | None = None,
    modes: ModeCount | None = None,
    rule: Rule | None = None,
    points: PointsOn = "elements",
    cracks: Cracks = "joints",
    loads: Loads = "consistent",
    mass_scaling: bool = True,
    energies: Energies = "given",
    displacements: Displacements = "small",
    collapse: float = U_CRIT,
    first_step: float = FIRST_STEP,
    budget: int = BUDGET,
    distance: float | None = None,
    observe: Observer = no_observer,
) -> Outcome:
    """Find the collapse load of a scene with deformable blocks; if its ground moves, the scale by `critical_scale`.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness, and so do its blocks unless `modes` is 3.
    cells
        Number of cells in half a block along the course, and in a block's height: by default 1, or 2 if blocks may
        crack between all triangles, as no crack passes level through a block that is one cell high.
    modes
        Number of modes of each block (`ModeCount`): by default 10, or all if blocks may crack.
    rule
        Quadrature rule of the joints; by default that of `wall_rule`.
    points
        Whether the rule is applied to each joint element, or to each whole joint as for rigid blocks.
    cracks
        Whether blocks stay whole, or may crack between all of their triangles with the scene's `inner_joint`. Joints
        are then at most as strong as that, as stones also crack right beside them.
    loads
        Whether loads proportional to mass are consistent with the mass, or act at inner nodes as in the paper.
    mass_scaling
        Make deformable modes heavy enough not to limit the time step; at small displacements see `run_of_longer_steps`.
    energies
        Source of the joints' fracture energies; without fracture energies joints are perfectly plastic.
    displacements
        Whether finite displacements are taken into account, as in `dem.dynamic.dem_dynamic`.
        Contacts are then at nodes and, if joints soften, crush or close, at points between them; `rule`,
        `points`, `cracks`, `loads` and `energies` cannot be set, and blocks crack along their axes only.
    tolerance, collapse, first_step, budget, distance, observe
        As in `collapse_by_steps`.

    Returns
    -------
    Outcome
        As returned by `collapse_by_steps`. `force` lists the points joint by joint; if the mesh's points are not those
        of whole joints, it lists forces with equal resultants at joint ends. `motion` is the blocks' rigid motion.
    """
    check_scene(scene)
    start = time.perf_counter()
    words = {"points": points, "cracks": cracks, "loads": loads, "energies": energies}
    for setting, word in words.items():
        one_of(f"model fem: {setting}", word, WORDS[setting])
    if cells is None:
        cells = 1 if cracks == "joints" else 2
    finite = are_finite(displacements, "fem", scene, distance) or bool(scene.history)
    if finite:
        _check_finite(rule, words)
    with threadpool_limits(limits=1, user_api="blas"):  # as in `collapse_by_steps`
        if finite:
            blocks = node_outline(with_impacts(scene) if scene.history else scene, cells, modes)
            wall = blocks.wall
            run = finite_run(finite_system(blocks, mass_scaling=mass_scaling), scene)
        else:
            if rule is None and energies != "given":
                rule = spread_rule(cells if points == "elements" else 1)
            wall = modal_wall(scene, cells, modes, rule, points, cracks)
            system = system_of(wall, loads=loads, mass_scaling=mass_scaling, energies=energies)
            run = run_of_longer_steps(wall, system) if mass_scaling else Run(system)
    note = _note(scene, wall, run.system, cracks, cells)
    if scene.history:
        return critical_scale(scene, "fem", run.system, tolerance, note=note, observe=observe)
    outcome = collapse_by_steps(
        scene,
        "fem",
        run,
        tolerance,
        points=wall.elements.points,
        point_order=wall.elements.listing,
        is_self_locking=lambda: is_self_locking(scene),
        bound=lambda: proved_bound(scene),
        gives=lambda multiplier: given_displacement(scene, multiplier),
        bears=lambda: cracks == "joints" and bears_dead_load(scene),
        note=note,
        collapse=collapse,
        first_step=first_step,
        budget=budget,
        distance=distance,
        observe=observe,
    )
    if len(outcome.force):
        own = wall.elements.points.part(wall.elements.listing)
        if finite or not _are_listed(scene, own):
            outcome = replace(outcome, force=at_ends(scene, own, outcome.force))
    return replace(outcome, seconds=time.perf_counter() - start)


def _check_finite(rule: Rule | None, words: Mapping[str, str]) -> None:
    """Refuse settings other than the default ones at finite displacements."""
    for setting, value in {"rule": rule, **words}.items():
        if value != WORDS.get(setting, (None,))[0]:
            raise SceneError(f"model fem: {setting}", "is not supported at finite displacements; leave it out", value)


def _are_listed(scene: Scene, points: JointPoints) -> bool:
    """Whether points are those to which readers of an outcome assign as many forces, place by place."""
    listed = listed_points(scene, len(points))
    if listed is None or not np.array_equal(listed.joint, points.joint):
        return False
    return bool(np.abs(listed.position - points.position).max(initial=0.0) <= scene.blocks.tolerance)


def at_ends(scene: Scene, points: JointPoints, force: Array) -> Array:
    """Forces ``(2 nj, 2)`` [N] at the ends of a scene's joints with the resultants of forces at points ``(np, 2)``.

    Points on no joint of the scene, which lie between triangles of a block, are left out.
    """
    ends = wall_points(scene)
    order = np.lexsort(((ends.position * ends.tangent).sum(axis=1), ends.joint)).reshape(-1, 2)
    inside = points.joint < len(scene.joints)
    joint, force = points.joint[inside], force[inside]
    low, high = ends.position[order].transpose(1, 0, 2)
    run = high - low
    share = ((points.position[inside] - low[joint]) * run[joint]).sum(axis=1) / (run**2).sum(axis=1)[joint]
    found = np.zeros((len(ends), 2))
    np.add.at(found, order[joint, 0], (1 - share)[:, None] * force)
    np.add.at(found, order[joint, 1], share[:, None] * force)
    return found


def run_of_longer_steps(wall: ModalWall, system: BlockSystem) -> Run:
    """Run with fictitious inertia for longer steps; with prescribed displacements only pieces of blocks get it."""
    if wall.scene.is_led:
        return Run(with_heavier_pieces(wall, system))
    coupled = with_coupled_masses(wall, system)
    if len(coupled.coupling.freedom):
        return Run(coupled, local=CALMING)
    return Run(with_fictitious_inertia(wall, system), viscous=CALMER)


def _note(scene: Scene, wall: ModalWall, system: BlockSystem, cracks: Cracks, cells: int) -> str:
    """Note for the outcome's message on scaled masses, and on the compliance and the paths of cracks inside blocks."""
    deformed = wall.stiffness > 0
    factor = largest_scaling(system.mass[deformed], wall.mass[deformed])
    scaled = f"masses of deformable modes scaled up to {factor:.3g} times" if factor > 1.005 else ""
    coupled = "masses of soft blocks coupled across joints" if len(system.coupling.freedom) else ""
    heavier = "pieces of blocks heavier against one another" if len(system.clusters.cluster) else ""
    masses = ", ".join(filter(None, (inertia_note(system.inertia_scaling), scaled, coupled, heavier)))
    softer = ""
    if cracks == "blocks" and (more := added_compliance(wall.pieces)) > REPORTED_COMPLIANCE:
        softer = f"inner joints make blocks up to {more:.0%} softer: a larger inner_joint.normal_stiffness would not"
    no_path = "no crack passes level through blocks one cell high: cells = 2 would let it"
    limited = "joints stronger than inner_joint have the tensile strength of the stone beside them"
    told = {softer: True, no_path: cells == 1, limited: has_weaker_stone(scene)} if cracks == "blocks" else {}
    return joined(masses, *(line for line, holds in told.items() if holds))


def fem_response(
    scene: Scene, scale: float = 1.0, *, cells: int = 1, modes: ModeCount | None = None, **settings: Any
) -> Response:
    """Response of a scene's deformable blocks to its ground motion times `scale`; settings as for `follow`."""
    resting = Resting.of(scene, "fem", finite_system(node_outline(with_impacts(scene), cells, modes)))
    return follow(resting, scale, **settings)


def fem_vibration(scene: Scene, count: int = 10, *, cells: int = 1, modes: ModeCount | None = None) -> Vibration:
    """Natural vibrations of a scene's deformable blocks at rest under their dead load."""
    check_scene(scene)
    system = system_of(modal_wall(scene, cells, modes), mass_scaling=False)
    return vibration_at_rest(scene, Run(system), count)
