"""Notes on walls: what is unusual in their data, and how it is taken."""

import numpy as np

from runningbond.scene import SceneError
from runningbond.scene.plausibility import warnings

from .formulas import pressed
from .measured import DRIFTS, NOISE, MeasuredWall
from .modes import GROUPS, NAMED
from .rig import RICHEST, Features, driven_path, load_in_name, scene_of, vertical_load
from .scores import goes_to_both_sides, is_envelope
from .stones import find_stone

LOWER = 0.02
"""Part of a wall's height by which its actuator may be lower because sizes are rounded."""

LONG = 50
"""Length of a path, relative to its largest displacement, above which a note tells that models take long."""

OF_A_SCENE = ("H", "L", "t", "hb", "lb", "Ntot", "σ0,pc", "Stone")
"""Columns that are not read for a wall with a scene of its own."""

SAME_STONE = 0.05
"""Relative difference up to which a number in a wall's row is that of its stone."""

SAME_SIZE = 0.05
"""Relative difference up to which a size or a load of a wall's scene is that of its row."""

SAME_PEAK = 0.05
"""Relative difference up to which the largest forces of a wall's record and of its table are the same."""


def notes_on(wall: MeasuredWall) -> list[str]:
    """What a reader of a wall's scores needs to know of its data, in one line each."""
    kinds = (
        _likely_slips,
        _misspelt,
        _nothing_measured,
        _unknown_modes,
        _missing_cycles,
        _other_side,
        _envelope,
        _long_path,
        _load_of_name,
        _other_stone,
        _other_size,
        _other_unit,
        _low_force,
        _turned,
        _reversed,
        _offset,
        _other_peak,
    )
    return [note for kind in kinds for note in kind(wall)]


def _likely_slips(wall: MeasuredWall) -> list[str]:
    """What `runningbond run` would say of the wall's scene with all of its features."""
    scene = scene_of(wall, RICHEST)
    place = "" if wall.scene_file else "in the scene of its row, "
    return [f"{place}{line}" for line in (*scene.notes, *warnings(scene))]


def _misspelt(wall: MeasuredWall) -> list[str]:
    unread = wall.row.misspelt()
    replaced = () if wall.scene_file is None else OF_A_SCENE
    return [
        f'column "{head}" is not read (did you mean "{column}"?)' for head, column in unread if column not in replaced
    ]


def _nothing_measured(wall: MeasuredWall) -> list[str]:
    what = f"neither Vmax,+ nor a curve {wall.name}.csv: its strength is predicted, but not scored"
    return [] if wall.peaks or len(wall.curve) else [what]


def _unknown_modes(wall: MeasuredWall) -> list[str]:
    words = ", ".join([*GROUPS, *(word.lower() for word in NAMED)])
    unknown = (word for word in wall.modes if word not in GROUPS | NAMED)
    return [f"failure type '{word}' is not understood and does not count; the words are {words}" for word in unknown]


def _missing_cycles(wall: MeasuredWall) -> list[str]:
    """A cyclic test that is predicted by a push to one side, because its record or its scene lacks the other."""
    if not wall.is_cyclic:
        return []
    if wall.scene_file is None:
        what = f"the test was cyclic, but there is no {wall.name}.csv with its cycles; models push the wall to one side"
        if len(wall.curve):
            what = (
                "the table has largest forces to both sides, but the record goes to one; models push the wall to that "
            )
            what += "side, and their strength is compared with the mean of both"
        printed = (
            wall.row.optional("Vmax,+", may_be_zero=True),
            wall.row.optional("Vmax,-", magnitude=True, may_be_zero=True),
        )
        is_complete = goes_to_both_sides(wall.path) or (len(wall.curve) and None in printed)
        return [] if is_complete else [what]
    was_one_sided = len(wall.curve) and not goes_to_both_sides(wall.path)
    if was_one_sided or goes_to_both_sides(driven_path(wall)):
        return []
    what = f"the test was cyclic, but {wall.scene_file.name} pushes the wall to one side"
    return [f"{what}; only the strength of that side is comparable"]


def _other_side(wall: MeasuredWall) -> list[str]:
    """A record of cycles that begins on the other side than the path of the wall's own scene."""
    if wall.scene_file is None or not wall.is_cyclic:
        return []
    path = driven_path(wall)
    if not (goes_to_both_sides(path) and goes_to_both_sides(wall.path)):
        return []
    if next(filter(None, path)) * wall.side > 0:  # a path may begin at zero
        return []
    what = f"the record and {wall.scene_file.name} push the wall first to opposite sides"
    told = "sides are compared by their sign, so that displacements and loops of different half cycles may be compared"
    return [f"{what}; {told}"]


def _envelope(wall: MeasuredWall) -> list[str]:
    """A record of a cyclic test that is the envelope of its cycles."""
    what = "the record is an envelope without cycles; models push the wall once to each side, and no work is compared"
    return [what] if wall.is_cyclic and wall.scene_file is None and is_envelope(wall.curve) else []


def _long_path(wall: MeasuredWall) -> list[str]:
    """A protocol of very many cycles, along which models may take hours."""
    path = np.array((0.0, *driven_path(wall)))
    times = float(np.abs(np.diff(path)).sum() / np.abs(path).max()) if path.any() else 0.0
    what = (
        f"its path is {times:.0f} times as long as its largest displacement; models that follow it take that many times"
    )
    return [f"{what} as long as for one push"] if times > LONG else []


def _load_of_name(wall: MeasuredWall) -> list[str]:
    """A name whose number is the only load: it may as well count walls."""
    named, loads = load_in_name(wall.name), [wall.row.optional(column) for column in ("Ntot", "σ0,pc")]
    if wall.scene_file is not None or not named or loads != [None, None]:
        return []
    return [f"no Ntot or σ0,pc: the {named / 1e3:g} in the name is taken as {named / 1e3:g} kN"]


