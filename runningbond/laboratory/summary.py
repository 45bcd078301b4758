"""Summary of the predictions of each rung, and the rungs that meet the requirements of the laboratory."""

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from runningbond.compare.advice.experiment import ModelError, joints_of
from runningbond.pictures.sheet import Sheet
from runningbond.results.outcome import two_digits

from .formulas import by_hand, pressed
from .predictions import Prediction

MEDIAN, WORST, MODES, FACTOR = 0.10, 0.20, 0.80, 1.5
"""Requirements: median and largest |ΔV|, share of correct modes, and largest factor by which stiffnesses, and
displacements at the loss of a fifth of the strength, may be off."""


@dataclass(frozen=True)
class Total:
    """Summary of the scored predictions of one rung on walls of one kind.

    Parameters
    ----------
    kind, model
        Kind of the walls' joints, and the rung.
    walls, answers
        Number of scored walls, and of those for which the rung predicts a strength.
    median, worst
        Median and largest |ΔV|; None without an answer.
    modes
        Share of correct modes among the known ones; None if none is known.
    stiffness, drift
        Largest factor by which a stiffness, and a displacement at the loss, is off; None if none is known.
    beaten
        Number of walls on which the rung is nearer to the test than the better of the two hand formulas.
    seconds
        Median CPU time [s].
    is_by_hand
        Whether the rung is a hand formula.
    """

    kind: str
    model: str
    walls: int
    answers: int
    median: float | None
    worst: float | None
    modes: float | None
    stiffness: float | None
    drift: float | None
    beaten: int
    seconds: float | None
    is_by_hand: bool

    @property
    def reaches(self) -> bool:
        """Whether all requirements are met, on every wall; hand formulas give no stiffness and never meet them."""
        if self.median is None or self.worst is None or self.answers < self.walls:
            return False
        factors = self.stiffness is not None and max(self.stiffness, self.drift or 1.0) <= FACTOR
        return self.median <= MEDIAN and self.worst <= WORST and (self.modes or 0.0) >= MODES and factors


def model_errors(predictions: Sequence[Prediction]) -> list[ModelError]:
    """ΔV of each rung that is a model, on the scored walls of each kind for which it has an answer."""
    answered = [each for each in predictions if each.wall.is_scored and each.error is not None and each.rung.base]
    found = []
    for (kind, name), own in _by_kind_and_rung(answered).items():
        rung, errors = own[0].rung, [each.error or 0.0 for each in own]
        features = rung.model.is_finite, rung.features.crushes, rung.features.splits
        walls, middle = " ".join(each.wall.name for each in own), median(map(abs, errors))
        found.append(ModelError(name, rung.base, kind, *features, walls, middle, min(errors), max(errors)))
    return found


def kind_of(prediction: Prediction) -> str:
    """Kind of a wall in tables, by its joints: as in the row of the wall, else as in its scene."""
    return prediction.wall.row.joints or joints_of(prediction.scene)


def totals(predictions: Sequence[Prediction]) -> list[Total]:
    """Totals of the scored walls, by kind of wall and by rung."""
    scored = [each for each in predictions if each.wall.is_scored]
    return [_total(*group, own, errors_by_hand(scored)) for group, own in _by_kind_and_rung(scored).items()]


def _by_kind_and_rung(predictions: Sequence[Prediction]) -> dict[tuple[str, str], list[Prediction]]:
    groups: dict[tuple[str, str], list[Prediction]] = {}
    for each in predictions:
        groups.setdefault((kind_of(each), each.rung.name), []).append(each)
    return groups


def errors_by_hand(predictions: Sequence[Prediction]) -> dict[str, float]:
    """|ΔV| of the better of the two formulas, by wall, whether or not the formulas are among the rungs."""
    peaks = {each.wall.name: (each.scene, each.wall.peak) for each in predictions}
    return {
        name: float(min(abs(load / peak - 1) for load in by_hand(scene).values()))
        for name, (scene, peak) in peaks.items()
        if peak and pressed(scene) >= 0
    }


