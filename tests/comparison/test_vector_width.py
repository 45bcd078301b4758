"""Wide and narrow vector registers, with a linear algebra library for each: bitwise equal brackets."""

import json
import os
import platform
import subprocess
import sys

import pytest

from runningbond.compare.published import PUBLISHED

BRACKET = """
import json, sys
from runningbond.models import run_model
from runningbond.compare.published import published_scene
answers = []
for cell in sys.argv[1:]:
    found = run_model(cell.split(":")[1], published_scene(cell.split(":")[0]))
    answers.append([found.status, found.lower, found.upper, found.steps])
print(json.dumps(answers))
"""

MODES = """
import hashlib, json, sys
from fem_interface.modal_wall import modal_wall
from fem_interface.system import system_of
from runningbond.compare.published import published_scene
digests = []
for name in sys.argv[1:]:
    system = system_of(modal_wall(published_scene(name)))
    parts = system.mass, system.stiffness, system.viscosity, system.live, *system.interface.geometry.tables[:3]
    digests.append([hashlib.sha256(part.tobytes()).hexdigest() for part in parts])
print(json.dumps(digests))
"""

SHAKEN = """
import json, math, sys
from dataclasses import replace
from dem.finite_system import finite_system
from runningbond.compare.published import published_scene
from runningbond.joints.wall_law import with_impacts
from runningbond.response import Resting, follow
from runningbond.scene import History, Load
from runningbond.scene.history import pulse
scene = published_scene(sys.argv[1])
ground = History(*pulse("sine", 6.0, 0.4), interval=0.01)
scene = with_impacts(replace(scene, load=Load(live=(ground,))))
found = follow(Resting.of(scene, "dem-dynamic", finite_system(scene)), 1.0, rows=20)
print(json.dumps([found.verdict, found.peak_drift, len(found.time)]))
"""

NARROW = {
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "+sse2",
    "OPENBLAS_CORETYPE": "Prescott",
    "NPY_DISABLE_CPU_FEATURES": "AVX2 FMA3 AVX512F AVX512_SKX X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_NUM_THREADS": "1",
}
"""Registers of two numbers, which every x86-64 has, in kernels and in NumPy's linear algebra and functions."""

WIDE = {"OPENBLAS_NUM_THREADS": "2"}
"""The machine's own registers and more than one thread, whatever the tests are run with."""

MODELS = ("limit-nonassociated", "dem-static", "dem-dynamic", "fem")
CASES = [f"{case.name}:{model}" for case in PUBLISHED for model in MODELS]


def answer(code: str, environment: dict[str, str], *arguments: str) -> object:
    """Output of a program run in a separate process."""
    command = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


x86 = pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="names registers of x86-64")


@x86
@pytest.mark.long
@pytest.mark.parametrize("cell", CASES)
def test_brackets_do_not_depend_on_the_width_of_registers(cell: str) -> None:
    """Status, bracket and steps of models on published walls; linear programs of a search count as steps."""
    assert answer(BRACKET, NARROW, cell) == answer(BRACKET, WIDE, cell)


@x86
def test_modes_do_not_depend_on_the_width_of_registers() -> None:
    """Square blocks with equal bending modes in both directions, pinned blocks, and scaled masses."""
    names = ("panel-03", "point-load-1", "wall-w1")
    assert answer(MODES, NARROW, *names) == answer(MODES, WIDE, *names)


@x86
@pytest.mark.long
def test_response_does_not_depend_on_the_width_of_registers() -> None:
    """With many contact searches, impacts, and time steps from the current highest frequency."""
    assert answer(SHAKEN, NARROW, "wall-w1") == answer(SHAKEN, WIDE, "wall-w1")
