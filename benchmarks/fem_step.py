"""Cost of a time step of deformable blocks: modal form with compiled kernels beside nodal form with sparse matrices.

Both have the same triangles, the same joint elements and the same law. The nodal form K u + Bᵀ (w σ(B u)) has either
the consistent mass, which yields the same step, or a lumped mass, which needs no linear solve but has different rotary
inertia. Prints, in one run, processor nanoseconds per triangle and step with their spread; the cost of a second of
motion with blocks as stiff as in the paper, by the modal form with mass scaling and by the sparse form with its own
stable step; and the cost against the number of triangles, with its exponent.
"""

import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import eigsh, splu
from threadpoolctl import threadpool_limits

from fem_interface.joint_elements import nodal_jump
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.operators import lumped_mass, mass_matrix, stiffness_matrix
from fem_interface.system import system_of
from runningbond.dynamics import Run, State, stable_step
from runningbond.scene import Scene, scene_from_dict

RUNS = 7
WALL = {
    "block": {"density": 1800.0, "young": 1e12, "poisson": 0.0},
    "joint": {"friction": 0.6, "mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}


def panel(blocks: int) -> Scene:
    """A square panel with about this number of blocks of 240 × 60 mm."""
    courses = max(2, round((blocks * 4) ** 0.5))
    along = max(1, round(blocks / courses))
    wall = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12}
    return scene_from_dict({"wall": {**wall, "length": 0.24 * along, "height": 0.06 * courses}, **WALL})


def seconds(call: Callable[[], object]) -> list[float]:
    """Processor times of `RUNS` calls, after one call to warm up."""
    call()
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return times


def triangles(wall: ModalWall) -> int:
    """Number of triangles in the blocks that move."""
    return int((~wall.scene.fixed[wall.mesh.triangle_block]).sum())


def modal(wall: ModalWall, steps: int) -> tuple[list[float], float]:
    """Seconds per step of the compiled kernels, and the time step [s]."""
    run = Run(system_of(wall))
    state = State.at_rest(run.system)
    run.hold(state, 0.2, 500)
    return [t / steps for t in seconds(lambda: run.hold(state, 0.2, steps))], run.dt


def sparse(wall: ModalWall, steps: int, *, lumped: bool) -> tuple[list[float], float]:
    """Seconds per step of the same scheme with nodal arrays and sparse matrices, and its stable time step [s]."""
    scene, mesh, system = wall.scene, wall.mesh, system_of(wall, damping=0.0, mass_scaling=False)
    free = np.repeat(~scene.fixed[mesh.block], 2)
    young, poisson = scene.block.young or 0.0, scene.block.poisson
    K = stiffness_matrix(mesh.points, mesh.triangles, young, poisson, scene.thickness)[free][:, free]
    properties = (mesh.points, mesh.triangles, scene.block.density, scene.thickness)
    M = diags_array(lumped_mass(*properties)).tocsr() if lumped else mass_matrix(*properties)
    M = csr_array(M[free][:, free])
    jump = nodal_jump(wall.elements, len(mesh.points))
    B_n, B_t = (csr_array(B.tocsc()[:, free].tocsr()) for B in (jump.opening, jump.slip))
    weight = diags_array(system.interface.area)
    B_n_t, B_t_t = csr_array(B_n.T @ weight), csr_array(B_t.T @ weight)
    k_n, k_t, tension, shear, friction, flexibility = (system.interface.law.of_points(row) for row in range(6))
    stiff = K + B_n_t @ diags_array(k_n) @ B_n + B_t_t @ diags_array(k_t) @ B_t
    fastest = system.interface.frequency_squared
    if lumped:
        root = diags_array(1 / np.sqrt(M.diagonal()))
        fastest = float(eigsh(root @ stiff @ root, 1, which="LM", tol=1e-3, return_eigenvectors=False)[0])
    dt, local, beta = stable_step(fastest, 0.1, 0.5), 0.5, 0.1
    load = M @ np.tile([0.2 * 9.81, -9.81], M.shape[0] // 2)
    mobility, solve = 1 / M.diagonal(), splu(M.tocsc()).solve
    u, v, plastic = np.zeros_like(load), np.zeros_like(load), np.zeros(len(k_n))
    before_n, before_t = np.zeros_like(k_n), np.zeros_like(k_n)

    def advance() -> None:
        nonlocal u, v, plastic, before_n, before_t
        for _ in range(steps):
            opening, slip = B_n @ u, B_t @ u
            elastic = np.minimum(k_n * opening, tension)
            normal = np.minimum(elastic + (elastic < tension) * beta * k_n * (opening - before_n), tension)
            most = shear + friction * (tension - normal)
            trial = k_t * (slip - plastic)
            held = np.clip(trial, -most, most)
            tangential = np.clip(held + beta * k_t * (slip - before_t), -most, most)
            plastic = plastic + (trial - held) * flexibility
            before_n, before_t = opening, slip
            force = load - K @ u - B_n_t @ normal - B_t_t @ tangential
            resisted = force - local * np.abs(force) * np.sign(v)
            v = v + dt * (mobility * resisted if lumped else solve(resisted))
            u = u + dt * v

    return [t / steps for t in seconds(advance)], dt


def main() -> None:
    """Print the tables."""
    wall = modal_wall(panel(1230), modes="all")
    n, blocks = triangles(wall), int((~wall.scene.fixed).sum())
    found = {
        "modes and runs": modal(wall, 2000),
        "sparse, consistent mass": sparse(wall, 40, lumped=False),
        "sparse, lumped mass": sparse(wall, 40, lumped=True),
    }
    fast, dt = found["modes and runs"]
    fast_cost = statistics.median(fast)
    print(f"{blocks} blocks, {n} triangles, {len(wall.elements.points)} joint points, E = 1000 GPa\n")
    print("                          ns a triangle-step (spread)   ratio   step [µs]   s a physical second   ratio")
    for name, (times, step) in found.items():
        cost = statistics.median(times)
        spread = f"({1e9 * min(times) / n:.2f} … {1e9 * max(times) / n:.2f})"
        print(
            f"{name:24} {1e9 * cost / n:8.2f} {spread:20} {cost / fast_cost:7.1f} {1e6 * step:11.3f} "
            f"{cost / step:21.3g} {cost / step / (fast_cost / dt):7.0f}"
        )

    print("\nblocks   triangles   ns a triangle-step")
    sizes, costs = [], []
    for wanted in (100, 300, 1000, 3000, 10_000):
        wall = modal_wall(panel(wanted), modes="all")
        n = triangles(wall)
        cost = statistics.median(modal(wall, max(20, 4_000_000 // n))[0])
        sizes.append(n)
        costs.append(cost)
        print(f"{int((~wall.scene.fixed).sum()):6d} {n:11d} {1e9 * cost / n:14.2f}")
    slope = np.polyfit(np.log(sizes), np.log(costs), 1)[0]
    print(f"cost of a step grows as triangles to the power {slope:.2f}")


if __name__ == "__main__":
    with threadpool_limits(limits=1, user_api="blas"):  # as in the models; processor time includes waiting threads
        main()
