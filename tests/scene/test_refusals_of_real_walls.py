"""Invalid materials, assignments, loads, settlements, ties and beams: one clear line, exit code 2, no output."""

import math
from pathlib import Path
from typing import Any

import pytest

from runningbond.commands.command_line import command
from runningbond.scene.beam import Drive
from tests.walls import content, panel, write_toml

OAK = {"materials": {"oak": {"density": 700.0}}}
MORTAR = {"joints": {"mortar": {"friction": 0.75, "cohesion": 1e5}}}
BOTH = OAK | MORTAR
BOX = [[0, 0], [1, 0.3]]
LINE = {"kind": "line", "from": [0, 0.72], "to": [1.44, 0.72], "force": [0, -8e3]}
MOMENT = {"kind": "moment", "at": [0.1, 0.7], "moment": 10.0}
SINK = {"kind": "settlement", "box": [[-1, -1], [0.7, 0]], "by": [0, -0.01]}
TIE = {"from": [0, 0.39], "to": [1.44, 0.39], "area": 3e-4, "young": 2.1e11, "yield": 7e4}
BEAM = {"height": 0.25, "drive": {"force": [1, 0]}}
DRIVEN = {"load": {"gravity": 9.81}}


def dead(load: Any) -> dict[str, Any]:
    return {"load__dead": [load]}


def live(load: Any) -> dict[str, Any]:
    return {"load__live": [load]}


def assign(entry: Any) -> dict[str, Any]:
    return BOTH | {"assign": [entry]}


def tie(**changes: Any) -> dict[str, Any]:
    return {"tie": [{key: value for key, value in (TIE | changes).items() if value is not None}]}


