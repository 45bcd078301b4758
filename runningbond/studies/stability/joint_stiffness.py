"""Joints from soft to stiff: the range in which λ does not depend on their stiffness, and the messages outside it.

Soft joints let blocks overlap, by ρ g H / k_n at the base, until the wall's own weight moves it as far as a collapse
does. Stiff joints require short time steps, until the budget ends before the wall has had the time to collapse.
"""

import numpy as np
from matplotlib.figure import Figure

from dem.rigid_system import rigid_system
from dem.static_system import static_system
from runningbond.dynamics import U_CRIT, Criteria, Run, State, settle
from runningbond.joints.stiffness import SOFT
from runningbond.models import MODEL_LOOKS, MODELS, TOLERANCE
from runningbond.pictures.charts import LOOKS, bracket
from runningbond.scene import Scene, Stiffness
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study, run_around
from runningbond.studies.walls import W1, inset_wall, known_wall, outcome_row

NORMAL = tuple(10.0**power for power in range(5, 16))  # normal stiffnesses of the joints [Pa/m]
OWN = 1e11  # of these, the one nearest to the stiffness of W1's joints
RATIO = 0.4  # k_t / k_n, that of mortar with ν = 0.2
FEM = (1e8, 1e12)  # stiffnesses between which fem is run; outside it takes minutes
RUN = ("dem-static", "dem-dynamic", "fem")  # models that depend on the stiffness
REST, COLLAPSES, K_N = "W1 at rest under its weight", "W1 brought to collapse", "k_n [Pa/m]"
OVERLAP, THEORY, STEPS = "overlap [block sizes]", "ρ g H / k_n", "steps to rest"
CONDITION = "condition number"


def wall(normal: float) -> Scene:
    """W1 with inset joints of a given normal stiffness [Pa/m]."""
    return inset_wall("wall-w1").with_joint(elasticity=Stiffness(normal, RATIO * normal))


def overlap(scene: Scene, normal: float) -> float:
    """Overlap of a wall's lowest course and its base under its own weight, in block sizes: ρ g H / k_n."""
    low, high = scene.blocks.extent(scene.wall)
    weight = scene.block.density * float(np.hypot(*scene.load.gravity)) * float((high - low)[1])
    return weight / normal / scene.block_size


def at_rest(normal: float) -> Row:
    """Largest overlap of blocks under the dead load, steps to rest, and conditioning of the static equations."""
    scene = wall(normal)
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=np.inf))
    depth = -float(run.tractions(state)[0].min()) / scene.block_size
    return {OVERLAP: depth, THEORY: overlap(scene, normal), STEPS: state.steps, CONDITION: condition(scene)}


def condition(scene: Scene) -> float:
    """Condition number of the static equations before any joint opens or slides."""
    system = static_system(scene)
    normal, tangential = system.opening.toarray(), system.slip.toarray()
    stiffness = normal.T @ (system.law.normal_stiffness[:, None] * normal)
    stiffness += tangential.T @ (system.law.shear_stiffness[:, None] * tangential)
    return float(np.linalg.cond(stiffness))


def collapse(normal: float, model: str) -> Row:
    """Outcome of a model for the wall."""
    outcome = MODELS[model].solve(wall(normal), TOLERANCE)
    return {"of the stiffness": stiffness_note(outcome.message), **outcome_row(outcome)}


def stiffness_note(message: str) -> str:
    """The note on the stiffness of joints in a message."""
    return next((part for part in message.split("; ") if part.startswith("joints are too")), "")


