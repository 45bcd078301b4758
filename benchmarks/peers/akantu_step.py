"""Cost of a time step beside Akantu's, on the same mesh of the same wall, in one run.

Needs Akantu: ``pip install -e '.[peers]'``. Its wheels are for Linux on x86-64 and CPython 3.11 and 3.12. Without
Akantu the exit code is 2.

The same in both programs: nodes, triangles and joint elements, and their numbers; plane stress; two points per joint
element; elastic joints with dry Coulomb friction, of the same stiffness and friction; weight, and a horizontal load of
0.2 of it; explicit central differences, all degrees of freedom, double precision, one thread. The first table shows
that the two programs move the same wall: for it the suite also has Akantu's masses and joint points, and neither has
damping. Most of the remaining difference is due to friction, as a run with almost no friction in `WALL` shows.

Different in the second table:

- Law. Akantu's ``cohesive_linear_friction`` needs a tensile strength, here 1 Pa over 2 µm, and stores how far a joint
  has slipped, but not in which direction. It returns NaN for a joint under pressure that has not slipped; therefore
  nodes start with offsets of about 1e-12 m.
- Joint points. Akantu has Gauss points, the suite the ends of the elements.
- Masses. Akantu lumps them to the nodes; the suite has consistent masses, in modes of the blocks.
- Damping. Akantu has none here. The suite has that of the model ``fem``, on unbalanced forces, joints and modes, and
  keeps an account of the dissipated work.
- Time step. Akantu has the stable step without damping, by the suite's bound for Akantu's masses; its own bound
  includes the blocks only. The suite's step is shorter for damping and consistent masses, and longer for mass scaling,
  which the suite has for stiff blocks (1000 GPa here, as in the paper) and Akantu does not have. Scaling changes the
  length of a step, but not its cost: hence the last two columns, for a millisecond of motion.
- Machine code. Akantu's wheel is for any x86-64 processor, the suite's kernels are compiled for this one. Akantu is
  called from Python once per step, which costs about ten microseconds for a wall of any size.

Times are processor times of several runs of each program in turn; ratios are of medians.
"""

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"  # read when numpy is loaded

import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.modes import block_modes
from fem_interface.operators import lumped_mass, stiffness_matrix
from fem_interface.system import system_of
from fem_interface.templates import Template, nodes_of, triangles_of
from runningbond.dynamics import Run, State
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.joints import gauss, joint_stiffness
from runningbond.scene import Array, Indices, Scene, scene_from_dict

RUNS = 7
BLOCKS = (300, 1230, 5000)
STEPS = 1000
"""Steps after which motions are compared, and steps of the suite before it is timed."""

WORK = 3_000_000
"""Steps times elements of one timed run of Akantu; those of the suite are `FASTER` times as long."""

FASTER = 10

LOAD = 0.2
"""Horizontal load, relative to the weight."""

WALL = {
    "block": {"density": 1800.0, "young": 1e12, "poisson": 0.0},
    "joint": {"friction": 0.6, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}

MATERIALS = """
material elastic [
  name = block
  rho = {block.density}
  E = {block.young}
  nu = {block.poisson}
  Plane_Stress = true
]
material cohesive_linear_friction [
  name = joint
  sigma_c = 1
  G_c = 1e-6
  beta = 0
  kappa = 1
  contact_after_breaking = true
  penalty = {stiffness.normal}
  mu = {joint.friction}
  penalty_for_friction = {stiffness.shear}
]
"""


def panel(blocks: int) -> Scene:
    """A square panel with about this number of blocks of 240 × 60 mm."""
    courses = max(2, round((blocks * 4) ** 0.5))
    along = max(1, round(blocks / courses))
    wall = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12}
    return scene_from_dict({"wall": {**wall, "length": 0.24 * along, "height": 0.06 * courses}, **WALL})


def wall_triangles(wall: ModalWall) -> Indices:
    """Triangles of the blocks that move, ``(nt, 3)``; neither program includes those of the ground."""
    return wall.mesh.triangles[~wall.scene.fixed[wall.mesh.triangle_block]]


