"""Loads and materials of real walls: closed forms that every model must reproduce, also mirrored."""

from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from dem.finite_system import finite_system
from runningbond.models import run_model
from runningbond.scene import Array, Scene, SceneError, read_scene, scene_from_dict
from tests.at_length import at_length
from tests.walls import content, write_toml

EVERY = ("limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem")
MORTAR = {"young": 1e11, "poisson": 0.0, "thickness": 0.01}
STONE = {"density": 2000.0, "young": 1e12}
OAK = {"density": 700.0, "young": 1e12}
G = 9.81 * 0.5
"""Weight per area for density 1 and a thickness of 0.5 m."""


def scene_of(wall: dict[str, Any], friction: float = 0.6, **changes: Any) -> dict[str, Any]:
    return content(
        wall={"thickness": 0.5, **wall}, block=STONE, joint={"friction": friction, "mortar": MORTAR}, **changes
    )


def block(width: float, height: float, friction: float = 0.6, **changes: Any) -> Scene:
    """One block on the ground, its lower left corner at the origin."""
    size = {"block_width": width, "block_height": height, "length": width, "height": height}
    return scene_from_dict(scene_of(size, friction, **changes))


def check(scene: Scene, exact: float, models: tuple[str, ...] = EVERY, sharp: float = 1e-6) -> None:
    """Static and certified results are sharp; the brackets of dynamic models contain the answer to a thousandth."""
    for model in models:
        outcome = run_model(model, scene)
        assert outcome.status == "collapse", (model, outcome.message)
        assert outcome.lower is not None
        assert outcome.upper is not None
        slack = sharp if model.startswith("limit") else 2e-3
        assert outcome.lower <= exact * (1 + slack), (model, outcome.lower)
        assert outcome.upper >= exact * (1 - slack), (model, outcome.upper)
        assert outcome.upper - outcome.lower <= 0.011 * exact, model


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(("friction", "height"), [(0.4, 1.0), (2.0, 1.6)])
def test_block_on_a_tilting_plane_slides_at_phi_or_topples_at_its_diagonal(
    side: str, friction: float, height: float
) -> None:
    scene = block(1.0, height, friction, load__live={"kind": "tilt", "direction": side})
    check(scene, min(friction, 1 / height))
    angle = np.degrees(np.arctan(min(friction, 1 / height)))
    assert f"tilted by {angle:.4g}°" in run_model("limit", scene).message


@pytest.mark.parametrize("side", ["right", "left"])
def test_the_same_block_from_a_drawing(side: str, tmp_path: Path) -> None:
    document = ezdxf.new()  # type: ignore[attr-defined]
    for x, y, width, height in ((-3, -1, 7, 1), (0, 0, 1, 1.6)):
        corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
        document.modelspace().add_lwpolyline(corners, close=True)
    document.saveas(tmp_path / "block.dxf")
    tables = scene_of({"drawing": "block.dxf", "units": "m"}, 2.0, load__live={"kind": "tilt", "direction": side})
    check(read_scene(write_toml(tables, tmp_path / "block.toml")), 1 / 1.6)


@pytest.mark.parametrize(("side", "arm"), [(1, 0.25), (-1, 0.75)])
def test_a_block_under_an_eccentric_line_load(side: int, arm: float) -> None:
    """A load q on the right half of the top: F h = G b / 2 + q (b / 2) a, with its lever a about the rotating edge."""
    line = {"kind": "line", "from": [0.5, 1.5], "to": [1.0, 1.5], "force": [0, -4e4]}
    push = {"kind": "point", "at": [0.5 - side * 0.5, 1.5], "force": [side, 0]}
    scene = block(1.0, 1.5, 2.0, load__live=push, load__dead=[line])
    check(scene, (2000 * G * 1.5 * 0.5 + 4e4 * 0.5 * arm) / 1.5)


@pytest.mark.parametrize("side", [1, -1])
def test_moment_overturns_a_block(side: int) -> None:
    """M = G b / 2, wherever the moment acts on the block; a dead moment is subtracted."""
    live = {"kind": "moment", "at": [0.3, 0.2], "moment": -side}
    dead = {"kind": "moment", "at": [0.9, 1.2], "moment": -side * 1e3}
    check(block(1.0, 1.5, load__live=live, load__dead=dead), 2000 * G * 1.5 * 0.5 - 1e3)


def test_live_loads_share_one_multiplier() -> None:
    """A push to the right and an upward pull on the edge it turns away from: λ (p G h / 2 + F b) = G b / 2."""
    weight = 2000 * G * 1.5
    pull = {"kind": "point", "at": [0.0, 0.75], "force": [0, 5e3]}
    scene = block(1.0, 1.5, 2.0, load__live=[{"kind": "lateral"}, pull])
    check(scene, weight * 0.5 / (weight * 0.75 + 5e3))


