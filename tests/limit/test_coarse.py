"""Search for certificates over macro-blocks: gluing, neighbourhoods, proofs in the full wall, limits and interrupts."""

import numpy as np
import pytest

from runningbond.compare import published_scene
from runningbond.limit import equilibrium, limit, limit_nonassociated
from runningbond.limit.canonical import canonical_order
from runningbond.limit.certificates import Certificate, certified_loads, certify
from runningbond.limit.coarse import COARSE_POINTS, CoarseSearch, finest, is_worth
from runningbond.limit.descent import Descent, jump_pattern
from runningbond.limit.equilibrium import Equilibrium
from runningbond.limit.force_program import ForceSolution, coulomb, solve_forces
from runningbond.limit.neighbourhood import neighbourhood
from runningbond.limit.nonassociated import _proved_again
from runningbond.limit.search import search
from runningbond.limit.search_log import SearchLog
from runningbond.scene import Array, Scene
from tests.at_length import at_length
from tests.limit.test_search import rubble

CERTIFIED = {"wall-w2": 0.557416, "wall-w4": 0.263736, "panel-04": 0.0892857}
"""Lowest loads certified by the search over the full wall, as benchmarks/limit_search.py prints them."""


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
def test_coarse_search_finds_lowest_load_of_full_search(name: str) -> None:
    scene = published_scene(name)
    looked = coarse(scene)
    looked.run()
    assert looked.found.lowest * looked.system.live_unit == pytest.approx(CERTIFIED[name], rel=2e-6)
    assert looked.found.highest * looked.system.live_unit <= (limit(scene).upper or 0.0) * (1 + 1e-5)


def test_certificates_are_proved_in_full_wall(found_in_w2: CoarseSearch) -> None:
    """Loads agree with exact certificates to 1e-5 where the search has them from interior points."""
    assert len(found_in_w2.found.certificates) > 2
    for each in found_in_w2.found.certificates:
        exact = certify(found_in_w2.system, each.motion)
        assert exact is not None
        assert each.least.multiplier == pytest.approx(exact.least.multiplier, rel=1e-5)
        assert each.most.multiplier == pytest.approx(exact.most.multiplier, rel=1e-5)


@pytest.mark.parametrize("freedoms", [12, 30, 60])
def test_glued_wall_has_wider_load_interval(freedoms: int, found_in_w2: CoarseSearch) -> None:
    """Glued joints carry any force, so the interval of loads on a mechanism contains that of the full wall."""
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


@pytest.mark.parametrize(("name", "needed"), [("wall-w3", 2), *at_length(("panel-12", 3))])
def test_loads_between_lowest_and_highest_certificate_are_proved(name: str, needed: int) -> None:
    """The search knows some of them from interior points only; those needed for the certified loads are proved."""
    looked = coarse(published_scene(name), starts=1)
    looked.run()
    system = equilibrium(published_scene(name)).under_live_load()
    proved = _proved_again(system, system, canonical_order(system), looked.found)
    assert len(looked.found.certificates) >= len(proved) == needed
    for forces in [forces for each in proved for forces in (each.least, each.most)]:
        assert np.abs(unbalanced(system, forces)).max() < 1e-11 * forces.pressure.max()
    loads = certified_loads(proved, lambda multiplier: multiplier)
    for each in looked.found.certificates:
        low, high = each.least.multiplier + 1e-6, each.most.multiplier - 1e-6
        assert any(first <= low and high <= last for first, last in loads)


def test_finest_glues_as_little_as_freedoms_allow(found_in_w2: CoarseSearch) -> None:
    system, place = found_in_w2.system, found_in_w2.place
    jumps, last = 10.0 ** np.random.default_rng(0).uniform(-4.5, 0.0, len(system.points)), 0
    for freedoms in (0, 30, 60, 120, 1000):
        glued = finest(system, place, jumps, freedoms)
        left = 0 if glued is None else glued.system.freedoms
        assert last <= left <= freedoms
        last = left
    assert last == system.freedoms


def test_certificate_holds_in_its_neighbourhood(found_in_w2: CoarseSearch) -> None:
    """The motion is unchanged, the forces balance what is left, and larger neighbourhoods have more freedoms."""
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
        assert unbalanced(glued.system, known.least) == pytest.approx(0.0, abs=1e-5)


def unbalanced(system: Equilibrium, forces: ForceSolution) -> Array:
    """Residual of the equilibrium equations for forces."""
    normal = system.strength.tension - forces.pressure
    balance = system.opening @ normal + system.slip @ forces.tangential
    return np.asarray(balance - forces.multiplier * system.live - system.dead)


