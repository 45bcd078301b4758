"""Published walls that ship with the package, and the values printed for them."""

from dataclasses import dataclass, field
from pathlib import Path

from runningbond.scene import Scene, SceneError, read_scene

FOLDER = Path(__file__).parent / "published"

BARALDI = "Baraldi, Reccia & Cecchi, Table 2: self-weight and lateral load"
CONCENTRATED = "Baraldi, Reccia & Cecchi, Sec. 6.2: concentrated load [N]"
FERRIS = "Ferris & Tin-Loi (2001): dry walls under lateral load"


@dataclass(frozen=True)
class PublishedCase:
    """A published wall."""

    name: str  # that of its scene file without the ending
    source: str  # where it was published; cases of one source share a table
    printed: dict[str, float] = field(default_factory=dict)  # values printed for it, by what the table calls them

    @property
    def path(self) -> Path:
        """The scene file."""
        return FOLDER / f"{self.name}.toml"


def _panel(row: int, fem_dem: float, dem: float, homo: float) -> PublishedCase:
    printed = {"FEM/DEM": fem_dem, "DEM": dem, "HOMO": homo}
    return PublishedCase(f"panel-{row:02d}", BARALDI, printed)


def _wall(name: str, associated: float, nonassociated: float) -> PublishedCase:
    return PublishedCase(name, FERRIS, {"associated": associated, "non-associated": nonassociated})


PUBLISHED: tuple[PublishedCase, ...] = (
    _panel(1, 0.500, 0.570, 0.537),
    _panel(2, 0.410, 0.390, 0.380),
    _panel(3, 0.310, 0.260, 0.269),
    _panel(4, 0.310, 0.160, 0.134),
    _panel(5, 0.380, 0.390, 0.537),
    _panel(6, 0.320, 0.310, 0.380),
    _panel(7, 0.225, 0.230, 0.269),
    _panel(8, 0.140, 0.110, 0.134),
    _panel(9, 0.240, 0.330, 0.372),
    _panel(10, 0.220, 0.310, 0.328),
    _panel(11, 0.175, 0.200, 0.267),
    _panel(12, 0.130, 0.094, 0.134),
    PublishedCase("point-load-4", CONCENTRATED),
    PublishedCase("point-load-2", CONCENTRATED),
    PublishedCase("point-load-1", CONCENTRATED),
    PublishedCase("point-load-quarter", CONCENTRATED),
    _wall("wall-w1", 0.643, 0.640),
    _wall("wall-w2", 0.580, 0.563),
    _wall("wall-w3", 0.404, 0.356),
)
"""The sixteen panels of Baraldi, Reccia & Cecchi and three walls of Ferris & Tin-Loi."""


def cases_of(source: str) -> tuple[PublishedCase, ...]:
    """Cases of one source, in the order in which they were published."""
    return tuple(case for case in PUBLISHED if case.source == source)


def published_scene(name: str) -> Scene:
    """Read a published scene by its name, for example ``panel-01``."""
    return read_scene(find_scene(name))


def published_case(path: Path) -> PublishedCase | None:
    """The published case whose own file this is; a file of the same name elsewhere is somebody's own wall."""
    return next((case for case in PUBLISHED if case.path.resolve() == path.resolve()), None)


def find_scene(scene: str) -> Path:
    """Path of a scene: a file, or the name of a published case where there is no such file."""
    path = Path(scene)
    if path.is_file():
        return path
    for case in PUBLISHED:
        if scene == case.name:
            return case.path
    names = f"{PUBLISHED[0].name} … {PUBLISHED[-1].name}"
    if path.exists():
        raise SceneError(scene, f"cannot be read: it is {'a folder' if path.is_dir() else 'no regular file'}")
    raise SceneError(scene, f"there is no such file, nor a published scene of that name ({names})")
