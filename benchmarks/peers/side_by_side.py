"""The suite's models and other programs on the same walls: λ, processor time, and the ratio of times.

Needs ``pip install -e '.[peers]'``; the table has a line for a program that is missing or fails. From the project's
directory:

    python benchmarks/peers/side_by_side.py
    python benchmarks/peers/side_by_side.py --walls trial --out /tmp/trial.jsonl

Every run is a process of its own with one thread, and adds one line to a file as it ends. An interrupted comparison
continues from there, unless the code or a program's version has changed. Runs are in turn, all programs once and then
again. Seconds are processor time to find the bracket, without imports and without the compilation of kernels, which is
part of a warm-up run. For several runs of a program the table has their median.
"""

import argparse
import hashlib
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, TypeAlias

from load_steps import Bracket
from peer import Peer
from walls import TRIAL, WALLS, wall_of

from runningbond.campaigns.fingerprint import code_digest
from runningbond.models import run_model
from runningbond.scene import Scene

MODELS = ("limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem")
MODULES = ("rbe_wall", "pymunk_wall", "mujoco_wall", "opensees_wall", "akantu_wall")
PROGRAMS = (*MODELS, *MODULES)

TOLERANCE = 0.01
"""Relative width of the brackets."""

RUNS, DEAR = 3, 30.0
"""Runs of each program on each wall, and processor time [s] of a run above which it is not repeated."""

BUDGET = 1200.0
"""Processor time [s] after which a program stops with its bracket so far."""

HERE = Path(__file__).parent
OUT = Path("comparison/peers.jsonl")

Record: TypeAlias = dict[str, Any]


def peer_of(program: str) -> Peer:
    """Description of a peer by the name of its module."""
    peer = import_module(program).PEER
    assert isinstance(peer, Peer)
    return peer


def run_one(program: str, scene: Scene, tolerance: float) -> Bracket:
    """Run a program on a scene, in this process."""
    if program in MODELS:
        outcome = run_model(program, scene, tolerance)
        status: Any = outcome.status
        return Bracket(outcome.lower, outcome.upper, status, 0)
    found = import_module(program).bracket(scene, tolerance, BUDGET)
    assert isinstance(found, Bracket)
    return found


def find(wall: str, program: str) -> Record:
    """Bracket and processor time of a program on a wall, after a warm-up run on the trial wall."""
    run_one(program, wall_of("trial"), 0.5)
    scene = wall_of(wall)
    start = time.process_time()
    found = run_one(program, scene, TOLERANCE)
    return {**vars(found), "seconds": time.process_time() - start}


def in_a_process(wall: str, program: str) -> Record:
    """Run a program on a wall in a process of its own; returns the result, or how the process ended."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    command = [sys.executable, __file__, "--one", wall, program]
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        child = subprocess.Popen(
            [*command, "--out", str(answer)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            env=environment,
            text=True,
        )
        assert child.stderr is not None
        said = [line.strip() for line in child.stderr if line.strip()]
        _, code, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(code)
        if child.returncode == 0:
            found: Record = json.loads(answer.read_text())
        else:
            missing = next((line for line in reversed(said) if line.startswith("ModuleNotFoundError")), None)
            message = missing or (said[-1] if said else "") or f"exit code {child.returncode}"
            found = {"status": "not installed" if missing else "failed", "message": message}
    return {**found, "process": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss / 1024}


def state_of_things() -> str:
    """Digest of the code and of the programs' versions; runs with another digest are repeated."""
    digest = hashlib.sha256(code_digest().encode())
    for source in sorted(HERE.glob("*.py")):
        if source.name != Path(__file__).name:
            digest.update(source.read_bytes())
    for program in MODULES:
        digest.update(version_of(peer_of(program).package).encode())
    return digest.hexdigest()[:16]


