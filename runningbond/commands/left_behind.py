"""Files that commands leave in a folder, of which the next one there replaces all."""

from pathlib import Path

from runningbond.results.store import RECORD

CURVE_FILES, RESPONSE_FILES = ("curve.csv", "curve.png"), ("response.csv", "response.png")
DRAWS = "draws"


def remove_older(folder: Path, *, record: bool = False) -> None:
    """Remove what an older command left beside a time series, which is replaced frame by frame; its outcome as well.

    An outcome that is replaced by another stays until that is written.
    """
    from runningbond.pictures.render import PICTURES

    outcome = (RECORD, *(path.name for path in folder.glob("arrays-*.npz"))) if record else ()
    for name in (f"{DRAWS}.json", *CURVE_FILES, *RESPONSE_FILES, *PICTURES, *outcome):
        (folder / name).unlink(missing_ok=True)
