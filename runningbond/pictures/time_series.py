"""Time series for ParaView: one VTU file per frame and a PVD file that lists them, readable after every frame."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from runningbond.results.store import StoreError, write_atomically

from .deformed_shape import series_scale
from .frame import Discretisation, Frame
from .style import AT_REST, CRUSHED, EDGE, FASTEST, OUTLINE, STATE_COLOURS, STATE_NAMES
from .vtk_grids import DISPLACEMENT, Grid, GridBuilder
from .vtk_safety import import_pyvista, vtk_errors_raised

KINDS = ("blocks", "joints")
"""Parts of a series: ``blocks.pvd`` and ``joints.pvd``, each with its own VTU files."""

MACRO = "open_run.py"
"""File name of the macro with which ParaView opens a series as pictures show it."""

MAX_FRAMES = 40
"""Largest number of frames in a series; beyond it, the frames closest to their neighbours are deleted."""


class TimeSeries:
    """Frames of one wall in order of arrival; the first one replaces any earlier series in the folder.

    The folder holds ``blocks.pvd``, ``joints.pvd`` and a folder ``frames`` with the VTU files.
    """

    def __init__(self, discretisation: Discretisation, folder: Path) -> None:
        self._grids = GridBuilder(discretisation)
        self._folder = folder
        self._frames: dict[int, tuple[float | None, float]] = {}  # time [s] and load by frame number
        self._next = 0
        self._farthest, self._size = 0.0, discretisation.scene.size
        self._is_started = False

    def __len__(self) -> int:
        return len(self._frames)

    def clear(self) -> None:
        """Delete all frames, including those of an earlier series."""
        self._frames, self._next, self._is_started, self._farthest = {}, 0, True, 0.0
        (self._folder / MACRO).unlink(missing_ok=True)
        for kind in KINDS:
            (self._folder / f"{kind}.pvd").unlink(missing_ok=True)
            for stale in (self._folder / "frames").glob(f"{kind}-*.vtu"):
                stale.unlink()

    def add(self, frame: Frame) -> None:
        """Write a frame; the series is readable before and after."""
        if not self._is_started:
            self.clear()
        grids = {"blocks": self._grids.blocks(frame), "joints": self._grids.joints(frame)}
        for kind, grid in grids.items():
            write_atomically(self._file(kind, self._next), vtu(grid))
        self._frames[self._next] = frame.time, frame.multiplier
        moved = np.asarray(grids["blocks"].point_data[DISPLACEMENT])
        self._farthest = max(self._farthest, float(np.hypot(*moved.T[:2]).max()))
        self._next += 1
        dropped = [self._nearest()] if len(self._frames) > MAX_FRAMES else []
        lost = [number for number in self._frames if not all(self._file(kind, number).exists() for kind in KINDS)]
        for number in {*dropped, *lost}:  # frames are lost if the folder is deleted during a run
            del self._frames[number]
        times = times_shown(list(self._frames.values()))
        for kind in KINDS:
            files = [(time, self._file(kind, number)) for time, number in zip(times, self._frames, strict=True)]
            write_atomically(self._folder / f"{kind}.pvd", _pvd(files, self._folder))
            for number in dropped:
                self._file(kind, number).unlink(missing_ok=True)  # another run into this folder may have deleted it

    def _nearest(self) -> int:
        """Number of the frame to delete: the one with the nearest neighbours by number, but not the largest load."""
        numbers = list(self._frames)
        largest = max(numbers, key=lambda number: self._frames[number][1])
        between = {
            number: after - before
            for before, number, after in zip(numbers, numbers[1:], numbers[2:], strict=False)
            if number != largest
        }
        return min(between, key=between.__getitem__)

    def write_macro(self) -> None:
        """Write the macro with which ParaView opens the series, enlarged like pictures of its largest motion."""
        from matplotlib.colors import to_rgb

        scale = series_scale(self._size, self._farthest)
        states = {
            str(int(state)): (name, to_rgb(STATE_COLOURS.get(state, CRUSHED))) for state, name in STATE_NAMES.items()
        }
        given = {"FOLDER": f"Path({str(self._folder.resolve())!r})", "SCALE": scale, "FARTHEST": self._farthest or 1.0}
        frames = list(self._frames.values())
        seconds, shown = frames[0][0] is not None, times_shown(frames)
        what = (
            "t [s]" if seconds else "load" if np.allclose(shown, [load for _, load in frames], rtol=1e-3) else "moment"
        )
        given["TIME"] = repr(what)
        given |= {"AT_REST": AT_REST, "FASTEST": FASTEST, "EDGE": EDGE, "STATES": {"0": ("sticks", OUTLINE), **states}}
        text = Path(__file__).with_name(MACRO).read_text(encoding="utf-8")
        for name, value in given.items():
            literal = str(value).replace("\\", r"\\")
            text = re.sub(rf"(?m)^({name}.*?) = .*$", rf"\1 = {literal}", text)
        write_atomically(self._folder / MACRO, text.encode())

    def _file(self, kind: str, number: int) -> Path:
        return self._folder / "frames" / f"{kind}-{number:04d}.vtu"


def times_shown(frames: Sequence[tuple[float | None, float]]) -> list[float]:
    """Increasing times under which frames are listed, from their times [s] and loads.

    These are the times in seconds, if known, or the loads, if they never decrease; frames at the same load, as in a
    fall, are each later by a millionth of the load range. If loads decrease or stay constant, frame indices are used.
    """
    seconds = [time for time, _ in frames if time is not None]
    if len(seconds) == len(frames):
        return seconds
    loads = [load for _, load in frames]
    range_ = loads[-1] - loads[0]
    if range_ <= 0 or any(after < before for before, after in pairwise(loads)):
        return [float(k) for k in range(len(frames))]
    times = loads[:1]
    for load in loads[1:]:
        times.append(max(load, times[-1] + 1e-6 * range_))
    return times


def frame_files(folder: Path, kind: str) -> list[Path]:
    """VTU files listed in a folder's ``blocks.pvd`` or ``joints.pvd``, in order; none if there is no such list.

    A damaged list raises a `StoreError`.
    """
    path = folder / f"{kind}.pvd"
    if not path.is_file():
        return []
    try:
        return [folder / entry.attrib["file"] for entry in ET.parse(path).getroot().iter("DataSet")]
    except (ET.ParseError, KeyError) as error:
        raise StoreError(f"{path}: is damaged: {error}") from error


def read_grid(path: Path) -> Grid:
    """Read a VTU file."""
    pv = import_pyvista("UnstructuredGrid")
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader: Any = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    with vtk_errors_raised():
        reader.Update()
    return pv.wrap(reader.GetOutput())


def vtu(grid: Grid) -> bytes:
    """A grid as the content of a VTU file."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer: Any = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()
    writer.SetCompressionLevel(1)
    writer.WriteToOutputStringOn()
    with vtk_errors_raised():
        writer.Write()
    return str(writer.GetOutputString()).encode()


def _pvd(files: list[tuple[float, Path]], folder: Path) -> bytes:
    root = ET.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ET.SubElement(root, "Collection")
    for time, path in files:
        name = path.relative_to(folder).as_posix()
        ET.SubElement(collection, "DataSet", timestep=repr(float(time)), part="0", file=name)
    ET.indent(root)
    content: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return content
