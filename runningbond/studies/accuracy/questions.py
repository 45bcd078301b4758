"""Questions that a model answers about a wall, with its defaults or with one parameter changed."""

import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from dem.rigid_system import rigid_system
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.periodic_cell import deformable_cell, rigid_cell
from fem_interface.system import system_of
from homog import rigid_moduli
from runningbond.dynamics import U_CRIT, BlockSystem, Criteria, Run, State, settle
from runningbond.models import MODELS, TOLERANCE
from runningbond.scene import Scene, SceneError, Stiffness
from runningbond.studies.pushover import Pushover, drive

from .walls import TURNED, Question

DRIVEN = 0.05  # displacement of the control point to which a wall is driven, in block sizes
STEPS, RUNS = 2000, 5  # number of time steps in a cost measurement, and of measurements
SETTLED = 1e-3  # relative change of λ at half the speed below which the curve of the turned block has converged
SOFT = 1e10  # stiffness of the turned block's joint [Pa/m]; soft joints allow long steps and barely move its corner


class AnswerRow(NamedTuple):
    """The answer of a model, as columns of the study's table."""

    status: str  # of `runningbond.results.Outcome`, or ``not applicable`` if the model cannot answer
    value: float | None = None  # requested quantity, and its bracket
    lower: float | None = None
    upper: float | None = None
    dofs: int | None = None
    steps: int | None = None
    message: str = ""


def ask(question: Question, model: str, scene: Scene, settings: dict[str, Any]) -> AnswerRow:
    """Answer of a model to a question about a scene, with arguments of the model from `parameters`."""
    try:
        return QUESTIONS[question](model, scene, **settings)
    except SceneError as reason:
        return AnswerRow("not applicable", message=str(reason))


def _collapse(model: str, scene: Scene, tolerance: float = TOLERANCE, **settings: Any) -> AnswerRow:
    if "drive" in settings:  # peak under work-conjugate displacement control; the number of steps sets the speed
        system, distance = _system(model, scene), DRIVEN * scene.block_size
        result = _drive(system, scene, distance, settings["drive"])
        speed = f"largest λ while driven {1e3 * distance:.3g} mm"
        return AnswerRow("collapse", result.peak, None, None, system.freedoms, result.state.steps, speed)
    said = MODELS[model].solve(scene, tolerance, **settings)
    return AnswerRow(said.status, said.multiplier, said.lower, said.upper, said.dofs, said.steps, said.message)


def _drive(system: BlockSystem, scene: Scene, distance: float, steps: int) -> Pushover:
    run, state = Run(system), State.at_rest(system)
    settle(run, state, 0.0, Criteria(collapse=U_CRIT * scene.block_size))
    return drive(run, state, distance, steps)


def _system(model: str, scene: Scene, *, mass_scaling: bool = True, **settings: Any) -> BlockSystem:
    if model != "fem":
        return rigid_system(scene)
    return system_of(modal_wall(scene, **settings), mass_scaling=mass_scaling)


def _turned(model: str, scene: Scene, **settings: Any) -> AnswerRow:
    """λ of one block that has rotated by `TURNED`, from a parabola fitted to its curve around that rotation."""
    scene = scene.with_joint(elasticity=Stiffness(SOFT, SOFT))
    height = scene.lowest_block
    distance = height * np.sin(1.5 * TURNED)
    dofs: int | None
    steps: int | None
    if "drive" in settings:
        system = _system(model, scene)
        pushed = _drive(system, scene, distance, settings["drive"])
        turned, multiplier = pushed.curve[:, 0] / height, pushed.curve[:, 1]
        dofs, steps = system.freedoms, pushed.state.steps
        turned, multiplier = (turned[1:] + turned[:-1]) / 2, multiplier[1:]  # λ is the mean since the previous row
    else:
        said = MODELS[model].solve(scene, SETTLED, displacements="finite", distance=distance)
        # The control point stands above the corner about which the block turns.
        turned, multiplier = np.arcsin(said.curve[:, 0] / height), said.curve[:, 1]
        dofs, steps = said.dofs, said.steps
    near = np.abs(turned - TURNED) < TURNED / 2
    parabola = np.polynomial.Polynomial.fit(turned[near], multiplier[near], 2)
    scatter = f"curve scatters by {float(np.std(multiplier[near] - parabola(turned[near]))):.1e}"
    return AnswerRow("collapse", float(parabola(TURNED)), None, None, dofs, steps, scatter)


def _modulus(which: int, model: str, scene: Scene, cells: int = 1, modes: ModeCount | None = None) -> AnswerRow:
    """A2222 or A1212 of a periodic cell; the energy of a shear E12 is 4 A1212 / 2."""
    if model == "homog":
        moduli = rigid_moduli(scene)
        return AnswerRow("elastic", (moduli.a2222, moduli.a1212)[which - 1])
    result, dofs = deformable_cell(scene, cells, modes) if model == "fem" else rigid_cell(scene)
    return AnswerRow("elastic", float(result[which, which]) / (1, 1, 4)[which], dofs=dofs)


def _physical_second(model: str, scene: Scene, **settings: Any) -> AnswerRow:
    """CPU seconds per simulated second, with the range of the measurements."""
    system = _system(model, scene, **settings)
    run, state = Run(system), State.at_rest(system)
    run.hold(state, 0.2, STEPS)
    costs = []
    for _ in range(RUNS):
        start = time.process_time()
        run.hold(state, 0.2, STEPS)
        costs.append((time.process_time() - start) / (STEPS * run.dt))
    step = f"time step {1e6 * run.dt:.4g} µs"
    return AnswerRow("measured", statistics.median(costs), min(costs), max(costs), system.freedoms, STEPS, step)


QUESTIONS: dict[Question, Callable[..., AnswerRow]] = {
    "collapse": _collapse,
    "turned block": _turned,
    "compression": partial(_modulus, 1),
    "shear": partial(_modulus, 2),
    "physical second": _physical_second,
}
