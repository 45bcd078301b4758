"""Results as tables: models with their defaults, their parameters, growth, stiffness, and the cheapest settings."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from runningbond.joints import joint_stiffness
from runningbond.models import MODELS
from runningbond.pictures.sheet import Sheet
from runningbond.results.outcome import two_digits
from runningbond.studies import Edge, Row, Rows
from runningbond.studies.apart import TOO_LONG

from .measure import REFERENCE
from .parameters import IN_MOTION, VARIED
from .walls import all_walls

KINDS = {  # groups of models in which the cheapest is determined
    "any": tuple(MODELS),
    "without a path": (REFERENCE, "limit-nonassociated"),
    "follows a path": ("dem-static", *IN_MOTION),
    "in motion": IN_MOTION,
}
QUESTIONS = {  # what each model is used for
    "homog": "the trend in texture and slenderness",
    "limit": "a bound at once",
    "limit-nonassociated": "true friction, without a path",
    "dem-static": "a pushover curve",
    "dem-dynamic": "loads brought up in time",
    "fem": "blocks that deform or crack",
}
CHANGED, DEARER = 1.5, 1.25  # least ratios (or inverses) of errors and of costs that count as a change
EXACT = 1e-4  # error that counts as zero: below the digits of published answers
TOLERANCES = (0.10, 0.05, 0.02, 0.01, 0.005)
Setting: TypeAlias = tuple[str, str, str]  # model, parameter and setting; the last two empty for a model's defaults


def setting_of(row: Row) -> Setting:
    """The setting that a row belongs to."""
    return row["model"], row["parameter"], row["setting"]


def certified_itself(row: Row) -> bool:
    """Whether a row's answer is known only from certificates of its own model, by which it is not judged."""
    return row.get("known") == "certified" and row["model"] == "limit-nonassociated"


def label(setting: Setting) -> str:
    """Name of a setting in tables and charts."""
    model, parameter, value = setting
    return f"{model}, {parameter} {value}" if parameter else model


def percent(error: float) -> str:
    """An error in per cent, with two significant digits."""
    return "0 %" if error == 0 else "< 0.01 %" if error < EXACT else f"{100 * error:.2g} %"


def times(ratio: float) -> str:
    """A ratio with two significant digits."""
    return "< 0.01" if ratio < 0.01 else f"{ratio:.2g}" if ratio < 100 else f"{ratio:.0f}"


@dataclass(frozen=True)
class SettingRecord:
    """Results of one setting on walls brought to collapse."""

    judged: Sequence[Row]  # rows with an error and a cost
    unanswered: Sequence[str]  # walls without a number
    own: Sequence[str]  # walls whose answer the model certified itself
    error: float  # largest error
    ratio: float  # median cost, relative to `REFERENCE`

    def all(self, column: str) -> list[Any]:
        """A column of the judged rows."""
        return [row[column] for row in self.judged]


def records(rows: Rows, walls: Sequence[str] | None = None) -> dict[Setting, SettingRecord]:
    """Record of each setting on walls brought to collapse, all or some of them; none without a judged row."""
    of_setting: dict[Setting, list[Row]] = {}
    for row in rows["accuracy"]:
        # Rows of cases that took too long or failed have no columns that describe the wall.
        wanted = all_walls()[row["wall"]].question == "collapse" and row.get("status") != "not applicable"
        if wanted and (walls is None or row["wall"] in walls):
            of_setting.setdefault(setting_of(row), []).append(row)
    result = {}
    for setting, own in of_setting.items():
        certified = [row for row in own if certified_itself(row)]
        judged = [
            row for row in own if row not in certified and row.get("error") is not None and row.get("ratio") is not None
        ]
        if judged:
            silent = [row["wall"] for row in own if row.get("value") is None]
            error, ratio = max(row["error"] for row in judged), statistics.median(row["ratio"] for row in judged)
            result[setting] = SettingRecord(judged, silent, [row["wall"] for row in certified], error, ratio)
    return result


