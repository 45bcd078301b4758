"""Custom joint laws, defined here, run in the models without changes to the package."""

import os
import pickle
import subprocess
import sys
import tracemalloc
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numba.core.errors import TypingError

import runningbond as rb
from dem.dynamic import dem_dynamic
from dem.rigid_system import contact_points, rigid_system
from dem.static import dem_static
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.dynamics import Criteria, Run, State, settle
from runningbond.dynamics.central_differences import step
from runningbond.joints import KernelLaw, Law, PointLaw, PointResponse, joint_stiffness
from runningbond.joints.compiled import kernel
from runningbond.joints.coulomb import COULOMB
from runningbond.joints.interface import INTERFACE
from runningbond.joints.law import (
    COMMON_ROWS,
    CRUSHING,
    DAMPED_WORK,
    OPENING_BEFORE,
    PLASTIC_CLOSURE,
    SLIP_BEFORE,
    Parameters,
)
from runningbond.joints.softening import SOFTENING
from runningbond.joints.trial import constants_of, try_kernel
from runningbond.joints.wall_law import kernel_law
from runningbond.scene import Array, JointMaterial, Scene, SceneError, Stiffness
from tests.walls import courses


@kernel
def springs(
    opening: Array,
    slip: Array,
    parameters: Parameters,
    history: Array,
    viscosity: float,
    normal: Array,
    tangential: Array,
) -> None:
    """σ = k_n δ_n, τ = k_t δ_t, with a dashpot parallel to each spring."""
    segments, constants = parameters
    for segment in range(constants.shape[0]):
        k_n, k_t = constants[segment, 0], constants[segment, 1]
        for i in range(segments[segment], segments[segment + 1]):
            change_n, change_t = opening[i] - history[OPENING_BEFORE, i], slip[i] - history[SLIP_BEFORE, i]
            damped_n, damped_t = viscosity * k_n * change_n, viscosity * k_t * change_t
            history[DAMPED_WORK, i] += damped_n * change_n + damped_t * change_t
            history[OPENING_BEFORE, i], history[SLIP_BEFORE, i] = opening[i], slip[i]
            normal[i], tangential[i] = k_n * opening[i] + damped_n, k_t * slip[i] + damped_t


def constants_of_springs(material: JointMaterial) -> tuple[float, ...]:
    stiffness = joint_stiffness(material)
    return stiffness.normal, stiffness.shear, np.inf


def stored_in_springs(points: KernelLaw, opening: Array, normal: Array, tangential: Array) -> Array:
    stored: Array = normal**2 / (2 * points.normal_stiffness) + tangential**2 / (2 * points.shear_stiffness)
    return stored


SPRINGS = Law("springs", constants_of_springs, springs, COMMON_ROWS, stored_in_springs)
MATERIAL = JointMaterial(0.6, elasticity=Stiffness(1e9, 4e8), law=SPRINGS)
PLASTIC = replace(MATERIAL, law=None)


def tower(**joint: object) -> Scene:
    """Two blocks of 0.24 × 0.12 m, stacked on a base, 0.12 m thick."""
    glue = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8, **joint}
    return courses([[1], [1]], width=0.24, height=0.12, joint=glue)


def test_springs_do_not_fail_and_slip_by_force_over_stiffness() -> None:
    """Under a lateral load of five times the weight G, a joint slips by 5 G / (k_t A) and settles by G / (k_n A)."""
    scene = tower(law=SPRINGS)
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    assert settle(run, state, 5.0, Criteria(collapse=1.0)) == "stable"
    opening, slip, _, _ = run.tractions(state)
    joint = contact_points(scene).joint
    above = np.array([scene.mass[:-1][scene.blocks.centroid[:-1, 1] > y].sum() for y in scene.joints.ends[:, 0, 1]])
    length = scene.joints.length * scene.thickness
    for k, weight in enumerate(9.81 * above):
        assert np.abs(slip[joint == k]) == pytest.approx(5 * weight / (4e8 * length[k]), rel=1e-4)
        assert opening[joint == k].mean() == pytest.approx(-weight / (1e9 * length[k]), rel=1e-4)
    ledger = run.ledger(state)
    assert abs(ledger.residual) < 1e-3 * ledger.external
    assert dem_dynamic(tower()).status == "collapse"


