"""The outcome of one model on one scene: a bracket and a status, never a bare number."""

import math
from dataclasses import dataclass, field
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
        multiple of the live load brings it down; ``infeasible``: it collapses under its dead load; ``undecided``:
        the budget ran out or nothing was proved; ``failed``: the numbers cannot be trusted.
    multiplier
        λ at collapse; for a point load of 1 N, newtons. None unless there is a collapse.
    lower, upper
        Bracket of the collapse multiplier; each None where the model has no such bound. What the bracket
        means, a proof or a pair of runs, is in the message.
    dofs, steps
        Degrees of freedom; steps, iterations or programs that were solved. None for a closed form.
    seconds, message
        Wall-clock time, and one line for the reader.
    motion : (nb, 3) float
        Collapse mechanism: displacement of each block's centroid [m] and rotation [rad], the fastest corner
        moving by one metre. Empty without one.
    force : (np, 2) float
        Normal and tangential force at each contact point [N], tension positive. Empty without them.
    pull : (nt, 1) float
        Pull of each tie [N]. Empty without them.
    held : (n, 1) float
        What each held motion of a block is held with, those of `Scene.pins` and then `Scene.late_pins`: a force on the
        block along the pin's direction [N], or a moment [N m]. Empty without them.
    far_motion, far_force, far_pull, far_held
        The same four at the other end of an interval of certified loads: at `upper`, or `lower` of a support that
        moves. Empty for models that certify none.
    curve : (n, 2) float
        Pushover curve: displacement of the control point along the live load [m], from the rest under the dead load
        on, and λ. Empty for models that follow no path. The control point is where a point load acts, or the wall's
        highest corner that lies farthest along a lateral load.
    path : (n, k) float
        What else is known of the states of `curve`, in columns that `path_columns` name with their units: reactions
        of all supports (`Supports`), the works of the dead and of the live load since the wall was built, and whether
        it rests (1) or falls (0). Without a curve one row at most, the collapse; not a number is what is not known.
    path_columns
        Names of the columns of `path`.
    moments : (n nb, 3) float
        Motions of all blocks [m, rad] since the wall was built, at some moments of its way and its fall, one after the
        other. Empty where none were kept.
    moment_loads : (n, 1) float
        λ at those moments.
    fall
        Smallest load under which the wall was seen to fall, where `upper` takes in others that fell later; else None.
    crushed : (nj, 2) float
        How far each joint has closed for good at its ends [m], up to where the mechanism was seen. Empty where no joint
        crushes, or a model does not follow how it does.
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

    def __post_init__(self) -> None:
        for name, columns in ARRAYS.items():
            object.__setattr__(self, name, frozen(getattr(self, name)).reshape(-1, columns))
        object.__setattr__(self, "path_columns", tuple(map(str, self.path_columns)))
        object.__setattr__(self, "path", frozen(self.path).reshape(len(self.path), len(self.path_columns)))
        if len(self.path) not in (0, len(self.curve) or 1):
            raise ValueError(f"path has {len(self.path)} rows: must have as many as the curve, or none")
        if self.status not in STATUSES:
            raise ValueError(f"status = {self.status!r}: must be one of {', '.join(STATUSES)}")
        numbers = [x for x in (self.lower, self.multiplier, self.upper) if x is not None]
        if not all(math.isfinite(x) for x in numbers):
            raise ValueError(f"bracket = {numbers}: a number that does not exist is None")
        if numbers != sorted(numbers):
            raise ValueError(f"bracket = {numbers}: lower, multiplier and upper must not decrease")
        if (self.status == "collapse") != (self.multiplier is not None):
            raise ValueError(f"multiplier = {self.multiplier}: exists if and only if the status is collapse")

    def summary(self) -> dict[str, Any]:
        """The scalars, in the order of the command line's contract."""
        return {key: getattr(self, key) for key in SCALARS}

    def curve_columns(self, multiplier: str = "multiplier", displacement: str = "displacement") -> dict[str, Array]:
        """Curve and path, column by column; without a curve the collapse, where something is known of it."""
        collapse = [(np.nan, self.multiplier)] * len(self.path)
        moved, load = (self.curve if len(self.curve) else np.array(collapse, dtype=float).reshape(-1, 2)).T
        return {multiplier: load, displacement: moved, **dict(zip(self.path_columns, self.path.T, strict=True))}


SCALARS = ("scene", "model", "status", "multiplier", "lower", "upper", "dofs", "steps", "seconds", "message")
FORCES = {"motion": 3, "force": 2, "pull": 1, "held": 1}
ARRAYS = {**FORCES, **{f"far_{name}": columns for name, columns in FORCES.items()}, "curve": 2}
ARRAYS |= {"crushed": 2, "moments": 3, "moment_loads": 1}
"""Array fields and their number of columns."""


def joined(*parts: str) -> str:
    """Those parts of a message that say anything."""
    return "; ".join(filter(None, parts))


def two_digits(value: float) -> str:
    """A number with the two digits that count, without an exponent below a million."""
    return f"{float(f'{value:.2g}'):g}"


def number(value: float) -> str:
    """Four decimals for a multiplier of order one, whole newtons for a force of a thousand or more."""
    if value != 0 and abs(value) < 0.01:
        return f"{value:.3g}"
    decimals = 4 if abs(value) < 100 else 1 if abs(value) < 1000 else 0
    return f"{value:,.{decimals}f}"
