"""Small against finite displacements: how far a wall may move before its small-displacement curve becomes wrong.

A block b × h that rocks about its corner has the capacity λ(θ) = tan(α − θ), tan α = b/h, when its upper corner has
moved by u = h sin θ; at small displacements its capacity remains b/h. A share d of λ is therefore lost at

    u = h sin(α − arctan((1 − d) b/h)) ≈ d h / (λ + 1/λ),  λ = b/h,                                          (1)

and walls that overturn as a whole about a corner of their base lose about as much, with their own λ and height.
"""

import math
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from runningbond.models import TOLERANCE
from runningbond.pictures.charts import looks_of
from runningbond.scene import Array, Mortar, Scene
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study
from runningbond.studies.walls import inset_wall, one_block

LOSSES = (0.01, 0.02, 0.05, 0.1)  # shares of the small-displacement λ whose loss is determined
WIDTH, HEIGHT = 0.5, 1.0  # of the block [m]
SOFTER = 0.1  # modulus of the mortar in walls, relative to the published one; affects the time step, not the falling λ
FARTHEST = 0.25  # displacement to which scenes are pushed, in block widths
WALLS = ("block", "W1", "W2")
ALONE = 2e-5  # tolerance of the block's curve, of which 1 % is to be resolved; curves of walls are less smooth
PART, PEAK, TALL = "λ lost past the peak", "λ, small", "height / block width"
MOVED, THEORY = ([f"u/b at {100 * d:.0f} % lost{whose}" for d in LOSSES] for whose in ("", ", one block"))


def scene_of(name: str) -> tuple[Scene, float]:
    """A rocking block, or a published wall with inset joints and a softer mortar, and the width of a block [m]."""
    if name == "block":
        return one_block(WIDTH, HEIGHT, 2.0, 1e10), WIDTH
    scene = inset_wall(f"wall-{name.lower()}")
    mortar = scene.joint.elasticity
    assert isinstance(mortar, Mortar)
    assert scene.bond is not None
    softer = replace(mortar, young=SOFTER * mortar.young)
    return scene.with_joint(elasticity=softer), scene.bond.width


def curves(scene: Scene, width: float, tolerance: float) -> tuple[float, Array, Array, Array]:
    """Push a scene at small and at finite displacements, more slowly until the curve changes by less than a tolerance.

    Returns the final λ at small displacements and, from the peak of the finite curve on, u / b and λ of both, ``(n,)``.
    """
    distance = FARTHEST * width
    static = dem_static(scene, collapse=2 * distance / scene.lowest_block).curve
    u, finite = dem_dynamic(scene, tolerance, displacements="finite", distance=distance).curve.T
    peak = int(np.argmax(finite))
    u, finite = u[peak:], finite[peak:]
    return float(static[-1, 1]), u / width, np.interp(u, static[:, 0], static[:, 1]), finite


def as_one_block(peak: float, tall: float, loss: float) -> float:
    """Displacement, in block widths, at which one block of the same height and λ has lost a share of λ, by (1)."""
    return tall * math.sin(math.atan(peak) - math.atan((1 - loss) * peak))


def displacement_at(moved: Array, lost: Array, loss: float) -> float:
    """Displacement, in block widths, beyond which more than a share of λ is lost."""
    last = int(np.flatnonzero(lost < loss)[-1])
    assert last + 1 < len(lost), "not pushed far enough"
    return float(np.interp(loss, lost[last : last + 2], moved[last : last + 2]))


def measure(name: str) -> Row:
    """Displacements at which a scene has lost shares of its small-displacement λ."""
    scene, width = scene_of(name)
    peak, moved, small, finite = curves(scene, width, ALONE if name == "block" else TOLERANCE)
    low, high = scene.blocks.extent(scene.wall)
    tall = float(high[1] - low[1]) / width
    row: Row = {PEAK: peak, TALL: tall}
    for loss, head, theory in zip(LOSSES, MOVED, THEORY, strict=True):
        row |= {head: displacement_at(moved, 1 - finite / small, loss), theory: as_one_block(peak, tall, loss)}
    return row | {"moved": moved.tolist(), "small": small.tolist(), "finite": finite.tolist()}


def fits(rows: Rows) -> list[Edge]:
    """Edges: displacements at which λ is lost, of the block beside (1), of walls as measured, and the error of (1)."""
    edges, apart = [], 0.0
    for row in rows[PART]:
        for loss, head, theory in zip(LOSSES, MOVED, THEORY, strict=True):
            known = (row[theory], 2e-3) if row["what"] == "block" else ()
            edges.append(Edge(f"u/b at which {row['what']} has lost {100 * loss:.0f} % of λ", row[head], *known))
            apart = apart if known else max(apart, abs(row[head] / row[theory] - 1))
    return [*edges, Edge("walls beside one block of their λ and height, off by at most [%]", 100 * apart)]


def _draw(figure: Figure, rows: Rows) -> None:
    curves, losses = figure.subplots(1, 2)
    looks, shares = looks_of(WALLS), np.linspace(0.001, 0.2, 50)
    for row in rows[PART]:
        colour, finite, small = looks[row["what"]][0], np.array(row["finite"]), np.array(row["small"])
        curves.plot(row["moved"], finite, color=colour, lw=1.4)
        curves.plot(row["moved"], small, color=colour, lw=1.0, ls="--")
        losses.plot(row["moved"], 100 * (1 - finite / small), color=colour, lw=1.4, label=row["what"])
        theory = [as_one_block(row[PEAK], row[TALL], d) for d in shares]
        losses.plot(theory, 100 * shares, color=colour, lw=1.2, ls=":")
    curves.plot([], [], color="0.3", ls="--", lw=1.0, label="small displacements")
    curves.plot([], [], color="0.3", lw=1.4, label="finite displacements")
    curves.set(ylabel="load multiplier λ", ylim=(0, None), xlim=(0, FARTHEST))
    losses.plot([], [], color="0.3", ls=":", lw=1.2, label="one block of that λ and height")
    losses.set(ylabel="λ lost [%]", xlim=(0, 0.2), ylim=(0, 15), yticks=[*(100 * d for d in LOSSES), 15])
    losses.grid(axis="y", color="0.9", lw=0.8)
    for axes, corner in ((curves, "lower left"), (losses, "lower right")):
        axes.set_xlabel("displacement of the top, in block widths u / b")
        axes.legend(loc=corner)


STUDY = Study(
    "displacements",
    "Small displacements: how far a wall may move before λ is no longer that of its undeformed shape",
    trusted="until a share d of λ is lost, at about u = d H / (λ + 1/λ), the value for a single block of the wall's "
    "height H and λ",
    beyond="a model at small displacements reports it in its message and continues at the same λ; `displacements = "
    '"finite"` gives the falling curve',
    parts={PART: Part(("what",), [(what,) for what in WALLS], measure)},
    charts=[Chart("λ past its peak at small and finite displacements, and what is lost between", _draw, size=(9, 4.8))],
    fits=fits,
)
