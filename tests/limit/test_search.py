"""Search for the smallest certified load: loads found, proofs of certificates, and invariances."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import Voronoi
from shapely.geometry import Polygon, box
from shapely.geometry.polygon import orient

import runningbond as rb
from runningbond.compare import published_scene
from runningbond.limit import LimitState, equilibrium, limit, limit_nonassociated, limit_state
from runningbond.limit.canonical import canonical_order
from runningbond.limit.certificates import driving_forces
from runningbond.limit.descent import Descent, is_lower
from runningbond.limit.force_program import coulomb, frozen_friction, solve_forces
from runningbond.limit.programs import Programs, Vertices
from runningbond.limit.search import dry_allowed, search
from runningbond.limit.search_log import SearchLog
from runningbond.limit.starts import ROUND, Start
from runningbond.pictures.progress import SearchProgress
from runningbond.results import save_outcome
from runningbond.scene import Array, BlockMaterial, JointMaterial, Lateral, Load, Scene, build_scene, scene_from_dict
from tests.at_length import at_length
from tests.checker import check
from tests.limit.test_limit import pile, rectangle
from tests.random_scenes import mirrored as mirror_image
from tests.walls import content, panel

SIZE, CELLS = 2.0, 5


def cells(seed: int) -> list[Array]:
    """Voronoi cells of points on a disturbed grid, which fill a square."""
    rng = np.random.default_rng(seed)
    step = SIZE / CELLS
    at = [((i + 0.5 + (j % 2) * 0.5 - 0.25) * step, (j + 0.5) * step) for j in range(CELLS) for i in range(CELLS)]
    points = np.array([[x + rng.uniform(-0.25, 0.25) * step, y + rng.uniform(-0.25, 0.25) * step] for x, y in at])
    images = [
        points,
        points * [-1, 1],
        points * [1, -1],
        [2 * SIZE, 0] + points * [-1, 1],
        [0, 2 * SIZE] + points * [1, -1],
    ]
    diagram, square = Voronoi(np.vstack(images)), box(0, 0, SIZE, SIZE)
    inside = [diagram.vertices[diagram.regions[region]] for region in diagram.point_region[: len(points)]]
    return [np.array(orient(Polygon(cell).intersection(square)).exterior.coords)[:-1].round(4) for cell in inside]


def rubble(seed: int, *, mirrored: bool = False, shuffled: int | None = None, size: float = 1.0) -> Scene:
    """Such cells as a dry wall that is pushed sideways."""
    blocks = [size * cell for cell in cells(seed)]
    if mirrored:
        blocks = [(cell * [-1, 1])[::-1] for cell in blocks]
    if shuffled is not None:
        blocks = [blocks[i] for i in np.random.default_rng(shuffled).permutation(len(blocks))]
    live = Lateral((-1.0 if mirrored else 1.0, 0.0))
    material = {"block": BlockMaterial(1800.0), "joint": JointMaterial(0.75), "load": Load(live=(live,))}
    return build_scene("rubble", blocks, thickness=0.12, **material)  # type: ignore[arg-type]


@pytest.mark.parametrize(("seed", "part"), [(1, 0.8), *at_length((3, 0.87))])
def test_more_starts_certify_far_smaller_loads(seed: int, part: float) -> None:
    """The first start finds only the associated load; all starts certify one that is a `part` of it.

    The search may miss the lowest mechanisms: with other random numbers that of the second wall is far smaller.
    """
    scene = rubble(seed)
    bound = limit(scene).multiplier or 0.0
    one, all_ = limit_nonassociated(scene, starts=1), limit_nonassociated(scene)
    assert one.lower == pytest.approx(bound, rel=1e-6)
    assert all_.lower is not None
    assert all_.lower < part * bound
    assert all_.upper == pytest.approx(bound, rel=1e-6)


@pytest.mark.parametrize(("name", "starts"), [("panel-02", 64), ("wall-w3", 188), ("wall-w1", 198)])
def test_small_walls_are_given_more_starts(name: str, starts: int) -> None:
    """The 204 joint points of W3 leave 64 * 600 / 204 starts in vain; W1 has fewer, twice its 99 freedoms."""
    assert dry_allowed(equilibrium(published_scene(name)).under_live_load()) == starts


def test_start_continues_from_one_of_the_round_before(monkeypatch: pytest.MonkeyPatch) -> None:
    """The four starts of a round begin at the vertices where those of the round before ended, the first four at one."""
    begun: dict[int, Vertices] = {}
    ended: dict[int, Vertices] = {}

    def run(start: Start, programs: Programs) -> None:
        begun[start.number] = start.vertices
        original(start, programs)
        ended[start.number] = start.vertices

    original = Start.run
    monkeypatch.setattr(Start, "run", run)
    system = equilibrium(published_scene("wall-w3")).under_live_load()
    search(system, solve_forces(system, coulomb(system.strength)), starts=11)
    assert begun[0] == (None, None, None)
    for number in range(1, 11):
        assert begun[number] is ended[max(0, number - ROUND)]


REFERENCE_LOADS = {
    ("wall-w4", 0.02): 0.2462,
    ("wall-w6", 0.0): 0.2918,
    ("wall-w6", 0.02): 0.2710,
}
"""Loads of walls with openings by inset [m], certified to four digits by another search over random pressures."""


@pytest.mark.long
@pytest.mark.parametrize(("name", "inset"), REFERENCE_LOADS)
def test_rare_mechanisms_of_walls_with_openings_are_found(name: str, inset: float) -> None:
    """One start in a hundred finds them; a wall of 146 blocks takes half a minute."""
    outcome = limit_nonassociated(published_scene(name).with_joint(inset=inset))
    assert outcome.lower is not None
    assert outcome.lower <= REFERENCE_LOADS[name, inset] + 5e-5


@pytest.mark.long
def test_true_friction_halves_load_of_panel_with_upright_blocks() -> None:
    """75 blocks, twelve wide and six high, H/L = 2, b/a = 1/4: 0.0717, against an associated bound of 0.1391."""
    scene = rb.Wall.running_bond(
        length=1.44, height=2.88, block_width=0.12, block_height=0.48, thickness=0.12, density=1800.0, friction=0.6
    ).scene
    outcome = limit_nonassociated(scene)
    assert scene.wall.sum() == 75
    assert outcome.lower is not None
    assert outcome.lower <= 0.07175
    assert outcome.upper == pytest.approx(0.1391, abs=5e-5)


@pytest.mark.long
def test_search_ends_after_given_number_of_programs() -> None:
    """It ends with the round in which they were solved; a longer search finds no larger load."""
    scene = published_scene("wall-w4")
    short, usual = limit_nonassociated(scene, programs=1), limit_nonassociated(scene)
    assert usual.lower is not None
    assert short.lower is not None
    assert (short.steps or 0) < 0.5 * (usual.steps or 0)
    assert usual.lower <= short.lower


@pytest.mark.parametrize(("most", "starts"), [(0, 1), (10_000, 33)])
def test_search_without_certificate_makes_one_more_round(most: int, starts: int) -> None:
    """After the limit of cost, or enough starts in vain, interior points decide on mechanisms in four more starts."""
    live = {"kind": "point", "at": [0.12, 0.12], "force": [0, -1]}
    size = {"wall__length": 0.48, "wall__height": 0.12, "wall__first_course": "half"}
    system = equilibrium(panel(**size, support__kind="pinned-corners", load={"gravity": 9.81, "live": live}))
    found = search(system, limit_state(system).forces, most=most)
    assert not found.certificates
    assert found.starts == starts + ROUND


def test_search_ignores_mirroring_order_and_scale() -> None:
    first = limit_nonassociated(rubble(3), starts=20)
    for other in (rubble(3, mirrored=True, shuffled=1), rubble(3, shuffled=2, size=2.7)):
        again = limit_nonassociated(other, starts=20)
        assert (again.lower, again.upper) == pytest.approx((first.lower, first.upper), rel=1e-6)
        assert again.steps == first.steps


@pytest.mark.parametrize("mirrored", [False, True])
def test_ordered_equations_are_identical_to_last_bit(mirrored: bool) -> None:
    one, other = (
        canonical_order(system).applied(system)
        for system in (equilibrium(rubble(1)), equilibrium(rubble(1, mirrored=mirrored, shuffled=4)))
    )
    for name in ("opening", "slip", "reaction", "tie"):
        assert (getattr(one, name).toarray() == getattr(other, name).toarray()).all(), name
    assert (one.dead == other.dead).all()
    assert (one.live == other.live).all()


def same_numbers(one: dict[str, Any], other: dict[str, Any]) -> None:
    """Assert that the ordered equations of two walls are equal to the last bit."""
    systems = [equilibrium(scene_from_dict(tables)).under_live_load() for tables in (one, other)]
    first, second = (canonical_order(system).applied(system) for system in systems)
    for name in ("opening", "slip", "reaction", "tie"):
        assert (getattr(first, name).toarray() == getattr(second, name).toarray()).all(), name
    for name in ("friction", "tension", "shear"):
        assert (getattr(first.strength, name) == getattr(second.strength, name)).all(), name


def test_ordered_equations_ignore_size_of_wall_under_a_level_beam() -> None:
    """The reaction that keeps a beam level is a moment, the others are forces."""
    beam = {"height": 0.2, "condition": "fixed-height", "force": [0.0, -100.0]}
    sizes = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.1}
    large = {name: 3.7 * size for name, size in sizes.items()}
    same_numbers(
        content(wall=sizes | {"courses": [[1, 1], [0.5, 1, 0.5]]}, beam=beam),
        content(
            wall=large | {"courses": [[1, 1], [0.5, 1, 0.5]]},
            beam=beam | {"height": 3.7 * 0.2, "force": [0.0, -100.0 * 3.7**3]},
        ),
    )


@pytest.mark.parametrize("kind", ["fixed-first-course", "pinned-corners"])
def test_ordered_equations_ignore_mirroring_on_any_support(kind: str) -> None:
    """Joints of several lengths with fixed blocks end at one point, and horizontal reactions change their sign."""
    wall = {"block_width": 1.0, "block_height": 0.25, "thickness": 0.1}
    courses = [[0.5, 0.75, 1, 0.75], [1, 1.25, 0.75], [0.5, 2, 0.5]]
    tables = content(
        wall=wall | {"courses": courses},
        joint={"friction": 0.7, "cohesion": 1e4},
        support={"kind": kind},
        load={"gravity": 9.81, "live": {"kind": "point", "at": [2.4, 0.75], "force": [3.0, -1.0]}},
    )
    same_numbers(tables, mirror_image(tables))


@pytest.mark.parametrize(
    "changes",
    [
        {
            "load": {
                "gravity": 9.81,
                "live": {"kind": "settlement", "box": [[0.9, -9.0], [9.0, 0.01]], "by": [-0.2, -0.5]},
            }
        },
        {"joints": {"rough": {"friction": 0.9}}, "assign": [{"joint": "rough", "box": [[0.0, 0.0], [1.0, 0.4]]}]},
        {"tie": [{"from": [0.25, 0.375], "to": [-1.0, 0.375], "area": 1e-4, "young": 2e11, "yield": 5.0}]},
    ],
    ids=["support", "joints", "tie"],
)
def test_ordered_equations_ignore_mirroring_where_blocks_and_loads_are_symmetric(changes: dict[str, Any]) -> None:
    """Then joints, ties, or the support that moves, choose between a wall and its mirror image."""
    wall = {"block_width": 1.0, "block_height": 0.25, "thickness": 0.1, "courses": [[1, 1], [0.5, 1, 0.5]]}
    down = {"kind": "point", "at": [1.0, 0.5], "force": [0.0, -1.0]}
    tables = content(wall=wall, **({"load": {"gravity": 9.81, "live": down}} | changes))
    same_numbers(tables, mirror_image(tables))


def test_motion_of_ordered_equations_is_restored() -> None:
    system = equilibrium(rubble(1))
    order = canonical_order(system)
    ordered, motion = order.applied(system), np.random.default_rng(0).normal(size=system.freedoms)
    restored = order.restored(motion)
    assert system.opening.T @ restored == pytest.approx(
        (ordered.opening.T @ motion)[np.argsort(order.points)], abs=1e-7
    )
    assert system.live @ restored == pytest.approx(ordered.live @ motion, abs=1e-7)


@pytest.mark.parametrize("name", ["rubble", "wall-w3"])
def test_both_loads_of_certificate_drive_its_mechanism(name: str) -> None:
    """Also if the upper load comes from the forces of the certificate from which the descent started."""
    system = equilibrium(rubble(3) if name == "rubble" else published_scene(name))
    found = search(system, limit_state(system).forces, 20)
    assert len(found.certificates) > 1
    for each in found.certificates:
        assert each.least.multiplier <= each.most.multiplier * (1 + 1e-9)
        opening, slip = system.opening.T @ each.motion, system.slip.T @ each.motion
        largest = abs(each.motion).max()
        assert opening.min() > -1e-6 * largest
        opens, slides = opening > 1e-5 * largest, abs(slip) > 1e-5 * largest
        for forces in (each.least, each.most):
            measures, scale = LimitState(system, forces), forces.pressure.max()
            normal = system.strength.tension - forces.pressure
            unbalanced = system.opening @ normal + system.slip @ forces.tangential
            unbalanced = unbalanced - forces.multiplier * system.live - system.dead
            assert abs(unbalanced).max() < 1e-6 * scale
            assert measures.system.strength.violation(normal, forces.tangential).max() < 1e-6 * scale
            assert abs(forces.pressure[opens]).max(initial=0.0) < 1e-6 * scale
            at_limit = np.sign(slip) * system.strength.friction * forces.pressure
            assert abs(forces.tangential - at_limit)[slides].max(initial=0.0) < 1e-6 * scale


def test_mix_of_mechanisms_may_close_joints_by_as_much_as_counts_as_still() -> None:
    """A block that slides and sinks by a little: interpenetration as a mechanism, an inaccuracy as a rough mix."""
    system = equilibrium(pile([rectangle(0, 0, 0.5, 1.2)], 0.1))
    sinks = np.array([1.0, -5e-5, 0.0]) / system.scale
    assert driving_forces(system, sinks) is None
    assert driving_forces(system, sinks, still=1e-4) is not None
    assert driving_forces(system, sinks, still=1e-5) is None


def test_descent_finds_smaller_load_than_sequence() -> None:
    """W3 without inset: 0.35582 from the first start's 0.36031; the message counts starts and programs."""
    outcome = limit_nonassociated(published_scene("wall-w3"), starts=1)
    assert outcome.lower == pytest.approx(0.35582, abs=1e-5)
    assert outcome.multiplier == outcome.lower
    assert "smaller ones are not excluded" in outcome.message
    assert f"from 1 starts, {(outcome.steps or 0) - 1} linear programs" in outcome.message


