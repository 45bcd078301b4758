"""Line loads on whole blocks act on every triangle along the line, so that a lintel bends like a beam."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import runningbond as rb
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.modes import ModeCount
from fem_interface.system import system_of
from runningbond.dynamics import BlockSystem
from runningbond.scene import Array, Scene

from .walls import wall

LENGTH, HEIGHT, THICKNESS, YOUNG, DENSITY, LOAD = 2.0, 0.2, 0.12, 1e10, 1800.0, 1e3
LINE: dict[str, Any] = {"kind": "line", "from": [0.0, HEIGHT], "to": [LENGTH, HEIGHT], "force": [0.0, -LOAD]}
SLOPE: dict[str, Any] = {"kind": "line", "from": [0.1, 0.02], "to": [1.9, 0.17], "force": [300.0, -LOAD]}
BODY: dict[str, Any] = {"kind": "body", "acceleration": [0.0, -LOAD / (DENSITY * HEIGHT * THICKNESS)]}


def lintel(load: dict[str, Any], cells: int) -> tuple[ModalWall, BlockSystem]:
    """One block on a pin and a roller, under the given load only."""
    modes = with_all_modes(cells)
    scene = replace(modes.scene, load=one_block(load).load)
    found = replace(modes, pieces=replace(modes.pieces, scene=scene))
    return found, system_of(found, mass_scaling=False)


@cache
def with_all_modes(cells: int) -> ModalWall:
    """The block with its modes, which do not depend on its load."""
    return modal_wall(one_block(LINE), cells, "all")


def one_block(load: dict[str, Any]) -> Scene:
    size: dict[str, Any] = {"wall__length": None, "wall__height": None, "wall__courses": [[6]]}
    size |= {"wall__block_width": LENGTH / 6, "wall__block_height": HEIGHT, "wall__thickness": THICKNESS}
    return wall(YOUNG, 0.0, **size, support__kind="corners", load={"gravity": 0.0, "live": load})


def deflection(load: dict[str, Any], cells: int) -> float:
    """Deflection of the middle of the lintel [m]; its pins hold it without any joint forces."""
    found, system = lintel(load, cells)
    motion = np.divide(system.live, system.stiffness, out=np.zeros_like(system.live), where=system.stiffness > 0)
    middle = np.argmin(np.hypot(*(found.mesh.points - [LENGTH / 2, HEIGHT / 2]).T))
    return -float(found.displacement(motion)[middle, 1])


@pytest.mark.long
def test_lintel_under_line_load_deflects_as_timoshenko_beam() -> None:
    """5 q L⁴ / 384 E I + q L² / 8 κ G A, with an error quadratic in the size of the triangles.

    On any mesh the same as under an equal body force, apart from its transverse compression.
    """
    area, inertia, shear = HEIGHT * THICKNESS, THICKNESS * HEIGHT**3 / 12, YOUNG / 2
    exact = 5 * LOAD * LENGTH**4 / (384 * YOUNG * inertia) + LOAD * LENGTH**2 / (8 * 5 / 6 * shear * area)
    found = [deflection(LINE, cells) for cells in (2, 3)]
    assert found == pytest.approx([deflection(BODY, cells) for cells in (2, 3)], rel=1e-3)
    assert (9 * found[1] - 4 * found[0]) / 5 == pytest.approx(exact, rel=0.015)


@pytest.mark.parametrize("cells", [1, 3])
def test_line_load_is_lumped_to_nodes_along_it(cells: int) -> None:
    """Load on the halves of the two adjacent edges, which does the same work on piecewise linear displacements."""
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
def test_line_load_has_correct_resultants_on_every_block(load: dict[str, Any]) -> None:
    """For a wall of half and whole blocks, along their top and across them."""
    changes: dict[str, Any] = {"wall__length": LENGTH, "wall__height": HEIGHT, "wall__block_width": 0.5}
    scene = wall(wall__block_height=0.1, **changes, load={"gravity": 9.81, "live": {**load}})
    found = modal_wall(scene, 3, "all")
    live = system_of(found, mass_scaling=False).live[found.rigid[~scene.fixed]]
    wanted: Array = scene.live_forces.resultants(scene)[~scene.fixed]
    assert live == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())


@pytest.mark.long
@pytest.mark.parametrize(("modes", "point", "line"), [(None, 0.71, 0.76), ("all", 0.66, 0.65)])
def test_lintel_of_one_block_sags_less_than_a_beam(modes: ModeCount | None, point: float, line: float) -> None:
    """A deflection of third degree is 3/4 of that of a slender beam under a force at its middle, 4/5 under a line load.

    On smooth piers, between whose edges the lintel spans once its own ends lift off; with all modes on four cells.
    """
    span, bearing, height, thickness, young, load = 2.0, 0.05, 0.25, 0.3, 1e9, 1000.0
    low, high = -bearing, span + bearing
    ground = [[(x, -0.5), (x + bearing, -0.5), (x + bearing, 0.0), (x, 0.0)] for x in (low, span)]
    inertia, shear = young * thickness * height**3 / 12, 5 / 6 * young / 2 * thickness * height
    lives: list[tuple[dict[str, Any], float, float]] = [
        (
            {"kind": "point", "at": [span / 2, height], "force": [0.0, -load]},
            load * span**3 / 48 / inertia + load * span / 4 / shear,
            point,
        ),
        (
            {"kind": "line", "from": [0.0, height], "to": [span, height], "force": [0.0, -load / span]},
            load * span**3 * 5 / 384 / inertia + load * span / 8 / shear,
            line,
        ),
    ]
    for live, beam, share in lives:
        lintel = rb.Wall.outlines(
            [[(low, 0.0), (high, 0.0), (high, height), (low, height)]],
            ground,
            thickness=thickness,
            density=500.0,
            young=young,
            friction=1e-6,
            normal_stiffness=1e11,
            shear_stiffness=1e11,
            live=live,
        )
        curve = fem(lintel.scene, cells=4, modes=modes).curve
        rows = [int(np.flatnonzero(curve[:, 1] <= most)[-1]) for most in (6.0, 20.0)]
        sag, grown = np.diff(curve[rows], axis=0)[0]
        assert sag / grown == pytest.approx(share * beam, rel=0.01)
