"""Cost of walls of some fifty blocks that are pushed to 20 mm, by models whose blocks may split.

    python -m benchmarks.laboratory_cost [WALL …]

By default the shipped dry walls that are pushed to one side; in the tests each of them ends at another displacement.
Compilation of kernels is not included; the median and the range of `REPEATS` runs in one process are printed.
"""

import sys
from dataclasses import replace
from statistics import median

from runningbond.laboratory import chosen_walls
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.rig import scene_of
from runningbond.models import TOLERANCE
from runningbond.scene import Scene
from runningbond.scene.errors import exits_in_a_line

MODELS = ("rigid-splitting", "fem-splitting")
TO, REPEATS = 0.02, 3


def pushed(scene: Scene, displacement: float) -> Scene:
    """The scene with its beam pushed to one side, up to a displacement [m]."""
    beam = scene.beam
    assert beam is not None
    assert beam.drive is not None
    return replace(scene, beam=replace(beam, drive=replace(beam.drive, path=(displacement,))))


def main(names: list[str]) -> None:
    """Print one row per wall and model."""
    walls = chosen_walls(names)
    print("| wall | blocks | model | status | V [kN] | time steps | CPU s |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in names:
        for model in MODELS:
            rung, seconds = LADDER[model], list[float]()
            blocks = int(scene_of(walls[name], LADDER["limit"].features).wall.sum())
            scene = pushed(scene_of(walls[name], rung.features), TO)
            for _ in range(REPEATS):
                outcome = rung.model.solve(scene, TOLERANCE)
                seconds.append(outcome.seconds)
            bracket = f"{(outcome.lower or 0) / 1e3:.1f} … {(outcome.upper or 0) / 1e3:.1f}"
            spread = f"{median(seconds):.1f} ({min(seconds):.1f} … {max(seconds):.1f})"
            cells = (name, str(blocks), model, outcome.status, bracket, f"{outcome.steps:,}", spread)
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    with exits_in_a_line():
        main(sys.argv[1:] or ["SW.30.1", "SW.200.1", "SW.200.2", "WS.100", "WS.250"])
