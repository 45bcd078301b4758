"""Upper bound of the highest frequency of deformable blocks at finite displacements, from each block by itself."""

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from runningbond.contacts.search import Contacts
from runningbond.dynamics import BlockSystem, block_frequency_squared, joint_shares, stable_step
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.joints.compiled import kernel
from runningbond.joints.law import KernelLaw
from runningbond.scene import Array, Indices

from .deformable_sides import DeformableSides, gather_deformable
from .mass_scaling import FREQUENCY_TOLERANCE, ScaledModes
from .node_outline import NodeOutline

Blocks: TypeAlias = tuple[Array, Array, Array, Array]
"""Blocks with equally many modes: share of contact stiffness ``(n, m, m)``; mass, stiffness, viscosity ``(n, m)``."""


def frequency_squared(
    blocks: NodeOutline,
    scaled: ScaledModes | BlockSystem,
    contacts: Contacts,
    geometry: DeformableSides,
    law: KernelLaw,
    guess: float,
) -> float:
    """Upper bound of the largest ω² [1/s²] with all contacts closed: each block on its share of their stiffness.

    The viscosity of the deformations is included, at the step of `stable_step`.

    Parameters
    ----------
    blocks, scaled
        The blocks, and the masses and viscosities of their modes.
    contacts, geometry, law
        The contacts, the arrays of their kernels, which are overwritten, and their law.
    guess
        Starting value of the bound [1/s²].
    """
    alike: dict[int, list[Blocks]] = {}
    for each in _blocks_on(blocks, scaled, contacts, geometry, law):
        alike.setdefault(each[1].shape[1], []).append(each)
    groups = [[np.concatenate(arrays) for arrays in zip(*group, strict=True)] for group in alike.values()]
    square = guess
    while True:
        viscous, bound = 2 / stable_step(square, VISCOUS, LOCAL), 0.0
        for stiffness, mass, k, c in groups:
            with_own = stiffness + (k + viscous * c)[:, :, None] * np.eye(k.shape[1])
            bound = max(bound, float(block_frequency_squared(with_own, mass).max()))
        if bound <= square:
            return bound
        square = bound * (1 + FREQUENCY_TOLERANCE)


def _blocks_on(
    blocks: NodeOutline,
    scaled: ScaledModes | BlockSystem,
    contacts: Contacts,
    geometry: DeformableSides,
    law: KernelLaw,
) -> Iterator[Blocks]:
    """The blocks of each template, with their shares of the contacts' stiffness."""
    wall = blocks.wall
    motion = np.zeros(len(scaled.mass))
    motion[wall.rigid] = contacts.motion.reshape(-1, 3)
    gather_deformable(motion, tuple(geometry), *np.zeros((2, len(contacts))))
    # One row per contact and block: first all blocks b, then all blocks a.
    facet = geometry.touched[:, :2].T.ravel()
    block, share, n = blocks.nodes.owner[facet], geometry.contact[:, 4:6].T.ravel(), len(contacts)
    mass = scaled.mass[wall.rigid[:, 0]]
    part = joint_shares(mass[np.column_stack([block, np.roll(block, n)])], 0.5)[:, 0]
    springs = np.column_stack([law.stiffest, law.shear_stiffness]) * contacts.area[:, None]
    weight = np.tile(springs, (2, 1)) * part[:, None]
    number, place = wall.place[block].T
    order = np.argsort(number, kind="stable")
    first = np.searchsorted(number[order], np.arange(len(wall.templates) + 1))
    split = [wall.split(values) for values in (scaled.mass, wall.stiffness, scaled.viscosity)]
    turned, contact, following = geometry.placed.blocks, geometry.contact, blocks.nodes.following
    for k, (template, table) in enumerate(zip(wall.templates, blocks.tables, strict=True)):
        rows = order[first[k] : first[k + 1]]
        own = np.zeros((len(template.blocks), *2 * [len(template.modes.mass)]))
        at, start, stop = rows % n, blocks.row[facet[rows]], blocks.row[following[facet[rows]]]
        arrays = contact[at, :4], turned[block[rows]], share[rows], weight[rows]
        _add_springs(place[rows], start, stop, *arrays, np.ascontiguousarray(table), own)
        mass_k, stiffness, viscosity = (values[k].T for values in split)
        yield own, mass_k, stiffness, viscosity


@kernel
def _add_springs(
    place: Indices,
    start: Indices,
    stop: Indices,
    contact: Array,
    turned: Array,
    share: Array,
    weight: Array,
    table: Array,
    own: Array,
) -> None:
    """Add the stiffness of contacts ``(n,)``, normal and shear ``weight`` ``(n, 2)`` [N/m], to blocks' ``(nb, m, m)``.

    Contact k is on block ``place[k]``, between rows ``start[k]`` and ``stop[k]`` of the ``table`` ``(no, 2, m - 3)``,
    at ``share[k]`` of the way.
    """
    m = own.shape[1]
    row = np.zeros(m)
    for k in range(place.size):
        cosine, sine = turned[k, 0], turned[k, 1]
        x, y = contact[k, 0] - turned[k, 2], contact[k, 1] - turned[k, 3]
        for way in range(2):
            dx, dy = contact[k, 2], contact[k, 3]
            if way == 1:
                dx, dy = -dy, dx
            along, across = cosine * dx + sine * dy, cosine * dy - sine * dx
            row[0], row[1], row[2] = dx, dy, x * dy - y * dx
            for mode in range(m - 3):
                near = along * table[start[k], 0, mode] + across * table[start[k], 1, mode]
                far = along * table[stop[k], 0, mode] + across * table[stop[k], 1, mode]
                row[3 + mode] = (1.0 - share[k]) * near + share[k] * far
            for i in range(m):
                scaled = weight[k, way] * row[i]
                for j in range(m):
                    own[place[k], i, j] += scaled * row[j]
