"""Draws: one model on walls that differ only in what is not known exactly, and statistics of the outcomes."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from numbers import Integral
from pathlib import Path
from typing import Any

import numpy as np

from runningbond.campaigns import run_campaign
from runningbond.models import TOLERANCE, Model
from runningbond.pictures.sheet import Sheet
from runningbond.results import Outcome, make_folder
from runningbond.results.outcome import number
from runningbond.scene import Array, Scene, SceneError
from runningbond.scene.ranges import Range

from .scatter import Scatter

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)

NUMBER = Range(least=2, most=10_000)


@dataclass(frozen=True, eq=False, repr=False)
class Draws:
    """Outcomes of one model on a wall as given, and on random draws of it.

    Parameters
    ----------
    outcomes
        Outcomes by the number of the draw; 0 is the wall as given.
    scatter
        What varies in addition to the last bits: sizes of blocks, friction of joints.
    """

    outcomes: tuple[Outcome, ...]
    scatter: Scatter

    @property
    def drawn(self) -> tuple[Outcome, ...]:
        """Outcomes of the draws, from which all statistics below are computed.

        If walls differ in last bits only, the wall as given is one of the draws. If sizes or frictions scatter, it is
        left out: all its joints are like the median one and none is the weakest, so that it carries more than most.
        """
        return self.outcomes[1:] if self._is_scattered else self.outcomes

    @property
    def _is_scattered(self) -> bool:
        return self.scatter != Scatter()

    @cached_property
    def multipliers(self) -> Array:
        """λ of the draws that collapse, ascending, ``(n,)``."""
        return np.sort([x.multiplier for x in self.drawn if x.multiplier is not None])

    @cached_property
    def borne(self) -> Array:
        """λ of all draws that are decided, ascending, ``(n,)``.

        It is 0 for a draw that falls under its dead load, and infinite for a draw that carries every load.
        """
        none, all_of_them = (self._count(status) for status in ("infeasible", "unbounded"))
        return np.concatenate([np.zeros(none), self.multipliers, np.full(all_of_them, np.inf)])

    @property
    def lowest(self) -> float | None:
        """Lowest λ; 0 if a draw falls under its dead load, None if it is infinite or no draw is decided."""
        return float(self.borne[0]) if len(self.borne) and np.isfinite(self.borne[0]) else None

    @property
    def mean(self) -> float | None:
        """Mean λ; None if a draw carries every load, or none is decided."""
        return float(self.borne.mean()) if len(self.borne) and np.isfinite(self.borne[-1]) else None

    @property
    def error(self) -> float | None:
        """Standard error of the mean; None for fewer than two draws, or an infinite λ."""
        n = len(self.borne)
        if n < 2 or not np.isfinite(self.borne[-1]):
            return None
        # Relative to the lowest, so that equal values do not scatter by the rounding of their mean.
        return float((self.borne - self.borne[0]).std(ddof=1) / np.sqrt(n))

    @property
    def half_width(self) -> float | None:
        """Half the widest bracket of the draws that collapse: error of each λ, or twice that if λ is its lower end."""
        brackets = [(each.lower, each.upper) for each in self.drawn if each.multiplier is not None]
        halves = [(upper - lower) / 2 for lower, upper in brackets if lower is not None and upper is not None]
        return max(halves, default=None)

    @property
    def quantiles(self) -> dict[str, float]:
        """Quantiles of λ of the decided draws, by percentage (`QUANTILES`); infinite if they fall on infinite λ."""
        if not len(self.borne):
            return {}
        high = np.quantile(self.borne, QUANTILES, method="higher")
        finite = np.quantile(np.minimum(self.borne, np.finfo(float).max / 2), QUANTILES)
        values = np.where(np.isfinite(high), finite, high)
        return {f"{100 * q:g}": float(value) for q, value in zip(QUANTILES, values, strict=True)}

    def _count(self, status: str) -> int:
        return sum(outcome.status == status for outcome in self.drawn)

    def summary(self) -> dict[str, Any]:
        """All results as a JSON object."""
        keys = ("status", "multiplier", "lower", "upper", "seconds")
        return {
            "scatter": str(self.scatter),
            "number": len(self.outcomes),
            "drawn": len(self.drawn),
            "collapsed": len(self.multipliers),
            **{status: self._count(status) for status in ("infeasible", "unbounded")},
            **{key: getattr(self, key) for key in ("lowest", "mean", "error", "half_width")},
            "quantiles": {q: x if np.isfinite(x) else None for q, x in self.quantiles.items()},
            "each": [{key: getattr(outcome, key) for key in keys} for outcome in self.outcomes],
        }

    def sheet(self) -> Sheet:
        """Table with one row per draw."""
        heads = ("draw", "status", "λ", "lower", "upper", "seconds")
        names = ["0, as it is", *map(str, range(1, len(self.outcomes)))]
        rows = [
            (name, each.status, *(_told(x) for x in (each.multiplier, each.lower, each.upper)), f"{each.seconds:.3g}")
            for name, each in zip(names, self.outcomes, strict=True)
        ]
        first = self.outcomes[0]
        return Sheet(f"{first.scene}: {first.model}, draws of {self.scatter}", heads, rows)

    def __str__(self) -> str:
        """Summary in one line."""
        told = f"{len(self.multipliers)} of {len(self.drawn)} draws collapse"
        if self._is_scattered:
            first = self.outcomes[0]
            told = f"as it is {first.status if first.multiplier is None else _told(first.multiplier)}; {told}"
        for status, words in (("infeasible", "under dead load alone, at 0"), ("unbounded", "at no load, ∞")):
            told += f", {self._count(status)} fall {words}" if self._count(status) else ""
        if len(self.borne) < 2:
            return f"{told}{'' if self.lowest is None else f', at {_told(self.lowest)}'}"
        quantiles = ", ".join(f"{q} % {_told(x)}" for q, x in self.quantiles.items())
        told += f": lowest {_told(self.lowest)}, quantiles {quantiles}"
        if self.mean is not None:
            told += f", mean {_told(self.mean)} ± {_told(self.error)} (standard error)"
        return f"{told}; each λ has a bracket up to {_told(2 * self.half_width)} wide" if self.half_width else told

    def __repr__(self) -> str:
        first, ends = self.outcomes[0], {"lowest": self.lowest, "mean": self.mean}
        known = "".join(f", {name} {number(value)}" for name, value in ends.items() if value is not None)
        spread = "" if self.error is None else f" ± {number(self.error)}"
        collapse = f"{len(self.multipliers)} of {len(self.drawn)} collapse"
        return f"<Draws of {first.model} on {first.scene!r}, {self.scatter}: {collapse}{known}{spread}>"


def _told(load: float | None) -> str:
    return "–" if load is None else number(load) if np.isfinite(load) else "∞"


@dataclass(frozen=True, eq=False)
class Sampling:
    """A model that follows a load path, to be run on a wall and on random draws of it.

    Parameters
    ----------
    scene
        The wall as given, which is the first draw.
    number
        Number of draws.
    scatter
        What varies: ``bits``, the last bits of densities and frictions; or ``size=0.01,friction=0.05``, the blocks'
        sizes within a relative tolerance, each joint's friction with a standard deviation of its logarithm.

    Raises
    ------
    SceneError
        For an invalid number of draws or scatter, for a model that follows no load path or does not apply to the
        wall, or for a scatter that the wall does not allow.
    """

    scene: Scene
    model: Model
    number: int
    scatter: str = "bits"

    def __post_init__(self) -> None:
        if isinstance(self.number, bool) or not isinstance(self.number, Integral):
            raise SceneError("number", f"must be a whole {str(NUMBER).removeprefix('a ')}", self.number)
        NUMBER.take("number", self.number)
        if self.model.kind != "history":
            raise SceneError(
                "number", f"is for models that follow a path, which {self.model.name} does not", self.number
            )
        self.model.check(self.scene)
        self.read.draw(self.scene, 1)

    @property
    def read(self) -> Scatter:
        """The scatter, parsed."""
        return Scatter.read(self.scatter)

    def run(
        self,
        tolerance: float = TOLERANCE,
        folder: Path | None = None,
        jobs: int = -1,
        progress: Callable[[str], None] = lambda done: None,
    ) -> Draws:
        """Run all draws that are not in the folder yet; parameters and errors as in `run_campaign`.

        Without a folder nothing is saved; `progress` is called with the name of each draw that is done.
        """
        scenes = {f"draw-{k:04d}": self.read.draw(self.scene, k) for k in range(self.number)}
        if folder is not None:
            make_folder(folder)
        found = run_campaign(
            scenes,
            [self.model],
            folder=folder,
            tolerance=tolerance,
            jobs=jobs,
            progress=lambda cell: progress(cell[0]),
        )
        for refusal in found.inapplicable.values():
            raise SceneError("number", refusal)
        return Draws(tuple(found.outcomes[name, self.model.name] for name in scenes), self.read)