@kernel
def torn(opening: Array, slip: Array, of: Parameters, history: Array, viscosity: float, n: Array, t: Array) -> None:
    """A law that always raises an error."""
    if opening.size:
        raise ArithmeticError("no law beyond this")


def test_laws_share_the_compiled_time_loop() -> None:
    """The time loop, which takes seconds to compile, does not depend on the law: a second law does not recompile it."""
    slips, loops = [], []
    for law in (None, SPRINGS):
        run = Run(rigid_system(tower(law=law)))
        state = State.at_rest(run.system)
        run.hold(state, 5.0, 100)
        slips.append(np.abs(run.tractions(state)[1]).max())
        loops.append(len(step.signatures))
    assert loops[0] == loops[1]
    assert slips[0] > 2 * slips[1]


def test_unpickled_run_uses_kernels_of_its_own_process() -> None:
    """A kernel's address is only valid in the process that compiled it."""
    runs = [Run(rigid_system(tower()))]
    states = [State.at_rest(runs[0].system) for _ in range(2)]
    runs[0].hold(states[0], 0.3, 100)
    runs.append(pickle.loads(pickle.dumps(runs[0])))
    assert (runs[0]._addresses is None, runs[1]._addresses is None) == (False, True)
    runs[1].hold(states[1], 0.3, 100)
    assert (states[0].motion == states[1].motion).all()


def test_strided_arrays_are_refused() -> None:
    """A kernel called by address assumes contiguous arrays."""
    run = Run(rigid_system(tower()))
    state = State.at_rest(run.system)
    state.motion = np.zeros((len(state.motion), 2))[:, 0]
    with pytest.raises(TypingError, match=r"a kernel takes array\(float64, 1d, C\), and no array\(float64, 1d, A\)"):
        run.hold(state, 0.0, 1)


def test_error_raised_by_law_is_propagated() -> None:
    scene = tower(law=Law("torn", constants_of_springs, torn, COMMON_ROWS, stored_in_springs))
    run = Run(rigid_system(scene))
    with pytest.raises(ArithmeticError, match="no law beyond this"):
        run.hold(State.at_rest(run.system), 0.0, 1)


def test_model_names_law_that_it_cannot_use() -> None:
    with pytest.raises(SceneError, match=r'joint\.law: "springs" has no response with a tangent, which dem-static'):
        dem_static(tower(law=SPRINGS))
    with pytest.raises(SceneError, match='"springs" keeps no "plastic slip" in its history'):
        SPRINGS.row("plastic slip")


def test_incompatible_laws_are_named() -> None:
    of_point = np.zeros(1, dtype=np.int64)
    with pytest.raises(SceneError, match=r'joint\.law: .* "Coulomb" and "springs"'):
        kernel_law([PLASTIC, MATERIAL], of_point)
    soft = replace(PLASTIC, fracture_energy_1=1.0, fracture_energy_2=1.0)
    assert kernel_law([PLASTIC, soft], of_point).law == SOFTENING
    assert kernel_law([PLASTIC], of_point).law == COULOMB
    assert kernel_law([replace(soft, law=COULOMB)], of_point).law == COULOMB


def test_invalid_law_is_refused_in_files_and_in_python() -> None:
    with pytest.raises(SceneError, match=r"joint\.law = 'brittle': must be a law of joints"):
        tower(law="brittle")
    with pytest.raises(SceneError, match=r"joint\.law = 'brittle': must be a law of joints"):
        JointMaterial(0.6, law="brittle")


