"""Draw the cracks of mortared walls at the end of their path by `fem-small`: docs/laboratory-j4d-j7d.png."""

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from fem_interface.modal_wall import ModalWall
from fem_interface.model import fem
from runningbond.dynamics import Run, State
from runningbond.joints.law import PLASTIC_CLOSURE
from runningbond.laboratory import chosen_walls
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.rig import scene_of
from runningbond.pictures.charts import bare
from runningbond.pictures.joint_state import JointState
from runningbond.pictures.style import CHART_COLOURS, CRUSHED, STATE_COLOURS
from runningbond.scene import Array
from runningbond.scene.errors import exits_in_a_line

SCALE = 12.0
KINDS = (
    ("slipped by 0.1 mm", 1e-4, STATE_COLOURS[JointState.SLIDE], (0, (1.8, 0.7))),
    ("opened by 0.1 mm", 1e-4, STATE_COLOURS[JointState.OPEN], "solid"),
    ("crushed", 9e-5, CRUSHED, "solid"),
)
"""Label, threshold, colour and dashes of each kind of crack, the last drawn on top. A joint element is drawn if one of
its points exceeds the threshold [m]; crushed means compressed beyond the strength."""


class LastLook:
    """Observer that keeps the last state of a run."""

    def __init__(self) -> None:
        self.jumps, self.motion = np.zeros((3, 0)), np.zeros(0)
        self.wall: object = None

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Store jumps, motion and wall of a state."""
        if not run.is_driven:
            return
        opening, slip, *_ = run.at_joints(state)
        crushed = state.history[run.interface.law.law.row(PLASTIC_CLOSURE)]
        self.jumps, self.motion, self.wall = np.array([np.abs(slip), opening, crushed]), state.motion, run.system.source


def draw(axes: Axes, seen: LastLook) -> None:
    """Draw deformed triangles, and the joint elements that slipped, opened or were crushed."""
    wall = seen.wall
    assert isinstance(wall, ModalWall)
    at: Array = wall.mesh.points + SCALE * wall.displacement(seen.motion)
    axes.add_collection(PolyCollection(list(at[wall.mesh.triangles]), facecolor="0.86", edgecolor="0.86", lw=0.3))
    ends = at[wall.elements.nodes].reshape(-1, 2, 2, 2).mean(axis=1)
    most = seen.jumps.reshape(3, -1, len(ends)).max(axis=1)
    for (label, least, colour, dashes), jump in zip(KINDS, most, strict=True):
        lines = LineCollection(
            list(ends[jump > least]), colors=colour, lw=2.6 if label == "crushed" else 1.8, ls=[dashes], label=label
        )
        axes.add_collection(lines)
    axes.set_aspect("equal")
    axes.set(xlim=(-0.12, 1.12), ylim=(-0.05, 1.08))
    axes.axis("off")


def main(path: Path, names: list[str]) -> None:
    """Draw walls side by side, with their curves."""
    walls = chosen_walls(names)
    figure = Figure(figsize=(3.6 * (len(names) + 1), 3.9), layout="constrained")
    *maps, curves = figure.subplots(1, len(names) + 1)
    for axes, name, colour in zip(maps, names, CHART_COLOURS, strict=False):
        seen = LastLook()
        scene = scene_of(walls[name], LADDER["fem-small"].features)
        curve = fem(scene, cells=2, modes=20, observe=seen).curve
        draw(axes, seen)
        axes.set_title(f"{name} at 4 mm, × {SCALE:g}", fontsize=9)
        peak, measured = 1e-3 * curve[:, 1].max(), 1e-3 * (walls[name].peak or np.nan)
        curves.plot(1e3 * curve[:, 0], 1e-3 * curve[:, 1], color=colour, label=f"{name}: {peak:.0f} kN")
        curves.axhline(measured, color=colour, ls="--", lw=0.8, label=f"measured peak: {measured:.0f} kN")
    curves.set(xlabel="displacement [mm]", ylabel="horizontal force [kN]", xlim=(0, None), ylim=(0, None))
    bare(curves)
    key = {"fontsize": 8, "frameon": False, "ncols": 3}
    figure.legend(*curves.get_legend_handles_labels(), loc="outside lower right", **key)
    figure.legend(*maps[0].get_legend_handles_labels(), loc="outside lower left", **key)
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("python tools/crack_maps.py PICTURE WALL …")
    with exits_in_a_line():
        main(Path(sys.argv[1]), sys.argv[2:])
