"""The machine fails: every command is broken off, killed, given a disk that takes no more, doubled and damaged.

Whatever happens, finished work is there whole, unfinished work is done again by the same command, and a command that
can say something says it in one line. Commands that write are tried; this one cannot be tried from within itself.
"""

import hashlib
import io
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from dataclasses import asdict, dataclass
from functools import cached_property, partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from results import StoreError, load_outcome
from results.rendering import why_not_drawn

from ..command import command
from ..commands.exits import BAD_INPUT, DONE, STOPPED
from ..published import find_scene
from .finding import Edge, Finding

WHOLE, REDONE, REFUSED, LOST, NOT_TRIED = "whole", "redone", "refused", "lost", "not tried"
VERDICTS = {
    WHOLE: ("does its work all the same", "#2a9d8f"),
    REDONE: ("what it had finished is whole; called again, it does the rest", "#8ecae6"),
    REFUSED: ("says in one line why not; nothing is half written", "#e9a23b"),
    LOST: ("none of these", "#1f1f1f"),
    NOT_TRIED: (
        "needs a disk of its own here, and may mount none",
        "#e5e5e5",
    ),
}
"""What may come of a mishap, and its colour in the chart."""

MISHAPS = ("Ctrl-C", "SIGKILL", "full disk", "read-only folder", "two at once", "damaged result")

ROOM = 16 << 10
"""Bytes that a full disk still takes, so that it is full in the middle [B]."""

DISK = 8 << 20
"""Size of the disk [B]."""

PROGRESS = re.compile(r"\d+/\d+ \d+:\d\d:\d\d\s*$")

PATIENCE = 120.0
"""Time in which a command must have begun to write, or end [s]."""

WALL = "wall-w1"
TITLE = "Ferris & Tin-Loi W1"
MODELS = ("homog", "limit", "limit-nonassociated", "dem-static")


@dataclass(frozen=True)
class Work:
    """A command as a user calls it.

    Parameters
    ----------
    name
        Its name.
    arguments
        Its arguments, for a folder to work in.
    begun
        Whether in that folder something has been written and more is to come.
    found
        What whole work is in the folder, named piece by piece, with what tells one piece from another.
    damage
        Damages what is in the folder.
    """

    name: str
    arguments: Callable[[Path], list[str]]
    begun: Callable[[Path], bool]
    found: Callable[[Path], dict[str, object]]
    damage: Callable[[Path], None]


@dataclass(frozen=True)
class Trial:
    """What a mishap did to a command.

    Parameters
    ----------
    command, mishap
        Which.
    kept
        Pieces of work that were whole afterwards, of those that an undisturbed command leaves.
    pieces
        Number of the latter.
    message
        What the command said.
    code
        What it left with; minus the signal that killed it.
    verdict
        One of `VERDICTS`.
    """

    command: str
    mishap: str
    kept: int
    pieces: int
    message: str
    code: int
    verdict: str


def _outcomes(folder: Path) -> dict[str, object]:
    """Outcomes of a folder that can be trusted and were not broken off, without the time they took."""
    found: dict[str, object] = {}
    for record in folder.rglob("outcome.json"):
        try:
            outcome, key = load_outcome(record.parent)
        except StoreError:
            continue
        if key:
            found[str(record.parent.relative_to(folder))] = outcome.summary() | {"seconds": None}
    return found


def _mesh_file(folder: Path) -> dict[str, object]:
    path = folder / "wall.msh"
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()} if path.exists() else {}


def _pictures(folder: Path) -> dict[str, object]:
    """Pictures that end as their format does."""
    ends = {".png": b"IEND\xaeB`\x82", ".gif": b";"}
    return {
        path.name: "whole"
        for path in folder.iterdir()
        if path.suffix in ends and path.read_bytes().endswith(ends[path.suffix])
    }