def cheapest(result: dict[Setting, SettingRecord], tolerance: float, models: Sequence[str]) -> Setting | None:
    """Cheapest setting of some models with errors within a tolerance on `VARIED`, except walls it certified itself."""
    good = [
        (record.ratio, setting)
        for setting, record in result.items()
        if setting[0] in models and {*VARIED} <= {*record.all("wall"), *record.own} and record.error <= tolerance
    ]
    return min(good)[1] if good else None


def models_table(rows: Rows) -> Sheet:
    """Table of all models with their defaults, on walls with a known answer."""
    body, result = [], records(rows)
    for model, record in [(model, result[model, "", ""]) for model in MODELS if (model, "", "") in result]:
        errors, ratios = record.all("error"), record.all("ratio")
        worst = record.all("wall")[errors.index(max(errors))]
        missed = [row for row in record.judged if row["error"] > EXACT]
        high = sum(row["value"] > row["answer_high"] for row in missed)
        error = [percent(statistics.median(errors)), percent(max(errors)), worst, str(high), str(len(missed) - high)]
        cost = [times(record.ratio), f"{times(min(ratios))} – {times(max(ratios))}", ", ".join(record.unanswered)]
        body.append([QUESTIONS[model], model, str(len(errors)), *error, *cost])
    heads = ["wanted", "model", "walls", "median error", "largest error", "on", "too high", "too low"]
    heads += [f"times {REFERENCE}", "from – to", "no number on"]
    return Sheet("Models as they are, on walls brought to collapse", heads, body)


def parameters_table(rows: Rows) -> Sheet:
    """Table of all parameters varied on walls brought to collapse, beside the model's defaults on the same walls."""
    body, everywhere = [], records(rows)
    for setting, record in everywhere.items():
        plain = (setting[0], "", "")
        both = [wall for wall in record.all("wall") if plain in everywhere and wall in everywhere[plain].all("wall")]
        if setting[1] and both:
            one, other = (records(rows, both)[which] for which in (setting, plain))
            costs = zip(one.all("ratio"), other.all("ratio"), strict=True)
            dearer = statistics.median(a / b for a, b in costs)
            change = max(one.error, EXACT) / max(other.error, EXACT)
            effect = "" if 1 / DEARER < dearer < DEARER else "cost alone"
            if not 1 / CHANGED < change < CHANGED:
                effect = "costs accuracy" if change > 1 else "buys accuracy"
            numbers = (str(len(both)), percent(one.error), percent(other.error), times(dearer))
            body.append([*setting, *numbers, effect, ", ".join(record.unanswered)])
    heads = ["model", "parameter", "setting", "walls", "largest error", "as it is", "cost, times as it is"]
    return Sheet("Parameters, one changed at a time", [*heads, "what it changes", "no number on"], body)


def cheapest_table(rows: Rows) -> Sheet:
    """Table of the cheapest settings within a tolerance on all walls on which parameters are varied."""
    body, result = [], records(rows, VARIED)
    for tolerance in TOLERANCES if result else ():
        for kind, models in KINDS.items():
            cells = ["none", "", ""]
            if (setting := cheapest(result, tolerance, models)) is not None:
                cells = [label(setting), times(result[setting].ratio), percent(result[setting].error)]
            body.append([f"{100 * tolerance:g} %", kind, *cells])
    heads = ["within", "kind", "cheapest", f"times {REFERENCE}", "largest error"]
    return Sheet(f"Cheapest setting within a tolerance on each of {', '.join(VARIED)}", heads, body)


def others_table(rows: Rows) -> Sheet:
    """Table of elastic cells and of the block with a large rotation."""
    body = []
    for row in rows["accuracy"]:
        if row.get("question") not in ("collapse", None) and row.get("error") is not None:
            numbers = f"{row['value']:.6g}", f"{row['answer_low']:.6g}", percent(row["error"])
            body.append([row["wall"], row["question"], label(setting_of(row)), *numbers])
    heads = ["scene", "question", "model", "value", "exact", "error"]
    return Sheet("Other known answers: moduli of a periodic cell [Pa], and λ of a block turned by 0.1", heads, body)


