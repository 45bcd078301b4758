"""How far the smallest load that `limit-nonassociated` certifies on a wall goes by the random starts of its search.

    python benchmarks/studies/limit_starts.py [SCENE [SEARCHES]]

Searches of the published wall as the suite makes it, then with other random numbers each: their loads, ascending.
"""

import statistics
import sys
from unittest.mock import patch

import numpy as np

from runningbond.compare import published_scene
from runningbond.limit import limit_nonassociated

DEFAULT_RNG = np.random.default_rng


def smallest(name: str, other: int) -> float:
    """The smallest load certified on a wall, by other seeds than the suite's unless `other` is zero."""

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
    main(sys.argv[1] if len(sys.argv) > 1 else "point-load-quarter", int(sys.argv[2]) if len(sys.argv) > 2 else 20)
