"""`advise` beside all six models: brackets, rungs, and processor time in one run.

From the project's directory, for all published walls or some of them, with the models at the same tolerance as `advise`
or at that of ``runningbond compare``:

    python benchmarks/advise.py
    python benchmarks/advise.py --against 0.01 panel-02 panel-04 wall-w3
"""

import argparse
import time
import warnings

from runningbond.compare import PUBLISHED, published_scene
from runningbond.compare.advice import TOLERANCE, advise
from runningbond.compare.table import bracket
from runningbond.models import MODELS, run_model
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError
from runningbond.scene.errors import exits_in_a_line


def timed_model(model: str, scene: Scene, tolerance: float) -> tuple[Outcome | None, float]:
    """Outcome of a model, None if it does not apply, and its processor time [s]."""
    start = time.process_time()
    try:
        outcome = run_model(model, scene, tolerance)
    except SceneError:
        outcome = None
    return outcome, time.process_time() - start


def main() -> None:
    """Print one row per wall, then the ratio of the sums."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("walls", nargs="*", help="published walls, all by default")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE)
    parser.add_argument("--against", type=float, help="tolerance of the six models, the same by default")
    arguments = parser.parse_args()
    against = arguments.against or arguments.tolerance
    walls = {name: published_scene(name) for name in arguments.walls or [case.name for case in PUBLISHED]}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for model in ("dem-dynamic", "fem"):  # kernels are compiled before anything is measured
            run_model(model, published_scene("wall-w1"), arguments.tolerance)
    print("| wall | advise | by | rungs | s | all six | s | ratio |")
    print("|---|---|---|---|---|---|---|---|")
    total_advice, total_all = 0.0, 0.0
    for name, scene in walls.items():
        start = time.process_time()
        advice = advise(scene, arguments.tolerance)
        spent = time.process_time() - start
        runs = {model: timed_model(model, scene, against) for model in MODELS}
        every = sum(seconds for _, seconds in runs.values())
        found = "; ".join(bracket(outcome) for outcome, _ in runs.values() if outcome is not None)
        answer, climbed = advice.outcome(), len(advice.rungs)
        print(
            f"| {name} | {bracket(answer)} | {answer.model} | {climbed} | {spent:.2f} | {found} | {every:.2f} "
            f"| {every / spent:.1f} |",
            flush=True,
        )
        total_advice, total_all = total_advice + spent, total_all + every
    print(f"\nall: advise {total_advice:.1f} s, six models {total_all:.1f} s of processor time: ", end="")
    print(f"{total_all / total_advice:.1f} times as much")


if __name__ == "__main__":
    with exits_in_a_line():
        main()