def growth(rows: Rows) -> dict[str, list[Row]]:
    """Timed rows of the growth study by model, in order of size."""
    timed = sorted((row for row in rows["growth"] if row.get("cpu_s") is not None), key=lambda row: int(row["blocks"]))
    return {model: own for model in MODELS if (own := [row for row in timed if row["model"] == model])}


def exponent(rows: Sequence[Row]) -> float | None:
    """Exponent p of cpu ∝ blocks^p, by least squares of the logarithms; None for a single size."""
    if len(rows) < 2:
        return None
    size, cost = ([row[name] for row in rows] for name in ("blocks", "cpu_s"))
    return float(np.polyfit(np.log(size), np.log(cost), 1)[0])


def growth_table(rows: Rows) -> Sheet:
    """Table of CPU seconds against the number of blocks."""
    body, walls = [], list(dict.fromkeys(row["wall"] for row in rows["growth"]))
    for model, timed in growth(rows).items():
        own = {row["wall"]: row for row in rows["growth"] if row["model"] == model}
        power, memory = exponent(timed), timed[-1]["memory_mb"]
        cells = [_seconds(own.get(wall, {})) for wall in walls]
        body.append([model, *cells, "" if power is None else f"{power:.2f}", f"{memory:.1f}"])
    heads = ["model", *(f"{all_walls()[wall].blocks} blocks" for wall in walls)]
    heads += ["exponent", "memory of the largest [MB]"]
    return Sheet("Processor seconds against the number of blocks: median (least – most)", heads, body)


def _seconds(row: Row) -> str:
    if row.get("cpu_s") is None:
        return "left out: too long" if row.get("status") == TOO_LONG else row.get("status", "")
    spread = f" ({two_digits(row['cpu_s_min'])} – {two_digits(row['cpu_s_max'])})" if row["runs"] > 1 else ""
    return f"{two_digits(row['cpu_s'])}{spread}" + ("" if row["status"] == "collapse" else f", {row['status']}")


def stiffness(rows: Rows) -> tuple[dict[float, float], dict[float, float], float | None]:
    """CPU seconds per physical second by Young's modulus [Pa], with scaled and unscaled masses, and of rigid blocks."""
    scaled, plain, rigid = dict[float, float](), dict[float, float](), None
    for row in rows["stiffness"]:
        if row["model"] == "dem-dynamic":
            rigid = row.get("value")
        elif row.get("value") is not None:
            (plain if row["parameter"] else scaled)[float(row["wall"].removeprefix("stiff-"))] = row["value"]
    return scaled, plain, rigid


def stiffness_table(rows: Rows) -> Sheet:
    """Table of the cost of a physical second for increasingly stiff blocks."""
    body, (scaled, plain, rigid) = [], stiffness(rows)
    for young, cost in scaled.items():
        unscaled = [f"{plain[young]:.2g}", times(plain[young] / cost)] if young in plain else ["", ""]
        body.append([f"{young / 1e9:g}", f"{cost:.2g}", *unscaled, times(cost / rigid) if rigid else ""])
    heads = ["E [GPa]", "fem, masses scaled", "not scaled", "ratio", "scaled, times dem-dynamic"]
    return Sheet("Processor seconds a physical second", heads, body)


def tables(rows: Rows) -> list[Sheet]:
    """All tables that have a row."""
    makers = (cheapest_table, models_table, parameters_table, others_table, growth_table, stiffness_table)
    return [sheet for sheet in (make(rows) for make in makers) if sheet.rows]


def fits(rows: Rows) -> list[Edge]:
    """Edges: rigid blocks are too stiff in compression by k_n a / E."""
    edges = []
    for row in rows["accuracy"]:
        if row["model"] == "homog" and row.get("question") == "compression" and row.get("error") is not None:
            scene = all_walls()[row["wall"]].scene
            assert scene.bond is not None
            theory = joint_stiffness(scene.joint).normal * scene.bond.height / (scene.block.young or 0.0)
            edges.append(Edge(f"rigid blocks too stiff by, {row['wall']}", row["error"], theory, 1e-6))
    return edges
