"""Cost of a time step: the three-pass kernels beside the same operators as sparse matrices, in one run.

Prints nanoseconds per joint point and step, with the spread of the runs and the ratio of medians; then the cost of a
step against the number of blocks, and its exponent.
"""

import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array, diags_array

from dem.rigid_system import contact_points, rigid_system
from runningbond.compare import published_scene
from runningbond.dynamics import Run, State
from runningbond.limit.kinematics import jump_operator
from runningbond.scene import Array, Scene, scene_from_dict

RUNS = 7
WALL = {
    "block": {"density": 1800.0},
    "joint": {"friction": 0.6, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}


def seconds(call: Callable[[], object]) -> list[float]:
    """Processor times of `RUNS` calls, after one call to warm up."""
    call()
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return times


def kernels(scene: Scene, steps: int) -> list[float]:
    """Seconds per step of the compiled kernels."""
    run = Run(rigid_system(scene))
    state = State.at_rest(run.system)
    run.hold(state, 0.2, 500)
    return [t / steps for t in seconds(lambda: run.hold(state, 0.2, steps))]


def sparse(scene: Scene, steps: int) -> list[float]:
    """Seconds per step of the same scheme, with sparse matrices and numpy arrays."""
    system, points = rigid_system(scene), contact_points(scene)
    run = Run(system)
    # Columns in the order of the system's coordinates.
    column = np.argsort(system.rigid.ravel())
    jump = jump_operator(points, scene.blocks.centroid)
    opening, slips = csr_array(jump.opening[:, column]), csr_array(jump.slip[:, column])
    k_n, k_t, tension, shear, friction, flexibility = (system.interface.law.of_points(row) for row in range(6))
    mobility, load = 1 / system.mass, system.dead + 0.2 * system.live
    weight = diags_array(points.area)
    opening_t, slip_t = csr_array(opening.T @ weight), csr_array(slips.T @ weight)
    motion, velocity, plastic = np.zeros_like(load), np.zeros_like(load), np.zeros(len(points))
    before_n, before_t = np.zeros(len(points)), np.zeros(len(points))
    beta = 0.1

    def advance() -> None:
        nonlocal motion, velocity, plastic, before_n, before_t
        for _ in range(steps):
            jump_n: Array = np.asarray(opening @ motion)
            slip: Array = np.asarray(slips @ motion)
            elastic = np.minimum(k_n * jump_n, tension)
            normal = np.minimum(elastic + (elastic < tension) * beta * k_n * (jump_n - before_n), tension)
            most = shear + friction * (tension - normal)
            trial = k_t * (slip - plastic)
            held = np.clip(trial, -most, most)
            tangential = np.clip(held + beta * k_t * (slip - before_t), -most, most)
            plastic = plastic + (trial - held) * flexibility
            before_n, before_t = jump_n, slip
            force = load - opening_t @ normal - slip_t @ tangential
            velocity = velocity + run.dt * mobility * (force - run.local * np.abs(force) * np.sign(velocity))
            motion = motion + run.dt * velocity

    return [t / steps for t in seconds(advance)]


def panel(blocks: int) -> Scene:
    """A square panel with about this number of blocks of 240 × 60 mm."""
    courses = max(2, round((blocks * 4) ** 0.5))
    along = max(1, round(blocks / courses))
    wall = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12}
    return scene_from_dict({"wall": {**wall, "length": 0.24 * along, "height": 0.06 * courses}, **WALL})


def main() -> None:
    """Print both tables."""
    print("wall        points   kernels [ns/point-step] (spread)   sparse [ns/point-step]   sparse / kernels")
    for name in ("wall-w1", "panel-05", "panel-06", "panel-11"):
        scene = published_scene(name)
        n = 2 * len(scene.joints)
        fast, slow = kernels(scene, 4_000_000 // n), sparse(scene, 200_000 // n + 10)
        a, b = statistics.median(fast), statistics.median(slow)
        print(
            f"{name:10} {n:7d} {1e9 * a / n:14.2f} ({1e9 * min(fast) / n:.2f} … {1e9 * max(fast) / n:.2f}) "
            f"{1e9 * b / n:30.1f} {b / a:18.1f}"
        )
    print("\nblocks   microseconds a step   seconds a million steps")
    sizes, costs = [], []
    for blocks in (100, 300, 1000, 3000, 10_000, 30_000):
        scene = panel(blocks)
        cost = statistics.median(kernels(scene, max(50, 2_000_000 // (6 * blocks))))
        sizes.append(scene.wall.sum())
        costs.append(cost)
        print(f"{sizes[-1]:6d} {1e6 * cost:20.2f} {1e6 * cost:25.1f}")
    slope = np.polyfit(np.log(sizes), np.log(costs), 1)[0]
    print(f"cost of a step grows as blocks to the power {slope:.2f}")


if __name__ == "__main__":
    main()
