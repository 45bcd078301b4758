"""Every example of docs/gallery runs as it is, and draws."""

import runpy
import warnings
from pathlib import Path

import matplotlib
import pytest

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"
EXAMPLES = sorted(GALLERY.glob("*/*.py"))
SLOW_MODELS = ("dem", "fem", "limit-nonassociated")
"""Parts of the names of slow models: examples that contain one of them are marked as long."""


def name(path: Path) -> str:
    return path.relative_to(GALLERY).as_posix()


def test_gallery_has_thirty_short_examples() -> None:
    assert len(EXAMPLES) >= 30
    for path in EXAMPLES:
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 30, name(path)


def takes_seconds(path: Path) -> bool:
    return any(word in path.read_text(encoding="utf-8") for word in SLOW_MODELS)


@pytest.mark.parametrize(
    "path",
    [pytest.param(x, id=name(x), marks=[pytest.mark.long] if takes_seconds(x) else []) for x in EXAMPLES],
)
def test_example_runs_and_draws(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib.pyplot as plt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(matplotlib, "rcParams", matplotlib.rcParams.copy())
    matplotlib.use("Agg")
    plt.close("all")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        runpy.run_path(str(path), run_name="__main__")
    drawn = plt.get_fignums()
    plt.close("all")
    assert drawn
