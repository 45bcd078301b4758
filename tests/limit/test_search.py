"""The search for the smallest certified load: what it finds, what it proves, and what it does not depend on."""

import numpy as np
import pytest
from scipy.spatial import Voronoi
from shapely.geometry import Polygon, box
from shapely.geometry.polygon import orient

from runningbond.compare import published_scene
from runningbond.limit import LimitState, equilibrium, limit, limit_nonassociated, limit_state
from runningbond.limit.canonical import canonical_order
from runningbond.limit.descent import Descent
from runningbond.limit.search import search
from runningbond.scene import Array, BlockMaterial, JointMaterial, Lateral, Load, Scene, build_scene

SIZE, CELLS = 2.0, 5


def cells(seed: int) -> list[Array]:
    """Voronoi cells of points on a disturbed grid, that fill a square."""
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
    """Such cells as a dry wall that is pushed to one side."""
    blocks = [size * cell for cell in cells(seed)]
    if mirrored:
        blocks = [(cell * [-1, 1])[::-1] for cell in blocks]
    if shuffled is not None:
        blocks = [blocks[i] for i in np.random.default_rng(shuffled).permutation(len(blocks))]
    live = Lateral((-1.0 if mirrored else 1.0, 0.0))
    material = {"block": BlockMaterial(1800.0), "joint": JointMaterial(0.75), "load": Load(live=(live,))}
    return build_scene("rubble", blocks, thickness=0.12, **material)  # type: ignore[arg-type]


def test_more_starts_certify_far_smaller_loads() -> None:
    """The first start finds the associated load and nothing else; a fifth less is certified as well."""
    scene = rubble(3)
    bound = limit(scene).multiplier or 0.0
    one, all_ = limit_nonassociated(scene, starts=1), limit_nonassociated(scene)
    assert one.lower == pytest.approx(bound, rel=1e-6)
    assert all_.lower is not None
    assert all_.lower < 0.8 * bound
    assert all_.upper == pytest.approx(bound, rel=1e-6)


def test_mirrored_shuffled_and_scaled_walls_have_the_same_loads() -> None:
    first = limit_nonassociated(rubble(3), starts=20)
    for other in (rubble(3, mirrored=True, shuffled=1), rubble(3, shuffled=2, size=2.7)):
        again = limit_nonassociated(other, starts=20)
        assert (again.lower, again.upper) == pytest.approx((first.lower, first.upper), rel=1e-6)
        assert again.steps == first.steps


@pytest.mark.parametrize("mirrored", [False, True])
def test_ordered_equations_are_the_same_to_the_last_bit(mirrored: bool) -> None:
    one, other = (
        canonical_order(system).applied(system)
        for system in (equilibrium(rubble(1)), equilibrium(rubble(1, mirrored=mirrored, shuffled=4)))
    )
    for name in ("opening", "slip", "reaction", "tie"):
        assert (getattr(one, name).toarray() == getattr(other, name).toarray()).all(), name
    assert (one.dead == other.dead).all()
    assert (one.live == other.live).all()


def test_a_motion_of_ordered_equations_is_restored() -> None:
    system = equilibrium(rubble(1))
    order = canonical_order(system)
    ordered, motion = order.applied(system), np.random.default_rng(0).normal(size=system.freedoms)
    restored = order.restored(motion)
    assert system.opening.T @ restored == pytest.approx(
        (ordered.opening.T @ motion)[np.argsort(order.points)], abs=1e-7
    )
    assert system.live @ restored == pytest.approx(ordered.live @ motion, abs=1e-7)


@pytest.mark.parametrize("name", ["rubble", "wall-w3"])
def test_both_ends_of_every_certificate_drive_its_mechanism(name: str) -> None:
    """Also where the upper end is the forces of the certificate from which the search came."""
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


def test_descent_goes_below_the_sequence() -> None:
    """W3, sharp: .35582 from the first start's .36031, and the outcome says how hard it was looked for."""
    outcome = limit_nonassociated(published_scene("wall-w3"), starts=1)
    assert outcome.lower == pytest.approx(0.35582, abs=1e-5)
    assert outcome.multiplier == outcome.lower
    assert "smaller ones are not excluded" in outcome.message
    assert f"from 1 starts, {(outcome.steps or 0) - 1} linear programs" in outcome.message


def test_an_interrupt_keeps_what_was_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*arguments: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Descent, "random_forces", interrupted)
    outcome = limit_nonassociated(rubble(3))
    assert outcome.status == "collapse"
    assert outcome.message.endswith("interrupted")
    monkeypatch.setattr("runningbond.limit.search.certify", interrupted)
    with pytest.raises(KeyboardInterrupt):
        limit_nonassociated(rubble(3))
