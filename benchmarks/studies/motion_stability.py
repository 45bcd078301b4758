"""Reliability of the response of `dem-dynamic` to ground motion: four Markdown tables.

    PYTHONPATH=. python benchmarks/studies/motion_stability.py [block | contacts | mesh | wall]

The first three are for the block of 0.5 × 2 m beside Housner's equation: joint stiffness, viscous damping and time
step, one varied at a time from the suite's values; impacts, with different numbers of contact points; and the mesh of
`fem`, also for the wall. The fourth is for a wall of 12 blocks under one sine and under seconds of noise, at peak
accelerations around the critical one, for `DRAWS` draws with slightly different joints (`SCATTER`): the number of
falls, the drifts of the walls that stand, and the peak acceleration at which each draw begins to fall.
"""

import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from itertools import pairwise

import numpy as np

import runningbond as rb
from fem_interface.finite_system import finite_system as fem_system
from fem_interface.node_outline import node_outline
from runningbond.joints.wall_law import with_impacts
from runningbond.response import Response, follow
from runningbond.response.resting import VISCOUS, Resting
from runningbond.scene import History, Scene, Stiffness
from tests.response.housner import GRAVITY, HousnerBlock, edge
from tests.response.walls import block, resting, shaken, still

FOLLOW = import_module("runningbond.response.follow")
BLOCK = HousnerBlock()
UNIT = GRAVITY * BLOCK.b / BLOCK.h
EDGES = ((0.5, 4, 2.798, 0.12), (1.0, 4, 1.780, 0.12), (1.0, 4, 5.3174, 0.04))
"""Cycles, ω / p, overturning amplitude of Housner's block in g tan α, and relative width of the search around it.

The block overturns before an impact, after one, and again before one.
"""

STIFFNESS, PART = 1e10, float(vars(FOLLOW)["PART"])
SETTINGS = (
    *((f"stiffness {k:.0e} Pa/m".replace("+", ""), k, VISCOUS, PART) for k in (1e8, 1e9, 1e10, 1e11, 1e12)),
    *((f"viscous ratio {ratio:g}", STIFFNESS, ratio, PART) for ratio in (0.01, 0.1, 0.5, 2.0)),
    *((f"{part:g} of the stable step", STIFFNESS, VISCOUS, part) for part in (0.2, 0.5, 1.0)),
)
"""Joint stiffness [Pa/m], viscous damping ratio at the highest frequency, and part of the stable time step."""

MESHES: dict[str, dict[str, int]] = {
    "`fem`, its 3 rigid modes": {"cells": 1, "modes": 3},
    "`fem`, 1 × 1 cells": {"cells": 1},
    "`fem`, 2 × 2 cells": {"cells": 2},
    "`fem`, 4 × 4 cells": {"cells": 4},
    "`fem`, 4 × 4 cells, 8 modes": {"cells": 4, "modes": 8},
}
"""Cells along each side of a block, and number of modes if not all are included."""

DRAWS, SCATTER = 6, {"stiffness": 0.01, "friction": 0.001}
PEAKS = {"one sine": [1.08 * 1.04**k for k in range(7)], "4 s of noise": [0.64 * 1.1**k for k in range(10)]}
FIRST = {"one sine": 1.21, "4 s of noise": 0.81}
"""Peak ground accelerations [g] of the runs, and approximate peak acceleration at which the wall begins to fall."""

DEFORMABLE, FARTHER = 1.17, 0.08
"""Approximate peak acceleration [g] at which a wall begins to fall, with rigid or with deformable blocks, which fall
earlier; and relative width of the search around it."""


def on_the_block() -> Iterator[str]:
    """Rows: errors of the overturning amplitudes, and the largest unaccounted share of energy in these runs."""
    yield "| setting | falls before an impact | after one | again before | energy missed, at most |"
    yield "|---|---|---|---|---|"
    for name, stiffness, viscous, part in SETTINGS:
        setattr(FOLLOW, "PART", part)  # noqa: B010 (of a module that no name leads to)
        rest = replace(resting(block(BLOCK.b, BLOCK.h, still(), stiffness=stiffness)), viscous=viscous)
        runs: list[Response] = []
        cells = [off(rest, *each, runs) for each in EDGES]
        yield f"| {name} | {' | '.join(cells)} | {max(run.unaccounted for run in runs):.1%} |"
    setattr(FOLLOW, "PART", PART)  # noqa: B010


