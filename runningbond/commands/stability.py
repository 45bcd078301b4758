"""``runningbond stability``."""

import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from runningbond.results import make_folder

from .exits import DONE, NO_ANSWER, STOPPED
from .terminal import progress_bar

if TYPE_CHECKING:
    from runningbond.studies.stability.report import Findings


def stability(*experiments: str, out: Path = Path("stability")) -> int:
    """Drive every method over its edge, and tell where each may be trusted.

    Findings are kept as they come: an interrupted command goes on where it was.

    Parameters
    ----------
    experiments
        Names of experiments; all where none is given.
    out
        Folder for findings, charts and the report.
    """
    from runningbond.studies.stability import EXPERIMENTS
    from runningbond.studies.stability.report import check_experiments, summary, write_report
    from runningbond.studies.stability.store import find

    check_experiments(experiments)
    make_folder(out)
    console = Console(stderr=True, highlight=False)
    try:
        found = _find_out_with_progress(experiments or EXPERIMENTS, out, console)
    except Stopped:
        kept = sum(find(name, out) is not None for name in EXPERIMENTS)
        said = f"Interrupted: {kept} of {len(EXPERIMENTS)} experiments are kept in {out}; the same command goes on."
        console.print(said, soft_wrap=True, markup=False)
        return STOPPED
    written = write_report(found, out)
    terminal = Console(width=None if sys.stdout.isatty() else 180, markup=False, highlight=False)
    terminal.print(summary(found).terminal())
    terminal.print(f"written: {', '.join(map(str, written))}", soft_wrap=True)
    for name, edge in found.off:
        theory = f"measured {edge.measured:.6g}, by theory {edge.theory:.6g}"
        console.print(f"{name}: {edge.what}: {theory}", soft_wrap=True, markup=False)
    for name, words in found.broken.items():
        console.print(f"{name} ended in an error: {words}", soft_wrap=True, markup=False)
    return NO_ANSWER if found.off or found.broken else DONE


class Stopped(BaseException):
    """Ctrl-C in the middle of experiments: not a KeyboardInterrupt, which a model would take for its own end."""


def _find_out_with_progress(experiments: Sequence[str], out: Path, console: Console) -> "Findings":
    from runningbond.studies.stability.report import Findings, findings

    def stop(number: int, frame: object) -> None:
        raise Stopped

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    found = Findings()
    try:
        with progress_bar(console) as bar:
            task = bar.add_task("stability", total=len(experiments))
            for name, finding in findings(experiments, out, lambda name: bar.update(task, description=name)):
                if isinstance(finding, str):
                    found.broken[name] = finding
                else:
                    found.kept[name] = finding
                bar.update(task, advance=name in experiments)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    return found
