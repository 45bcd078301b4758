"""The page of all experiments, and what they say together."""

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from runningbond.compare.table import Sheet
from runningbond.studies import Rows, Study
from runningbond.studies.page import Block, agreement, section
from runningbond.studies.store import failures

Measured: TypeAlias = Sequence[tuple[Study, Rows]]
"""Experiments and their rows."""


def summary(measured: Measured) -> Sheet:
    """Experiment by experiment: where the method may be trusted, and what a user gets beyond."""
    heads = ("experiment", "what is driven", "edges", "may be trusted where", "beyond it you get")
    sound = [(study, rows) for study, rows in measured if not failures(rows)]
    body = [(one.name, one.title, agreement(one.edges(rows)), one.trusted, one.beyond) for one, rows in sound]
    return Sheet("Where each method may be trusted", heads, body)


def page(measured: Measured, folder: Path) -> list[Block]:
    """The page; charts are drawn into a folder."""
    sections = [block for study, rows in measured if not failures(rows) for block in section(study, rows, folder)]
    return ["# Where the methods fail", summary(measured), *sections, *failed(measured)]


def off(measured: Measured) -> list[str]:
    """Edges that do not lie where theory has them."""
    edges = [(study.name, edge) for study, rows in measured if not failures(rows) for edge in study.edges(rows)]
    wrong = [(name, edge) for name, edge in edges if edge.agrees is False]
    return [f"{name}: {edge.what}: measured {edge.measured:.6g}, by theory {edge.theory:.6g}" for name, edge in wrong]


def failed(measured: Measured) -> list[str]:
    """Experiments that ended in an error, and its words."""
    return [f"{study.name} ended in an error: {words}" for study, rows in measured for words in failures(rows)]
