"""Joints from soft to stiff: the window in which λ does not depend on them, and what is said outside it.

Soft joints let blocks sink into each other, until the wall's own weight moves it as far as a collapse does. Stiff ones
ask for short time steps, until the budget ends before the wall has had the time to fall.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from dem import limit_nonassociated
from dem.dynamic import dem_dynamic
from dem.rigid_system import rigid_system
from dem.static import dem_static
from dem.static_system import static_system
from fem_interface.model import fem
from runningbond.compare import published_scene
from runningbond.compare.figures import OURS, bare
from runningbond.dynamics import Criteria, Run, State, settle
from runningbond.dynamics.collapse import U_CRIT
from runningbond.joints.stiffness_range import SOFT
from runningbond.results import Outcome
from runningbond.scene import Scene, Stiffness

from .block_stiffness import INSET
from .finding import Edge, Entry, Finding

NORMAL = (1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15)
"""Normal stiffnesses of the joints [Pa/m]."""

RATIO = 0.4
"""k_t / k_n, that of mortar with ν = 0.2."""

FEM = (1e8, 1e12)
"""Stiffnesses between which fem is run; beyond them it takes minutes."""

MODELS = ("dem-static", "dem-dynamic", "fem")
TOLERANCE = 0.01


@dataclass(frozen=True, eq=False)
class Joints:
    """A wall with joints of one stiffness.

    Parameters
    ----------
    normal : float
        k_n [Pa/m].
    overlap : float
        Depth of one block in another under the dead load, in block sizes.
    rest : int
        Time steps to rest under it.
    condition : float
        Condition number of the static equations.
    outcomes
        Collapse by model; those that were looked for.
    """

    normal: float
    overlap: float
    rest: int
    condition: float
    outcomes: dict[str, Outcome]


def experiment() -> Finding:
    """Stiffen the joints of W1 ten thousand million times."""
    found = [with_joints(normal) for normal in NORMAL]
    scene = wall(NORMAL[0])
    exact = limit_nonassociated(scene).multiplier
    assert exact is not None
    depth = max((joints for joints in found if joints.overlap < U_CRIT), key=lambda joints: _off(joints, scene))
    edges = [
        Edge(
            f"overlap at {depth.normal:.0e} Pa/m, of all the farthest from theory [block sizes]",
            depth.overlap,
            overlap(scene, depth.normal),
            0.01,
        ),
        Edge(
            "condition number at the last stiffness by that at the first",
            found[-1].condition / found[0].condition,
            1.0,
            0.01,
        ),
    ]
    for model in MODELS:
        loads = [o.multiplier for o in (joints.outcomes.get(model) for joints in found) if o and o.multiplier]
        farthest = max(loads, key=lambda load: abs(load - exact))
        edges.append(
            Edge(f"λ, {model}, of all collapses the farthest from the certified one", farthest, exact, TOLERANCE)
        )
    sound = [joints.normal for joints in found if safe(joints)]
    return Finding(
        title="Joint stiffness",
        heads=[
            *("k_n [Pa/m]", "overlap under dead load [block sizes]", "steps to rest", "condition number"),
            *(f"{model}: {what}" for model in MODELS for what in ("status", "λ")),
            *("time steps of dem-dynamic", "said of the stiffness"),
        ],
        rows=[row(joints) for joints in found],
        edges=edges,
        trust=f"from {min(sound):.0e} to {max(sound):.0e} Pa/m on W1: overlaps at rest stay below {SOFT:.0%} of the "
        "displacement that counts as collapse, and the budget of time steps lasts; neither λ nor the conditioning of "
        "the static equations depends on the stiffness",
        beyond=beyond(found),
        draw=lambda figure: draw(figure, found, exact),
    )


def wall(normal: float) -> Scene:
    """W1 with inset joints of a normal stiffness [Pa/m]."""
    scene = published_scene("wall-w1")
    return replace(scene, joint=replace(scene.joint, inset=INSET, elasticity=Stiffness(normal, RATIO * normal)))


def overlap(scene: Scene, normal: float) -> float:
    """Depth of a wall's lowest course in its base under its own weight, in block sizes: ρ g H / k_n."""
    low, high = scene.blocks.extent(scene.wall)
    weight = scene.block.density * float(np.hypot(*scene.load.gravity)) * float((high - low)[1])
    return weight / normal / scene.block_size


def _off(joints: Joints, scene: Scene) -> float:
    return abs(joints.overlap / overlap(scene, joints.normal) - 1)


def with_joints(normal: float) -> Joints:
    """What the wall comes to with joints of a stiffness [Pa/m]."""
    scene = wall(normal)
    depth, steps = sunk(scene)
    outcomes = {"dem-static": dem_static(scene, TOLERANCE), "dem-dynamic": dem_dynamic(scene, TOLERANCE)}
    if FEM[0] <= normal <= FEM[1]:
        outcomes["fem"] = fem(scene, TOLERANCE)
    return Joints(normal, depth, steps, condition(scene), outcomes)