def beam(**changes: Any) -> dict[str, Any]:
    return DRIVEN | {"beam": {key: value for key, value in (BEAM | changes).items() if value is not None}}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        # materials
        ({"materials": 3}, "materials = 3: must be a table"),
        ({"materials": {"oak": 3}}, "materials.oak = 3: must be a table"),
        ({"materials": {"oak": {}}}, "materials.oak.density: is missing"),
        ({"materials": {"oak": {"density": -1}}}, "materials.oak.density = -1: must be a number above 0"),
        ({"materials": {"oak": {"density": 1.0, "yung": 1e9}}}, 'materials.oak.yung = 1000000000.0: is not a key'),
        ({"materials": {"ground": {"density": 1.0}}}, "materials.ground: is a name that means something else"),
        ({"materials": {"block": {"density": 1.0}}}, "materials.block: is a name that means something else"),
        ({"joints": {"mortar": {"cohesion": 1e5}}}, "joints.mortar.friction: is missing"),
        ({"joints": {"mortar": {"friction": 0.5, "tensile_strength": 9.0}}}, "joints.mortar.tensile_strength = 9.0"),
        ({"joints": {"mortar": {"friction": 0.5, "mortar": {"young": 1e9}}}}, "joints.mortar.mortar.poisson: is miss"),
        ({"joints": {"joint": {"friction": 0.5}}}, "joints.joint: is a name that means something else"),
        ({"joints": {"mortar": {"friction": 0.5, "inset": 0.2}}, "assign": [{"joint": "mortar", "box": BOX}]},
         "joints.mortar.inset = 0.2: must be less than half the shortest joint"),
        # assignments
        ({"assign": 3}, "assign = 3: must be tables, [[assign]]"),
        (assign(3), "assign[0] = 3: must be a table"),
        (assign({"box": BOX}), "assign[0]: must have one of block and joint"),
        (assign({"block": "oak", "joint": "mortar", "box": BOX}), "assign[0]: must have one of block and joint"),
        (assign({"block": "oka", "box": BOX}), 'assign[0].block = \'oka\': must be one of "block", "oak"; did'),
        (assign({"joint": "oak", "box": BOX}), 'assign[0].joint = \'oak\': must be one of "joint", "mortar"'),
        (assign({"block": "oak"}), "assign[0]: must have one of box, layer, blocks"),
        (assign({"block": "oak", "box": BOX, "blocks": [1]}), "assign[0]: must have one of box, layer, blocks"),
        (assign({"block": "oak", "between": ["oak", "*"]}), "assign[0]: must have one of box, layer, blocks"),
        (assign({"block": "oak", "box": [[0, 0]]}), "assign[0].box = [[0, 0]]: must be two corners"),
        (assign({"block": "oak", "box": [[1, 1], [0, 0]]}), "assign[0].box = [[1, 1], [0, 0]]: must have its lower"),
        (assign({"block": "oak", "box": [[0, 0], [1, "a"]]}), "assign[0].box[1] = [1, 'a']: must be a pair"),
        (assign({"block": "oak", "box": [[9, 9], [10, 10]]}), "assign[0]: chooses no block"),
        (assign({"block": "oak", "blocks": []}), "assign[0].blocks = []: must be a list of block numbers"),
        (assign({"block": "oak", "blocks": [1.5]}), "assign[0].blocks = [1.5]: must be a list of block numbers"),
        (assign({"block": "oak", "blocks": [999]}), "assign[0].blocks = 999: must be below"),
        (assign({"block": "oak", "layer": "OAK"}), "assign[0].layer = 'OAK': needs a drawing"),
        (assign({"joint": "mortar", "between": ["oak"]}), "assign[0].between = ['oak']: must be two names"),
        (assign({"joint": "mortar", "between": ["oak", "stone"]}), "assign[0].between[1] = 'stone': must be one of"),
        (assign({"joint": "mortar", "between": ["oak", "*"]}), "assign[0]: chooses no joint"),
        (assign({"joint": "mortar", "orientation": "flat"}), 'assign[0].orientation = \'flat\': must be one of "bed"'),
        (assign({"block": "oak", "box": BOX, "orientation": "bed"}), "assign[0].orientation = 'bed': is not a key"),
        # loads
        (live({"kind": "tilt", "direction": "down"}), "load.live[0].direction = 'down': must be"),
        (live({"kind": "tilt", "direction": [1, -1]}), "load.live.direction = [0.707107, -0.707107]: must be"),
        (live({"kind": "lateral", "direction": [0, 0]}), "load.live[0].direction = [0.0, 0.0]: must not be zero"),
        (dead({"kind": "tilt"}), "load.dead[0].kind = 'tilt': must be one of"),
        (dead(SINK), "load.dead[0].kind = 'settlement': must be one of"),
        (dead(LINE | {"to": [0, 0.72]}), "load.dead[0].to = [0.0, 0.72]: must lie apart from the line's other end"),
        (dead(LINE | {"force": [0, 0]}), "load.dead[0].force = [0.0, 0.0]: must not be zero"),
        (dead(LINE | {"to": [2, 0.72]}), "load.dead.from = [0.0, 0.72]: the line from there to [2.0, 0.72] runs at"),
        (dead(LINE | {"from": [0, 0.66], "to": [1.44, 0.66], "force": [5e3, 0]}), "is at (0.06, 0.66) on more than"),
        (dead(LINE | {"at": [0, 0]}), "load.dead[0].at = [0, 0]: is not a key"),
        (dead(MOMENT | {"moment": 0}), "load.dead[0].moment = 0.0: must not be zero"),
        (dead(MOMENT | {"at": [9, 9]}), "load.dead.at = [9.0, 9.0]: must lie in one block that can move"),
        (dead(MOMENT | {"at": [0.36, 0.7]}), "load.dead.at = [0.36, 0.7]: must lie in one block that can move"),
        (dead({"kind": "moment", "moment": 1.0}), "load.dead[0].at: is missing"),
        (dead({"kind": "body", "acceleration": [1]}), "load.dead[0].acceleration = [1]: must be a pair"),
        ({"load__gravity": [0, "g"]}, "load.gravity = [0, 'g']: must be a pair"),
        # settlements
        (live(SINK | {"by": [0, 0]}), "load.live[0].by = [0.0, 0.0]: must move the support"),
        (live({"kind": "settlement", "box": SINK["box"]}), "load.live[0].by: is missing"),
        (live(SINK | {"box": [[5, 5], [6, 6]]}), "load.live.box = [[5.0, 5.0], [6.0, 6.0]]: holds no ground"),
        (live(SINK | {"box": [[0, 5], [0.7, 6]]}), "load.live.box = [[0.0, 5.0], [0.7, 6.0]]: holds no ground"),
        (live(SINK | {"rotation_angle": 30}), "load.live[0].rotation_angle = 30.0: must be a number at least -10"),
        (live(SINK | {"rotation_angle": 10, "path": [1, -5, 0]}), "at most 10 degrees; its path multiplies it by 5"),
        (live(SINK | {"rotation_angle": 6, "amplitudes": [1, 2]}), "load.live[0].rotation_angle = 6.0: must turn the"),
        (live(SINK | {"about": [1, 1]}), "load.live[0].rotation_angle: is missing; about is the point"),
        (live(SINK | {"about": [1]}), "load.live[0].about = [1]: must be a pair"),
        (live(SINK | {"path": []}), "load.live[0].path = []: must be a list of finite numbers that are not all zero"),
        (live(SINK | {"path": 2}), "load.live[0].path = 2: must be a list"),
        (live(SINK | {"path": [0, 0]}), "load.live[0].path = [0, 0]: must be a list of finite numbers that are"),
        (live(SINK | {"path": [1, "a"]}), "load.live[0].path = 'a': must be a number"),
        (live(SINK | {"path": [1, True]}), "load.live[0].path = True: must be a number"),
        (live(SINK | {"path": [1, math.inf]}), "load.live[0].path = inf: must be a number"),
        (live(SINK | {"path": [1], "amplitudes": [1]}), "load.live[0]: must have one of path and amplitudes, not both"),
        (live(SINK | {"cycles": 2}), "load.live[0].cycles = 2: needs amplitudes"),
        (live(SINK | {"amplitudes": 1}), "load.live[0].amplitudes = 1: must be a list"),
        (live(SINK | {"amplitudes": [1, 0]}), "load.live[0].amplitudes[1] = 0.0: must not be zero"),
        (live(SINK | {"amplitudes": [1], "cycles": 1.5}), "load.live[0].cycles = 1.5: must be a whole number"),
        (live(SINK | {"amplitudes": [1], "rate": 1e-3}), "load.live[0].rate = 0.001: is not a key"),
        (live(SINK | {"path": [1, -1]}), "load.live settlement, along a path: is not supported by model limit"),
        ({"load__live": [SINK, {"kind": "lateral"}]}, "load.live: must be the settlement alone"),
        (
            {"load__live": [SINK, {"kind": "lateral"}], "beam": {"height": 0.25}},
            "load.live: must be the settlement alone",
        ),
        (
            {"load__live": SINK, "load__dead": {"kind": "point", "at": [9, 9], "force": [0, -1]}},
            "load.dead.at = [9.0, 9.0]: touches no block",
        ),
        (live(SINK) | {"support__kind": "corners"}, "load.live: needs support.kind"),
        # ties
        ({"tie": {"from": [0, 0]}}, "tie = {'from': [0, 0]}: must be tables, [[tie]]"),
        (tie(area=0), "tie[0].area = 0: must be a number above 0"),
        (tie(**{"yield": None}), "tie[0].yield: is missing"),
        (tie(young=None), "tie[0].young: is missing"),
        (tie(preload=8e4), "tie[0].preload = 80000.0: must be at most the yield force"),
        (tie(to=[1.44, 0.42]), "tie[0].to = [1.44, 0.42]: lies on the joint of"),
        (tie(to=[0.1, 0.39]), "tie[0].to = [0.1, 0.39]: must lie on another block than tie[0].from"),
        (
            tie(**{"from": [-0.1, 0.3], "to": [1.5, 0.3]}),
            "tie[0].to = [1.5, 0.3]: is at no block, and tie[0].from at no block; one of them must be at a block that",
        ),
        (
            tie(**{"from": [0.3, 9], "to": [0.3, -0.1]}),
            "tie[0].to = [0.3, -0.1]: is at block 78, which is held, and tie[0].from at no block",
        ),
        (tie(diameter=0.02), "tie[0].diameter = 0.02: is not a key"),
        # beams
        (beam(height=0), "beam.height = 0: must be a number above 0"),
        (beam(mass=-1), "beam.mass = -1: must be a number at least 0"),
        (beam(condition="levle"), "did you mean \"level\"?"),
        (beam(joint="mortar"), "beam.joint = 'mortar': must be one of \"joint\""),
        (beam(force=[1]), "beam.force = [1]: must be a pair"),
        (beam(drive={}), "beam.drive: must have one of force, displacement and amplitudes"),
        (beam(drive={"force": [1, 0], "displacement": [0.01, 0]}), "beam.drive: must have one of force, displ"),
        (beam(drive={"force": [1, 0], "amplitudes": [0.01]}), "beam.drive: must have one of force, displacement and"),
        (beam(drive={"displacement": [0.01, 0], "amplitudes": [0.01]}), "beam.drive: must have one of force, displ"),
        (beam(drive={"force": [1, 0], "cycles": 2}), "beam.drive.cycles = 2: needs amplitudes"),
        (beam(drive={"displacement": [0.01, 0], "cycles": 2}), "beam.drive.cycles = 2: needs amplitudes"),
        (beam(drive={"amplitudes": []}), "beam.drive.amplitudes = []: must be a list of finite numbers that are not"),
        (beam(drive={"amplitudes": 0.01}), "beam.drive.amplitudes = 0.01: must be a list"),
        (beam(drive={"amplitudes": "0.01"}), "beam.drive.amplitudes = '0.01': must be a list"),
        (beam(drive={"amplitudes": [[0.01]]}), "beam.drive.amplitudes = [0.01]: must be a number"),
        (beam(drive={"amplitudes": [0.01, 0]}), "beam.drive.amplitudes[1] = 0.0: must not be zero"),
        (beam(drive={"amplitudes": [math.nan]}), "beam.drive.amplitudes = nan: must be a number"),
        (beam(drive={"amplitudes": [0.01], "cycles": 0}), "beam.drive.cycles = 0: must be a number at least 1"),
        (beam(drive={"amplitudes": [0.01], "cycles": 1001}), "beam.drive.cycles = 1001: must be a number at least 1"),
        (beam(drive={"amplitudes": [0.01], "cycles": 2.5}), "beam.drive.cycles = 2.5: must be a whole number"),
        (beam(drive={"amplitudes": [0.01], "cycles": [2]}), "beam.drive.cycles = [2]: must be a number at least 1"),
        (beam(drive={"amplitudes": [0.01], "rate": -1}), "beam.drive.rate = -1: must be a number above 0"),
        (beam(drive={"amplitude": [0.01]}), 'is not a key of [beam.drive]; did you mean "amplitudes"?'),
        (beam(drive={"force": [0, 0]}), "beam.drive.force = [0.0, 0.0]: must not be zero"),
        (beam(drive={"force": [1, 0], "rate": 1e-3}), "beam.drive.rate = 0.001: is not a key"),
        (beam(drive={"displacement": [0.01, 0.01]}), "must be horizontal"),
        (beam(drive={"displacement": [[0, 0]]}), "beam.drive.displacement = [0, 0]: must move the beam"),
        (beam(drive={"displacement": [[0, "a"]]}), "beam.drive.displacement = 'a': must be a number"),
        (beam(drive={"displacement": [0.01, 0], "rate": 0}), "beam.drive.rate = 0: must be a number above 0"),
        (beam(drive=None), "load.live: is missing"),
        ({"beam": {"height": 0.2, "drive": {"displacement": [0.01, 0]}}}, "load.live: must be left out where the"),
    ],
)  # fmt: skip
def test_invalid_scene_is_refused(
    changes: dict[str, Any], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = write_toml(content(**changes), tmp_path / "wall.toml")
    out = tmp_path / "out"
    assert command(["run", "--model", "limit", str(scene), "--out", str(out)]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert said in printed.err
    assert printed.err.count("\n") == 1
    assert not out.exists()


def test_amplitudes_and_cycles_become_turning_points() -> None:
    """Each amplitude is repeated for its cycles, then back to zero; a negative one begins on the other side."""
    drive = {"amplitudes": [1e-3, -2e-3], "cycles": 2, "at": 0.8}
    scene = panel(**beam(drive=drive))
    assert scene.beam is not None
    assert scene.beam.drive == Drive.along((*[1e-3, -1e-3] * 2, *[-2e-3, 2e-3] * 2, 0.0), 0.8)
    sunk = panel(**live(SINK | {"amplitudes": [0.5]})).settlement
    assert sunk is not None
    assert sunk.path == (0.5, -0.5, 0.0)
    assert panel(**live(SINK | {"path": [1]})).extras == ("load.live settlement",)
