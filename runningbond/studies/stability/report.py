"""The page of all experiments, and what they say together."""

from collections.abc import Sequence
from pathlib import Path
from typing import TypeAlias

from runningbond.compare.table import Sheet
from runningbond.studies import Rows, Study
from runningbond.studies.page import Block, agreement, section
from runningbond.studies.store import failures

Findings: TypeAlias = Sequence[tuple[Study, Rows]]
"""Experiments and their rows."""


def summary(found: Findings) -> Sheet:
    """Experiment by experiment: where the method may be trusted, and what a user gets beyond."""
    heads = ("experiment", "what is driven", "edges", "may be trusted where", "beyond it you get")
    rows = [
        (study.name, study.title, agreement(study.edges(rows)), study.trusted, study.beyond)
        for study, rows in found
        if not failures(rows)
    ]
    return Sheet("Where each method may be trusted", heads, rows)


def page(found: Findings, folder: Path) -> list[Block]:
    """The page; charts are drawn into a folder."""
    blocks: list[Block] = ["# Where the methods fail", summary(found)]
    for study, rows in found:
        if not failures(rows):
            blocks += section(study, rows, folder)
    return [*blocks, *failed(found)]


def off(found: Findings) -> list[str]:
    """Edges that do not lie where theory has them."""
    edges = [(study.name, edge) for study, rows in found if not failures(rows) for edge in study.edges(rows)]
    return [
        f"{name}: {edge.what}: measured {edge.measured:.6g}, by theory {edge.theory:.6g}"
        for name, edge in edges
        if edge.agrees is False
    ]


def failed(found: Findings) -> list[str]:
    """Experiments that ended in an error, and its words."""
    return [f"{study.name} ended in an error: {words}" for study, rows in found for words in failures(rows)]
