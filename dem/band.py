"""Banded linear systems of one pattern: blocks in the order of their courses, or of their columns if those are fewer.

A wall is long in one direction; numbered along it, a block's neighbours are at most a row of blocks away. LAPACK's
banded factors then cost a fraction of sparse ones (`benchmarks/static_pushover.py` prints both); on walls of many
blocks `dissection` takes over.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from runningbond.scene import Array, Indices


@dataclass(frozen=True, eq=False)
class Band:
    """Where the entries of a banded matrix go."""

    place: Indices  # (n,) row and column of each unknown in the band
    width: int  # entries on either side of the diagonal
    entry: Indices  # (n_entries,) where LAPACK wants each entry, in its columns one after the other
    slot: Indices  # (n_terms,) entry to which each term is added, the number of entries for terms that are none
    jump: Array  # (np, 2, 6) jumps of the joint points per freedom, whose 6 × 6 tangents are the first terms
    constant: Array  # the other terms

    def solve(self, tangent: Array, right: Array) -> Array:
        """Solve with tangents ``(np, 2, 2)`` of the joint points for some right-hand sides ``(n, k)``.

        Raises
        ------
        numpy.linalg.LinAlgError
            For a matrix that is singular to the last bit.
        """
        own = np.matmul(np.matmul(self.jump.transpose(0, 2, 1), tangent), self.jump)
        terms = np.append(own, self.constant)
        height, n = 3 * self.width + 1, len(self.place)
        band = np.zeros(height * n)
        band[self.entry] = np.bincount(self.slot, terms, minlength=len(self.entry) + 1)[:-1]
        sorted_right = np.empty_like(right)
        sorted_right[self.place] = right
        _, _, x, info = lapack.dgbsv(
            self.width, self.width, band.reshape((height, n), order="F"), sorted_right, overwrite_ab=True
        )
        if info > 0:
            raise np.linalg.LinAlgError("singular tangent")
        return np.asarray(x[self.place])


def band(row: Indices, column: Indices, position: Array, spacing: float, jump: Array, constant: Array) -> Band:
    """Number unknowns along the direction that gives the narrower band.

    Parameters
    ----------
    row, column : (n_terms,) int
        Unknowns that each term couples; negative for terms that are left out.
    position : (n, 2) float
        Where each unknown lives [m]; those that live together stay in their order.
    spacing : float
        Distance across the rows that counts as none [m].
    jump : (np, 2, 6) float
        Jumps of the joint points per freedom; their tangents are the first terms.
    constant : (n_constant,) float
        The other terms.
    """
    there = (row >= 0) & (column >= 0)
    level = np.round(position / spacing)

    def numbered(along: int) -> tuple[int, Indices]:
        order = np.lexsort((position[:, 1 - along], level[:, along]))
        place = np.argsort(order)
        return int(np.abs(place[row[there]] - place[column[there]]).max()), place

    width, place = min((numbered(0), numbered(1)), key=lambda result: result[0])
    size = (3 * width + 1) * len(place)
    address = np.where(there, 2 * width + place[row] - place[column] + (3 * width + 1) * place[column], size)
    entry, slot = np.unique(np.append(address, size), return_inverse=True)
    return Band(place, width, entry[:-1], slot[:-1], jump, constant)
