"""Pictures of a result folder, drawn only from what the folder contains."""

import io
from collections.abc import Iterable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from runningbond.results.store import (
    StoreError,
    holds_response,
    load_outcome,
    load_response_summary,
    load_scene,
    write_atomically,
)
from runningbond.scene import Indices, Scene

from .captions import to_png, to_svg
from .deformed_shape import DeformedShape, farthest_motion, series_scale, undeformed_shape
from .flat import figure_of
from .mechanism import has_mechanism, mechanism_shape
from .pyvista_figure import frame_figure, mechanism_figure
from .pyvista_painter import Painter, fill_plotter, look_at
from .style import Colouring
from .time_series import frame_files, read_grid
from .vtk_grids import shape_of_grids
from .vtk_safety import VtkError, import_pyvista

FILM_DPI = 150
FRAME_TIME, LAST_FRAME_TIME = 150, 2000
"""Time for which a frame of a film is shown, and its last frame [ms]."""

EXACT_COLOURS = 160
"""Number of GIF colours kept exactly as drawn; all other shades of a film share the rest of the palette."""

PACKED = np.array([256**2, 256, 1])
"""Weights that pack the red, green and blue of a colour into one number."""

VECTOR = {".svg": to_svg, ".png": to_png}
"""Writers of flat drawings, by file ending."""

DRAWINGS = tuple(f"mechanism{ending}" for ending in VECTOR)
"""File names of the drawings of a mechanism."""

PICTURES = (*DRAWINGS, "rendering.png", "last-moment.png", "film.gif")
"""File names of all pictures of a folder with a mechanism or a time series."""


def draw_folder(folder: Path) -> list[Path]:
    """Draw a folder's mechanism, if any, as ``mechanism.svg`` and ``mechanism.png``, and return these files."""
    if holds_response(folder):
        return []
    outcome, scene = load_outcome(folder)[0], load_scene(folder)
    if not has_mechanism(scene, outcome):
        return []
    figure = figure_of(scene, outcome)
    for name, write in zip(DRAWINGS, VECTOR.values(), strict=True):
        write_atomically(folder / name, write(figure))
    return [folder / name for name in DRAWINGS]


def render_folder(folder: Path, colouring: Colouring = "displacement") -> list[Path]:
    """Paint a folder's mechanism, and the last moment and a film of its time series.

    Return the files that were written: ``rendering.png``, ``last-moment.png`` and ``film.gif``. A response has no
    mechanism, and its last moment is in its chart.

    Raises
    ------
    StoreError
        If the folder contains no undamaged outcome or response, or no scene, or a damaged time series.
    """
    scene, written = load_scene(folder), list[Path]()
    with closing(Painter()) as painter:
        if holds_response(folder):
            said = load_response_summary(folder)
            return _render_series(folder, scene, said["scene"], said["model"], colouring, painter)
        outcome = load_outcome(folder)[0]
        if has_mechanism(scene, outcome):
            figure = mechanism_figure(scene, outcome, painter, colouring)
            write_atomically(folder / "rendering.png", to_png(figure))
            written.append(folder / "rendering.png")
        return written + _render_series(folder, scene, outcome.scene, outcome.model, colouring, painter)


def _render_series(
    folder: Path, scene: Scene, title: str, model: str, colouring: Colouring, painter: Painter
) -> list[Path]:
    """Draw the last moment of a folder, and a film with one view and one scale, that of the largest motion."""
    shapes = _shapes(folder, scene, colouring)
    if not shapes:
        return []
    last, written = shapes[-1], []
    if len({shape.multiplier for shape in shapes}) > 1:  # under a single load it would repeat the mechanism
        write_atomically(folder / "last-moment.png", to_png(frame_figure(last, title, model, painter)))
        written.append(folder / "last-moment.png")
    if len(shapes) > 1:
        farthest = max(farthest_motion(shape.displacement) for shape in shapes)
        scale = series_scale(last.scene.size, farthest)
        shapes = [replace(shape, scale=scale) for shape in shapes]
        figures = (frame_figure(shape, title, model, painter, tuple(shapes)) for shape in shapes)
        write_atomically(folder / "film.gif", _film(to_png(figure, FILM_DPI) for figure in figures))
        written.append(folder / "film.gif")
    return written


def _shapes(folder: Path, scene: Scene, colouring: Colouring) -> list[DeformedShape]:
    shapes = []
    for blocks, joints in zip(frame_files(folder, "blocks"), frame_files(folder, "joints"), strict=False):
        try:
            shape = shape_of_grids(scene, read_grid(blocks), read_grid(joints))
        except (VtkError, ValueError, KeyError, IndexError, AttributeError) as error:
            what = "are damaged or of another wall; another run replaces them"
            raise StoreError(f"{blocks}, {joints.name}: {what}") from error
        shapes.append(replace(shape, colouring=colouring))
    return shapes


def view_folder(folder: Path, colouring: Colouring = "displacement") -> None:
    """Show a folder's mechanism, else its last moment or undeformed wall, in a window until it is closed."""
    pv = import_pyvista("Plotter")
    scene = load_scene(folder)
    outcome = None if holds_response(folder) else load_outcome(folder)[0]
    shape = outcome and mechanism_shape(scene, outcome)
    shape = shape or [undeformed_shape(scene), *_shapes(folder, scene, colouring)][-1]
    said = load_response_summary(folder) if outcome is None else outcome.summary()
    plotter: Any = pv.Plotter(title=f"{said['scene']}: {said['model']}")
    plotter.set_background("white")
    fill_plotter(plotter, replace(shape, colouring=colouring), 1.5)
    look_at(plotter, shape.extent)
    plotter.enable_image_style()
    plotter.show()


def _film(contents: Iterable[bytes]) -> bytes:
    """Convert PNG files of one size into an animated GIF with a common palette.

    The most frequent colours are in the palette unchanged, so that things drawn in one colour keep it, however small.
    """
    from PIL import Image

    images = [np.asarray(Image.open(io.BytesIO(content)).convert("RGB")) @ PACKED for content in contents]
    colours, count = np.unique(np.concatenate([image[::3, ::3].ravel() for image in images]), return_counts=True)
    often, rare = np.split(_unpacked(colours[np.argsort(-count, kind="stable")]), [EXACT_COLOURS])
    palette = often.tolist()
    if len(rare):
        shades = Image.fromarray(rare[None]).quantize(256 - len(often)).getpalette() or []
        palette += np.reshape(shades, (-1, 3)).tolist()
    nearest, frames = cKDTree(palette), []
    for image in images:
        seen, which = np.unique(image, return_inverse=True)
        number = np.asarray(nearest.query(_unpacked(seen))[1], dtype=np.uint8)
        frame = Image.fromarray(number[which].reshape(image.shape))
        frame.putpalette(np.ravel(palette).tolist())
        frames.append(frame)
    times = [FRAME_TIME] * (len(frames) - 1) + [LAST_FRAME_TIME]
    buffer = io.BytesIO()
    frames[0].save(buffer, format="GIF", save_all=True, append_images=frames[1:], duration=times, loop=0)
    return buffer.getvalue()


def _unpacked(colours: Indices) -> NDArray[np.uint8]:
    """Red, green and blue ``(n, 3)`` of colours that were packed with `PACKED`."""
    return np.asarray(colours[:, None] // PACKED % 256, dtype=np.uint8)