def on_contacts() -> Iterator[str]:
    """Rows: first peak under half a sine, and ratio of rotation rates at impacts, for the block on more contacts."""
    yield "| contacts | first peak [α] | rate after an impact over that before |"
    yield "|---|---|---|"
    period, amplitude = math.pi / BLOCK.p, 1.4 * UNIT
    yield f"| Housner's | {BLOCK.peak(amplitude, period, 0.5) / BLOCK.alpha:.3f} | {BLOCK.restitution:.3f} |"
    history, scene = shaken("half-sine", amplitude, period), block(BLOCK.b, BLOCK.h, still())
    crushing = scene.with_joint(compressive_strength=1e9)  # never reached
    size = {"block_width": 2 * BLOCK.b, "block_height": 2 * BLOCK.h, "thickness": 0.12}
    laid = rb.Wall.courses([[1]], **size, density=1800.0, friction=2.0).scene
    bonded = replace(laid, joint_materials=scene.joint_materials, load=scene.load)
    rigid = {f"`fem`, 3 modes, base of {2 * n} facets": at_rest(bonded, {"cells": n, "modes": 3}) for n in (1, 2, 4)}
    rests = {"`dem-dynamic`, dry: two": resting(scene), "`dem-dynamic`, crushing: nine": resting(crushing), **rigid}
    for name, rest in rests.items():
        response = follow(under(rest, history), 1.0, points=np.array([[0.0, 2 * BLOCK.h], [2 * BLOCK.b, 2 * BLOCK.h]]))
        width, height = np.diff(response.displacement, axis=1)[:, 0].T
        turn = np.arctan2(height, 2 * BLOCK.b + width) / BLOCK.alpha
        swings = np.split(np.abs(turn), np.flatnonzero(np.diff(np.sign(turn))) + 1)
        peaks = [swing.max() for swing in swings if swing.max() > 0.01][:3]
        # An impact reduces the energy of one turning point to that of the next.
        left = [math.cos(BLOCK.alpha * (1 - peak)) - math.cos(BLOCK.alpha) for peak in peaks]
        rates = ", ".join(f"{math.sqrt(after / before):.3f}" for before, after in pairwise(left))
        yield f"| {name} | {peaks[0]:.3f} | {rates} |"


def on_the_mesh() -> Iterator[str]:
    """Rows by mesh: errors of the overturning amplitudes, and peak acceleration at which the wall begins to fall."""
    heads = ("falls before an impact", "after one", "again before", "energy missed, at most", "wall's first fall [g]")
    yield f"| blocks | {' | '.join(heads)} |"
    yield "|---|---|---|---|---|---|"
    settings: dict[str, dict[str, int] | None] = {"`dem-dynamic`": None, **MESHES}
    for name, mesh in settings.items():
        rests = [at_rest(scene, mesh) for scene in (block(BLOCK.b, BLOCK.h, still(), stiffness=STIFFNESS), wall())]
        runs, history = list[Response](), wall().history
        assert history is not None
        cells = [off(rests[0], *each, runs) for each in EDGES]
        missed = max(run.unaccounted for run in runs)
        yield f"| {name} | {' | '.join(cells)} | {missed:.1%} | {first(rests[1], history, DEFORMABLE, FARTHER)} |"


def at_rest(scene: Scene, mesh: dict[str, int] | None) -> Resting:
    """A scene at rest, with rigid blocks or with a mesh of blocks of 10 GPa."""
    if mesh is None:
        return resting(scene)
    blocks = node_outline(with_impacts(scene.with_block(young=1e10, poisson=0.2)), mesh["cells"], mesh.get("modes"))
    return Resting.of(scene, "fem", fem_system(blocks))


def off(rest: Resting, cycles: float, ratio: float, exact: float, width: float, runs: list[Response]) -> str:
    """Relative error of the block's overturning amplitude; no other change of the verdict is within the width."""
    history = shaken("sine" if cycles == 1 else "half-sine", UNIT, 2 * math.pi / (ratio * BLOCK.p))
    found = edge(lambda scale: fallen(under(rest, history), scale, runs), exact, width, 3e-3)
    return f"{found / exact - 1:+.1%}" if found else f"over {width:.0%}"


