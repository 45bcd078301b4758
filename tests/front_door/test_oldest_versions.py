"""tools/oldest_versions.py lists a lowest version for every dependency of the package, for tests with these."""

import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_every_requirement_has_an_oldest_version() -> None:
    tool = [sys.executable, str(ROOT / "tools" / "oldest_versions.py")]
    lines = subprocess.run(tool, capture_output=True, text=True, check=True).stdout.split()
    oldest = dict(line.split("==") for line in lines)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    asked = [each.split(">=")[0] for each in project["dependencies"]]
    assert set(asked) <= set(oldest)
    assert tuple(map(int, oldest["scikit-fem"].split("."))) >= (
        12,
        0,
        2,
    )  # before, its Lamé parameters of plane stress were other numbers
