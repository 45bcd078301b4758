"""The search by steps of constant load, whatever the wall says to each of them."""

from collections.abc import Callable
from unittest.mock import patch

from hypothesis import given, settings
from hypothesis import strategies as st

from dem.rigid_system import rigid_system
from dynamics import Criteria, LoadSteps, Run, load_steps
from dynamics.run import Verdict
from tests.fem_interface.walls import MORTAR
from tests.walls import panel

FIRST = 0.05
BLOCK = Run(rigid_system(panel(wall__length=0.24, wall__height=0.06, joint__mortar=MORTAR)))


def searched(answer: Callable[[float], Verdict], tolerance: float = 0.005) -> tuple[LoadSteps, list[float]]:
    """Search on a wall that gives an answer to each load, and the loads that were tried."""
    tried: list[float] = []

    def settle(run: Run, state: object, multiplier: float, *_: object, sudden: bool = False) -> Verdict:
        if sudden:
            return "stable"
        tried.append(multiplier)
        assert len(tried) < 500, "no end"
        return answer(multiplier)

    with patch("dynamics.loading.settle", settle), patch("dynamics.loading.ramp"):
        return load_steps(BLOCK, FIRST, tolerance, Criteria(collapse=1.0), most=10.0), tried


def test_falls_on_either_side_of_a_load_without_an_answer_end_it() -> None:
    """Panel 11 neither rested nor fell at 0.25, fell just above it and just below it; that was tried for ever."""

    def answer(multiplier: float) -> Verdict:
        if round(multiplier, 6) == 0.25:
            return "undecided"
        return "stable" if multiplier < 0.24 else "collapse"

    found, _ = searched(answer)
    assert found.lower is not None
    assert found.upper is not None
    assert found.lower < 0.24 <= found.upper
    assert found.upper - found.lower <= 0.005 * found.upper


def test_the_bracket_closes_in_on_loads_without_an_answer() -> None:
    """Loads about the collapse neither hold nor fall: the bracket is theirs, and no answer."""

    def answer(multiplier: float) -> Verdict:
        return "stable" if multiplier < 0.422 else "collapse" if multiplier > 0.427 else "undecided"

    found, tried = searched(answer)
    assert found.verdict == "undecided"
    assert found.lower is not None
    assert found.upper is not None
    assert 0.42 < found.lower < 0.422
    assert 0.427 < found.upper < 0.43
    assert sum(answer(multiplier) == "undecided" for multiplier in tried) <= 4


def test_a_wall_that_never_answers_costs_two_budgets() -> None:
    found, tried = searched(lambda multiplier: "undecided")
    assert (found.lower, found.upper, found.verdict, len(tried)) == (0.0, None, "undecided", 2)


@given(st.data(), st.sampled_from([0.0005, 0.005, 0.05, 0.5]))
@settings(max_examples=300, deadline=None)
def test_a_search_ends_whatever_the_answers(data: st.DataObject, tolerance: float) -> None:
    """Each load that is tried lies inside the bracket so far, which never widens."""
    lower, upper = 0.0, float("inf")

    def answer(multiplier: float) -> Verdict:
        nonlocal lower, upper
        assert lower < multiplier < upper
        verdict: Verdict = data.draw(st.sampled_from(("stable", "collapse", "undecided")))
        if verdict == "stable":
            lower = multiplier
        elif verdict == "collapse":
            upper = multiplier
        return verdict

    found, _ = searched(answer, tolerance)
    assert found.lower == lower
    assert found.upper == (upper if upper < float("inf") else None)
