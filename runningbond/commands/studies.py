"""``runningbond stability`` and ``runningbond study``; every measurement is stored as soon as it is made."""

import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from runningbond.campaigns import INTERRUPTIONS
from runningbond.results import make_folder
from runningbond.scene import SceneError
from runningbond.scene.folder_lock import locked
from runningbond.scene.ranges import suggestion

from .terminal import DONE, NO_ANSWER, STOPPED, Whole, print_table, progress_bar

if TYPE_CHECKING:
    from runningbond.studies import Row, Study


def stability(*experiments: str, out: Path = Path("stability")) -> int:
    """Drive every method beyond its limit, and report where each may be trusted.

    Every measurement is stored as soon as it is made; an interrupted command continues from there.

    Parameters
    ----------
    experiments
        Names of experiments; all experiments if none is given.
    out
        Folder for tables, charts and the report.
    """
    from runningbond.studies.page import failed, off, page, summary, write_page
    from runningbond.studies.stability import EXPERIMENTS, experiment
    from runningbond.studies.store import is_complete

    for name in experiments:
        if name not in EXPERIMENTS:
            what = f"must be one of {', '.join(EXPERIMENTS)}{suggestion(name, list(EXPERIMENTS))}"
            raise SceneError("experiment", what, name)
    make_folder(out)
    studies = [experiment(name) for name in EXPERIMENTS]
    try:
        # Complete experiments are included in the page even if only others are requested.
        included = [each for each in studies if each.name in (experiments or EXPERIMENTS) or is_complete(each, out)]
        rows = _measured(included, out, "stability")
    except Stopped:
        kept = sum(is_complete(each, out) for each in studies)
        return _interrupted(f"{kept} of {len(studies)} experiments, and what is measured of others, are kept in {out}")
    with locked(out):
        written = write_page("stability", page(rows, out), out, "stability")
    print_table(summary(rows))
    print(f"written: {', '.join(map(str, written[:2]))}")
    return _exit_code([*off(rows), *failed(rows)])


def study(*, out: Path = Path("study"), jobs: Whole = 1) -> int:
    """Measure error and cost of every model and its parameters on walls whose answer is known.

    Every measurement is stored as soon as it is made; an interrupted study continues from there.

    Parameters
    ----------
    out
        Folder for the table, the charts and the page.
    jobs
        Number of processes in parallel; with more than one, the measured seconds are less reliable.
    """
    if jobs < 1:
        raise SceneError("--jobs", "must be a number of processes, 1 or more", jobs)
    from runningbond.studies.accuracy.study import STUDY, page
    from runningbond.studies.page import write_page
    from runningbond.studies.store import failures

    make_folder(out)
    try:
        rows = _measured([STUDY], out, "measuring", jobs)[0][1]
    except Stopped:
        return _interrupted(f"what is measured is kept in {out}")
    with locked(out):
        written = write_page("speed against accuracy", page(rows, out), out, STUDY.name)
    for sheet in STUDY.tables(rows)[:2]:
        print(sheet.markdown())
    print(f"written: {', '.join(map(str, written))}")
    return _exit_code(failures(rows))


class Stopped(BaseException):
    """Ctrl-C during a study; not a KeyboardInterrupt, because a model would end its own run with that."""


def _measured(
    studies: Sequence["Study"], out: Path, description: str, jobs: int = 1
) -> "list[tuple[Study, dict[str, list[Row]]]]":
    """Rows of studies, measured unless they are stored; Ctrl-C or SIGTERM raises `Stopped`."""
    from runningbond.studies.store import run_study

    def stop(number: int, frame: object) -> None:
        raise Stopped

    before = {number: signal.signal(number, stop) for number in INTERRUPTIONS}
    try:
        with progress_bar(description, sum(len(study.cases) for study in studies)) as advance:
            return [(study, run_study(study, out, jobs=jobs, progress=advance)) for study in studies]
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupted(kept: str) -> int:
    print(f"Interrupted: {kept}; the same command goes on.", file=sys.stderr)
    return STOPPED


def _exit_code(wrong: Sequence[str]) -> int:
    """Print the errors; returns the exit code."""
    for words in wrong:
        print(words, file=sys.stderr)
    return NO_ANSWER if wrong else DONE
