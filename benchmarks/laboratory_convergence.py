"""Change of the scores of `rigid-splitting` with half the time step, half the speed, and other numbers of joint points.

    python -m benchmarks.laboratory_convergence [WALL …]

The beam is driven at a constant rate, `RATE`, and only one parameter changes from row to row; as shipped, the rate is
halved until the largest force converges. Each row has this force, the secant stiffness at 0.3 of it, the displacements
at the peak and at the drop to 0.8 (for walls that reach it), relative to the first row, and the unaccounted energy.
"""

import sys
import time
from dataclasses import replace
from importlib import import_module
from unittest.mock import patch

import numpy as np

from dem.finite_system import finite_system
from dem.rigid_system import contact_points
from runningbond.dynamics import Run, State, collapse_by_steps
from runningbond.dynamics.run import MOVING
from runningbond.laboratory import chosen_walls
from runningbond.laboratory.ladder import LADDER
from runningbond.laboratory.rig import scene_of
from runningbond.laboratory.scores import Marks, marks_of
from runningbond.models import TOLERANCE
from runningbond.scene import Scene
from runningbond.scene.errors import exits_in_a_line

RATE = 0.04
"""Speed of the beam [m/s], about the one at which the largest forces of the shipped walls converge."""

POINTS = (5, 17)
"""Points along a joint, in place of `BETWEEN`."""


def follow(scene: Scene, step: float, points: int | None) -> tuple[Marks, float]:
    """Drive a wall with `step` times the stable time step; returns its marks, and the unaccounted energy at the end."""
    rule = import_module("runningbond.joints.wall_points")
    with patch.object(rule, "BETWEEN", points or rule.BETWEEN):
        run, lost = Run(finite_system(scene), local=MOVING), list[float]()
        if step != 1:
            run = Run(run.system, local=MOVING, dt=step * run.safe_step)
        at = contact_points(scene)

        def observe(run: Run, state: State, multiplier: float) -> None:
            if run.is_driven:
                lost.append(run.unaccounted(state))

        outcome = collapse_by_steps(
            scene,
            "dem-dynamic",
            run,
            TOLERANCE,
            points=at,
            point_order=np.argsort(at.joint, kind="stable"),
            is_self_locking=lambda: False,
            observe=observe,
        )
    marks = marks_of(outcome.curve, cyclic=False)
    if marks is None:
        raise SystemExit(f"{scene.title}: {outcome.status}: {outcome.message}")
    return marks, lost[-1]


def at_rate(scene: Scene, rate: float) -> Scene:
    """The scene with its beam driven at a rate [m/s]."""
    beam = scene.beam
    assert beam is not None
    assert beam.drive is not None
    return replace(scene, beam=replace(beam, drive=replace(beam.drive, rate=rate)))


def change(now: float | None, before: float | None) -> str:
    """Relative change of a number, as text."""
    return "–" if now is None or before is None else f"{now / before - 1:+.1%}"


def main(names: list[str]) -> None:
    """Print one row per wall and change."""
    walls = chosen_walls(names)
    print("| wall | what | V [kN] | V | stiffness | at the peak | at 0.8 | energy unaccounted | CPU s |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name in names:
        scene = scene_of(walls[name], LADDER["rigid-splitting"].features)
        led = at_rate(scene, RATE)
        cases: dict[str, tuple[Scene, float, int | None]] = {
            f"{RATE:g} m/s": (led, 1, None),
            "half the speed": (at_rate(scene, RATE / 2), 1, None),
            "half the step": (led, 0.5, None),
            **{f"{points} points a joint": (led, 1, points) for points in POINTS},
            "as shipped": (scene, 1, None),
        }
        first: Marks | None = None
        for what, case in cases.items():
            start = time.process_time()
            marks, lost = follow(*case)
            first = first or marks
            changes = [
                change(getattr(marks, key), getattr(first, key))
                for key in ("strength", "stiffness", "at_peak", "at_loss")
            ]
            numbers = f"{marks.strength / 1e3:.1f} | {' | '.join(changes)} | {lost:.2%}"
            print(f"| {name} | {what} | {numbers} | {time.process_time() - start:.0f} |", flush=True)


if __name__ == "__main__":
    with exits_in_a_line():
        main(sys.argv[1:] or ["SW.200.1", "WS.250"])
