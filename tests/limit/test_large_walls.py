"""Large walls solved by interior point and repair: exact forces and mechanisms, compared with HiGHS's vertex."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import clarabel
import numpy as np
import pytest
from scipy.optimize import linprog

from dem.dynamic import dem_dynamic
from runningbond.compare import published_scene
from runningbond.limit import LimitState, equilibrium, limit, limit_nonassociated, limit_state, proved_bound
from runningbond.limit.associated import is_self_locking, judge
from runningbond.limit.force_program import coulomb, force_program, solve_forces
from runningbond.limit.interior_point import finishing, interior_point
from runningbond.limit.kinematics import dead_load, live_load
from runningbond.limit.proved import CLOSE, STOP, WIDE, is_large, proved, resting_forces
from runningbond.limit.repair import ROUNDING, admissible, balanced
from runningbond.results import check_mechanism, save_outcome
from runningbond.scene import Scene
from tests.checker import check
from tests.walls import panel

SIZE = {"wall__length": 2.88, "wall__height": 1.32}
"""275 blocks."""


def ties(pull: float) -> list[dict[str, Any]]:
    size = {"area": 1e-4, "young": 2e11, "yield": pull}
    return [{"from": [0.03, 1.29], "to": [-1.0, 0.2]} | size, {"from": [0.03, 1.17], "to": [2.85, 1.17]} | size]


def beam(condition: str) -> dict[str, Any]:
    return {"height": 0.2, "condition": condition, "force": [0, -3e3], "drive": {"force": [1, 0]}}


def at(x: float, force: list[float], gravity: float = 9.81) -> dict[str, Any]:
    return {"gravity": gravity, "live": {"kind": "point", "at": [x, 1.32], "force": force}}


SINKS = {"kind": "settlement", "box": [[1.5, -1], [4, 0.01]], "by": [0.0, -0.01]}
COLLAPSES: dict[str, dict[str, Any]] = {
    "dry": {},
    "slides everywhere": {"joint__friction": 0.1},
    "steep": {"joint__friction": 2.0},
    "toothed": {"wall__ends": "toothed"},
    "opening": {"wall__opening": [{"from": [1.2, 0.42], "to": [1.7, 0.9]}], "joint__friction": 1.0},
    "cohesive": {"joint__cohesion": 2e3},
    "cut off": {"joint__cohesion": 1e5, "joint__tensile_strength": 1e3},
    "no friction": {"joint": {"friction": 0.0, "cohesion": 2e3, "tensile_strength": 1e3}},
    "hardly cohesive": {"joint__cohesion": 1e-3},
    "glued": {"joint__cohesion": 1e9},
    "glued for good": {"joint__cohesion": 1e12},
    "light": {"block__density": 1e-3, "joint__cohesion": 1e3},
    "weightless": {"joint__cohesion": 1e5, "support__kind": "corners", "load": at(1.44, [0, -1], 0.0)},
    "wedged": {"support__kind": "pinned-corners"},
    "wedged and cohesive": {"support__kind": "pinned-corners", "joint__cohesion": 1e4},
    "pushed at a corner": {"load": at(0.0, [1, 0])},
    "pulled up": {"load": at(1.44, [0, 1])},
    "tied": {"tie": ties(20.0), "joint__friction": 0.9},
    "tied hard": {"tie": ties(2e4), "joint__friction": 0.9},
    "free beam": {"beam": beam("free")},
    "level beam": {"beam": beam("level")},
    "settling": {"load__live": SINKS},
    "settling and cohesive": {"load__live": SINKS, "joint__cohesion": 500.0},
}


def wall(name: str) -> Scene:
    return panel(**{**SIZE, **COLLAPSES[name]})


@pytest.mark.parametrize("name", COLLAPSES)
def test_repaired_bracket_contains_simplex_multiplier(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The bracket is at most 1e-6 wide, with forces and mechanism admissible to rounding, and HiGHS is not called."""
    scene = wall(name)
    system = equilibrium(scene).under_live_load()
    assert is_large(system)
    state = limit_state(system)
    exact = state.system.load(solve_forces(state.system, coulomb(state.system.strength)).multiplier)

    monkeypatch.setattr("runningbond.limit.associated.solve_forces", fail_if_called)
    outcome = limit(scene)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower - 1e-9 * abs(exact) <= exact <= outcome.upper + 1e-9 * abs(exact)
    assert outcome.upper - outcome.lower <= CLOSE * abs(exact)
    for measure in ("residual", "violation", "penetration"):
        assert state.measures[measure] <= ROUNDING


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"load": at(1.44, [0, -1])}, "unbounded"),
        ({"support__kind": "pinned-corners", "load": at(1.44, [0, -1])}, "unbounded"),
        ({"beam": beam("fixed-height")}, "unbounded"),
        ({"support__kind": "corners"}, "infeasible"),
        ({"wall__opening": [{"from": [0.5, 0.0], "to": [2.4, 0.6]}], "joint__friction": 0.1}, "infeasible"),
    ],
)
def test_verdicts_match_highs(changes: dict[str, Any], status: str) -> None:
    scene = panel(**{**SIZE, **changes})
    assert limit(scene).status == status
    system = equilibrium(scene).under_live_load()
    assert judge(LimitState(system, solve_forces(system, coulomb(system.strength))))[0] == status


