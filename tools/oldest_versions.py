#!/usr/bin/env python3
"""Print the oldest version of every requirement in ``pyproject.toml``, as constraints for pip.

``make test-oldest`` installs these versions and runs the tests with them. Only the standard library is needed.
"""

import re
import tomllib
from pathlib import Path

PROJECT = Path(__file__).parents[1] / "pyproject.toml"
REQUIREMENT = re.compile(r"(?P<name>[\w-]+)(\[[\w,]+\])?>=(?P<version>[\d.]+)")

TESTS = ("cluster", "tables", "develop")
"""Groups of optional requirements that the tests need."""


def constraints(project: Path = PROJECT) -> list[str]:
    """Lines ``name==version`` for each requirement of the package and its tests that has a lower bound."""
    table = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    requirements = [*table["dependencies"], *(each for key in TESTS for each in table["optional-dependencies"][key])]
    found = filter(None, map(REQUIREMENT.match, requirements))
    return sorted({f"{each['name']}=={each['version']}" for each in found})


if __name__ == "__main__":
    print("\n".join(constraints()))
