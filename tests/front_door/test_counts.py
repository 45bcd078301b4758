"""Counts of tools/count_lines.py for a tree small enough to count by hand."""

import runpy
from pathlib import Path
from typing import Any

import pytest

TOOL = Path(__file__).parents[2] / "tools" / "count_lines.py"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """`runningbond` with two subpackages that import each other, a method, tests, and an old single-file module."""
    files = {
        "runningbond/__init__.py": "",
        "runningbond/compare/__init__.py": "",
        "runningbond/compare/models.py": 'MODELS = {"fem": 1}\n"dem-static in a sentence"\n',
        "runningbond/scene/__init__.py": "from .wall import Wall\n",
        "runningbond/scene/wall.py": "from typing import Any\nfrom runningbond.joints.laws import law\n\n"
        "geometry: tuple[Any, ...]\n",
        "runningbond/joints/__init__.py": "",
        "runningbond/joints/laws.py": "from runningbond.scene import wall\n\ndef law(): from dem import late\n",
        "dem/__init__.py": "",
        "dem/late.py": "from .kernels import PointLoad\n",
        "dem/kernels.py": "import dem.late\n",
        "tests/__init__.py": "1\n2\n3\n",
        "old.py": "1\n",
    }
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    return tmp_path


def test_counts_of_a_small_tree(tree: Path) -> None:
    counted: dict[str, Any] = dict(runpy.run_path(str(TOOL))["report"](tree))
    rooms = {"compare": 2, "scene": 5, "joints": 3, "dem": 2, "old": 1, "front door": 0}
    assert {name: counted[f"lines of {name}"] for name in rooms} == rooms
    assert counted["lines of models + campaigns + draws + compare + studies + commands"] == 2
    assert counted["lines of the package, without tests and benchmarks"] == 13
    assert counted["module cycles"] == (
        "dem.kernels ↔ dem.late; runningbond.joints.laws ↔ runningbond.scene ↔ runningbond.scene.wall"
    )
    assert counted["geometry as tuple[Any, …]"] == 1
    assert counted["files that name a model there is"] == 1
    assert counted["files that name a load there is"] == 1
    assert counted["files of the package that own_law.py touches"] == "no such example"
