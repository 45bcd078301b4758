"""A block mortared to its base and pushed over: its joint tears progressively from the edge."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from fem_interface.fracture import fractured
from fem_interface.model import fem
from runningbond.joints import Law, lobatto
from runningbond.joints.softening import HISTORY, softening_constants, softening_kernel, stored_by_secant
from runningbond.limit import limit
from runningbond.scene import JointMaterial, Mortar
from tests.at_length import at_length
from tests.walls import courses

WIDTH, HEIGHT, THICKNESS, DENSITY, GRAVITY = 0.5, 1.0, 0.4, 2000.0, 9.81
STRENGTH, STIFFNESS = 1e5, 1e10


def stone(energy: float, strength: float = STRENGTH) -> Any:
    """A rigid block that cannot slide, on mortar with a fracture energy [J/m²] and a tensile strength [Pa]."""
    mortar = {"friction": 2.0, "cohesion": 4e5, "tensile_strength": strength, "fracture_energy_1": energy}
    spring = {"normal_stiffness": STIFFNESS, "shear_stiffness": 0.4 * STIFFNESS, "fracture_energy_2": energy}
    block = {"density": DENSITY, "young": 1e15, "poisson": 0.2}
    joint = {**mortar, **spring}
    return courses([[1]], WIDTH, HEIGHT, wall__thickness=THICKNESS, joint=joint, block=block)


def strength_on_springs(energy: float, strength: float = STRENGTH, *, leans: float = 0.0, count: int = 200) -> float:
    """Largest λ over all rotations of a rigid block on a bed of springs that soften linearly.

    At finite displacements (`leans` = 1) its weight moves with it, which takes the rotation from λ.
    """
    place = (np.arange(count) + 0.5) / count * WIDTH - WIDTH / 2
    area, weight = WIDTH * THICKNESS, DENSITY * GRAVITY * WIDTH * HEIGHT * THICKNESS
    elastic, broken = strength / STIFFNESS, 2 * energy / strength
    largest = 0.0
    for rotation in np.geomspace(1e-6, 2e-2, 500):
        # From wide open to fully compressed: the first settlement at which the bed carries the weight.
        sinking = np.linspace(-2e-6, rotation * WIDTH, 4001)[:, None]
        opening = rotation * (place + WIDTH / 2) - sinking
        softened = strength * (broken - opening) / (broken - elastic)
        stress = np.where(opening < elastic, STIFFNESS * opening, np.clip(softened, 0.0, strength))
        carried = stress.mean(axis=1) * area + weight
        balanced = np.flatnonzero(np.diff(np.sign(carried)))
        moments = (stress @ place)[balanced] * area / count
        largest = max(largest, float(moments.max(initial=0.0)) / (weight * HEIGHT / 2) - leans * rotation)
    return largest


@pytest.mark.parametrize(("model", "off"), [(dem_dynamic, 0.03), *at_length((fem, 0.02))])
@pytest.mark.parametrize("energy", [10.0, *at_length(1.0)])
def test_mortar_tears_progressively_from_edge(model: Any, off: float, energy: float) -> None:
    """With contact only at both ends it would carry as much as a plastic joint, 1.7 to 2.5 times as much."""
    exact, scene = strength_on_springs(energy), stone(energy)
    outcome = model(scene)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert (1 - off) * exact < outcome.lower <= outcome.upper < (1 + off) * exact
    plastic = limit(scene).multiplier
    assert plastic is not None
    assert plastic > 1.6 * exact


@pytest.mark.parametrize("model", [dem_dynamic, *at_length(fem)])
def test_custom_damage_law_tears_progressively_from_edge(model: Any) -> None:
    """A law with a damage variable gets points along the joint, also if the scene has no fracture energies, as here."""

    def constants(material: JointMaterial) -> tuple[float, ...]:
        return softening_constants(replace(material, fracture_energy_1=10.0, fracture_energy_2=10.0))

    law = Law("of one's own", constants, softening_kernel, HISTORY, stored_by_secant, damage="damage")
    scene = stone(10.0).with_joint(law=law, fracture_energy_1=None, fracture_energy_2=None)
    exact, outcome = strength_on_springs(10.0), model(scene)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert 0.97 * exact < outcome.lower <= outcome.upper < 1.03 * exact


@pytest.mark.long
@pytest.mark.parametrize(("strength", "distance", "off"), [(STRENGTH, 2e-3, 0.005), (2500.0, 8e-3, 0.01)])
def test_mortar_tears_progressively_at_finite_displacements(strength: float, distance: float, off: float) -> None:
    """For any mesh: contacts only at the nodes of a mesh with one cell per half block would carry 50 % more.

    Of weak mortar, points at equal distances carried 4 % more: cracks passed them in larger jumps.
    """
    exact = strength_on_springs(10.0, strength, leans=1.0)
    for cells in (1, 3, 8):
        pushed = fem(stone(10.0, strength), cells=cells, modes=3, displacements="finite", distance=distance)
        assert pushed.multiplier == pytest.approx(exact, rel=off)


@pytest.mark.parametrize("model", [dem_dynamic, fem])
def test_brittle_mortar_carries_load_of_first_crack(model: Any) -> None:
    """Eccentric lift, little fracture energy: (f_t A + W) / (1 + 6 e / b), which nine points overestimate by 11 %."""
    length, thickness, height, strength, eccentricity = 2.0, 0.4, 0.2, 1e4, 0.5
    joint = {"friction": 0.6, "cohesion": 2e4, "tensile_strength": strength}
    joint |= {"normal_stiffness": 1e10, "shear_stiffness": 4e9, "fracture_energy_1": 0.01, "fracture_energy_2": 0.05}
    lift = {"kind": "point", "at": [length / 2 + eccentricity, height / 2], "force": [0, 1]}
    block = {"density": DENSITY, "young": 1e15, "poisson": 0.2}
    scene = courses([[1]], length, height, wall__thickness=thickness, joint=joint, block=block, load__live=lift)
    weight = DENSITY * GRAVITY * length * height * thickness
    exact = (strength * length * thickness + weight) / (1 + 6 * eccentricity / length)
    outcome = model(scene)
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert 0.98 * exact < outcome.lower < outcome.upper < 1.125 * exact


@pytest.mark.long
def test_strength_of_dry_crack_converges_with_joint_points() -> None:
    """One half slips along the other as the crack between them opens: each point slips at another load.

    With 33 points both models agree. With the nine of a wall with softening bed joints they are at most 2 % apart, and
    `dem-static` has only the two ends.
    """
    bed = {"friction": 1.0, "cohesion": 2e3, "tensile_strength": 1e3, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    tough = {"fracture_energy_1": 1e3, "fracture_energy_2": 1e3}
    crack = {"friction": 1.0, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
    push = {"kind": "point", "at": [0.1, 0.4], "force": [1, -1]}
    block = {"density": 1800.0, "young": 1e14, "poisson": 0.2}
    scene = courses([[1]], 0.4, 0.4, joint=bed | tough, inner_joint=crack, block=block, load__live=push)
    rigid, deformable = dem_dynamic(scene, 0.005).multiplier, fem(scene, 0.005).multiplier
    finer, ends = fem(scene, 0.005, rule=lobatto(33)).multiplier, dem_static(scene, 0.005).multiplier
    assert rigid is not None
    assert deformable is not None
    assert finer is not None
    assert 1.01 * finer < min(rigid, deformable) < max(rigid, deformable) < 1.06 * finer
    assert rigid == pytest.approx(deformable, rel=0.02)
    assert ends == pytest.approx(0.98 * finer, rel=0.01)


def test_formula_energies_act_like_given_energies() -> None:
    """Fracture energies from the formula give the same result as the same energies given in the scene."""
    mortar = Mortar(thickness=0.01, young=1e8, poisson=0.2)
    scene = stone(10.0).with_joint(elasticity=mortar, cohesion=4e4, tensile_strength=1e4)
    materials, _ = fractured(scene, "corrected")
    energies = {f"fracture_energy_{mode}": getattr(materials[0], f"fracture_energy_{mode}") for mode in (1, 2)}
    given = fem(scene.with_joint(**energies))
    taken = fem(scene.with_joint(fracture_energy_1=None, fracture_energy_2=None), energies="corrected")
    assert (taken.lower, taken.upper) == (given.lower, given.upper)
    assert given.lower is not None
    assert given.lower < 0.9 * (limit(scene).multiplier or 0.0)
