"""Formulas as MathML, which browsers draw by themselves: no script, and of a font the signs that formulas need.

Systems without a font for mathematics set subscripts badly; STIX Two Math (Open Font License) comes with ziamath.
"""

from importlib.resources import files
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from fontTools import subset
from sphinx.application import Sphinx
from sphinx.util.logging import getLogger
from sphinx.util.math import get_node_equation_number

SIGNS = (
    "20-7E,A0-B7,D7,2C6-2DD,302-308,391-3F6,2010-2064,210E,2190-21D4,2200-22FF,"
    "2308-230B,239B-23AE,1D400-1D49B,1D5A0-1D5B9,1D6A8-1D755"
)
"""Latin, Greek, signs, and letters of mathematics."""


def mathml(node: nodes.Element, *, as_block: bool) -> str:
    """A formula's element; one that is not understood is a warning, which ends the build."""
    try:
        return str(tex2mathml(node.astext(), as_block=as_block))
    except MathError as error:
        getLogger(__name__).warning("%s: %s", node.astext(), error, location=node)
        return ""


def inline(writer: Any, node: nodes.math) -> None:
    """Write a formula in a line."""
    writer.body.append(mathml(node, as_block=False))
    raise nodes.SkipNode


def block(writer: Any, node: nodes.math_block) -> None:
    """Write a formula of its own, with its number where it has one."""
    writer.body.append(writer.starttag(node, "div", CLASS="math"))
    writer.body.append(mathml(node, as_block=True))
    if node["number"]:
        writer.body.append(f'<span class="eqno">({get_node_equation_number(writer, node)})')
        writer.add_permalink_ref(node, "Link to this equation")
        writer.body.append("</span>")
    writer.body.append("</div>\n")
    raise nodes.SkipNode


def write_font(app: Sphinx, failure: Exception | None) -> None:
    """Write the font beside the pages, where there are any: a second error would hide what the build failed of."""
    if failure:
        return
    wanted = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True)
    with subset.load_font(str(files("ziamath.fonts") / "STIXTwoMath-Regular.ttf"), wanted) as font:
        subsetter = subset.Subsetter(wanted)
        subsetter.populate(unicodes=subset.parse_unicodes(SIGNS))
        subsetter.subset(font)
        subset.save_font(font, str(Path(app.outdir) / "_static" / "math.woff"), wanted)


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx."""
    app.connect("build-finished", write_font)
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
