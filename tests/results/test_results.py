"""Outcomes: consistency, storage without loss, and detection of damaged files."""

import json
import math
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runningbond.results import Outcome, StoreError, load_outcome, save_outcome, write_atomically
from runningbond.scene import Array

numbers = st.floats(0, 1e6)


@given(
    bracket=st.lists(numbers, min_size=3, max_size=3).map(sorted),
    dofs=st.none() | st.integers(0, 10**6),
    message=st.text(max_size=50),
    rows=st.integers(0, 5),
)
def test_outcome_is_unchanged_by_storage(
    tmp_path_factory: pytest.TempPathFactory, bracket: list[float], dofs: int | None, message: str, rows: int
) -> None:
    folder = tmp_path_factory.mktemp("outcome")
    motion = np.arange(3.0 * rows).reshape(rows, 3) / 7
    lower, multiplier, upper = bracket
    outcome = Outcome(
        "wall", "limit", "collapse", multiplier, lower, upper, dofs, 3, 0.1, message, motion, motion[:, :2]
    )
    save_outcome(outcome, folder, "key")
    back, key = load_outcome(folder)
    assert key == "key"
    assert back.summary() == outcome.summary()
    assert np.array_equal(back.motion, motion)
    assert np.array_equal(back.force, motion[:, :2])


def test_every_field_of_outcome_is_stored(tmp_path: Path) -> None:
    given: dict[str, Any] = {"multiplier": 0.5, "lower": 0.4, "upper": 0.6, "dofs": 6, "steps": 7, "fall": 0.02}
    given |= {each.name: np.full((2, 3), 0.1) for each in fields(Outcome) if each.type is Array}
    given["curve"] = np.full((2, 2), 0.1)
    outcome = Outcome("wall", "limit", "collapse", message="told", path_columns=("a", "b", "c"), **given)
    assert len(given) > 15
    save_outcome(outcome, tmp_path, "key")
    back, _ = load_outcome(tmp_path)
    for each in fields(Outcome):
        assert np.array_equal(getattr(back, each.name), getattr(outcome, each.name)), each.name


@pytest.mark.parametrize(
    "contents",
    [
        {"status": "collapse"},  # a collapse needs a multiplier
        {"status": "undecided", "multiplier": 0.3},  # only a collapse may have one
        {"status": "collapse", "multiplier": 0.3, "lower": 0.4},
        {"status": "collapse", "multiplier": 0.3, "upper": 0.2},
        {"status": "collapse", "multiplier": math.nan},
        {"status": "undecided", "upper": math.inf},
        {"status": "fine"},
    ],
)
def test_inconsistent_outcome_is_refused(contents: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="bracket|multiplier|status"):
        Outcome("wall", "limit", **contents)


def test_numbers_of_numpy_and_lines_of_a_message_can_be_stored(tmp_path: Path) -> None:
    """A user's model that counted its steps with numpy ended the whole sweep with a TypeError of the JSON writer."""
    given = {"multiplier": np.float32(0.5), "lower": np.int64(0), "dofs": np.int64(3), "seconds": np.float64(1.0)}
    outcome = Outcome("wall", "own", "collapse", **given, message="topples\nas one")  # type: ignore[arg-type]
    save_outcome(outcome, tmp_path)
    found, _ = load_outcome(tmp_path)
    assert found.summary() == outcome.summary()
    assert (found.multiplier, found.lower, found.dofs, found.message) == (0.5, 0.0, 3, "topples as one")
    with pytest.raises(ValueError, match="seconds = nan: must be finite"):
        Outcome("wall", "own", "collapse", 0.5, seconds=math.nan)
    with pytest.raises(ValueError, match="dofs = 'many': must be a number"):
        Outcome("wall", "own", "collapse", 0.5, dofs="many")  # type: ignore[arg-type]


def test_repr_of_outcome_is_one_line() -> None:
    """Without its arrays, which would fill pages for a wall of a thousand blocks."""
    shown = repr(Outcome("wall", "limit", "collapse", 0.5, 0.5, 0.5, motion=np.ones((1000, 3))))
    assert "multiplier=0.5" in shown
    assert "\n" not in shown
    assert "1." not in shown


def test_arrays_of_outcome_are_read_only() -> None:
    outcome = Outcome("wall", "limit", "undecided", motion=np.ones((2, 3)))
    with pytest.raises(ValueError, match="read-only"):
        outcome.motion[0, 0] = 2


def stored(folder: Path) -> Path:
    save_outcome(Outcome("wall", "limit", "collapse", 0.5, motion=np.ones((4, 3))), folder, "key")
    return folder


def test_folder_contains_only_record_and_arrays(tmp_path: Path) -> None:
    stored(stored(tmp_path))
    save_outcome(Outcome("wall", "limit", "collapse", 0.6, motion=np.zeros((4, 3))), tmp_path, "key")
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".json", ".npz"]


def test_truncated_files_are_rejected(tmp_path: Path) -> None:
    """A file cut off at any length is never read as complete."""
    stored(tmp_path)
    for path in sorted(tmp_path.iterdir()):
        whole = path.read_bytes()
        for length in range(0, len(whole) - 2, 7):
            path.write_bytes(whole[:length])
            with pytest.raises(StoreError):
                load_outcome(tmp_path)
        path.write_bytes(whole)
    load_outcome(tmp_path)


def test_flipped_bit_in_arrays_is_rejected(tmp_path: Path) -> None:
    stored(tmp_path)
    arrays = next(tmp_path.glob("*.npz"))
    content = bytearray(arrays.read_bytes())
    content[len(content) // 2] ^= 1
    arrays.write_bytes(content)
    with pytest.raises(StoreError, match="vouches"):
        load_outcome(tmp_path)


@pytest.mark.parametrize("record", ["", "[]", "{}", "null", '{"key": 1}', '{"arrays": "x.npz", "sha256": ""}'])
def test_foreign_record_is_rejected(tmp_path: Path, record: str) -> None:
    stored(tmp_path)
    (tmp_path / "outcome.json").write_text(record)
    with pytest.raises(StoreError):
        load_outcome(tmp_path)


def test_failed_write_keeps_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "table.csv"
    write_atomically(path, b"before")

    def broken(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", broken)
    with pytest.raises(OSError, match="space"):
        write_atomically(path, b"after")
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_record_is_plain_json(tmp_path: Path) -> None:
    record = json.loads((stored(tmp_path) / "outcome.json").read_text())
    assert record["multiplier"] == 0.5
    assert record["lower"] is None
