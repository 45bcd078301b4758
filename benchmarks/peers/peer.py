"""What is said of a peer, whether or not it is installed."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Peer:
    """A program that others would take for these walls.

    Parameters
    ----------
    name
        What the table calls it.
    package
        Its distribution, which is asked for its version.
    kind
        What it is a model of.
    rivals
        Models of the suite of its kind.
    does, does_not
        What it can and cannot do beside them.
    """

    name: str
    package: str
    kind: str
    rivals: tuple[str, ...]
    does: str
    does_not: str
