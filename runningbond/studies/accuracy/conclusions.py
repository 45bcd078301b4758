"""Which model to take for which question: sentences with numbers, all of them out of the table."""

from collections.abc import Iterator, Sequence

from .findings import (
    CHANGED,
    PATH,
    Setting,
    cheapest,
    exponent,
    growth,
    label,
    percent,
    records,
    stiffness,
    times,
    turned,
)
from .measure import REFERENCE
from .parameters import VARIED
from .rows import TOO_LONG, Row
from .walls import TURNED

EXACT = 1e-4
"""Error that counts as none: below the digits of the answers that are published."""

WORSE = "Knobs that cost accuracy (largest error, and the cost in that of the model as it is)"
BETTER = "Knobs that buy accuracy"
ALIKE = "Knobs that hardly change the largest error, but the cost by a factor of"

DEARER = 1.25
"""Ratio of costs from which on a knob is said to change them."""


def conclusions(rows: Sequence[Row]) -> list[str]:
    """Sentences in Markdown, one a question, of all that the table has something for."""
    parts = (_models, _cheapest, _knobs, _deformable, _far, _growth, _stiff)
    return [sentence for part in parts for sentence in part(rows)]


def _models(rows: Sequence[Row]) -> Iterator[str]:
    found = records(rows)
    questions = {
        "limit": "A bound at once",
        "limit-nonassociated": "True friction, without a path",
        "dem-static": "A pushover curve",
        "dem-dynamic": "Loads brought up in time",
        "fem": "Blocks that deform or crack",
        "homog": "The trend in texture and slenderness",
    }
    for model, question in questions.items():
        record = found.get((model, "", ""))
        if record is None:
            continue
        side = _side([row for row in rows if row.model == model and not row.knob and row.wall in record.walls])
        cost = "the unit of cost" if model == REFERENCE else f"{times(record.ratio)} times `{REFERENCE}` in the median"
        none = f"; no number on {', '.join(record.unanswered)}" if record.unanswered else ""
        yield (
            f"**{question}: `{model}`.** Error of {percent(record.middle)} in the median and {percent(record.worst)} "
            f"at most ({record.worst_wall}) on {len(record.walls)} walls{side}; {cost}{none}."
        )


def _side(rows: Sequence[Row]) -> str:
    """On which side of the answer the values lie that miss it."""
    missed = [row for row in rows if row.part == "accuracy" and row.error is not None and row.error > EXACT]
    above = sum(row.value > row.answer_high for row in missed if row.value is not None and row.answer_high is not None)
    return f", {above} of them too high and {len(missed) - above} too low" if missed else ""


def _cheapest(rows: Sequence[Row]) -> Iterator[str]:
    found = records(rows, VARIED)
    for tolerance in (0.05, 0.01) if found else ():
        parts = []
        for models, what in (
            ((REFERENCE, "limit-nonassociated"), "without a path"),
            (PATH, "that follows a path"),
            (("dem-dynamic", "fem"), "in motion"),
        ):
            setting = cheapest(found, tolerance, VARIED, models)
            if setting is None:
                parts.append(f"none {what}")
            else:
                parts.append(f"`{label(setting)}` {what} ({times(found[setting].ratio)} times `{REFERENCE}`)")
        yield f"**Within {100 * tolerance:g} % on each of {', '.join(VARIED)}** the cheapest is {', '.join(parts)}."


def _knobs(rows: Sequence[Row]) -> Iterator[str]:
    """Settings by what they change: the largest error for worse or for better, or nothing but the cost."""
    kinds: dict[str, list[str]] = {WORSE: [], BETTER: [], ALIKE: []}
    for one in turned(rows):
        record, plain, name = one.record, one.plain, label(one.setting)
        change = max(record.worst, EXACT) / max(plain.worst, EXACT)
        if 1 / CHANGED < change < CHANGED:
            if not 1 / DEARER < one.dearer < DEARER:
                kinds[ALIKE].append(f"`{name}` {times(one.dearer)}")
        else:
            errors = f"{percent(record.worst)} instead of {percent(plain.worst)}"
            kinds[WORSE if change > 1 else BETTER].append(f"`{name}` {errors} at {times(one.dearer)} times the cost")
    for kind, settings in kinds.items():
        if settings:
            yield f"**{kind}:** {'; '.join(settings)}."


