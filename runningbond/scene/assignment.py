"""Material of each block and each joint: the default one, unless an entry of ``[[assign]]`` chooses another."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .arrays import Array, Indices, Mask
from .blocks import Blocks
from .errors import SceneError
from .ranges import one_of
from .segments import Joints
from .settlement import read_box
from .table import Table

ANY = "*"
GROUND, BEAM = "ground", "beam"
"""Names that ``between`` uses for bodies without a block material: the ground and the beam."""

ORIENTATIONS = ("bed", "head")
"""Bed joints lie flatter than 45°; all others are head joints."""


@dataclass(frozen=True)
class Assignment:
    """An entry of ``[[assign]]``: a material, and the criteria that select its blocks or joints (None: unused)."""

    key: str
    material: str
    of_joints: bool
    box: tuple[tuple[float, float], tuple[float, float]] | None = None
    layer: str | None = None
    blocks: tuple[int, ...] | None = None
    between: tuple[str, str] | None = None
    orientation: str | None = None


def read_assignments(content: Any, block_names: Sequence[str], joint_names: Sequence[str]) -> tuple[Assignment, ...]:
    """The entries of ``[[assign]]``, in the order of the file."""
    if not isinstance(content, list):
        raise SceneError("assign", "must be tables, [[assign]] with keys of their own", content)
    return tuple(_read(Table(f"assign[{k}]", one), block_names, joint_names) for k, one in enumerate(content))


def _read(table: Table, block_names: Sequence[str], joint_names: Sequence[str]) -> Assignment:
    of_joints = "joint" in table
    if of_joints == ("block" in table):
        raise SceneError(table.name, "must have one of block and joint, the name of a material")
    material = table.choice("joint", joint_names) if of_joints else table.choice("block", block_names)
    ways = ("between", "box", "layer") if of_joints else ("box", "layer", "blocks")
    given = [way for way in ways if way in table]
    orientation = table.choice("orientation", ORIENTATIONS) if of_joints and "orientation" in table else None
    if len(given) > 1 or not (given or orientation):
        raise SceneError(table.name, f"must have one of {', '.join(ways)}{'; or orientation' if of_joints else ''}")
    way = given[0] if given else ""
    value = table.value(way) if given else None
    table.finish()
    key = table.key(way)
    if way == "box":
        value = read_box(key, value, flat=True)
    elif way == "layer" and not isinstance(value, str):
        raise SceneError(key, "must be the name of a layer", value)
    elif way == "blocks":
        value = _numbers(key, value)
    elif way == "between":
        value = _pair(key, value, (ANY, *block_names, GROUND, BEAM))
    return Assignment(table.name, material, of_joints, orientation=orientation, **{way: value} if way else {})


def _numbers(key: str, value: Any) -> tuple[int, ...]:
    if not isinstance(value, list) or not value or not all(type(one) is int and one >= 0 for one in value):
        raise SceneError(key, "must be a list of block numbers, from 0", value)
    return tuple(value)


def _pair(key: str, value: Any, options: Sequence[str]) -> tuple[str, str]:
    if not isinstance(value, list) or len(value) != 2:
        raise SceneError(key, f'must be two names of block materials, "{ANY}" for any', value)
    first, second = (one_of(f"{key}[{k}]", name, options) for k, name in enumerate(value))
    return first, second


def assign_blocks(
    blocks: Blocks, names: Sequence[str], layers: Sequence[str], given: Mapping[int, str], entries: Sequence[Assignment]
) -> tuple[Indices, dict[int, str]]:
    """Material of each block of a wall, ``(nb,)``, as an index into `names`, and a report on each entry.

    Parameters
    ----------
    names
        Names of the materials, the default one first.
    layers
        Layer of each block; empty if the blocks have none.
    given
        Materials of blocks whose own description names one, such as lintels, by the numbers of these blocks.
    entries
        Entries of ``[[assign]]``; later ones override earlier ones.
    """
    material = np.zeros(len(blocks), dtype=np.int64)
    for block, name in given.items():
        material[block] = names.index(name)
    chosen = {k: _chosen_blocks(one, blocks, layers) for k, one in enumerate(entries) if not one.of_joints}
    for k, own in chosen.items():
        material[own] = names.index(entries[k].material)
    return material, _became(entries, chosen, "block")


def _chosen_blocks(entry: Assignment, blocks: Blocks, layers: Sequence[str]) -> Mask:
    chosen: Mask = np.zeros(len(blocks), dtype=np.bool_)
    if entry.blocks is not None:
        if max(entry.blocks) >= len(blocks):
            raise SceneError(
                f"{entry.key}.blocks", f"must be below {len(blocks)}, the number of blocks", max(entry.blocks)
            )
        chosen[list(entry.blocks)] = True
    elif entry.layer is not None:
        chosen = _on_layer(entry, len(blocks), layers)
    elif entry.box is not None:
        chosen = _in_box(blocks.centroid, entry.box, blocks.tolerance)
    return _some(entry, chosen, "block")


def assign_joints(
    joints: Joints,
    names: Sequence[str],
    material_names: Sequence[str],
    layers: Sequence[str],
    entries: Sequence[Assignment],
    reach: float,
    beam: tuple[int, str] | None = None,
) -> tuple[Indices, dict[int, str]]:
    """Material of each joint, ``(nj,)``, as an index into `names`, and a report on each entry.

    Entries do not change the material of potential cracks.

    Parameters
    ----------
    material_names
        Name that ``between`` uses for each block.
    reach
        Contact tolerance [m].
    beam
        Block number of the beam, and the name of the material of its joints.
    """
    material = np.zeros(len(joints), dtype=np.int64)
    if beam:
        material[(joints.block == beam[0]).any(axis=1)] = names.index(beam[1])
    chosen = {
        k: _chosen_joints(one, joints, material_names, layers, reach) for k, one in enumerate(entries) if one.of_joints
    }
    for k, own in chosen.items():
        material[own] = names.index(entries[k].material)
    cracks = names.index("inner_joint") if joints.inner.any() else 0
    return np.where(joints.inner, cracks, material), _became(entries, chosen, "joint")


def _became(entries: Sequence[Assignment], chosen: Mapping[int, Mask], what: str) -> dict[int, str]:
    """Report on each entry, by its number: how many blocks or joints it keeps after later entries override it."""
    said, later = {}, np.zeros(len(next(iter(chosen.values()), [])), np.bool_)
    for k in sorted(chosen, reverse=True):
        n, kept = int(chosen[k].sum()), int((chosen[k] & ~later).sum())
        later |= chosen[k]
        text = f"{kept} {what}{'s' * (kept != 1)} of {entries[k].material}"
        if kept == 0:
            text = f"assigns {entries[k].material} to nothing: later entries choose all of its {n} {what}s"
        elif kept < n:
            text += f"; later entries choose {n - kept} more that it chose"
        said[k] = f"{entries[k].key}: {text}"
    return said


def _in_box(points: Array, box: tuple[tuple[float, float], tuple[float, float]], reach: float) -> Mask:
    """Whether points ``(n, 2)`` lie in a box or outside it by at most the contact tolerance `reach`.

    Rounding makes this necessary: three courses of 0.1 m end at 0.30000000000000004 m, three of 0.3 m at
    0.8999999999999999 m.
    """
    low, high = np.array(box)
    inside: Mask = np.all((points >= low - reach) & (points <= high + reach), axis=1)
    return inside


def _chosen_joints(
    entry: Assignment, joints: Joints, material_names: Sequence[str], layers: Sequence[str], reach: float
) -> Mask:
    chosen: Mask = ~joints.inner
    if entry.box is not None:
        chosen &= _in_box(joints.ends.mean(axis=1), entry.box, reach)
    elif entry.layer is not None:
        chosen &= _on_layer(entry, len(material_names), layers)[joints.block].any(axis=1)
    elif entry.between is not None:
        of = np.array(material_names, dtype=object)[joints.block]
        first, second = (np.ones(of.shape, dtype=bool) if name == ANY else of == name for name in entry.between)
        chosen &= (first[:, 0] & second[:, 1]) | (first[:, 1] & second[:, 0])
    if entry.orientation is not None:
        chosen &= joints.is_bed == (entry.orientation == "bed")
    return _some(entry, chosen, "joint")


def _on_layer(entry: Assignment, n: int, layers: Sequence[str]) -> Mask:
    if not layers:
        raise SceneError(f"{entry.key}.layer", "needs a drawing, whose blocks have layers", entry.layer)
    sought, known = str(entry.layer).lower(), [layer.lower() for layer in layers]
    if sought not in known:
        one_of(f"{entry.key}.layer", entry.layer, sorted(set(layers)))
    on = np.array([layer == sought for layer in known], dtype=np.bool_)
    return np.append(on, np.zeros(n - len(on), dtype=np.bool_))


def _some(entry: Assignment, chosen: Mask, what: str) -> Mask:
    if not chosen.any():
        raise SceneError(entry.key, f"chooses no {what}; boxes hold centroids of blocks and middles of joints")
    return chosen
