"""What holds a wall, and with which forces: the path quantities of an outcome.

A held block is one that is fixed and touched or tied, or pinned, as a beam may be. What holds it is the balance of its
joint forces, its ties' pulls and its loads,

    R = B_nᵀ N + B_tᵀ S + B_tieᵀ T − f_dead − λ f_live,

of a fixed one the forces alone, for loads on it go straight into the ground. Reactions act on the wall.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from runningbond.joints import JointPoints
from runningbond.scene import Array, Forces, Indices, Scene

from .mechanism import carried

WORKS = ("work of the dead load [J]", "work of the live load [J]")
AT_REST = "at rest"

UNFELT = 1e-6
"""Force, beside the largest in any joint, that counts as none."""

COME_FREE = "it bridges the support, which bears nothing of it where the settlement ends"
"""What is said of a wall at rest whose supports have come free."""


def resultants(body: Indices, at: Array, force: Array, about: Array) -> Array:
    """Sums of forces ``(n, 2)`` at points ``(n, 2)`` on bodies ``(n,)``, moments about ``(k, 2)``: ``(k, 3)``."""
    arm, total = at - about[body], np.zeros((len(about), 3))
    np.add.at(total, body, np.column_stack([force, arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]]))
    return total


class Supports:
    """The held blocks of a scene that is joined at some points.

    Parameters
    ----------
    scene, points
        The scene, and the points of which joint forces are known.
    owner : (n,) int
        Block of each body that `points` know; None where bodies are the scene's blocks.

    Attributes
    ----------
    block : (k,) int
        The held blocks.
    about : (k, 2) float
        Point about which each one's moment is taken [m]: the middle of its pins, or of where it is touched.
    """

    def __init__(self, scene: Scene, points: JointPoints, owner: Indices | None = None) -> None:
        sides = points.block if owner is None else owner[points.block]
        touched = np.isin(np.arange(len(scene.blocks)), [*sides.ravel(), *scene.ties.block.ravel()])
        self._pins = scene.pins  # what is held later as well is held from the first, at the same point
        self.block: Indices = np.union1d(np.flatnonzero(scene.fixed & touched), self._pins.block)
        number = np.full(len(scene.blocks), -1)
        number[self.block] = np.arange(len(self.block))
        self._point, side = np.nonzero((number[sides] >= 0) & (sides[:, :1] != sides[:, 1:]))
        self._body, self._points = number[sides][self._point, side], points.part(self._point)
        self._sign = np.where(side == 1, 1.0, -1.0)[:, None]
        # A tie draws its second end against its direction, and its first one along it.
        tied = np.append(number, -1)[scene.ties.block]
        self._tie, end = np.nonzero(tied >= 0)
        self._tied, self._tied_at = tied[self._tie, end], scene.ties.ends[self._tie, end]
        self._along = np.where(end == 1, 1.0, -1.0)[:, None] * scene.ties.direction[self._tie]
        self._scene = scene
        self.about = np.array([self._middle(k) for k in range(len(self.block))]).reshape(-1, 2)
        self._dead, self._live = (self._load(forces, number) for forces in (scene.dead_forces, scene.live_forces))

    def _middle(self, k: int) -> Array:
        pinned = self._pins.point[self._pins.block == self.block[k]]
        touched = self._points.position[self._body == k]
        at = next(each for each in (pinned, touched, self._tied_at[self._tied == k]) if len(each))
        return np.asarray((at.min(axis=0) + at.max(axis=0)) / 2)

    def _load(self, forces: Forces, number: Indices) -> Array:
        scene, block = self._scene, self.block
        weight = scene.mass[block, None] * forces.acceleration[block]
        load = resultants(np.arange(len(block)), scene.blocks.centroid[block], weight, self.about)
        load[:, 2] += forces.moment[block]
        here = number[forces.block] >= 0
        load += resultants(number[forces.block[here]], forces.at[here], forces.force[here], self.about)
        load[scene.fixed[block]] = 0.0
        return load

    @property
    def columns(self) -> list[str]:
        """Names of the numbers that `reactions` gives, and of the ties' forces."""
        ties = [f"tie {k} [N]" for k in range(len(self._scene.ties))]
        heads = ("horizontal [N]", "vertical [N]", "moment about {} [N m]")
        told = [self._scene.blocks.place(place, 6) for place in self.about]
        return [
            f"{name} {head.format(about)}" for name, about in zip(self._names(), told, strict=True) for head in heads
        ] + ties

    def _names(self) -> list[str]:
        scene = self._scene
        ground = self.block[~scene.wall[self.block]]
        names = {int(b): "ground" if len(ground) == 1 else f"ground {k + 1}" for k, b in enumerate(ground)}
        if scene.beam is not None and scene.beam.block is not None:
            names[scene.beam.block] = "beam"
        return [names.get(int(b), f"{'block' if scene.fixed[b] else 'pinned block'} {b}") for b in self.block]

    def reactions(self, force: Array, tie: Array, multiplier: float, *, at_rest: bool = True) -> Array:
        """Horizontal and vertical reaction and moment of each held block, ``(3 k,)`` [N, N, N m], and ties' forces.

        Parameters
        ----------
        force : (np, 2) float
            Normal and tangential forces of the points [N], tension positive.
        tie : (nt,) float
            Forces of the ties [N].
        multiplier
            λ.
        at_rest
            Whether the wall rests; if not, what holds a pinned block also has its inertia to bear and is not a number.
        """
        points, (normal, tangential) = self._points, force[self._point].T[:, :, None]
        pull = self._sign * (normal * points.normal + tangential * points.tangent)
        total = resultants(self._body, points.position, pull, self.about) - self._dead - multiplier * self._live
        total += resultants(self._tied, self._tied_at, tie[self._tie, None] * self._along, self.about)
        if not at_rest:
            total[~self._scene.fixed[self.block]] = np.nan
        return np.append(total.ravel(), tie)

    def have_come_free(self, force: Array, tie: Array) -> bool:
        """Whether the supports that move bear nothing; forces of points and ties as of `reactions`.

        What is borne where they do not move, at the point about which they turn, is not in their way.
        """
        block = self.block[np.append(self._body, self._tied)]
        at = np.concatenate([self._points.position, self._tied_at])
        ways = np.hypot(*carried(self._scene.blocks, block, at, self._scene.support_motion).T)
        borne = np.append(np.hypot(*force[self._point].T), tie[self._tie])
        largest = float(np.hypot(*force.T).max(initial=0.0) * ways.max(initial=0.0))
        return bool((borne * ways).max(initial=0.0) <= UNFELT * largest)

    def path(
        self,
        forces: Sequence[Array] | Array,
        ties: Sequence[Array] | Array,
        multipliers: Iterable[float],
        works: Array,
        *,
        falls: bool = False,
    ) -> dict[str, Any]:
        """Path and names of its columns, as `Outcome` has them, of states with forces of points and ties, and works.

        Works are ``(n, 2)``. All states rest, or all but the last one where the wall `falls`.
        """
        resting = [True] * (len(forces) - falls) + [False] * falls
        states = zip(forces, ties, multipliers, resting, strict=True)
        reactions = [self.reactions(force, tie, load, at_rest=rests) for force, tie, load, rests in states]
        path = np.column_stack([np.reshape(reactions, (len(forces), -1)), works, resting])
        return {"path": path, "path_columns": (*self.columns, *WORKS, AT_REST)}


def collapse_state(scene: Scene, points: JointPoints, force: Array, tie: Array, multiplier: float) -> dict[str, Any]:
    """The path of a model that knows the forces at collapse alone: one row, whose works are not numbers."""
    return Supports(scene, points).path([force], [tie], [multiplier], np.full((1, 2), np.nan))
