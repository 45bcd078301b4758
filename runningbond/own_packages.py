"""The top-level packages of methods, whose names a user's own files and folders may have too."""

import sys
from importlib.util import find_spec
from pathlib import Path

HOUSE = Path(__file__).resolve().parents[1]
PACKAGES = {
    "dem": ("dem",),
    "fem_interface": ("dem", "fem_interface", "meshing"),
    "homog": ("homog",),
    "meshing": ("meshing",),
}
"""The packages, each with those that its models import; deformable blocks are compared with rigid ones."""


def prefer_to_folders() -> None:
    """Make Python find the packages if folders without code, such as those of results, have the same names.

    In an editable installation Python would import such a folder, which comes first, as an empty package.
    """
    if any(other.is_dir() for other in _taken_instead().values()):
        sys.path.append(str(HOUSE))


def prefer_to_files() -> None:
    """Make Python find the packages before a user's files, in a process that runs only the suite."""
    if _taken_instead():
        sys.path.insert(0, str(HOUSE))


def hidden_package(module: str) -> str | None:
    """The error message if Python would import a user's file in place of a package that a module needs, else None.

    The file is not overridden, because the user's own scripts may import it.
    """
    needed = PACKAGES.get(module.split(".")[0], tuple(PACKAGES))
    for name, other in _taken_instead().items():
        if name in needed:
            return f"{other} would be imported in place of the suite's package {name}: let it have another name"
    return None


def _taken_instead() -> dict[str, Path]:
    """Files and folders that would be imported in place of packages, by the packages' names."""
    found = {name: _place(name) for name in PACKAGES}
    return {name: place for name, place in found.items() if place is not None and HOUSE not in place.parents}


def _place(name: str) -> Path | None:
    """The file of a package, or the first folder of a package without one."""
    if name in sys.modules:
        where = getattr(sys.modules[name], "__file__", None)
        return None if where is None else Path(where).resolve()
    spec = find_spec(name)
    if spec is None:
        return None
    places = [spec.origin, *(spec.submodule_search_locations or ())]
    return next((Path(place).resolve() for place in places if place is not None), None)
