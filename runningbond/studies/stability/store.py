"""Findings on disk: each kept whole as soon as it is there, and taken again only if the same code wrote it.

The chart is written first; the JSON file, which vouches for both, is moved into place last.
"""

import hashlib
import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from numbers import Integral
from pathlib import Path

from matplotlib.figure import Figure

from runningbond.compare.fingerprint import code_digest
from runningbond.results import write_atomically

from .finding import Edge, Entry, Finding


@dataclass(frozen=True)
class Kept:
    """A finding as it is kept: `Finding`, its chart drawn.

    Parameters
    ----------
    name
        Name of the experiment.
    title, heads, rows, edges, trust, beyond
        As in `Finding`.
    chart
        The chart, a PNG file.
    """

    name: str
    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Entry]]
    edges: Sequence[Edge]
    trust: str
    beyond: str
    chart: Path

    @property
    def off(self) -> list[Edge]:
        """Edges that do not lie where theory has them."""
        return [edge for edge in self.edges if edge.agrees is False]


@cache
def stability_digest() -> str:
    """Digest of every source file that can change a finding: the models', and those of the room they are run from."""
    digest = hashlib.sha256(code_digest().encode())
    folder = Path(__file__).parents[2]
    for source in sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".toml")):
        digest.update(f"{source.relative_to(folder)}\n".encode() + source.read_bytes())
    return digest.hexdigest()


def drawn(finding: Finding) -> bytes:
    """The chart of a finding as a PNG file."""
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    finding.draw(figure)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=160)
    return buffer.getvalue()


def keep(name: str, finding: Finding, chart: bytes, folder: Path) -> Kept:
    """Write a finding and its chart into a folder."""
    told = {
        "name": name,
        "key": stability_digest(),
        "title": finding.title,
        "heads": list(finding.heads),
        "rows": [[_plain(entry) for entry in row] for row in finding.rows],
        "edges": [
            {what: entry if entry is None else _plain(entry) for what, entry in asdict(edge).items()}
            for edge in finding.edges
        ],
        "trust": finding.trust,
        "beyond": finding.beyond,
    }
    write_atomically(folder / f"{name}.png", chart)
    record = {**told, "sha256": _seal(told, chart)}
    content = json.dumps(record, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    write_atomically(folder / f"{name}.json", content.encode())
    kept = find(name, folder)
    assert kept is not None
    return kept


def find(name: str, folder: Path) -> Kept | None:
    """Read a finding back; None unless it is there whole, and of the code that runs."""
    chart = folder / f"{name}.png"
    try:
        told = json.loads((folder / f"{name}.json").read_bytes())
        seal = told.pop("sha256")
        if told.pop("name") != name or told["key"] != stability_digest():
            return None
        if _seal({"name": name, **told}, chart.read_bytes()) != seal:
            return None
        told.pop("key")
        edges = [Edge(**edge) for edge in told.pop("edges")]
        return Kept(name, edges=edges, chart=chart, **told)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _seal(told: Mapping[str, object], chart: bytes) -> str:
    """Digest of everything that is kept."""
    return hashlib.sha256(json.dumps(told, sort_keys=True).encode() + chart).hexdigest()


def _plain(entry: Entry) -> Entry:
    """An entry that JSON has words for."""
    if isinstance(entry, str):
        return str(entry)
    if isinstance(entry, Integral):
        return int(entry)
    if math.isfinite(entry):
        return float(entry)
    return "–" if math.isnan(entry) else ("∞" if entry > 0 else "−∞")
