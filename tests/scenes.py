"""Hypothesis strategies for random scenes, as tables of a scene file: valid walls and invalid tables."""

import copy
from pathlib import Path
from typing import Any

import ezdxf
from hypothesis import strategies as st

from .walls import content

widths = st.sampled_from([0.5, 1, 1.5, -0.5, -1])
patterns = st.lists(st.lists(widths, min_size=1, max_size=5), min_size=1, max_size=5)
odd = st.sampled_from([0, -1, float("nan"), float("inf"), 1e300, 5e-324, "", "x", True, [], {}, [[]], 10**30, "\x00"])
kinds = st.sampled_from(["base", "base", "fixed-first-course", "corners", "pinned-corners"])


@st.composite
def walls(draw: st.DrawFn) -> dict[str, Any]:
    """A wall in running bond of any kind, loaded laterally or at a point on its top."""
    half, courses = draw(st.integers(2, 8)), draw(st.integers(2, 5))
    friction = draw(st.one_of(st.just(0.0), st.floats(0.01, 3)))
    cohesion = draw(st.sampled_from([0.0, 0.0, 1e2, 1e4]))
    joint: dict[str, Any] = {"friction": friction, "cohesion": cohesion, "inset": draw(st.sampled_from([0.0, 0.01]))}
    if friction == 0.0 or draw(st.booleans()):
        joint["tensile_strength"] = draw(st.floats(0, 1)) * (cohesion / friction if friction else cohesion)
    lateral = draw(st.booleans())
    live: dict[str, Any] = {"kind": "lateral"}
    if not lateral:
        at = [0.12 * draw(st.integers(0, 2 * half)) / 2, 0.06 * courses]
        live = {"kind": "point", "at": at, "force": [draw(st.floats(-1, 1)), -draw(st.floats(0.01, 1))]}
    return content(
        joint=joint,
        wall__length=0.12 * half,
        wall__height=0.06 * courses,
        wall__first_course=draw(st.sampled_from(["full", "half"])),
        wall__ends=draw(st.sampled_from(["flush", "flush", "toothed"])) if half % 2 == 0 and half > 2 else "flush",
        support__kind=draw(kinds),
        block__density=draw(st.floats(1, 1e5)),
        load={"gravity": 9.81 if lateral else draw(st.sampled_from([9.81, 0.0])), "live": live},
    )


def _spoil(draw: st.DrawFn, scene: dict[str, Any]) -> None:
    """Set a key or two to nonsense."""
    for _ in range(draw(st.integers(0, 2))):
        table = draw(st.sampled_from(["wall", "block", "joint", "support", "load"]))
        if scene[table]:
            scene[table][draw(st.sampled_from([*scene[table], "unheard_of", "drawing"]))] = draw(odd)


@st.composite
def spoilt(draw: st.DrawFn) -> dict[str, Any]:
    """A wall with a key or two set to nonsense, or an arbitrary pattern of courses."""
    scene = draw(walls())
    if draw(st.booleans()):
        scene["wall"] |= {"courses": draw(patterns)}
        for key in ("length", "height", "first_course", "ends"):
            scene["wall"].pop(key, None)
    _spoil(draw, scene)
    return scene


@st.composite
def small_walls(draw: st.DrawFn) -> dict[str, Any]:
    """Walls of a few blocks for every model, of any size, shape and material; most are valid, some are not."""
    size = draw(st.sampled_from([1.0, 1.0, 1.0, 1e-6, 1e-3, 1e3]))
    width, height = draw(
        st.sampled_from([(0.24, 0.06), (0.24, 0.12), (0.12, 0.12), (0.06, 0.24), (0.01, 0.5), (1, 0.02)])
    )
    width, height = size * width, size * height
    wall: dict[str, Any] = {"block_width": width, "block_height": height, "thickness": 0.12 * size}
    if draw(st.integers(0, 3)):
        half, courses = draw(st.integers(1, 5)), draw(st.integers(1, 3))
        wall |= {"length": width / 2 * half, "height": height * courses, "first_course": draw(_starts)}
        span = wall["length"]
    else:
        wall["courses"] = draw(_small_patterns)
        courses, span = len(wall["courses"]), width * sum(map(abs, wall["courses"][-1]))
    gravity = draw(st.sampled_from([9.81, 9.81, 9.81, 1e-3, 0.0]))
    live: dict[str, Any] = {"kind": "lateral"}
    if gravity == 0.0 or draw(st.integers(0, 2)) == 0:
        at = [span * draw(st.sampled_from([0.0, 0.25, 0.5, 1.0])), height * draw(st.sampled_from([courses, 0.5]))]
        live = {"kind": "point", "at": at, "force": draw(_forces)}
    scene = content(
        wall=wall,
        block={"density": draw(_powers(0, 5)), "young": draw(_powers(7, 13)), "poisson": draw(_poisson)},
        joint=draw(joints(min(width, height))),
        support__kind=draw(kinds if courses > 1 else st.sampled_from(["base", "base", "base", "corners"])),
        load={"gravity": gravity, "live": live},
    )
    if draw(st.integers(0, 9)) == 0:
        scene["inner_joint"] = draw(joints(min(width, height)))
    if draw(st.integers(0, 9)) == 0:
        _spoil(draw, scene)
    return scene


