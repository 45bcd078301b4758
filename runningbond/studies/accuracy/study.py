"""The study of accuracy against cost: its cases, and its page."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from fem_interface.modes import BENDING
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.studies import Case, Part, Rows, Study
from runningbond.studies.apart import LONGEST
from runningbond.studies.page import Block, draw_charts, edges_sheet
from runningbond.studies.store import failures, table_path
from runningbond.studies.study import PACKAGE
from runningbond.studies.walls import INSET

from .charts import CHARTS
from .measure import CHEAP, REFERENCE, RUNS, machine, measure
from .parameters import COLLAPSE, IN_MOTION, PARAMETERS, STIFF, settings_of
from .tables import fits, tables
from .walls import StudiedWall, accuracy_walls, all_walls, growth_walls, stiffness_walls

ELASTIC = ("homog", "dem-static", "fem")
ASKED = {"collapse": ("homog", *COLLAPSE), "turned block": IN_MOTION, "compression": ELASTIC, "shear": ELASTIC}
ASKED |= {"physical second": ("fem",)}
HOW = (  # text of the page: how the study is made
    "Walls with an exact answer are a block that topples, a block that slides and a stack, λ = min(tan φ, b / (n h)); "
    "a block that is rotated by θ, λ = tan(α − θ); and periodic cells. The contacts of W1 – W3 of Ferris & Tin-Loi lie "
    f"{1e3 * INSET:g} mm in from the ends of the joints; their λ is published to four digits. It is the only load that "
    "`limit-nonassociated` certifies for W1 and W2, and the smaller of two for W3. "
    "For the panels the answer is the interval of loads that `limit-nonassociated` certifies: the error is the "
    "distance from this interval, and zero inside it, where no load can be called wrong; loads below it are not "
    "excluded. A model is not judged by its own certificates.",
    "The error is that of the multiplier which a model reports: the middle of the bracket for `dem-dynamic` and `fem`, "
    "its lower end for `limit-nonassociated` and `dem-static`. Parameters are changed one at a time; otherwise `fem` "
    f"has two Lobatto points per joint element, one cell in half a block, {BENDING} modes and scaled masses, brackets "
    "are 1 % wide, and loads are held until the wall rests or falls. *Driven* walls are pushed at a prescribed "
    "work-conjugate speed instead, in the given number of time steps for a twentieth of a block if all of the wall "
    "moved as far, and λ is the largest value on the way.",
    "Every case runs in its own process on one thread, after an untimed run that loads the kernels: "
    f"{RUNS} times, or once if it takes more than {CHEAP:g} s; seconds are medians of processor time. Ratios are to "
    f"`{REFERENCE}` on the same wall, run alternately in the same process. A run that would take more than {LONGEST} s "
    "is stopped and left out.",
)


def _cases(walls: Mapping[str, StudiedWall]) -> Iterator[Case]:
    """Every model on every wall with a question for it, with its defaults and with each parameter varied there."""
    for name, wall in walls.items():
        for model in ASKED[wall.question]:
            if model == "homog" and wall.question == "collapse" and wall.known != "certified":
                continue  # homogenisation does not apply to one block or to a wall that is no running bond
            if name != "cell-shear" or model != "fem":  # deformable blocks have no closed form
                yield name, model, "", ""
            for parameter in PARAMETERS:
                if model in parameter.models and name in parameter.walls:
                    for setting in parameter.settings:
                        if setting not in parameter.expensive or name in parameter.walls[:2]:
                            yield name, model, parameter.name, setting


def depends(case: Case) -> str:
    """Digest of the scene, the settings and the machine."""
    return fingerprint(all_walls()[case[0]].scene, f"{settings_of(*case[1:])!r} {machine()}", 0.0)


COLUMNS = ("wall", "model", "parameter", "setting")
SOURCES = [
    PACKAGE / f"studies/{name}.py" for name in ("walls", "accuracy/walls", "accuracy/questions", "accuracy/measure")
]
CASES = {
    "accuracy": [*_cases(accuracy_walls())],
    "stiffness": [*_cases(stiffness_walls()), (STIFF[-1], "dem-dynamic", "", "")],
    "growth": [(name, model, "", "") for name in growth_walls() for model in COLLAPSE],
}

STUDY = Study(
    "study",
    "Speed against accuracy",
    parts={name: Part(COLUMNS, cases, measure) for name, cases in CASES.items()},
    charts=CHARTS,
    fits=fits,
    tables=tables,
    sources=SOURCES,
    depends=depends,
    apart=True,
)


def page(rows: Rows, folder: Path) -> list[Block]:
    """The study's page, with its charts drawn into a folder."""
    every = [row for own in rows.values() for row in own]
    machines = "; ".join(sorted({row["machine"] for row in every if row.get("machine")}))
    failed = failures(rows)
    blocks: list[Block] = ["# Speed against accuracy", "What `runningbond study` printed.", *HOW]
    blocks.append(f"Measured on {machines}: {len(every) - len(failed)} of {len(STUDY.cases)} cases.")
    blocks += [f"Failed: {words}" for words in failed]
    blocks += ["## Charts", *draw_charts(STUDY, rows, folder), "## Tables", *STUDY.tables(rows)]
    blocks += [edges_sheet(STUDY.edges(rows)), f"Every run is a row of `{table_path(STUDY, folder).name}`."]
    return blocks
