"""Open a run in ParaView as its pictures show it: ``paraview --script=open_run.py``, or as a macro.

Written beside each series; nothing of runningbond is needed to run it.
"""

from pathlib import Path
from typing import Any

from paraview import simple

FOLDER = Path()
SCALE = 1.0
FARTHEST = 1.0

AT_REST = (0.9, 0.9, 0.9)
FASTEST = (0.5, 0.5, 0.5)
STATES: dict[str, tuple[str, tuple[float, float, float]]] = {}


def moved(kind: str) -> tuple[Any, Any]:
    """A series and its shape, displacements enlarged."""
    beside = Path(globals().get("__file__", FOLDER / "open_run.py")).resolve().with_name(f"{kind}.pvd")
    folder = beside.parent if beside.is_file() else FOLDER
    series = simple.PVDReader(FileName=str(folder / f"{kind}.pvd"))
    shape = simple.WarpByVector(Input=series)
    shape.Vectors = ["POINTS", "displacement [m]"]
    shape.ScaleFactor = SCALE
    return series, shape


view = simple.GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [1.0, 1.0, 1.0]
view.InteractionMode = "2D"
view.OrientationAxesVisibility = 0

built, blocks = moved("blocks")
outline = simple.Show(built, view)
outline.Representation = "Wireframe"
outline.AmbientColor = outline.DiffuseColor = [0.8, 0.8, 0.8]

wall = simple.Show(blocks, view)
wall.Representation = "Surface With Edges"
wall.Position = [0.0, 0.0, 0.001]
simple.ColorBy(wall, ("POINTS", "displacement [m]", "Magnitude"))
simple.GetColorTransferFunction("displacement [m]").RGBPoints = [0.0, *AT_REST, FARTHEST, *FASTEST]
wall.SetScalarBarVisibility(view, True)

_, joints = moved("joints")
lines = simple.Show(joints, view)
lines.Representation = "Surface With Edges"
lines.LineWidth = 3.0
lines.Position = [0.0, 0.0, 0.002]
simple.ColorBy(lines, ("CELLS", "state"))
states = simple.GetColorTransferFunction("state")
states.InterpretValuesAsCategories = 1
states.AnnotationsInitialized = 1
states.Annotations = [text for number, (name, _) in STATES.items() for text in (number, name)]
states.IndexedColors = [part for _, colour in STATES.values() for part in colour]
lines.SetScalarBarVisibility(view, True)

simple.Show(simple.AnnotateTime(), view)
scene = simple.GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToLast()
simple.ResetCamera(view)
simple.Render(view)
