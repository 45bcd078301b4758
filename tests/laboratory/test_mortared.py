"""Mortared walls between beams at fixed height, as modelled with interface elements."""

import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.campaigns import Task
from runningbond.joints import joint_stiffness
from runningbond.laboratory.folder import SHIPPED, read_folder
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.rig import scene_of
from runningbond.scene import Scene, scene_from_dict
from runningbond.scene.file import read_description
from tests.at_length import at_length
from tests.walls import write_toml

WALLS = {wall.name: wall for wall in read_folder(SHIPPED[1])}
HEIGHT = 0.248


def squat(softening: str, way: float = 6e-4, rate: float = 0.04) -> Scene:
    """Four courses of J7D, two bricks long, pushed by `way` [m] at a `rate` [m/s]."""
    path = WALLS["J7D"].scene_file
    assert path is not None
    tables: dict[str, Any] = copy.deepcopy(read_description(path))
    tables["wall"] |= {"length": 0.44, "height": HEIGHT}
    tables["joint"]["softening"] = softening
    tables["beam"] |= {
        "force": [0, -44e3],
        "drive": {"displacement": [way, 0], "rate": rate, "at": HEIGHT},
    }
    return scene_from_dict(tables)


def test_wall_at_fixed_height_transfers_its_push_to_the_ground() -> None:
    """The ground reaction equals the push, the joints' work never decreases; exponential softening lowers the peak."""
    solve = LADDER["fem-small"].model.solve
    outcomes = {softening: solve(squat(softening), 0.01) for softening in ("exponential", "linear")}
    peaks = {}
    for softening, outcome in outcomes.items():
        assert outcome.status != "failed", outcome.message
        known = dict(zip(outcome.path_columns, outcome.path.T, strict=True))
        force = outcome.curve[:, 1]
        late = slice(len(force) // 4, len(force) - 20)
        assert -known["ground horizontal [N]"][late] == pytest.approx(force[late], rel=0.03)
        peaks[softening] = float(force.max())
        assert np.diff(known["work spent in joints [J]"]).min() > -1e-6
    assert peaks["exponential"] < peaks["linear"] < 1.2 * peaks["exponential"]


IN_MOTION = [name for name, rung in LADDER.items() if rung.base in ("dem-dynamic", "fem")]


@pytest.mark.parametrize("name", [*(each for each in IN_MOTION if each != "fem-cracking"), *at_length("fem-cracking")])
def test_models_of_the_ladder_run_under_the_campaigns_observer(name: str) -> None:
    """As `runningbond validate` runs them: under an observer that keeps moments, except for pieces of blocks."""
    answer = Task("squat", squat("exponential", 5e-5, 0.01), LADDER[name].model, 0.01).run()
    assert answer.outcome is not None, answer.reason
    assert answer.outcome.status in ("collapse", "unbounded", "undecided"), answer.outcome.message
    assert len(answer.outcome.curve) > 10
    assert (len(answer.outcome.moments) > 1) == (name != "fem-cracking")


@pytest.mark.parametrize("parts", [1, 3, 6])
def test_inner_joints_between_smaller_parts_are_stiffer(parts: int) -> None:
    """Ten times E over the height of a part (62 mm for the whole block), if that exceeds the scene's own stiffness."""
    features = replace(LADDER["fem-small"].features, parts=parts)
    plain, crack = (scene_of(WALLS["J7D"], each).inner_joint for each in (LADDER["fem-small"].features, features))
    assert plain is not None
    assert crack is not None
    stiffness = joint_stiffness(crack)
    assert stiffness.normal == pytest.approx(1.5e12 if parts == 1 else 10 * 16.7e9 * parts / 0.062)
    assert stiffness.shear == pytest.approx(stiffness.normal)
    assert replace(crack, elasticity=plain.elasticity) == plain
    rung: Any = LADDER["fem-cracking"]
    assert rung.features.parts == rung.model.solve.keywords["settings"]["cells"]


@pytest.mark.parametrize(
    "changes",
    [
        {"beam": {"height": 0.01}},
        {
            "block": {"young": 1e9},
            "materials": {"brick": {"density": 1800.0, "young": 16.7e9}},
            "assign": [{"block": "brick", "box": [[-1, -1], [2, 2]]}],
        },
    ],
)
def test_crack_stiffness_depends_only_on_the_cracking_blocks(changes: dict[str, Any], tmp_path: Path) -> None:
    """Neither on the beam, which does not crack, nor on a material that no block has."""
    wall = WALLS["J7D"]
    assert wall.scene_file is not None
    tables = copy.deepcopy(read_description(wall.scene_file))
    for key, table in changes.items():
        tables[key] = tables.get(key, {}) | table if isinstance(table, dict) else table
    own = replace(wall, scene_file=write_toml(tables, tmp_path / "J7D.toml"))
    features = LADDER["fem-cracking"].features
    cracks = [scene_of(each, features).inner_joint for each in (wall, own)]
    assert cracks[0] == cracks[1]


@pytest.mark.parametrize("name", ["J4D", "J5D", "J6D", "J7D"])
def test_the_scenes_have_the_published_joints(name: str) -> None:
    """c = 1.4 f_t, the same apex for potential cracks and joints, and a load equal to the pressure on the top."""
    scene = scene_of(WALLS[name], LADDER["fem-small"].features)
    joint, crack = scene.joint, scene.inner_joint
    assert crack is not None
    assert scene.beam is not None
    assert joint.softening == crack.softening == "exponential"
    assert joint.cohesion == pytest.approx(1.4 * joint.tension)
    assert crack.cohesion == pytest.approx(1.4 * crack.tension)
    pressure = {"J4D": 0.30e6, "J5D": 0.30e6, "J6D": 1.21e6, "J7D": 2.12e6}[name]
    assert -scene.beam.force[1] == pytest.approx(pressure * 0.99 * 0.1)
