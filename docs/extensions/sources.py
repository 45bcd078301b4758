"""The pages of this folder are read on GitHub as well, and docstrings in terminals: what Sphinx is told of both."""

import re
from typing import Any

import matplotlib
from sphinx.application import Sphinx

PAGES = {
    "../README.md#which-model": "/how-to/choose-a-model.md",
    "../runningbond/laboratory/data/README.md": "/laboratory-data.md",
}
"""Where links to files outside this folder lead within the site; all others are downloads."""

TYPES = {
    r"~[\w.]*\.(\w+)": r"\1",
    r"ndarray\[tuple\[Any, \.\.\.\], dtype\[float64\]\]": "Array",
    r"ndarray\[tuple\[Any, \.\.\.\], dtype\[int64\]\]": "Indices",
    r"ndarray\[tuple\[Any, \.\.\.\], dtype\[bool\]\]": "Mask",
}


def lead_home(app: Sphinx, page: str, source: list[str]) -> None:
    """Lead links to files that are pages of the site, scripts of the gallery among them, to these pages."""
    for file, target in PAGES.items():
        source[0] = source[0].replace(f"]({file})", f"]({target})")
    source[0] = re.sub(r"\]\((?:\.\./)?gallery\)", "](/gallery-of-examples/index.rst)", source[0])
    source[0] = re.sub(r"\]\((?:\.\./)?gallery/(\S+)\.py\)", r"](/gallery-of-examples/\1.rst)", source[0])


def keep_formulas(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Keep formulas of docstrings as they stand: indented paragraphs before the first section, and |x|."""
    section = next((i for i, line in enumerate(lines) if re.fullmatch(r"-{3,}", line)), len(lines) + 1) - 1
    kept: list[str] = []
    formula = False
    for number, line in enumerate(lines):
        indented = line.startswith("    ") and number < section
        if indented and not formula and not lines[number - 1].strip():
            kept += [".. code-block:: none", ""]
        formula = indented or (formula and not line.strip())
        kept.append(line if formula else re.sub(r"\|(?=\S)([^|`]+)(?<=\S)\|(?!`)", r"\\|\1\\|", line))
    lines[:] = kept


def shorten(app: Sphinx, what: str, name: str, thing: Any, options: Any, signature: str, returned: str) -> Any:
    """Types by the names that the sources know them by."""
    parts = [signature, returned]
    for long, short in TYPES.items():
        parts = [part and re.sub(long, short, part) for part in parts]
    return parts


def cropped(configuration: dict[str, Any], name: str) -> None:
    """Pictures of the gallery, without the white around them."""
    matplotlib.rcParams.update({"savefig.bbox": "tight", "savefig.pad_inches": 0.1, "savefig.dpi": 150})


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("source-read", lead_home)
    app.connect("autodoc-process-signature", shorten)
    app.connect("autodoc-process-docstring", keep_formulas, priority=100)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
