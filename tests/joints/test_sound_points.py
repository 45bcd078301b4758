"""Vectorized joint points of full strength give bitwise the results of the general loop."""

import numpy as np
import pytest

from runningbond.joints.interface import BATCH, HISTORY, any_points, interface_constants, interface_kernel
from runningbond.joints.sound_points import are_sound, can_be_sound, sound_points
from runningbond.scene import Closure, JointMaterial, Stiffness

N = 200
ROWS = (np.uint64(0), np.uint64(N))
VISCOSITY = 0.1
DAMAGE, SLIPPED, CRUSHED = (HISTORY.index(name) for name in ("damage", "slipped", "crushed"))


def glued(**changes: object) -> JointMaterial:
    """A joint of 1 MPa tensile strength that softens exponentially and crushes at 5 MPa."""
    given: dict[str, object] = {
        "cohesion": 1.4e6,
        "tensile_strength": 1e6,
        "elasticity": Stiffness(1e11, 4e10),
        "fracture_energy_1": 80.0,
        "fracture_energy_2": 200.0,
        "softening": "exponential",
        "compressive_strength": 5e6,
    }
    return JointMaterial(0.6, **(given | changes))  # type: ignore[arg-type]


MATERIALS = {
    "softens and crushes": glued(),
    "hardens": glued(peak_closure=1e-5),
    "never crushes": glued(compressive_strength=None),
    "straight branches": glued(softening="linear"),
    "plastic": glued(softening="linear", fracture_energy_1=None, fracture_energy_2=None),
    "no tension": glued(tensile_strength=0.0),
}


@pytest.mark.parametrize("viscosity", [0.0, 0.1])
@pytest.mark.parametrize("name", MATERIALS)
def test_sound_points_equal_general_loop_bitwise(name: str, viscosity: float) -> None:
    """Rows of few points under random jumps up to their strength, and sometimes beyond, step by step.

    They start with a plastic closure and a plastic slip; accumulated slip that costs no strength may be ignored.
    """
    rng, of = np.random.default_rng(1), np.array(interface_constants(MATERIALS[name]))
    assert can_be_sound(of)
    fast = np.zeros((len(HISTORY), N))
    fast[HISTORY.index("plastic closure")] = 1e-6 * rng.random(N)
    fast[HISTORY.index("plastic slip")] = 2e-6 * rng.normal(size=N)
    if name == "plastic":
        fast[SLIPPED] = 1e-5 * rng.random(N)
    slow, opening, slip, sound = fast.copy(), np.zeros(N), np.zeros(N), []
    for step in range(60):
        reach = 0.3 + 0.9 * step / 60
        opening = 1e-5 * reach * rng.uniform(-3.0, 0.7 if MATERIALS[name].tension > 0 else -0.1, N)
        slip = 2.6e-5 * reach * rng.uniform(-1.0, 1.0, N)
        (n, t), (n_slow, t_slow) = np.zeros((2, 2, N))
        for first in range(0, N, 4):
            rows = np.uint64(first), np.uint64(first + 4)
            sound.append(are_sound(rows, of, opening, slip, fast, viscosity))
            bring = sound_points if sound[-1] else any_points
            bring(rows, of, opening, slip, fast, viscosity, n, t)
            any_points(rows, of, opening, slip, slow, viscosity, n_slow, t_slow)
        assert np.array_equal(n, n_slow)
        assert np.array_equal(t, t_slow)
        assert np.array_equal(fast, slow)
    assert 0.1 < np.mean(sound) < 1.0


def test_interface_kernel_equals_general_loop_bitwise() -> None:
    """A few rows of many are loaded beyond their strength, the others below it: the whole law against one loop."""
    rng, of = np.random.default_rng(2), np.array(interface_constants(glued(peak_closure=1e-5)))
    count = 10 * int(BATCH)
    rows, segments = (np.uint64(0), np.uint64(count)), np.array([0, count], dtype=np.uint64)
    fast, slow = np.zeros((2, len(HISTORY), count))
    reach = np.where(np.arange(count) < 3 * int(BATCH), 4.0, 0.4)
    for _ in range(40):
        opening, slip = 1e-5 * reach * rng.uniform(-1, 1, (2, count))
        (n, t), (n_slow, t_slow) = np.zeros((2, 2, count))
        interface_kernel(opening, slip, (segments, of[None]), fast, VISCOSITY, n, t)
        any_points(rows, of, opening, slip, slow, VISCOSITY, n_slow, t_slow)
        assert np.array_equal(n, n_slow)
        assert np.array_equal(t, t_slow)
        assert np.array_equal(fast, slow)
    assert (fast[DAMAGE] > 0).any()
    assert (fast[CRUSHED] > 0).any()
    assert not fast[DAMAGE, 3 * int(BATCH) :].any()


@pytest.mark.parametrize(
    ("row", "value"), [(DAMAGE, 1e-9), (SLIPPED, 1e-9), (CRUSHED, 1e-12)], ids=["damaged", "slipped", "crushed"]
)
def test_points_that_have_lost_strength_are_not_sound(row: int, value: float) -> None:
    of, history, still = np.array(interface_constants(glued())), np.zeros((len(HISTORY), N)), np.zeros(N)
    assert are_sound(ROWS, of, still, still, history, VISCOSITY)
    history[row, 17] = value
    assert not are_sound(ROWS, of, still, still, history, VISCOSITY)


@pytest.mark.parametrize(
    ("opening", "slip"),
    [(1.01e-5, 0.0), (-5.01e-5, 0.0), (0.0, 3.6e-5), (-3e-5, 3.5e-5), (np.nan, 0.0), (0.0, np.nan)],
    ids=["torn", "crushed", "slid", "in the corner", "no number", "no slip"],
)
def test_points_that_reach_their_strength_are_not_sound(opening: float, slip: float) -> None:
    """1 MPa in tension, 1.4 MPa in shear, 5 MPa in compression at 1e11 and 4e10 Pa/m; without viscosity."""
    of, history = np.array(interface_constants(glued())), np.zeros((len(HISTORY), N))
    jumps = np.zeros((2, N))
    jumps[:, 17] = 0.98 * opening, 0.9 * slip
    assert are_sound(ROWS, of, *jumps, history, 0.0) == np.isfinite(jumps).all()
    jumps[:, 17] = opening, slip
    assert not are_sound(ROWS, of, *jumps, history, 0.0)


def test_dry_and_closing_joints_cannot_be_sound() -> None:
    dry = glued(cohesion=0.0, tensile_strength=0.0)
    for material in (dry, glued(closure=Closure(1e4, 1e12))):
        assert not can_be_sound(np.array(interface_constants(material)))
