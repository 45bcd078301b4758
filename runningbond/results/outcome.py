"""The outcome of one model on one scene: a bracket and a status, never a bare number."""

import math
from dataclasses import dataclass, field
from numbers import Real
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from runningbond.scene import Array, frozen

Status: TypeAlias = Literal["collapse", "unbounded", "infeasible", "undecided", "failed"]
STATUSES: tuple[str, ...] = get_args(Status)


@dataclass(frozen=True, eq=False)
class Outcome:
    """The answer of one model on one scene.

    Parameters
    ----------
    scene, model
        Title of the scene and name of the model.
    status
        ``collapse``: a load was found at which the wall collapses; ``unbounded``: the wall is self-locking, no
        multiple of the live load brings it down (by `limit`, if its joints are associated); ``infeasible``: it
        collapses under its dead load; ``undecided``: the budget ran out or nothing was proved; ``failed``: the numbers
        cannot be trusted.
    multiplier
        λ at collapse; for a point load of 1 N, the load in newtons. None unless the status is ``collapse``.
    lower, upper
        Bracket of the collapse multiplier; each None if the model has no such bound. The message says what the bracket
        means: a proof or a pair of runs.
    dofs, steps
        Degrees of freedom; number of steps, iterations or programs solved. None for a closed form.
    seconds, message
        Wall-clock time, and one line for the reader.
    motion : (nb, 3) float
        Collapse mechanism: displacement of each block's centroid [m] and rotation [rad], scaled so that the fastest
        corner moves by one metre. Empty if there is none.
    moved
        Factor by which `motion` is multiplied to give the deformed shape of a wall that has turned so far that its
        displacements are not linear in its rotations. None for a mechanism in the shape as built.
    force : (np, 2) float
        Normal and tangential force at each contact point [N], tension positive. Empty if not known.
    pull : (nt, 1) float
        Pull of each tie [N]. Empty if not known.
    held : (n, 1) float
        Reaction of each held motion of a block, first those of `Scene.pins`, then those of `Scene.late_pins`: a force
        on the block along the pin's direction [N], or a moment [N m]. Empty if not known.
    far_motion, far_force, far_pull, far_held
        The same four quantities at the other end of an interval of certified loads: at `upper`, or at `lower` for a
        moving support. Empty for models that certify no interval.
    curve : (n, 2) float
        Pushover curve: displacement of the control point along the live load [m], measured from the state at rest under
        the dead load, and λ. Empty for models that follow no path. The control point is where a point load acts, or the
        wall's highest corner that lies farthest along a lateral load.
    path : (n, k) float
        Further quantities of the states of `curve`, with names and units in `path_columns`: reactions of all supports,
        forces of ties (`Supports`), work of the dead and of the live load since the wall was built, and whether the
        wall is at rest (1), or falls or moves with what drives it (0). Without a curve at most one row, the collapse.
        Unknown values are NaN.
    path_columns
        Names of the columns of `path`.
    moments : (n nb, 3) float
        Motions of all blocks [m, rad] since the wall was built, at selected moments of its loading and its fall,
        stacked moment by moment. Empty if none were kept.
    moment_loads : (n, 1) float
        λ at those moments.
    fall
        Smallest load at which the wall was found to fall, if `upper` also covers load paths that fell later; else None.
    crushed : (nj, 2) float
        Plastic closure of each joint at its ends [m], up to the state that shows the mechanism. Empty if no joint
        crushes or the model does not track crushing.
    """

    scene: str
    model: str
    status: Status
    multiplier: float | None = None
    lower: float | None = None
    upper: float | None = None
    dofs: int | None = None
    steps: int | None = None
    seconds: float = 0.0
    message: str = ""
    motion: Array = field(repr=False, default_factory=lambda: np.zeros((0, 3)))
    force: Array = field(repr=False, default_factory=lambda: np.zeros((0, 2)))
    pull: Array = field(repr=False, default_factory=lambda: np.zeros((0, 1)))
    held: Array = field(repr=False, default_factory=lambda: np.zeros((0, 1)))
    far_motion: Array = field(repr=False, default_factory=lambda: np.zeros((0, 3)))
    far_force: Array = field(repr=False, default_factory=lambda: np.zeros((0, 2)))
    far_pull: Array = field(repr=False, default_factory=lambda: np.zeros((0, 1)))
    far_held: Array = field(repr=False, default_factory=lambda: np.zeros((0, 1)))
    curve: Array = field(repr=False, default_factory=lambda: np.zeros((0, 2)))
    moments: Array = field(repr=False, default_factory=lambda: np.zeros((0, 3)))
    moment_loads: Array = field(repr=False, default_factory=lambda: np.zeros((0, 1)))
    path: Array = field(repr=False, default_factory=lambda: np.zeros((0, 0)))
    path_columns: tuple[str, ...] = ()
    fall: float | None = None
    crushed: Array = field(repr=False, default_factory=lambda: np.zeros((0, 2)))
    moved: float | None = None

    def __post_init__(self) -> None:
        for name, kind in (("multiplier", float), ("lower", float), ("upper", float), ("dofs", int), ("steps", int)):
            value = getattr(self, name)
            if isinstance(value, Real):  # numpy's numbers are written into no JSON file
                object.__setattr__(self, name, kind(float(value)))
            elif value is not None:
                raise ValueError(f"{name} = {value!r}: must be a number")
        object.__setattr__(self, "seconds", float(self.seconds))
        object.__setattr__(self, "message", " ".join(self.message.split("\n")))
        for name, columns in ARRAYS.items():
            object.__setattr__(self, name, frozen(getattr(self, name)).reshape(-1, columns))
        object.__setattr__(self, "path_columns", tuple(map(str, self.path_columns)))
        object.__setattr__(self, "path", frozen(self.path).reshape(len(self.path), len(self.path_columns)))
        if len(self.path) not in (0, len(self.curve) or 1):
            raise ValueError(f"path has {len(self.path)} rows: must have as many as the curve, or none")
        if self.status not in STATUSES:
            raise ValueError(f"status = {self.status!r}: must be one of {', '.join(STATUSES)}")
        if not math.isfinite(self.seconds):
            raise ValueError(f"seconds = {self.seconds}: must be finite")
        numbers = [x for x in (self.lower, self.multiplier, self.upper) if x is not None]
        if not all(math.isfinite(x) for x in numbers):
            raise ValueError(f"bracket = {numbers}: a number that does not exist is None")
        if numbers != sorted(numbers):
            raise ValueError(f"bracket = {numbers}: lower, multiplier and upper must not decrease")
        if (self.status == "collapse") != (self.multiplier is not None):
            raise ValueError(f"multiplier = {self.multiplier}: exists if and only if the status is collapse")

    def summary(self) -> dict[str, Any]:
        """Return the scalar fields in the order of the command line's JSON object."""
        return {key: getattr(self, key) for key in SCALARS}

    def curve_columns(self, multiplier: str = "multiplier", displacement: str = "displacement") -> dict[str, Array]:
        """Return curve and path by column name; without a curve, the one row of the collapse if it has a path."""
        collapse = [(np.nan, self.multiplier)] * len(self.path)
        moved, load = (self.curve if len(self.curve) else np.array(collapse, dtype=float).reshape(-1, 2)).T
        return {multiplier: load, displacement: moved, **dict(zip(self.path_columns, self.path.T, strict=True))}


SCALARS = ("scene", "model", "status", "multiplier", "lower", "upper", "dofs", "steps", "seconds", "message")
FORCES = {"motion": 3, "force": 2, "pull": 1, "held": 1}
ARRAYS = {**FORCES, **{f"far_{name}": columns for name, columns in FORCES.items()}, "curve": 2}
ARRAYS |= {"crushed": 2, "moments": 3, "moment_loads": 1}
"""Array fields and their number of columns."""


def joined(*parts: str) -> str:
    """Join the non-empty parts of a message with semicolons."""
    return "; ".join(filter(None, parts))


def two_digits(value: float) -> str:
    """Format a number with two significant digits, without an exponent from 0.0001 to a million."""
    return f"{float(f'{value:.2g}'):g}"


def number(value: float) -> str:
    """Format a multiplier of order one with four decimals, and a force of a thousand or more in whole newtons."""
    if value != 0 and abs(value) < 0.01:
        return f"{value:.3g}"
    decimals = 4 if abs(value) < 100 else 1 if abs(value) < 1000 else 0
    return f"{value:,.{decimals}f}"
