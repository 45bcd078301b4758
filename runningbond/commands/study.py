"""``runningbond study``."""

import signal
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from runningbond.scene import SceneError

from .exits import DONE, NO_ANSWER, STOPPED
from .terminal import progress_bar, whole


def study(*, out: Path = Path("study"), jobs: Annotated[int, Parameter(converter=whole)] = 1) -> int:
    """Measure every model and its parameters on walls whose answer is known: error against cost.

    Measurements are kept as they come: an interrupted study goes on where it was.

    Parameters
    ----------
    out
        Folder for the table, the charts and the page.
    jobs
        Number of processes side by side; with more than one, seconds are worth less.
    """
    if jobs < 1:
        raise SceneError("--jobs", "must be a number of processes, 1 or more", jobs)
    from runningbond.studies.accuracy.study import STUDY, page
    from runningbond.studies.page import write_page
    from runningbond.studies.store import failures, run_study

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    console = Console(stderr=True)
    try:
        with progress_bar(console) as bar:
            task = bar.add_task("measuring", total=len(STUDY.cases))
            rows = run_study(STUDY, out, jobs=jobs, progress=lambda case: bar.update(task, advance=1, description=case))
    except KeyboardInterrupt:
        console.print(
            f"Interrupted: what is measured is kept in {out}; the same command goes on.", soft_wrap=True, markup=False
        )
        return STOPPED
    written = write_page("speed against accuracy", page(rows, out), out, STUDY.name)
    for sheet in STUDY.tables(rows)[:2]:
        print(sheet.markdown())
    print(f"written: {', '.join(map(str, written))}")
    failed = failures(rows)
    for words in failed:
        console.print(words, markup=False)
    return NO_ANSWER if failed else DONE
