"""Names in the reference exist; tested here because building the documentation takes minutes."""

import re
from collections.abc import Iterator
from importlib import import_module
from operator import attrgetter
from pathlib import Path

import pytest

DIRECTIVE = re.compile(r"^\.\. (currentmodule|auto\w+):: ([\w.]+)", re.MULTILINE)


def named() -> Iterator[str]:
    """Full names of the documented objects, in the order of the pages."""
    for page in sorted((Path(__file__).parents[2] / "docs").rglob("*.rst")):
        module = ""
        for directive, name in DIRECTIVE.findall(page.read_text(encoding="utf-8")):
            if directive == "currentmodule":
                module = f"{name}."
            else:
                yield name if "." in name else module + name


NAMES = sorted(set(named()))


def test_pages_name_something() -> None:
    assert len(NAMES) > 50


@pytest.mark.parametrize("name", NAMES)
def test_documented_name_exists(name: str) -> None:
    parts = name.split(".")
    for k in range(len(parts), 0, -1):  # a function may have the name of its module
        try:
            module = import_module(".".join(parts[:k]))
        except ModuleNotFoundError:
            continue
        break
    assert k == len(parts) or attrgetter(".".join(parts[k:]))(module) is not None
