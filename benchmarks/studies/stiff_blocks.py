"""Deformable blocks of 1 to 1000 GPa beside rigid ones: walls with inset contacts and arches, brackets and cost.

Prints two Markdown tables, one row per wall and Young's modulus as it ends. First: time steps in the longest period of
the elastic wall, with mass scaling of each mode by itself and as in `fem`, and the decrease of the lowest frequency by
the latter. Second: brackets, time steps, processor seconds, and the ratio of the seconds of both models.

    python benchmarks/studies/stiff_blocks.py
    python benchmarks/studies/stiff_blocks.py wall-w1 arch-27 --young 1 100
"""

import argparse
import math
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import ezdxf
import numpy as np
from scipy.linalg import eigh
from threadpoolctl import threadpool_limits

from dem.dynamic import quasi_static_run
from fem_interface.modal_wall import modal_wall
from fem_interface.model import run_of_longer_steps
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.compare.table import bracket
from runningbond.dynamics import Run
from runningbond.dynamics.vibrations import elastic_stiffness
from runningbond.models import run_model
from runningbond.models.second_opinion import share_loads
from runningbond.results import Outcome
from runningbond.scene import Scene, scene_from_dict

INSET = 0.02
ARCHES = {"arch-9": (9, 180.0), "arch-15": (15, 180.0), "arch-21": (21, 120.0), "arch-27": (27, 180.0)}
"""Number of voussoirs, and the angle [degrees] that they span."""

WALLS = ["wall-w1", "wall-w2", "wall-w3", "wall-w4", *ARCHES]
YOUNG = [1.0, 10.0, 100.0, 1000.0]
RADIUS, RING = 2.0, 0.4


def arch(voussoirs: int, spanned: float) -> Scene:
    """An arch of 2 m inner radius, 0.4 m thick, on the ground, under lateral load proportional to its weight."""
    document = ezdxf.new("R2000")  # type: ignore[attr-defined]
    space = document.modelspace()
    rays = np.radians(90 + np.linspace(spanned / 2, -spanned / 2, voussoirs + 1))
    ring = np.array([[np.cos(rays), np.sin(rays)]]) * np.array([RADIUS, RADIUS + RING])[:, None, None]
    inner, outer = np.moveaxis(ring, 2, 1)
    for k in range(voussoirs):
        space.add_lwpolyline(
            [inner[k], outer[k], outer[k + 1], inner[k + 1]][::-1], close=True, dxfattribs={"layer": "ARCH"}
        )
    for end, sense in ((0, -1.0), (-1, 1.0)):
        away = sense * np.array([-np.sin(rays[end]), np.cos(rays[end])]) * -RING
        corners = [inner[end], outer[end], outer[end] + away, inner[end] + away]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "GROUND"})
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "arch.dxf"
        document.saveas(path)
        return scene_from_dict(
            {
                "title": f"arch of {voussoirs} voussoirs",
                "wall": {"drawing": str(path), "units": "m", "thickness": 0.3},
                "block": {"density": 2000.0, "young": 1e10, "poisson": 0.2},
                "joint": {"friction": 0.7, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
                "support": {"kind": "base"},
                "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
            },
            folder=Path(folder),
        )


def wall(name: str) -> Scene:
    """A wall by its name; those of Ferris & Tin-Loi have contacts inset by `INSET`."""
    return arch(*ARCHES[name]) if name in ARCHES else published_scene(name).with_joint(inset=INSET)


def timed(model: str, scene: Scene) -> tuple[Outcome, float]:
    """Outcome of a model, and its processor time [s], with one thread as in campaigns."""
    with threadpool_limits(1):
        start = time.process_time()
        return run_model(model, scene), time.process_time() - start


def steps_in_a_period(run: Run) -> tuple[float, float]:
    """Number of time steps in the longest period, and its angular frequency [rad/s]."""
    system = run.system
    stiffness, own = elastic_stiffness(system)
    mass, place = np.diag(own), np.cumsum(np.isfinite(system.mass)) - 1
    coupled = place[system.coupling.freedom]
    mass[np.ix_(coupled, coupled)] += system.coupling.inertia
    frequency = math.sqrt(eigh(stiffness, mass, eigvals_only=True, subset_by_index=(0, 0))[0])
    return 2 * math.pi / (frequency * run.dt), frequency


def periods(names: list[str], moduli: list[float]) -> Iterator[str]:
    """Rows of the first table."""
    yield "| wall | E [GPa] | rigid blocks | each mode by itself | `fem` | lowest frequency lost |"
    yield "|---|---|---|---|---|---|"
    for name in names:
        scene = wall(name)
        rigid, _ = steps_in_a_period(quasi_static_run(scene))
        for young in moduli:
            blocks = modal_wall(scene.with_block(young=1e9 * young))
            system = system_of(blocks)
            alone, exact = steps_in_a_period(Run(system))
            steps, slowed = steps_in_a_period(run_of_longer_steps(blocks, system))
            yield f"| {name} | {young:g} | {rigid:.0f} | {alone:.0f} | {steps:.0f} | {1 - slowed / exact:.1%} |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("walls", nargs="*", default=WALLS)
    parser.add_argument("--young", nargs="+", type=float, default=YOUNG, help="in GPa")
    asked = parser.parse_args()
    for row in periods(asked.walls, asked.young):
        print(row, flush=True)
    print(
        "\n| wall | E [GPa] | `dem-dynamic` | `fem` | agree | steps | steps | seconds | seconds | ratio | `fem` says |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name in ("wall-w1", "arch-9"):  # kernels are compiled before anything is measured
        for young in (min(YOUNG), max(YOUNG)):
            run_model("fem", wall(name).with_block(young=1e9 * young), 0.5)
    for name in asked.walls:
        scene = wall(name)
        run_model("dem-dynamic", scene)
        rigid, rigid_seconds = timed("dem-dynamic", scene)
        for young in asked.young:
            found, seconds = timed("fem", scene.with_block(young=1e9 * young))
            brackets = f"{bracket(rigid)} | {bracket(found)} | {'yes' if share_loads(rigid, found) else 'no'}"
            costs = (
                f"{rigid.steps} | {found.steps} | {rigid_seconds:.2g} | {seconds:.2g} | {seconds / rigid_seconds:.1f}"
            )
            print(f"| {name} | {young:g} | {brackets} | {costs} | {found.message} |", flush=True)


if __name__ == "__main__":
    main()
