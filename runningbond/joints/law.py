"""A joint law as one object, and the law of all joint points of a wall.

Kernels work with tractions and jumps only; the area of a point is a weight that is applied outside them.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from runningbond.scene import Array, JointMaterial, Mask, SceneError, Unsigned

from .mohr_coulomb import PointStrength, truncated_cone
from .point_law import PointLaw

COMMON_ROWS = ("work", "viscous work", "opening before", "slip before")
"""History rows of every law: work dissipated in the joint and in its viscosity, both [J/m²], and the jumps of the last
step [m]."""

FRICTION_WORK, DAMPED_WORK, OPENING_BEFORE, SLIP_BEFORE = range(4)
"""Numbers of the `COMMON_ROWS`."""

PLASTIC_CLOSURE = "plastic closure"
"""History row, in laws of joints that crush, of the overlap [m] at which a point closes.

It is how far the point has been crushed, plus the overlap at which area that was added later starts to press."""

CRUSHING = "crushed"
"""History row, in laws of joints that crush, of κ of the cap [m]: above zero once a point has been crushed."""

Parameters: TypeAlias = tuple[Unsigned, Array]


@dataclass(frozen=True)
class Law:
    """A law of joint points. Laws of the same name are the same law; the joints of a wall have one law.

    Parameters
    ----------
    name
        Name in messages.
    constants
        ``constants(material)``: the kernel's constants for a material; k_n, k_t [Pa/m] and f_t [Pa] come first.
    kernel
        ``kernel(opening, slip, parameters, history, viscosity, normal, tangential)``, compiled with
        `runningbond.joints.compiled.kernel`: reads jumps ``(np,)`` [m] and the parameters, updates the history
        ``(rows, np)`` and writes tractions ``(np,)`` [Pa]; it returns nothing. Parameters are `KernelLaw.segments` and
        `KernelLaw.constants`. `viscosity` times k is a dashpot's traction per change of a jump over the last step.
    history
        Names of the history rows, `COMMON_ROWS` first. At finite displacements, where a contact may pass from one side
        of a block to the next, a law needs a row ``"plastic slip"`` [m].
    stored
        ``stored(points, opening, normal, tangential)``: recoverable energy of points, ``(np,)`` [J/m²]; the opening is
        measured from where they close (`PLASTIC_CLOSURE`).
    damage
        History row of the damage, from 0 to 1; None for a law without damage. Joints of a law with damage or with a
        `PLASTIC_CLOSURE` are evaluated along their length, at nine points, those of other laws at their two ends.
    cone
        ``cone(material)``: tan φ, f_t [Pa] and shear at that tension [Pa] of the strength, for limit analysis.
    response
        ``response(strength, normal_stiffness, shear_stiffness)``: the law with a tangent, a `PointLaw` or a subclass;
        static models refuse a law without one.
    stiffest
        Index of the constant that is the largest normal stiffness [Pa/m], which determines time steps.
    cap
        Index of the constant that is the compressive strength; None for laws without one.
    closed
        ``closed(points, pressure)``: elastic closure ``(np,)`` [m] and tangent normal stiffness ``(np,)`` [Pa/m] under
        a pressure [Pa], not negative, for a law with a `PLASTIC_CLOSURE`; None for other laws, whose stiffness is k_n.
    weakens
        ``weakens(constants)``: whether points of materials may lose strength, ``(ns,)``, from the materials' constants
        ``(ns, n_constants)``. None means all points for a law with damage, and no points for other laws.
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
    cap: int | None = None
    closed: Callable[["KernelLaw", Array], tuple[Array, Array]] | None = None
    weakens: Callable[[Array], Mask] | None = None

    def __post_init__(self) -> None:
        if self.history[:4] != COMMON_ROWS:
            raise SceneError("joint.law", f"must have a history that begins with {COMMON_ROWS}", self.history)
        if self.damage is not None:
            self.row(self.damage)

    @property
    def identity(self) -> tuple[Any, ...]:
        """Identity of the law, the same in every process: its names, and the code of its functions."""
        from .compiled import identity_of

        kernel = getattr(self.kernel, "py_func", self.kernel)
        functions = (kernel, self.constants, self.stored, self.cone, self.response, self.closed, self.weakens)
        return self.name, self.history, self.damage, self.stiffest, *map(identity_of, functions)

    @property
    def may_break(self) -> bool:
        """Whether points may be damaged or crushed, so that the distribution of forces along a joint matters."""
        return self.damage is not None or PLASTIC_CLOSURE in self.history

    def loses_strength(self, constants: Array) -> bool:
        """Whether any point of materials with the constants ``(ns, n_constants)`` may lose strength."""
        return self.damage is not None if self.weakens is None else bool(np.any(self.weakens(constants)))

    def row(self, name: str) -> int:
        """Number of a history row; raises a `SceneError` that names the law if it has no such row."""
        if name not in self.history:
            raise SceneError("joint.law", f'"{self.name}" keeps no "{name}" in its history, which this model needs')
        return self.history.index(name)