def sunk(scene: Scene) -> tuple[float, int]:
    """Depth of one block in another at rest under the dead load, in block sizes, and the time steps to there."""
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=np.inf))
    return -float(run.tractions(state)[0].min()) / scene.block_size, state.steps


def condition(scene: Scene) -> float:
    """Condition number of the static equations before anything opens or slides."""
    system = static_system(scene)
    normal, tangential = system.opening.toarray(), system.slip.toarray()
    stiffness = normal.T @ (system.law.normal_stiffness[:, None] * normal)
    stiffness += tangential.T @ (system.law.shear_stiffness[:, None] * tangential)
    return float(np.linalg.cond(stiffness))


def safe(joints: Joints) -> bool:
    """Whether every model found the collapse, and had nothing to say of the stiffness."""
    return all(outcome.status == "collapse" and not said(outcome) for outcome in joints.outcomes.values())


def said(outcome: Outcome) -> str:
    """What a message says of the joints' stiffness."""
    return next((part for part in outcome.message.split("; ") if part.startswith("joints are too")), "")


def beyond(found: Sequence[Joints]) -> str:
    """What dem-dynamic says on either side of the window."""
    sound = [k for k, joints in enumerate(found) if safe(joints)]
    told = []
    for k in (0, sound[0] - 1, sound[-1] + 1):
        if 0 <= k < len(found):
            outcome = found[k].outcomes["dem-dynamic"]
            told.append(f"at {found[k].normal:.0e} Pa/m {outcome.status}: {outcome.message}")
    return ". ".join(dict.fromkeys(told))


def row(joints: Joints) -> list[Entry]:
    """Row of the table."""
    models: list[Entry] = []
    for model in MODELS:
        outcome = joints.outcomes.get(model)
        if outcome is None:
            models += ["not run", "–"]
        else:
            models += [outcome.status, "–" if outcome.multiplier is None else outcome.multiplier]
    dynamic = joints.outcomes["dem-dynamic"]
    own: list[Entry] = [f"{joints.normal:.0e}", joints.overlap, joints.rest, joints.condition]
    return [*own, *models, dynamic.steps or 0, said(dynamic) or "–"]


def draw(figure: Figure, found: Sequence[Joints], exact: float) -> None:
    """λ, overlap and steps against the stiffness."""
    figure.set_size_inches(11, 4.2)
    loads, depths, steps = figure.subplots(1, 3)
    stiffness = [joints.normal for joints in found]
    for shift, model in enumerate(MODELS):
        colour, marker = OURS[model]
        first = True
        for joints in found:
            outcome = joints.outcomes.get(model)
            if outcome is None or outcome.lower is None or outcome.upper is None:
                continue
            at, paler = joints.normal * 2.0 ** (shift - 1), 1.0 if outcome.status == "collapse" else 0.4
            label = model if first else "_"
            bracket = [outcome.lower, outcome.upper]
            loads.plot([at, at], bracket, color=colour, lw=3, alpha=paler, solid_capstyle="butt", label=label)
            first = False
    loads.axhline(exact, color="0.5", lw=0.9, ls="--", label="certified")
    loads.set(ylabel="λ of wall W1, inset 20 mm", ylim=(0.97 * exact, 1.03 * exact))
    colour, marker = OURS["dem-dynamic"]
    depths.plot(stiffness, [overlap(wall(k), k) for k in stiffness], color="0.4", lw=1.2, label="ρ g H / $k_n$")
    depths.plot(
        stiffness, [joints.overlap for joints in found], marker, color=colour, mfc="none", label="dem-dynamic at rest"
    )
    depths.axhline(SOFT * U_CRIT, color="#c2410c", lw=0.9, ls="--", label="a note is made above")
    depths.axhline(U_CRIT, color="#c2410c", lw=0.9, label="counts as collapse")
    depths.set(yscale="log", ylabel="overlap under dead load [block sizes]")
    steps.plot(
        stiffness, [joints.rest for joints in found], marker, color=colour, mfc="none", label="to rest under dead load"
    )
    dynamic = [joints.outcomes["dem-dynamic"] for joints in found]
    ended = [(k, outcome.steps) for k, outcome in zip(stiffness, dynamic, strict=True) if outcome.lower is not None]
    steps.plot(*zip(*ended, strict=True), marker, color=colour, label="to the bracket of λ")
    steps.set(yscale="log", ylabel="time steps of dem-dynamic")
    for axes in (loads, depths, steps):
        axes.set(xscale="log", xlabel="normal stiffness of joints [Pa/m]")
        axes.legend(frameon=False, fontsize=8)
        bare(axes)
