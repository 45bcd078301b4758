"""Any scene gets a result or one line, never a traceback; results keep their promises."""

import json
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compare.command import command
from compare.models import MODELS
from dem import limit, limit_nonassociated
from scene import SceneError, scene_from_dict
from tests.walls import content, write_toml

widths = st.sampled_from([0.5, 1, 1.5, -0.5, -1])
patterns = st.lists(st.lists(widths, min_size=1, max_size=5), min_size=1, max_size=5)
odd = st.sampled_from([0, -1, float("nan"), float("inf"), 1e300, 1e-300, "", "x", True, [], {}, [[]], 10**30])
kinds = st.sampled_from(["base", "fixed-first-course", "corners", "pinned-corners"])


@st.composite
def tables(draw: st.DrawFn) -> dict[str, Any]:
    """A scene, most often a wall, with up to two keys set to nonsense."""
    changes: dict[str, Any] = {
        "joint": {
            "friction": draw(st.floats(0, 3)),
            "cohesion": draw(st.sampled_from([0.0, 0.0, 1e2, 1e5])),
            "inset": draw(st.sampled_from([0.0, 0.0, 0.01])),
        },
        "support__kind": draw(kinds),
        "block__density": draw(st.floats(1e-3, 1e5)),
        "load__gravity": draw(st.sampled_from([9.81, 9.81, 0.0])),
    }
    if draw(st.booleans()):
        changes |= {"wall__length": None, "wall__height": None, "wall__courses": draw(patterns)}
    else:
        changes |= {"wall__length": 0.12 * draw(st.integers(1, 8)), "wall__height": 0.06 * draw(st.integers(1, 5))}
        changes["wall__ends"] = draw(st.sampled_from(["flush", "toothed"]))
    if draw(st.booleans()):
        at = [draw(st.floats(-0.2, 1.2)), draw(st.sampled_from([0.06, 0.12, 0.18, 0.24]))]
        force = [draw(st.floats(-1, 1)), draw(st.floats(-1, 1))]
        changes["load__live"] = {"kind": "point", "at": at, "force": force}
    scene = content(**changes)
    for _ in range(draw(st.sampled_from([0, 0, 0, 1, 2]))):
        table = draw(st.sampled_from(["wall", "block", "joint", "support", "load"]))
        if scene[table]:
            key = draw(st.sampled_from([*scene[table], "unheard_of"]))
            scene[table][key] = draw(odd)
    return scene


@given(scene=tables(), model=st.sampled_from(sorted(MODELS)))
@settings(max_examples=200, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
def test_any_scene_gets_an_object_or_a_line(scene: dict[str, Any], model: str) -> None:
    out, err = StringIO(), StringIO()
    with tempfile.TemporaryDirectory() as folder:
        path = write_toml(scene, Path(folder) / "wall.toml")
        with redirect_stdout(out), redirect_stderr(err):
            code = command(["run", str(path), "--model", model, "--json"])
    if code == 2:
        assert out.getvalue() == ""
        assert err.getvalue().count("\n") == 1
        return
    found = json.loads(out.getvalue())
    assert out.getvalue().count("\n") == 1
    assert code == (3 if found["status"] in ("undecided", "failed") else 0)
    assert found["status"] != "failed", found["message"]
    assert (found["multiplier"] is not None) == (found["status"] == "collapse")


@given(pattern=patterns, friction=st.floats(0.05, 2), height=st.floats(0.05, 1))
@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.filter_too_much])
def test_true_friction_never_carries_more_than_the_associated_bound(
    pattern: list[list[float]], friction: float, height: float
) -> None:
    tables = content(wall__length=None, wall__height=None, wall__courses=pattern, joint__friction=friction)
    tables["wall"] |= {"block_width": 0.4, "block_height": height}
    try:
        scene = scene_from_dict(tables)
    except SceneError:
        return
    associated, true = limit(scene), limit_nonassociated(scene)
    assert (associated.status == "infeasible") == (true.status == "infeasible")
    if associated.upper is not None and true.upper is not None:
        assert true.upper <= associated.upper * (1 + 1e-6) + 1e-9
    if associated.status == "collapse":
        assert associated.multiplier is not None
        assert associated.multiplier <= friction + 1e-6, "a frictional base slides at tan φ"