def _others(rows: Sequence[Row], question: str) -> Iterator[tuple[str, Setting, float]]:
    """Wall, setting and error of what answered another question."""
    for row in rows:
        if row.part == "accuracy" and row.question == question and row.error is not None:
            yield row.wall, (row.model, row.knob, row.setting), row.error


def _deformable(rows: Sequence[Row]) -> Iterator[str]:
    of_cells: dict[str, dict[Setting, float]] = {}
    for wall, setting, error in _others(rows, "compression"):
        of_cells.setdefault(wall, {})[setting] = error
    rigid = {wall: found["dem-static", "", ""] for wall, found in of_cells.items() if ("dem-static", "", "") in found}
    if not rigid:
        return
    steps = ", ".join(f"{percent(error)} at {_gigapascals(wall)} GPa" for wall, error in rigid.items())
    best = {
        setting: max(found[setting] for found in of_cells.values() if setting in found)
        for setting in {setting for found in of_cells.values() for setting in found if setting[0] == "fem"}
    }
    exact = [label(setting) for setting, error in sorted(best.items()) if error < 1e-9]
    named = f"; exact there: {', '.join(f'`{name}`' for name in exact)}" if exact else ""
    yield (
        f"**When blocks need a stiffness.** Rigid blocks are too stiff under compression by {steps}, "
        f"which is k_n a / E{named}."
    )


def _gigapascals(wall: str) -> str:
    return f"{float(wall.removeprefix('cell-')) / 1e9:g}"


def _far(rows: Sequence[Row]) -> Iterator[str]:
    found = {setting: error for _, setting, error in _others(rows, "turned block")}
    small = [error for setting, error in found.items() if setting[1] == "displacements"]
    finite = [error for setting, error in found.items() if setting[1] != "displacements"]
    if small and finite:
        yield (
            f"**After the peak.** Models of small displacements give a block that has turned by {TURNED:g} "
            f"{percent(max(small))} too much to bear; `finite_pushover` and `fem_pushover` err by "
            f"{percent(max(finite))} at most, at all speeds tried."
        )


def _growth(rows: Sequence[Row]) -> Iterator[str]:
    found = growth(rows)
    sizes = sorted({row.blocks for own in found.values() for row in own})
    parts = []
    for model, own in found.items():
        power = exponent(own)
        if power is not None:
            less = "" if own[-1].blocks == sizes[-1] else f" (up to {own[-1].blocks})"
            parts.append(f"`{model}` {power:.2f}{less}")
    if not parts:
        return
    left_out = [f"`{row.model}` on {row.blocks}" for row in rows if row.part == "growth" and row.status == TOO_LONG]
    none = f" Left out, for a run takes more than a minute: {', '.join(left_out)}." if left_out else ""
    yield (
        f"**More blocks.** From {sizes[0]} to {sizes[-1]} blocks, processor seconds grow with the number of blocks to "
        f"the power {', '.join(parts)}.{none}"
    )


def _stiff(rows: Sequence[Row]) -> Iterator[str]:
    found = stiffness(rows)
    both = [young for young in sorted(found.scaled) if young in found.unscaled]
    if len(both) < 2:
        return
    scaled = [found.scaled[young].value or 0.0 for young in both]
    plain = [found.unscaled[young].value or 0.0 for young in both]
    gains = ", ".join(f"{times(b / a)} at {young / 1e9:g} GPa" for young, a, b in zip(both, scaled, plain, strict=True))
    rigid = found.rigid.value if found.rigid else None
    beside = f", {times(scaled[-1] / rigid)} times that of rigid blocks" if rigid else ""
    yield (
        f"**Stiff blocks.** A physical second without mass scaling is dearer than with it by a factor of {gains}. With "
        f"it the stiffest blocks cost {times(scaled[-1] / scaled[0])} times what the softest do{beside}."
    )
