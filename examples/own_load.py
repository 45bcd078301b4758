"""A user-defined load: water against the left face of a wall; λ multiplies the weight of the water."""

from dataclasses import dataclass

import numpy as np

import runningbond as rb
from runningbond.scene import Action, Forces, Scene


@dataclass(frozen=True)
class Water(Action):
    """Water with its surface at y = `level` [m], against the face with the smallest x."""

    level: float

    def forces(self, scene: Scene) -> Forces:
        """Pressure on each block's face as a force at the centre of pressure."""
        blocks, (x, _) = scene.blocks, scene.blocks.extent(scene.wall)[0]
        high, low = blocks.vertices, blocks.vertices[blocks.successor]  # faces on the left run downwards
        wet = scene.wall[blocks.owner] & (np.maximum(high[:, 0], low[:, 0]) < x + blocks.tolerance)
        wet &= low[:, 1] < self.level
        shallow, deep = (np.maximum(0.0, self.level - end[wet, 1]) for end in (high, low))
        weight = 1000.0 * 9.81 * scene.thickness_of_blocks[blocks.owner[wet]]
        force = weight * (deep**2 - shallow**2) / 2
        centre = self.level - weight * (deep**3 - shallow**3) / 3 / force
        at = np.column_stack([np.full_like(centre, x), centre])
        return Forces.on(scene, block=blocks.owner[wet], at=at, force=np.outer(force, [1.0, 0.0]))


courses = [[2.0]] * 10
size = {"block_width": 0.5, "block_height": 0.1, "thickness": 1.0}
dam = rb.Wall.courses(courses, **size, density=2000.0, friction=0.75, live=Water(1.0), title="dam")

if __name__ == "__main__":
    table = rb.sweep(dam, {"load.live": [Water(0.5), Water(0.8), Water(1.0)]}, "limit")
    for water, multiplier in zip(table["load.live"], table["multiplier"], strict=True):
        print(f"water {water.level} m deep: it bears {multiplier:.3f} times the weight of water")
