"""Read a wall of 20 000 blocks and find its joints: median and spread of five runs."""

import statistics
import tempfile
import time
from pathlib import Path

from runningbond.scene import Scene, read_scene

WALL = """
[wall]
block_width = 0.24
block_height = 0.06
thickness = 0.12
length = 48.0
height = 6.0
[block]
density = 1800.0
[joint]
friction = 0.6
[support]
kind = "base"
[load]
gravity = 9.81
live = { kind = "lateral" }
"""


def timed(path: Path) -> tuple[float, Scene]:
    """Seconds to read a scene, and the scene."""
    start = time.perf_counter()
    scene = read_scene(path)
    return time.perf_counter() - start, scene


def main() -> None:
    """Print the times."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "wall.toml"
        path.write_text(WALL)
        runs = [timed(path) for _ in range(5)]
    seconds, scene = [run[0] for run in runs], runs[0][1]
    print(
        f"{scene.wall.sum()} blocks, {len(scene.joints)} joints: median {statistics.median(seconds):.3f} s "
        f"({min(seconds):.3f} … {max(seconds):.3f})"
    )


if __name__ == "__main__":
    main()
