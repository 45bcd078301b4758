"""Response of a wall to ground motion: time series, fallen blocks, and a verdict."""

import math
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from runningbond.scene import Array, Indices

ResponseVerdict: TypeAlias = Literal["stands", "collapse", "undecided", "infeasible"]
"""Whether the wall has come to rest, a block has fallen or the wall slides away, or neither within the simulated time;
``infeasible`` if the wall already falls under its dead load, before any ground motion."""

ENERGIES = ("input", "weight", "kinetic", "stored", "friction", "damped")
"""Work of the ground motion, in the ground's frame, and of the dead load; kinetic and stored energy; energy dissipated
by friction, crushing and cracking, and by impacts and damping [J]."""

MISSED = 0.01
"""Share of the energy supplied that the ledger may miss; above it a run is not reliable."""


@dataclass(frozen=True, eq=False, repr=False)
class Response:
    """Response of a wall to a ground motion, in the frame of the ground.

    Parameters
    ----------
    scene, model, scale
        Title of the scene, name of the model, and the factor on the record, λ.
    verdict
        Verdict on the wall.
    message
        The verdict in one line.
    points : (k, 2) float
        Points of the undeformed wall that are followed [m].
    time : (n,) float
        Time since the record began [s].
    ground : (n, 2) float
        Acceleration of the ground [m/s²].
    displacement : (n, k, 2) float
        Displacement of the points since the wall was at rest [m].
    drift : (n,) float
        Mean horizontal displacement of the points over their mean height above the base.
    reaction : (n, 2) float
        Mean force of the ground on the wall since the previous row [N]: base shear, and vertical force.
    energy : (n, 6) float
        `ENERGIES` since the wall was at rest [J].
    fallen : (n,) int
        Number of blocks that have fallen.
    first : (m,) int
        Blocks that had fallen by the end, in the order of falling.
    motion, shape : (nb, 3) float
        Displacement of each block's centroid [m] and its rotation [rad] since the wall was at rest: at the end, and at
        the last moment before a block fell at which no corner had moved farther than a tenth of the wall's size, or
        than that beyond where the wall last swung back.
    unaccounted
        Largest share of the energy supplied that the ledger misses, until a block has fallen; relative to the kinetic
        energy that a wall at rest may have if that is larger.
    steps
        Time steps taken.
    seconds
        Wall-clock time.
    """

    scene: str
    model: str
    scale: float
    verdict: ResponseVerdict
    message: str
    points: Array
    time: Array
    ground: Array
    displacement: Array
    drift: Array
    reaction: Array
    energy: Array
    fallen: Indices
    first: Indices
    motion: Array
    shape: Array
    unaccounted: float
    steps: int
    seconds: float = 0.0

    @property
    def residual(self) -> Array:
        """Energy that the ledger misses ``(n,)`` [J]."""
        return np.asarray(supplied(self.energy) - self.energy[:, 2:].sum(axis=1))

    @property
    def residual_drift(self) -> float:
        """Drift at the end; not a number, like `peak_drift`, if the wall was not shaken."""
        return float(self.drift[-1]) if len(self.drift) else math.nan

    @property
    def peak_drift(self) -> float:
        """Largest absolute drift until a block has fallen, which does not depend on how long the run continues."""
        return float(np.abs(until_fallen(self.drift, self.fallen)).max()) if len(self.drift) else math.nan

    @property
    def line(self) -> str:
        """The message, with the verdict in front if the message does not include it."""
        return f"infeasible: {self.message}" if self.verdict == "infeasible" else self.message

    def summary(self) -> dict[str, Any]:
        """Scalar results by name; None where there is no value."""
        names = ("scene", "model", "verdict", "scale", "peak_drift", "residual_drift", "unaccounted")
        fallen = {"fallen": self.first.tolist(), "time": float(self.time[-1]) if len(self.time) else math.nan}
        last = {name: getattr(self, name) for name in ("steps", "seconds", "message")}
        found = {name: getattr(self, name) for name in names} | fallen | last
        return {name: None if isinstance(x, float) and math.isnan(x) else x for name, x in found.items()}

    def columns(self) -> dict[str, Array]:
        """Time series by column, with units."""
        moved = {
            f"point {k + 1} {axis} [m]": self.displacement[:, k, number]
            for k in range(len(self.points))
            for number, axis in enumerate("xy")
        }
        return {
            "time [s]": self.time,
            "ground x [m/s²]": self.ground[:, 0],
            "ground y [m/s²]": self.ground[:, 1],
            **moved,
            "drift": self.drift,
            "base shear [N]": self.reaction[:, 0],
            "base pressure [N]": self.reaction[:, 1],
            **{f"{name} [J]": column for name, column in zip(ENERGIES, self.energy.T, strict=True)},
            "residual [J]": self.residual,
            "fallen": self.fallen,
        }

    def __repr__(self) -> str:
        return f"<Response of {self.model} on {self.scene!r}, λ = {self.scale:g}: {self.line.split(';')[0]}>"


def until_fallen(rows: Array, fallen: Indices) -> Array:
    """Rows ``(n, …)`` up to the first one in which a block has fallen."""
    return rows[: int(np.argmax(fallen > 0)) + 1] if fallen.any() else rows


def supplied(energy: Array) -> Array:
    """Energy supplied by the loads, ``(n,)`` [J]."""
    return np.asarray(energy[:, 0] + energy[:, 1])


def unaccounted(energy: Array, least: float) -> float:
    """Largest energy that the ledger misses at any time, relative to the energy supplied, at least to `least` [J].

    The works of the ground and of the weight count separately, each by its range: when a rocking wall passes through
    its upright position, their sum is almost zero.
    """
    missing = np.abs(supplied(energy) - energy[:, 2:].sum(axis=1))
    gone = max(float(np.ptp(energy[:, :2], axis=0).sum()), least)
    return float(missing.max(initial=0.0) / gone) if gone else 0.0
