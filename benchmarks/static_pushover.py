"""`dem-static` on every published wall: its bracket, that with other load steps, and what they cost.

Then a linear system in banded form beside a sparse one, and the paper's algorithm run on the dry walls.
"""

import argparse
import resource
import statistics
import time
from collections import Counter
from collections.abc import Callable

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

from compare import PUBLISHED, published_scene
from dem.static import FIRST_STEP, dem_static
from dem.static_system import Control, StaticSystem, static_system
from dem.stiffness_update import stiffness_update
from results import Outcome
from scene import Scene

INCREMENTS, ARMS = (0.05, 0.01, 0.002), (0.5, 1.0)
"""Load increments and l_c, as a share of the joint's length, with which the paper's algorithm is run."""

SYSTEMS = 20


def cpu() -> float:
    """User CPU seconds of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def bracket(outcome: Outcome) -> str:
    """Bracket as it is printed."""
    return " – ".join(
        "?" if x is None else f"{x:.4f}" if x < 10 else f"{x:.0f}" for x in (outcome.lower, outcome.upper)
    )


def pushover(scene: Scene, runs: int) -> tuple[Outcome, str]:
    """Outcome of a scene, and its row of the table."""
    outcomes, spent = [], []
    for _ in range(runs):
        before = cpu()
        outcomes.append(dem_static(scene))
        spent.append(cpu() - before)
    other = dem_static(scene, first_step=FIRST_STEP / 2)
    found, seconds = outcomes[0], statistics.median(outcome.seconds for outcome in outcomes)
    return found, (
        f"{found.status:10} {bracket(found):>17} {bracket(other):>17} {found.steps:8d} "
        f"{seconds:8.2f} {statistics.median(spent):8.2f}"
    )


def median_ms(call: Callable[[], object]) -> float:
    """Median milliseconds of a call."""
    taken = []
    for _ in range(SYSTEMS):
        start = time.perf_counter()
        call()
        taken.append(time.perf_counter() - start)
    return 1e3 * statistics.median(taken)


def linear_system(system: StaticSystem) -> str:
    """Milliseconds of a linear system, assembled and solved in banded form, and of sparse factors of it alone."""
    law, equations = system.law, system.equilibrium
    joints = equations.opening @ diags_array(law.normal_stiffness) @ equations.opening.T
    joints += equations.slip @ diags_array(law.shear_stiffness) @ equations.slip.T
    matrix = csc_array(joints + 1e-9 * diags_array(np.ones(system.freedoms)))
    order = np.argsort(splu(matrix, permc_spec="MMD_AT_PLUS_A").perm_c)
    sorted_matrix = csc_array(matrix[order][:, order])
    right = np.ones(system.unknowns)
    banded = median_ms(lambda: system.solve(system.elastic, Control(0.0, multiplier=True), right))
    sparse = median_ms(lambda: splu(sorted_matrix, permc_spec="NATURAL", options={"SymmetricMode": True}))
    return f"{banded:8.2f} {sparse:8.2f}"


def published_algorithm(scene: Scene, collapse: float) -> Counter[str]:
    """How the paper's algorithm ended, and how often below the collapse load."""
    ends: Counter[str] = Counter()
    for increment in INCREMENTS:
        for arm in ARMS:
            found = stiffness_update(scene, increment, 1.0, arm)
            ends[found.status[-1]] += 1
            ends["below"] += (found.multiplier or 0.0) < collapse
    return ends


def main() -> None:
    """Print a row a wall, then the sum over the paper's algorithm."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("walls", nargs="*", help="published walls, all by default")
    parser.add_argument("--runs", type=int, default=3, help="runs of which times are the median")
    arguments = parser.parse_args()
    print(f"{'':55}{'half the':>17}{'':28}linear system [ms]")
    known = f"{'wall':18} blocks {'status':10} {'bracket':>17} {'first step':>17}"
    print(known, " systems  seconds  CPU [s]   banded   sparse")
    ends: Counter[str] = Counter()
    for case in PUBLISHED:
        if arguments.walls and case.name not in arguments.walls:
            continue
        scene = published_scene(case.name)
        found, row = pushover(scene, arguments.runs)
        print(f"{case.name:18} {scene.wall.sum():6d} {row} {linear_system(static_system(scene))}", flush=True)
        if scene.joint.cohesion == 0:
            ends += published_algorithm(scene, found.lower or 0.0)
    runs = sum(ends[status] for status in ("converged", "cycle", "singular", "wandering"))
    print(f"the paper's algorithm, {runs} runs on dry walls, below the collapse load at its end in {ends['below']}:")
    print(", ".join(f"{ends[status]} {status}" for status in ("cycle", "singular", "wandering", "converged")))


if __name__ == "__main__":
    main()
