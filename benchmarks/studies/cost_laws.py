"""Laws of what the models cost: fitted to the table of a comparison, printed as `compare.costs.LAWS` has them.

From the project's directory, after ``runningbond compare --fresh --out comparison``:

    python benchmarks/studies/cost_laws.py comparison/table.csv
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

from compare import MODELS, published_scene


def main() -> None:
    """Fit log seconds to log blocks and to whether the wall has weight, a line a model."""
    rows: dict[str, list[tuple[float, float, float]]] = defaultdict(list)
    with Path(sys.argv[1]).open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["status"] in ("collapse", "undecided"):
                weightless = not any(published_scene(row["scene"]).load.gravity)
                rows[row["model"]].append((int(row["blocks"]), float(weightless), float(row["seconds"])))
    for model in MODELS:
        n, weightless, seconds = np.array(rows[model]).T
        terms = np.column_stack([np.ones_like(n), np.log(n / 100), weightless])
        found = np.linalg.lstsq(terms, np.log(seconds))[0]
        spread = np.exp(np.std(np.log(seconds) - terms @ found))
        at_100, growth, factor = np.exp(found[0]), found[1], np.exp(found[2])
        print(f'    "{model}": Law({at_100:.2g}, {growth:.2f}, {factor:.2g}, {spread:.2f}),')


if __name__ == "__main__":
    main()
