"""Bodies in clusters, with more inertia against relative motion than against common motion (selective mass scaling).

A cluster has the rigid motion with the linear and angular momentum of its bodies; the remainder of the bodies'
rigid motions carries no momentum. With the projection P of bodies' motions onto those of their clusters, and their
masses M, the remainder has 1 + β times the physical inertia (`olovsson2005`):

    M* = M + β (M − Pᵀ M P),    M*⁻¹ f = P a + (a − P a) / (1 + β),    a = M⁻¹ f.

Static equilibrium does not depend on the masses, and a cluster that moves as a rigid body has its physical mass.
"""

from typing import NamedTuple

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array, Unsigned


class Clusters(NamedTuple):
    """Which bodies are in clusters, and how they contribute to the motion of their clusters."""

    freedom: Unsigned  # (n, 3) indices in the motion of the translations and the rotation of each body in a cluster
    cluster: Unsigned  # (n,) its cluster
    arm: Array  # (n, 2) its centroid relative to that of the cluster [m]
    # (n, 3) its fraction of the cluster's mass, its mass over the cluster's moment of inertia J [1/m²], fraction of J
    part: Array
    more: float = 0.0  # β

    @property
    def number(self) -> int:
        """Number of clusters."""
        return len(np.unique(self.cluster))

    def energy(self, velocity: Array, mass: Array) -> float:
        """Kinetic energy at a velocity ``(nd,)`` in excess of that of the masses ``(nd,)`` [J]."""
        if not len(self.cluster):
            return 0.0
        motion = np.zeros((self.number, 3))
        sum_up(self.freedom, self.cluster, self.arm, self.part, velocity, motion)
        u, v, spin = motion[self.cluster].T
        x, y = self.arm.T
        apart = velocity[self.freedom] - np.column_stack([u - y * spin, v + x * spin, spin])
        return float(0.5 * self.more * (mass[self.freedom] * apart**2).sum())


_NONE = np.zeros(0, dtype=np.uint64)
NO_CLUSTERS = Clusters(_NONE.reshape(0, 3), _NONE, np.zeros((0, 2)), np.zeros((0, 3)))


@kernel
def sum_up(freedom: Unsigned, cluster: Unsigned, arm: Array, part: Array, source: Array, motion: Array) -> None:
    """Write the motions of clusters ``(nc, 3)`` that have the momentum of their bodies in ``source`` ``(nd,)``."""
    motion[:] = 0.0
    for k in range(cluster.size):
        u, v, spin = source[freedom[k, 0]], source[freedom[k, 1]], source[freedom[k, 2]]
        c = cluster[k]
        motion[c, 0] += part[k, 0] * u
        motion[c, 1] += part[k, 0] * v
        motion[c, 2] += part[k, 1] * (arm[k, 0] * v - arm[k, 1] * u) + part[k, 2] * spin
