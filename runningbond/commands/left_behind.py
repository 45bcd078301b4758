"""Files that commands leave in a folder, of which the next one there replaces all."""

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
    """Have a folder for this command alone, made where it is missing; what is made for a refused scene goes again."""
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
            with suppress(OSError):  # somebody else has used it since
                path.rmdir()
        raise


def holds_results(folder: Path | None) -> bool:
    """Whether a command has left an outcome or a time series in a folder: else all files there are somebody's own."""
    return folder is not None and any((folder / name).exists() for name in (RECORD, *(f"{kind}.pvd" for kind in KINDS)))


def remove_older(folder: Path, *, record: bool = False) -> None:
    """Remove what an older command left beside a time series, which is replaced frame by frame; its outcome as well.

    An outcome that is replaced by another stays until that is written, and a ``response.csv`` without its chart is
    somebody's own.
    """
    from runningbond.pictures.render import PICTURES

    outcome = (RECORD, *(path.name for path in folder.glob(ARRAY_FILES))) if record else ()
    response = (*RESPONSE_FILES, RESPONSE_RECORD) if all((folder / name).exists() for name in RESPONSE_FILES) else ()
    for name in (f"{DRAWS}.json", *CURVE_FILES, *response, *PICTURES, *outcome):
        (folder / name).unlink(missing_ok=True)
