"""One moment of a wall, made visible."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runningbond.scene import Array, Indices, Scene

from .frame import Frame, Stage, State
from .grids import Grid, Grids
from .painting import DRAWN, STATE_COLOURS, Cells, Colouring, View, wall_size, wall_view


@dataclass(frozen=True, eq=False)
class Shown:
    """One moment of a wall as it is to be drawn.

    Parameters
    ----------
    scene
        The wall.
    blocks, joints
        Its grids.
    scale : float
        Factor of displacements.
    colouring
        How blocks are coloured.
    """

    scene: Scene
    blocks: Grid
    joints: Grid
    scale: float
    colouring: Colouring = "displacement"

    @classmethod
    def of_frame(cls, stage: Stage, frame: Frame, colouring: Colouring = "displacement") -> "Shown":
        """A frame, its displacements made visible."""
        grids = Grids(stage)
        return cls.of_grids(stage.scene, grids.blocks(frame), grids.joints(frame), colouring)

    @classmethod
    def of_grids(cls, scene: Scene, blocks: Grid, joints: Grid, colouring: Colouring = "displacement") -> "Shown":
        """A moment read back from files, its displacements made visible."""
        return cls(scene, blocks, joints, visible_scale(scene, blocks), colouring)

    def view(self, pixels: int) -> View:
        """What shows all of it."""
        return wall_view(self.scene, self.blocks, self.scale, pixels)

    def drawn_motion(self, block: Indices, at: Array) -> Array:
        """How far a point ``(2,)`` [m] of some blocks ``(n,)`` is drawn to have moved, ``(2,)`` [m]."""
        cells = Cells.of_wall(self.scene, self.blocks, self.scale)
        still = Cells.of_wall(self.scene, self.blocks, 0.0)
        corners = cells.corners[np.repeat(np.isin(cells.data["block"], block), np.diff(cells.first))]
        # The linear displacement that fits the block's corners best is exact where it is rigid.
        place = np.column_stack([np.ones(len(corners)), still.points[corners] - at])
        fitted = np.linalg.lstsq(place, (cells.points - still.points)[corners], rcond=None)[0]
        return np.asarray(fitted[0])

    @property
    def multiplier(self) -> float:
        """λ of the moment."""
        return float(_numbers(self.blocks.GetFieldData().GetArray("multiplier"))[0])

    @property
    def states(self) -> list[State]:
        """States of its joints that are worth a word."""
        found = np.unique(_numbers(self.joints.GetCellData().GetArray("state")))
        return [state for state in STATE_COLOURS if state in found]


def visible_scale(scene: Scene, blocks: Grid) -> float:
    """Factor of displacements that makes the largest one of the wall visible; 1 where nothing moves."""
    farthest = Cells.of_wall(scene, blocks, 1.0).farthest
    return DRAWN * wall_size(scene) / farthest if farthest > 0 else 1.0


def _numbers(array: Any) -> NDArray[Any]:
    from vtkmodules.util import numpy_support

    convert: Any = numpy_support.vtk_to_numpy
    return np.asarray(convert(array))
