"""Walls used in the studies: blocks and walls whose collapse load is known.

While a wall collapses in one mechanism, with block displacements u φ and largest translation u, it is driven by
(λ − λ_c) F, F = f_live · φ, against the inertia M = Σ m φ² of its blocks. Local damping reduces every unbalanced force
by a share α, and mass-proportional damping opposes the driving force by c M u̇:

    (M / F) ü = (1 − α) ((λ − λ_c) − c (M / F) u̇).                                                            (1)

Friction depends on the pressure, and the pressure on the inertia of the moving blocks, which (1) neglects. Equation (1)
is exact for a single block, whose pressure does not change.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np

from dem.rigid_system import rigid_system
from runningbond.compare.published import published_scene
from runningbond.dynamics import U_CRIT, BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.run import LOCAL
from runningbond.limit import limit_nonassociated
from runningbond.results import Outcome
from runningbond.scene import BlockMaterial, JointMaterial, Load, Scene, Stiffness, build_scene

from .study import Row

INSET = 0.02  # distance of contacts from the joint ends [m]; makes λ of W1 and W2 unique
RAMP = 4  # length of a ramp to a load, relative to the time the wall took to rest under its weight
SLIDES, TOPPLES = 0.4, 0.5  # tan φ of the sliding block, and b/h of the toppling one
BRICK = BlockMaterial(1800.0)
HOLDS = 1e15  # cohesion and tensile strength [Pa] that are never reached in a study
Box: TypeAlias = tuple[float, float, float, float]  # left, bottom, width, height [m]
TABLES: dict[str, dict[str, Any]] = {  # default tables of a scene file
    "block": {"density": 1800.0, "young": 2e10, "poisson": 0.2},
    "joint": {"friction": 0.6, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}


def boxes(*places: Box, joint: JointMaterial, block: BlockMaterial = BRICK) -> Scene:
    """Boxes 0.12 m thick on rigid ground and on each other, pushed at their centroids by λ times their weight."""
    outlines = [np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]]) for x, y, w, h in places]
    return build_scene("boxes", outlines, thickness=0.12, block=block, joint=joint, load=Load())


def one_block(width: float, height: float, friction: float, stiffness: float) -> Scene:
    """A dry block (sizes in m, 1800 kg/m³) on a joint with tan φ and equal normal and shear stiffness [Pa/m]."""
    joint = JointMaterial(friction, elasticity=Stiffness(stiffness, stiffness))
    return boxes((0, 0, width, height), joint=joint, block=BlockMaterial(1800.0, 1e12, 0.0))


def inset_wall(name: str) -> Scene:
    """A published wall with its contacts `INSET` from the ends of the joints."""
    return published_scene(name).with_joint(inset=INSET)


def bonded(scene: Scene) -> Scene:
    """The same wall with joints that neither open nor slide."""
    return scene.with_joint(cohesion=HOLDS, tensile_strength=HOLDS)


def outcome_row(outcome: Outcome) -> Row:
    """An outcome of a collapse as columns of a table."""
    bracket = {"λ": outcome.multiplier, "λ lower": outcome.lower, "λ upper": outcome.upper}
    return {"status": outcome.status, **bracket, "steps": outcome.steps, "message": outcome.message}


@dataclass(frozen=True, eq=False)
class KnownWall:
    """A wall under its weight and a lateral load, with its collapse load and collapse mechanism."""

    scene: Scene
    multiplier: float  # λ at collapse
    system: BlockSystem  # its rigid blocks
    far: float  # displacement [m] at which the suite judges whether it collapses
    inertia: float  # M / F of (1) [s²/m]: inertia of the mechanism per newton of driving force
    unbalanced: float  # largest unbalanced force, in the system's units, per unit of λ − λ_c

    @property
    def is_block(self) -> bool:
        """Whether it is a single block, for which (1) is exact."""
        return len(self.scene.blocks) == 2

    @cache  # noqa: B019 - there are as many walls as names
    def rest(self, local: float = LOCAL) -> tuple[Run, State]:
        """Run and state of its blocks at rest under their weight; copy the state before changing it."""
        run = Run(self.system, local=local)
        state = State.at_rest(self.system)
        assert settle(run, state, 0.0, Criteria(collapse=self.far)) == "stable"
        return run, state


# Walls with a known collapse load: a block twice as long as high with λ = tan φ, one twice as high as long with
# λ = b/h, and walls with rounded corners, whose unique collapse load is certified by limit analysis
SLIDING, TOPPLING, W1, W2 = KNOWN = ("block that slides", "block that topples", "rounded W1", "rounded W2")


def known_scene(name: str) -> Scene:
    """The scene of a wall of `KNOWN`."""
    blocks = {SLIDING: (0.24, 0.12, SLIDES), TOPPLING: (0.12, 0.12 / TOPPLES, 0.9)}
    return one_block(*blocks[name], 1e10) if name in blocks else inset_wall(f"wall-{name[-2:].lower()}")


@cache
def known_wall(name: str) -> KnownWall:
    """A wall of `KNOWN`."""
    exact, scene = {SLIDING: SLIDES, TOPPLING: TOPPLES}.get(name), known_scene(name)
    certified, system = limit_nonassociated(scene), rigid_system(scene)
    assert certified.multiplier is not None
    phi = np.zeros(len(system.mass))
    phi[system.rigid] = certified.motion / np.abs(certified.motion[:, :2]).max()
    moving = np.isfinite(system.mass)
    inertia = float((system.mass[moving] * phi[moving] ** 2).sum() / (system.live @ phi))
    unbalanced = system.measure(np.where(moving, system.mass, 0.0) * phi / inertia)
    return KnownWall(scene, exact or certified.multiplier, system, U_CRIT * scene.block_size, inertia, unbalanced)