class AkantuWall:
    """A wall's mesh as a model of Akantu, at rest except for a little noise.

    Parameters
    ----------
    akantu
        The module.
    wall
        The wall.
    dt
        Time step [s].
    """

    def __init__(self, akantu: Any, wall: ModalWall, dt: float) -> None:
        nodes = wall.mesh.points
        triangles, joints = wall_triangles(wall), wall.mesh.interfaces[:, [0, 1, 3, 2]]
        self._mesh = akantu.Mesh(2)  # kept: the model does not own it
        access = akantu.MeshAccessor(self._mesh)
        access.resizeNodes(len(nodes))
        self._mesh.getNodes()[:] = nodes
        for kind, elements in ((akantu._triangle_3, triangles), (akantu._cohesive_2d_4, joints)):
            self._mesh.addConnectivityType(kind)
            access.resizeConnectivity(len(elements), kind)
            self._mesh.getConnectivity(kind)[:] = elements
        access.makeReady()

        self._model = akantu.SolidMechanicsModelCohesive(self._mesh)
        # Akantu would insert joints between all triangles; the limit restricts this to a region left of the wall.
        left = float(nodes[:, 0].min())
        self._model.getElementInserter().setLimit(akantu._x, left - 2.0, left - 1.0)
        self._model.initFull(_analysis_method=akantu._explicit_lumped_mass, _is_extrinsic=False)
        if self._mesh.getNbElement(type=akantu._cohesive_2d_4) != len(joints):
            raise RuntimeError("Akantu has put in joint elements of its own")

        held = wall.scene.fixed[wall.mesh.block]
        self._model.getBlockedDOFs()[held] = True
        self._model.assembleMassLumped()
        self._model.getExternalForce()[:] = self._model.getMass() * acceleration(wall.scene)
        noise = 1e-12 * np.random.default_rng(0).standard_normal(nodes.shape)
        self._model.getDisplacement()[:] = np.where(held[:, None], 0.0, noise)
        self._model.setTimeStep(dt)

    @property
    def displacement(self) -> Array:
        """Displacement of every node, ``(nn, 2)`` [m]."""
        return np.array(self._model.getDisplacement())

    def advance(self, steps: int) -> None:
        """Take a number of time steps."""
        for _ in range(steps):
            self._model.solveStep()


def acceleration(scene: Scene) -> Array:
    """Weight and horizontal load per unit of mass, ``(2,)`` [m/s²]."""
    gravity = np.array(scene.load.gravity)
    return np.array([gravity[0] + LOAD * np.linalg.norm(gravity), gravity[1]])


def read_materials(akantu: Any, scene: Scene) -> None:
    """Pass a scene's materials to Akantu, for all its models."""
    joint = scene.joint_materials[0]
    text = MATERIALS.format(block=scene.block, joint=joint, stiffness=joint_stiffness(joint))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "materials.dat"
        path.write_text(text)
        akantu.parseInput(str(path))


def as_in_akantu(scene: Scene) -> ModalWall:
    """A wall with Akantu's masses and joint points."""
    wall = modal_wall(scene, modes="all", rule=gauss(2))

    def lumped(template: Template) -> Template:
        block = int(template.blocks[0])
        nodes, triangles = wall.mesh.points[nodes_of(wall.mesh, block)], triangles_of(wall.mesh, block)
        K = stiffness_matrix(nodes, triangles, scene.block.young or 0.0, scene.block.poisson, scene.thickness)
        M = np.diag(lumped_mass(nodes, triangles, scene.block.density, scene.thickness))
        return replace(template, modes=block_modes(nodes, K.toarray(), M, np.zeros((0, len(M))), "all"))

    return replace(wall, templates=[lumped(template) for template in wall.templates])


def free_run(wall: ModalWall) -> Run:
    """A run of a wall without damping and without mass scaling."""
    return Run(system_of(wall, damping=0.0, mass_scaling=False), local=0.0, viscous=0.0)


