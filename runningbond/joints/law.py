"""A joint law as one object, and the law of all joint points of a wall.

Kernels know tractions and jumps; the area that a point stands for is its weight, and they do not know it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from runningbond.scene import Array, JointMaterial, Mask, SceneError, Unsigned

from .mohr_coulomb import PointStrength, truncated_cone
from .point_law import PointLaw

COMMON_ROWS = ("work", "viscous work", "opening before", "slip before")
"""Rows of the history that every law has: work spent on the joint and on its viscosity, both [J/m²], and the jumps of
the last step [m]."""

FRICTION_WORK, DAMPED_WORK, OPENING_BEFORE, SLIP_BEFORE = range(4)
"""Their numbers."""

PLASTIC_CLOSURE = "plastic closure"
"""Row, in laws of joints that crush, of by how much less than touching a point closes [m].

How far it has been crushed, and how far blocks overlapped where they have met since."""

CRUSHING = "crushed"
"""Row, in laws of joints that crush, of κ of the cap [m]: above zero where a point has been crushed."""

Parameters: TypeAlias = tuple[Unsigned, Array]


@dataclass(frozen=True)
class Law:
    """A law of joint points. Laws of one name are one law; the joints of a wall have one law.

    Parameters
    ----------
    name
        What messages call it.
    constants
        ``constants(material)``: what the kernel needs to know of a material; k_n, k_t [Pa/m] and f_t [Pa] come first.
    kernel
        ``kernel(opening, slip, parameters, history, viscosity, normal, tangential)``, compiled with
        `runningbond.joints.compiled.kernel`: reads jumps ``(np,)`` [m] and the parameters, brings the history
        ``(rows, np)`` up to date and writes tractions ``(np,)`` [Pa]; it returns nothing. Parameters are
        `KernelLaw.segments` and `KernelLaw.constants`. `viscosity` times k is a dashpot's traction per change of a
        jump over the last step.
    history
        Names of the rows of the history, `COMMON_ROWS` first. At finite displacements, where a contact is carried
        from one side of a block to the next, a law needs a row ``"plastic slip"`` [m].
    stored
        ``stored(points, opening, normal, tangential)``: energy that points would give back, ``(np,)`` [J/m²]; the
        opening counts from where they close (`PLASTIC_CLOSURE`).
    damage
        The row that says how far points are broken, from 0 to 1; None for a law that knows no damage. Joints of a law
        that does are evaluated all along, at nine points, those of another at their two ends.
    cone
        ``cone(material)``: tan φ, f_t [Pa] and shear at that tension [Pa] of the strength, which limit analysis reads.
    response
        ``response(strength, normal_stiffness, shear_stiffness)``: the law with a tangent, a `PointLaw` or a subclass;
        models that solve for rest refuse a law that has none.
    stiffest
        Number of the constant that is the largest normal stiffness [Pa/m], by which time steps go.
    closed
        ``closed(points, pressure)``: elastic closure ``(np,)`` [m] and tangent normal stiffness ``(np,)`` [Pa/m] under
        a pressure [Pa], not negative, of a law whose points have a `PLASTIC_CLOSURE`; None for another, of k_n.
    weakens
        ``weakens(constants)``: whether points of materials lose strength in what they do, ``(ns,)``, from the
        materials' constants ``(ns, n_constants)``; None where all do of a law that knows damage, and none of another.
    """

    name: str
    constants: Callable[[JointMaterial], tuple[float, ...]] = field(compare=False)
    kernel: Any = field(compare=False)
    history: tuple[str, ...]
    stored: Callable[["KernelLaw", Array, Array, Array], Array] = field(compare=False)
    damage: str | None = None
    cone: Callable[[JointMaterial], tuple[float, float, float]] = field(default=truncated_cone, compare=False)
    response: Callable[[PointStrength, Array, Array], PointLaw] | None = field(default=None, compare=False)
    stiffest: int = 0
    closed: Callable[["KernelLaw", Array], tuple[Array, Array]] | None = None
    weakens: Callable[[Array], Mask] | None = None

    def __post_init__(self) -> None:
        if self.history[:4] != COMMON_ROWS:
            raise SceneError("joint.law", f"must have a history that begins with {COMMON_ROWS}", self.history)
        if self.damage is not None:
            self.row(self.damage)

    @property
    def identity(self) -> tuple[Any, ...]:
        """What tells the law from others, in every process the same: its names, and its functions' code."""
        from .compiled import identity_of

        kernel = getattr(self.kernel, "py_func", self.kernel)
        functions = (kernel, self.constants, self.stored, self.cone, self.response, self.closed, self.weakens)
        return self.name, self.history, self.damage, self.stiffest, *map(identity_of, functions)

    def row(self, name: str) -> int:
        """Number of a row of the history; a law without it is refused by name."""
        if name not in self.history:
            raise SceneError("joint.law", f'"{self.name}" keeps no "{name}" in its history, which this model needs')
        return self.history.index(name)


