"""Model ``dem-static``: rigid blocks on elastic, frictional joint points, pushed over along their equilibrium path.

The paper's second solver (Sec. 3) sets the stiffness of violated joint actions to zero and solves again, which
cycles or goes singular below collapse (`stiffness_update`). Here every step is brought to true equilibrium under the
displacement of the live load by Newton's method with the consistent Coulomb tangent and a vanishing proximal term
(`relaxation`). Of the routes that were tried on the published walls,

- Newton's method with a line search on the residual stalls: the tangent turns singular under loose blocks, and the
  residual is a poor measure of progress, as a contact that closes a little too far makes it grow a thousandfold;
- a proximal term that falls with the residual alone gets past the stall, but creeps or falls into cycles of two;
- one that follows how well the linear model foretold the forces does neither: 15 to 50 linear systems a step, on
  walls with openings as on others, and the same with its parameters changed two- or threefold;
- a step that is only ever shortened gets stuck where the wall snaps; tried longer as well it lands beyond.

Friction is never frozen and no convex program is solved, so the cost is that of sparse LU factors of one pattern.
A state of equilibrium need not be stable: walls of upright blocks snap, and where they do depends on the steps. Hence
the peak is only believed when halving the steps leaves it in place.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from results import Outcome
from scene import Array, Scene

from .kinematics import control_row, movable_freedoms
from .limit import FALLS, locks, stands_under_dead_load
from .pushover import EASY, LONGER, SHORTER, Curve, elastic_response, under_dead_load
from .static_system import StaticSystem, static_system

FIRST_STEP = 0.03
"""First step, by the multiplier it would add to the elastic wall, in units of `Equilibrium`."""

COLLAPSE = 0.1
"""Motion of a block to which a curve is followed at least, in heights of the lowest block."""

FARTHEST = 50.0
"""Motion, in those of `COLLAPSE`, at which a curve that still rises is given up."""

HALVINGS = 3
"""How often the steps are halved until the peak stays where it is."""

MOST_PARTS = 16
"""Half of the largest number of steps that one step is divided into."""

NOISE = 1e-6
"""Difference of λ that is put down to unbalanced forces, relative to the peak; and λ itself, in scaled units."""

BUDGET = 40_000
"""Linear systems after which a curve is left where it is."""

LOCKED = 1.5
"""Growth of λ over the last doubling of the displacement of a wall that may be locked."""


def dem_static(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    first_step: float = FIRST_STEP,
    collapse: float = COLLAPSE,
    budget: int = BUDGET,
) -> Outcome:
    """Collapse of a scene at the peak of its pushover curve, at small displacements.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness.
    tolerance
        Relative width of the bracket.
    first_step
        First step, by the multiplier it would add to the elastic wall: in live loads as large as the largest
        dead one, for a weightless wall as the strongest joint point.
    collapse
        Motion of a block to which the curve is followed at least, in heights of the lowest block.
    budget
        Linear systems after which it is given up.

    Returns
    -------
    Outcome
        The curve is drawn again with steps halved on the way to its peak until that stays where it is. `lower` is
        the lower peak of the last two curves, a load in equilibrium; `upper` is the higher one, or what the last
        curve may have reached between its states, or would reach if its displacement were doubled once more.
        `multiplier`, `curve`, `motion` and `force` are of the last curve.
    """
    start = time.perf_counter()
    system = static_system(scene)
    found = Outcome(scene.title, "dem-static", "undecided", dofs=system.freedoms)
    rest = under_dead_load(system)
    if rest is None:
        found = _fallen(found, system)
    else:
        far = collapse * scene.lowest_block / system.length_unit
        found = _drawn(found, Drawing(system, rest, first_step, far, tolerance, budget))
    return replace(found, seconds=time.perf_counter() - start)


@dataclass(frozen=True, eq=False)
class Drawing:
    """How pushover curves are drawn.

    Parameters
    ----------
    system
        The static equations.
    rest
        Curve with nothing but its first state, at rest under the dead load.
    first_step : float
        First step's λ on the elastic wall, in units of `Equilibrium`.
    far : float
        Motion of a block to which a curve is followed at least, in units of the system.
    tolerance : float
        Relative width of the bracket.
    budget : int
        Linear systems a curve may take.
    """

    system: StaticSystem
    rest: Curve
    first_step: float
    far: float
    tolerance: float
    budget: int

    def draw(self, plan: Array) -> tuple[Curve, str]:
        """Draw a curve through planned displacements ``(n,)`` and on by itself, and say how it ended.

        It ends ``settled``, ``rising`` where it never did, ``broken`` where no equilibrium was found, or
        ``long`` where the budget ran out.
        """
        curve = Curve(self.system, self.rest.states[:1], 0)
        step = self.first_step / float(elastic_response(self.system)[-1])
        while True:
            now = curve.displacement[-1]
            ahead = plan[plan > now + 1e-9 * step]
            made = curve.push(ahead[0] - now if len(ahead) else step)
            if made is None:
                return curve, "broken"
            step = made[0] * min(max((EASY / max(made[1], 1)) ** 0.5, SHORTER), LONGER)
            if curve.moved >= self.far and self.settled(curve):
                return curve, "settled"
            if curve.moved >= FARTHEST * self.far:
                return curve, "rising"
            if curve.solves > self.budget:
                return curve, "long"

    def settled(self, curve: Curve) -> bool:
        """Whether a curve would not rise above its peak if its displacement were doubled once more."""
        reached = curve.multiplier[-1] + last_rise(curve)
        return bool(reached <= (1 + self.tolerance / 2) * curve.multiplier.max())

    def halved(self, curve: Curve) -> Array:
        """Displacements that halve a curve's steps on the way to its peak, and divide them finer where it may hide."""
        displacement, multiplier = curve.displacement, curve.multiplier
        peak = float(multiplier.max())
        way = np.arange(len(multiplier) - 1) <= np.argmax(multiplier >= (1 - self.tolerance / 2) * peak)
        hidden = (ceilings(displacement, multiplier) - peak) / (peak or 1.0)
        # What a chord's extension claims shrinks with its length.
        finer = np.minimum(np.ceil(4 * hidden / self.tolerance), MOST_PARTS).astype(int)
        parts = np.where(finer > 1, 2 * finer, np.where(way, 2, 1))
        pieces = [
            np.linspace(a, b, n + 1)[1:] for a, b, n in zip(displacement[:-1], displacement[1:], parts, strict=True)
        ]
        return np.concatenate(pieces)