def fits(rows: Rows) -> list[Edge]:
    """Edges: overlap, conditioning, λ farthest from theory; smallest and largest k_n without a note of any model."""
    rest = [row for row in rows[REST] if row[OVERLAP] < U_CRIT]
    deepest = max(rest, key=lambda row: abs(row[OVERLAP] / row[THEORY] - 1))
    worse, exact = rows[REST][-1][CONDITION] / rows[REST][0][CONDITION], known_wall(W1).multiplier
    edges = [
        Edge(f"overlap at {deepest[K_N]:.0e} Pa/m, farthest from theory", deepest[OVERLAP], deepest[THEORY], 0.01),
        Edge("condition number at the last stiffness by that at the first", worse, 1.0, 0.01),
    ]
    for model in RUN:
        loads = [row["λ"] for row in rows[COLLAPSES] if row["model"] == model and row.get("λ")]
        farthest = max(loads, key=lambda load: abs(load - exact))
        edges.append(Edge(f"λ, {model}, of all collapses farthest from the certified", farthest, exact, TOLERANCE))
    bad = {row[K_N] for row in rows[COLLAPSES] if row["status"] != "collapse" or row.get("of the stiffness")}
    ends = zip(("smallest", "largest"), run_around(OWN, NORMAL, {*NORMAL} - bad), strict=True)
    return edges + [
        Edge(f"{end} k_n at which all models collapse and say nothing [Pa/m]", value) for end, value in ends
    ]


def _draw(figure: Figure, rows: Rows) -> None:
    loads, depths, steps = figure.subplots(1, 3)
    for place, model in enumerate(RUN):
        for row in rows[COLLAPSES]:
            if row["model"] == model and row.get("λ upper") and row.get("λ lower") is not None:
                bracket(loads, row[K_N] * 2.0 ** (place - 1), row, MODEL_LOOKS[model][0], lw=3)
        loads.plot([], [], color=MODEL_LOOKS[model][0], lw=3, label=model)
    exact = known_wall(W1).multiplier
    loads.plot([], [], "s", color="0.3", mfc="white", label="hollow: no collapse load found")
    loads.axhline(exact, color="0.5", lw=0.9, ls="--", label="certified")
    loads.set(ylabel="λ of wall W1, inset 20 mm", ylim=(0.97 * exact, 1.03 * exact))
    colour, marker = MODEL_LOOKS["dem-dynamic"]
    overlaps, theory, rests = ([row[head] for row in rows[REST]] for head in (OVERLAP, THEORY, STEPS))
    hollow, filled = ({"marker": marker, "color": colour, "mfc": fill, "ls": "none"} for fill in ("none", colour))
    depths.plot(NORMAL, theory, color="0.4", lw=1.2, label="ρ g H / $k_n$")
    depths.plot(NORMAL, overlaps, **hollow, label="dem-dynamic at rest")
    depths.axhline(SOFT * U_CRIT, color=LOOKS[3][0], lw=0.9, ls="--", label="a note is made above")
    depths.axhline(U_CRIT, color=LOOKS[3][0], lw=0.9, label="counts as collapse")
    depths.set(yscale="log", ylabel="overlap under dead load [block sizes]")
    ended = [row for row in rows[COLLAPSES] if row["model"] == "dem-dynamic" and row.get("λ lower") is not None]
    steps.plot(NORMAL, rests, **hollow, label="to rest under dead load")
    steps.plot([row[K_N] for row in ended], [row["steps"] for row in ended], **filled, label="to the bracket of λ")
    steps.set(yscale="log", ylabel="time steps of dem-dynamic")
    for axes in (loads, depths, steps):
        axes.set(xscale="log", xlabel="normal stiffness of joints [Pa/m]")
        axes.legend()


CASES = [(k, model) for k in NORMAL for model in RUN if model != "fem" or FEM[0] <= k <= FEM[1]]
STUDY = Study(
    "joint-stiffness",
    "Joint stiffness",
    trusted="overlaps at rest are far below the displacement that counts as collapse, and the budget of time steps "
    "suffices; there neither λ nor the conditioning of the static equations depends on the stiffness",
    beyond="softer: a message that joints are too soft; stiffer than any here: `undecided`, because the budget runs "
    "out, with the time for which each load was followed",
    parts={REST: Part((K_N,), [*zip(NORMAL)], at_rest), COLLAPSES: Part((K_N, "model"), CASES, collapse)},
    charts=[Chart("λ, overlap under the dead load and time steps of joints from soft to stiff", _draw, size=(11, 4.6))],
    fits=fits,
)
