"""Support reactions, which are part of the path quantities of an outcome.

Held blocks are fixed blocks that are in contact or tied, and pinned blocks, such as a beam. The reaction of a block
balances its joint forces, the pulls of its ties and its loads,

    R = B_nᵀ N + B_tᵀ S + B_tieᵀ T − f_dead − λ f_live.

For a fixed block the loads are omitted, because they go straight into the ground. Reactions act on the wall.
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
"""Force, relative to the largest joint force, up to which a moving support counts as unloaded."""

COME_FREE = "it bridges the support, which bears nothing of it where the settlement ends"
"""Message for a wall at rest whose moving supports no longer carry any load."""


def resultants(body: Indices, at: Array, force: Array, about: Array) -> Array:
    """Sum forces ``(n, 2)`` at points ``(n, 2)`` per body ``(n,)``, with moments about ``(k, 2)``, to ``(k, 3)``."""
    arm, total = at - about[body], np.zeros((len(about), 3))
    np.add.at(total, body, np.column_stack([force, arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]]))
    return total


class Supports:
    """The held blocks of a scene and their reactions.

    Parameters
    ----------
    scene, points
        The scene, and the joint points at which forces are given.
    owner : (n,) int
        Block of each body to which `points` refer; None if the bodies are the scene's blocks.

    Attributes
    ----------
    block : (k,) int
        The held blocks.
    about : (k, 2) float
        Reference point of each block's moment [m]: the middle of its pins, else of its joint points, else of its
        joints, else of its ties.
    """

    def __init__(self, scene: Scene, points: JointPoints, owner: Indices | None = None) -> None:
        sides = points.block if owner is None else owner[points.block]
        # At finite displacements a body that touches corners alone has none of the points.
        near = [*sides.ravel(), *scene.joints.block.ravel(), *scene.ties.block.ravel()]
        touched = np.isin(np.arange(len(scene.blocks)), near)
        self._pins = scene.pins  # late pins hold blocks that are pinned anyway, at the same point
        self.block: Indices = np.union1d(np.flatnonzero(scene.fixed & touched), self._pins.block)
        number = np.full(len(scene.blocks), -1)
        number[self.block] = np.arange(len(self.block))
        self._point, side = np.nonzero((number[sides] >= 0) & (sides[:, :1] != sides[:, 1:]))
        self._body, self._points = number[sides][self._point, side], points.part(self._point)
        self._sign = np.where(side == 1, 1.0, -1.0)[:, None]
        # A tie pulls its first end along its direction and its second end against it; reactions oppose these pulls.
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
        joints = self._scene.joints
        near = joints.ends[(joints.block == self.block[k]).any(axis=1)].reshape(-1, 2)
        at = next(each for each in (pinned, touched, near, self._tied_at[self._tied == k]) if len(each))
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
        """Names of the values that `reactions` returns, tie forces last."""
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
        """Horizontal and vertical reaction and moment of each held block, ``(3 k,)`` [N, N, N m], then tie forces.

        Parameters
        ----------
        force : (np, 2) float
            Normal and tangential forces of the points [N], tension positive.
        tie : (nt,) float
            Forces of the ties [N].
        multiplier
            λ.
        at_rest
            Whether the wall is at rest; if not, reactions of pinned blocks include inertia forces and are set to NaN.
        """
        points, (normal, tangential) = self._points, force[self._point].T[:, :, None]
        pull = self._sign * (normal * points.normal + tangential * points.tangent)
        total = resultants(self._body, points.position, pull, self.about) - self._dead - multiplier * self._live
        total += resultants(self._tied, self._tied_at, tie[self._tie, None] * self._along, self.about)
        if not at_rest:
            total[~self._scene.fixed[self.block]] = np.nan
        return np.append(total.ravel(), tie)

    def have_come_free(self, force: Array, tie: Array) -> bool:
        """Whether the moving supports carry no load; joint forces and tie forces as in `reactions`.

        Each force is weighted by the displacement of its point, so that a force at the centre of rotation is ignored.
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
        """Return `path` and `path_columns` of an `Outcome` for states with given joint forces, tie forces and works.

        Works are ``(n, 2)`` [J]. All states are at rest, except for the last one if the wall `falls`.
        """
        resting = [True] * (len(forces) - falls) + [False] * falls
        states = zip(forces, ties, multipliers, resting, strict=True)
        reactions = [self.reactions(force, tie, load, at_rest=rests) for force, tie, load, rests in states]
        path = np.column_stack([np.reshape(reactions, (len(forces), -1)), works, resting])
        return {"path": path, "path_columns": (*self.columns, *WORKS, AT_REST)}


def collapse_state(scene: Scene, points: JointPoints, force: Array, tie: Array, multiplier: float) -> dict[str, Any]:
    """Return the path of a model that computes only the forces at collapse: one row, with NaN for the works."""
    return Supports(scene, points).path([force], [tie], [multiplier], np.full((1, 2), np.nan))