def version_of(package: str) -> str:
    """Version of a distribution; empty if it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def kept(place: Path, state: str) -> list[Record]:
    """Records in the complete lines of a file that are from the same code and programs."""
    records = []
    for line in place.read_text().splitlines() if place.exists() else []:
        try:
            record = json.loads(line)
        except ValueError:  # interrupted while the line was written
            continue
        if record.get("state") == state:
            records.append(record)
    return records


def run_all(walls: Sequence[str], programs: Sequence[str], place: Path) -> list[Record]:
    """Run programs on walls in turn, and store each result as soon as it is available."""
    state = state_of_things()
    records = kept(place, state)
    place.parent.mkdir(parents=True, exist_ok=True)
    for turn in range(RUNS):
        for wall in walls:
            for program in programs:
                before = of_cell(records, wall, program)
                if len(before) > turn or any(r["process"] > DEAR or "seconds" not in r for r in before):
                    continue
                found = in_a_process(wall, program)
                record = {"state": state, "wall": wall, "program": program, **found}
                records.append(record)
                with place.open("a") as file:
                    file.write(json.dumps(record) + "\n")
                print(f"{wall}, {program}: {found['status']}, {found['process']:.1f} s", file=sys.stderr, flush=True)
    return records


def of_cell(records: Sequence[Record], wall: str, program: str) -> list[Record]:
    """The runs of a program on a wall."""
    return [record for record in records if (record["wall"], record["program"]) == (wall, program)]


def middle(runs: Sequence[Record]) -> float | None:
    """Median processor time of the runs that found a collapse; None if there is none."""
    times = [run["seconds"] for run in runs if run.get("status") == "collapse"]
    return statistics.median(times) if times else None


def table(records: Sequence[Record], walls: Sequence[str], programs: Sequence[str]) -> Iterator[str]:
    """Lines of the table."""
    yield "| wall | kind | program | λ | status | CPU [s] (spread) | loads | times the suite's | MB | remark |"
    yield "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for wall in walls:
        blocks = int(wall_of(wall).wall.sum())
        for program in programs:
            runs = of_cell(records, wall, program)
            if not runs:
                continue
            run = runs[0]
            peer = None if program in MODELS else peer_of(program)
            cells = (
                f"{wall} ({blocks} blocks)",
                "the suite" if peer is None else peer.kind,
                f"`{program}`" if peer is None else f"{peer.name} {version_of(peer.package)}",
                bracket_of(run),
                run["status"],
                seconds_of(runs),
                str(run.get("loads") or ""),
                ", ".join(f"{ratio:.3g} × `{model}`" for model, ratio in ratios(records, wall, program)),
                f"{run['memory']:.0f}",
                run["message"],
            )
            yield "| " + " | ".join(cells) + " |"


def bracket_of(run: Record) -> str:
    """Bracket as text."""
    if run.get("lower") is None:
        return "–"
    upper = "?" if run["upper"] is None else f"{run['upper']:.4f}"
    return f"{run['lower']:.4f}–{upper}"


def seconds_of(runs: Sequence[Record]) -> str:
    """Median and spread of processor times, as text."""
    times = sorted(run["seconds"] for run in runs if "seconds" in run)
    if not times or runs[0]["status"] == "cost only":
        return "–"
    spread = f" ({times[0]:.3g} … {times[-1]:.3g})" if len(times) > 1 else ""
    return f"{statistics.median(times):.3g}{spread}"


def ratios(records: Sequence[Record], wall: str, program: str) -> list[tuple[str, float]]:
    """Cost of a peer relative to each model of its kind."""
    if program in MODELS:
        return []
    peer, runs = peer_of(program), of_cell(records, wall, program)
    given = [run["ratio"] for run in runs if run.get("ratio")]
    if given:
        return [(peer.rivals[0], statistics.median(given))]
    theirs = middle(runs)
    found = [(model, theirs, middle(of_cell(records, wall, model))) for model in peer.rivals]
    return [(model, a / b) for model, a, b in found if a and b]


def verdict(records: Sequence[Record], walls: Sequence[str], programs: Sequence[str]) -> str:
    """Sentence on whether a peer costs less than a model of its kind on any wall."""
    all_ratios = [
        (ratio, f"{peer_of(program).name} on {wall}: {ratio:.3g} × `{model}`")
        for wall in walls
        for program in programs
        for model, ratio in ratios(records, wall, program)
    ]
    if not all_ratios:
        return "No peer has found a bracket."
    cheaper = [said for ratio, said in sorted(all_ratios) if ratio < 1]
    if cheaper:
        return "Peers that cost less than a model of their kind: " + "; ".join(cheaper) + "."
    return f"Of those that were run no peer costs less than a model of its kind; the nearest is {min(all_ratios)[1]}."


def machine() -> str:
    """Description of the machine."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), platform.machine())
    return f"{name}, {os.cpu_count()} processors, {platform.system()}, Python {platform.python_version()}"


def main() -> None:
    """Run the missing cases, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--walls", nargs="+", choices=[*WALLS, *TRIAL], default=list(WALLS))
    parser.add_argument("--programs", nargs="+", choices=PROGRAMS, default=list(PROGRAMS))
    parser.add_argument("--out", type=Path, default=OUT, help="where runs are kept")
    parser.add_argument("--one", nargs=2, metavar=("WALL", "PROGRAM"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        resource.setrlimit(resource.RLIMIT_CPU, (round(1.5 * BUDGET), round(1.5 * BUDGET)))  # ends a program that hangs
        arguments.out.write_text(json.dumps(find(*arguments.one)))
        return
    walls, programs = arguments.walls, arguments.programs
    records = run_all(walls, programs, arguments.out)
    print(f"Machine: {machine()}; brackets {TOLERANCE:.0%} wide.\n")
    print("\n".join(table(records, walls, programs)))
    print(f"\n{verdict(records, walls, programs)}\n")
    for program in programs:
        if program not in MODELS:
            peer = peer_of(program)
            print(f"- {peer.name} can do {peer.does}. It does not {peer.does_not}.")


if __name__ == "__main__":
    main()
