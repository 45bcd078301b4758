"""The sixteen panels of Baraldi, Reccia & Cecchi, against the numbers recomputed for this project.

The reference multipliers are of rigid blocks by limit analysis, each checked by two independent codes before this
project began; the paper itself prints none. The paper's own columns are printed beside ours by
``runningbond compare`` and not tested against: several of its values exceed a rigorous bound (docs/errata.md).
"""

import math
from typing import Any

import numpy as np
import pytest

from runningbond.compare import published_scene
from runningbond.limit import LimitState, equilibrium, limit, limit_nonassociated, limit_state
from runningbond.limit.search import search
from runningbond.scene import Scene, scene_from_dict
from tests.at_length import at_length
from tests.walls import content

PANELS = [(h, b, a) for h in (0.72, 1.44, 2.88) for b, a in ((0.24, 0.06), (0.12, 0.06), (0.06, 0.06), (0.06, 0.24))]

REFERENCE = {
    "tan φ = 0.6": (0.6000, 0.5004, 0.3098, 0.1865, 0.6000, 0.4352, 0.2873, 0.1392, 0.4273, 0.3597, 0.2776, 0.1179),
    "tan 30°": (0.5774, 0.4934, 0.3031, 0.1825, 0.5774, 0.4279, 0.2820, 0.1371, 0.4263, 0.3572, 0.2735, 0.1168),
    "first course fixed": (
        *(0.6000, 0.5020, 0.3098, 0.1926, 0.6000, 0.4362),
        *(0.2873, 0.1470, 0.4320, 0.3631, 0.2780, 0.1195),
    ),
    "toothed ends": (
        *(0.6000, 0.4668, 0.2923, 0.0960, 0.6000, 0.4148),
        *(0.2775, 0.1345, 0.3731, 0.3426, 0.2731, 0.1155),
    ),
}


VARIANTS: dict[str, dict[str, Any]] = {
    "tan φ = 0.6": {},
    "tan 30°": {"joint__friction": math.tan(math.radians(30))},
    "first course fixed": {"support__kind": "fixed-first-course"},
    "toothed ends": {"wall__ends": "toothed"},
}


def variant(name: str, row: int) -> Scene:
    height, b, a = PANELS[row]
    size = {"wall__height": height, "wall__block_width": b, "wall__block_height": a}
    return scene_from_dict(content(**size, **VARIANTS[name]))


FIRST, *OTHERS = REFERENCE
MOST_BLOCKS = 10  # row of the panel that takes as long as half of the others


@pytest.mark.parametrize(
    ("name", "row"),
    [
        *((FIRST, row) for row in range(12)),
        *((name, row) for name in OTHERS for row in range(12) if row != MOST_BLOCKS),
        *at_length(*((name, MOST_BLOCKS) for name in OTHERS)),
    ],
)
def test_limit_analysis_of_the_twelve_panels(name: str, row: int) -> None:
    """To 5e-4, with forces and mechanism certifying each other."""
    state = limit_state(equilibrium(variant(name, row)))
    assert state.forces.multiplier * state.system.live_unit == pytest.approx(REFERENCE[name][row], abs=5e-4)
    assert max(state.measures.values()) < 1e-7, state.measures


@pytest.mark.parametrize("row", range(12))
def test_shipped_scenes_equal_the_panels(row: int) -> None:
    shipped, built = published_scene(f"panel-{row + 1:02d}"), variant("tan φ = 0.6", row)
    assert (shipped.blocks.vertices == built.blocks.vertices).all()
    assert shipped.joint.friction == 0.6


NONASSOCIATED = {1: (0.6, 0.6), 2: (0.4771, 0.4997), 4: (0.0893, 0.1592), 5: (0.6, 0.6), 6: (0.4197, 0.4339)}
"""Certified intervals by row of the panels in Table 2; each end is proved with the forces below and in tests/limit.

The ends may move apart as the search improves, but not closer together.
"""

SHORT_SEARCH, SHORTER_SEARCH = 300, 110
"""Numbers of linear programs that find these intervals, and for tall panels; the full search takes up to 45 s."""

FULL_SEARCH = NONASSOCIATED | {3: (0.2591, 0.3098), 9: (0.4208, 0.4259), 12: (0.0662, 0.0986)}
"""Intervals found by the full search of `make compare`."""


