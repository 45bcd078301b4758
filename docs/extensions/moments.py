"""Walls that pages show, drawn while the site is built: as they stand, as they fall, and moment by moment."""

from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import runningbond as rb
from runningbond.compare.page import inline_svg, templates
from runningbond.pictures.deformed_shape import common_extent, undeformed_shape
from runningbond.pictures.flat import figure_of
from runningbond.pictures.inline import inline_wall
from runningbond.pictures.moments import farthest_shape, moving_wall, with_moments

MOMENTS, ROOT = 24, Path(__file__).parents[2]


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
        """Follow the wall, and keep some moments under a slider, as reports of comparisons do."""
        result = self.wall.run(self.arguments[1], states=True)
        outcome = with_moments(result.wall.scene, result.outcome, result.states, MOMENTS)
        scene, name = result.wall.scene, f"wall-{self.env.new_serialno('wall')}"
        extent = common_extent([undeformed_shape(scene), farthest_shape(scene, outcome)])
        parts: Any = templates().get_template("parts.html").module
        moving = parts.moments([moving_wall(scene, outcome, extent, name)])
        return [nodes.raw("", inline_wall(scene, extent, name) + str(moving), format="html")]


def setup(app: Sphinx) -> dict[str, Any]:
    """Tell Sphinx."""
    app.add_directive("drawing", Drawing)
    app.add_directive("moments", Moments)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