@pytest.mark.parametrize("side", [1, *at_length(-1)])
def test_oak_lintel_on_two_stone_piers(side: int) -> None:
    """Both piers rotate and lift the lintel equally: F h = (P + L / 2 · 2) w with piers of weight P."""
    width, height, span, depth = 0.5, 2.0, 3.0, 0.3
    wall = {"courses": [[1, -4, 1], [6]], "block_width": 0.5, "course_heights": [height, depth]}
    tables = scene_of(wall, 3.0, load__live={"kind": "point", "at": [1.5 - side * 1.5, 2.0], "force": [side, 0]})
    tables |= {"materials": {"oak": OAK}, "assign": [{"block": "oak", "box": [[0, 2], [span, 3]]}]}
    pier, lintel = 2000 * G * width * height, 700 * G * span * depth
    check(scene_from_dict(tables), (pier + lintel) * width / height)


ARCH = 11
RADIUS, RING = 2.0, 0.25


def arch_joints() -> Array:
    """Inner and outer ends of the joints of a semicircular arch, from left to right, ``(n + 1, 2, 2)``."""
    angle = np.linspace(np.pi, 0, ARCH + 1)
    rays = np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([RADIUS * rays, (RADIUS + RING) * rays], axis=1)


def arch(folder: Path, loaded: int) -> Scene:
    """The arch on the ground, with a live load on the middle of one voussoir's extrados."""
    document, joints = ezdxf.new(), arch_joints()  # type: ignore[attr-defined]
    document.modelspace().add_lwpolyline([(-4, -1), (4, -1), (4, 0), (-4, 0)], close=True)
    for left, right in pairwise(joints):
        document.modelspace().add_lwpolyline([left[0], right[0], right[1], left[1]], close=True)
    document.saveas(folder / "arch.dxf")
    at = joints[loaded : loaded + 2, 1].mean(axis=0)
    live = {"kind": "point", "at": at.tolist(), "force": [0, -1]}
    tables = scene_of({"drawing": "arch.dxf", "units": "m"}, 3.0, load__live=live)
    return read_scene(write_toml(tables, folder / "arch.toml"))


def least_load_of_four_hinges(scene: Scene, loaded: int) -> float:
    """Kinematic theorem by enumeration: least load of all mechanisms with four hinges at joint ends."""
    joints, best = arch_joints(), np.inf
    weight, centre = scene.mass[:-1] * 9.81, scene.blocks.centroid[:-1]
    at = joints[loaded : loaded + 2, 1].mean(axis=0)
    for hinges in combinations(range(ARCH + 1), 4):
        for ends in range(16):
            points = [joints[k, (ends >> i) & 1] for i, k in enumerate(hinges)]
            # Three parts rotate about a, the pole and d; their velocities agree at the hinges b and c.
            a, b, c, d = points
            line, other = b - a, d - c
            across = np.column_stack([line, other])
            if abs(np.linalg.det(across)) < 1e-9:
                continue
            s, _ = np.linalg.solve(across, c - a)
            pole = a + s * line
            spin = np.zeros(3)
            spin[0] = 1.0
            spin[1] = spin[0] * (b - a) @ line / ((b - pole) @ line)
            spin[2] = spin[1] * (c - pole) @ other / ((c - d) @ other)
            part = np.searchsorted(hinges, np.arange(ARCH) + 0.5) - 1
            for sense in (1, -1):
                rates = np.array([0, *(sense * spin), 0])
                turn = rates[part + 1]
                about = np.array([a, a, pole, d, d])[part + 1]
                opening = np.diff(rates)
                # A hinge at the inner end opens the outer end: the part on its right rotates clockwise.
                inner = np.array([(ends >> i) & 1 == 0 for i in range(4)])
                if not np.all(np.where(inner, opening, -opening) <= 1e-12):
                    continue
                down = -turn * (centre - about)[:, 0]
                power = down[loaded] - turn[loaded] * (at - centre[loaded])[0]
                if power > 1e-9:
                    best = min(best, float(-(weight @ down) / power))
    return best


@pytest.mark.parametrize("loaded", [3, *at_length(1, 5)])
def test_arch_under_a_moving_load(loaded: int, tmp_path: Path) -> None:
    scene = arch(tmp_path, loaded)
    exact = least_load_of_four_hinges(scene, loaded)
    if exact == np.inf:
        assert run_model("limit", scene).status == "unbounded"
        return
    check(scene, exact, ("limit", "dem-static") if loaded == 3 else ("limit",), sharp=1e-5)


@pytest.mark.parametrize("unused", [{}, {"mortar": MORTAR, "compressive_strength": 1e3, "cohesion": 1e6}])
def test_unused_default_joint_material_has_no_effect(
    unused: dict[str, Any],
) -> None:
    scene = scene_from_dict(
        content(
            wall={"thickness": 0.5, "block_width": 1.0, "block_height": 1.6, "length": 1.0, "height": 1.6},
            block=STONE,
            joint={"friction": 0.1, **unused},
            joints={"rough": {"friction": 2.0, "mortar": MORTAR}},
            assign=[{"joint": "rough", "between": ["block", "*"]}],
        )
    )
    check(scene, 1 / 1.6)
    for model in EVERY:
        assert "not taken into account: joint." not in run_model(model, scene).message
    if not unused:
        with pytest.raises(SceneError, match=r"joint\.mortar: is missing; blocks that move far meet anew on \[joint\]"):
            finite_system(scene)
