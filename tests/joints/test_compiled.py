"""Compiled kernels are cached for other processes, and never confused with one another."""

import math
import os
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numba.core.caching import IndexDataCacheFile

from runningbond.joints.compiled import SharedCache, compilation, kernel

ROOT = Path(__file__).parents[2]


@kernel
def doubled(x: float) -> float:
    return 2.0 * x


@kernel
def tripled(x: float) -> float:
    return 3.0 * x


def plus_one(law: Callable[[float], float]) -> Any:
    """A kernel closed over another one, like the interpolation along joints."""

    @kernel
    def loop(x: float) -> float:
        return law(x) + 1.0

    return loop


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr("runningbond.joints.compiled.FOLDER", str(tmp_path))
    return tmp_path


@pytest.mark.long
def test_kernel_closed_over_another_is_cached_for_next_process(tmp_path: Path) -> None:
    """Two processes, two laws in one loop: the second process recompiles neither and gets both right."""
    program = """
from tests.joints.test_compiled import doubled, plus_one, tripled
loops = plus_one(doubled), plus_one(tripled)
print([loop(5.0) for loop in loops], sum(len(loop.stats.cache_misses) for loop in loops))
"""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    line = [sys.executable, "-c", program]
    printed = [subprocess.run(line, env=environment, capture_output=True, text=True).stdout for _ in range(2)]
    assert printed == ["[11.0, 16.0] 2\n", "[11.0, 16.0] 0\n"]


def test_cache_depends_on_source_not_on_install_path(tmp_path: Path) -> None:
    """The cache key is the source of the package, not its location; it includes files that the kernel may call."""
    program = """
from runningbond.joints.coulomb import shear_within
shear_within(1.0, 0.0, 0.5)
print(len(shear_within.stats.cache_misses))
"""
    places = [ROOT, tmp_path / "elsewhere", tmp_path / "changed"]
    for place in places[1:]:
        for room in ("runningbond", "dem", "fem_interface"):
            shutil.copytree(ROOT / room, place / room, ignore=shutil.ignore_patterns("__pycache__", "walls"))
    with (places[2] / "runningbond" / "joints" / "points.py").open("a") as source:
        source.write("# changed\n")
    printed = []
    for place in places:
        environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": str(place)}
        line = [sys.executable, "-c", program]
        done = subprocess.run(line, env=environment, cwd=tmp_path, capture_output=True, text=True)
        printed.append(done.stdout)
    assert printed == ["1\n", "0\n", "1\n"]


def ramp(factor: float) -> Any:
    """A kernel that is long and called often, so that its caller does not inline it; both depend on a number."""

    @kernel
    def raised(x: Any) -> None:
        for i in range(x.size):
            x[i] += factor
        for i in range(x.size):
            x[i] += math.sin(factor * x[i]) * math.exp(-x[i]) / math.sqrt(1.0 + x[i] ** 2)
        for i in range(x.size - 1):
            x[i] = x[i] + x[i + 1]

    @kernel
    def loop(x: Any) -> float:
        raised(x)
        raised(x[:5])
        raised(x[3:])
        raised(x[1:])
        return float(x[0])

    return loop


@pytest.mark.long
def test_kernels_of_two_processes_are_not_confused_by_a_third(tmp_path: Path) -> None:
    """Numba numbers functions per process: the first functions of one source get the same symbol in both processes."""
    program = """
import numpy as np
from tests.joints.test_compiled import ramp
print([ramp(float(k))(np.ones(8)) for k in {}])
"""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(ROOT)}
    two, three, both, turned = (
        subprocess.run(
            [sys.executable, "-c", program.format(k)], env=environment, capture_output=True, text=True
        ).stdout
        for k in ([2], [3], [2, 3], [3, 2])
    )
    assert float(two[1:-2]) != float(three[1:-2])
    assert both == f"{two[:-2]}, {three[1:]}"
    assert turned == f"{three[:-2]}, {two[1:]}"


