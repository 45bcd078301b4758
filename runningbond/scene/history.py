"""Motion of the ground: a record or a pulse, for a dynamic analysis in time.

Between samples, accelerations and velocities are interpolated linearly, displacements by a cubic spline. The analysis
uses the ground's velocity: whatever its size, each time step applies exactly the change of velocity over that step.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .actions import Action
from .arrays import Array, frozen
from .errors import SceneError
from .forces import Forces
from .ranges import Range, one_of
from .records import read_record
from .table import Table

if TYPE_CHECKING:
    from .scene import Scene

KEY = "load.history"

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of gravity, 1 g [m/s²]."""

QUANTITIES = {"acceleration": 1.0, "g": STANDARD_GRAVITY, "velocity": 1.0, "displacement": 1.0}
"""Quantities that a record may hold, and the factor that converts each to m/s², m/s or m."""

PULSES = ("sine", "half-sine", "ricker", "ramp")

SAMPLES_PER_PERIOD = 1000
"""Samples per period of a pulse; linear interpolation of a sine between them errs by 5e-6 of its amplitude."""

INTERVALS = 200
"""Intervals per period of a pulse; within each, the acceleration may be replaced by its mean."""

SECONDS = Range(above=0.0, most=1e4)
FACTOR = Range(least=-1e6, most=1e6)


