"""`dem-static` on every published wall: its bracket, the bracket with half the first load step, and the cost.

Also the time of a linear system by nested dissection, as in the model, and by a sparse factorisation.
"""

import argparse
import resource
import statistics
import time
from collections.abc import Callable
from itertools import count

import numpy as np
from scipy.sparse import csc_array, diags_array
from scipy.sparse.linalg import splu

from dem.static import FIRST_STEP, dem_static
from dem.static_system import Control, StaticSystem, static_system
from runningbond.compare import PUBLISHED, published_scene
from runningbond.results import Outcome
from runningbond.scene import Scene

SYSTEMS = 20


def cpu() -> float:
    """User CPU seconds of this process so far."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def bracket(outcome: Outcome) -> str:
    """Bracket as text."""
    return " – ".join(
        "?" if x is None else f"{x:.4f}" if x < 10 else f"{x:.0f}" for x in (outcome.lower, outcome.upper)
    )


def pushover(scene: Scene, runs: int) -> str:
    """Cells of a scene in the table."""
    outcomes, spent = [], []
    for _ in range(runs):
        before = cpu()
        outcomes.append(dem_static(scene))
        spent.append(cpu() - before)
    other = dem_static(scene, first_step=FIRST_STEP / 2)
    found, seconds = outcomes[0], statistics.median(outcome.seconds for outcome in outcomes)
    return (
        f"{found.status:10} {bracket(found):>17} {bracket(other):>17} {found.steps:8d} "
        f"{seconds:8.2f} {statistics.median(spent):8.2f}"
    )


def median_ms(call: Callable[[], object]) -> float:
    """Median milliseconds of a call, of `SYSTEMS` repetitions."""
    taken = []
    for _ in range(SYSTEMS):
        start = time.perf_counter()
        call()
        taken.append(time.perf_counter() - start)
    return 1e3 * statistics.median(taken)


def linear_system(system: StaticSystem) -> str:
    """Milliseconds to assemble, factorise and solve a linear system, and to factorise it alone as a sparse matrix."""
    law, equations = system.law, system.equilibrium
    joints = equations.opening @ diags_array(law.normal_stiffness) @ equations.opening.T
    joints += equations.slip @ diags_array(law.shear_stiffness) @ equations.slip.T
    matrix = csc_array(joints + 1e-9 * diags_array(np.ones(system.freedoms)))
    order = np.argsort(splu(matrix, permc_spec="MMD_AT_PLUS_A").perm_c)
    sorted_matrix = csc_array(matrix[order][:, order])
    right = np.ones(system.unknowns)
    stiffer = count(1)  # an unchanged tangent would not be factorised again
    own = median_ms(lambda: system.solve(next(stiffer) * system.elastic, Control(0.0, multiplier=True), right))
    sparse = median_ms(lambda: splu(sorted_matrix, permc_spec="NATURAL", options={"SymmetricMode": True}))
    return f"{own:8.2f} {sparse:8.2f}"


def main() -> None:
    """Print one row per wall."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("walls", nargs="*", help="published walls, all by default")
    parser.add_argument("--runs", type=int, default=3, help="runs of which times are the median")
    arguments = parser.parse_args()
    print(f"{'':55}{'half the':>17}{'':28}linear system [ms]")
    known = f"{'wall':18} blocks {'status':10} {'bracket':>17} {'first step':>17}"
    print(known, " systems  seconds  CPU [s]      own   sparse")
    for case in PUBLISHED:
        if arguments.walls and case.name not in arguments.walls:
            continue
        scene = published_scene(case.name)
        row = pushover(scene, arguments.runs)
        print(f"{case.name:18} {scene.wall.sum():6d} {row} {linear_system(static_system(scene))}", flush=True)


if __name__ == "__main__":
    main()
