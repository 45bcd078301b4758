"""Tables on terminals that are narrower than they are: in parts, so that no cell is cut off."""

from collections.abc import Sequence

from rich.cells import cell_len
from rich.table import Table
from rich.text import Text

from runningbond.pictures.sheet import Sheet

FRAME = 3
"""Characters that the border and padding add to the width of a column; the table has one more."""


def tables_of(sheet: Sheet, width: int) -> list[Table]:
    """A sheet as one table or, if it does not fit without breaking words, as several with the first column repeated."""
    cells = [[head, *(row[k] for row in sheet.rows)] for k, head in enumerate(sheet.heads)]
    least = [max(cell_len(word) for cell in column for word in (cell.split() or [""])) for column in cells]
    whole = [max(cell_len(line) for cell in column for line in (cell.splitlines() or [""])) for column in cells]
    parts: list[list[int]] = [[]]
    for column in range(1, len(cells)):
        if parts[-1] and 1 + sum(least[k] + FRAME for k in (0, *parts[-1], column)) > width:
            parts.append([])
        parts[-1].append(column)
    tables = []
    for number, part in enumerate(parts):
        columns = [0, *part]
        fitted = _fitted([least[k] for k in columns], [whole[k] for k in columns], width - 1 - FRAME * len(columns))
        title = sheet.title if not number else f"{sheet.title} (continued)"
        table = Table(title=Text(title), title_justify="left")
        for k, size in zip(columns, fitted, strict=True):
            table.add_column(Text(sheet.heads[k]), width=size, overflow="fold")
        for row in sheet.rows:
            table.add_row(*(Text(row[k]) for k in columns))
        tables.append(table)
    return tables


def _fitted(least: Sequence[int], whole: Sequence[int], room: int) -> list[int]:
    """Widths of columns in a room: whole if possible, else the widest are reduced, those of long words last."""
    widths = list(whole)
    while sum(widths) > room:
        slack = [k for k, size in enumerate(widths) if size > least[k]] or [
            k for k, size in enumerate(widths) if size > 1
        ]
        if not slack:
            break
        widths[max(slack, key=widths.__getitem__)] -= 1
    return widths
