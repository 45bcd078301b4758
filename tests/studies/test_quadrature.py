"""Quadrature and mesh: blocks and walls rotate about the outermost integration point of a joint."""

import math
from itertools import pairwise

import pytest

from runningbond.studies import Row
from runningbond.studies.stability.quadrature import CELLS, EARLY, RULES, inset_of, measure
from runningbond.studies.walls import INSET, inset_wall


@pytest.fixture(scope="module")
def block() -> dict[tuple[str, int], Row]:
    return {(rule, cells): measure("block", rule, cells) for rule in RULES for cells in CELLS}


def early(block: dict[tuple[str, int], Row], rule: str) -> list[float]:
    """Relative underestimate of the toppling load for a rule, on successively finer meshes."""
    return [1 - block[rule, cells][EARLY] for cells in CELLS]


@pytest.mark.long
def test_block_topples_early_by_the_exact_amount(block: dict[tuple[str, int], Row]) -> None:
    """λ = (b/h) (1 − (1 + x) / n) to 1e-3, with brackets half as wide; two Gauss points: 42, 21 and 11 % early."""
    for row in block.values():
        assert row["measured"] == pytest.approx(row["theory"], rel=1e-3)
    assert early(block, "Gauss 2") == pytest.approx([(1 - 1 / math.sqrt(3)) / n for n in CELLS], abs=1e-3)
    assert early(block, "Gauss 2") == pytest.approx([0.42, 0.21, 0.11], abs=0.006)


@pytest.mark.long
def test_error_of_gauss_points_is_first_order_in_element_length(block: dict[tuple[str, int], Row]) -> None:
    """With two and with three points; no error with points at the ends."""
    for rule in ("Gauss 2", "Gauss 3"):
        for coarse, fine in pairwise(early(block, rule)):
            assert math.log2(coarse / fine) == pytest.approx(1.0, abs=0.02)
    assert max(abs(part) for rule in ("Lobatto 2", "Simpson") for part in early(block, rule)) < 1e-3


def test_distance_of_outermost_points_from_joint_ends() -> None:
    """Of 160 mm between insets, the outermost Gauss point is 33.8 mm inside; Lobatto points are at the insets."""
    scene = inset_wall("wall-w1")
    assert inset_of(scene, RULES["Gauss 2"], 1) == pytest.approx(0.02 + 0.16 * 0.2113249, abs=1e-8)
    assert inset_of(scene, RULES["Gauss 2"], 2) == pytest.approx(0.02 + 0.08 * 0.2113249, abs=1e-8)
    assert {inset_of(scene, RULES["Simpson"], cells) for cells in CELLS} == {INSET}


@pytest.mark.long
def test_gauss_points_give_the_load_of_contacts_moved_inwards() -> None:
    """W1, by another solver: .474 with one cell, .540 with two, and .586 for points at the joint ends."""
    rows = [measure("W1", "Gauss 2", 1), measure("W1", "Gauss 2", 2), measure("W1", "Lobatto 2", 1)]
    for row in rows:
        assert row["measured"] == pytest.approx(row["theory"], rel=5e-3)
    coarse, fine, ends = (row["measured"] for row in rows)
    assert coarse < 0.85 * ends
    assert coarse < fine < 0.95 * ends
    assert ends == pytest.approx(0.5856, rel=0.005)
