"""Smaller loads near a certificate: all but some of the wall is glued, and what is left is searched from there.

A rare mechanism is mostly a frequent one with a few joints changed, which a search over the whole wall does not find
because all of its starts end elsewhere. With the rest glued there are few freedoms, and programs take milliseconds;
neighbourhoods of many places and sizes are searched one after the other (large neighbourhood search, Shaw 1998).
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

NEARBY = 0.5
"""Scatter of the logarithm of the pressures that sequences start from, beside the certificate's."""

PLACES = 6
"""Decimals of distances, in sizes of the wall, that are looked at: a wall that is drawn larger has the same."""


def neighbourhood(system: Equilibrium, place: Array, moving: Mask, centres: Mask, freedoms: int) -> Glued | None:
    """The wall glued but where points move ``(np,)`` and near some, as near as leaves so many freedoms; None for none.

    Nearness goes by the blocks, which have their centroids at `place` ``(n, 2)`` [m].
    """
    of_centres = np.unique([side[centres] for side in sides(system)])
    distance = distances(system, place, place[of_centres[of_centres < len(place)]])
    nearness = np.where(moving, 2.0, 1 / (1 + distance))
    return freest(system, place, nearness, np.unique(nearness[~moving])[::-1].tolist(), freedoms)


def distances(system: Equilibrium, place: Array, centres: Array) -> Array:
    """Distances ``(np,)`` of each point's nearer block from the nearest of some centres ``(n, 2)``, in wall sizes."""
    first, second = sides(system)
    size = float(np.ptp(place, axis=0).max()) or 1.0  # of a single block nothing is far
    far = np.hypot(*(place[:, None] - centres).transpose(2, 0, 1)).min(axis=1) / size
    of_blocks = np.append(np.round(far, PLACES), np.inf)
    return np.asarray(np.minimum(of_blocks[first], of_blocks[second]))


def one_of(moving: Mask, rng: np.random.Generator) -> Mask:
    """One of some points ``(np,)``."""
    return np.asarray(np.arange(len(moving)) == rng.choice(np.flatnonzero(moving)))


def certificates_near(
    glued: Glued, certificate: Certificate, programs: Programs, sequences: int, rng: np.random.Generator
) -> Iterator[Certificate]:
    """Certificates of a glued wall that are found by its `programs`, from one of the wall that moves nothing glued.

    So many `sequences` are run beside walks from that one and from the lowest.
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
    """Certificates of sequences that start from pressures ``(np,)``, and near them, and those below."""
    for k in range(sequences):
        start = pressure * rng.lognormal(0.0, NEARBY, len(pressure)) if k else pressure
        for each in short_sequence(descent, start, WEIGHTS[k % len(WEIGHTS)]):
            yield each
            yield from descent.below(each.motion, each.least, rng)
