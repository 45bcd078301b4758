"""Published walls that ship with the package, and the values printed for them."""

from dataclasses import dataclass, field
from pathlib import Path

from runningbond.scene import Scene, SceneError, read_scene
from runningbond.scene.ranges import nearest

FOLDER = Path(__file__).parent / "published"

BARALDI = "Baraldi, Reccia & Cecchi, Table 2: self-weight and lateral load"
CONCENTRATED = "Baraldi, Reccia & Cecchi, Sec. 6.2: concentrated load [N]"
FERRIS = "Ferris & Tin-Loi (2001): dry walls under lateral load"


@dataclass(frozen=True)
class PublishedCase:
    """A published wall."""

    name: str  # name of its scene file without the suffix
    source: str  # publication; cases of one source share a table
    printed: dict[str, float] = field(default_factory=dict)  # published values by their column heads in the tables

    @property
    def path(self) -> Path:
        """The scene file."""
        return FOLDER / f"{self.name}.toml"


TABLE_2 = {  # multipliers of the twelve panels, as the paper prints them
    "FEM/DEM": (0.500, 0.410, 0.310, 0.310, 0.380, 0.320, 0.225, 0.140, 0.240, 0.220, 0.175, 0.130),
    "DEM": (0.570, 0.390, 0.260, 0.160, 0.390, 0.310, 0.230, 0.110, 0.330, 0.310, 0.200, 0.094),
    "HOMO": (0.537, 0.380, 0.269, 0.134, 0.537, 0.380, 0.269, 0.134, 0.372, 0.328, 0.267, 0.134),
}
PUBLISHED: tuple[PublishedCase, ...] = (  # sixteen panels of Baraldi, Reccia & Cecchi, three walls of Ferris & Tin-Loi
    *(PublishedCase(f"panel-{k + 1:02d}", BARALDI, {x: TABLE_2[x][k] for x in TABLE_2}) for k in range(12)),
    *(PublishedCase(f"point-load-{texture}", CONCENTRATED) for texture in ("4", "2", "1", "quarter")),
    PublishedCase("wall-w1", FERRIS, {"associated": 0.643, "non-associated": 0.640}),
    PublishedCase("wall-w2", FERRIS, {"associated": 0.580, "non-associated": 0.563}),
    PublishedCase("wall-w3", FERRIS, {"associated": 0.404, "non-associated": 0.356}),
)

FURTHER = tuple(PublishedCase(f"wall-w{k}", FERRIS) for k in (4, 5, 6))
"""Walls with more openings; `runningbond compare` runs them only if they are requested by name."""


def cases_of(source: str) -> tuple[PublishedCase, ...]:
    """Cases of one source, in the order of publication."""
    return tuple(case for case in PUBLISHED if case.source == source)


def published_scene(name: str) -> Scene:
    """Read a published scene by its name, for example ``panel-01``."""
    return read_scene(find_scene(name))


def published_case(path: Path) -> PublishedCase | None:
    """The published case with this scene file; None for a file of the same name elsewhere, which is a user's wall."""
    return next((case for case in (*PUBLISHED, *FURTHER) if case.path.resolve() == path.resolve()), None)


def find_scene(scene: str) -> Path:
    """Path of a scene given as a file or, if no such file exists, as the name of a published case."""
    path = Path(scene)
    if path.is_file():
        return path
    cases = {case.name: case for case in (*PUBLISHED, *FURTHER)}
    if scene in cases:
        return cases[scene].path
    if path.exists():
        raise SceneError(str(path), f"cannot be read: it is {'a folder' if path.is_dir() else 'no regular file'}")
    names, ending = list(cases), ".toml"
    what = f"there is no such file, nor a published scene of that name ({names[0]} … {names[-1]})"
    beside = {other.stem: str(other) for other in sorted(path.parent.glob(f"*{ending}")) if str(other).isprintable()}
    likely = nearest(path.name.removesuffix(ending), [*names, *beside])
    hint = f'; did you mean "{beside.get(likely, likely)}"?' if likely else ""
    raise SceneError(scene, what + hint)
