"""A law's kernel of a user's own is compiled anew when it changes, though the loop around it does not."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

LOOP = """
from runningbond.joints.compiled import kernel
import law

def around(inner):
    @kernel
    def loop(x):
        return 10.0 * inner(x)
    return loop

print(around(law.law)(1.0))
"""

LAW = """
from runningbond.joints.compiled import kernel
FACTOR = {factor}

@kernel
def helper(x):
    return {helper} * x

@kernel
def law(x):
    return FACTOR * helper(x) + {shift}
"""


@pytest.mark.parametrize(
    "changed", [{"factor": 2.0}, {"helper": 2.0}, {"shift": 10.0}], ids=["constant", "helper", "source"]
)
def test_loop_around_a_changed_law_is_compiled_anew(tmp_path: Path, changed: dict[str, float]) -> None:
    """Exact: 10 (factor · helper · 1 + shift), before and after one of them changes."""
    (tmp_path / "loop.py").write_text(LOOP)
    surroundings = {**os.environ, "PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    before = {"factor": 1.0, "helper": 1.0, "shift": 0.0}
    for numbers in (before, before | changed):
        (tmp_path / "law.py").write_text(LAW.format(**numbers))
        answer = subprocess.run(
            [sys.executable, "loop.py"], cwd=tmp_path, env=surroundings, capture_output=True, text=True, check=True
        )
        assert float(answer.stdout) == 10 * (numbers["factor"] * numbers["helper"] + numbers["shift"])
