"""Python warnings about likely slips in walls that are about to be analysed."""

import sys
from collections.abc import Iterable
from warnings import warn

from .scene import Scene, plausibility


def warn_of_likely_slips(scenes: Iterable[Scene]) -> None:
    """Issue each warning about some scenes once, at the line outside of this package that asks for the analysis."""
    level = _frames_of_this_package()
    for line in dict.fromkeys(line for scene in scenes for line in plausibility.warnings(scene)):
        warn(line, stacklevel=level)


def _frames_of_this_package() -> int:
    """Number of frames of this package in front of the first other one, which is the `stacklevel` of a caller."""
    level, frame = 0, sys._getframe(1)
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    return level + 1
