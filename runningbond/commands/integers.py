"""Whole numbers on the command line."""

from collections.abc import Sequence

from cyclopts import Token


def whole(_: type, tokens: Sequence[Token]) -> int:
    """Read a whole number; cyclopts would round any other."""
    if not tokens[0].value.lstrip("+-").isdecimal():
        raise ValueError(f"{tokens[0].value!r} is no whole number")
    return int(tokens[0].value)