def test_fingerprint_includes_law_and_is_equal_in_every_process() -> None:
    """The fingerprint of an outcome distinguishes laws and is the same in another process."""
    program = """
from runningbond.campaigns.fingerprint import fingerprint
from tests.joints.test_laws import SPRINGS, tower
print(fingerprint(tower(law=SPRINGS), "limit", 0.01))
"""
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    own = fingerprint(tower(law=SPRINGS), "limit", 0.01)
    assert done.stdout.strip() == own
    others = [
        replace(SPRINGS, constants=lambda material: (1.0, 1.0, np.inf)),
        replace(SPRINGS, response=PointLaw),
        replace(SPRINGS, response=Doubled),
        replace(SPRINGS, response=partial(Doubled)),
        replace(SPRINGS, closed=lambda points, pressure: (pressure, pressure)),
        replace(SPRINGS, stiffest=1),
    ]
    assert len({own, *(fingerprint(tower(law=law), "limit", 0.01) for law in (None, *others))}) == 8


class Doubled(PointLaw):
    """A response that differs in one method only."""

    def __call__(self, opening: Array, slip: Array, plastic_slip: Array) -> PointResponse:
        return super().__call__(2 * opening, slip, plastic_slip)


@pytest.mark.parametrize(("row", "crushed"), [((), [0.0, 0.0]), ((CRUSHING,), [0.0, 2e-4])])
def test_overlap_counts_as_crushing_only_in_law_that_crushes(row: tuple[str, ...], crushed: list[float]) -> None:
    """Two points close at an overlap of 0.1 and 0.2 mm; the second one has been crushed, if the law records it."""
    law = replace(SPRINGS, history=(*COMMON_ROWS, PLASTIC_CLOSURE, *row))
    points = KernelLaw(law, np.array([0, 2], dtype=np.uint64), np.array([[1e9, 4e8, np.inf]]))
    history = np.zeros((points.rows, 2))
    history[law.row(PLASTIC_CLOSURE)] = 1e-4, 2e-4
    for name in row:
        history[law.row(name)] = 0.0, 1e-5
    assert points.crushed(history).tolist() == crushed


@kernel
def of_a_fifth_row(
    opening: Array, slip: Array, of: Parameters, history: Array, viscosity: float, n: Array, t: Array
) -> None:
    """Springs that count their evaluations in a row of the history after the common ones."""
    springs(opening, slip, of, history, viscosity, n, t)
    for i in range(opening.size):
        history[4, i] += 1.0


@kernel
def without_numbers(
    opening: Array, slip: Array, of: Parameters, history: Array, viscosity: float, n: Array, t: Array
) -> None:
    """Springs that give no number where joints open."""
    springs(opening, slip, of, history, viscosity, n, t)
    for i in range(opening.size):
        if opening[i] > 1e-5:
            n[i] = np.nan


@kernel
def without_tractions(
    opening: Array, slip: Array, of: Parameters, history: Array, viscosity: float, n: Array, t: Array
) -> None:
    """A kernel that writes nothing."""


@kernel
def springs_of_a_fourth(
    opening: Array, slip: Array, of: Parameters, history: Array, viscosity: float, n: Array, t: Array
) -> None:
    """Springs whose shear stiffness is scaled by a fourth constant."""
    springs(opening, slip, of, history, viscosity, n, t)
    for i in range(slip.size):
        t[i] *= of[1][0, 3]


def four_constants(material: JointMaterial) -> tuple[float, ...]:
    """Those of `springs_of_a_fourth`."""
    return *constants_of_springs(material), 0.5


@kernel
def with_a_mark(
    opening: Array, slip: Array, of: Parameters, history: Array, viscosity: float, n: Array, t: Array
) -> None:
    """Springs that mark points which have never been open by a NaN in a row of their own."""
    springs(opening, slip, of, history, viscosity, n, t)
    for i in range(opening.size):
        if history[4, i] == 0.0 or np.isnan(history[4, i]):
            history[4, i] = opening[i] if opening[i] > 0.0 else np.nan


@pytest.mark.parametrize(("row", "refused"), [("first opening", False), ("plastic slip", True)])
def test_row_that_no_model_reads_may_be_no_number(row: str, refused: bool) -> None:
    law = Law("marks", constants_of_springs, with_a_mark, (*COMMON_ROWS, row), stored_in_springs)
    if refused:
        with pytest.raises(SceneError, match="must write finite tractions and histories"):
            rigid_system(tower(law=law))
    else:
        rigid_system(tower(law=law))
        assert "no longer finite" not in dem_dynamic(tower(law=law)).message


