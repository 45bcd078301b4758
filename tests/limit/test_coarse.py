"""The search over parts of a wall: what it may leave out, what it proves, and what it finds."""

import numpy as np
import pytest

from runningbond.compare import published_scene
from runningbond.limit import equilibrium, limit, limit_nonassociated
from runningbond.limit.canonical import canonical_order
from runningbond.limit.certificates import Certificate, certify
from runningbond.limit.coarse import POINTS, CoarseSearch, finest, is_worth
from runningbond.limit.descent import Descent, jump_pattern
from runningbond.limit.equilibrium import Equilibrium
from runningbond.limit.force_program import ForceSolution, coulomb, solve_forces
from runningbond.limit.neighbourhood import neighbourhood
from runningbond.limit.search import search
from runningbond.limit.search_log import SearchLog
from runningbond.scene import Array, Scene
from tests.at_length import at_length
from tests.limit.test_search import rubble

CERTIFIED = {"wall-w2": 0.557416, "wall-w4": 0.263736, "panel-04": 0.0892857}
"""Lowest loads that the search over the wall itself certifies, as benchmarks/limit_search.py prints them."""


def ordered(scene: Scene) -> tuple[Equilibrium, Array]:
    system = equilibrium(scene).under_live_load()
    order = canonical_order(system)
    return order.applied(system), order.places(scene)


def coarse(scene: Scene, **settings: float) -> CoarseSearch:
    return CoarseSearch(*ordered(scene), observe=lambda found: None, **settings)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def found_in_w2() -> CoarseSearch:
    looked = coarse(published_scene("wall-w2"))
    looked.run()
    return looked


@pytest.mark.parametrize("name", ["wall-w4", "panel-04", *at_length("wall-w2")])
def test_parts_hold_the_lowest_certificate_of_small_walls(name: str) -> None:
    scene = published_scene(name)
    looked = coarse(scene)
    looked.run()
    assert looked.found.lowest * looked.system.live_unit == pytest.approx(CERTIFIED[name], rel=2e-6)
    assert looked.found.highest * looked.system.live_unit <= (limit(scene).upper or 0.0) * (1 + 1e-5)


def test_all_that_is_found_is_proved_in_the_wall(found_in_w2: CoarseSearch) -> None:
    """Exactly, where the search has it from interior points."""
    assert len(found_in_w2.found.certificates) > 2
    for each in found_in_w2.found.certificates:
        exact = certify(found_in_w2.system, each.motion)
        assert exact is not None
        assert each.least.multiplier == pytest.approx(exact.least.multiplier, rel=1e-5)
        assert each.most.multiplier == pytest.approx(exact.most.multiplier, rel=1e-5)


@pytest.mark.parametrize("freedoms", [12, 30, 60])
def test_loads_that_drive_a_mechanism_in_the_wall_do_so_in_the_glued_wall(
    freedoms: int, found_in_w2: CoarseSearch
) -> None:
    """What is glued bears anything, so that the interval is not smaller there; forces that are none there are none."""
    system, place = found_in_w2.system, found_in_w2.place
    jumps = np.abs(system.jumps(solve_forces(system, coulomb(system.strength)).motion)).max(axis=0)
    glued = finest(system, place, jumps / jumps.max(), freedoms)
    assert glued is not None
    found = search(glued.system, solve_forces(glued.system, coulomb(glued.system.strength)), 20)
    assert found.certificates
    proved = 0
    for each in found.certificates:
        whole, parts = certify(system, glued.motions @ each.motion), certify(glued.system, each.motion)
        assert parts is not None
        if whole is not None:
            proved += 1
            assert parts.least.multiplier <= whole.least.multiplier + 1e-9
            assert parts.most.multiplier >= whole.most.multiplier - 1e-9
    assert proved or freedoms < 60


