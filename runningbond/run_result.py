"""Result of a run of a wall: the outcome with its tables, its picture and the states along the load path."""

from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from .joints import listed_points, wall_points
from .likely_slips import warn_of_likely_slips
from .models import Model, check_parameters, find_model, run_model
from .path_states import PathState, collected
from .pictures.captions import to_png, to_svg
from .pictures.curve import curve_figure, draw_curve
from .pictures.flat import draw_mechanism, figure_of
from .results import Outcome, Status
from .results.mechanism import rigid_jumps
from .results.outcome import number
from .scene import Array, SceneError
from .tables import Table, table
from .wall import Wall

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class Result:
    """Result of a model for a wall.

    Parameters
    ----------
    wall
        The wall.
    outcome
        The outcome, which documents its scalars; they are attributes of the result as well.
    states
        The states along the load path; None if they were not collected.
    """

    model: str
    status: Status
    multiplier: float | None
    lower: float | None
    upper: float | None
    dofs: int | None
    steps: int | None
    seconds: float
    message: str
    motion: Array

    def __init__(self, wall: Wall, outcome: Outcome, states: list[PathState] | None = None) -> None:
        self.wall = wall
        self.outcome = outcome
        self._states = states

    def __getattr__(self, name: str) -> Any:
        if name in Result.__annotations__:
            return getattr(self.outcome, name)
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __dir__(self) -> list[str]:
        return sorted({*super().__dir__(), *Result.__annotations__})

    @property
    def states(self) -> list[PathState]:
        """States at rest in the order in which they were found, then the fall; empty for a model without a path."""
        if self._states is None:
            raise ValueError(f"states were not collected; ask for them: wall.run({self.model!r}, states=True)")
        return self._states

    @cached_property
    def curve(self) -> Table:
        """Pushover curve: ``displacement`` of the control point along the live load [m], ``multiplier``, and more.

        The other columns, named in ``outcome.path_columns``, are the reactions of every support and the work of the
        loads. For a model that computes only the forces at collapse the table has one row.
        """
        return table(self.outcome.curve_columns())

    @cached_property
    def blocks(self) -> Table:
        """Blocks, with the ground last.

        ``x``, ``y`` of the centroid [m], ``area`` [m²], ``mass`` [kg], ``fixed``, and ``u``, ``v`` [m], ``rotation``
        [rad] of the mechanism, scaled to 1 m at its fastest corner; NaN without a mechanism.
        """
        scene = self.wall.scene
        (x, y), (u, v, rotation) = scene.blocks.centroid.T, self._mechanism().T
        size = {"x": x, "y": y, "area": scene.blocks.area, "mass": scene.mass, "fixed": scene.fixed}
        return table({**size, "u": u, "v": v, "rotation": rotation})

    @cached_property
    def joints(self) -> Table:
        """Joint points: two per joint, or all points along joints if any joint softens, crushes or closes.

        ``joint``, blocks ``a`` and ``b``, ``x``, ``y`` [m], ``area`` [m²], ``normal_force`` and ``shear_force`` [N],
        tension positive, at finite displacements along the side that bears (`PathState.force`), and ``opening`` and
        ``slip`` [m] of the mechanism, or in the deformed shape of a wall that has moved far (`Outcome.moved`). NaN
        where the model gives no value.
        """
        scene = self.wall.scene
        force = self.outcome.force
        points = listed_points(scene, len(force)) or wall_points(scene)
        if len(force) != len(points):
            force = np.full((len(points), 2), np.nan)
        opening, slip = rigid_jumps(scene.blocks, points, self._mechanism(), self.outcome.moved)
        (a, b), (x, y) = points.block.T, points.position.T
        place = {"joint": points.joint, "a": a, "b": b, "x": x, "y": y, "area": points.area}
        forces = {"normal_force": force[:, 0], "shear_force": force[:, 1]}
        return table({**place, **forces, "opening": opening, "slip": slip})

    def plot(self, what: Literal["mechanism", "curve"] | None = None, axes: "Axes | None" = None) -> "Axes":
        """Draw the mechanism or the curve into axes; by default the mechanism if there is one.

        Without axes a new figure is made, which pyplot shows.
        """
        if what not in (None, "mechanism", "curve"):
            raise SceneError("what", "must be mechanism or curve", what)
        if what == "curve" and not len(self.outcome.curve):
            raise SceneError("what", f"must be mechanism: {self.model} has no curve here", what)
        is_curve = what == "curve" or (what is None and not len(self.motion) and len(self.outcome.curve))
        if axes is None:
            from matplotlib.pyplot import figure

            make_figure = curve_figure if is_curve else figure_of
            return make_figure(self.wall.scene, self.outcome, make=figure).axes[0]
        draw = draw_curve if is_curve else draw_mechanism
        draw(axes, self.wall.scene, self.outcome)
        return axes

    def _mechanism(self) -> Array:
        shape = (len(self.wall.scene.blocks), 3)
        return self.motion if self.motion.shape == shape else np.full(shape, np.nan)

    def __repr__(self) -> str:
        names = {"λ": self.multiplier, "lower": self.lower, "upper": self.upper}
        bracket = ", ".join(f"{name} {number(value)}" for name, value in names.items() if value is not None)
        return f"<Result of {self.model} on {self.outcome.scene!r}: {self.status}{': ' + bracket if bracket else ''}>"

    def _repr_svg_(self) -> str:
        return to_svg(figure_of(self.wall.scene, self.outcome)).decode()

    def _repr_png_(self) -> bytes:
        return to_png(figure_of(self.wall.scene, self.outcome))


def run_wall(wall: Wall, model: str | Model, tolerance: float, states: bool, parameters: dict[str, Any]) -> Result:
    """Run a model on a wall, as documented in `Wall.run`."""
    model = find_model(model)
    check_parameters(model, parameters)  # some may have the names of parameters of `run_model`
    warn_of_likely_slips([wall.scene])
    recorder = model.observer(wall.scene, None) if states and model.observer else None
    outcome = run_model(model, wall.scene, tolerance, recorder, **parameters)
    if recorder is None:
        return Result(wall, outcome, [] if states else None)
    recorder.finish(outcome)
    return Result(wall, outcome, collected(recorder))
