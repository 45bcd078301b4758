"""Time integration of deformable blocks in nodal coordinates."""

import numpy as np
from scipy.sparse.linalg import splu

from fem_interface.joint_elements import nodal_jump
from fem_interface.modal_wall import ModalWall
from runningbond.dynamics import BlockSystem

from .walls import whole


class NodalSteps:
    """Central differences for all nodes, with forces K u + Bᵀ (w σ(B u)) from sparse matrices."""

    def __init__(self, found: ModalWall, system: BlockSystem) -> None:
        K, M = whole(found.mesh, found.scene)
        free = np.repeat(~found.scene.fixed[found.mesh.block], 2)
        jump = nodal_jump(found.elements, len(found.mesh.points))
        self.law, self.area, self.free = system.interface.law, system.interface.area, free
        self.K, self.M = K[free][:, free], M[free][:, free].tocsc()
        self.opening, self.slip = jump.opening.tocsc()[:, free].tocsr(), jump.slip.tocsc()[:, free].tocsr()
        gravity = np.tile(found.scene.load.gravity, len(found.mesh.points))[free]
        side = np.tile([np.hypot(*found.scene.load.gravity), 0.0], len(found.mesh.points))[free]
        self.dead, self.live = self.M @ gravity, self.M @ side
        self.history = np.zeros((system.interface.law.rows, system.interface.law.points))
        self.u, self.v = np.zeros(free.sum()), np.zeros(free.sum())

    def take(self, steps: int, dt: float, viscosity: float, multiplier: float) -> None:
        solve = splu(self.M).solve
        normal, tangential = np.zeros((2, self.law.points))
        for _ in range(steps):
            opening, slip = self.opening @ self.u, self.slip @ self.u
            self.law.kernel(opening, slip, self.law.parameters, self.history, viscosity, normal, tangential)
            joint = self.opening.T @ (self.area * normal) + self.slip.T @ (self.area * tangential)
            force = self.dead + multiplier * self.live - self.K @ self.u - joint
            self.v = self.v + dt * solve(force)
            self.u = self.u + dt * self.v
