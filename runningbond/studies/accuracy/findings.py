"""What the table says, as smaller tables: models as they are, their knobs, growth, stiffness, and what is cheapest."""

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from runningbond.compare.figures import OURS
from runningbond.compare.table import Sheet

from .fits import slope
from .measure import REFERENCE
from .parameters import VARIED
from .rows import TOO_LONG, Row

PATH = ("dem-static", "dem-dynamic", "fem")
"""Models that follow a path to the collapse."""

CHANGED = 1.5
"""Ratio of errors from which on a knob is said to change them."""

TOLERANCES = (0.10, 0.05, 0.02, 0.01, 0.005)

Setting: TypeAlias = tuple[str, str, str]
"""Model, knob and setting; the last two empty where the model runs as it is."""


@dataclass(frozen=True)
class Record:
    """How one setting did on some walls.

    Parameters
    ----------
    walls
        Names of the walls on which it gave a number that can be judged.
    errors
        Its error on each.
    ratios
        Processor seconds on each, in those of `REFERENCE` there.
    unanswered
        Walls on which it gave no number.
    own
        Walls whose answer it certified itself, on which it is not judged.
    """

    walls: Sequence[str]
    errors: Sequence[float]
    ratios: Sequence[float]
    unanswered: Sequence[str]
    own: Sequence[str] = ()

    @property
    def worst(self) -> float:
        """Largest error."""
        return max(self.errors)

    @property
    def worst_wall(self) -> str:
        """Where it is."""
        return self.walls[self.errors.index(self.worst)]

    @property
    def middle(self) -> float:
        """Median error."""
        return statistics.median(self.errors)

    @property
    def ratio(self) -> float:
        """Median cost, in runs of `REFERENCE`."""
        return statistics.median(self.ratios)


def label(setting: Setting) -> str:
    """What a table or a chart calls a setting."""
    model, knob, turned = setting
    return f"{model}, {knob} {turned}" if knob else model


def percent(error: float) -> str:
    """An error in per cent, with two digits that count."""
    return "0 %" if error == 0 else "< 0.01 %" if error < 1e-4 else f"{100 * error:.2g} %"


def times(ratio: float) -> str:
    """A ratio with two digits that count."""
    if ratio < 0.01:
        return "< 0.01"
    return f"{ratio:.2g}" if ratio < 100 else f"{ratio:.0f}"


def records(rows: Iterable[Row], walls: Sequence[str] | None = None) -> dict[Setting, Record]:
    """Record of each setting on walls brought to collapse, all of them or some; without a number it has none."""
    judged = [row for row in rows if row.part == "accuracy" and row.question == "collapse"]
    of_setting: dict[Setting, list[Row]] = {}
    for row in judged:
        if (walls is None or row.wall in walls) and row.status != "not applicable":
            of_setting.setdefault((row.model, row.knob, row.setting), []).append(row)
    found = {}
    for setting, own in of_setting.items():
        certified = [row for row in own if row.known == "certified" and row.model == "limit-nonassociated"]
        answered = [row for row in own if row not in certified and row.error is not None and row.ratio is not None]
        if answered:
            found[setting] = Record(
                [row.wall for row in answered],
                [row.error or 0.0 for row in answered],
                [row.ratio or 0.0 for row in answered],
                [row.wall for row in own if row.value is None],
                [row.wall for row in certified],
            )
    return found


def cheapest(
    found: dict[Setting, Record], tolerance: float, walls: Sequence[str], models: Sequence[str]
) -> Setting | None:
    """The cheapest setting of some models whose error on every one of some walls is within a tolerance.

    Where a model certified the answer itself, it counts as within.
    """
    good = [
        (record.ratio, setting)
        for setting, record in found.items()
        if setting[0] in models and set(walls) <= {*record.walls, *record.own} and record.worst <= tolerance
    ]
    return min(good)[1] if good else None


@dataclass(frozen=True)
class Turned:
    """A setting beside its model as it is, on the walls where both gave a number."""

    setting: Setting
    record: Record
    plain: Record

    @property
    def dearer(self) -> float:
        """How many times the cost it has, in the median."""
        return statistics.median(a / b for a, b in zip(self.record.ratios, self.plain.ratios, strict=True))


def turned(rows: Sequence[Row]) -> list[Turned]:
    """Every knob that was turned on walls brought to collapse."""
    everywhere = records(rows)
    found = []
    for setting, record in everywhere.items():
        plain = everywhere.get((setting[0], "", ""))
        if setting[1] and plain is not None:
            both = [wall for wall in record.walls if wall in plain.walls]
            if both:
                there = records(rows, [*both, *record.unanswered])
                found.append(Turned(setting, there[setting], records(rows, both)[setting[0], "", ""]))
    return found


def models_sheet(rows: Sequence[Row]) -> Sheet:
    """Every model as it is, on the walls whose answer is known."""
    heads = ["model", "walls", "median error", "largest error", "on", f"times {REFERENCE}", "from – to", "no number on"]
    found = records(rows)
    body = []
    for model in OURS:
        record = found.get((model, "", ""))
        if record is not None:
            spread = f"{times(min(record.ratios))} – {times(max(record.ratios))}"
            error = (percent(record.middle), percent(record.worst), record.worst_wall)
            body.append(
                [model, str(len(record.walls)), *error, times(record.ratio), spread, ", ".join(record.unanswered)]
            )
    return Sheet("Models as they are, on walls brought to collapse", heads, body)


