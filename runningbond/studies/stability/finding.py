"""What an experiment found out about where a method fails."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from matplotlib.figure import Figure

Entry: TypeAlias = float | int | str
"""Entry of a table."""


@dataclass(frozen=True)
class Edge:
    """An edge beyond which a method fails, as it was measured and as theory has it.

    Parameters
    ----------
    what
        The edge, with its unit: ``largest ω dt with local damping 0.5``.
    measured
        Where the method began to fail.
    theory
        Where it must, by theory; None where there is none.
    tolerance
        Relative difference that the experiment allows itself; None without a theory.
    """

    what: str
    measured: float
    theory: float | None = None
    tolerance: float | None = None

    @property
    def error(self) -> float | None:
        """Relative difference of measurement and theory."""
        return None if self.theory is None else abs(self.measured - self.theory) / abs(self.theory)

    @property
    def agrees(self) -> bool | None:
        """Whether measurement and theory agree; None without a theory."""
        if self.error is None or self.tolerance is None:
            return None
        return self.error <= self.tolerance


@dataclass(frozen=True)
class Finding:
    """What an experiment found.

    Parameters
    ----------
    title
        What was driven over its edge, in a few words.
    heads, rows
        The table: heads with units, and every run as a row.
    edges
        Edges measured.
    trust
        Where the method may be trusted, in a sentence or two.
    beyond
        What a user is told beyond: the status and the message of the outcome there.
    draw
        Draws the chart on an empty figure.
    """

    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Entry]]
    edges: Sequence[Edge]
    trust: str
    beyond: str
    draw: Callable[[Figure], None]
