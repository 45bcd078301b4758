"""Errors of the models on walls tested to failure in laboratories, as measured by `runningbond validate`.

``measured.csv`` is a copy of the table `FILE` that this command writes into its folder.
"""

import csv
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from runningbond.pictures.sheet import csv_lines
from runningbond.scene import Scene

FILE = "model-errors.csv"
"""Name of the table in the folder of the laboratory."""

SHIPPED = Path(__file__).with_name("measured.csv")
DRY, MORTAR = "dry", "mortar"


@dataclass(frozen=True)
class ModelError:
    """Error ΔV of a model, predicted over measured strength minus 1, on walls with one kind of joints.

    Parameters
    ----------
    rung, base
        Name of the model in the laboratory, and the model of this package on which it is based.
    joints
        Kind of the walls' joints.
    finite, crushes, splits
        Whether displacements are finite, joints crush, and blocks split.
    walls
        Names of the walls, separated by blanks.
    median
        Median of |ΔV|.
    least, most
        Least and largest ΔV.
    """

    rung: str
    base: str
    joints: str
    finite: bool
    crushes: bool
    splits: bool
    walls: str
    median: float
    least: float
    most: float

    def __str__(self) -> str:
        names = self.walls.split()
        extra = ["joints that crush"] * self.crushes + ["blocks that split"] * self.splits
        rung = f"{self.rung} ({self.base} with {' and '.join(extra)})" if extra else self.rung
        return (
            f"{rung} was off by {self.median:.0%} in the median, {self.least:+.0%} to {self.most:+.0%}, on "
            f"{len(names)} tested walls with {self.joints} joints ({', '.join(names)})"
        )

    def as_json(self) -> dict[str, Any]:
        """Content for a script: the fields, with the walls as a list."""
        return asdict(self) | {"walls": self.walls.split()}


def write_errors(errors: Iterable[ModelError]) -> str:
    """Table of errors as the text of a CSV file."""
    names = [field.name for field in fields(ModelError)]
    rows = [[f"{x:.4f}" if isinstance(x, float) else str(x) for x in asdict(each).values()] for each in errors]
    return csv_lines([names, *rows])


def read_errors(path: Path = SHIPPED) -> list[ModelError]:
    """Read a table that `write_errors` has written."""
    read: dict[Any, Callable[[str], Any]] = {str: str, float: float, bool: "True".__eq__}
    with path.open(encoding="utf-8", newline="") as file:
        rows = [*csv.DictReader(file)]
    return [ModelError(**{one.name: read[one.type](row[one.name]) for one in fields(ModelError)}) for row in rows]


def joints_of(scene: Scene) -> str:
    """Kind of the joints between the blocks of a scene: mortar if any of them has cohesion, otherwise dry."""
    bonded = any(each.cohesion > 0 for each in scene.materials_of_joints if each.name != "inner_joint")
    return MORTAR if bonded else DRY


def error_of(model: str, scene: Scene, *, finite: bool) -> ModelError | None:
    """Measured error of a model on walls with the scene's kind of joints; None if no such wall was tested.

    Of several, one that agrees with the scene on splitting blocks is preferred, then one that agrees on crushing.
    """
    crushes = any(each.compressive_strength is not None for each in scene.materials_of_joints)
    splits = scene.inner_joint is not None
    own = [each for each in read_errors() if (each.base, each.joints, each.finite) == (model, joints_of(scene), finite)]
    return max(own, key=lambda each: (each.splits == splits, each.crushes == crushes), default=None)
