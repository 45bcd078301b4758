"""A block on a bed of springs and dashpots without tension, integrated independently of the suite."""

import math

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import Array

from .housner import GRAVITY, HousnerBlock


@kernel
def _rotations(
    bed: tuple[Array, Array],
    block: tuple[float, float, float],
    joint: tuple[float, float, float],
    pulse: tuple[float, float, float],
    time: tuple[float, int],
) -> Array:
    """Rotation [rad] after each of a number of time steps, by central differences."""
    (place, area), (h, mass, inertia), (k, beta, friction) = bed, block, joint
    (amplitude, omega, end), (dt, steps) = pulse, time
    x, y, turn = 0.0, -mass * GRAVITY / (k * area.sum()), 0.0
    dx, dy, spin = 0.0, 0.0, 0.0
    found = np.empty(steps)
    for i in range(steps):
        t = i * dt
        ground = amplitude * math.sin(omega * t) if t < end else 0.0
        cosine, sine = math.cos(turn), math.sin(turn)
        fx, fy, moment = -mass * ground, -mass * GRAVITY, 0.0
        for j in range(place.size):
            arm_x, arm_y = place[j] * cosine + h * sine, place[j] * sine - h * cosine
            gap = y + h + arm_y
            if gap < 0.0:
                n = max(0.0, -k * gap - k * beta * (dy + spin * arm_x))
                q = -k * (x + arm_x - place[j]) - k * beta * (dx - spin * arm_y)
                q = max(-friction * n, min(friction * n, q))
                fx += q * area[j]
                fy += n * area[j]
                moment += area[j] * (arm_x * n - arm_y * q)
        dx, dy, spin = dx + dt * fx / mass, dy + dt * fy / mass, spin + dt * moment / inertia
        x, y, turn = x + dt * dx, y + dt * dy, turn + dt * spin
        found[i] = turn
    return found


def peak(block: HousnerBlock, springs: tuple[Array, Array], k: float, pulse: tuple[float, float]) -> float:
    """Largest rotation [rad] within 1.2 s of a block 0.12 m thick, of 1800 kg/m³, under half a sine.

    Springs are at places on [-1, 1], with shares of the base; each dashpot is critical at the highest frequency.
    """
    b, h, (at, share), (amplitude, period) = block.b, block.h, springs, pulse
    area = 2 * b * 0.12
    mass = 1800.0 * 2 * h * area
    inertia = mass * (b * b + h * h) / 3
    stiffness = k * area * np.array([[1, 0, -h], [0, 1, 0], [-h, 0, h * h + b * b * float(share @ at**2)]])
    root = np.sqrt([mass, mass, inertia])
    highest = math.sqrt(float(np.linalg.eigvalsh(stiffness / np.outer(root, root)).max()))
    bed, body = (at * b, share * area), (h, mass, inertia)
    dt = 1e-6
    sine = amplitude, 2 * math.pi / period, period / 2
    return float(np.abs(_rotations(bed, body, (k, 2 / highest, 2.0), sine, (dt, round(1.2 / dt)))).max())
