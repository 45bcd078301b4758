"""``runningbond new``: a scene to start from."""

import shlex
from importlib.resources import files
from pathlib import Path

from runningbond.results import write_atomically
from runningbond.scene import SceneError

from .terminal import DONE

NEXT = ("show {0} -o {1}", "run {0} --model limit", "advise {0} --tolerance 0.05")


def new(file: Path, /) -> int:
    """Write a scene file with comments, to start from.

    Parameters
    ----------
    file
        File to write; an existing file is never overwritten.
    """
    if file.suffix.lower() != ".toml":
        raise SceneError("FILE", "must end in .toml", str(file))
    if file.exists():
        raise SceneError(str(file), "is there already; name a new file")
    write_atomically(file, files(__package__).joinpath("scene.toml").read_bytes())
    print(f"{file}\nwhat to do next:")
    for line in NEXT:
        print("  runningbond", line.format(*(shlex.quote(str(name)) for name in (file, file.with_suffix(".svg")))))
    return DONE
