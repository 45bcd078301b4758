"""Every mishap happens to every command, and what comes of it is told and drawn."""

import signal
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from runningbond.compare.published import find_scene
from runningbond.pictures.offscreen import why_not_drawn
from runningbond.studies.stability.finding import Edge, Finding

from .disk import disk_trials_apart
from .faults import at_once, damage, interrupt
from .trial import LOST, NOT_TRIED, VERDICTS, WHOLE, Scratch, Trial, call
from .works import RENDER, TITLE, WALL, WORKS, Work

MISHAPS = ("Ctrl-C", "SIGKILL", "full disk", "read-only folder", "two at once", "damaged result")


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