@pytest.mark.parametrize("seed", [3, *at_length(10, 11)])
def test_coarse_search_ignores_mirroring_order_and_scale(seed: int) -> None:
    """Also with two workers. The numbers of programs agree because glued equations are rounded."""
    images = (rubble(seed), rubble(seed, mirrored=True, shuffled=1), rubble(seed, shuffled=2, size=2.7))
    looked = [coarse(scene, most=40) for scene in images] + [coarse(images[0], most=40, workers=2)]
    loads = []
    for each in looked:
        each.run()
        loads.append((each.found.lowest * each.system.live_unit, each.found.highest * each.system.live_unit))
    assert loads[1:] == [pytest.approx(loads[0], rel=1e-6)] * 3
    assert [each.found.programs for each in looked[1:]] == [looked[0].found.programs] * 3


@pytest.mark.parametrize(("points", "parts"), [(0, True), (COARSE_POINTS, False)])
def test_large_walls_use_coarse_search(points: int, parts: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the requested numbers of starts and programs."""
    looked: list[CoarseSearch] = []
    run = CoarseSearch.run

    def seen(self: CoarseSearch) -> SearchLog:
        looked.append(self)
        return run(self)

    monkeypatch.setattr(CoarseSearch, "run", seen)
    monkeypatch.setattr("runningbond.limit.nonassociated.COARSE_POINTS", points)
    outcome = limit_nonassociated(published_scene("wall-w2"), starts=1)
    assert outcome.lower is not None
    assert "from 1 starts" in outcome.message
    assert [(each.starts, each.most, len(each.found.certificates) > 0) for each in looked] == [(1, None, True)] * parts


@pytest.mark.long
def test_coarse_search_ends_at_cost_limit() -> None:
    """Programs over parts are weighted by their freedoms: thousands cost as much as a few hundred full ones."""
    scene = published_scene("wall-w2")
    usual, short, shortest = coarse(scene), coarse(scene, most=20), coarse(scene, most=1)
    for each in (usual, short, shortest):
        each.run()
    assert shortest.found.programs == 1
    assert 0 < short.found.cost < 20 + 40  # the current search is completed
    assert short.found.cost < usual.found.cost < 0.5 * usual.found.programs
    assert usual.found.lowest <= short.found.lowest


def test_interrupt_keeps_certificates(monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[int] = []
    look = CoarseSearch._search_glued

    def interrupted(self: CoarseSearch, *arguments: object) -> None:
        look(self, *arguments)  # type: ignore[arg-type]
        looks.append(len(self.found.certificates))
        if looks[-1]:
            raise KeyboardInterrupt

    monkeypatch.setattr(CoarseSearch, "_search_glued", interrupted)
    monkeypatch.setattr("runningbond.limit.nonassociated.COARSE_POINTS", 0)
    outcome = limit_nonassociated(published_scene("wall-w2"))
    assert outcome.status == "collapse"
    assert "interrupted" in outcome.message
    assert outcome.lower is not None


def test_interrupt_in_neighbourhood_keeps_certificates(monkeypatch: pytest.MonkeyPatch) -> None:
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


def test_refused_certificate_does_not_hide_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """If the lowest mechanism is refused every time, another one is found, and the refused one is not kept."""
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


def test_full_wall_is_searched_if_nothing_is_glued(monkeypatch: pytest.MonkeyPatch) -> None:
    """No freedoms are allowed for glued walls. The neighbourhood of the certificate found is searched as well."""
    around: list[SearchLog] = []
    monkeypatch.setattr("runningbond.limit.nonassociated.COARSE_POINTS", 0)
    monkeypatch.setattr("runningbond.limit.coarse.finest", lambda *arguments: None)

    def go_on(self: CoarseSearch) -> SearchLog:
        around.append(self.found)
        return self.found

    monkeypatch.setattr(CoarseSearch, "go_on", go_on)
    outcome = limit_nonassociated(published_scene("wall-w3"), starts=1)
    assert outcome.lower == pytest.approx(0.35582, abs=1e-5)  # as in tests/limit/test_search.py
    assert [found.lowest for found in around] == pytest.approx([0.35582], abs=1e-5)


def test_gain_worth_proof_exceeds_interior_point_accuracy() -> None:
    assert is_worth(np.inf, 0.3)
    assert is_worth(0.3, -np.inf)
    assert is_worth(0.3 + 2e-5, 0.3)
    assert not is_worth(0.3 + 1e-6, 0.3)
    assert not is_worth(0.3, 0.3)
    assert not is_worth(np.inf, np.inf)


@pytest.mark.long
def test_rare_mechanism_is_found_in_neighbourhood() -> None:
    """W6 with an inset of 20 mm: 0.2710 to four digits, which one start in a hundred of the full search reaches."""
    looked = coarse(published_scene("wall-w6").with_joint(inset=0.02))
    looked.run()
    assert looked.found.lowest * looked.system.live_unit <= 0.27105
