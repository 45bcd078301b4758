"""Pictures of a result folder, drawn from what the folder holds and nothing else."""

import io
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from runningbond.results.store import StoreError, load_outcome, load_scene, write_atomically
from runningbond.scene import Scene

from .mechanisms import mechanism_picture, moment_picture, png, show_mechanism, show_undeformed
from .moment import Shown
from .painting import Colouring, Painter, fill_plotter, look_at
from .series import moments, read_grid
from .vtk_imports import import_pyvista
from .vtk_messages import VtkError

if TYPE_CHECKING:
    from PIL.Image import Image

FILM_DPI = 150
PACE, PAUSE = 150, 2000
"""Milliseconds that a moment of a film lasts, and its last one."""

PICTURES = ("mechanism.png", "last-moment.png", "film.gif")


def forget_pictures(folder: Path) -> None:
    """Take away pictures, which may be of an outcome that is there no more."""
    for name in PICTURES:
        (folder / name).unlink(missing_ok=True)


def draw_mechanism(folder: Path, colouring: Colouring = "displacement") -> list[Path]:
    """Draw ``mechanism.png`` of a folder's outcome, where it has a mechanism.

    Raises
    ------
    StoreError
        If the folder holds no outcome that can be trusted, or not its scene.
    """
    with closing(Painter()) as painter:
        return _draw_mechanism(folder, colouring, painter)


def draw_folder(folder: Path, colouring: Colouring = "displacement") -> list[Path]:
    """Draw what a folder has to show: its mechanism, the last moment of its run, and a film of its time series.

    Returns
    -------
    list of Path
        ``mechanism.png``, ``last-moment.png`` and ``film.gif``, those of them that there are.

    Raises
    ------
    StoreError
        If the folder holds no outcome that can be trusted, or not its scene, or a damaged time series.
    """
    with closing(Painter()) as painter:
        return _draw_mechanism(folder, colouring, painter) + _draw_series(folder, colouring, painter)


def _draw_mechanism(folder: Path, colouring: Colouring, painter: Painter) -> list[Path]:
    outcome, scene = load_outcome(folder)[0], load_scene(folder)
    shown = show_mechanism(scene, outcome, colouring)
    if shown is None:
        return []
    write_atomically(folder / "mechanism.png", png(mechanism_picture(shown, outcome, painter)))
    return [folder / "mechanism.png"]


def _draw_series(folder: Path, colouring: Colouring, painter: Painter) -> list[Path]:
    """Draw the moments of a folder, all from one point of view and to one scale: that of the last."""
    found = _moments(folder, colouring)
    if not found:
        return []
    outcome, last, written = load_outcome(folder)[0], found[-1], []
    view = last.view(painter.pixels)
    if len({shown.multiplier for shown in found}) > 1:  # under one load, it is the mechanism once more
        write_atomically(folder / "last-moment.png", png(moment_picture(last, outcome, painter)))
        written.append(folder / "last-moment.png")
    if len(found) > 1:
        images = []
        for shown in found:
            figure = moment_picture(replace(shown, scale=last.scale), outcome, painter, view, last.states)
            images.append(_image(png(figure, FILM_DPI)))
        write_atomically(folder / "film.gif", _film(images))
        written.append(folder / "film.gif")
    return written


def _moments(folder: Path, colouring: Colouring) -> list[Shown]:
    scene = load_scene(folder)
    pairs = zip(moments(folder, "blocks"), moments(folder, "joints"), strict=False)
    return [_shown(scene, blocks, joints, colouring) for blocks, joints in pairs]


def _shown(scene: Scene, blocks: Path, joints: Path, colouring: Colouring) -> Shown:
    try:
        return Shown.of_grids(scene, read_grid(blocks), read_grid(joints), colouring)
    except (VtkError, ValueError, KeyError, IndexError, AttributeError) as error:
        what = "are damaged or of another wall; another run replaces them"
        raise StoreError(f"{blocks}, {joints.name}: {what}") from error


def view_folder(folder: Path, colouring: Colouring = "displacement") -> None:
    """Show a folder's mechanism, its last moment or its undeformed wall in a window, until that is closed."""
    import_pyvista()
    import pyvista as pv

    outcome, scene = load_outcome(folder)[0], load_scene(folder)
    found = _moments(folder, colouring)
    shown = show_mechanism(scene, outcome, colouring) or (found[-1] if found else show_undeformed(scene))
    plotter: Any = pv.Plotter(title=f"{outcome.scene}: {outcome.model}")
    plotter.set_background("white")
    fill_plotter(plotter, scene, shown.blocks, shown.joints, shown.scale, colouring, 1.5)
    look_at(plotter, shown.view(1000))
    plotter.enable_image_style()
    plotter.show()


def _image(content: bytes) -> "Image":
    from PIL import Image

    return Image.open(io.BytesIO(content)).convert("RGB")


def _film(images: list["Image"]) -> bytes:
    """Images of one size as an animated GIF, with the colours of the last one."""
    from PIL import Image

    palette = images[-1].quantize(128, dither=Image.Dither.NONE)
    frames = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    pace = [PACE] * (len(frames) - 1) + [PAUSE]
    buffer = io.BytesIO()
    frames[0].save(buffer, format="GIF", save_all=True, append_images=frames[1:], duration=pace, loop=0)
    return buffer.getvalue()
