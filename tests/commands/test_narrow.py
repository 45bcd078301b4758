"""Tables on narrow terminals: no number is cut off."""

import io
import re

import pytest
from rich.console import Console

from runningbond.commands.narrow import tables_of
from runningbond.pictures.sheet import Sheet

MODELS = ["homog", "limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem"]
ANSWERS = ["0.5477", "0.6000", "0.4771 – 0.4997", "216,951 – 217,191", "0.5997 – 0.6030", "undecided"]
COMPARISON = Sheet("panels", ["scene", "title", *MODELS], [["panel-01", "H/L = 0.5, b/a = 4", *ANSWERS]] * 2)


def printed(sheet: Sheet, width: int) -> str:
    console = Console(width=width, file=io.StringIO(), color_system=None)
    for table in tables_of(sheet, width):
        console.print(table)
    return str(console.file.getvalue())  # type: ignore[attr-defined]


@pytest.mark.parametrize("width", [40, 60, 80, 100, 180])
def test_no_word_of_a_table_is_cut_off(width: int) -> None:
    """At 80 characters a comparison of six models read "0.60…"."""
    said = printed(COMPARISON, width)
    assert max(map(len, said.splitlines())) <= width
    assert "…" not in said
    for word in " ".join([*COMPARISON.heads, *COMPARISON.rows[0]]).split():
        assert re.search(rf"(?<!\S){re.escape(word)}(?!\S)", said), word


def test_parts_of_a_table_repeat_its_first_column() -> None:
    tables = tables_of(COMPARISON, 60)
    heads = [[str(column.header) for column in table.columns] for table in tables]
    assert len(heads) > 1
    assert {own[0] for own in heads} == {"scene"}
    assert [head for own in heads for head in own[1:]] == COMPARISON.heads[1:]
    assert [str(table.title) for table in tables[:2]] == ["panels", "panels (continued)"]


def test_wide_enough_table_is_in_one_part() -> None:
    (table,) = tables_of(COMPARISON, 180)
    assert len(table.columns) == len(COMPARISON.heads)


def test_words_longer_than_the_terminal_are_broken() -> None:
    said = printed(Sheet("", ["quantity", "value"], [["file", "x" * 90]]), 40)
    assert max(map(len, said.splitlines())) <= 40
    assert said.count("x") == 90
