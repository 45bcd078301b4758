"""Change of frame in the histories of joint points, when jumps are measured along the other block's side."""

from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

from runningbond.scene import Array, Mask

from .compiled import kernel
from .law import OPENING_BEFORE, SLIP_BEFORE

Frames: TypeAlias = tuple[Mask, int]
"""Whether each contact's jumps are measured along the side of block b, ``(nc,)``; and the row of the plastic slip in
the history, −1 if the law has none."""


@kernel
def retell(history: Array, plastic: int, point: int, opening: float, slip: float) -> None:
    """Convert a point's history to jumps that are larger by `opening` and `slip` [m] from now on.

    This change causes no viscous traction, and the point keeps its shear traction.
    """
    history[OPENING_BEFORE, point] += opening
    history[SLIP_BEFORE, point] += slip
    if plastic >= 0:
        history[plastic, point] += slip


@kernel
def keep_frames(geometry: Any, frames: Frames, history: Array) -> None:
    """Leave the history ``(rows, np)`` unchanged: jumps are always measured in the same frame."""


@cache
def reframe_along(turned: Callable[..., Any]) -> Any:
    """Return the kernel ``reframe(geometry, frames, history)`` of points between ends (`along`).

    `turned(ends, k)` returns by how much the jumps of end k are larger in its present frame, two lengths [m].
    """

    @kernel
    def reframe_points(geometry: Any, frames: Frames, history: Array) -> None:
        ends, pairs, share, _, _, _, _, _, _ = geometry
        bore, plastic = frames
        n = pairs.shape[0]
        for j in range(n):
            alone = pairs[j, 0] == pairs[j, 1]
            for second in range(2):
                k = pairs[j, second]
                if ends.bears[k] == bore[k]:
                    continue
                opening, slip = turned(ends, k)
                for p in range(share.size):
                    part = 1.0 if alone else share[p] if second == 1 else 1.0 - share[p]
                    retell(history, plastic, p * n + j, part * opening, part * slip)
                bore[k] = ends.bears[k]

    return reframe_points
