"""Results and cost so far of a search for certificates."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .certificates import Certificate, least_multiplier


@dataclass(eq=False)
class SearchLog:
    """Results of a search.

    Parameters
    ----------
    certificates
        Every certificate found; in large walls some have approximate loads.
    starts, programs
        Number of starts, and of linear programs solved.
    cost
        Cost of these programs in programs of the full wall; those of glued walls cost less.
    dry
        Number of consecutive starts, up to the last one, that found no lower load.
    frictionless
        Whether normal forces alone carry any multiple of the live load.
    growing
        Whether each program of a full sequence carried more than the one before, i.e. friction grew with the load.
    interrupted
        Whether the search was stopped before its end.
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
        """Multiplier of the lowest certificate; infinite without one."""
        return np.inf if self.best is None else self.best.least.multiplier

    @property
    def highest(self) -> float:
        """The largest certified multiplier; minus infinity without one."""
        return max((each.most.multiplier for each in self.certificates), default=-np.inf)

    def add_programs(self, number: int, cost: float = 1.0) -> None:
        """Record solved programs and the cost of each."""
        self.programs += number
        self.cost += number * cost


Observer = Callable[[SearchLog], None]
