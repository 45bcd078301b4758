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
    """Measure every model and its knobs on walls whose answer is known: error against cost.

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
    from runningbond.studies.accuracy import all_cases, run_study
    from runningbond.studies.accuracy.conclusions import conclusions
    from runningbond.studies.accuracy.page import write_page

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    console = Console(stderr=True)
    try:
        with progress_bar(console) as bar:
            task = bar.add_task("measuring", total=len(all_cases()))
            rows = run_study(out, jobs=jobs, progress=lambda case: bar.update(task, advance=1, description=str(case)))
    except KeyboardInterrupt:
        console.print(
            f"Interrupted: what is measured is kept in {out}; the same command goes on.", soft_wrap=True, markup=False
        )
        return STOPPED
    written = write_page(rows, out)
    print("\n".join(conclusions(rows)))
    print(f"written: {', '.join(map(str, written))}")
    failed = [row for row in rows if row.status == "failed"]
    for row in failed:
        console.print(f"{row.case}: {row.message}", markup=False)
    return NO_ANSWER if failed else DONE
