"""Charts and plates: axes of curves, brackets without a collapse, rows of walls of any shape."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import same_color
from matplotlib.figure import Figure
from matplotlib.text import Annotation

from runningbond.pictures.charts import LOOKS, bracket, looks_of
from runningbond.pictures.curve import curve_figure
from runningbond.pictures.deformed_shape import undeformed_shape
from runningbond.pictures.plate import PlateRow, plate_figure
from runningbond.results import Outcome
from runningbond.scene import Array, scene_from_dict
from tests.walls import panel

from .scenes import settling_portal, wall


def curve(moved: Array, load: Array) -> Figure:
    """The chart of a pushover curve [m]."""
    return curve_figure(panel(), Outcome("wall", "dem-static", "collapse", 1.0, curve=np.column_stack([moved, load])))


def test_displacement_axis_is_logarithmic_if_elastic_range_is_tiny() -> None:
    load = np.array([0.0, 0.9, 1.0, 1.0])
    assert curve(np.array([0.0, 1e-5, 1e-3, 1e-2]), load).axes[0].get_xscale() == "symlog"
    assert curve(np.array([0.0, 1e-3, 2e-3, 1e-2]), load).axes[0].get_xscale() == "linear"


def test_linear_part_does_not_grow_with_the_load_steps() -> None:
    """Half the peak lies at 0.021 mm, between two states; the second one would make the axis linear up to 1 mm."""
    figure = curve(1e-3 * np.array([0.0, 0.01, 0.11, 0.2, 6.0]), np.array([0.0, 0.44, 0.95, 0.98, 1.0]))
    (linear,) = (float(one.xy[0]) for one in figure.axes[0].findobj(Annotation) if one.get_text() == "linear")
    assert linear == pytest.approx(0.1)


def test_cyclic_curve_has_linear_axes_with_whole_curve() -> None:
    figure = curve(1e-3 * np.array([0.0, 0.01, 1.0, -1.0, 1.0]), np.array([0.0, 0.9, 1.0, -1.0, 1.0]))
    axes = figure.axes[0]
    assert axes.get_xscale() == "linear"
    assert axes.get_ylim()[0] < -1.05


@pytest.mark.parametrize(("share", "least"), [(0.13, 0.13), (0.0, 0.0), (-0.17, -0.17), (0.13, 0.12), (0.13, 0.07)])
def test_settlement_label_hides_neither_curve_nor_axis(share: float, least: float) -> None:
    """It lies below bracket and curve, whose states may lie on the lower bound or below it, and above the axis."""
    loads = np.array([0.25, least, least, share])
    outcome = Outcome("wall", "dem-static", "collapse", share, share, share + 0.01)
    outcome = replace(outcome, curve=np.column_stack([[0.0, 1e-4, 1e-3, 1e-2], loads]))
    figure = curve_figure(scene_from_dict(settling_portal()), outcome)
    figure.draw_without_rendering()
    axes = figure.axes[0]
    label = axes.texts[0].get_window_extent()
    radius = axes.lines[-1].get_markersize() / 2 * figure.dpi / 72
    assert label.y1 < axes.transData.transform((0.0, least))[1] - radius
    assert label.y0 > axes.get_window_extent().y0


@pytest.mark.parametrize(("rests", "named"), [([1, 0, 0, 0], []), ([1, 1, 1, 0], ["at rest", "falls"])])
def test_wall_that_is_driven_does_not_fall_all_the_way(rests: list[int], named: list[str]) -> None:
    """It rests under the dead load and then moves with the drive: one line, not a fall from the first row on."""
    moved, load = np.array([0.0, 1e-3, 2e-3, 3e-3]), np.array([0.0, 1.0, 1.1, 1.1])
    outcome = Outcome("wall", "dem-dynamic", "collapse", 1.1, curve=np.column_stack([moved, load]))
    outcome = replace(outcome, path=np.array(rests, dtype=float)[:, None], path_columns=("at rest",))
    axes = curve_figure(panel(), outcome).axes[0]
    legend = axes.get_legend()
    assert ([] if legend is None else [text.get_text() for text in legend.get_texts()]) == named
    assert any(np.size(line.get_xdata()) == 4 for line in axes.lines) == (not named)


@pytest.mark.parametrize(("status", "inside"), [("collapse", "red"), ("undecided", "white")])
def test_bracket_without_collapse_is_hollow(status: str, inside: str) -> None:
    axes = Figure().add_subplot()
    bracket(axes, 1.0, {"status": status, "λ lower": 0.2, "λ upper": 0.4}, "red")
    last = axes.lines[-1]
    assert same_color(last.get_color(), inside)
    assert axes.lines[0].get_linewidth() == (4 if status == "collapse" else 2 * last.get_linewidth())


def test_looks_of_many_names_differ() -> None:
    """The sixth and later names used to be left out."""
    names = [f"wall {k}" for k in range(25)]
    looks = looks_of(names)
    assert list(looks) == names
    assert len(set(looks.values())) == 25
    assert looks_of(names[:5]) == dict(zip(names, LOOKS, strict=False))


def test_texts_of_plate_do_not_overlap() -> None:
    """A row is neither so low that its label overlaps the captions, nor so high that the others have no space."""
    sizes = {"garden wall": (24.0, 0.5), "chimney": (1.0, 24.0), "panel": (2.0, 1.0)}
    scenes = {name: scene_from_dict(wall(*size)) for name, size in sizes.items()}
    rows = [PlateRow(name, [undeformed_shape(scene)], ["λ = 0.6000"]) for name, scene in scenes.items()]
    figure = plate_figure("Mechanisms", ["limit"], rows)
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for axes in figure.axes for text in (*axes.texts, axes.title) if text.get_text()]
    for one, other in combinations(boxes, 2):
        assert min(min(one.x1, other.x1) - max(one.x0, other.x0), min(one.y1, other.y1) - max(one.y0, other.y0)) <= 0
    low, high = (figure.axes[k].get_position().height for k in (0, 1))
    assert high <= 10.01 * low