def ceilings(displacement: Array, multiplier: Array) -> Array:
    """Highest λ that a curve may have reached between its states ``(n,)``, ``(n − 1,)``.

    Where a curve is concave it lies below the extensions of its chords on either side. A chord is only extended
    where the next one is less steep, or as steep but for the noise of equilibrium; the far side of a snap is thus
    not taken for the near one.
    """
    width, slope = np.diff(displacement), np.diff(multiplier) / np.diff(displacement)
    highest = np.maximum(multiplier[:-1], multiplier[1:])
    for k in range(len(slope)):
        noise = NOISE * multiplier.max() / width[k]
        left = slope[k - 1] if k > 0 and slope[k - 1] > slope[k] + noise else None
        right = slope[k + 1] if k + 1 < len(slope) and slope[k + 1] < slope[k] + noise else None
        rise = multiplier[k + 1] - multiplier[k]
        if left is not None and right is not None:
            meet = np.clip((rise - right * width[k]) / (left - right), 0.0, width[k])
            highest[k] = max(highest[k], multiplier[k] + left * meet)
        elif left is not None:
            highest[k] = max(highest[k], multiplier[k] + left * width[k])
        elif right is not None:
            highest[k] = max(highest[k], multiplier[k + 1] - right * width[k])
    return highest


