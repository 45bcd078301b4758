"""Fracture energies and joint dissipation."""

import numpy as np
import pytest

from fem_interface.fracture import corrected_energies, fractured, printed_energies
from fem_interface.modal_wall import modal_wall
from fem_interface.model import fem
from fem_interface.system import system_of
from runningbond.dynamics import Run
from runningbond.joints.law import FRICTION_WORK
from runningbond.joints.softening import DAMAGE
from runningbond.scene import SceneError

from .walls import check_dissipation, wall


def test_fracture_energies_as_corrected_and_as_printed() -> None:
    """l = 0.24 m, c = 0.1 MPa, tan φ = 0.6, E = 1 GPa: 7.5 and 20.9 J/m², swapped in print."""
    strengths = (0.24, 1e5, 1e5 / 0.6, 1e9)
    assert printed_energies(*strengths) == pytest.approx((7.540, 20.944), abs=1e-3)
    assert corrected_energies(*strengths) == pytest.approx(printed_energies(*strengths)[::-1])
    assert corrected_energies(0.24, 0.0, 0.0, 1e9) == (0.0, 0.0)


def test_fracture_energy_depends_on_joint_length() -> None:
    scene = wall(joint__cohesion=1e5)
    for energies, bed in (("corrected", 0.12), ("printed", 0.24)):
        materials, of_joint = fractured(scene, energies)  # type: ignore[arg-type]
        run = np.abs(scene.joints.ends[:, 1] - scene.joints.ends[:, 0])
        between = scene.wall[scene.joints.block].all(axis=1)
        for joint in np.flatnonzero(between):
            length = bed if run[joint, 0] > run[joint, 1] else 0.06
            found = materials[of_joint[joint]]
            formula = corrected_energies if energies == "corrected" else printed_energies
            expected = formula(length, 1e5, 1e5 / 0.6, 1e9)
            assert (found.fracture_energy_1, found.fracture_energy_2) == pytest.approx(expected, rel=1e-3)


def test_energies_from_formula_need_mortar() -> None:
    stiff = {"friction": 0.6, "normal_stiffness": 1e11, "shear_stiffness": 4e10}
    with pytest.raises(SceneError, match=r"joint.mortar"):
        system_of(modal_wall(wall(joint=stiff)), energies="corrected")


@pytest.mark.parametrize("energy", [None, 0.0, 20.0])
@pytest.mark.parametrize("cohesion", [0.0, 2e3])
def test_dissipation_never_decreases(cohesion: float, energy: float | None) -> None:
    """At every point, through rest and collapse, including c = f_t = G = 0."""
    scene = wall(1e10, joint__cohesion=cohesion)
    run = Run(system_of(modal_wall(scene.with_joint(fracture_energy_1=energy, fracture_energy_2=energy))))
    state = check_dissipation(run, 100)
    assert state.history[FRICTION_WORK].max() > 0
    if energy is not None:
        assert state.history[DAMAGE].max() <= 1


def test_zero_strength_and_zero_energy_equal_dry_joint() -> None:
    scene = wall(1e12)
    dry = scene.with_joint(cohesion=0.0, tensile_strength=0.0, fracture_energy_1=0.0, fracture_energy_2=0.0)
    outcome = fem(dry)
    assert outcome.status == "collapse"
    plastic = fem(scene)
    assert outcome.multiplier == pytest.approx(plastic.multiplier, rel=0.01)
