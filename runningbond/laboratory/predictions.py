"""Predictions of walls: every rung on every wall, run in parallel and stored, and their scores."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from runningbond.campaigns import Campaign, Cell, Task, run_tasks
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.models import TOLERANCE, Model
from runningbond.results import Outcome
from runningbond.scene import Array, Scene, SceneError

from .folder import raised
from .formulas import FORMULAS, by_hand
from .ladder import Rung
from .measured import MeasuredWall
from .modes import ROCKING, SLIDING, measured_modes, predicted_mode
from .rig import RICHEST, scene_of
from .scores import Marks, cycle_ends, cycle_peaks, energy_ratio, goes_to_both_sides, has_cycles, marks_of, ratio

ARRIVED = 0.99
"""Share of the path's length above which a wall has been followed to the end of the path."""

FOLLOWED, INAPPLICABLE = "followed", "inapplicable"
"""Statuses in addition to those of outcomes: followed along the whole path without an answer; the model refuses the
wall."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """Prediction of one wall by one rung.

    `outcome` is None if the rung does not apply to the wall, with a `reason`.
    """

    wall: MeasuredWall
    rung: Rung
    scene: Scene
    outcome: Outcome | None
    reason: str = ""

    @property
    def status(self) -> str:
        """Status of the outcome, or `FOLLOWED` if the wall was followed to the path's end without an answer."""
        if self.outcome is None:
            return INAPPLICABLE
        return FOLLOWED if self.outcome.status in ("undecided", "unbounded") and self._arrived else self.outcome.status

    @property
    def _arrived(self) -> bool:
        path = self.scene.drive_path
        if self.outcome is None or not path or not len(self.outcome.curve):
            return False
        way = float(np.abs(np.diff((0.0, *path))).sum())
        return float(np.abs(np.diff(self.outcome.curve[:, 0])).sum()) >= ARRIVED * way

    @property
    def is_answer(self) -> bool:
        """Whether there is a result to score."""
        return self.status in ("collapse", FOLLOWED)

    @property
    def curve(self) -> Array:
        """Displacement [m] and force [N], with the signs of the test."""
        drive = self.scene.drive
        if self.outcome is None or drive is None or not drive.path:
            return np.zeros((0, 2))
        # Outcomes are positive in the direction of the first push, and so are one-sided tests, whichever side it was.
        return np.asarray(self.outcome.curve * (np.sign(drive.force[0]) if self._is_to_both_sides else 1.0))

    @property
    def is_to_and_fro(self) -> bool:
        """Whether it has cycles; a scene of its own may push to one side although the test was cyclic."""
        return has_cycles(self.scene.drive_path)

    @property
    def _is_to_both_sides(self) -> bool:
        """Whether both the test and the prediction go to both sides."""
        return goes_to_both_sides(self.wall.path) and goes_to_both_sides(self.scene.drive_path)

    @cached_property
    def marks(self) -> Marks | None:
        """Values read from its curve."""
        side = self.wall.side if self._is_to_both_sides else 1.0
        return marks_of(self.curve, cyclic=self.wall.is_cyclic, side=side) if self.is_answer else None

    @property
    def strength(self) -> float | None:
        """Its largest force [N]."""
        if not self.is_answer or self.outcome is None:
            return None
        found = self.marks.strength if self.marks else self.outcome.multiplier
        return None if found is None else float(found)

    @property
    def error(self) -> float | None:
        """ΔV, the relative error of the strength."""
        over = ratio(self.strength, self.wall.peak)
        return None if over is None else over - 1

    @property
    def mode(self) -> str | None:
        """Predicted failure mode."""
        if self.rung.is_by_hand and self.is_answer:
            loads = by_hand(self.scene)
            formula = self.rung.name if self.rung.name in loads else min(loads, key=lambda name: loads[name])
            return dict(zip(FORMULAS, (ROCKING, SLIDING), strict=True))[formula]
        return predicted_mode(self.scene, self.outcome) if self.is_answer and self.outcome else None

    @property
    def is_mode_right(self) -> bool | None:
        """Whether the report names the predicted mode; None if either is unknown."""
        known = measured_modes(self.wall.modes)
        return self.mode in known if self.mode and known else None

    def row(self) -> dict[str, Any]:
        """Its scores, and the values in SI units that they compare, under the names that the command line prints."""
        test = marks_of(self.wall.curve, cyclic=self.wall.is_cyclic, side=self.wall.side)
        own, outcome = self.marks, self.outcome
        over = {
            name: ratio(getattr(own, key, None), getattr(test, key, None))
            for name, key in (
                ("stiffness_ratio", "stiffness"),
                ("peak_displacement_ratio", "at_peak"),
                ("drift_ratio", "at_loss"),
                ("residual_ratio", "residual"),
            )
        }
        values = {
            f"{key}{end}": getattr(marks, key, None)
            for key in ("stiffness", "at_peak", "at_loss", "residual")
            for end, marks in (("", own), ("_measured", test))
        }
        if goes_to_both_sides(self.wall.path) != goes_to_both_sides(self.scene.drive_path):
            over["stiffness_ratio"] = None  # secants of one side and of both
        energy = energy_ratio(own.loops, test.loops) if own and test else None
        return {
            "wall": self.wall.name,
            "model": self.rung.name,
            "status": self.status,
            "V_max": self.strength,
            "V_measured": self.wall.peak,
            "dV": self.error,
            **values,
            **over,
            "energy_ratio": energy,
            "cycle_ratio": self._cycles(),
            "mode": self.mode,
            "mode_measured": ", ".join(self.wall.modes) or None,
            "mode_right": self.is_mode_right,
            "scored": self.wall.is_scored,
            "seconds": outcome.seconds if outcome else None,
            "message": outcome.message if outcome else self.reason,
        }

    def _cycles(self) -> float | None:
        """Mean ratio of predicted to measured peaks of cycles."""
        if not self.wall.is_cyclic or not self.is_to_and_fro or not self.marks:
            return None
        ends = cycle_ends(self.wall.path)
        pairs = zip(cycle_peaks(self.curve, ends), cycle_peaks(self.wall.curve, ends), strict=False)
        over = [own / test for own, test in pairs if test]
        return float(np.mean(over)) if over else None


