"""Walls with a known answer: exact, published to some digits, or an interval of certified loads."""

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, TypeAlias

from homog import rigid_moduli
from runningbond.compare.published import published_scene
from runningbond.joints import joint_stiffness
from runningbond.limit import limit_nonassociated
from runningbond.scene import Scene, scene_from_dict
from runningbond.studies.walls import TABLES, inset_wall

# λ at collapse, λ of a block turned by `TURNED`, a modulus [Pa], or CPU seconds per physical second
Question: TypeAlias = Literal["collapse", "turned block", "compression", "shear", "physical second"]
Interval: TypeAlias = tuple[float, float]
# λ with inset contacts (Ferris & Tin-Loi 2001), to four digits
PUBLISHED_INSET = {"wall-w1": 0.5856, "wall-w2": 0.5244, "wall-w3": 0.3374}
DIGITS = 5e-5  # half a unit of the last published digit
TURNED = 0.1  # rotation of the turned block [rad]
STIFF = 1e12  # default Young's modulus of blocks, the paper's [Pa]


@dataclass(frozen=True, eq=False)
class StudiedWall:
    """A wall, the question about it, and the known answer."""

    scene: Scene
    question: Question = "collapse"
    known: Literal["exact", "published", "certified", ""] = ""  # how the answer is known; empty if unknown
    answer: Interval | None = None  # interval of the answer; None if it is certified later (`interval`) or unknown

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return self.scene.count_blocks()

    def interval(self) -> Interval | None:
        """Interval of the answer, certified by non-associated limit analysis if it has to be; None if it is unknown."""
        if self.known != "certified":
            return self.answer
        result = limit_nonassociated(self.scene)
        if result.status != "collapse" or result.lower is None or result.upper is None:
            return None
        return result.lower, result.upper


def error(value: float, interval: Interval) -> float:
    """Distance of a value from an interval, relative to the nearer end; zero inside."""
    low, high = interval
    nearer = low if value < low else high
    return 0.0 if low <= value <= high else abs(value - nearer) / abs(nearer)


def _scene(width: float, height: float, friction: float, young: float = STIFF, /, **wall: Any) -> Scene:
    tables = {"wall": {"block_width": width, "block_height": height, "thickness": 0.12, **wall}}
    scene = scene_from_dict(TABLES | tables).with_block(young=young, poisson=0.0)
    return scene.with_joint(friction=friction)


def pile(width: float, height: float, count: int, friction: float) -> StudiedWall:
    """A stack of n blocks b × h, which collapses at λ = min(tan φ, b / (n h))."""
    scene = _scene(width, height, friction, courses=[[1]] * count)
    return StudiedWall(scene, known="exact", answer=(min(friction, width / (count * height)),) * 2)


def turned_block(width: float, height: float) -> StudiedWall:
    """A block that has rotated by θ about its corner, with the capacity λ = tan(α − θ), tan α = b / h."""
    scene = _scene(width, height, 0.9, courses=[[1]])
    return StudiedWall(scene, "turned block", "exact", (math.tan(math.atan2(width, height) - TURNED),) * 2)


def elastic_cell(young: float, question: Question) -> StudiedWall:
    """A periodic cell of running bond.

    In compression across the bed joints, blocks without lateral strain and joints act as springs in series,
    1 / A2222 = 1 / (a k_n) + 1 / E; in shear, rigid blocks have the closed form of `homog`.
    """
    scene = _scene(0.24, 0.06, 0.6, young, length=1.44, height=0.36)
    in_series = 1 / (1 / (0.06 * joint_stiffness(scene.joint).normal) + 1 / young)
    answer = in_series if question == "compression" else rigid_moduli(scene).a1212
    return StudiedWall(scene, question, "exact", (answer, answer))


def square_panel(courses: int) -> Scene:
    """A square panel of blocks twice as wide as high, the texture of panel-06, with an even number of courses."""
    return _scene(0.12, 0.06, 0.6, length=0.06 * courses, height=0.06 * courses)


@cache
def accuracy_walls() -> dict[str, StudiedWall]:
    """Walls with a known answer, by name."""
    inset = {name: (middle - DIGITS, middle + DIGITS) for name, middle in PUBLISHED_INSET.items()}
    return {
        "block-topples": pile(0.23, 0.36, 1, 0.9),
        "block-slides": pile(0.23, 0.36, 1, 0.497),
        "stack-of-5": pile(0.23, 0.1, 5, 0.9),
        **{
            f"{name}-inset": StudiedWall(inset_wall(name), "collapse", "published", known)
            for name, known in inset.items()
        },
        **{
            name: StudiedWall(published_scene(name), known="certified") for name in ("panel-02", "panel-03", "panel-04")
        },
        "turned-block": turned_block(0.1, 0.4),
        **{f"cell-{young:.0e}".replace("+", ""): elastic_cell(young, "compression") for young in (1e10, 1e11, 1e12)},
        "cell-shear": elastic_cell(STIFF, "shear"),
    }


@cache
def growth_walls() -> dict[str, StudiedWall]:
    """Square panels of one texture, each with four times the blocks of the previous one."""
    return {f"square-{courses}": StudiedWall(square_panel(courses)) for courses in (6, 12, 24, 48)}


@cache
def stiffness_walls() -> dict[str, StudiedWall]:
    """One wall with increasingly stiff blocks."""
    stiff = {n: square_panel(12).with_block(young=10.0**n) for n in range(9, 14)}
    return {f"stiff-1e{n}": StudiedWall(scene, "physical second") for n, scene in stiff.items()}


@cache
def all_walls() -> dict[str, StudiedWall]:
    """Every wall of the study, by name."""
    return accuracy_walls() | growth_walls() | stiffness_walls()
