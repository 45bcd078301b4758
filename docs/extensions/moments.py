"""Walls that pages show, drawn while the site is built: as they stand, as they fall, and moment by moment."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from docutils import nodes
from jinja2 import Environment, FileSystemLoader
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import runningbond as rb
from runningbond.compare.page import inline_svg
from runningbond.pictures.flat import figure_of

MOMENTS, DRAWN, ROOT = 24, 0.6, Path(__file__).parents[2]
"""Most moments, and how far the last of them is drawn, in heights of the lowest block."""


class Drawing(SphinxDirective):
    """A wall, a file of this repository or a published one; with a model, its mechanism."""

    required_arguments, optional_arguments = 1, 1

    @property
    def wall(self) -> rb.Wall:
        """The wall, upon whose file the page depends."""
        file = ROOT / self.arguments[0]
        self.env.note_dependency(str(file))
        return rb.read(file if file.exists() else self.arguments[0])

    def run(self) -> list[nodes.Node]:
        """Draw it."""
        scene = self.wall.scene
        outcome = self.wall.run(self.arguments[1]).outcome if len(self.arguments) > 1 else None
        svg = inline_svg(figure_of(scene, outcome), scene.title)
        return [nodes.raw("", f'<figure class="drawing">{svg}</figure>', format="html")]


class Moments(Drawing):
    """A wall and a model that follows a path."""

    required_arguments, optional_arguments = 2, 0

    def run(self) -> list[nodes.Node]:
        """Follow the wall, and keep some moments as a drawing that `moments.js` moves."""
        return [nodes.raw("", page(self.wall.run(self.arguments[1], states=True)), format="html")]


def page(result: rb.Result) -> str:
    """Drawing, curve and slider of a result with states."""
    scene, states = result.wall.scene, result.states
    loads = result.outcome.curve[:, 1] if scene.is_led else [state.multiplier for state in states]
    far = np.array([np.abs(state.motion[:, :2]).max() for state in states])
    chosen = np.unique([int(np.abs(far - x).argmin()) for x in np.linspace(far[0], far.max(), MOMENTS)])
    factor = float(f"{DRAWN * scene.lowest_block / far.max():.1g}")
    (x0, y0), (x1, y1) = scene.blocks.extent(scene.wall)
    margin = 0.06 * max(x1 - x0, y1 - y0) + DRAWN * scene.lowest_block
    blocks = [
        {"points": " ".join(f"{x:.4g},{-y:.4g}" for x, y in scene.blocks.polygon(b)), "at": scene.blocks.centroid[b]}
        for b in range(len(scene.blocks))
    ]
    moments = [
        {
            "load": f"{loads[i]:.4g}",
            "far": f"{1000 * far[i]:.3g}",
            "at": [float(f"{1000 * far[i]:.4g}"), float(f"{loads[i]:.5g}")],
            "motion": [[float(f"{v * factor:.4g}") for v in row] for row in states[i].motion],
        }
        for i in chosen
    ]
    template = Environment(loader=FileSystemLoader(Path(__file__).parent), autoescape=True).get_template("moments.html")
    return template.render(
        result=result,
        blocks=blocks,
        held=scene.fixed,
        factor=factor,
        box=f"{x0 - margin:.4g} {-y1 - margin:.4g} {x1 - x0 + 2 * margin:.4g} {y1 - y0 + 1.5 * margin:.4g}",
        moments=json.dumps(moments),
        count=len(moments),
    )


def setup(app: Sphinx) -> dict[str, Any]:
    """Tell Sphinx."""
    app.add_directive("drawing", Drawing)
    app.add_directive("moments", Moments)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
