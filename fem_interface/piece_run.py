"""A run of a wall whose blocks may crack, and how its blocks move as wholes."""

from typing import Any

import numpy as np
from scipy.sparse import coo_array, csr_array

from runningbond.dynamics import BlockSystem, Run, State
from runningbond.scene import Array, Scene

from .modal_wall import ModalWall


class PieceRun(Run):
    """A wall in motion whose pieces move by themselves; see `Run`.

    A block's motion is the rigid one with the linear and the angular momentum of its pieces.
    """

    def __init__(self, system: BlockSystem, wall: ModalWall, **options: Any) -> None:
        super().__init__(system, **options)
        self._of_blocks = _momentum(wall)
        self._owner = wall.pieces.owner

    def sizes(self, scene: Scene) -> Array:
        """Size of the block of each piece, ``(np,)`` [m]."""
        return scene.block_sizes[self._owner]

    def motion_of_blocks(self, state: State) -> Array:
        """Translation and rotation of each block, ``(nb, 3)`` [m, m, rad]."""
        return np.asarray((self._of_blocks @ super().motion_of_blocks(state).ravel()).reshape(-1, 3))

    def velocity_of_blocks(self, state: State) -> Array:
        """Velocity and spin of each block half a step ago, ``(nb, 3)`` [m/s, m/s, rad/s]."""
        return np.asarray((self._of_blocks @ super().velocity_of_blocks(state).ravel()).reshape(-1, 3))


def _momentum(wall: ModalWall) -> csr_array:
    """Motion of blocks per motion of their pieces, ``(3 nb, 3 np)``."""
    pieces, owner = wall.scene.blocks, wall.pieces.owner
    count = int(owner[-1]) + 1
    area = np.bincount(owner, pieces.area, minlength=count)
    centre = np.column_stack([np.bincount(owner, pieces.area * x, minlength=count) for x in pieces.centroid.T])
    x, y = (pieces.centroid - (centre / area[:, None])[owner]).T
    moment = np.bincount(owner, pieces.polar_moment + pieces.area * (x**2 + y**2), minlength=count)
    part, spin = pieces.area / area[owner], pieces.area / moment[owner]
    own = pieces.polar_moment / moment[owner]
    row, column = 3 * owner, 3 * np.arange(len(owner))
    entries = [(0, 0, part), (1, 1, part), (2, 0, -y * spin), (2, 1, x * spin), (2, 2, own)]
    rows, columns, values = (
        np.concatenate([row + i for i, _, _ in entries]),
        np.concatenate([column + j for _, j, _ in entries]),
        np.concatenate([value for _, _, value in entries]),
    )
    return csr_array(coo_array((values, (rows, columns)), shape=(3 * count, 3 * len(owner))))
