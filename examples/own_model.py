"""A user-defined model: the wall as one rigid block that slides on the ground or topples about its corner."""

import time

import numpy as np

import runningbond as rb
from runningbond.models import Model
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError


def monolith(scene: Scene, tolerance: float = 0.01) -> Outcome:
    """Collapse of a wall under lateral load if its joints hold it together: an upper bound of the collapse load."""
    start = time.perf_counter()
    joint, *others = scene.materials_of_joints
    weight, live, dead = float(np.hypot(*scene.load.gravity)), scene.live_forces, scene.dead_forces
    sideways = live.on_mass_alone and np.allclose(live.acceleration, [weight, 0.0])
    if not sideways or not dead.on_mass_alone or not np.allclose(dead.acceleration, [0.0, -weight]):
        raise SceneError("model monolith", "has no answer for this scene: it needs a lateral load to the right alone")
    if others or joint.cohesion > 0 or len(scene.pins):
        raise SceneError("model monolith", "has no answer for this scene: it needs dry joints of one material, no pins")
    free = ~scene.fixed
    (_, low), (right, _) = scene.blocks.extent(free)
    x, y = scene.mass[free] @ scene.blocks.centroid[free] / scene.mass[free].sum()
    topples, slides = (right - x) / (y - low), joint.friction
    multiplier = float(min(topples, slides))
    message = "topples" if topples < slides else "slides"
    seconds = time.perf_counter() - start
    return Outcome(
        scene.title, "monolith", "collapse", multiplier, upper=multiplier, seconds=seconds, message=f"{message} as one"
    )


READS = frozenset({"block.density", "joint.friction"})
MONOLITH = Model(name="monolith", title="the wall as one block", solve=monolith, reads=READS)

if __name__ == "__main__":
    panels = [rb.read(f"panel-{number:02d}") for number in (1, 5, 9)]
    for panel in panels:
        print(panel, panel.run(MONOLITH).upper, panel.run("limit").upper)
