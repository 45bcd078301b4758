"""Pushover of deformable blocks at finite displacements."""

import numpy as np

from runningbond.dynamics import Run, pushover_curve
from runningbond.scene import Array, Scene

from .finite_system import finite_system
from .modes import ModeCount
from .node_outline import node_outline


def fem_pushover(
    scene: Scene,
    distance: float,
    *,
    cells: int = 1,
    modes: ModeCount | None = None,
    speed: float = 5e-4,
    local: float = 0.2,
) -> Array:
    """Pushover curve of a scene's deformable blocks at finite displacements, past its peak.

    Blocks turn, slide off their neighbours and come to rest on others. The live load's power is kept constant, and
    the multiplier follows. Joints that soften hold the two sides that they glued until they are broken; what touches
    afterwards is dry.

    Parameters
    ----------
    scene
        The scene, on a base or a fixed first course; its joints need a stiffness and either no cohesion or both
        fracture energies, its blocks a stiffness unless `modes` is 3.
    distance
        Displacement of the control point at which to stop [m].
    cells, modes
        As `fem_interface.model.fem` has them.
    speed, local
        As `dem.dynamic.finite_pushover` has them.

    Returns
    -------
    (n, 3) float
        As of `dem.dynamic.finite_pushover`.

    Raises
    ------
    SceneError
        For a scene that is not of this kind.
    """
    blocks = node_outline(scene, cells, modes)
    run = Run(finite_system(blocks), local=local)
    held, at, direction = scene.control_point
    wall, corners = blocks.wall, blocks.node[blocks.first[:-1]]
    # How the deformations move the control point, in the frames of the blocks that have it.
    rows = np.array([[wall.displacement_row(int(b), at, axis) for axis in np.eye(2)] for b in held])
    rows[:, :, wall.rigid] = 0.0
    arm = at - scene.blocks.centroid[held]

    def measure(motion: Array) -> tuple[float, float]:
        cosine, sine, x, y = blocks.outline.placed(blocks.rigid(motion)).blocks[held].T
        px, py = (arm + rows @ motion).T
        control = np.column_stack([x + cosine * px - sine * py, y + sine * px + cosine * py]) - at
        moved = (blocks.positions(motion)[corners] - scene.blocks.vertices) @ direction
        return float((control @ direction).mean()), float(moved.max())

    return pushover_curve(run, scene, distance, speed, measure)
