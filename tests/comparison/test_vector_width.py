"""Kernels in wide and in narrow vector registers: the same brackets, to the last bit."""

import json
import os
import platform
import subprocess
import sys

import pytest

from runningbond.compare.published import PUBLISHED

CODE = """
import json, sys
from runningbond.compare.models import run_model
from runningbond.compare.published import published_scene
found = run_model(sys.argv[2], published_scene(sys.argv[1]))
print(json.dumps([found.status, found.lower, found.upper, found.steps]))
"""

NARROW = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "+sse2"}
"""Registers of two numbers, which every x86-64 has."""

SMALL = ("wall-w1", "wall-w2", "wall-w3")
CASES = [
    pytest.param(case.name, model, marks=() if (case.name, model) == ("wall-w1", "dem-dynamic") else pytest.mark.long)
    for case in PUBLISHED
    for model in ("dem-dynamic", "fem")
    if model == "dem-dynamic" or case.name in SMALL
]


def answer(name: str, model: str, environment: dict[str, str]) -> object:
    """Status, bracket and steps of a model on a published wall, in a process of its own."""
    command = [sys.executable, "-c", CODE, name, model]
    done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="names registers of x86-64")
@pytest.mark.parametrize(("name", "model"), CASES)
def test_brackets_do_not_depend_on_the_width_of_registers(name: str, model: str) -> None:
    assert answer(name, model, NARROW) == answer(name, model, {})