@dataclass(frozen=True, eq=False)
class History(Action):
    """Motion of the ground; as a live load at λ = 1, the inertia forces of the blocks at the peak acceleration.

    Parameters
    ----------
    time : (n,) float
        Times of the samples [s], from 0.
    values : (n, 2) float
        Horizontal and vertical motion at these times, in the unit of the quantity.
    quantity
        ``"acceleration"`` [m/s²], ``"g"``, ``"velocity"`` [m/s] or ``"displacement"`` [m].
    scale
        Factor on the record, which λ multiplies further.
    source
        Name of the file or kind of the pulse.
    holds
        Whether the last acceleration continues after the end of the record.
    interval
        Time [s] over which the acceleration may be replaced by its mean; None is half the shortest sampling step.
    """

    time: Array
    values: Array
    quantity: str = "acceleration"
    scale: float = 1.0
    source: str = ""
    holds: bool = False
    interval: float | None = None

    def __post_init__(self) -> None:
        one_of(f"{KEY}.quantity", self.quantity, QUANTITIES)
        object.__setattr__(self, "scale", FACTOR.take(f"{KEY}.scale", self.scale))
        try:
            time = frozen(np.reshape(self.time, (len(self.time),)))
            values = frozen(np.reshape(self.values, (len(time), 2)))
        except (TypeError, ValueError):
            raise SceneError(KEY, "must have a list of times, and [horizontal, vertical] for each of them") from None
        if len(time) < 2 or not (np.isfinite(time).all() and np.isfinite(values).all() and (np.diff(time) > 0).all()):
            raise SceneError(KEY, "must have two samples at least, finite, at times that ascend")
        object.__setattr__(self, "time", frozen(time - time[0]))
        object.__setattr__(self, "values", values)
        if self.scale == 0:
            raise SceneError(f"{KEY}.scale", "must not be zero", self.scale)
        if not np.abs(self.acceleration(self.time)).max() > 0:
            moves = "moves the ground by a jump alone, as it begins; let it begin at 0 and rise"
            what = moves if self.jump else "does not move the ground"
            raise SceneError(KEY, what, self.source or None)

    @property
    def duration(self) -> float:
        """Duration of the record [s]."""
        return float(self.time[-1])

    @cached_property
    def resolution(self) -> float:
        """`interval` or its default [s]; cached, as it is needed every few steps and a record may have many samples."""
        return self.interval or float(np.diff(self.time).min() / 2)

    @cached_property
    def _velocity(self) -> Any:
        from scipy.interpolate import CubicSpline, make_interp_spline  # slow to import, only needed here

        values = self.scale * QUANTITIES[self.quantity] * self.values
        if self.quantity == "displacement":
            return CubicSpline(self.time, values).derivative()
        spline: Any = make_interp_spline(self.time, values, k=1)
        return spline if self.quantity == "velocity" else spline.antiderivative()

    @cached_property
    def _acceleration(self) -> Any:
        return self._velocity.derivative()

    @property
    def has_jumps(self) -> bool:
        """Whether the ground's velocity may jump when the record begins or ends."""
        return self.quantity in ("velocity", "displacement")

    @cached_property
    def jump(self) -> float:
        """Magnitude of the jump in the ground's velocity when the record begins [m/s]."""
        return float(np.hypot(*self._velocity(0.0))) if self.has_jumps else 0.0

    def velocity(self, time: Array | float) -> Array:
        """Velocity of the ground ``(…, 2)`` [m/s] at some times [s]; the ground is at rest before the record.

        After the record the velocity stays constant or, if `holds`, grows with the last acceleration; after a record of
        displacements the ground is at rest in the last position.
        """
        time = np.asarray(time, dtype=float)
        begun, over = (time > 0)[..., None], (time > self.duration)[..., None]
        now = np.where(begun, self._velocity(np.clip(time, 0.0, self.duration)), 0.0)
        if self.quantity == "displacement":
            return np.where(over, 0.0, now)
        if not self.holds:
            return np.asarray(now)
        beyond = np.maximum(0.0, time - self.duration)[..., None] * self._acceleration(self.duration)
        return np.asarray(now + beyond)

    def acceleration(self, time: Array | float) -> Array:
        """Acceleration of the ground ``(…, 2)`` [m/s²] at some times [s]."""
        time = np.asarray(time, dtype=float)
        there = (time >= 0) & ((time <= self.duration) | self.holds)
        return np.asarray(np.where(there[..., None], self._acceleration(np.clip(time, 0.0, self.duration)), 0.0))

    @cached_property
    def peak(self) -> Array:
        """Acceleration ``(2,)`` [m/s²] at the sample where it is largest."""
        every = self.acceleration(self.time)
        return np.asarray(every[np.hypot(*every.T).argmax()])

    def forces(self, scene: "Scene") -> Forces:
        """Inertia forces of the blocks in the frame of the ground, at the peak acceleration."""
        return Forces.on(scene, -self.peak)

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse walls that cannot be analysed in time: those on pins, and those with a beam that is held."""
        if len(scene.pins):  # a beam with late pins has one from the start too
            name = "support.kind" if scene.beam is None else "beam.condition"
            raise SceneError(
                name, "does not go with load.history, which moves a wall on its ground that is free on top"
            )

    def note(self, multiplier: float) -> str:
        """The peak acceleration, and the velocity jump with which the record begins."""
        peak, jump = (abs(multiplier) * x for x in (float(np.hypot(*self.peak)) / STANDARD_GRAVITY, self.jump))
        told = f"the ground is accelerated by up to {peak:.4g} g"
        return told if not jump else f"{told}, and has {jump:.4g} m/s at once as the record begins"


def pulse(kind: str, amplitude: float, period: float) -> tuple[Array, Array]:
    """Times ``(n,)`` [s] and values ``(n, 2)`` of a horizontal pulse.

    A half-sine lasts half a period, a Ricker wavelet three periods, all others one.
    """
    span = {"half-sine": 0.5, "ricker": 3.0}.get(kind, 1.0)
    share = np.linspace(0.0, span, round(span * SAMPLES_PER_PERIOD) + 1)
    if kind == "ramp":
        shape = share = np.array([0.0, 1.0])
    elif kind == "ricker":
        squared = (math.pi * (share - span / 2)) ** 2
        shape = (1 - 2 * squared) * np.exp(-squared)
    else:
        shape = np.sin(2 * math.pi * share)
    return period * share, amplitude * np.column_stack([shape, np.zeros_like(shape)])


def read_history(table: Table, folder: Path) -> History:
    """Read the motion of the ground from a table of a scene file; paths of records are relative to `folder`."""
    if ("file" in table) == ("pulse" in table):
        raise SceneError(table.name, "must have one of file and pulse")
    scale = table.optional_number("scale", FACTOR)
    given = table.choice("quantity", QUANTITIES, "") if "quantity" in table else None
    if "pulse" in table:
        quantity, inner = _required(table, given), table.table("pulse")
        kind = inner.choice("kind", PULSES)
        amplitude, period = inner.number("amplitude", FACTOR), inner.number("period", SECONDS)
        inner.finish()
        if amplitude == 0:
            raise SceneError(inner.key("amplitude"), "must not be zero", amplitude)
        time, values = pulse(kind, amplitude, period)
        source, holds, interval = kind, kind == "ramp" and quantity in ("acceleration", "g"), period / INTERVALS
    else:
        name = table.text("file")
        record = read_record(folder / name, table.key("file"))
        if record.quantity is not None and given not in (None, record.quantity):
            what = f'must be left out or "{record.quantity}", as {Path(name).name} says itself'
            raise SceneError(table.key("quantity"), what, given)
        quantity = record.quantity or _required(table, given)
        time, values, source, holds, interval = record.time, record.values, Path(name).name, False, None
    table.finish()
    return History(time, values, quantity, 1.0 if scale is None else scale, source, holds, interval)


def _required(table: Table, quantity: str | None) -> str:
    """The quantity; refused if it is missing, because it determines the unit."""
    if quantity is None:
        units = '"acceleration" (m/s²), "g", "velocity" (m/s) or "displacement" (m)'
        raise SceneError(table.key("quantity"), f"is missing; without it the record has no unit: {units}")
    return quantity