def loses_strength(material: JointMaterial) -> bool:
    """Whether a joint may lose strength: it softens, or has a law of its own that weakens.

    Without stiffness a material has no constants, from which a law may tell that it does not weaken.
    """
    law = material.law
    if material.softens or not isinstance(law, Law):
        return material.softens
    if law.weakens is None:
        return law.damage is not None
    with suppress(SceneError):
        return law.loses_strength(np.array([law.constants(material)], dtype=np.float64))
    return True


def crushes_by_law(material: JointMaterial) -> bool:
    """Whether a joint crushes by a law of its own, but not by its keys, which limit analysis reads."""
    law = material.law
    if material.compressive_strength is not None or not isinstance(law, Law):
        return False
    if law.cap is None:
        return CRUSHING in law.history
    with suppress(SceneError):
        return bool(np.isfinite(law.constants(material)[law.cap]))
    return True  # without stiffness it has no constants


KERNEL_KEYS = (
    "friction",
    "cohesion",
    "tensile_strength",
    "fracture_energy_1",
    "fracture_energy_2",
    "softening",
    "compressive_strength",
    "compressive_fracture_energy",
    "cap_shear",
    "peak_closure",
    "closure",
)
"""Keys of a material that a kernel knows only from its constants, and limit analysis, the first three, from a cone."""


NEVER_REACHED = 1e12
"""Compressive strength [Pa] that no joint reaches: it only has joints evaluated at points along them."""


class _Watched(JointMaterial):
    """A material that notes in `seen` which of its attributes are looked at."""

    seen: set[str]

    def __getattribute__(self, name: str) -> Any:
        object.__getattribute__(self, "seen").add(name)
        return object.__getattribute__(self, name)


def unread_keys(material: JointMaterial, *, static: bool) -> set[str]:
    """Keys of a material that its own law does not look at, for its cone if `static`, else for its constants."""
    law = material.law
    if not isinstance(law, Law):
        return set()
    watched = object.__new__(_Watched)
    object.__setattr__(watched, "seen", set())
    for name, value in vars(material).items():
        object.__setattr__(watched, name, value)
    keys, numbers = (KERNEL_KEYS[:3], law.cone) if static else (KERNEL_KEYS, law.constants)
    try:
        numbers(watched)
    except Exception:  # the model that takes these numbers says what is wrong with them
        return set()
    without_effect = {"compressive_strength"} if (material.compressive_strength or 0.0) >= NEVER_REACHED else set()
    return set(keys) - watched.seen - without_effect


@dataclass(frozen=True, eq=False)
class KernelLaw:
    """A law for all joint points of a wall, as the integrator uses it.

    Parameters
    ----------
    segments : (ns + 1,) uint64
        First point of each run of points of one material, then the number of points.
    constants : (ns, n_constants) float
        The law's constants for the material of each run.
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
        """Number of history rows."""
        return len(self.law.history)

    def energy(self, opening: Array, normal: Array, tangential: Array, history: Array) -> Array:
        """Recoverable energy of points with given jumps and tractions, ``(np,)`` [J/m²]."""
        return self.law.stored(self, opening + self.plastic_closure(history), normal, tangential)

    @property
    def parameters(self) -> Parameters:
        """Parameters that the kernel is called with."""
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
    def compressive_strength(self) -> Array:
        """Compressive strength of each point, ``(np,)`` [Pa]; infinite without one."""
        return np.full(self.points, np.inf) if self.law.cap is None else self.of_points(self.law.cap)

    @property
    def can_break(self) -> bool:
        """Whether any point may lose strength, so that it may fail under a load that it carried before."""
        return self.law.loses_strength(self.constants)

    def normal_tangent(self, pressure: Array) -> Array:
        """Tangent normal stiffness [Pa/m] of closed points under a pressure ``(np,)`` [Pa], not negative."""
        return self.normal_stiffness if self.law.closed is None else self.law.closed(self, pressure)[1]

    def of_points(self, constant: int) -> Array:
        """Constant of a given index for each point's material, ``(np,)``."""
        return np.repeat(self.constants[:, constant], np.diff(self.segments).astype(np.int64))

    def plastic_closure(self, history: Array) -> Array:
        """Overlap at which each point closes, for a history ``(rows, np)`` [m]; zero without such a row.

        It is how far the point has been crushed, plus the overlap at which area that was added later starts to press.
        """
        known = PLASTIC_CLOSURE in self.law.history
        return history[self.law.row(PLASTIC_CLOSURE)].copy() if known else np.zeros(self.points)

    def crushed(self, history: Array) -> Array:
        """How far each point has been crushed [m], for a history ``(rows, np)``; zero without a `CRUSHING` row."""
        if CRUSHING not in self.law.history:
            return np.zeros(self.points)
        return np.where(history[self.law.row(CRUSHING)] > 0, self.plastic_closure(history), 0.0)

    def damage(self, history: Array) -> Array:
        """Damage of each point, for a history ``(rows, np)``; zero for a law without damage."""
        return np.zeros(self.points) if self.law.damage is None else history[self.law.row(self.law.damage)].copy()