def ceiling(curve: Curve) -> float:
    """Highest λ that a curve may have reached, or would reach if its displacement were doubled once more."""
    between = float(ceilings(curve.displacement, curve.multiplier).max())
    return max(between, float(curve.multiplier[-1]) + last_rise(curve))


def last_rise(curve: Curve) -> float:
    """Rise of λ over the last doubling of a curve's displacement; no less than nothing."""
    displacement, multiplier = curve.displacement, curve.multiplier
    return float(max(0.0, multiplier[-1] - np.interp(displacement[-1] / 2, displacement, multiplier)))


def _drawn(found: Outcome, drawing: Drawing) -> Outcome:
    """Draw curves until the peak stays where it is."""
    unit = drawing.system.equilibrium.live_unit
    plan, peaks, solves = np.zeros(0), list[float](), drawing.rest.solves
    for _ in range(1 + HALVINGS):
        curve, end = drawing.draw(plan)
        solves += curve.solves
        found = replace(_shown(found, drawing.system, curve), steps=solves)
        if end != "settled":
            return _unsettled(found, drawing.system, curve, end)
        peaks = [*peaks, float(curve.multiplier.max())][-2:]
        lower, upper = min(peaks), max(*peaks, ceiling(curve))
        found = replace(found, lower=unit * lower, upper=unit * upper)
        if len(peaks) == 2 and upper - lower <= drawing.tolerance * max(upper, NOISE):
            message = _evidence(drawing.system, curve, unit * abs(peaks[1] - peaks[0]))
            return replace(found, status="collapse", multiplier=unit * peaks[1], message=message)
        plan = drawing.halved(curve)
    return replace(found, message=f"collapse, but the peak still moves after {HALVINGS} halvings of the steps")


def _evidence(system: StaticSystem, curve: Curve, change: float) -> str:
    """What a collapse is believed by."""
    heights = curve.moved * system.length_unit / system.equilibrium.scene.lowest_block
    return (
        f"peak of the pushover curve at small displacements, followed to {heights:.2g} block heights; "
        f"halving the steps moved it by {change:.0e}"
    )


def _shown(found: Outcome, system: StaticSystem, curve: Curve) -> Outcome:
    """The arrays of an outcome: curve, mechanism at its end and forces at its peak."""
    equations, states = system.equilibrium, curve.states
    row = control_row(equations.scene)[movable_freedoms(equations.scene)] * equations.scale * system.length_unit
    q = np.array([state.x[: system.freedoms] for state in states])
    motion = equations.motion(q[-1] - q[-2]) if len(states) > 1 else np.zeros((0, 3))
    return replace(
        found,
        curve=np.column_stack([(q - q[0]) @ row, equations.live_unit * curve.multiplier]),
        motion=motion,
        force=equations.force_unit * states[int(np.argmax(curve.multiplier))].force,
    )


def _unsettled(found: Outcome, system: StaticSystem, curve: Curve, end: str) -> Outcome:
    """Outcome of a curve that proves no collapse."""
    multiplier, found = curve.multiplier, replace(found, lower=None, upper=None)
    if end == "rising" and multiplier[-1] > LOCKED * (multiplier[-1] - last_rise(curve)) and locks(system.equilibrium):
        message = "self-locking: λ grows with the displacement, and joint forces balance any multiple of the live load"
        return replace(found, status="unbounded", message=message)
    reasons = {
        "rising": "the pushover curve still rises at the largest displacement",
        "broken": "the pushover curve broke off: no equilibrium was found at a larger displacement",
        "long": "the budget ran out before the pushover curve was past its peak",
    }
    return replace(found, lower=system.equilibrium.live_unit * float(multiplier.max()), message=reasons[end])


def _fallen(found: Outcome, system: StaticSystem) -> Outcome:
    """Outcome of a wall that was not brought to rest under its dead load."""
    if not stands_under_dead_load(system.equilibrium):
        return replace(found, status="infeasible", message=FALLS)
    return replace(found, message="no equilibrium was found under the dead load, though forces exist that balance it")