def fallen(rest: Resting, scale: float, runs: list[Response]) -> bool:
    """Whether a wall falls; its response is appended to `runs`."""
    runs.append(follow(rest, scale, rows=50))
    return runs[-1].verdict == "collapse"


def under(rest: Resting, history: History) -> Resting:
    """A wall at rest, with another ground motion."""
    return replace(rest, scene=replace(rest.scene, load=replace(rest.scene.load, live=(history,))))


def noise(seconds: float = 4.0, seed: int = 1) -> History:
    """White noise between 0.5 and 5 Hz with a half-sine envelope and a peak of 1 g."""
    random = np.random.default_rng(seed)
    time, frequency = np.linspace(0, seconds, 801), np.arange(0.5, 5.0, 1 / seconds)
    phases, sizes = random.uniform(0, 2 * np.pi, len(frequency)), random.normal(size=len(frequency))
    values = np.sin(np.pi * time / seconds) * (sizes @ np.sin(2 * np.pi * np.outer(frequency, time) + phases[:, None]))
    return History(time, np.column_stack([values / np.abs(values).max(), 0 * time]), "g")


def wall() -> Scene:
    """A wall of eight courses, alternately one block of 500 × 250 mm and two halves."""
    size = {"block_width": 0.5, "block_height": 0.25, "thickness": 0.3, "density": 2000.0, "friction": 0.7}
    pulse = {"pulse": {"kind": "sine", "amplitude": 1.0, "period": 0.5}, "quantity": "g"}
    return rb.Wall.courses(
        [[1], [0.5, 0.5]] * 4, **size, normal_stiffness=1e9, shear_stiffness=4e8, history=pulse
    ).scene


def drawn(scene: Scene, seed: int) -> Resting:
    """A wall at rest, with joint stiffness and friction changed at random within `SCATTER`."""
    stiffer, rougher = 1 + np.array(list(SCATTER.values())) * np.random.default_rng(seed).uniform(-1, 1, 2)
    joint = scene.joint
    assert isinstance(joint.elasticity, Stiffness)
    normal, shear = joint.elasticity.normal, joint.elasticity.shear
    changed = scene.with_joint(
        elasticity=Stiffness(stiffer * normal, stiffer * shear), friction=float(rougher * joint.friction)
    )
    return resting(changed)


def on_the_wall() -> Iterator[str]:
    """Rows: falls and peak drifts of the draws, at peak accelerations around the critical one."""
    scene = wall()
    rests = [drawn(scene, seed) for seed in range(DRAWS)]
    yield "| motion | peak [g] | fall | peak drift of the others | energy missed, at most |"
    yield "|---|---|---|---|---|"
    for history, (name, peaks) in zip((scene.history, noise()), PEAKS.items(), strict=True):
        assert history is not None
        for peak in peaks:
            runs = list[Response]()
            falls = sum(fallen(under(rest, history), peak, runs) for rest in rests)
            drifts = [run.peak_drift for run in runs if run.verdict != "collapse"]
            across = f"{min(drifts):.3f} … {max(drifts):.3f}" if drifts else "–"
            missed = max(run.unaccounted for run in runs)
            yield f"| {name} | {peak:.2f} | {falls} of {DRAWS} | {across} | {missed:.1%} |"
    yield "\n| motion | smallest peak at which a draw falls [g], by draw |\n|---|---|"
    for history, (name, about) in zip((scene.history, noise()), FIRST.items(), strict=True):
        assert history is not None
        yield f"| {name} | {', '.join(first(rest, history, about) for rest in rests)} |"


def first(rest: Resting, history: History, about: float, width: float = 0.06) -> str:
    """Peak acceleration at which a wall begins to fall, searched around a given one."""
    found = edge(lambda peak: fallen(under(rest, history), peak, []), about, width, 2e-3)
    return f"{found:.3f}" if found else f"not within {width:.0%} of {about:g}"


if __name__ == "__main__":
    tables = {"block": on_the_block, "contacts": on_contacts, "mesh": on_the_mesh, "wall": on_the_wall}
    if unknown := [part for part in sys.argv[1:] if part not in tables]:
        sys.exit(f"no such part: {unknown[0]}; there are {', '.join(tables)}")
    for part in sys.argv[1:] or tables:
        for line in tables[part]():
            print(line, flush=True)
        print()