def fail_if_called(*_: object, **__: object) -> None:
    pytest.fail("HiGHS was asked")


@pytest.mark.parametrize(
    "changes",
    [
        {"support__kind": "corners"},
        {"wall__opening": [{"from": [0.5, 0.0], "to": [2.4, 0.6]}], "joint__friction": 0.1},
        {"load__gravity": [1.02, -9.81], "joint__friction": 0.1},
        {"load__gravity": [2.5, -9.81], "joint": {"friction": 0.1, "cohesion": 500.0}},
    ],
)
def test_mechanism_proves_fall_of_large_wall_under_dead_load(
    changes: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """HiGHS takes minutes to find that there are no such forces for 2000 blocks, and hours for 10 000."""
    system = equilibrium(panel(**{**SIZE, **changes})).under_live_load()
    assert judge(LimitState(system, solve_forces(system, coulomb(system.strength))))[0] == "infeasible"
    monkeypatch.setattr("runningbond.limit.associated.solve_forces", fail_if_called)
    outcome = limit(system.scene)
    assert outcome.status == "infeasible"
    check = check_mechanism(system.scene, outcome.motion, dead_load(system.scene), live_load(system.scene), 0.0)
    assert check.is_driven
    assert not check.warning


@pytest.mark.parametrize("friction", [0.102, 0.1042])
def test_large_wall_falls_if_gravity_is_inclined_beyond_friction(
    friction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Friction 1.9 % below and 0.2 % above the limit 1.02 / 9.81 = 0.10398."""
    changes = {"load__gravity": [1.02, -9.81], "load__live": {"kind": "lateral"}, "joint__friction": friction}
    monkeypatch.setattr("runningbond.limit.associated.solve_forces", fail_if_called)
    assert limit(panel(**SIZE, **changes)).status == ("infeasible" if friction < 1.02 / 9.81 else "collapse")


def stopped_too_early(monkeypatch: pytest.MonkeyPatch) -> tuple[Scene, float]:
    """A wall whose interior point stops before its bracket is narrow enough, and its exact multiplier."""
    scene = wall("dry")
    exact = limit(scene).multiplier
    assert exact is not None
    monkeypatch.setattr("runningbond.limit.proved.VERY_LARGE", 1)
    monkeypatch.setitem(STOP, WIDE, 1e-2)
    return scene, exact


def test_interior_point_that_stopped_too_early_is_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Very large walls start with a loose tolerance; if that is not enough, a tight one follows, without HiGHS."""
    scene, exact = stopped_too_early(monkeypatch)
    system = equilibrium(scene).under_live_load()
    first = LimitState(system, proved(system, resting_forces(system.under_dead_load())[0]))
    assert first.admissible
    assert not first.sound
    monkeypatch.setattr("runningbond.limit.associated.solve_forces", fail_if_called)
    outcome = limit(scene)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower - 1e-6 <= exact <= outcome.upper + 1e-6
    assert outcome.upper <= outcome.lower * (1 + WIDE)


def test_ctrl_c_in_repeated_interior_point_keeps_first_bracket(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, exact = stopped_too_early(monkeypatch)
    interrupt_at(1, monkeypatch, program=2)
    outcome = limit(scene)
    assert outcome.status == "undecided"
    assert "interrupted" in outcome.message
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert 0.5 * exact < outcome.lower <= exact <= outcome.upper < 1.5 * exact


def test_repair_of_rough_interior_point_is_exact() -> None:
    """From a tolerance of 1e-4 the bracket is wide but contains the exact multiplier."""
    system = equilibrium(wall("dry")).under_live_load()
    exact = solve_forces(system, coulomb(system.strength)).multiplier
    program = force_program(system, coulomb(system.strength))
    point = interior_point(program, 1e-4)
    resting, _ = resting_forces(system.under_dead_load())
    assert resting is not None
    forces, motion = balanced(program, point, resting), admissible(program, point)
    assert forces is not None
    assert motion is not None
    assert np.abs(program["A_eq"] @ forces - program["b_eq"]).max() <= 1e-12 * forces.max()
    assert (forces >= 0).all()
    assert (program["c"] - program["A_eq"].T @ motion)[:-1].min() >= -ROUNDING * np.abs(motion).max()
    upper = -float(program["b_eq"] @ motion / (system.live @ motion))
    assert forces[-1] < exact < upper
    assert upper - forces[-1] < 1e-2 * exact


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_repair_holds_forces_at_their_bounds(tolerance: float) -> None:
    """If a wall slides as a whole, many forces end at their bounds; no resting state is given to interpolate to."""
    system = equilibrium(published_scene("panel-01")).under_live_load()
    forces = coulomb(system.strength)
    program = force_program(system, forces)
    point = interior_point(program, tolerance)
    found = balanced(program, point, None)
    assert found is not None
    low, high = program["bounds"].T
    assert ((low <= found) & (found <= high)).all()
    assert np.abs(program["A_eq"] @ found - program["b_eq"]).max() <= ROUNDING * np.abs(found).max()
    exact = solve_forces(system, forces).multiplier
    assert 0 < exact - found[-1] < 10 * tolerance * exact


def test_repair_returns_none_if_it_fails() -> None:
    """For forces shifted out of their bounds, without a resting state, and for a reversed mechanism."""
    system = equilibrium(wall("dry")).under_live_load()
    program = force_program(system, coulomb(system.strength))
    point = interior_point(program, 1e-9)
    outside = replace(point, forces=point.forces - 1.0)
    assert balanced(program, outside, None) is None
    assert admissible(program, replace(point, motion=-point.motion, slack=np.zeros_like(point.slack))) is None


def test_wall_held_up_by_live_load_has_no_resting_forces() -> None:
    system = equilibrium(panel(**SIZE, support__kind="corners")).under_live_load()
    assert resting_forces(system.under_dead_load())[0] is None
    assert proved(system, None).status != "optimal"


@pytest.fixture(autouse=True)
def _listens_for_ctrl_c() -> Iterator[None]:
    """Listen for Ctrl-C, which may be ignored if the tests run in the background."""
    listener = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, listener)


class Interrupted:
    """Clarabel that raises a signal at its `at`-th iteration."""

    def __init__(self, at: int, how: signal.Signals, *program: Any) -> None:
        self._at, self._how, self._solver = at, how, clarabel.DefaultSolver(*program)

    def set_termination_callback(self, ended: Callable[[Any], bool]) -> None:
        def watched(now: Any) -> bool:
            if now.iterations == self._at:
                signal.raise_signal(self._how)
            return ended(now)

        self._solver.set_termination_callback(watched)

    def solve(self) -> Any:
        return self._solver.solve()


def interrupt_at(
    iteration: int, monkeypatch: pytest.MonkeyPatch, program: int = 1, how: signal.Signals = signal.SIGINT
) -> None:
    """Press Ctrl-C, or send another signal, in a program: number 0 is that of rest, number 1 that of collapse."""
    made = count()
    parts = {name: getattr(clarabel, name) for name in ("DefaultSettings", "ZeroConeT", "NonnegativeConeT")}

    def solver(number: int) -> Callable[..., Any]:
        return partial(Interrupted, iteration, how) if number == program else clarabel.DefaultSolver

    changed = SimpleNamespace(**parts, DefaultSolver=lambda *given: solver(next(made))(*given))
    monkeypatch.setattr("runningbond.limit.interior_point.clarabel", changed)


@pytest.mark.parametrize("iteration", [3, 6, 8])
@pytest.mark.parametrize("name", ["dry", "opening", "tied", "cohesive"])
def test_ctrl_c_keeps_bracket_proved_so_far(
    name: str, iteration: int, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The bracket is wide, contains the multiplier, and is never called a collapse; unproved bounds are None.

    The forces and the mechanism that prove it are kept, and the checker finds both bounds in them.
    """
    scene = wall(name)
    exact = limit(scene).multiplier
    assert exact is not None
    interrupt_at(iteration, monkeypatch)
    outcome = limit(scene)
    assert outcome.status == "undecided"
    assert "interrupted" in outcome.message
    assert outcome.lower is not None
    assert 0 <= outcome.lower <= exact
    assert outcome.upper is None or outcome.upper > exact - 1e-9
    assert outcome.multiplier is None
    save_outcome(outcome, tmp_path, scene=scene)
    assert check(tmp_path)
    assert (len(outcome.force) > 0) == (len(outcome.motion) > 0) == (outcome.upper is not None)
    if iteration == 8:
        assert outcome.upper is not None
        save_outcome(replace(outcome, upper=1.001 * outcome.upper), tmp_path, scene=scene)
        assert not check(tmp_path)
        assert outcome.upper - outcome.lower < 0.5 * exact


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_during_proof_keeps_proof(how: signal.Signals, monkeypatch: pytest.MonkeyPatch) -> None:
    """A proof takes seconds after minutes of solving, all of which were lost; the previous handler is still called."""
    scene, heard = wall("dry"), []
    exact = limit(scene).multiplier

    def interrupted(*given: Any) -> Any:
        signal.raise_signal(how)
        return admissible(*given)

    def listen(number: int, frame: object) -> None:
        heard.append(number)
        raise KeyboardInterrupt

    monkeypatch.setattr("runningbond.limit.proved.admissible", interrupted)
    before = signal.signal(how, listen)
    try:
        outcome = limit(scene)
        assert signal.getsignal(how) is listen
    finally:
        signal.signal(how, before)
    assert heard == [how]
    assert outcome.status == "undecided"
    assert "interrupted" in outcome.message
    assert (outcome.lower, outcome.upper) == pytest.approx((exact, exact), rel=1e-6)


@pytest.mark.parametrize("lets_go", [True, False])
def test_second_ctrl_c_during_proof_ends_it(lets_go: bool) -> None:
    """If the handler hands the second one over to the system (`lets_go`), it is not installed again afterwards."""

    def listen(number: int, frame: object) -> None:
        if lets_go:
            signal.signal(number, signal.SIG_IGN)  # in place of the default, which would end the tests
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, listen)
    with nullcontext() if lets_go else pytest.raises(KeyboardInterrupt), finishing() as received:
        signal.raise_signal(signal.SIGINT)
        assert received == [signal.SIGINT]
        signal.raise_signal(signal.SIGINT)
    assert len(received) == (1 if lets_go else 2)
    assert signal.getsignal(signal.SIGINT) is (signal.SIG_IGN if lets_go else listen)


def test_ctrl_c_keeps_associated_bound_of_limit_nonassociated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Interrupted in the associated program, and in the program after it, that of a single start."""
    scene, after = wall("dry"), [8, 4]
    exact = limit(scene).multiplier
    assert exact is not None
    monkeypatch.setattr("runningbond.limit.large.LARGE_POINTS", 0)
    for number, iteration in enumerate(after, start=1):
        with monkeypatch.context() as patch:
            interrupt_at(iteration, patch, program=number)
            outcome = limit_nonassociated(scene)
        assert (outcome.status, outcome.lower, outcome.multiplier) == ("undecided", None, None)
        assert outcome.upper is not None
        assert exact - 1e-9 <= outcome.upper < 1.5 * exact
        assert "interrupted" in outcome.message


def test_ctrl_c_before_any_proof_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    """While forces at rest are searched for; the handler is restored afterwards."""
    interrupt_at(2, monkeypatch, program=0)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        limit(wall("dry"))
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_does_not_wait_for_highs(monkeypatch: pytest.MonkeyPatch) -> None:
    """HiGHS neither holds Python's lock nor checks for signals while it solves: it is abandoned in a thread."""
    solver, left = threading.Event(), threading.Event()

    def endless(**_: Any) -> None:
        assert threading.current_thread() is not threading.main_thread()
        signal.raise_signal(signal.SIGINT)
        solver.wait()
        left.set()

    system = equilibrium(wall("dry")).under_live_load()
    monkeypatch.setattr("runningbond.limit.force_program.linprog", endless)
    with pytest.raises(KeyboardInterrupt):
        solve_forces(system, coulomb(system.strength))
    assert not left.is_set()
    solver.set()


def test_ctrl_c_in_limit_bound_ends_dynamic_model(monkeypatch: pytest.MonkeyPatch) -> None:
    """`limit` returns what it has proved, but a model that only needs its bound is to stop."""
    scene = panel(**SIZE, joint={"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 5e9})
    exact = limit(scene).upper
    assert exact is not None
    assert exact <= (proved_bound(scene) or 0.0) <= exact * (1 + 1.1e-8)
    interrupt_at(6, monkeypatch)
    outcome = dem_dynamic(scene)
    assert (outcome.status, outcome.steps) == ("undecided", 0)
    assert outcome.message.startswith("interrupted before")


def test_program_that_runs_out_of_iterations_is_not_taken_for_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """If that happens to the interior point, the simplex method solves the program."""
    bound = proved_bound(panel())

    def limited(**program: Any) -> Any:
        return linprog(**program, options={"maxiter": 0} if program["method"] == "highs-ipm" else {})

    monkeypatch.setattr("runningbond.limit.force_program.linprog", limited)
    assert limit(panel()).status == "collapse"
    assert proved_bound(panel()) == bound


@pytest.mark.parametrize("name", ["dry", "cohesive", "pulled up"])
def test_proved_bound_excludes_self_locking(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without HiGHS, which needs minutes to find that there are no such forces for 1000 blocks."""
    monkeypatch.setattr("runningbond.limit.associated.solve_forces", None)
    assert not is_self_locking(wall(name))


def test_interrupted_bound_of_cut_strengths_is_discarded(monkeypatch: pytest.MonkeyPatch) -> None:
    interrupt_at(6, monkeypatch)
    outcome = limit(wall("glued for good"))
    assert (outcome.status, outcome.lower, outcome.upper) == ("undecided", 0.0, None)
