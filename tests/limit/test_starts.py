"""Starts of the search from known certificates: in their neighbourhoods, and from their pressures."""

from collections.abc import Iterator

import numpy as np
import pytest

from runningbond.compare import published_scene
from runningbond.limit.certificates import Certificate, certify, least_multiplier
from runningbond.limit.descent import Descent
from runningbond.limit.equilibrium import Equilibrium
from runningbond.limit.force_program import ForceSolution, coulomb, solve_forces
from runningbond.limit.macro import sides
from runningbond.limit.neighbourhood import distances
from runningbond.limit.programs import Programs
from runningbond.limit.search import search
from runningbond.limit.starts import ORIGINS, ROUND, Origin, Start
from runningbond.scene import Array, BlockMaterial, JointMaterial, Lateral, Load, Scene, build_scene
from tests.limit.test_coarse import ordered
from tests.limit.test_search import rubble

Known = tuple[Equilibrium, Array, ForceSolution, list[Certificate]]


def known(scene: Scene) -> Known:
    """Equations, places, the associated solution, and the first start's certificates in ascending order of load."""
    system, place = ordered(scene)
    associated = solve_forces(system, coulomb(system.strength))
    return system, place, associated, sorted(search(system, associated, 1).certificates, key=least_multiplier)


def numbers(origin: Origin) -> range:
    """Numbers of the first starts with an origin; `ROUND` consecutive starts have the same one."""
    return range(ORIGINS.index(origin) * ROUND, (ORIGINS.index(origin) + 1) * ROUND)


@pytest.mark.parametrize(("name", "part"), [("rubble", 0.87), ("wall-w3", 0.9), ("wall-w5", 0.98)])
def test_neighbourhoods_of_certificate_contain_smaller_loads(name: str, part: float) -> None:
    """From the first start's highest certificate the load falls to a `part`, each mechanism certified in the wall."""
    system, place, associated, before = known(rubble(3) if name == "rubble" else published_scene(name))
    before, found = before[-1:], list[Certificate]()
    for number in [k + later for later in (0, ROUND * len(ORIGINS)) for k in numbers("neighbourhood")]:
        start = Start(number, associated, before, {}, place)
        start.run(Programs(system))
        found += start.found.certificates
        assert start.found.programs > start.found.cost > 0  # programs of glued walls cost less
    assert min(map(least_multiplier, found)) < part * before[0].least.multiplier
    for each in found:
        again = certify(system, each.motion)
        assert again is not None
        assert again.least.multiplier == pytest.approx(each.least.multiplier, rel=1e-6)


def test_pressures_are_scattered_everywhere_or_near_one_block(monkeypatch: pytest.MonkeyPatch) -> None:
    """With radius zero only the pressures at one block's own joints change; without places all pressures change."""
    system, place, associated, before = known(rubble(3))
    started: list[Array] = []

    def sequence(descent: Descent, pressure: Array, weight: float | None) -> Iterator[Certificate]:
        started.append(pressure)
        return iter(())

    monkeypatch.setattr("runningbond.limit.starts.short_sequence", sequence)
    monkeypatch.setattr("runningbond.limit.starts.LOCAL", 1.0)
    monkeypatch.setattr("runningbond.limit.starts.RADIUS", (0.0, 0.0))
    ends = np.stack(sides(system), axis=1)
    first, changes = before[0].least.pressure, 0
    for number in numbers("known"):
        for at in (place, None):
            Start(number, associated, before[:1], {}, at).run(Programs(system))
            changed = started.pop() != first
            if at is None:
                assert changed[first > 0].all()
            elif changed.any():
                changes += 1
                assert set.intersection(*map(set, ends[changed].tolist()))  # all changed joints have a block in common
    assert changes


@pytest.mark.parametrize("size", [1.0, 2.7])
def test_distances_are_from_nearer_block_in_wall_sizes(size: float) -> None:
    system, place = ordered(rubble(3, size=size))
    distance = distances(system, place, place[[0]])
    ends = np.stack(sides(system), axis=1)
    assert (distance[(ends == 0).any(axis=1)] == 0).all()
    assert (distance[(ends != 0).all(axis=1)] > 0).all()
    reference, at = ordered(rubble(3))
    assert distance == pytest.approx(distances(reference, at, at[[0]]), abs=1e-6)


def test_distances_in_single_block_are_zero() -> None:
    block = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)])
    material = {"block": BlockMaterial(1800.0), "joint": JointMaterial(0.6), "load": Load(live=(Lateral((1.0, 0.0)),))}
    system, place = ordered(build_scene("one", [block], thickness=0.1, **material))  # type: ignore[arg-type]
    assert (distances(system, place, place) == 0).all()