@dataclass(frozen=True, eq=False)
class KernelLaw:
    """A law over the joint points of a wall, for the integrator.

    Parameters
    ----------
    segments : (ns + 1,) uint64
        First point of each row of points of one material, then their number.
    constants : (ns, n_constants) float
        The law's constants of each of those materials.
    """

    law: Law
    segments: Unsigned
    constants: Array

    @property
    def kernel(self) -> Any:
        """The law's compiled kernel."""
        return self.law.kernel

    @property
    def rows(self) -> int:
        """Rows of the history."""
        return len(self.law.history)

    def energy(self, opening: Array, normal: Array, tangential: Array, history: Array) -> Array:
        """Energy that points of some jumps and tractions would give back, ``(np,)`` [J/m²]."""
        return self.law.stored(self, opening + self.plastic_closure(history), normal, tangential)

    @property
    def parameters(self) -> Parameters:
        """What the kernel is called with."""
        return self.segments, self.constants

    @property
    def points(self) -> int:
        """Number of points."""
        return int(self.segments[-1])

    @property
    def normal_stiffness(self) -> Array:
        """k_n of each point, ``(np,)`` [Pa/m]."""
        return self.of_points(0)

    @property
    def stiffest(self) -> Array:
        """Largest normal stiffness of each point, ``(np,)`` [Pa/m]."""
        return self.of_points(self.law.stiffest)

    @property
    def shear_stiffness(self) -> Array:
        """k_t of each point, ``(np,)`` [Pa/m]."""
        return self.of_points(1)

    @property
    def tension(self) -> Array:
        """Largest tension of each point, ``(np,)`` [Pa]."""
        return self.of_points(2)

    @property
    def can_break(self) -> bool:
        """Whether any point loses strength in what it does, so that a load it has borne may be too much for it."""
        weakens = self.law.weakens
        return self.law.damage is not None if weakens is None else bool(weakens(self.constants).any())

    def normal_tangent(self, pressure: Array) -> Array:
        """Stiffness of closed points against more or less of a pressure ``(np,)`` [Pa], not negative; [Pa/m]."""
        return self.normal_stiffness if self.law.closed is None else self.law.closed(self, pressure)[1]

    def of_points(self, constant: int) -> Array:
        """A constant of each point's material, ``(np,)``."""
        return np.repeat(self.constants[:, constant], np.diff(self.segments).astype(np.int64))

    def plastic_closure(self, history: Array) -> Array:
        """By how much less than touching each point closes with a history ``(rows, np)`` [m]; zero without such a row.

        How far it has been crushed, and how far blocks overlapped where they have met since.
        """
        known = PLASTIC_CLOSURE in self.law.history
        return history[self.law.row(PLASTIC_CLOSURE)].copy() if known else np.zeros(self.points)

    def crushed(self, history: Array) -> Array:
        """How far each point has been crushed with a history ``(rows, np)`` [m]; zero for a law that knows none."""
        closure = self.plastic_closure(history)
        return np.where(history[self.law.row(CRUSHING)] > 0, closure, 0.0) if CRUSHING in self.law.history else closure

    def damage(self, history: Array) -> Array:
        """Damage of each point with a history ``(rows, np)``; zero for a law that knows none."""
        return np.zeros(self.points) if self.law.damage is None else history[self.law.row(self.law.damage)].copy()
