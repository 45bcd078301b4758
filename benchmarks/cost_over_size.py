"""Cost against size: processor seconds of every model on running-bond panels, until a run exceeds its budget.

    python benchmarks/cost_over_size.py [--seconds 60] [--models limit,fem] [--out docs/cost-over-size.png]

Every run is a process of its own and is ended after that many processor seconds; an arrow in the chart marks that its
true cost is not known. Compiled kernels are loaded before the measurement. The table is stored beside the picture
(CSV), and models that are not run again (with ``--models ""`` all) are drawn from it.
"""

import argparse
import csv
import multiprocessing
import resource
import time
from dataclasses import asdict, dataclass, fields
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from limit_large import wall
from matplotlib.figure import Figure

from runningbond.models import MODELS, run_model
from runningbond.scene import Mortar, Scene

ACROSS = (4, 6, 9, 12, 17, 24, 35, 50, 70, 100, 158, 223)
"""Blocks per course; the number of courses is twice as large."""

MORTAR = Mortar(1e9, 0.2, 0.01)


@dataclass(frozen=True)
class Run:
    """A run: processor seconds, peak memory [GB], and status, which is empty if the run exceeded its budget."""

    model: str
    blocks: int
    seconds: float
    memory: float
    status: str


def panel(across: int) -> Scene:
    """A panel of `limit_large` on mortar of 1 GPa, 10 mm thick."""
    return wall(across, 2 * across).with_joint(elasticity=MORTAR).with_block(young=1e10, poisson=0.2)


def measured(model: str, scene: Scene, seconds: int) -> Run:
    """Run a model in a process of its own with a budget of processor seconds."""
    here, there = multiprocessing.Pipe(duplex=False)
    process = multiprocessing.get_context("fork").Process(target=_run, args=(model, scene, seconds, there))
    process.start()
    there.close()
    blocks = int(scene.wall.sum())
    try:
        spent, memory, status = here.recv()
    except EOFError:
        spent, memory, status = float(seconds), float("nan"), ""
    process.join()
    return Run(model, blocks, spent, memory, status)


def _run(model: str, scene: Scene, seconds: int, there: Connection) -> None:
    start = time.process_time()
    most = int(start) + seconds
    resource.setrlimit(resource.RLIMIT_CPU, (most, most))
    status = run_model(model, scene).status
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    there.send((time.process_time() - start, memory, status))


def every_size(model: str, seconds: int) -> list[Run]:
    """Run a model on growing panels up to the first that exceeds the budget; prints each run as it ends."""
    runs: list[Run] = []
    run_model(model, panel(ACROSS[0]))
    for across in ACROSS:
        runs.append(run := measured(model, panel(across), seconds))
        took = f"{run.seconds:9.2f} s  {run.memory:5.2f} GB  {run.status}" if run.status else f"> {seconds:7d} s"
        print(f"{model:20} {run.blocks:7d} blocks  {took}", flush=True)
        if not run.status:
            break
    return runs


def chart(table: list[Run]) -> Figure:
    """Draw cost over size on logarithmic axes; open markers are runs without an answer, arrows exceeded budgets."""
    figure = Figure(figsize=(7.2, 5.0), layout="constrained")
    axes = figure.add_subplot()
    for name, looks in MODELS.items():
        runs = [run for run in table if run.model == name]
        ended = [run for run in runs if run.status]
        done = ([run.blocks for run in ended], [max(run.seconds, 1e-3) for run in ended])
        (line,) = axes.plot(*done, color=looks.colour, linestyle=looks.line, marker=looks.marker, label=name)
        line.set_markevery([k for k, run in enumerate(ended) if run.status == "collapse"])
        for run in ended:
            if run.status != "collapse":
                axes.plot(run.blocks, run.seconds, looks.marker, color=looks.colour, markerfacecolor="white")
        for run in runs[len(ended) :]:
            arrow = {"arrowstyle": "->", "color": looks.colour}
            axes.annotate("", (run.blocks, 2 * run.seconds), (run.blocks, run.seconds), arrowprops=arrow)
            last = [*zip(*done, strict=True)][-1:]
            path = np.array([*last, (run.blocks, run.seconds)]).T
            axes.plot(*path, color=looks.colour, linewidth=0.8, linestyle=":")
            axes.plot(run.blocks, run.seconds, looks.marker, color=looks.colour, markerfacecolor="white")
    figure.suptitle("Cost against size, model by model", fontsize=11)
    said = "hollow: no collapse load found; arrows: ended by their budget, the true cost is not known"
    axes.set_title(said, fontsize=8, color="0.35", loc="left")
    axes.set(xscale="log", yscale="log", xlim=(25, 2e5), ylim=(1e-3, 4 * max(run.seconds for run in table)))
    axes.set(xlabel="blocks of a running-bond panel", ylabel="processor seconds")
    axes.grid(which="major", color="0.9")
    axes.legend(fontsize=8, loc="lower right", frameon=False)
    return figure


def main() -> None:
    """Print one row per run, store the table, and draw the chart."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=60, help="most processor seconds of a run")
    parser.add_argument("--models", default=",".join(MODELS))
    parser.add_argument("--out", type=Path, default=Path("docs/cost-over-size.png"))
    arguments = parser.parse_args()
    kept, chosen = arguments.out.with_suffix(".csv"), [name for name in arguments.models.split(",") if name]
    rows = list(csv.DictReader(kept.open(encoding="utf-8"))) if kept.exists() else []
    table = [
        Run(row["model"], int(row["blocks"]), float(row["seconds"]), float(row["memory"]), row["status"])
        for row in rows
        if row["model"] not in chosen
    ]
    for name in chosen:
        table += every_size(name, arguments.seconds)
    with kept.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(Run)], lineterminator="\n")
        writer.writeheader()
        writer.writerows(map(asdict, table))
    chart(table).savefig(arguments.out, dpi=160)


if __name__ == "__main__":
    main()
