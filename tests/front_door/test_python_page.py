"""The code, links and keywords of docs/python.md."""

import re
from pathlib import Path
from typing import Any

import matplotlib
import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "python.md").read_text()


def test_snippets_run_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(matplotlib, "rcParams", matplotlib.rcParams.copy())
    matplotlib.use("Agg")
    names: dict[str, Any] = {}
    snippets = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(snippets[0], names)
    assert repr(names["result"]) in PAGE
    for snippet in snippets[1:]:
        exec(snippet, names)
    import runningbond as rb

    assert rb.read("glued.toml").description == names["glued"].description
    assert names["peak"] >= names["result"].lower * 0.9
    assert list((tmp_path / "sweep").iterdir())


def test_linked_files_exist() -> None:
    for target in re.findall(r"\]\((?!https:)([^)#]+)", PAGE):
        assert (ROOT / "docs" / target).exists(), target


def test_material_keywords_are_documented_keys_of_scene_files() -> None:
    from runningbond.wall import TABLES

    keys = (ROOT / "docs" / "scene-file.md").read_text()
    for key in (key for known in TABLES.values() for key in known if key != "law"):
        assert f"`{key}`" in keys
