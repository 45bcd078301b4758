"""Quadrature and mesh: blocks rock about the outermost point of a joint, and walls with them."""

import math
from itertools import pairwise

import pytest
from matplotlib.figure import Figure

from runningbond.studies.stability.blocks import INSET, rounded
from runningbond.studies.stability.quadrature import (
    CELLS,
    RULES,
    Case,
    block_case,
    draw,
    edges,
    inset_of,
    wall_cases,
    with_theory,
)


@pytest.fixture(scope="module")
def block() -> list[Case]:
    return [block_case(rule, cells) for rule in RULES for cells in CELLS]


def test_a_block_topples_as_early_as_theory_says(block: list[Case]) -> None:
    """λ = (b/h) (1 − (1 + x) / n) to 1e-3, its bracket half as wide; two Gauss points: 42, 21 and 11 % early."""
    found = edges(block)
    assert len(found) == len(block) == len(RULES) * len(CELLS)
    assert all(edge.agrees for edge in found)
    early = [1 - case.multiplier / case.reference for case in block if case.rule == "Gauss 2"]
    assert early == pytest.approx([(1 - 1 / math.sqrt(3)) / n for n in CELLS], abs=1e-3)
    assert early == pytest.approx([0.42, 0.21, 0.11], abs=0.006)


def test_the_error_of_gauss_points_goes_as_the_length_of_the_elements(block: list[Case]) -> None:
    """First order in h, with two and with three points; none with points at the ends."""
    for rule in ("Gauss 2", "Gauss 3"):
        early = [1 - case.multiplier / case.reference for case in block if case.rule == rule]
        for coarse, fine in pairwise(early):
            assert math.log2(coarse / fine) == pytest.approx(1.0, abs=0.02)
    ends = [abs(1 - case.multiplier / case.reference) for case in block if case.rule in ("Lobatto 2", "Simpson")]
    assert max(ends) < 1e-3


def test_points_keep_from_the_ends_of_a_wall_s_joints_as_the_theory_counts_them() -> None:
    """Of 160 mm between insets the outermost Gauss point is 33.8 mm in; Lobatto's are at the insets."""
    scene = rounded("wall-w1")
    assert inset_of(scene, RULES["Gauss 2"], 1) == pytest.approx(0.02 + 0.16 * 0.2113249, abs=1e-8)
    assert inset_of(scene, RULES["Gauss 2"], 2) == pytest.approx(0.02 + 0.08 * 0.2113249, abs=1e-8)
    assert {inset_of(scene, RULES["Simpson"], cells) for cells in CELLS} == {INSET}


def test_a_wall_with_gauss_points_falls_as_one_with_its_contacts_as_far_in() -> None:
    """W1, by another solver: .474 with one cell, .540 with two, where points at the ends of the joints have .586."""
    scene = rounded("wall-w1")
    cases = [with_theory(case, scene) for case in wall_cases("W1", scene, [("Gauss 2", 1), ("Gauss 2", 2)])]
    cases += wall_cases("W1", scene, [("Lobatto 2", 1)])
    assert all(edge.agrees for edge in edges(cases))
    coarse, fine, ends = (case.multiplier for case in cases)
    assert coarse < 0.85 * ends
    assert coarse < fine < 0.95 * ends
    assert ends == pytest.approx(0.5856, rel=0.005)
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    draw(figure, cases)
    assert len(figure.axes) == 3
