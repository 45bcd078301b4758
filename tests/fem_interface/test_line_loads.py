"""Loads along lines on whole blocks: on every triangle along them, so that a lintel bends as a beam does."""

from typing import Any

import numpy as np
import pytest

from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.system import system_of
from runningbond.dynamics import BlockSystem
from runningbond.scene import Array

from .walls import wall

LENGTH, HEIGHT, THICKNESS, YOUNG, DENSITY, LOAD = 2.0, 0.2, 0.12, 1e10, 1800.0, 1e3
LINE: dict[str, Any] = {"kind": "line", "from": [0.0, HEIGHT], "to": [LENGTH, HEIGHT], "force": [0.0, -LOAD]}
SLOPE: dict[str, Any] = {"kind": "line", "from": [0.1, 0.02], "to": [1.9, 0.17], "force": [300.0, -LOAD]}
BODY: dict[str, Any] = {"kind": "body", "acceleration": [0.0, -LOAD / (DENSITY * HEIGHT * THICKNESS)]}


def lintel(load: dict[str, Any], cells: int) -> tuple[ModalWall, BlockSystem]:
    """One block on a pin and a roller, under a load alone."""
    size: dict[str, Any] = {"wall__length": None, "wall__height": None, "wall__courses": [[6]]}
    size |= {"wall__block_width": LENGTH / 6, "wall__block_height": HEIGHT, "wall__thickness": THICKNESS}
    scene = wall(YOUNG, 0.0, **size, support__kind="corners", load={"gravity": 0.0, "live": load})
    found = modal_wall(scene, cells, "all")
    return found, system_of(found, mass_scaling=False)


def deflection(load: dict[str, Any], cells: int) -> float:
    """How far the middle of the lintel sinks [m]; its pins hold it without any forces of joints."""
    found, system = lintel(load, cells)
    motion = np.divide(system.live, system.stiffness, out=np.zeros_like(system.live), where=system.stiffness > 0)
    middle = np.argmin(np.hypot(*(found.mesh.points - [LENGTH / 2, HEIGHT / 2]).T))
    return -float(found.displacement(motion)[middle, 1])


def test_a_lintel_sinks_under_a_line_load_as_a_timoshenko_beam() -> None:
    """5 q L⁴ / 384 E I + q L² / 8 κ G A, to which triangles come in the square of their size.

    On any mesh as under the same load on its mass, but for what that squeezes the beam.
    """
    area, inertia, shear = HEIGHT * THICKNESS, THICKNESS * HEIGHT**3 / 12, YOUNG / 2
    exact = 5 * LOAD * LENGTH**4 / (384 * YOUNG * inertia) + LOAD * LENGTH**2 / (8 * 5 / 6 * shear * area)
    found = [deflection(LINE, cells) for cells in (2, 3)]
    assert found == pytest.approx([deflection(BODY, cells) for cells in (2, 3)], rel=1e-3)
    assert (9 * found[1] - 4 * found[0]) / 5 == pytest.approx(exact, rel=0.015)


@pytest.mark.parametrize("cells", [1, 3])
def test_every_node_along_a_line_load_has_its_share(cells: int) -> None:
    """What lies on the halves of the two edges beside it: the work on displacements that are linear in between."""
    found, system = lintel(LINE, cells)
    points, (template,) = found.mesh.points, found.templates
    top = np.flatnonzero(np.abs(points[:, 1] - HEIGHT) < 1e-9)
    top = top[np.argsort(points[top, 0])]
    x, nodal = points[top, 0], np.zeros_like(points)
    nodal[top, 1] = -LOAD * np.diff(np.concatenate([x[:1], (x[1:] + x[:-1]) / 2, x[-1:]]))
    wanted = template.modes.shape.T @ nodal.ravel()
    wanted[np.isinf(template.modes.mass)] = 0.0
    assert system.live[:-1] == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())


@pytest.mark.parametrize("load", [LINE, SLOPE])
def test_a_line_load_on_triangles_has_its_resultants_on_every_block(load: dict[str, Any]) -> None:
    """Of a wall of halves and wholes, along their top and across them."""
    changes: dict[str, Any] = {"wall__length": LENGTH, "wall__height": HEIGHT, "wall__block_width": 0.5}
    scene = wall(wall__block_height=0.1, **changes, load={"gravity": 9.81, "live": {**load}})
    found = modal_wall(scene, 3, "all")
    live = system_of(found, mass_scaling=False).live[found.rigid[~scene.fixed]]
    wanted: Array = scene.live_forces.resultants(scene)[~scene.fixed]
    assert live == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