def test_kernel_that_writes_beyond_its_history_is_refused() -> None:
    """It would write over other memory: the process ended with "double free or corruption", or anywhere else."""
    law = Law("counting", constants_of_springs, of_a_fifth_row, COMMON_ROWS, stored_in_springs)
    with pytest.raises(SceneError, match=r'joint\.law: "counting" writes to rows of the history .* it names 4'):
        rigid_system(tower(law=law))
    rigid_system(tower(law=replace(law, history=(*COMMON_ROWS, "evaluations"))))


@pytest.mark.parametrize("changed", [{"history": COMMON_ROWS}, {"kernel": INTERFACE.kernel}])
def test_copy_of_a_law_whose_kernel_writes_beyond_its_history_is_refused(changed: dict[str, object]) -> None:
    """The process ended with "munmap_chunk(): invalid pointer", or with a segmentation fault."""
    with pytest.raises(SceneError, match="writes to rows of the history"):
        rigid_system(tower(law=Law(**{**vars(COULOMB), **changed})))


@pytest.mark.parametrize("given", [{"kernel": springs_of_a_fourth}, {"constants": lambda material: (1e9, 4e8, np.inf)}])
def test_kernel_that_reads_more_constants_than_it_is_given_is_refused(given: dict[str, Any]) -> None:
    """It would read those of the next material, or what lies behind them in memory."""
    rigid_system(tower(law=replace(SPRINGS, name="wrong", kernel=springs_of_a_fourth, constants=four_constants)))
    law = replace(SPRINGS if "kernel" in given else COULOMB, name="wrong", **given)
    with pytest.raises(SceneError, match=r'"wrong" has a kernel that reads more constants than the 3 it is given'):
        rigid_system(tower(law=law))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"kernel": without_tractions}, "must write finite tractions and histories"),
        ({"kernel": springs.py_func}, "needs a kernel compiled with"),
        ({"constants": lambda material: (1e9, 4e8)}, "must have constants k_n, k_t, f_t"),
        ({"constants": lambda material: None}, "must have constants k_n, k_t, f_t"),
        ({"constants": lambda material: (0.0, 4e8, np.inf)}, "must have constants that are numbers, k_n above zero"),
        ({"constants": lambda material: (1e9, np.nan, np.inf)}, "must have constants that are numbers"),
        ({"cone": lambda material: (0.6, 0.0)}, "must have a cone of three numbers, none"),
        ({"cone": lambda material: (np.nan, 0.0, 0.0)}, "must have a cone of three numbers, none"),
        ({"cone": lambda material: (-0.6, 0.0, 0.0)}, "must have a cone of three numbers, none"),
    ],
)
def test_law_that_no_wall_can_rely_on_is_refused(given: dict[str, object], said: str) -> None:
    law = Law(**{**vars(SPRINGS), "name": "wrong", **given})
    with pytest.raises(SceneError, match=rf'joint\.law.*: "wrong" {said}'):
        dem_dynamic(tower(law=law))


def test_wall_that_moves_by_no_number_has_failed() -> None:
    """The motion was NaN up to the end of the budget, and the wall "neither rested nor fell"."""
    law = Law("torn", constants_of_springs, without_numbers, COMMON_ROWS, stored_in_springs)
    outcome = dem_dynamic(tower(law=law))
    assert (outcome.status, outcome.multiplier) == ("failed", None)
    assert "the motion is no longer finite after" in outcome.message


def test_energy_that_is_no_number_is_unaccounted_for() -> None:
    """It passed every check, and the message said: work accounted for to nan of it."""
    law = replace(COULOMB, name="lost", stored=lambda points, opening, normal, tangential: np.nan * opening)
    assert dem_dynamic(tower(law=law)).status == "failed"


