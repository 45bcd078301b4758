"""What is kept of a run for ParaView: every load that was borne, then what came after, as they come."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from dem.pushover import State as StaticState
from dem.rigid_system import contact_points
from dem.static_system import StaticSystem
from fem_interface.element_order import modal_wall
from fem_interface.modal_wall import ModalWall
from runningbond.dynamics import Criteria, Run, State
from runningbond.dynamics.run import CALM
from runningbond.joints.softening_kernel import DAMAGE, softening_kernel
from runningbond.limit.kinematics import movable_freedoms
from runningbond.pictures.frame import Frame, Stage, Triangles, mechanism_frame, states_of_points
from runningbond.pictures.painting import DRAWN, wall_size
from runningbond.pictures.series import Series
from runningbond.pictures.vtk_messages import VtkError
from runningbond.results import Outcome
from runningbond.results.mechanism import rigid_jumps
from runningbond.results.store import RECORD
from runningbond.scene import Array, Scene

from .models import IN_MOTION

FALL = 12
"""Most moments of a fall that are kept."""

STEPS_OF_MECHANISM = 8
"""Moments in which a mechanism, where there is nothing else, grows to a size that is seen."""


def recorder(scene: Scene, model: str, folder: Path | None) -> "MotionRecorder | StaticRecorder | None":
    """The observer that writes what a model passes through into a folder; None for models without observers.

    Without a folder it keeps the moments in `Recorder.moments`.
    """
    if model == "dem-static":
        return StaticRecorder(scene, folder)
    return MotionRecorder(scene, model, folder) if model in IN_MOTION else None


class Moments(list[Frame]):
    """Moments in memory, in the order in which they come."""

    add = list[Frame].append


class Recorder:
    """Writes moments. Where one cannot be written that is no reason to give a run up; `finish` says so.

    Parameters
    ----------
    stage
        The wall.
    folder
        Where the series is written; None keeps it in `moments`.
    """

    def __init__(self, stage: Stage, folder: Path | None) -> None:
        self.stage = stage
        self.moments = Moments()
        self._series = self.moments if folder is None else Series(stage, folder)
        self._folder = folder
        self._broken: OSError | VtkError | None = None

    def keep(self, frame: Frame) -> None:
        """Write a moment."""
        if self._broken is None:
            try:
                if self._folder and not len(self._series):  # an outcome that is there is of another run
                    (self._folder / RECORD).unlink(missing_ok=True)
                self._series.add(frame)
            except (OSError, VtkError) as error:
                self._broken = error

    def finish(self, outcome: Outcome) -> None:
        """End the series, once the outcome is known.

        Raises
        ------
        OSError, VtkError
            If a moment could not be written.
        """
        if self._broken is not None:
            raise self._broken
        if not len(self._series):
            self._series.clear()


class StaticRecorder(Recorder):
    """Writes every state of rest that `dem.static` finds."""

    def __init__(self, scene: Scene, folder: Path | None) -> None:
        super().__init__(Stage.of_rigid_blocks(scene), folder)

    def __call__(self, system: StaticSystem, state: StaticState) -> None:
        """Write a state."""
        scene, points, equations = self.stage.scene, self.stage.points, system.equilibrium
        motion = np.zeros(3 * len(scene.blocks))
        motion[movable_freedoms(scene)] = state.x[: system.freedoms] * equations.scale * system.length_unit
        opening, slip = rigid_jumps(scene.blocks, points, motion.reshape(-1, 3))
        normal, tangential = (equations.force_unit * state.force / points.area[:, None]).T
        undamaged = np.zeros(len(points))
        shown = states_of_points(scene, points, opening, normal, tangential, undamaged)
        load = equations.live_unit * state.multiplier
        self.keep(Frame(load, motion.reshape(-1, 3), opening, slip, normal, tangential, shown))


class MotionRecorder(Recorder):
    """Writes every state at rest of blocks in motion, and in the end the fall.

    Parameters
    ----------
    scene
        The wall.
    model
        ``dem-dynamic``, or ``fem`` with the parameters that it has by default.
    folder
        Where the series is written; None keeps it in `moments`.
    """

    def __init__(self, scene: Scene, model: str, folder: Path | None) -> None:
        wall = modal_wall(scene) if model == "fem" else None
        points = contact_points(scene) if wall is None else wall.interface.points
        super().__init__(Stage(scene, points, None if wall is None else _triangles(wall)), folder)
        self._wall = wall
        self._multiplier = np.nan
        self._calm = 0
        self._looks: list[tuple[int, Frame]] = []
        self._stride = 1
        self._fall: tuple[float, list[tuple[int, Frame]]] = (np.nan, [])

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Look at a run: keep the state if it is at rest, or else remember it for a while."""
        if multiplier != self._multiplier:
            self._next_load(multiplier)
        self._calm = self._calm + 1 if run.unbalanced(state) < Criteria.rest else 0
        if self._calm == CALM:
            self.keep(self.frame(run, state, multiplier))
            self._looks = []
        elif not self._looks or state.steps >= self._looks[-1][0] + self._stride:
            self._looks.append((state.steps, self.frame(run, state, multiplier)))
            if len(self._looks) > FALL:
                self._looks = self._looks[::2]
                self._stride = 2 * (self._looks[1][0] - self._looks[0][0])

    def _next_load(self, multiplier: float) -> None:
        if multiplier == 0.0 and len(self._series):  # the search begins anew, more slowly
            self._series.clear()
        if self._looks:
            self._fall = (self._multiplier, self._looks)
        self._multiplier, self._calm, self._looks, self._stride = multiplier, 0, [], 1

    def finish(self, outcome: Outcome) -> None:
        """Write the fall under the load that brought the wall down, and end the series."""
        if self._looks:
            self._fall = (self._multiplier, self._looks)
        if self._fall[0] == outcome.upper:
            for _, frame in self._fall[1]:
                self.keep(frame)
        super().finish(outcome)

    def frame(self, run: Run, state: State, multiplier: float) -> Frame:
        """The moment of a run."""
        stage = self.stage
        opening, slip, normal, tangential = run.tractions(state)
        damage = state.history[DAMAGE].copy() if run.system.law.kernel is softening_kernel else np.zeros(len(opening))
        frame = Frame(
            multiplier,
            run.motion_of_blocks(state),
            opening,
            slip,
            normal,
            tangential,
            states_of_points(stage.scene, stage.points, opening, normal, tangential, damage),
            run.velocity_of_blocks(state),
            damage,
        )
        if self._wall is None:
            return frame
        displacement = self._wall.displacement(state.motion)
        return replace(frame, displacement=displacement, stress=stresses(self._wall, state.motion))