def knobs_sheet(rows: Sequence[Row]) -> Sheet:
    """Every knob, beside its model as it is on the same walls."""
    heads = ["model", "knob", "setting", "walls", "largest error", "as it is", "cost, times as it is", "no number on"]
    body = []
    for one in turned(rows):
        record = one.record
        errors = (percent(record.worst), percent(one.plain.worst))
        body.append([*one.setting, str(len(record.walls)), *errors, times(one.dearer), ", ".join(record.unanswered)])
    return Sheet("Knobs, one turned at a time", heads, body)


def cheapest_sheet(rows: Sequence[Row]) -> Sheet:
    """What is cheapest within a tolerance on all walls on which knobs are turned."""
    found = records(rows, VARIED)
    body = []
    for tolerance in TOLERANCES if found else ():
        cells = [f"{100 * tolerance:g} %"]
        for models in (tuple(OURS), PATH):
            setting = cheapest(found, tolerance, VARIED, models)
            if setting is None:
                cells += ["none", "", ""]
            else:
                cells += [label(setting), times(found[setting].ratio), percent(found[setting].worst)]
        body.append(cells)
    cost = (f"times {REFERENCE}", "largest error")
    heads = ["within", "cheapest of all", *cost, "cheapest that follows a path", *cost]
    return Sheet(f"Cheapest setting within a tolerance on each of {', '.join(VARIED)}", heads, body)


def growth(rows: Iterable[Row]) -> dict[str, list[Row]]:
    """Rows of the growth study that were timed, by model, in order of size."""
    found: dict[str, list[Row]] = {}
    for row in sorted(rows, key=lambda row: row.blocks):
        if row.part == "growth" and row.cpu_s is not None:
            found.setdefault(row.model, []).append(row)
    return found


def exponent(rows: Sequence[Row]) -> float | None:
    """Exponent with which seconds grow with blocks; None of a single size."""
    if len(rows) < 2:
        return None
    return slope([row.blocks for row in rows], [row.cpu_s or 0.0 for row in rows])


def growth_sheet(rows: Sequence[Row]) -> Sheet:
    """Processor seconds against the number of blocks."""
    sizes = sorted({row.blocks for row in rows if row.part == "growth"})
    body = []
    for model in OURS:
        own = {row.blocks: row for row in rows if row.part == "growth" and row.model == model}
        if own:
            power = exponent([row for row in own.values() if row.cpu_s is not None])
            cells = [_seconds(own.get(size)) for size in sizes]
            body.append([model, *cells, "" if power is None else f"{power:.2f}", _memory(list(own.values()))])
    heads = ["model", *(f"{size} blocks" for size in sizes), "exponent", "memory of the largest [MB]"]
    return Sheet("Processor seconds against the number of blocks: median (least – most)", heads, body)


def _seconds(row: Row | None) -> str:
    if row is None or row.cpu_s is None:
        return "" if row is None else "left out: too long" if row.status == TOO_LONG else row.status
    spread = f" ({row.cpu_s_min:.2g} – {row.cpu_s_max:.2g})" if row.runs > 1 else ""
    undecided = "" if row.status == "collapse" else f", {row.status}"
    return f"{row.cpu_s:.2g}{spread}{undecided}"


def _memory(rows: Sequence[Row]) -> str:
    timed = [row for row in rows if row.memory_mb is not None]
    return f"{max(timed, key=lambda row: row.blocks).memory_mb:.1f}" if timed else ""


@dataclass(frozen=True)
class Stiffness:
    """Processor seconds a physical second against Young's modulus: with masses scaled, without, and of rigid blocks."""

    scaled: dict[float, Row]
    unscaled: dict[float, Row]
    rigid: Row | None


def stiffness(rows: Iterable[Row]) -> Stiffness:
    """The rows of the stiffness study by Young's modulus [Pa]."""
    found = Stiffness({}, {}, None)
    for row in rows:
        if row.part != "stiffness" or row.value is None:
            continue
        if row.model == "dem-dynamic":
            found = Stiffness(found.scaled, found.unscaled, row)
        else:
            (found.unscaled if row.knob else found.scaled)[float(row.wall.removeprefix("stiff-"))] = row
    return found


def stiffness_sheet(rows: Sequence[Row]) -> Sheet:
    """What a physical second costs where blocks are ever stiffer."""
    found = stiffness(rows)
    body = []
    for young, scaled in found.scaled.items():
        plain = found.unscaled.get(young)
        rigid = found.rigid.value if found.rigid else None
        cost = scaled.value or 0.0
        body.append(
            [
                f"{young / 1e9:g}",
                f"{cost:.2g}",
                f"{plain.value:.2g}" if plain and plain.value else "",
                times(plain.value / cost) if plain and plain.value else "",
                times(cost / rigid) if rigid else "",
            ]
        )
    heads = ["E [GPa]", "fem, masses scaled", "not scaled", "ratio", "scaled, times dem-dynamic"]
    return Sheet("Processor seconds a physical second", heads, body)


def others_sheet(rows: Sequence[Row]) -> Sheet:
    """Elastic cells and the block that has turned far."""
    body = []
    for row in rows:
        if row.part == "accuracy" and row.question != "collapse" and row.error is not None and row.answer_low:
            case = label((row.model, row.knob, row.setting))
            body.append([row.wall, row.question, case, f"{row.value:.6g}", f"{row.answer_low:.6g}", percent(row.error)])
    heads = ["scene", "question", "model", "value", "exact", "error"]
    return Sheet("Other known answers: moduli of a periodic cell [Pa], and λ of a block turned by 0.1", heads, body)


def sheets(rows: Sequence[Row]) -> list[Sheet]:
    """All of them that have a row."""
    makers = (cheapest_sheet, models_sheet, knobs_sheet, others_sheet, growth_sheet, stiffness_sheet)
    return [sheet for sheet in (make(rows) for make in makers) if sheet.rows]