def _halve(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _damage_outcomes(folder: Path) -> None:
    """Cut the arrays of one outcome off, and the record of the others."""
    records = sorted(folder.rglob("outcome.json"))
    _halve(next(records[0].parent.glob("*.npz")))
    for record in records[1:]:
        _halve(record)


RUN = Work(
    "run",
    lambda folder: ["run", WALL, "--model", "dem-dynamic", "--tolerance", "0.1", "--out", str(folder)],
    lambda folder: (folder / "blocks.pvd").exists(),
    _outcomes,
    _damage_outcomes,
)
COMPARE = Work(
    "compare",
    lambda folder: [
        *("compare", str(folder / "wall.toml"), "--models", ",".join(MODELS)),
        *("--jobs", "1", "--out", str(folder)),
    ],
    lambda folder: any(folder.glob("*/*/outcome.json")),
    _outcomes,
    _damage_outcomes,
)
MESH = Work(
    "mesh",
    lambda folder: ["mesh", "panel-06", "--cells", "4", "--out", str(folder / "wall.msh")],
    lambda folder: any(path.stat().st_size for path in folder.glob(".wall.*.msh")),
    _mesh_file,
    lambda folder: _halve(folder / "wall.msh"),
)
RENDER = Work(
    "render",
    lambda folder: ["render", str(folder)],
    lambda folder: (folder / "mechanism.png").exists(),
    _pictures,
    lambda folder: _halve(folder / "blocks.pvd"),
)
WORKS = (RUN, COMPARE, MESH, RENDER)


@dataclass(frozen=True)
class Scratch:
    """A command in a folder of this experiment.

    Parameters
    ----------
    work
        The command.
    home
        Where its folders are: one with what it needs, one in which it has been called undisturbed.
    """

    work: Work
    home: Path

    @property
    def prepared(self) -> Path:
        """The folder with what it needs."""
        return self.home / f"{self.work.name}-prepared"

    @property
    def done(self) -> Path:
        """The folder in which it has been called undisturbed."""
        return self.home / f"{self.work.name}-done"

    @cached_property
    def expected(self) -> dict[str, object]:
        """What it leaves undisturbed."""
        return self.work.found(self.done)

    def prepare(self, needed: Path | None = None) -> None:
        """Call it undisturbed, in a folder with what it needs."""
        self.prepared.mkdir()
        if needed is not None:
            shutil.copytree(needed, self.prepared, dirs_exist_ok=True)
            for picture in _pictures(self.prepared):
                (self.prepared / picture).unlink()
        call(self.work.arguments(self.fresh(self.done)))

    def fresh(self, folder: Path) -> Path:
        """Make a folder in which the command can be called."""
        return Path(shutil.copytree(self.prepared, folder))

    def trial(self, mishap: str, folder: Path, code: int, message: str, verdict: str) -> Trial:
        """Judge what is in a folder after a mishap; it is lost if it is not what an undisturbed command leaves."""
        found = self.work.found(folder)
        whole = found.items() <= self.expected.items()
        message = message.replace(str(folder), "OUT")
        said = len(message.splitlines()) <= 1 and "Traceback" not in message
        return Trial(
            self.work.name, mishap, len(found), len(self.expected), message, code, verdict if whole and said else LOST
        )

    def does_it_again(self, folder: Path) -> bool:
        """Call the command once more, and see whether everything is there."""
        code, _ = call(self.work.arguments(folder))
        return code == DONE and self.work.found(folder) == self.expected


def call(arguments: Sequence[str]) -> tuple[int, str]:
    """Call a command in this process.

    Returns
    -------
    code, message
        What it leaves with, and what it says last on standard error.
    """
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    said = io.StringIO()
    try:
        with redirect_stdout(io.StringIO()), redirect_stderr(said):
            code = command(arguments)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return code, _message(said.getvalue())


def _message(said: str, printed: str = "") -> str:
    """What a command says on standard error; where that is nothing, the last line but one that it prints.

    Bars of progress are left out, and that there are no pictures from this machine.
    """
    lines = [line for line in said.splitlines() if line.strip() and not PROGRESS.search(line)]
    lines = [line for line in lines if "no pictures" not in line]
    return "\n".join(lines or [line.strip() for line in printed.splitlines()[-2:-1]])


@contextmanager
def started(work: Work, folder: Path) -> Iterator["subprocess.Popen[str]"]:
    """Start a command in processes of its own, and wait until it is in the middle of its work."""
    line = [sys.executable, "-m", "runningbond", *work.arguments(folder)]
    process = subprocess.Popen(line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    try:
        deadline = time.monotonic() + PATIENCE
        while not work.begun(folder) and process.poll() is None and time.monotonic() < deadline:
            time.sleep(0.005)
        yield process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)


def interrupt(scratch: Scratch, folder: Path, how: signal.Signals, mishap: str) -> Trial:
    """Send a signal to a command in the middle, and call it again."""
    with started(scratch.work, scratch.fresh(folder)) as process:
        os.killpg(process.pid, how)
        printed, said = process.communicate(timeout=PATIENCE)
    code = process.returncode
    right = code == (STOPPED if how == signal.SIGINT else -how)
    trial = scratch.trial(mishap, folder, code, _message(said, printed), REDONE)
    return _judged(trial, right and scratch.does_it_again(folder))


def at_once(scratch: Scratch, folder: Path) -> Trial:
    """Call a command in the folder where another one is in the middle."""
    with started(scratch.work, scratch.fresh(folder)) as process:
        code, message = call(scratch.work.arguments(folder))
        _, said = process.communicate(timeout=PATIENCE)
    code, message = max((code, message), (process.returncode, _message(said)))
    trial = scratch.trial("two at once", folder, code, message, WHOLE)
    return _judged(trial, code == DONE and scratch.work.found(folder) == scratch.expected)


def damage(scratch: Scratch, folder: Path) -> Trial:
    """Damage what a command has left or needs, and call it again."""
    scratch.fresh(folder)
    call(scratch.work.arguments(folder))
    scratch.work.damage(folder)
    code, message = call(scratch.work.arguments(folder))
    if scratch.work is RENDER:  # it makes pictures of what others have computed
        return _judged(scratch.trial("damaged result", folder, code, message, REFUSED), code == BAD_INPUT)
    trial = scratch.trial("damaged result", folder, code, message, REDONE)
    return _judged(trial, code == DONE and scratch.work.found(folder) == scratch.expected)


def fill(scratch: Scratch, folder: Path, disk: "Disk") -> Trial:
    """Call a command on a disk that is full before it is done, then on one that has room again."""
    scratch.fresh(folder)
    disk.fill()
    code, message = call(scratch.work.arguments(folder))
    trial = scratch.trial("full disk", folder, code, message, REDONE)
    disk.mend()
    return _judged(trial, code == BAD_INPUT and scratch.does_it_again(folder))


def lock(scratch: Scratch, folder: Path, disk: "Disk") -> Trial:
    """Call a command in a folder that takes nothing, then in the same folder when it does."""
    scratch.fresh(folder)
    before = sorted(folder.rglob("*"))
    disk.lock()
    code, message = call(scratch.work.arguments(folder))
    nothing = sorted(folder.rglob("*")) == before
    trial = scratch.trial("read-only folder", folder, code, message, REFUSED)
    disk.mend()
    return _judged(trial, nothing and code == BAD_INPUT and scratch.does_it_again(folder))


def _judged(trial: Trial, right: bool) -> Trial:
    return trial if right else Trial(**{**asdict(trial), "verdict": LOST})


class Disk:
    """A folder as a small disk of its own; without one, as near to that as limits and permissions come.

    Parameters
    ----------
    folder
        The folder.
    mounts
        Whether this process may mount what nobody else sees.
    """

    def __init__(self, folder: Path, mounts: bool) -> None:
        self.folder = folder
        mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK}", "tmpfs", str(folder)]
        self.mounted = mounts and subprocess.run(mount, capture_output=True, check=False).returncode == 0
        self._unlimited = resource.getrlimit(resource.RLIMIT_FSIZE)

    def fill(self) -> None:
        """Leave `ROOM` bytes; where nothing is mounted, let no file grow larger than a fourth of them."""
        if not self.mounted:
            resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM // 4, self._unlimited[1]))
            return
        free = shutil.disk_usage(self.folder).free
        (self.folder / "ballast").write_bytes(bytes(free - ROOM))

    def lock(self) -> None:
        """Take nothing any more; where nothing is mounted, of those who are not the superuser."""
        if self.mounted:
            self._remount("ro")
        else:
            for path in (self.folder, *self.folder.rglob("*/")):
                path.chmod(0o500)

    def mend(self) -> None:
        """Take files again."""
        resource.setrlimit(resource.RLIMIT_FSIZE, self._unlimited)
        if self.mounted:
            self._remount("rw")
        for path in (self.folder, *self.folder.rglob("*/")):
            path.chmod(0o700)
        (self.folder / "ballast").unlink(missing_ok=True)

    def _remount(self, how: str) -> None:
        subprocess.run(["mount", "-o", f"remount,{how}", str(self.folder)], check=True)


