"""Smaller loads near a certificate: all of the wall except a part is glued, and that part is searched from there.

A rare mechanism mostly differs from a frequent one in a few joints. A search over the whole wall does not find it,
because all of its starts end elsewhere. With the rest glued there are few degrees of freedom, and programs take
milliseconds; neighbourhoods of many places and sizes are searched one after another (large neighbourhood search, Shaw
1998).
"""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from runningbond.scene import Array, Mask

from .certificates import Certificate, least_multiplier
from .descent import Descent
from .equilibrium import Equilibrium
from .macro import Glued, freest, sides
from .programs import Programs
from .sequences import WEIGHTS, short_sequence

PRESSURE_SCATTER = 0.5
"""Standard deviation of the logarithm of a sequence's initial pressures, relative to the certificate's."""

DISTANCE_DECIMALS = 6
"""Decimals to which distances, in wall sizes, are rounded, so that a wall drawn larger yields the same numbers."""


def neighbourhood(system: Equilibrium, place: Array, moving: Mask, centres: Mask, freedoms: int) -> Glued | None:
    """Glue the wall except at moving points ``(np,)`` and as near `centres` ``(np,)`` as at most `freedoms` allow.

    None if there is no such wall. Distance is measured between blocks, whose centroids are at `place` ``(n, 2)`` [m].
    """
    of_centres = np.unique([side[centres] for side in sides(system)])
    distance = distances(system, place, place[of_centres[of_centres < len(place)]])
    nearness = np.where(moving, 2.0, 1 / (1 + distance))
    return freest(system, place, nearness, np.unique(nearness[~moving])[::-1].tolist(), freedoms)


def distances(system: Equilibrium, place: Array, centres: Array) -> Array:
    """Distances ``(np,)`` from each point's nearer block to the nearest of some centres ``(n, 2)``, in wall sizes."""
    first, second = sides(system)
    size = float(np.ptp(place, axis=0).max()) or 1.0  # for a single block all distances are zero
    far = np.hypot(*(place[:, None] - centres).transpose(2, 0, 1)).min(axis=1) / size
    of_blocks = np.append(np.round(far, DISTANCE_DECIMALS), np.inf)
    return np.asarray(np.minimum(of_blocks[first], of_blocks[second]))


def one_of(moving: Mask, rng: np.random.Generator) -> Mask:
    """Random choice of one of some points, as a mask ``(np,)``."""
    return np.asarray(np.arange(len(moving)) == rng.choice(np.flatnonzero(moving)))


def certificates_near(
    glued: Glued, certificate: Certificate, programs: Programs, sequences: int, rng: np.random.Generator
) -> Iterator[Certificate]:
    """Certificates of a glued wall, found by its `programs` from a certificate that moves none of the glued joints.

    They come from a walk from that certificate, from so many `sequences`, and from a walk from the lowest one found.
    """
    known = glued.certificate(certificate)
    descent, pressure, found = Descent(programs), known.least.pressure, list[Certificate]()
    for each in chain(descent.around(known, rng), _from_sequences(descent, pressure, sequences, rng)):
        found.append(each)
        yield each
    if found:
        yield from descent.around(min(found, key=least_multiplier), rng)


def _from_sequences(
    descent: Descent, pressure: Array, sequences: int, rng: np.random.Generator
) -> Iterator[Certificate]:
    """Certificates of sequences that start from and near pressures ``(np,)``, and certificates at smaller loads."""
    for k in range(sequences):
        start = pressure * rng.lognormal(0.0, PRESSURE_SCATTER, len(pressure)) if k else pressure
        for each in short_sequence(descent, start, WEIGHTS[k % len(WEIGHTS)]):
            yield each
            yield from descent.below(each.motion, each.least, rng)