class _Responds(PointLaw):
    """Coulomb's points with another response once one of them has slid."""

    def __call__(self, opening: Array, slip: Array, plastic_slip: Array) -> PointResponse:
        found = super().__call__(opening, slip, plastic_slip)
        return self.other(found) if found.plastic_slip.any() else found

    def other(self, found: PointResponse) -> PointResponse:
        return found


class _WithoutSlip(_Responds):
    def other(self, found: PointResponse) -> PointResponse:
        return replace(found, plastic_slip=np.where(found.plastic_slip == 0, 0.0, np.nan))


class _WithoutTangent(_Responds):
    def other(self, found: PointResponse) -> PointResponse:
        return replace(found, tangent=np.nan * found.tangent)


class _OfOnePoint(_Responds):
    def other(self, found: PointResponse) -> PointResponse:
        return replace(found, normal=found.normal[:1])


class _TooStrong(_Responds):
    def other(self, found: PointResponse) -> PointResponse:
        return replace(found, tangential=1.5 * found.tangential)


@pytest.mark.parametrize(
    ("response", "said"),
    [
        (_WithoutSlip, "responds with a plastic slip not all finite"),  # it fell at the first slip, as a collapse
        (_WithoutTangent, "responds with a tangent not all finite"),
        (_OfOnePoint, "must respond with forces and a plastic slip"),
        (_TooStrong, "responds with forces beyond its cone"),  # it collapsed above the bound of limit analysis
    ],
)
def test_response_that_no_wall_can_rely_on_is_refused(response: type[PointLaw], said: str) -> None:
    assert dem_static(tower(law=replace(COULOMB, name="right", response=_Responds))).status == "collapse"
    with pytest.raises(SceneError, match=rf'joint\.law: "wrong" {said}'):
        dem_static(tower(law=replace(COULOMB, name="wrong", response=response)))


class _Stiffens(PointLaw):
    """Coulomb's points whose pressure grows exponentially with their overlap, within a few units of it."""

    def __call__(self, opening: Array, slip: Array, plastic_slip: Array) -> PointResponse:
        found = super().__call__(opening, slip, plastic_slip)
        with np.errstate(over="ignore", invalid="ignore"):
            grown = np.exp(np.maximum(-opening, 0.0) / self.scale)
            normal = np.where(opening < 0, self.normal_stiffness * self.scale * (1 - grown), found.normal)
            most = self.strength.shear + self.strength.friction * (self.strength.tension - normal)
            tried = self.shear_stiffness * (slip - plastic_slip)
            slides, tangent = np.abs(tried) > most, found.tangent.copy()
            tangent[:, 0, 0] *= grown
            tangent[:, 1, 1] = np.where(slides, 0.0, self.shear_stiffness)
            friction = np.where(slides, self.strength.friction, 0.0)
            tangent[:, 1, 0] = -np.sign(tried) * friction * tangent[:, 0, 0]
            held = np.clip(tried, -most, most)
        return PointResponse(normal, held, slip - held / self.shear_stiffness, tangent)

    @property
    def scale(self) -> float:
        return 0.01


def test_law_that_overflows_only_where_no_wall_rests_is_right() -> None:
    """The search for rest tries far larger overlaps than those at rest, and passes over forces that are not finite."""
    wall = rb.read("wall-w2")
    stiffer = wall.with_({"joint.law": replace(COULOMB, name="stiffens", response=_Stiffens)}).run("dem-static")
    assert stiffer.status == "collapse"
    assert stiffer.multiplier == pytest.approx(0.5642, rel=0.01)  # of joints that do not stiffen


def test_trial_of_many_materials_needs_little_memory() -> None:
    """Spare rows of all materials at once took 700 MB for a wall with 10 000 of them."""
    materials = [replace(tower().joint_materials[0], friction=0.6 + 1e-5 * number) for number in range(2000)]
    law = replace(SPRINGS, name="many springs")
    constants = constants_of(law, materials)
    try_kernel(law, constants[:1])
    tracemalloc.start()
    try_kernel(law, constants)
    largest = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert largest < 3e7