def test_any_load_is_lower_than_infinity() -> None:
    assert is_lower(0.3, np.inf)
    assert not is_lower(np.inf, np.inf)
    assert not is_lower(0.3, 0.3 + 1e-8)


@pytest.mark.parametrize("workers", [1, 2])
def test_interrupt_keeps_certificates_or_associated_bound(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupt in a walk keeps all certificates; one before the first certificate keeps the associated bound."""

    def interrupted(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Descent, "around", interrupted)
    outcome = limit_nonassociated(rubble(3), workers=workers)
    assert outcome.status == "collapse"
    assert outcome.message.endswith("interrupted")
    monkeypatch.setattr(Descent, "least", interrupted)
    outcome = limit_nonassociated(rubble(3), workers=workers)
    assert (outcome.status, outcome.lower) == ("undecided", None)
    assert outcome.upper == pytest.approx(limit(rubble(3)).upper, rel=1e-9)
    assert "interrupted; upper is the associated bound" in outcome.message


def test_interrupted_search_does_not_say_that_wall_locks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Friction grew with the load in all programs so far, but others were still to come."""
    live = {"kind": "point", "at": [0.12, 0.12], "force": [0, -1]}
    size = {"wall__length": 0.48, "wall__height": 0.12, "wall__first_course": "half"}
    scene = panel(**size, support__kind="pinned-corners", load={"gravity": 9.81, "live": live})
    assert limit_nonassociated(scene, starts=5).status == "unbounded"

    def interrupted(*arguments: object) -> None:
        raise KeyboardInterrupt

    def observe(found: SearchLog) -> None:
        assert found.growing
        monkeypatch.setattr(Programs, "frozen", interrupted)

    outcome = limit_nonassociated(scene, starts=5, observe=observe)
    assert outcome.status == "undecided"
    assert "interrupted; forces within Coulomb's law balance any multiple of the live load" in outcome.message


def test_result_is_independent_of_number_of_workers() -> None:
    scene = rubble(3)
    one, three = (limit_nonassociated(scene, starts=21, workers=workers) for workers in (1, 3))
    assert (one.lower, one.upper, one.steps, one.message) == (three.lower, three.upper, three.steps, three.message)
    assert (one.motion == three.motion).all()


def test_search_reports_progress() -> None:
    progress, lines = SearchProgress(), []

    def observe(found: SearchLog) -> None:
        progress(found)
        lines.append(progress.line())

    assert progress.line() == "looks for a first certificate"
    outcome = limit_nonassociated(rubble(3), starts=9, observe=observe)
    assert [line.split(",")[0] for line in lines] == ["1 starts", "5 starts", "9 starts"]
    assert lines[-1].startswith(f"9 starts, {(outcome.steps or 0) - 1} linear programs")


def test_program_that_does_not_end_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """HiGHS 1.16 stays in one program of this wall for ever, without counting iterations; the search goes on."""
    monkeypatch.setattr("runningbond.limit.simplex.LEAST_SECONDS", 0.5)
    live = {"kind": "point", "at": [0.15, 0.09], "force": [-346.752, -84.2796]}
    wall = panel(
        wall={"thickness": 0.461, "block_width": 0.6, "block_height": 0.06, "length": 1.2, "height": 0.36},
        joint={"friction": 1.116, "cohesion": 9770.0},
        joints={"lime": {"friction": 0.43, "cohesion": 1190.0}},
        assign=[{"joint": "lime", "box": [[-9.0, 0.18], [10.2, 9.36]]}],
        beam={"height": 0.1, "condition": "level"},
        load={"gravity": 9.81, "live": live},
    )
    outcome = limit_nonassociated(wall)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower < 1.7
    assert outcome.upper <= (limit(wall).multiplier or 0.0) * (1 + 1e-6)


def test_warm_started_programs_reach_cold_optimum() -> None:
    """Both ends of the loads on one mechanism, after other programs, against interior point and crossover."""
    system = equilibrium(published_scene("wall-w3"))
    programs, driving = Programs(system), None
    pressure = limit_state(system).forces.pressure
    while driving is None:
        program = programs.frozen(pressure)
        alone = solve_forces(system, frozen_friction(system.strength, pressure))
        assert program.multiplier == pytest.approx(alone.multiplier, rel=1e-9)
        driving = driving_forces(system, program.motion)
        if driving is not None and programs.extreme(driving).status != "optimal":
            driving = None
        pressure = 0.4 * pressure + 0.6 * program.pressure
    for sense, aim in ((1.0, "smallest"), (-1.0, "largest"), (1.0, "smallest")):
        alone = solve_forces(system, driving, aim)  # type: ignore[arg-type]
        assert programs.extreme(driving, sense).multiplier == pytest.approx(alone.multiplier, rel=1e-9)
        programs.vertex(driving, np.ones(len(system.points)), pivots=20)


def test_interior_point_decides_if_simplex_gives_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """With one pivot per program, interior points find the same loads, or that there are none."""
    system = equilibrium(published_scene("wall-w3"))
    patient, hasty, statuses = Programs(system), Programs(system), set()
    pressure = limit_state(system).forces.pressure * np.exp(np.random.default_rng(0).normal(size=len(system.points)))
    for _ in range(6):
        program = patient.frozen(pressure)
        driving = driving_forces(system, program.motion)
        with monkeypatch.context() as patch:
            patch.setattr("runningbond.limit.programs.SEQUENCE_PIVOTS", 1)
            patch.setattr("runningbond.limit.programs.MOST_PIVOTS", 1)
            assert hasty.frozen(pressure).multiplier == pytest.approx(program.multiplier, rel=1e-7)
            assert driving is not None
            for sense in (1.0, -1.0):
                hasty.start_from((None, None, None))
                found, exact = hasty.extreme(driving, sense), patient.extreme(driving, sense)
                assert found.status == exact.status
                assert found.multiplier == pytest.approx(exact.multiplier, rel=1e-7, nan_ok=True)
                statuses.add(found.status)
        pressure = 0.4 * pressure + 0.6 * program.pressure
    assert statuses == {"optimal", "infeasible"}


@pytest.mark.parametrize("name", ["wall-w2", "wall-w3"])
def test_checker_proves_stored_lowest_and_highest_certificates(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With wrong forces, motion or load at either end the checker rejects the result."""
    scene = published_scene(name)
    outcome = limit_nonassociated(scene, starts=2)
    save_outcome(outcome, tmp_path / "right", scene=scene)
    assert check(tmp_path / "right")
    assert capsys.readouterr().out.count("unbalanced force") == 2
    save_outcome(replace(outcome, far_force=outcome.force), tmp_path / "wrong", scene=scene)
    assert not check(tmp_path / "wrong")
    save_outcome(replace(outcome, far_motion=-outcome.far_motion), tmp_path / "backwards", scene=scene)
    assert not check(tmp_path / "backwards")
    assert outcome.lower is not None
    save_outcome(replace(outcome, lower=outcome.lower - 1e-3), tmp_path / "longer", scene=scene)
    assert not check(tmp_path / "longer")
