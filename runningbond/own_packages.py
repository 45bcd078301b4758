"""The packages of methods, which stand beside this one under names that a user's own files and folders may have too."""

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
"""The packages, each with those that its models need: deformable blocks ask rigid ones for a second opinion."""


def prefer_to_folders() -> None:
    """Let Python find the packages where folders without code have their names, as those that results are kept in.

    Of an editable installation it would take such a folder, which comes first, for a package that is empty.
    """
    if any(other.is_dir() for other in _taken_instead().values()):
        sys.path.append(str(HOUSE))


def prefer_to_files() -> None:
    """Let Python find the packages before anything of a user's, in a process that runs the suite and nothing else."""
    if _taken_instead():
        sys.path.insert(0, str(HOUSE))


def hidden_package(module: str) -> str | None:
    """What is to be said where Python would import a file of a user's in place of a package that a module needs.

    None where it would not. The user's own scripts may import that file, so it is not replaced.
    """
    needed = PACKAGES.get(module.split(".")[0], tuple(PACKAGES))
    for name, other in _taken_instead().items():
        if name in needed:
            return f"{other} would be imported in place of the suite's package {name}: let it have another name"
    return None


def _taken_instead() -> dict[str, Path]:
    """What would be imported in place of packages, by their names."""
    found = {name: _place(name) for name in PACKAGES}
    return {name: place for name, place in found.items() if place is not None and HOUSE not in place.parents}


def _place(name: str) -> Path | None:
    """The file that a package is made from, or the first folder of one that has none."""
    if name in sys.modules:
        where = getattr(sys.modules[name], "__file__", None)
        return None if where is None else Path(where).resolve()
    spec = find_spec(name)
    if spec is None:
        return None
    places = [spec.origin, *(spec.submodule_search_locations or ())]
    return next((Path(place).resolve() for place in places if place is not None), None)
