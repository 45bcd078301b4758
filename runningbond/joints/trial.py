"""Checks of a user's law: of its strength, of its constants, of its kernel before a wall moves, and of every response.

A kernel that writes to a row that the law does not name would write over other memory of the process, and one that
reads more constants than the law gives would take those of the next material, or whatever lies behind the last.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from runningbond.scene import Array, JointMaterial, SceneError

from .law import COMMON_ROWS, CRUSHING, PLASTIC_CLOSURE, Law
from .point_law import PointLaw, PointResponse

SPARE_ROWS = 1000
"""Rows behind the history of a trial, in which it is seen whether the kernel has written to them."""

UNTOUCHED = 0.7071
"""Value of the spare rows: not one that a kernel writes, nor one that stays as it is if something is added."""

BEHIND = -UNTOUCHED, 1e7 * UNTOUCHED
"""Values behind the constants of two equal trials, which differ if the kernel reads them."""

JUMP = 1e-6
"""Opening and slip in a trial [m]."""

TOGETHER = 100
"""Number of materials in a trial: spare rows of walls whose joints all differ would fill the memory."""

BEYOND = 1e-6
"""Force beyond the strength, relative to all forces and strengths of points, up to which it counts as rounding."""


def cone_of(law: Law, material: JointMaterial) -> tuple[float, float, float]:
    """Tan φ, f_t [Pa] and shear at that tension [Pa] of a material under a law, checked."""
    found: Any = law.cone(material)
    numbers = _numbers(found)
    if numbers.shape != (3,) or not (numbers >= 0).all() or not np.isfinite(numbers[0]):
        what = f'"{law.name}" must have a cone of three numbers, none negative: tan φ, f_t, shear at that tension'
        raise SceneError("joint.law", what, found)
    friction, tension, shear = map(float, numbers)
    return friction, tension, shear


def constants_of(law: Law, materials: Sequence[JointMaterial]) -> Array:
    """Constants of materials under a law, ``(nm, n_constants)``, checked."""
    found = [law.constants(material) for material in materials]
    constants = _numbers(found)
    if constants.ndim != 2 or constants.shape[1] < 3:
        raise SceneError("joint.law", f'"{law.name}" must have constants k_n, k_t, f_t and further numbers', found[0])
    k_n, k_t, tension = constants.T[:3]
    if np.isnan(constants).any() or not ((k_n > 0) & np.isfinite(k_n)).all() or min(*k_t, *tension) < 0:
        what = f'"{law.name}" must have constants that are numbers, k_n above zero, k_t and f_t not below'
        raise SceneError("joint.law", what, found[0])
    return constants


def try_kernel(law: Law, constants: Array) -> None:
    """Call the kernel of a law, with constants ``(nm, n_constants)``; refuse one that would write over other memory."""
    named = *COMMON_ROWS, PLASTIC_CLOSURE, CRUSHING, "plastic slip", law.damage
    read = tuple(row for row, name in enumerate(law.history) if name in named)  # other rows are the law's affair
    _try_kernel(law.name, law.kernel, len(law.history), read, constants.shape[1], constants.tobytes())


def _numbers(found: Any) -> Array:
    """Values as an array of floats; an empty one if they are no numbers."""
    with suppress(TypeError, ValueError):
        return np.array(found, dtype=float)
    return np.zeros(0)


@lru_cache(maxsize=64)
def _try_kernel(name: str, kernel: Any, rows: int, read: tuple[int, ...], columns: int, content: bytes) -> None:
    """Call a kernel with small jumps of points without history, of every material; refuse what a wall cannot bear.

    `read` are the rows of the history that models read. The kernel may raise errors at jumps that a wall may never
    reach; they are raised again if it does.
    """
    if not hasattr(kernel, "py_func"):
        raise SceneError(
            "joint.law", f'"{name}" needs a kernel compiled with runningbond.joints.compiled.kernel', kernel
        )
    constants = np.frombuffer(content).reshape(-1, columns).copy()
    for first in range(0, len(constants), TOGETHER):
        _try_materials(name, kernel, rows, read, constants[first : first + TOGETHER])


def _try_materials(name: str, kernel: Any, rows: int, read: tuple[int, ...], constants: Array) -> None:
    """As `_try_kernel`, of a few materials with constants ``(nm, n_constants)``."""
    moved = [(-JUMP, JUMP), (-JUMP, -JUMP), (JUMP, 0.0), (JUMP, JUMP), (JUMP, -JUMP)]
    jumps = np.array([(0.0, 0.0), (-JUMP, 0.0), *moved])
    for these in (jumps[:2], jumps):  # first those of a wall that is built, and bears itself
        (room, traction, raised), (again, traction_again, _) = (
            _call(kernel, these, constants, value, rows) for value in BEHIND
        )
        if (room[rows:] != UNTOUCHED).any():
            what = f'"{name}" writes to rows of the history that it does not name: it names {rows}'
            raise SceneError("joint.law", what)
        equal = np.array_equal(room, again, equal_nan=True) and np.array_equal(traction, traction_again, equal_nan=True)
        if not equal:
            what = f'"{name}" has a kernel that reads more constants than the {constants.shape[1]} it is given'
            raise SceneError("joint.law", what)
        finite = np.isfinite(traction).all() and np.isfinite(room[list(read)]).all()
        if not raised and these is not jumps and not finite:
            what = f'"{name}" must write finite tractions and histories for points that are closed and have not slid'
            raise SceneError("joint.law", what)


def _call(kernel: Any, jumps: Array, constants: Array, behind: float, rows: int) -> tuple[Array, Array, bool]:
    """History with spare rows, tractions, and whether the kernel raised an error, of every jump in every material.

    A value lies behind the constants.
    """
    count = len(jumps) * len(constants)
    segments = np.arange(0, count + 1, len(jumps)).astype(np.uint64)
    opening, slip = np.tile(jumps.T, len(constants)).copy()
    given = np.full((len(constants) + SPARE_ROWS, constants.shape[1]), behind)
    given[: len(constants)] = constants
    room, traction = np.full((rows + SPARE_ROWS, count), UNTOUCHED), np.full((2, count), np.nan)
    room[:rows] = 0.0
    with suppress(Exception):
        kernel(opening, slip, (segments, given[: len(constants)]), room[:rows], 0.0, *traction)
        return room, traction, False
    return room, traction, True


@dataclass(frozen=True, eq=False)
class CheckedLaw(PointLaw):
    """A user's law with a tangent, whose responses are checked: they are finite, and within the law's strength.

    Forces that are not finite are left to the search for rest, which does not take them for balance.
    """

    law: PointLaw
    name: str

    def __call__(self, opening: Array, slip: Array, plastic_slip: Array) -> PointResponse:
        """The law's response; a `SceneError` if no wall can rely on it."""
        found: Any = self.law(opening, slip, plastic_slip)
        count = len(opening)
        if not isinstance(found, PointResponse):
            raise SceneError("joint.law", f'"{self.name}" must respond with a PointResponse', found)
        arrays = found.normal, found.tangential, found.plastic_slip, found.tangent
        if [np.shape(each) for each in arrays] != [(count,)] * 3 + [(count, 2, 2)]:
            what = f'"{self.name}" must respond with forces and a plastic slip (np,), and a tangent (np, 2, 2)'
            raise SceneError("joint.law", what)
        with np.errstate(over="ignore", invalid="ignore"):  # a search tries jumps at which stiffening laws overflow
            squares = np.square(found.normal) + np.square(found.tangential)
        if not np.isfinite([opening, slip, plastic_slip, squares]).all():
            return found
        for what, values in ("a plastic slip", found.plastic_slip), ("a tangent", found.tangent):
            if not np.isfinite(values).all():
                raise SceneError("joint.law", f'"{self.name}" responds with {what} not all finite')
        size = np.abs(found.normal) + np.abs(found.tangential) + self.strength.strongest
        if (self.strength.violation(found.normal, found.tangential) > BEYOND * size.max(initial=0.0)).any():
            what = "responds with forces beyond its cone, on which limit analysis relies; give it a cone of its own"
            raise SceneError("joint.law", f'"{self.name}" {what}')
        return found
