"""Description of a peer program, independent of whether it is installed."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Peer:
    """A program that could be used for these walls instead of the suite.

    Parameters
    ----------
    name
        Name in the table.
    package
        Name of its distribution, for its version.
    kind
        Kind of model.
    rivals
        Models of the suite of the same kind.
    does, does_not
        Further capabilities, and features that it lacks.
    """

    name: str
    package: str
    kind: str
    rivals: tuple[str, ...]
    does: str
    does_not: str