def _total(kind: str, model: str, own: Sequence[Prediction], to_beat: dict[str, float]) -> Total:
    errors = [abs(each.error) for each in own if each.error is not None]
    modes = [each.is_mode_right for each in own if each.is_mode_right is not None]
    rows = [each.row() for each in own]
    beaten = [each.error is not None and abs(each.error) < to_beat.get(each.wall.name, 0.0) for each in own]
    return Total(
        kind,
        model,
        len(own),
        len(errors),
        median(errors) if errors else None,
        max(errors, default=None),
        sum(modes) / len(modes) if modes else None,
        _factor([row["stiffness_ratio"] for row in rows]),
        _factor([row["drift_ratio"] for row in rows]),
        sum(beaten),
        median(seconds) if (seconds := [row["seconds"] for row in rows if row["seconds"] is not None]) else None,
        own[0].rung.is_by_hand,
    )


def _factor(ratios: Sequence[float | None]) -> float | None:
    """Largest of the ratios and of their inverses."""
    return max((max(ratio, 1 / ratio) for ratio in ratios if ratio), default=None)


def cheapest(sums: Sequence[Total]) -> str | None:
    """The rung that meets all requirements on dry walls in the least time; None if there is none."""
    reaching = [(each.seconds or 0.0, each.model) for each in sums if each.reaches and each.kind == "dry"]
    return min(reaching)[1] if reaching else None


def as_json(sums: Sequence[Total]) -> dict[str, Any]:
    """The summary as the command line prints it."""
    kinds: dict[str, dict[str, Any]] = {}
    for each in sums:
        kinds.setdefault(each.kind, {})[each.model] = {
            "walls": each.walls,
            "answers": each.answers,
            "median_dV": each.median,
            "worst_dV": each.worst,
            "modes_right": each.modes,
            "beats_hand": each.beaten,
            "seconds": each.seconds,
            "reaches": each.reaches,
        }
    return {**kinds, "cheapest": cheapest(sums)}


def percent(value: float | None, sign: str = "") -> str:
    """A share in per cent; a dash if there is none."""
    return "–" if value is None else f"{100 * value:{sign}.1f} %"


def summary_sheet(sums: Sequence[Total]) -> Sheet:
    """Totals as a table."""
    heads = ("walls", "model", "scored", "median |ΔV|", "worst |ΔV|", "modes right", "stiffness within", "drift within")
    rows = []
    for each in sums:
        hand = "–" if each.is_by_hand else f"{each.beaten} of {each.answers}"
        shares = [percent(each.median), percent(each.worst), percent(each.modes)]
        factors = ["–" if x is None else f"× {x:.2f}" for x in (each.stiffness, each.drift)]
        time = "–" if each.seconds is None or each.is_by_hand else two_digits(each.seconds)
        rows.append([each.kind, each.model, f"{each.answers} of {each.walls}", *shares, *factors, hand, time])
    return Sheet("Summary", (*heads, "nearer than by hand", "CPU seconds"), rows)


def verdicts(sums: Sequence[Total]) -> list[str]:
    """Text: what the best rung achieves, and which rungs are not worth their cost."""
    asked = (
        f"Asked for, on dry walls: median |ΔV| ≤ {MEDIAN:.0%}, none beyond {WORST:.0%}, {MODES:.0%} of the modes, "
        f"stiffness and drift at the loss of a fifth within a factor of {FACTOR:g}."
    )
    best = cheapest(sums)
    lines = [f"{asked} The cheapest that reaches it: `{best}`." if best else f"{asked} **None reaches all of it.**"]
    for kind in dict.fromkeys(each.kind for each in sums):
        own = [each for each in sums if each.kind == kind and each.median is not None]
        models = [each for each in own if not each.is_by_hand]
        if models:
            most = max(each.answers for each in models)
            least = min((each for each in models if each.answers == most), key=lambda each: each.median or 0.0)
            modes = "" if least.modes is None else f"; {percent(least.modes)} of its modes are right"
            lines.append(
                f"Walls with {kind} joints: median |ΔV| {percent(least.median)} by `{least.model}` at best, of those "
                f"that answer on {most} of {least.walls}; {percent(least.worst)} at worst{modes}."
            )
        lines += [
            f"`{each.model}` has not earned its cost on walls with {kind} joints: it is nearer than the better "
            f"of the two formulas on {each.beaten} of {each.answers} of them."
            for each in models
            if 2 * each.beaten <= each.answers
        ]
    return lines
