"""Influence of the random starts of its search on the smallest load that `limit-nonassociated` certifies.

    python benchmarks/studies/limit_starts.py [SCENE [SEARCHES]]

The published wall is searched with the suite's random numbers, then with others; prints the loads in ascending order.
"""

import statistics
import sys
from unittest.mock import patch

import numpy as np

from runningbond.compare import published_scene
from runningbond.limit import limit_nonassociated
from runningbond.scene.errors import exits_in_a_line

DEFAULT_RNG = np.random.default_rng


def smallest(name: str, other: int) -> float:
    """Smallest certified load of a wall, with other seeds than the suite's unless `other` is zero."""

    def seeded(seed: int | list[int]) -> np.random.Generator:
        numbers = [seed] if isinstance(seed, int) else seed
        return DEFAULT_RNG([*numbers, other]) if other else DEFAULT_RNG(seed)

    with patch("numpy.random.default_rng", seeded):
        lower = limit_nonassociated(published_scene(name)).lower
    if lower is None:
        raise SystemExit(f"{name}: nothing is certified")
    return lower


def main(name: str, searches: int) -> None:
    """Print the loads, and their median."""
    loads = [smallest(name, other) for other in range(searches)]
    listed = ", ".join(f"{load:.6g}" for load in sorted(loads))
    print(f"{name}: {loads[0]:.6g}; in {searches} searches {listed}; median {statistics.median(loads):.6g}")


if __name__ == "__main__":
    with exits_in_a_line():
        main(sys.argv[1] if len(sys.argv) > 1 else "point-load-quarter", int(sys.argv[2]) if len(sys.argv) > 2 else 20)