def _other_stone(wall: MeasuredWall) -> list[str]:
    """Numbers of another stone than that of the campaign with its name, from which models take their own."""
    if wall.scene_file is not None:
        return []
    row = wall.row
    stone = find_stone(row)
    used = {"fc": stone.prism, "fc,b": stone.block, "Eb": stone.young}
    if row.stress("Epc") is not None:
        used["Epc"] = stone.modulus(vertical_load(wall) / (row.number("L") * row.number("t")))
    told = [(column, value, own) for column, own in used.items() if (value := row.stress(column)) is not None]
    unlike = ", ".join(
        f"{column} = {value / 1e6:.5g} MPa (for {own / 1e6:.5g})"
        for column, value, own in told
        if abs(value - own) > SAME_STONE * own
    )
    what = f"not read: {unlike}; models take the numbers of {row.text('stone').casefold()} in brackets"
    return [f"{what}, and a wall of other stone needs a {wall.name}.toml"] if unlike else []


def _other_size(wall: MeasuredWall) -> list[str]:
    """A scene of another length, thickness or load than the wall's row: one of both has a slip."""
    if wall.scene_file is None:
        return []
    scene = scene_of(wall, Features())
    (left, _), (right, _) = scene.blocks.extent(scene.masonry)
    thickness, load = scene.thickness_of_blocks[scene.masonry], pressed(scene)
    length, stress, total = (_entry(wall, column) for column in ("L", "σ0,pc", "Ntot"))
    told = {"L": (length, right - left, right - left, 1e-3, "mm")}
    told["t"] = _entry(wall, "t"), float(thickness.min()), float(thickness.max()), 1e-3, "mm"
    if stress is not None:
        area = (right - left) * float(thickness.mean())
        told["σ0,pc"] = stress, load / area, load / area, 1e6, "MPa"
    weight = -float(scene.mass[scene.masonry].sum() * scene.load.gravity[1])
    told["Ntot"] = total, load, load + weight, 1e3, "kN"
    unlike = ", ".join(
        f"{column} = {value / unit:.4g} {name} (for {(low if value < low else high) / unit:.4g})"
        for column, (value, low, high, unit, name) in told.items()
        if value is not None and not (1 - SAME_SIZE) * low <= value <= (1 + SAME_SIZE) * high
    )
    what = f"not read: {unlike}; models take the numbers of {wall.scene_file.name} in brackets"
    return [what] if unlike else []


def _other_unit(wall: MeasuredWall) -> list[str]:
    """Displacements that cannot be in mm, of a wall whose row does not have the height that they are compared with."""
    if wall.scene_file is None or not len(wall.curve) or wall.row.optional("H0") is not None:
        return []
    scene = scene_of(wall, Features())
    (_, bottom), (_, top) = scene.blocks.extent(scene.masonry)
    far = max(wall.reach)
    what = (
        f"the largest displacement of the record is {1e3 * far:.3g} mm, {far / (top - bottom):.2g} of the wall's height"
    )
    return [] if DRIFTS[0] < far / (top - bottom) < DRIFTS[1] else [f"{what}; it must be in mm"]


def _entry(wall: MeasuredWall, column: str) -> float | None:
    """A number of a wall's row that no model reads, in SI units; None if the entry is no such number."""
    try:
        return wall.row.optional(column)
    except SceneError:
        return None


def _low_force(wall: MeasuredWall) -> list[str]:
    """An actuator below the top of the wall: in tables of walls bent in double curvature it is where no moment acts."""
    at, top = wall.row.optional("H0"), wall.row.optional("H")
    if wall.scene_file is not None or at is None or top is None or at >= (1 - LOWER) * top:
        return []
    told = f"H0 = {1e3 * at:.4g} mm is below the top of the wall, {1e3 * top:.4g} mm"
    return [f"{told}; models push a free beam at that height, where the wall's moment vanishes"]


def _turned(wall: MeasuredWall) -> list[str]:
    what = "the record goes to the negative side; its curve is drawn and scored with reversed signs"
    return [what] if wall.is_turned else []


def _reversed(wall: MeasuredWall) -> list[str]:
    what = "the record starts at its largest displacement and ends at rest; it is read from its last row to its first"
    return [what] if wall.is_reversed else []


def _offset(wall: MeasuredWall) -> list[str]:
    """A record that starts with a displacement but no force to its side, or the other way round."""
    known = wall.curve[~np.isnan(wall.curve[:, 0])]
    if not len(known):
        return []
    (x, y), (far, peak) = known[0], np.abs(known).max(axis=0)
    is_offset = abs(x) > NOISE * far and y * np.sign(x) <= 0
    is_offset |= abs(y) > NOISE * peak and x * np.sign(y) <= 0
    start = f"{1e3 * x:.3g} mm under {y / 1e3:.3g} kN"
    return [f"the record starts at {start}, and is read as it is; both must count from rest"] if is_offset else []


def _other_peak(wall: MeasuredWall) -> list[str]:
    """A record whose largest force is not that of the table: each is compared with a part of a prediction."""
    if not len(wall.curve) or not wall.peaks:
        return []
    largest, told = float(np.nanmax(np.abs(wall.curve[:, 1]))), max(wall.peaks)
    what = f"the record's largest force is {largest / 1e3:.4g} kN, and the table's {told / 1e3:.4g} kN"
    uses = "strength is compared with the table, stiffness and displacements with the record"
    return [f"{what}; {uses}"] if abs(largest - told) > SAME_PEAK * told else []
