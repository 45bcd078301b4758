"""Write and draw one moment of a wall of 20 000 blocks: median and spread of five runs, after one to warm up."""

import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from runningbond.pictures.captions import to_png
from runningbond.pictures.flat import figure_of
from runningbond.pictures.frame import Discretisation, Frame
from runningbond.pictures.mechanism import mechanism_frame
from runningbond.pictures.offscreen import why_not_drawn
from runningbond.pictures.pyvista_figure import mechanism_figure
from runningbond.pictures.pyvista_painter import Painter
from runningbond.pictures.time_series import TimeSeries
from runningbond.results import Outcome, fastest_corner_by_one, write_atomically
from runningbond.scene import Scene, scene_from_dict

WALL = {
    "wall": {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12, "length": 48.0, "height": 6.0},
    "block": {"density": 1800.0},
    "joint": {"friction": 0.6},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}
RUNS = 6


def sheared(scene: Scene) -> Outcome:
    """Outcome in which the courses have slid on each other, in proportion to their height."""
    height = np.where(scene.wall, scene.blocks.centroid[:, 1], 0.0)
    motion = fastest_corner_by_one(scene.blocks, height[:, None] * np.array([1.0, 0.0, 0.0]))
    return Outcome("20 000 blocks", "limit", "collapse", 0.3, motion=motion)


def timed(action: Callable[[], object]) -> str:
    """Median and spread of the seconds of an action, as text."""
    seconds = []
    for _ in range(RUNS):
        start = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - start)
    rest = seconds[1:]
    return f"median {statistics.median(rest):.2f} s ({min(rest):.2f} … {max(rest):.2f}), first {seconds[0]:.2f} s"


def main() -> None:
    """Print the times."""
    scene = scene_from_dict(WALL)
    outcome = sheared(scene)
    frame = mechanism_frame(scene, outcome)
    assert frame is not None
    print(f"{scene.wall.sum()} blocks, {len(scene.joints)} joints")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        print(f"write a moment of blocks and joints: {timed(lambda: write(scene, frame, folder))}")
        print(f"draw it flat: {timed(lambda: to_png(figure_of(scene, outcome)))}")
        if why_not_drawn():
            print(why_not_drawn())
            return
        painter = Painter()
        print(f"draw the mechanism: {timed(lambda: draw(scene, outcome, painter, folder / 'mechanism.png'))}")
        painter.close()


def write(scene: Scene, frame: Frame, folder: Path) -> None:
    """Write one moment as a time series."""
    TimeSeries(Discretisation.of_rigid_blocks(scene), folder).add(frame)


def draw(scene: Scene, outcome: Outcome, painter: Painter, path: Path) -> None:
    """Draw a mechanism and write the picture."""
    write_atomically(path, to_png(mechanism_figure(scene, outcome, painter)))


if __name__ == "__main__":
    main()