def test_two_kernels_saved_at_once_do_not_share_a_file(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each thread waits between reading and writing the index; otherwise both would choose the same file name."""
    loops = plus_one(doubled), plus_one(tripled)
    caches = [SharedCache(loop.py_func) for loop in loops]
    for loop in loops:
        loop._cache.disable()
        loop(1.0)
    met = threading.Barrier(2, timeout=0.5)

    def dwelling(self: IndexDataCacheFile, overloads: Any) -> None:
        with suppress(threading.BrokenBarrierError):
            met.wait()
        save(self, overloads)

    save = IndexDataCacheFile._save_index
    monkeypatch.setattr(IndexDataCacheFile, "_save_index", dwelling)
    compiled = [next(iter(loop.overloads.values())) for loop in loops]
    savers = [
        threading.Thread(target=shared.save_overload, args=(code.signature, code))
        for shared, code in zip(caches, compiled, strict=True)
    ]
    for saver in savers:
        saver.start()
    for saver in savers:
        saver.join()
    assert len(set(caches[0]._cache_file._load_index().values())) == 2
    assert len(list(cache.rglob("*.nbc"))) == 2


def test_damaged_or_full_cache_only_costs_compilation(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert plus_one(doubled)(5.0) == 11.0
    for path in cache.rglob("*.nb?"):
        path.write_bytes(path.read_bytes()[:-5])
    again = plus_one(doubled)
    assert again(5.0) == 11.0
    assert again.stats.cache_misses
    assert not plus_one(doubled).stats.cache_misses, "is mended"

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(IndexDataCacheFile, "_save_data", full)
    assert plus_one(tripled)(5.0) == 16.0


def test_unreadable_kernel_does_not_affect_others_of_its_source(cache: Path) -> None:
    """A loop over a user's law whose module is gone is stored next to the loops over all other laws."""
    assert plus_one(doubled)(5.0) == 11.0
    assert plus_one(tripled)(5.0) == 16.0
    loops = sorted(cache.rglob("*loop*.nbc"))
    assert len(loops) == 2
    loops[0].write_bytes(b"no kernel")
    first, second = plus_one(doubled), plus_one(tripled)
    assert (first(5.0), second(5.0)) == (11.0, 16.0)
    assert first.stats.cache_misses
    assert not second.stats.cache_misses
    assert not plus_one(doubled).stats.cache_misses, "is mended"


def test_new_kernel_folder_replaces_the_oldest(tmp_path: Path) -> None:
    """Folders that are no kernel folders stay."""
    cache = tmp_path / "runningbond"
    names = [f"{k:016x}" for k in range(7)]
    for k, name in enumerate([*names, "mine", "0123"]):
        (cache / name / "dem").mkdir(parents=True)
        os.utime(cache / name, (k, k))
    own = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment = own | {"XDG_CACHE_HOME": str(tmp_path), "PYTHONPATH": str(ROOT)}
    program = "from runningbond.joints.coulomb import shear_within\nshear_within(1.0, 0.0, 0.5)"
    for _ in range(2):
        subprocess.run([sys.executable, "-c", program], env=environment, check=True, capture_output=True)
        (new,) = {path.name for path in cache.iterdir()} - {*names, "mine", "0123"}
        assert {path.name for path in cache.iterdir()} == {*names[-4:], "mine", "0123", new}
        assert list((cache / new).rglob("*.nbc"))


def test_kernels_are_compiled_without_a_writable_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("runningbond.joints.compiled.FOLDER", str(tmp_path / "file"))
    monkeypatch.setattr(
        "numba.core.caching._CacheLocator.ensure_cache_path", lambda self: (_ for _ in ()).throw(OSError)
    )
    assert plus_one(doubled)(5.0) == 11.0


def test_other_kernels_of_user_stay_in_numba_default_cache(tmp_path: Path) -> None:
    """Otherwise the package would delete them together with its own kernels of other versions."""
    (tmp_path / "mine.py").write_text(
        "from runningbond.joints import compiled\nimport numba\n"
        "@numba.njit(cache=True)\ndef half(x):\n    return x / 2\n"
        "print(half(5.0), bool(numba.config.CACHE_DIR))\n"
    )
    own = {name: value for name, value in os.environ.items() if name != "NUMBA_CACHE_DIR"}
    environment = own | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "mine.py"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.stdout == "2.5 False\n", done.stderr
    assert list((tmp_path / "__pycache__").glob("mine.half*.nbc"))


def test_changed_custom_law_is_recompiled(tmp_path: Path) -> None:
    """The loop over the law is in another, unchanged file; the law's own code may be unchanged but not its constant."""
    program = "from mine import law\nfrom tests.joints.test_compiled import plus_one\nprint(plus_one(law)(5.0))"
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache"), "PYTHONPATH": f"{ROOT}:{tmp_path}"}
    text = "from runningbond.joints.compiled import kernel\nK = {}\n@kernel\ndef law(x):\n    return {} * x\n"
    printed = []
    for k, code in ((1.0, "2.0"), (1.0, "3.0"), (4.0, "K"), (5.0, "K")):
        (tmp_path / "mine.py").write_text(text.format(k, code))
        line = [sys.executable, "-B", "-c", program]
        printed.append(subprocess.run(line, env=environment, capture_output=True, text=True).stdout)
    assert printed == ["11.0\n", "16.0\n", "21.0\n", "26.0\n"]


def test_user_without_home_has_kernels_and_scenes_but_no_drawing(tmp_path: Path) -> None:
    """No HOME and no entry in the password file: code that needs a user folder reports this or does without."""
    program = """
import pwd
pwd.getpwuid = lambda uid: {}[uid]
from pathlib import Path
from runningbond.scene import SceneError, scene_from_dict
from tests.joints.test_compiled import doubled
from tests.walls import content
scene_from_dict(content())
Path("wall.dxf").write_text("")
try:
    scene_from_dict(content(wall={"drawing": "wall.dxf", "units": "mm", "thickness": 0.1}))
except SceneError as error:
    print(doubled(2.0), str(error).splitlines()[0])
"""
    variables = {"HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "NUMBA_CACHE_DIR"}
    environment = {name: value for name, value in os.environ.items() if name not in variables}
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment | {"PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.stdout.startswith("4.0 wall.drawing = 'wall.dxf': "), done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["wall.dxf"]


@pytest.mark.usefixtures("cache")
def test_compilation_time_is_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With a clock that ticks when read: once for a kernel including the kernels it calls; zero without compilation."""
    monkeypatch.setattr("runningbond.joints.compiled.time", SimpleNamespace(process_time=count().__next__))
    loop = ramp(3.0)
    with compilation() as compiled:
        for _ in range(2):
            loop(np.ones(8))
            assert compiled.seconds == 1
    ramp(4.0)(np.ones(8))
    assert compiled.seconds == 1
