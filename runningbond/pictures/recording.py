"""Observers that record a run for ParaView as it proceeds: every load that was carried, then the fall."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from dem.lead import reaction
from dem.load_path import LoadPath, StaticState
from dem.rigid_system import contact_points
from fem_interface.modal_wall import ModalWall
from runningbond.dynamics import Criteria, Run, State
from runningbond.dynamics.collapse import CALM
from runningbond.pictures.frame import Discretisation, Frame, Triangles
from runningbond.pictures.joint_state import states_under_load
from runningbond.pictures.mechanism import mechanism_frame
from runningbond.pictures.style import DRAWN
from runningbond.pictures.time_series import MAX_FRAMES, TimeSeries
from runningbond.pictures.vtk_safety import VtkError
from runningbond.results import Outcome
from runningbond.results.mechanism import carried, rigid_jumps, rotated, turned, turned_frames
from runningbond.results.reactions import AT_REST
from runningbond.results.store import RECORD, RESPONSE_RECORD
from runningbond.scene import Array, Scene

FALL_FRAMES = 12
"""Largest number of recorded moments of a fall."""

RESPONSE_FRAMES = 30
"""Number of recorded moments of a ground motion, in addition to those of the free motion after it."""

MECHANISM_FRAMES = 8
"""Number of frames in which a mechanism grows to a visible size, if there is no run to record."""


class FrameList(list[Frame]):
    """A time series in memory."""

    add = list[Frame].append


class SeriesRecorder:
    """Writes moments of a wall into a folder, or keeps them in `frames` if no folder is given.

    A moment that cannot be written does not end the run; see `finish`.
    """

    def __init__(self, discretisation: Discretisation, folder: Path | None) -> None:
        self._folder = folder
        self._error: OSError | VtkError | None = None
        self._is_begun = False
        self._begin(discretisation)

    def _begin(self, discretisation: Discretisation) -> None:
        """Begin a series for a discretised wall."""
        self.discretisation = discretisation
        self.frames = FrameList()
        self._series = self.frames if self._folder is None else TimeSeries(discretisation, self._folder)

    def keep(self, frame: Frame) -> None:
        """Write a moment."""
        if self._error is None:
            try:
                if self._folder and not self._is_begun:  # an existing outcome is of another run
                    for name in (RECORD, RESPONSE_RECORD):
                        (self._folder / name).unlink(missing_ok=True)
                self._is_begun = True
                self._series.add(frame)
            except (OSError, VtkError) as error:
                self._error = error

    def finish(self, outcome: Outcome) -> None:
        """End the series once the outcome is known; raise the error of a moment that could not be written."""
        if self._error is not None:
            raise self._error
        if not len(self._series):
            self._series.clear()
        elif isinstance(self._series, TimeSeries):
            self._series.write_macro()


class StaticRecorder(SeriesRecorder):
    """Writes every equilibrium that `dem.static` finds."""

    def __init__(self, scene: Scene, folder: Path | None) -> None:
        super().__init__(Discretisation.of_rigid_blocks(scene), folder)

    def __call__(self, path: LoadPath, state: StaticState) -> None:
        """Write a state; if a path starts again, so does the series."""
        if state is path.rests[0] and len(self._series):
            self._series.clear()
        scene, points, system = self.discretisation.scene, self.discretisation.points, path.system
        equations, motion = system.equilibrium, system.motion(state.x)
        opening, slip = rigid_jumps(scene.blocks, points, motion)
        normal, tangential = (equations.force_unit * state.force / points.area[:, None]).T
        kinds = states_under_load(scene, points, opening, normal, tangential, np.zeros(len(points)))
        self.keep(Frame(reaction(system, state), motion, opening, slip, normal, tangential, kinds))

    def finish(self, outcome: Outcome) -> None:
        """End the series; for a wall without any equilibrium, write the mechanism by which it falls."""
        super().finish(outcome)
        if self._folder is not None and not len(self._series):
            record_mechanism(self.discretisation.scene, outcome, self._folder)


class MotionRecorder(SeriesRecorder):
    """Writes every state at rest of blocks in motion, or every state on a prescribed path, and at the end the fall.

    Blocks and joint points are those of the observed run, whatever its mesh.
    """

    def __init__(self, scene: Scene, folder: Path | None) -> None:
        super().__init__(Discretisation(scene, contact_points(scene)), folder)
        self._wall: ModalWall | None = None
        self._multiplier = np.nan
        self._calm = 0
        self._moments: list[tuple[int, Frame]] = []
        self._stride = 1
        self._fall: tuple[float, list[tuple[int, Frame]]] = (np.nan, [])
        self._led = math.inf  # steps at the last call, for prescribed displacements

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Write a state at rest or on a prescribed path; otherwise keep it temporarily as part of a possible fall."""
        self._turn_to(run.system.source)
        if run.is_driven:
            if state.steps < self._led:  # first state of a path, at rest under dead load; each slower path restarts
                self._series.clear()
            self._led = state.steps
        elif multiplier != self._multiplier:
            self._next_load(multiplier)
        self._calm = self._calm + 1 if run.unbalanced(state) < Criteria.rest else 0
        if run.is_driven or self._calm == CALM:
            self.keep(self._frame(run, state, multiplier))
            self._moments = []
        elif not self._moments or state.steps >= self._moments[-1][0] + self._stride:
            self._moments.append((state.steps, self._frame(run, state, multiplier)))
            if len(self._moments) > FALL_FRAMES:
                self._moments = self._moments[::2]
                self._stride = 2 * (self._moments[1][0] - self._moments[0][0])

    def _turn_to(self, wall: object) -> None:
        """Switch to the mesh of a run if it differs; pieces of blocks that may crack are separate blocks there."""
        if not isinstance(wall, ModalWall) or wall is self._wall:
            return
        self._wall = wall
        triangles = Triangles(wall.mesh.points, wall.mesh.triangles, wall.mesh.triangle_block)
        self._begin(Discretisation(wall.scene, wall.elements.points, triangles))

    def _next_load(self, multiplier: float) -> None:
        if multiplier == 0.0 and len(self._series):  # the search restarts with slower loading
            self._series.clear()
        if self._moments:
            self._fall = (self._multiplier, self._moments)
        self._multiplier, self._calm, self._moments, self._stride = multiplier, 0, [], 1

    def finish(self, outcome: Outcome) -> None:
        """Write the fall under the load that brought the wall down, and end the series."""
        if self._moments:
            self._fall = (self._multiplier, self._moments)
        self._is_begun = True  # from now on an existing outcome is of this run
        if self._fall[0] == self._load_of_fall(outcome):
            for _, frame in self._fall[1]:
                self.keep(frame)
        super().finish(outcome)

    def _load_of_fall(self, outcome: Outcome) -> float | None:
        """Load under which the wall fell: the last one of the curve, because breaking joints extend the bracket beyond.

        It is 0 if the dead load alone brings the wall down, and None if the wall did not fall.
        """
        if outcome.status == "infeasible":
            return 0.0
        rests = outcome.curve_columns().get(AT_REST, np.ones(0))
        return float(outcome.curve[-1, 1]) if len(rests) and rests[-1] == 0 else None

    def _frame(self, run: Run, state: State, multiplier: float) -> Frame:
        """Frame of the current state of a run."""
        wall = self.discretisation
        opening, slip, normal_force, tangential_force, damage, closure = run.at_joints(state)
        normal, tangential = np.array([normal_force, tangential_force]) / wall.points.area
        kinds = states_under_load(wall.scene, wall.points, opening, normal, tangential, damage, closure)
        # Motions are those of bodies, not of whole blocks: if blocks may crack, each piece is a block here.
        motion, velocity = run.system.motion_of_bodies(state.motion), run.system.motion_of_bodies(state.velocity)
        finite = run.system.contacts is not None
        displacement, traction, stress = np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 3))
        sides = np.zeros((0, 0, 2))
        if self._wall is not None:
            displacement, stress = self._wall.displacement(state.motion), stresses(self._wall, state.motion)
            displacement = self._far_displacement(self._wall, displacement, motion) if finite else displacement
            sides = self._wall.elements.sides(displacement)
        if finite:
            opening, slip = self._far_jumps(sides, motion)
            traction = run.pulls_at_joints(state).T / wall.points.area[:, None]
        return Frame(
            multiplier,
            motion,
            opening,
            slip,
            normal,
            tangential,
            kinds,
            velocity,
            damage,
            displacement,
            sides,
            stress,
            traction=traction,
            new_contacts=run.new_contacts(state),
            finite=finite,
        )

    @staticmethod
    def _far_displacement(wall: ModalWall, displacement: Array, motion: Array) -> Array:
        """Nodal displacements ``(nn, 2)`` [m] at finite displacements; deformations rotate with their blocks."""
        blocks, block, at = wall.scene.blocks, wall.mesh.block, wall.mesh.points
        own = displacement - carried(blocks, block, at, motion)
        return turned(blocks, block, at, motion) + rotated(own, motion[block, 2])

    def _far_jumps(self, sides: Array, motion: Array) -> tuple[Array, Array]:
        """Opening and slip ``(np,)`` [m] at finite displacements, between the `sides` of deformable blocks.

        The jumps of the joint law cannot be used: they refer to the sides in contact and are missing if these parted.
        """
        scene, points = self.discretisation.scene, self.discretisation.points
        if len(sides):
            a, b = sides
        else:
            a, b = (turned(scene.blocks, side, points.position, motion) for side in points.block.T)
        normal, tangent = turned_frames(points, motion)
        return ((b - a) * normal).sum(axis=1), ((b - a) * tangent).sum(axis=1)