def scenes_of(
    walls: Sequence[MeasuredWall], rungs: Sequence[Rung], refuse: Callable[[SceneError], None] = raised
) -> dict[Cell, Scene]:
    """The scene of every wall for every rung; `refuse` is called for walls without one, as in `read_folder`.

    Walls are refused for the parts of their descriptions that no rung takes as well, whichever rungs are asked for.
    """
    scenes: dict[Cell, Scene] = {}
    for wall in walls:
        try:
            scene_of(wall, RICHEST)
            scenes |= {(wall.name, rung.name): scene_of(wall, rung.features) for rung in rungs}
        except SceneError as error:
            where = wall.row.place if wall.scene_file is None else wall.scene_file.name
            key = error.key if where in error.key else f"{where}: {error.key}"
            refuse(SceneError(key, error.remedy, error.value))
    return scenes


def predict(
    walls: Sequence[MeasuredWall],
    rungs: Sequence[Rung],
    scenes: Mapping[Cell, Scene],
    folder: Path,
    *,
    jobs: int = -1,
    fresh: bool = False,
    progress: Callable[[Cell], None] = lambda cell: None,
) -> tuple[list[Prediction], Campaign]:
    """Predict walls with rungs, on their scenes; stored results of the same computation are reused from the folder.

    Walls whose scenes differ only in their titles are computed once and share the result. For parameters and errors see
    `runningbond.campaigns.run_tasks`.
    """
    # The most expensive first; otherwise they would end up on a single core at the end.
    cells = [(wall, rung) for rung in reversed(rungs) for wall in sorted(walls, key=lambda wall: not wall.is_cyclic)]
    reasons = {(wall.name, rung.name): rung.leaves_out(scenes[wall.name, rung.name]) for wall, rung in cells}
    models = {cell: rung.model for wall, rung in cells if not reasons[cell := (wall.name, rung.name)]}
    computed = _computed(models, scenes)
    tasks = [Task(cell[0], scenes[cell], models[cell], TOLERANCE) for cell in models if computed[cell] == cell]
    campaign = run_tasks(tasks, folder=folder, jobs=jobs, fresh=fresh, progress=progress)
    for cell, first in computed.items():
        if cell != first:
            if first in campaign.outcomes:
                campaign.outcomes[cell] = replace(campaign.outcomes[first], scene=scenes[cell].title)
            else:
                campaign.inapplicable[cell] = campaign.inapplicable[first]
            progress(cell)
    for cell, reason in reasons.items():
        if reason:
            campaign.inapplicable[cell] = reason
            progress(cell)
    predictions = []
    for wall in walls:
        for rung in rungs:
            cell = (wall.name, rung.name)
            outcome, reason = campaign.outcomes.get(cell), campaign.inapplicable.get(cell, "")
            predictions.append(Prediction(wall, rung, scenes[cell], outcome, reason))
    return predictions, campaign


def _computed(models: Mapping[Cell, Model], scenes: Mapping[Cell, Scene]) -> dict[Cell, Cell]:
    """The cell from which each cell takes its result: the first of its model with the same scene up to the title."""
    first: dict[str, Cell] = {}
    return {
        cell: first.setdefault(fingerprint(replace(scenes[cell], title=""), model, TOLERANCE), cell)
        for cell, model in models.items()
    }
