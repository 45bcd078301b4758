#!/usr/bin/env python3
"""Print the oldest version of everything that ``pyproject.toml`` asks for, as constraints of pip.

``make test-oldest`` installs these, and runs the tests with them. Only the standard library is needed.
"""

import re
import tomllib
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
REQUIREMENT = re.compile(r"(?P<name>[\w-]+)(\[[\w,]+\])?>=(?P<version>[\d.]+)")

TESTS = ("cluster", "tables", "develop")
"""Optional requirements that the tests have."""


def constraints(project: Path = PROJECT) -> list[str]:
    """A line ``name==version`` for each requirement with a lowest version, of the package and of its tests."""
    table = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    requirements = [*table["dependencies"], *(each for key in TESTS for each in table["optional-dependencies"][key])]
    found = filter(None, map(REQUIREMENT.match, requirements))
    return sorted({f"{each['name']}=={each['version']}" for each in found})


if __name__ == "__main__":
    print("\n".join(constraints()))