class ResponseRecorder(MotionRecorder):
    """Keeps evenly spaced moments of a wall under a ground motion, and at the end writes those at the upper scale."""

    def __init__(self, scene: Scene, folder: Path | None) -> None:
        super().__init__(scene, folder)
        self._duration = scene.history.duration if scene.history else 0.0
        self._start = self._now = self._next = self._spacing = 0.0

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Keep a moment if it is due."""
        self._turn_to(run.system.source)
        if multiplier != self._multiplier or state.time < self._now:  # another motion
            self._multiplier, self._moments, self._spacing = multiplier, [], self._duration / RESPONSE_FRAMES
            self._start = self._next = state.time
        self._now = state.time
        if state.time >= self._next:
            frame = replace(self._frame(run, state, multiplier), time=state.time - self._start)
            self._moments.append((state.steps, frame))
            if len(self._moments) > MAX_FRAMES:
                self._moments, self._spacing = self._moments[::2], 2 * self._spacing
            self._next = state.time + self._spacing

    def _load_of_fall(self, outcome: Outcome) -> float | None:
        """The upper scale, because the curve contains all scales that were tried."""
        return outcome.upper


def motion_recorder(scene: Scene, folder: Path | None) -> MotionRecorder:
    """Recorder of a run: of the upper scale under a ground motion, else of the carried loads and the fall."""
    return (ResponseRecorder if scene.history else MotionRecorder)(scene, folder)


def record_mechanism(scene: Scene, outcome: Outcome, folder: Path) -> None:
    """Write the mechanism of an outcome as a series in which it grows; nothing if there is none."""
    frame = mechanism_frame(scene, outcome)
    series = TimeSeries(Discretisation.of_rigid_blocks(scene), folder)
    series.clear()
    if frame is not None:
        series.add(replace(frame.scaled(0.0), state=np.zeros_like(frame.state)))
        for share in np.linspace(0, 1, MECHANISM_FRAMES)[1:]:
            series.add(frame.scaled(float(share) * DRAWN * scene.size))
        series.write_macro()


def stresses(wall: ModalWall, motion: Array) -> Array:
    """Mean plane stress σ_x, σ_y, τ_xy of each triangle, ``(nt, 3)`` [Pa], after a motion ``(nd,)``."""
    materials = [(material.young or 0.0, material.poisson) for material in wall.scene.block_materials]
    young, poisson = np.array(materials)[wall.scene.material_of_block[wall.mesh.triangle_block]].T
    strain_x, strain_y, shear = wall.strain(motion).T
    plane = young / (1 - poisson**2)
    normal = (plane * (strain_x + poisson * strain_y), plane * (strain_y + poisson * strain_x))
    return np.column_stack([*normal, young / (2 * (1 + poisson)) * shear])