def disk_trials(home: Path, names: Sequence[str], mounts: bool) -> list[Trial]:
    """Give commands that have been prepared full and read-only disks."""
    trials: list[Trial] = []
    for scratch in (Scratch(work, home) for work in WORKS if work.name in names):
        for mishap, happen in (("full disk", fill), ("read-only folder", lock)):
            place = home / f"{scratch.work.name}-{happen.__name__}"
            place.mkdir()
            disk = Disk(place, mounts)
            if happen is lock and not disk.mounted and os.geteuid() == 0:
                trials.append(Trial(scratch.work.name, mishap, 0, len(scratch.expected), "", DONE, NOT_TRIED))
            else:
                trials.append(happen(scratch, place / "folder", disk))
    return trials


def disk_trials_apart(home: Path, names: Sequence[str]) -> list[Trial]:
    """`disk_trials` in a process of its own, which may mount things if the system knows a way."""
    apart: Sequence[str] = ()
    for way in (["unshare", "--mount"], ["unshare", "--user", "--map-root-user", "--mount"]):
        if shutil.which(way[0]) and subprocess.run([*way, "true"], capture_output=True, check=False).returncode == 0:
            apart = way
            break
    program = f"""
import json
from dataclasses import asdict
from pathlib import Path
from compare.stability.machine import disk_trials
print(json.dumps([asdict(trial) for trial in disk_trials(Path({str(home)!r}), {list(names)!r}, {bool(apart)})]))
"""
    done = subprocess.run([*apart, sys.executable, "-c", program], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"trials on disks: {done.stderr}")
    return [Trial(**trial) for trial in json.loads(done.stdout.splitlines()[-1])]