def likeness(theirs: AkantuWall, wall: ModalWall, run: Run) -> str:
    """Columns of the first table, after `STEPS` steps from rest: states of joints, and difference of the programs."""
    state = State.at_rest(run.system)
    run.hold(state, LOAD, STEPS)
    theirs.advance(STEPS + 1)  # its accelerations start from zero, so its first step has no motion
    ours = wall.displacement(state.motion)
    # Blocks that the support's reaction has not reached fall freely in any program: this motion is subtracted.
    fall = run.dt**2 * STEPS * (STEPS + 1) / 2 * acceleration(wall.scene)
    moving = ~wall.scene.fixed[wall.mesh.block]
    departure = np.linalg.norm(ours[moving] - fall)
    normal, tangential = run.forces(state)
    pressed = normal < -1e-6 * float(np.abs(run.system.dead).max())
    sliding = pressed & (np.abs(tangential) > 0.999 * wall.scene.joint_materials[0].friction * np.abs(normal))
    return (
        f"{1e3 * STEPS * run.dt:10.3f} {1e6 * np.abs(ours).max():11.3f} {pressed.mean():8.0%} {sliding.mean():8.0%} "
        f"{np.linalg.norm(theirs.displacement - ours) / departure:11.1e}"
    )


def seconds_by_turns(calls: list[Callable[[], None]]) -> list[list[float]]:
    """Processor times of `RUNS` runs of each call, in turn."""
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(RUNS):
        for call, found in zip(calls, times, strict=True):
            start = time.process_time()
            call()
            found.append(time.process_time() - start)
    return times


def compare_steps(akantu: Any, scene: Scene) -> tuple[str, list[str]]:
    """Lines of the two tables for one wall."""
    wall = modal_wall(scene, modes="all")
    n_triangles, n_joints = len(wall_triangles(wall)), len(wall.mesh.interfaces)
    n = n_triangles + n_joints
    size = f"{scene.wall.sum():6d} {n_triangles:10d} {n_joints:7d}"

    twin = as_in_akantu(scene)
    free = free_run(twin)
    theirs = AkantuWall(akantu, wall, free.dt)
    alike = size + likeness(theirs, twin, free)

    runs = [Run(system_of(wall, mass_scaling=scaled), local=LOCAL, viscous=VISCOUS) for scaled in (False, True)]
    states = [State.at_rest(run.system) for run in runs]
    steps = max(20, WORK // n)
    calls: list[Callable[[], None]] = [partial(theirs.advance, steps)]
    for run, state in zip(runs, states, strict=True):
        run.hold(state, LOAD, STEPS)
        calls.append(partial(run.hold, state, LOAD, FASTER * steps))
    counts = [steps, FASTER * steps, FASTER * steps]
    costs = [[t / count for t in times] for times, count in zip(seconds_by_turns(calls), counts, strict=True)]
    if not np.isfinite(theirs.displacement).all():
        raise RuntimeError("Akantu's motion is not finite")

    names = ("Akantu", "suite, masses as they are", "suite, masses scaled")
    lengths = [free.dt, *(run.dt for run in runs)]
    medians = [statistics.median(cost) for cost in costs]
    lines = []
    for name, cost, a, dt in zip(names, costs, medians, lengths, strict=True):
        spread = f"({1e6 * min(cost):.1f} … {1e6 * max(cost):.1f})"
        lines.append(
            f"{size}  {name:26} {1e6 * a:10.1f} {spread:20} {1e9 * a / n_triangles:10.2f} {1e9 * a / n:10.2f} "
            f"{medians[0] / a:9.1f} {1e6 * dt:11.3f} {1e-3 * a / dt:12.4f} {medians[0] / free.dt / (a / dt):9.1f}"
        )
    return alike, lines


def main() -> int:
    """Print both tables; returns the exit code, 2 without Akantu."""
    try:
        import akantu
    except ImportError as error:
        print(f"no Akantu ({error}): pip install -e '.[peers]', with Python 3.11 or 3.12 on Linux", file=sys.stderr)
        return 2
    scenes = [panel(blocks) for blocks in BLOCKS]
    read_materials(akantu, scenes[0])
    tables = [compare_steps(akantu, scene) for scene in scenes]
    size = "blocks  triangles  joints"
    print(f"Akantu {akantu.__version__}. Undamped motion after {STEPS} steps from rest, masses and points alike:")
    print(f"{size} time [ms]  moved [µm]  pressed  sliding  difference")
    for alike, _ in tables:
        print(alike)
    print(f"\nCost of a step: {RUNS} runs of each program; elements are triangles and joint elements:")
    print(
        f"{size}  {'program':26} a step [µs] (spread)           ns/triangle ns/element Akantu/it "
        "length [µs]  s/ms motion Akantu/it"
    )
    for _, lines in tables:
        print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
