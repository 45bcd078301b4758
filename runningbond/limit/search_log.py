"""What a search for certificates has found so far, and what it has cost."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .certificates import Certificate, least_multiplier


@dataclass(eq=False)
class SearchLog:
    """What a search has found.

    Parameters
    ----------
    certificates
        Every collapse that was proved.
    starts, programs
        Starts, and linear programs solved.
    cost
        Those programs, where glued walls were searched by what they cost beside the wall's own.
    dry
        Starts in a row, the last ones, that brought nothing lower.
    frictionless
        Whether normal forces alone carry any multiple of the live load.
    growing
        Whether each program of a full sequence carried more than the one before: friction grew with the load.
    interrupted
        Whether it was stopped before its end.
    """

    certificates: list[Certificate] = field(default_factory=list)
    starts: int = 0
    programs: int = 0
    cost: float = 0.0
    dry: int = 0
    frictionless: bool = False
    growing: bool = False
    interrupted: bool = False

    @property
    def best(self) -> Certificate | None:
        """The lowest certificate."""
        return min(self.certificates, key=least_multiplier, default=None)

    @property
    def lowest(self) -> float:
        """Its multiplier; infinite without one."""
        return np.inf if self.best is None else self.best.least.multiplier

    @property
    def highest(self) -> float:
        """The largest certified multiplier; minus infinity without one."""
        return max((each.most.multiplier for each in self.certificates), default=-np.inf)

    def add_programs(self, number: int, cost: float = 1.0) -> None:
        """Take note of programs that were solved, and of what each cost."""
        self.programs += number
        self.cost += number * cost


Observer = Callable[[SearchLog], None]
