"""Python warnings about likely slips in walls that are about to be analysed."""

from collections.abc import Iterable
from warnings import warn

from .scene import Scene, plausibility


def warn_of_likely_slips(scenes: Iterable[Scene], stacklevel: int = 3) -> None:
    """Issue each warning about some scenes once, by default at the caller of the function that calls this one."""
    for line in dict.fromkeys(line for scene in scenes for line in plausibility.warnings(scene)):
        warn(line, stacklevel=stacklevel)