def test_as_little_is_glued_as_leaves_so_many_freedoms(found_in_w2: CoarseSearch) -> None:
    system, place = found_in_w2.system, found_in_w2.place
    jumps, last = 10.0 ** np.random.default_rng(0).uniform(-4.5, 0.0, len(system.points)), 0
    for freedoms in (0, 30, 60, 120, 1000):
        glued = finest(system, place, jumps, freedoms)
        left = 0 if glued is None else glued.system.freedoms
        assert last <= left <= freedoms
        last = left
    assert last == system.freedoms


def test_a_certificate_is_one_of_its_neighbourhood(found_in_w2: CoarseSearch) -> None:
    """It moves as in the wall, and its forces balance what is left; a larger neighbourhood has more freedoms."""
    system, place, best = found_in_w2.system, found_in_w2.place, found_in_w2.found.best
    assert best is not None
    largest, last = np.abs(best.motion).max(), 0
    moving = np.abs(system.jumps(best.motion)).max(axis=0) > 1e-7 * largest
    for freedoms in (120, 140, 165):
        glued = neighbourhood(system, place, moving, moving, freedoms)
        assert glued is not None
        assert last < glued.system.freedoms <= freedoms
        last = glued.system.freedoms
        known = glued.certificate(best)
        assert glued.motions @ known.motion == pytest.approx(best.motion, abs=1e-9 * largest)
        assert unbalanced(glued.system, known) == pytest.approx(0.0, abs=1e-5)


def unbalanced(system: Equilibrium, certificate: Certificate) -> Array:
    """What the forces of a certificate at its least load leave unbalanced."""
    forces = certificate.least
    normal = system.strength.tension - forces.pressure
    balance = system.opening @ normal + system.slip @ forces.tangential
    return np.asarray(balance - forces.multiplier * system.live - system.dead)


@pytest.mark.parametrize("seed", [3, *at_length(10, 11)])
def test_a_wall_and_its_mirrored_shuffled_and_scaled_images_are_searched_alike(seed: int) -> None:
    """By as many programs, and by two workers too, for glued equations have lost their last bits."""
    images = (rubble(seed), rubble(seed, mirrored=True, shuffled=1), rubble(seed, shuffled=2, size=2.7))
    looked = [coarse(scene, most=40) for scene in images] + [coarse(images[0], most=40, workers=2)]
    loads = []
    for each in looked:
        each.run()
        loads.append((each.found.lowest * each.system.live_unit, each.found.highest * each.system.live_unit))
    assert loads[1:] == [pytest.approx(loads[0], rel=1e-6)] * 3
    assert [each.found.programs for each in looked[1:]] == [looked[0].found.programs] * 3