def record_mechanism(scene: Scene, outcome: Outcome, folder: Path) -> None:
    """Write the mechanism of an outcome as it grows; nothing where it has none."""
    frame = mechanism_frame(scene, outcome)
    series = Series(Stage.of_rigid_blocks(scene), folder)
    series.clear()
    if frame is not None:
        series.add(replace(frame.scaled(0.0), state=np.zeros_like(frame.state)))
        for share in np.linspace(0, 1, STEPS_OF_MECHANISM)[1:]:
            series.add(frame.scaled(float(share) * DRAWN * wall_size(scene)))


def _triangles(wall: ModalWall) -> Triangles:
    return Triangles(wall.mesh.points, wall.mesh.triangles, wall.mesh.triangle_block)


def stresses(wall: ModalWall, motion: Array) -> Array:
    """Mean plane stress σ_x, σ_y, τ_xy of each triangle, ``(nt, 3)`` [Pa], after a motion ``(nd,)``."""
    young, poisson = wall.scene.block.young or 0.0, wall.scene.block.poisson
    strain_x, strain_y, shear = wall.strain(motion).T
    plane = young / (1 - poisson**2)
    return np.column_stack(
        [
            plane * (strain_x + poisson * strain_y),
            plane * (strain_y + poisson * strain_x),
            young / (2 * (1 + poisson)) * shear,
        ]
    )
