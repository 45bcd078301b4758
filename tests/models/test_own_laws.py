"""Laws of the user: models say which keys of a joint its law leaves out."""

from dataclasses import replace
from typing import Any

from runningbond.compare.advice import advise
from runningbond.joints import Law
from runningbond.joints.coulomb import COULOMB
from runningbond.joints.interface import INTERFACE
from runningbond.joints.softening import SOFTENING
from runningbond.models import MODELS, run_model
from runningbond.models.beds import along_joints
from runningbond.scene import Scene, Stiffness
from tests.walls import courses


def test_keys_that_the_users_law_does_not_look_at_are_told() -> None:
    """A wall whose toe crushes by its keys, and not by its law, bore .167 without a word; `limit` finds .122."""
    joint: dict[str, Any] = {"friction": 0.7, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    weak = joint | {"cohesion": 10.0, "compressive_strength": 2e5, "fracture_energy_1": 1.0, "fracture_energy_2": 1.0}
    wall, dry = (courses([[1]] * 6, 0.5, 0.5, joint=each) for each in (weak, joint))
    plastic, breaks = replace(COULOMB, name="plastic"), replace(SOFTENING, name="breaks")
    crushes, bare = replace(INTERFACE, name="crushes"), replace(COULOMB, name="bare", cone=lambda _: (0.7, 0.0, 0.0))

    def unread(model: str, law: Law | None, scene: Scene = wall) -> set[str]:
        return {key.removeprefix("joint.") for key in MODELS[model].unread(scene.with_joint(law=law))}

    for model in ("dem-dynamic", "fem"):
        assert unread(model, plastic) == {"compressive_strength", "fracture_energy_1", "fracture_energy_2"}
        assert unread(model, breaks) == {"compressive_strength"}
        assert not unread(model, crushes)
        assert not unread(model, None)
        assert not unread(model, plastic, dry)
    assert unread("limit", bare) - unread("limit", plastic) == {"friction", "cohesion"}
    assert unread("limit", plastic) == unread("limit", None)
    assert not unread("dem-dynamic", plastic, along_joints(dry))
    crushing = courses([[1]] * 6, 0.5, 0.5, joint=joint | {"compressive_strength": 2e5}).with_joint(law=plastic)
    said = "; not taken into account: joint.compressive_strength"
    assert said in run_model("dem-dynamic", crushing, 0.1).message
    assert advise(crushing, 0.1).outcome().message.count(said) == 1
    leaning = crushing.with_joint(elasticity=Stiffness(1e8, 4e7))
    advice = advise(leaning, 0.1)
    assert advice.known.evidence == "finite"
    assert advice.outcome().message.count(said) == 1