def _powers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda exponent: float(10**exponent))


_starts = st.sampled_from(["full", "half"])
_poisson = st.sampled_from([0.0, 0.2, -0.5, 0.5])
_small_patterns = st.lists(
    st.lists(st.sampled_from([1, 1, 0.5, 1.5, 0.01, 0.3, 3, -0.5, -1]), min_size=1, max_size=3),
    min_size=1,
    max_size=3,
)
_forces = st.one_of(
    st.sampled_from([[0.0, -1.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [1e-9, -1.0]]),
    st.tuples(st.floats(-10, 10), st.floats(-10, 10)).map(list),
)


@st.composite
def joints(draw: st.DrawFn, side: float) -> dict[str, Any]:
    """A joint with stiffness: frictionless to very rough, dry to glued, perfectly plastic or brittle."""
    friction = draw(st.one_of(st.floats(0.01, 3), st.sampled_from([0.0, 0.6, 0.6, 1e-9, 1e-6, 1e-3, 10.0, 1e6])))
    cohesion = draw(st.one_of(st.sampled_from([0.0, 0.0, 0.0]), _powers(-6, 7)))
    joint: dict[str, Any] = {"friction": friction, "cohesion": cohesion}
    if friction == 0.0 or draw(st.booleans()):
        apex = min(cohesion / friction, 1e99) if friction else cohesion
        joint["tensile_strength"] = draw(st.sampled_from([0.0, 0.5, 1.0])) * apex
    if draw(st.booleans()):
        joint["mortar"] = {"young": draw(_powers(6, 12)), "poisson": 0.2, "thickness": 0.01}
    else:
        joint["normal_stiffness"] = draw(_powers(8, 13))
        joint["shear_stiffness"] = joint["normal_stiffness"] * draw(st.sampled_from([0.4, 1.0, 1e-3]))
    if draw(st.integers(0, 2)) == 0:
        energies = st.sampled_from([0.0, 1e-12, 1e-3, 1.0, 1e6])
        joint |= {"fracture_energy_1": draw(energies), "fracture_energy_2": draw(energies)}
    joint["inset"] = draw(st.sampled_from([0.0, 0.0, 0.01, 0.2])) * side
    return joint


@st.composite
def outlines(draw: st.DrawFn) -> list[list[tuple[float, float]]]:
    """A pier of two or three convex blocks on the ground, with joints that slope, gape or overlap a little [mm]."""
    width, rise = draw(st.sampled_from([200.0, 1000.0])), draw(st.floats(20.0, 300.0))
    slopes = [0.0, *draw(st.lists(st.floats(-0.4, 0.4), min_size=2, max_size=3))]
    gaps = draw(st.lists(st.sampled_from([0.0, 0.0, 0.0, 1e-3, 0.01, 0.02, -0.01, -1.0, 1.0]), min_size=3, max_size=3))
    found = [[(-width, -100.0), (2 * width, -100.0), (2 * width, 0.0), (-width, 0.0)]]
    base = 0.0
    for below, above, gap in zip(slopes, slopes[1:], gaps, strict=False):
        low, high = base + gap, base + gap + rise + 0.4 * width
        found.append([(0.0, low), (width, low + below * width), (width, high + above * width), (0.0, high)])
        base = high
    return found


def write_drawing(found: list[list[tuple[float, float]]], path: Path) -> Path:
    """Write closed polylines as a DXF file."""
    document = ezdxf.new()  # type: ignore[attr-defined]
    for outline in found:
        document.modelspace().add_lwpolyline(outline, close=True)
    document.saveas(path)
    return path


def drawn(scene: dict[str, Any]) -> dict[str, Any]:
    """A scene whose wall is the drawing ``wall.dxf``, in millimetres, instead of its blocks."""
    changed = copy.deepcopy(scene)
    changed["wall"] = {"drawing": "wall.dxf", "units": "mm", "thickness": 0.12}
    changed["support"] = {"kind": "base"}
    changed["load"] = {"gravity": 9.81, "live": {"kind": "lateral"}}
    return changed
