"""Files that commands write to a result folder; the next command with the same folder replaces all of them."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from runningbond.pictures.time_series import KINDS
from runningbond.results import make_folder
from runningbond.results.store import ARRAY_FILES, RECORD, RESPONSE_RECORD
from runningbond.scene import SceneError
from runningbond.scene.folder_lock import claim

CURVE_FILES, RESPONSE_FILES = ("curve.csv", "curve.png"), ("response.csv", "response.png")
DRAWS = "draws"


@contextmanager
def own_folder(folder: Path | None) -> Iterator[None]:
    """Create and lock a folder for one command; if the scene is refused, newly created folders are removed."""
    if folder is None:
        yield
        return
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    make_folder(folder)
    try:
        claim(folder, "--out")
        yield
    except SceneError:
        for path in made:
            with suppress(OSError):  # another process has used it since
                path.rmdir()
        raise


def holds_results(folder: Path | None) -> bool:
    """Whether a folder holds an outcome or a time series of a command; otherwise all its files belong to the user."""
    return folder is not None and any((folder / name).exists() for name in (RECORD, *(f"{kind}.pvd" for kind in KINDS)))


def remove_older(folder: Path, *, record: bool = False) -> None:
    """Remove the files of an older command, except its time series, which is replaced frame by frame.

    The older outcome is removed only if `record`; otherwise it stays until the new one is written. A ``response.csv``
    without its chart belongs to the user and stays.
    """
    from runningbond.pictures.render import PICTURES

    outcome = (RECORD, *(path.name for path in folder.glob(ARRAY_FILES))) if record else ()
    response = (*RESPONSE_FILES, RESPONSE_RECORD) if all((folder / name).exists() for name in RESPONSE_FILES) else ()
    for name in (f"{DRAWS}.json", *CURVE_FILES, *response, *PICTURES, *outcome):
        (folder / name).unlink(missing_ok=True)