def what_commands_need(home: Path) -> dict[str, Path]:
    """Folders with what some commands need: a scene, and the result of a run."""
    needed = {"compare": home / "scene", "render": home / "result"}
    needed["compare"].mkdir()
    # Under a title of its own, or the charts of the published walls would be drawn each time.
    (needed["compare"] / "wall.toml").write_text(find_scene(WALL).read_text().replace(TITLE, "wall"))
    call(["run", WALL, "--model", "limit", "--out", str(needed["render"])])
    return needed


def trials(works: Sequence[Work] = WORKS) -> list[Trial]:
    """Let every mishap happen to every command, in the order of commands and then of `MISHAPS`."""
    with TemporaryDirectory() as name:
        home = Path(name)
        needed = what_commands_need(home)
        found: list[Trial] = []
        for work in works:
            scratch = Scratch(work, home)
            scratch.prepare(needed.get(work.name))
            found += [
                interrupt(scratch, home / f"{work.name}-int", signal.SIGINT, "Ctrl-C"),
                interrupt(scratch, home / f"{work.name}-kill", signal.SIGKILL, "SIGKILL"),
                at_once(scratch, home / f"{work.name}-twice"),
                damage(scratch, home / f"{work.name}-damage"),
            ]
        found += disk_trials_apart(home, [work.name for work in works])
        names = [work.name for work in works]
        return sorted(found, key=lambda trial: (names.index(trial.command), MISHAPS.index(trial.mishap)))


def experiment() -> Finding:
    """Let every mishap happen to every command, and see what is lost."""
    found = trials([work for work in WORKS if work is not RENDER or not why_not_drawn()])
    tried = [trial for trial in found if trial.verdict != NOT_TRIED]
    kept = sum(trial.verdict != LOST for trial in tried)
    rows = [
        (
            trial.command,
            trial.mishap,
            f"{trial.kept} of {trial.pieces}",
            trial.message,
            str(trial.code),
            trial.verdict,
        )
        for trial in found
    ]
    return Finding(
        title="The machine fails",
        heads=("command", "mishap", "pieces whole afterwards", "said", "exit code", "what came of it"),
        rows=rows,
        edges=[Edge("mishaps after which nothing was lost", kept, len(tried), 0.0)],
        trust=(
            "What a command has finished is whole on disk whatever ends it, and the same command does the rest: files "
            "are written beside their place and moved there, arrays before the record that vouches for them."
        ),
        beyond=(
            "Ctrl-C leaves with 130; a disk that takes no more, a folder that cannot be written and a damaged file are "
            "refused with 2 and a line that names the file. SIGKILL says nothing, and leaves files of no name at most."
        ),
        draw=partial(draw, found),
    )


def draw(found: Sequence[Trial], figure: Figure) -> None:
    """Draw what came of each mishap to each command."""
    commands = list(dict.fromkeys(trial.command for trial in found))
    verdicts = list(VERDICTS)
    shade = np.full((len(commands), len(MISHAPS)), verdicts.index(NOT_TRIED))
    figure.set_size_inches(8, 1.6 + 0.55 * len(commands))
    axes = figure.add_subplot()
    for trial in found:
        row, column = commands.index(trial.command), MISHAPS.index(trial.mishap)
        shade[row, column] = verdicts.index(trial.verdict)
        colour = "white" if trial.verdict in (LOST, WHOLE) else "black"
        axes.text(column + 0.5, row + 0.5, trial.verdict, ha="center", va="center", color=colour)
    colours = ListedColormap([colour for _, colour in VERDICTS.values()])
    axes.pcolormesh(shade, cmap=colours, vmin=-0.5, vmax=len(verdicts) - 0.5, edgecolors="white", linewidth=2)
    axes.set_xticks(np.arange(len(MISHAPS)) + 0.5, [mishap.replace(" ", "\n", 1) for mishap in MISHAPS])
    axes.set_yticks(np.arange(len(commands)) + 0.5, [f"runningbond {name}" for name in commands])
    axes.invert_yaxis()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    shown = [verdict for verdict in verdicts if any(trial.verdict == verdict for trial in found)]
    handles = [Patch(color=VERDICTS[verdict][1], label=f"{verdict}: {VERDICTS[verdict][0]}") for verdict in shown]
    figure.legend(handles=handles, loc="outside lower left", frameon=False, fontsize="small")
