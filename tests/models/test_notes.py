"""Notes on outcomes that are made by hand: walls that moved far, and what models leave out."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dem.static import FALLEN
from runningbond.limit import elastic_displacement
from runningbond.models import MODELS, run_model
from runningbond.models.far import going_far
from runningbond.models.notes import FAR_MOTION, led_far, left_out, moves, without_mass
from runningbond.results import Outcome
from runningbond.scene import Scene, scene_from_dict
from tests.walls import content, courses, panel

STATIC = MODELS["dem-static"]
STIFF = {"friction": 0.6, "normal_stiffness": 1e13, "shear_stiffness": 1e13}
SMALLER = 0.72
"""Height of the reference panel [m], which is 1.44 m long."""

SINKS = {"kind": "settlement", "box": [[-1.0, -1.0], [9.0, 0.01]], "by": [0.0, -0.01]}
DRIVEN = {"height": 0.1, "condition": "free", "force": [0, -1000.0], "drive": {"displacement": [0.01, 0.0]}}


def collapsed(curve: list[list[float]]) -> Outcome:
    """A collapse between 0.3 and 0.35, on a path."""
    return Outcome("panel", "dem-static", "collapse", 0.32, 0.3, 0.35, curve=np.array(curve))


def settling(**changes: Any) -> Scene:
    """The panel on a ground that sinks."""
    return panel(joint=STIFF, load__live=SINKS, **changes)


def driven() -> Scene:
    """The panel under a driven beam."""
    tables = content(joint=STIFF, beam=DRIVEN)
    del tables["load"]["live"]
    return scene_from_dict(tables)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_motion_at_the_largest_load_at_rest_counts(sense: float) -> None:
    """Not the motion of the fall, not that at other loads; 2 % of the smaller side are small."""

    def note(moved: float) -> str:
        curve = [[0.0, 0.0], [0.1, 0.2], [sense * moved, 0.3], [1.0, 0.31]]
        return moves(STATIC, panel(joint=STIFF), collapsed(curve), None)

    assert note(0.999 * FAR_MOTION * SMALLER) == ""
    side = "at the largest load at rest the wall has moved by 5 % of its smaller side, beyond small displacements"
    assert note(0.05 * SMALLER) == side
    assert "2 % of its smaller side" in note(1.001 * FAR_MOTION * SMALLER)


def test_motion_counts_up_to_where_the_largest_load_is_first_reached() -> None:
    """Along a plateau, as of a pier whose ties yield while it turns, λ drifts by rounding: this is no softness."""
    curve = [[0.0, 0.0], [1e-4, 0.3 * (1 - 1e-9)], [0.1, 0.3 * (1 - 1e-11)], [0.3, 0.3], [1.0, 0.3]]
    assert moves(STATIC, panel(joint=STIFF), collapsed(curve), None) == ""
    curve[1][1] = curve[2][1] = 0.299
    assert "has moved by 42 % of its smaller side" in moves(STATIC, panel(joint=STIFF), collapsed(curve), None)


def test_without_rest_on_the_path_no_motion_is_told() -> None:
    assert moves(STATIC, panel(joint=STIFF), collapsed([[0.0, 0.0], [1.0, 0.31]]), None) == ""


def test_motion_is_told_of_walls_that_collapse_on_a_path_under_a_load() -> None:
    """Not of closed forms, moving supports, driven beams, undecided walls, and walls that fall under the dead load."""
    far = collapsed([[0.0, 0.0], [0.1, 0.3]])
    assert moves(STATIC, panel(joint=STIFF), far, None) != ""
    assert moves(MODELS["limit"], panel(joint=STIFF), far, None) == ""
    assert moves(STATIC, settling(), far, None) == ""
    assert moves(STATIC, driven(), far, None) == ""
    assert moves(STATIC, panel(joint=STIFF), replace(far, status="undecided", multiplier=None), None) == ""
    falls = replace(far, multiplier=0.0, lower=0.0, upper=0.0, curve=np.array([[0.1, 0.0]]))
    assert moves(STATIC, panel(joint=STIFF), falls, None) == ""


def test_elastic_motion_is_told_beyond_the_height_at_which_a_wall_counts_as_fallen() -> None:
    """In heights of a block, at the upper load; a larger `collapse` allows more."""
    soft = panel(joint={"friction": 0.6, "normal_stiffness": 2e10, "shear_stiffness": 1e6})
    given = elastic_displacement(soft, 0.35)
    assert given is not None
    share = given / 0.06
    assert share > 2 * FALLEN
    still = collapsed([[0.0, 0.3]])
    said = f"joints are too soft: the wall gives by {100 * share:.2g} % of a block's height elastically"
    assert moves(STATIC, soft, still, None).startswith(said)
    assert moves(STATIC, soft, still, 0.999 * share).startswith(said)
    assert moves(STATIC, soft, still, 1.001 * share) == ""


def test_modulus_counts_for_models_that_read_it() -> None:
    """Blocks of 1 MPa on stiff joints are soft in `fem`, and rigid in `dem-static`."""
    soft, still = panel(joint=STIFF, block__young=1e6, block__poisson=0.2), collapsed([[0.0, 0.3]])
    assert "joints are too soft" in moves(MODELS["fem"], soft, still, None)
    assert moves(STATIC, soft, still, None) == ""


@pytest.mark.parametrize(("scene", "who"), [(settling(), "the support"), (driven(), "the beam")])
def test_prescribed_motion_is_told_beyond_small_displacements(scene: Scene, who: str) -> None:
    """By the farthest displacement of the path to either side; a beam is no part of the wall's sides."""

    def note(model: Any, *moved: float) -> str:
        return led_far(model, scene, collapsed([[each, 0.1] for each in (0.0, *moved)]))

    height = SMALLER
    small, far = 0.999 * FAR_MOTION * height, 0.05 * height
    assert note(STATIC, small, -small) == ""
    said = f"{who} goes by 5 % of the wall's smaller side, beyond small displacements"
    assert note(STATIC, far, 0.0) == note(STATIC, small, -far) == said
    assert note(MODELS["dem-dynamic"], far) == f"{said}; finite ones follow it"
    assert note(going_far(MODELS["dem-dynamic"], "finite", None), far) == ""
    assert note(MODELS["limit"], far) == ""


