"""Mesh a wall of 20 000 blocks and write it: medians of five runs, and the time spent in gmsh."""

import statistics
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from meshing import wall_mesh, write_mesh
from meshing.outline import outlines
from meshing.shapes import shape_of_blocks, triangulate
from runningbond.scene import BlockMaterial, Bond, JointMaterial, Load, build_scene
from runningbond.scene.bond import bonded_rows, rectangles

BOND = Bond(0.24, 0.06)


def median(action: Callable[[], object]) -> float:
    """Median seconds of five runs."""
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        action()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


def main() -> None:
    """Print the times."""
    scene = build_scene(
        "48 m × 6 m",
        rectangles(bonded_rows(BOND.width, 48.0, 100), BOND.width, BOND.levels(100)),
        thickness=0.12,
        block=BlockMaterial(density=1800.0),
        joint=JointMaterial(friction=0.6),
        load=Load(),
        bond=BOND,
    )
    print(f"{scene.wall.sum()} blocks, {len(scene.joints)} joints")
    for cells in (1, 2, 4):
        outline = outlines(scene, cells)
        _, example = shape_of_blocks(outline)
        mesh = wall_mesh(scene, cells)
        whole = median(partial(wall_mesh, scene, cells))
        gmsh = median(partial(triangulate, outline, example))
        print(f"cells {cells}: {len(mesh.triangles)} triangles, {whole:.2f} s, of which gmsh {gmsh:.3f} s", end="")
        with tempfile.TemporaryDirectory() as folder:
            for suffix in (".msh", ".vtu"):
                path = Path(folder) / f"wall{suffix}"
                seconds = median(partial(write_mesh, mesh, scene, path))
                print(f"; {suffix} {seconds:.2f} s, {path.stat().st_size / 1e6:.1f} MB", end="")
        print()


if __name__ == "__main__":
    main()
