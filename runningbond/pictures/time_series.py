"""Time series for ParaView: a VTU file a frame, and a PVD file that lists them, readable after every frame."""

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

from runningbond.results.store import StoreError, write_atomically

from .frame import Discretisation, Frame
from .vtk_grids import Grid, GridBuilder
from .vtk_safety import import_pyvista, vtk_errors_raised

KINDS = ("blocks", "joints")
"""What a series consists of: ``blocks.pvd`` and ``joints.pvd``, each with its own VTU files."""

MAX_FRAMES = 40
"""Frames that a series keeps; when there are more, every other one is deleted."""


class TimeSeries:
    """Frames of one wall, in the order in which they come; the first replaces what was there before.

    Its folder holds ``blocks.pvd``, ``joints.pvd`` and a folder ``frames`` with the VTU files.
    """

    def __init__(self, discretisation: Discretisation, folder: Path) -> None:
        self._grids = GridBuilder(discretisation)
        self._folder = folder
        self._numbers: list[int] = []
        self._next = 0
        self._is_started = False

    def __len__(self) -> int:
        return len(self._numbers)

    def clear(self) -> None:
        """Delete all frames, also those that were there before."""
        self._numbers, self._next, self._is_started = [], 0, True
        for kind in KINDS:
            (self._folder / f"{kind}.pvd").unlink(missing_ok=True)
            for stale in (self._folder / "frames").glob(f"{kind}-*.vtu"):
                stale.unlink()

    def add(self, frame: Frame) -> None:
        """Write a frame; the series can be read before and after."""
        if not self._is_started:
            self.clear()
        grids = {"blocks": self._grids.blocks(frame), "joints": self._grids.joints(frame)}
        for kind, grid in grids.items():
            write_atomically(self._file(kind, self._next), vtu(grid))
        self._numbers.append(self._next)
        self._next += 1
        dropped = self._numbers[1:-1:2] if len(self._numbers) > MAX_FRAMES else []
        self._numbers = [number for number in self._numbers if number not in dropped]
        for kind in KINDS:
            files = [(number, self._file(kind, number)) for number in self._numbers]
            write_atomically(self._folder / f"{kind}.pvd", _pvd(files, self._folder))
            for number in dropped:
                self._file(kind, number).unlink(missing_ok=True)  # of another run into the same folder

    def _file(self, kind: str, number: int) -> Path:
        return self._folder / "frames" / f"{kind}-{number:04d}.vtu"


def frame_files(folder: Path, kind: str) -> list[Path]:
    """VTU files that a folder's ``blocks.pvd`` or ``joints.pvd`` lists, in order; none where there is no such file.

    A list that is damaged is a `StoreError`.
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


def _pvd(files: list[tuple[int, Path]], folder: Path) -> bytes:
    root = ET.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ET.SubElement(root, "Collection")
    for number, path in files:
        name = path.relative_to(folder).as_posix()
        ET.SubElement(collection, "DataSet", timestep=str(float(number)), part="0", file=name)
    ET.indent(root)
    content: bytes = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return content