def test_prescribed_motion_is_told_of_walls_that_are_led_along_a_path() -> None:
    far = collapsed([[0.0, 0.0], [0.1, 0.3]])
    assert led_far(STATIC, panel(joint=STIFF), far) == ""
    assert led_far(STATIC, settling(), replace(far, curve=np.zeros((0, 2)))) == ""


def test_finite_displacements_are_offered_to_walls_that_they_support() -> None:
    far = collapsed([[0.0, 0.0], [0.1, 0.3]])
    under_beam = settling(beam={"height": 0.1, "condition": "free", "force": [0, -1000.0]})
    assert "finite ones follow it" in led_far(MODELS["dem-dynamic"], settling(), far)
    assert led_far(MODELS["dem-dynamic"], under_beam, far).endswith("beyond small displacements")


def test_keys_that_a_model_does_not_read_are_listed() -> None:
    soft = panel(joint=STIFF, block__young=1e6, block__poisson=0.2)
    assert left_out(MODELS["dem-dynamic"], soft) == "not taken into account: block.young, block.poisson"
    assert left_out(MODELS["fem"], soft) == ""


def test_floors_that_the_lateral_load_does_not_push_are_told() -> None:
    """A block under a floor of its own weight topples at 2 b / h, or at 2 b / 3 h if the floor is pushed as well."""
    width, height = 0.5, 2.0
    weight = 1800.0 * 9.81 * width * height * 0.12
    floor = {"kind": "point", "at": [width / 2, height], "force": [0.0, -weight]}
    sideways = {"kind": "point", "at": [width / 2, height], "force": [weight, 0.0]}
    lateral = {"kind": "lateral"}

    def loaded(live: Any, **dead: Any) -> Scene:
        return courses([[1]], width, height, joint={"friction": 2.0}, load={"gravity": 9.81, "live": live, **dead})

    told = "dead loads at points and along lines have no mass: λ does not push floors that weigh so much"
    alone, both = loaded(lateral, dead=floor), loaded([lateral, sideways], dead=floor)
    for scene, says, exact in ((alone, True, 2 * width / height), (both, False, 2 * width / height / 3)):
        outcome = run_model("limit", scene)
        assert outcome.multiplier == pytest.approx(exact, rel=1e-6)
        assert outcome.message.endswith(told) == says
    assert without_mass(loaded(lateral)) == ""
    assert without_mass(loaded(lateral, dead=sideways)) == ""  # it does not weigh on the wall


def test_floors_that_the_ground_does_not_move_are_told() -> None:
    pulse = {"pulse": {"kind": "sine", "amplitude": 1.0, "period": 0.5}, "quantity": "acceleration"}
    floor = {"kind": "point", "at": [0.25, 2.0], "force": [0.0, -1000.0]}
    joint = {"friction": 2.0, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    for dead in ({}, {"dead": floor}):
        scene = courses([[1]], 0.5, 2.0, joint=joint, load={"gravity": 9.81, "history": pulse, **dead})
        assert ("the ground's motion does not move floors" in without_mass(scene)) == bool(dead)
