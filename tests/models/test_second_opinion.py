"""Soft blocks compared with rigid blocks: equal limit loads, different ones, and what the message reports."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from dem.dynamic import dem_dynamic
from fem_interface.model import fem
from runningbond.compare import PUBLISHED, published_scene
from runningbond.joints.stiffness import block_compliance
from runningbond.models import run_model
from runningbond.models.second_opinion import asks_others, beside_others
from runningbond.results import Outcome
from tests.walls import courses


def bracket(lower: float, upper: float, steps: int = 10) -> Outcome:
    return Outcome("", "fem", "collapse", (lower + upper) / 2, lower, upper, steps=steps, message="found")


def never() -> Outcome:
    raise AssertionError("asked though there is no need")


def test_bracket_shared_with_rigid_blocks_is_unchanged() -> None:
    found = beside_others(bracket(0.50, 0.51), lambda: bracket(0.51, 0.52), never)
    assert (found.lower, found.upper, found.message) == (0.50, 0.51, "found")
    assert found.steps == 20


@pytest.mark.parametrize("rigid", [(0.45, 0.46), (0.55, 0.56)])
def test_bracket_includes_finer_mesh_if_rigid_blocks_differ(rigid: tuple[float, float]) -> None:
    found = beside_others(bracket(0.50, 0.51), lambda: bracket(*rigid), lambda: bracket(0.46, 0.47))
    assert (found.lower, found.upper) == (0.46, 0.51)
    assert found.multiplier == pytest.approx(0.465)  # the smaller of the two limit loads
    assert found.steps == 30
    assert "forces are those of blocks as they are" in found.message
    for loads in ("0.5000–0.5100", "0.4600–0.4700", f"{rigid[0]:.4f}–{rigid[1]:.4f}"):
        assert loads in found.message


def test_undecided_comparison_is_reported_and_changes_no_bracket() -> None:
    lost = replace(bracket(0.4, 0.6), status="undecided", multiplier=None, message="the budget ran out")
    found = beside_others(bracket(0.50, 0.51), lambda: lost, never)
    assert (found.lower, found.upper) == (0.50, 0.51)
    assert "undecided: the budget ran out" in found.message
    found = beside_others(bracket(0.50, 0.51), lambda: bracket(0.45, 0.46), lambda: lost)
    assert (found.lower, found.upper) == (0.50, 0.51)
    assert "as fine undecided" in found.message
    assert beside_others(lost, never, never) is lost


def test_elastic_displacement_of_locking_wall_is_not_collapse() -> None:
    """Soft blocks under an inclined force inside the friction cone move by 1/20 of their height and come to rest."""
    joint = {"friction": 0.68, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    live = {"kind": "point", "at": [0.6, 0.8], "force": [0.3, -1.0]}
    wall = {"wall__thickness": 0.25, "block": {"density": 2000.0, "young": 7.5e8}, "joint": joint, "load__live": live}
    scene = courses([[1, 1, 1], [0.5, 1, 1, 0.5]], width=0.4, height=0.4, **wall)
    outcome = fem(scene, 0.2)
    assert outcome.status == "unbounded", outcome.message
    assert "it carried every load tried, and joint forces balance any multiple" in outcome.message


def test_published_blocks_are_stiff_and_stone_in_thin_mortar_is_soft() -> None:
    """k_n h / (k_n h + E) with h = 175 mm and 10 mm of mortar of 1 GPa, confined along the joint."""
    for case in PUBLISHED:
        assert not asks_others(published_scene(case.name), {})
    column = 1e9 / (1 - 0.2**2) / 0.01 * 0.175
    for young, soft in ((1e12, False), (1e10, True)):
        wall = published_scene("wall-w4").with_block(young=young)
        assert block_compliance(wall) == pytest.approx(column / (column + young))
        assert asks_others(wall, {}) is soft
        assert asks_others(wall, {"cells": 1, "budget": 10}) is soft
        assert not asks_others(wall, {"cells": 2})


def test_beam_does_not_count_in_block_compliance() -> None:
    """Nor does its joint: with another block height, the beam would count as masonry of that height."""
    joint = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    beams: list[dict[str, Any]] = [{}, {"beam": {"height": 0.1}}]
    alone, under = (courses([[1, 1], [0.5, 1, 0.5]], joint=joint, block__young=2e9, **beam) for beam in beams)
    assert len(under.joints) > len(alone.joints)
    assert block_compliance(under) == pytest.approx(block_compliance(alone), rel=1e-12)


def test_block_compliance_counts_used_materials_only() -> None:
    """A Young's modulus that no block has requires no comparison; one that some blocks have does, in any table."""
    changes: dict[str, Any] = {"wall__thickness": 0.25, "joint": {"friction": 0.6}, "load__live": {"kind": "lateral"}}
    changes["joint"] |= {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    for default, other, box, soft in ((2e9, 1e12, 9, False), (1e12, 2e9, 9, True), (1e12, 2e9, 0.4, True)):
        blocks: dict[str, Any] = {"block": {"density": 2000.0, "young": default}}
        blocks["materials"] = {"other": {"density": 2000.0, "young": other}}
        assign = [{"block": "other", "box": [[-9, -9], [box, box]]}]
        wall = courses([[1, 1], [0.5, 1, 0.5]], width=0.4, height=0.4, assign=assign, **blocks, **changes)
        assert asks_others(wall, {}) is soft


@pytest.mark.long
def test_error_of_coarse_mesh_on_soft_wall_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """55 blocks of 10 GPa, contacts inset 20 mm: one cell per half block gives 3 % above rigid blocks, three do not."""
    wall = published_scene("wall-w4").with_joint(inset=0.02).with_block(young=1e10)
    asked: list[Outcome] = []

    def heard(model: Callable[..., Outcome]) -> Callable[..., Outcome]:
        def solve(*arguments: Any, **settings: Any) -> Outcome:
            asked.append(model(*arguments, **settings))
            return asked[-1]

        return solve

    monkeypatch.setattr("fem_interface.model.fem", heard(fem))
    monkeypatch.setattr("dem.dynamic.dem_dynamic", heard(dem_dynamic))
    found = run_model("fem", wall)
    alone, rigid, finer = asked
    assert rigid.lower is not None
    assert rigid.upper is not None
    assert alone.lower is not None
    assert finer.lower is not None
    assert rigid.upper < alone.lower
    assert finer.lower <= rigid.upper
    assert (found.lower, found.upper) == (finer.lower, alone.upper)
    assert "how blocks deform decides where this wall falls" in found.message