@pytest.mark.parametrize(("points", "parts"), [(0, True), (POINTS, False)])
def test_larger_walls_are_searched_in_parts_first(points: int, parts: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the starts and programs that are asked for."""
    looked: list[CoarseSearch] = []
    run = CoarseSearch.run

    def seen(self: CoarseSearch) -> SearchLog:
        looked.append(self)
        return run(self)

    monkeypatch.setattr(CoarseSearch, "run", seen)
    monkeypatch.setattr("runningbond.limit.nonassociated.POINTS", points)
    outcome = limit_nonassociated(published_scene("wall-w2"), starts=1)
    assert outcome.lower is not None
    assert "from 1 starts" in outcome.message
    assert [(each.starts, each.most, len(each.found.certificates) > 0) for each in looked] == [(1, None, True)] * parts


@pytest.mark.long
def test_a_search_ends_once_it_has_cost_so_much() -> None:
    """What programs over parts cost is counted by their freedoms: thousands of them as a few hundred of the wall's."""
    scene = published_scene("wall-w2")
    usual, short, shortest = coarse(scene), coarse(scene, most=20), coarse(scene, most=1)
    for each in (usual, short, shortest):
        each.run()
    assert shortest.found.programs == 1
    assert 0 < short.found.cost < 20 + 40  # what was begun is ended
    assert short.found.cost < usual.found.cost < 0.5 * usual.found.programs
    assert usual.found.lowest <= short.found.lowest


def test_an_interrupt_keeps_what_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[int] = []
    look = CoarseSearch._look

    def interrupted(self: CoarseSearch, *arguments: object) -> None:
        look(self, *arguments)  # type: ignore[arg-type]
        looks.append(len(self.found.certificates))
        if looks[-1]:
            raise KeyboardInterrupt

    monkeypatch.setattr(CoarseSearch, "_look", interrupted)
    monkeypatch.setattr("runningbond.limit.nonassociated.POINTS", 0)
    outcome = limit_nonassociated(published_scene("wall-w2"))
    assert outcome.status == "collapse"
    assert "interrupted" in outcome.message
    assert outcome.lower is not None


def test_an_interrupt_in_a_neighbourhood_keeps_what_was_found_there(monkeypatch: pytest.MonkeyPatch) -> None:
    looked = coarse(rubble(3))
    looked.found.certificates = search(
        looked.system, solve_forces(looked.system, coulomb(looked.system.strength)), 1
    ).certificates
    before = looked.found.lowest
    least, found = Descent.least, list[float]()

    def interrupted(self: Descent, motion: Array) -> ForceSolution | None:
        if min(found, default=np.inf) < before - 1e-3 and jump_pattern(self.system, motion) not in self.known:
            raise KeyboardInterrupt
        forces = least(self, motion)
        found.append(np.inf if forces is None else forces.multiplier)
        return forces

    monkeypatch.setattr(Descent, "least", interrupted)
    looked.go_on()
    assert looked.found.interrupted
    assert looked.found.lowest < before - 1e-3
    assert looked.found.programs > 0


def test_what_cannot_be_proved_exactly_hides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a wall whose lowest mechanism is refused each time, another one is found; the refused one is not kept."""
    free = coarse(rubble(3))
    free.run()
    lowest = free.found.lowest

    def refused(system: Equilibrium, motion: Array) -> Certificate | None:
        certificate = certify(system, motion)
        return None if certificate is None or certificate.least.multiplier < lowest + 1e-4 else certificate

    monkeypatch.setattr("runningbond.limit.coarse.certify", refused)
    looked = coarse(rubble(3))
    looked.run()
    assert lowest + 1e-4 < looked.found.lowest < np.inf


def test_walls_of_no_parts_are_searched_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    """With no freedoms allowed to what is glued; the neighbourhood of what is found then is searched as well."""
    around: list[SearchLog] = []
    monkeypatch.setattr("runningbond.limit.nonassociated.POINTS", 0)
    monkeypatch.setattr("runningbond.limit.coarse.finest", lambda *arguments: None)

    def go_on(self: CoarseSearch) -> SearchLog:
        around.append(self.found)
        return self.found

    monkeypatch.setattr(CoarseSearch, "go_on", go_on)
    outcome = limit_nonassociated(published_scene("wall-w3"), starts=1)
    assert outcome.lower == pytest.approx(0.35582, abs=1e-5)  # as in tests/limit/test_search.py
    assert [found.lowest for found in around] == pytest.approx([0.35582], abs=1e-5)


def test_what_is_worth_a_proof_is_larger_by_more_than_interior_points_tell() -> None:
    assert is_worth(np.inf, 0.3)
    assert is_worth(0.3, -np.inf)
    assert is_worth(0.3 + 2e-5, 0.3)
    assert not is_worth(0.3 + 1e-6, 0.3)
    assert not is_worth(0.3, 0.3)
    assert not is_worth(np.inf, np.inf)


@pytest.mark.long
def test_a_rare_mechanism_is_found_in_the_neighbourhood_of_a_frequent_one() -> None:
    """W6 inset by 20 mm, .2710 to four digits: one start in a hundred of the search over the wall leads to it."""
    looked = coarse(published_scene("wall-w6").with_joint(inset=0.02))
    looked.run()
    assert looked.found.lowest * looked.system.live_unit <= 0.27105