@pytest.mark.parametrize("row", [4, *at_length(1, 2, 5, 6)])
def test_true_friction_on_small_panels(row: int) -> None:
    outcome = limit_nonassociated(published_scene(f"panel-{row:02d}"), programs=SHORT_SEARCH)
    low, high = NONASSOCIATED[row]
    assert outcome.status == "collapse"
    assert outcome.lower == pytest.approx(low, abs=5e-4)
    assert outcome.upper == pytest.approx(high, abs=5e-4)


def test_mechanism_is_certified_at_both_ends_of_the_interval() -> None:
    """Row 4: equilibrium, Coulomb's law and friction opposite to slip, at the smallest and the largest load."""
    system = equilibrium(published_scene("panel-04"))
    certificates = search(system, limit_state(system).forces, 5).certificates
    assert max(c.most.multiplier for c in certificates) * system.live_unit > 0.13
    assert min(c.least.multiplier for c in certificates) * system.live_unit < 0.09
    for certificate in certificates:
        opening, slip = system.opening.T @ certificate.motion, system.slip.T @ certificate.motion
        largest = abs(certificate.motion).max()
        assert opening.min() > -1e-6 * largest
        for forces in (certificate.least, certificate.most):
            state = LimitState(system, forces)
            assert state.measures["residual"] < 1e-8
            assert state.measures["violation"] < 1e-8
            scale = forces.pressure.max()
            opens, slides = opening > 1e-5 * largest, abs(slip) > 1e-5 * largest
            assert abs(forces.pressure[opens]).max(initial=0.0) < 1e-8 * scale
            at_limit = np.sign(slip) * system.strength.friction * forces.pressure
            assert abs(forces.tangential - at_limit)[slides].max() < 1e-8 * scale


@pytest.mark.parametrize("row", at_length(9, 12))
def test_true_friction_on_tall_panels_lies_inside_the_certified_interval(row: int) -> None:
    """By a short search; the full one finds loads beyond both ends (`FULL_SEARCH`)."""
    low, high = {9: (0.423, 0.4265), 12: (0.066, 0.118)}[row]  # for row 12 up to the associated bound
    outcome = limit_nonassociated(published_scene(f"panel-{row:02d}"), programs=SHORTER_SEARCH)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert low - 5e-4 <= outcome.lower <= outcome.upper <= high + 5e-4


@pytest.mark.long
@pytest.mark.parametrize("row", [*range(1, 13)])
def test_true_friction_is_certified_on_every_panel(row: int) -> None:
    """Below the associated bound, and reaching or passing both ends that were certified before."""
    scene = published_scene(f"panel-{row:02d}")
    outcome = limit_nonassociated(scene)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.upper <= (limit(scene).upper or 0) * (1 + 1e-9)
    low, high = FULL_SEARCH.get(row, (np.inf, -np.inf))
    assert outcome.lower <= low + 5e-4
    assert outcome.upper >= high - 5e-4


@pytest.mark.parametrize(
    ("name", "kilonewtons"),
    [("point-load-4", 260.4), ("point-load-2", 99.3), ("point-load-1", 66.1), ("point-load-quarter", 40.6)],
)
def test_concentrated_loads(name: str, kilonewtons: float) -> None:
    """On pin and roller, to 0.1 kN."""
    state = limit_state(equilibrium(published_scene(name)))
    assert state.forces.multiplier * state.system.live_unit == pytest.approx(1e3 * kilonewtons, abs=100)
    assert max(state.measures.values()) < 1e-7, state.measures


@pytest.mark.parametrize(("b", "a"), [(0.24, 0.06), (0.12, 0.06), (0.06, 0.06), (0.06, 0.24)])
def test_concentrated_loads_lock_between_held_corners(b: float, a: float) -> None:
    """A strut with slope 2 to 1 needs only tan φ = 1/2."""
    scene = scene_from_dict(
        content(
            wall__height=1.44,
            wall__block_width=b,
            wall__block_height=a,
            joint__cohesion=1e5,
            support__kind="pinned-corners",
            load={"gravity": 0.0, "live": {"kind": "point", "at": [0.72, 1.44], "force": [0, -1]}},
        )
    )
    assert limit(scene).status == "unbounded"


def test_concentrated_load_without_cohesion_is_zero() -> None:
    """A dry weightless wall on pin and roller cannot resist the thrust: λ = 0, which is no failure of the solver."""
    scene = published_scene("point-load-4")
    dry = scene.with_joint(cohesion=0.0, tensile_strength=0.0)
    assert limit(dry).multiplier == pytest.approx(0, abs=1e-9)
