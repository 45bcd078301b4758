"""What the digest of an outcome knows of."""

import ast
import sys
from importlib import import_module
from importlib.metadata import packages_distributions
from pathlib import Path

from runningbond.campaigns.fingerprint import COMPUTING_ROOMS, LIBRARIES

OWN = {"runningbond", "meshing", "fem_interface", "dem", "homog"}
OTHERS = {"threadpoolctl", "filelock", "ezdxf", "meshio"}
"""Of threads and locks, and of files: what is read from a drawing is in the digest as a scene."""


def test_no_library_that_computes_is_left_out() -> None:
    """A library of another version may give other numbers: each that a room which computes imports is in the digest."""
    imported = set()
    for room in COMPUTING_ROOMS:
        for source in Path(str(import_module(room).__file__)).parent.rglob("*.py"):
            for node in ast.walk(ast.parse(source.read_text("utf-8"))):
                if isinstance(node, ast.Import):
                    imported |= {alias.name.partition(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                    imported.add(node.module.partition(".")[0])
    foreign = imported - OWN - set(sys.stdlib_module_names)
    assert {"numpy", "clarabel", "highspy"} <= foreign
    distributions = packages_distributions()
    assert {name for module in foreign for name in distributions[module]} - OTHERS <= set(LIBRARIES)
