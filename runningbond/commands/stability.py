"""``runningbond stability``."""

import difflib
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from runningbond.results import make_folder
from runningbond.scene import SceneError

from .exits import DONE, NO_ANSWER, STOPPED
from .terminal import progress_bar

if TYPE_CHECKING:
    from runningbond.studies import Rows, Study


def stability(*experiments: str, out: Path = Path("stability")) -> int:
    """Drive every method over its edge, and tell where each may be trusted.

    What is measured is kept as it comes: an interrupted command goes on where it was.

    Parameters
    ----------
    experiments
        Names of experiments; all where none is given.
    out
        Folder for tables, charts and the report.
    """
    from runningbond.studies.page import failed, off, page, summary, write_page
    from runningbond.studies.stability import EXPERIMENTS, experiment
    from runningbond.studies.store import is_complete

    for name in experiments:
        if name not in EXPERIMENTS:
            likely = difflib.get_close_matches(name, EXPERIMENTS, n=1)
            hint = f'; did you mean "{likely[0]}"?' if likely else ""
            raise SceneError("experiment", f"must be one of {', '.join(EXPERIMENTS)}{hint}", name)
    make_folder(out)
    console = Console(stderr=True, highlight=False)
    studies = [experiment(name) for name in EXPERIMENTS]
    try:
        # What is complete comes along, also where others are asked for.
        asked = [each for each in studies if each.name in (experiments or EXPERIMENTS) or is_complete(each, out)]
        found = _measured(asked, out, console)
    except Stopped:
        kept = sum(is_complete(each, out) for each in studies)
        said = f"Interrupted: {kept} of {len(studies)} experiments are kept in {out}; the same command goes on."
        console.print(said, soft_wrap=True, markup=False)
        return STOPPED
    written = write_page("stability", page(found, out), out, "stability")
    terminal = Console(width=None if sys.stdout.isatty() else 180, markup=False, highlight=False)
    terminal.print(summary(found).terminal())
    terminal.print(f"written: {', '.join(map(str, written[:2]))}", soft_wrap=True)
    wrong = [*off(found), *failed(found)]
    for words in wrong:
        console.print(words, soft_wrap=True, markup=False)
    return NO_ANSWER if wrong else DONE


class Stopped(BaseException):
    """Ctrl-C in the middle of experiments: not a KeyboardInterrupt, which a model would take for its own end."""


def _measured(studies: Sequence["Study"], out: Path, console: Console) -> "list[tuple[Study, Rows]]":
    from runningbond.studies.store import run_study

    def stop(number: int, frame: object) -> None:
        raise Stopped

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with progress_bar(console) as bar:
            task = bar.add_task("stability", total=sum(len(study.cases) for study in studies))

            def progress(case: str) -> None:
                bar.update(task, advance=1, description=case)

            return [(study, run_study(study, out, progress=progress)) for study in studies]
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
