"""Open a run in ParaView as its pictures show it: ``paraview --script=open_run.py``, or as a macro.

A copy is written beside each series; it runs without runningbond.
"""

from pathlib import Path
from typing import Any

from paraview import simple

FOLDER = Path()
SCALE = 1.0
FARTHEST = 1.0
TIME = "time"

AT_REST = (0.9, 0.9, 0.9)
FASTEST = (0.5, 0.5, 0.5)
EDGE = (0.5, 0.5, 0.5)
STATES: dict[str, tuple[str, tuple[float, float, float]]] = {}


def moved(kind: str) -> tuple[Any, Any]:
    """Return a series and its deformed shape with enlarged displacements."""
    beside = Path(globals().get("__file__", FOLDER / "open_run.py")).resolve().with_name(f"{kind}.pvd")
    folder = beside.parent if beside.is_file() else FOLDER
    series = simple.PVDReader(FileName=str(folder / f"{kind}.pvd"))
    shape = simple.WarpByVector(Input=series)
    shape.Vectors = ["POINTS", "displacement [m]"]
    shape.ScaleFactor = SCALE
    return series, shape


def shown(shape: Any, height: float) -> Any:
    """Show a shape at a height above the plane, in its own colours, without shading."""
    display = simple.Show(shape, view)
    display.Representation = "Surface"
    display.Ambient, display.Diffuse, display.Specular = 1.0, 0.0, 0.0
    display.Position = [0.0, 0.0, height]
    return display


def outlined(shape: Any, colour: tuple[float, float, float], height: float) -> None:
    """Show the edges of blocks, which are boundary edges because blocks share no points."""
    edges = simple.FeatureEdges(Input=simple.ExtractSurface(Input=shape))
    edges.BoundaryEdges, edges.FeatureEdges, edges.NonManifoldEdges, edges.ManifoldEdges = 1, 0, 0, 0
    display = shown(edges, height)
    simple.ColorBy(display, None)
    display.AmbientColor = display.DiffuseColor = list(colour)


def key(colours: Any, title: str) -> Any:
    """Set up and return the legend of a colour map, with black text."""
    bar = simple.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle = title, ""
    bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
    return bar


view = simple.GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground = 0
view.Background = [1.0, 1.0, 1.0]
view.InteractionMode = "2D"
view.OrientationAxesVisibility = 0

built, blocks = moved("blocks")
outlined(built, (0.8, 0.8, 0.8), 0.0)
wall = shown(blocks, 0.001)
simple.ColorBy(wall, ("POINTS", "displacement [m]", "Magnitude"))
displacement = simple.GetColorTransferFunction("displacement [m]")
displacement.ColorSpace = "RGB"
displacement.RGBPoints = [0.0, *AT_REST, FARTHEST, *FASTEST]
wall.SetScalarBarVisibility(view, True)
key(displacement, "displacement [m]")
outlined(blocks, EDGE, 0.002)

lines = shown(moved("joints")[1], 0.003)
lines.LineWidth = 3.0
simple.ColorBy(lines, ("CELLS", "state"))
states = simple.GetColorTransferFunction("state")
states.InterpretValuesAsCategories = 1
states.AnnotationsInitialized = 1
states.Annotations = [text for number, (name, _) in STATES.items() for text in (number, name)]
states.IndexedColors = [part for _, colour in STATES.values() for part in colour]
lines.SetScalarBarVisibility(view, True)
key(states, "joints")

clock = simple.AnnotateTime()
clock.Format = f"{TIME} = {{time:.5g}}"
simple.Show(clock, view).Color = [0.0, 0.0, 0.0]
scene = simple.GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.GoToLast()
simple.ResetCamera(view)
simple.Render(view)
