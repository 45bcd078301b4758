"""A wall in Python: the tables of a scene file, with the same checks; changed by copies, run and drawn."""

from collections.abc import Mapping, Sequence
from functools import cached_property, reduce
from hashlib import sha256
from operator import getitem
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from numpy.typing import NDArray

from .descriptions import as_in_a_file, keys_of_name, merge, merge_changes
from .likely_slips import warn_of_likely_slips
from .scene import Scene, SceneError, read_description, scene_from_dict
from .scene.errors import abbreviated
from .scene.ranges import path_of, suggestion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .compare.advice import Advice
    from .draws import Draws
    from .models import Model
    from .pictures.response import DrawnResponse
    from .run_result import Result

TABLES = {
    "block": ("density", "young", "poisson"),
    "joint": (
        *("friction", "friction_angle", "cohesion", "tensile_strength", "mortar", "normal_stiffness"),
        *("shear_stiffness", "inset", "fracture_energy_1", "fracture_energy_2", "softening", "law"),
        *("compressive_strength", "compressive_fracture_energy", "cap_shear", "peak_closure", "closure"),
    ),
    "load": ("gravity", "live", "dead", "history"),
}
"""Keys of a scene file's tables that the constructors of `Wall` take as separate keywords."""

TABLE_OF = {key: table for table, keys in TABLES.items() for key in keys}
"""The table of each of them."""

TOP_LEVEL = (
    "title",
    "wall",
    "block",
    "joint",
    "inner_joint",
    "support",
    "load",
    "beam",
    "materials",
    "joints",
    "assign",
    "tie",
)
"""Keys at the top level of a scene file, which are given as whole tables or values."""

DEFAULTS: dict[str, Any] = {
    "block": {},
    "joint": {},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}
"""Support and loads of a wall built in Python unless others are given."""


class Wall:
    """A wall with its joints, support and loads, ready to be run.

    Parameters
    ----------
    description
        The contents of a scene file as nested dictionaries (docs/scene-file.md). Tuples and arrays count as lists. In
        place of the name of a load or of a joint law, a Python object may be given.
    folder
        Folder that relative paths of drawings and records refer to.

    Raises
    ------
    SceneError
        If the description is not a valid wall: one line that names the key, the value and what is right.
    """

    def __init__(self, description: Mapping[str, Any], folder: str | Path = ".") -> None:
        if not isinstance(description, Mapping):
            raise SceneError("description", "must be a mapping of the tables of a scene file", description)
        self._description: dict[str, Any] = as_in_a_file(description)
        self.folder = path_of("folder", folder).absolute()  # the current folder may change later
        self.scene  # noqa: B018 - built at once, so that errors are raised where the description is written
        self._digests = {key: _digest(file) for key, file in self._files().items()}

    @classmethod
    def from_dict(cls, description: Mapping[str, Any], folder: str | Path = ".") -> "Wall":
        """Build a wall from nested dictionaries with the contents of a scene file."""
        return cls(description, folder)

    @classmethod
    def running_bond(
        cls,
        *,
        length: float,
        height: float | None = None,
        block_width: float,
        block_height: float | None = None,
        thickness: float,
        **keys: Any,
    ) -> "Wall":
        """Build a panel of running bond.

        Parameters
        ----------
        length, height
            Size of the panel [m]: whole half blocks long, whole blocks high.
        block_width, block_height, thickness
            Size of a block [m].
        keys
            Other keys of a scene file: those of ``[block]``, ``[joint]`` and ``[load]`` by their names (``density``
            [kg/m³], ``young`` [Pa], ``friction``, and ``normal_stiffness`` and ``shear_stiffness`` [Pa/m] or
            ``mortar``); those of ``[wall]`` by ``first_course``, ``ends``, ``opening`` (a list of tables) and
            ``course_heights`` (in place of `height` and `block_height`); whole tables and top-level keys
            (``title="…", joint={"inset": 0.01}``); a ``support`` or a ``live`` load without further keys by its
            kind (``support="corners"``). Defaults: gravity 9.81 m/s², the ground as support, a lateral live
            load.

        Examples
        --------
        >>> size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2}
        >>> wall = Wall.running_bond(length=1.6, height=1.2, **size, density=1800.0, friction=0.6)
        >>> wall
        <Wall 'running bond': 27 blocks, 1.6 × 1.2 m>
        >>> print(f"{wall.run('limit').multiplier:.4f}")
        0.5838
        """
        block = {"block_width": block_width, "block_height": block_height, "thickness": thickness}
        return cls._built("running bond", {"length": length, "height": height, **block}, keys)

    @classmethod
    def courses(
        cls,
        courses: Sequence[Sequence[float]],
        *,
        block_width: float,
        block_height: float | None = None,
        thickness: float,
        **keys: Any,
    ) -> "Wall":
        """Build a wall course by course, with the other parameters of `running_bond`.

        Parameters
        ----------
        courses
            From bottom to top; each a list of widths from left to right in units of `block_width`, negative for an
            opening.
        block_width, block_height, thickness, keys
            As in `running_bond`.
        """
        block = {"block_width": block_width, "block_height": block_height, "thickness": thickness}
        return cls._built("courses", {"courses": courses, **block}, keys)

    @classmethod
    def outlines(
        cls,
        outlines: Sequence[Any] | NDArray[Any],
        ground: Sequence[Any] | NDArray[Any] | None = None,
        *,
        thickness: float,
        units: str = "m",
        expand: float | None = None,
        heal: float | None = None,
        **keys: Any,
    ) -> "Wall":
        """Build a wall from the outlines of its stones, with the keys of `running_bond`.

        Parameters
        ----------
        outlines
            Simple polygons, each with the corners of one stone, ``(n, 2)``; blocks are numbered in this order.
        ground
            Polygons of the ground. If none are given and the support needs ground, a flat strip is added under the
            lowest stones.
        thickness
            Thickness of the wall [m].
        units
            Unit of the corners: ``"mm"``, ``"cm"``, ``"m"``, ``"in"`` or ``"ft"``.
        expand
            Width of the widest mortar joint [m], for stones drawn with the mortar between them: each stone is
            extended to the middle of its joints.
        heal
            Largest gap or overlap that is closed [m].
        keys
            As in `running_bond`.

        Examples
        --------
        >>> arch = [[(0, 0), (1, 0), (1, 0.4), (-0.15, 0.4)], [(2, 0), (1, 0), (1, 0.4), (2.15, 0.4)]]
        >>> left = [(-1, -1), (0, -1), (0, 0), (-0.15, 0.4), (-1, 0.4)]
        >>> sides = [left, [(2 - x, y) for x, y in left]]
        >>> Wall.outlines(arch, sides, thickness=0.2, density=2000.0, friction=0.8)
        <Wall 'outlines': 2 blocks, 2.3 × 0.4 m>
        """
        given = {"outlines": outlines, "ground": ground, "thickness": thickness, "expand": expand, "heal": heal}
        return cls._built("outlines", {**given, "units": None if units == "m" else units}, keys)

    @classmethod
    def _built(cls, title: str, wall: dict[str, Any], keys: dict[str, Any]) -> "Wall":
        table_of = TABLE_OF | dict.fromkeys(("first_course", "ends", "course_heights", "opening"), "wall")
        tables: list[dict[str, Any]] = []
        for key, value in keys.items():
            if key not in table_of and key not in TOP_LEVEL:
                raise SceneError(key, f"is not a key of a wall{suggestion(key, [*table_of, *TOP_LEVEL])}", value)
            named = {"kind": value} if key in ("support", "live") and isinstance(value, str) else value
            tables.append({table_of[key]: {key: named}} if key in table_of else {key: named})
        given = {"wall": {key: value for key, value in wall.items() if value is not None}}
        description = merge_changes({"title": title, "wall": {}, **DEFAULTS}, [given, *tables])
        beam, load = (description.get(name) for name in ("beam", "load"))
        is_moved = (isinstance(beam, Mapping) and "drive" in beam) or (isinstance(load, Mapping) and "history" in load)
        if is_moved and not any("live" in named for table in tables if isinstance(named := table.get("load"), Mapping)):
            description = merge(description, {"load": {"live": None}})
        return cls(description)

    def with_(self, changes: Mapping[str, Any] | None = None, /, **tables: Any) -> "Wall":
        """Return a copy with some keys changed and everything checked again.

        Parameters
        ----------
        changes
            Values by the full names of keys: ``{"joint.friction": 0.7, "tie[0].yield": 5e4}``. None removes a key.
        tables
            Keys by table: ``joint={"friction": 0.7}``. Tables are merged with the existing ones, except that a table
            with a ``kind`` replaces the old one.

        Examples
        --------
        >>> read("wall-w1").with_({"joint.friction": 0.4}).run("limit").status
        'collapse'
        >>> read("wall-w1").with_({"joint.friktion": 0.4})
        Traceback (most recent call last):
            ...
        runningbond.scene.errors.SceneError: joint.friktion = 0.4: is not a key of [joint]; did you mean "friction"?
        """
        nested_changes: list[dict[str, Any]] = []
        if not isinstance(changes, Mapping | None):
            raise SceneError("with_", 'takes values by the full names of keys, {"joint.friction": 0.7}', changes)
        for name, value in (changes or {}).items():
            path = keys_of_name(name, self._description) if isinstance(name, str) else [""]
            if "" in path:
                raise SceneError("with_", 'takes keys by their full names, "joint.friction"', name)
            _check_has_its_table(name, value)
            nested = value
            for part in reversed(path):
                nested = {part: nested}
            nested_changes.append(nested)
        for name, value in tables.items():
            full_name = name.replace("__", ".")
            if "." in full_name:
                raise SceneError(name, f'is within a table; give it as {{"{full_name}": {abbreviated(value)}}}', value)
            _check_has_its_table(name, value)
        copy = Wall(merge_changes(self._description, [*nested_changes, tables]), self.folder)
        shared = self._files().items() & copy._files().items()
        self._check_unchanged({key: (file, copy._digests[key]) for key, file in shared})
        return copy

    def _check_unchanged(self, files: Mapping[str, tuple[Path, bytes | None]]) -> None:
        """Refuse files, by their keys with their digests, by which other walls than this one would be described."""
        for key, (file, digest) in files.items():
            if digest != self._digests[key]:
                raise SceneError(key, "has changed since the wall was read from it; read the wall again", file.name)

    def _files(self) -> dict[str, Path]:
        """The drawing and the record that the wall is read from, by their keys."""
        wall, history = self._description["wall"], self._description["load"].get("history", {})
        named = {"wall.drawing": wall.get("drawing"), "load.history.file": history.get("file")}
        return {key: self.folder / name for key, name in named.items() if name is not None}

    @property
    def description(self) -> dict[str, Any]:
        """A copy of the contents of the scene file, as nested dictionaries."""
        copy: dict[str, Any] = as_in_a_file(self._description)
        return copy

    @cached_property
    def scene(self) -> Scene:
        """The input of the models: blocks, joints, materials, support and loads."""
        return scene_from_dict(self.description, folder=self.folder)

    def run(
        self, model: "str | Model", *, tolerance: float = 0.01, states: bool = False, **parameters: Any
    ) -> "Result":
        """Find the collapse of the wall.

        Parameters
        ----------
        model
            Name of a model, for example ``"limit"`` or ``"dem-static"``, or a user-defined `Model`.
        tolerance
            Requested relative width of the bracket.
        states
            Whether to collect the states along the load path, for `Result.states`.
        parameters
            Parameters of the model, by their names.

        Raises
        ------
        SceneError
            If the model is unknown or does not apply to the wall.
        """
        from .run_result import run_wall

        return run_wall(self, model, tolerance, states, parameters)

    def draws(
        self,
        model: "str | Model",
        number: int,
        *,
        scatter: str = "bits",
        tolerance: float = 0.01,
        displacements: Literal["small", "finite"] = "small",
        distance: float | None = None,
        folder: str | Path | None = None,
        jobs: int = -1,
    ) -> "Draws":
        """Run a model that follows a load path on this wall and on copies that differ within the scatter of the input.

        Parameters
        ----------
        model, tolerance
            As in `run`.
        number
            Number of runs; the first is of the wall as it is.
        scatter
            ``"bits"`` changes the last bits of densities and frictions; ``"size=0.01,friction=0.05"``, or one of the
            two, the sizes of blocks within a relative tolerance and the friction of each joint by a standard deviation
            of its logarithm.
        displacements, distance
            Small or finite displacements, and the distance to which live loads push a wall at finite ones [m].
        folder
            Folder in which outcomes are saved and found again; None saves nothing.
        jobs
            Number of processes; −1 is one per core.

        Raises
        ------
        SceneError
            If the model follows no load path or `number` is not from 2 to 10 000; and as in `run`.
        """
        from .campaigns import ctrl_c_passed_on
        from .draws import Sampling
        from .models import find_model
        from .models.far import check_goes_far, going_far

        chosen = going_far(find_model(model), displacements, distance)
        check_goes_far(chosen, self.scene, displacements, distance)
        warn_of_likely_slips([self.scene])
        sampling = Sampling(self.scene, chosen, number, scatter)
        with ctrl_c_passed_on():
            return sampling.run(tolerance, None if folder is None else path_of("folder", folder), jobs)

    def respond(self, model: "str | Model", scale: float = 1.0, **settings: Any) -> "DrawnResponse":
        """Compute the response of the wall to its ground motion, ``load.history``.

        Parameters
        ----------
        model
            Name of a dynamic model.
        scale
            Factor on the record, λ.
        settings
            ``points`` ``(k, 2)`` [m], which are followed instead of the upper corners; ``rows`` per second; ``after``,
            the time for which the wall is followed after a block has fallen [s].
        """
        from .models import respond
        from .pictures.response import DrawnResponse

        warn_of_likely_slips([self.scene])
        return DrawnResponse(**vars(respond(model, self.scene, scale, **settings)), wall=self.scene)

    def advise(self, tolerance: float = 0.05, *, finite: bool = False) -> "Advice":
        """Run models from the cheapest on until the bracket is as narrow as requested.

        Parameters
        ----------
        tolerance
            Requested relative width of the bracket.
        finite
            Whether the last model follows the wall at finite displacements even if they are small.

        Returns
        -------
        Advice
            ``rungs``, one per model with its outcome and the conclusion from it, and ``outcome()``, the answer; it
            prints as ``runningbond advise`` does.
        """
        from .compare.advice import advise

        warn_of_likely_slips([self.scene])
        return advise(self.scene, tolerance, finite=finite)

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the wall with its support and loads into axes, by default those of a new figure.

        A figure with several axes needs ``layout="constrained"`` to leave room for the text around each.
        """
        from .pictures.flat import draw_wall, figure_of

        if axes is None:
            from matplotlib.pyplot import figure

            return figure_of(self.scene, make=figure).axes[0]
        draw_wall(axes, self.scene)
        return axes

    def to_toml(self, path: str | Path) -> None:
        """Write the wall as a scene file that `read` turns into the same wall.

        Raises
        ------
        SceneError
            If a law or a load is a Python object, which a file cannot hold, or the drawing or record has changed.
        """
        from .results import write_atomically
        from .scene_writer import toml

        self._check_unchanged({key: (file, _digest(file)) for key, file in self._files().items()})
        description, path = {"title": self.scene.title} | self.description, path_of("path", path)
        for name, file in self._files().items():
            *tables, key = name.split(".")
            table = reduce(getitem, tables, description)
            # Resolved, because ".." leads out of the folder that a link points to, not of the one that it lies in.
            table[key] = Path(relpath(file.parent.resolve() / file.name, path.parent.resolve())).as_posix()
        write_atomically(path, toml(description).encode())

    def __repr__(self) -> str:
        low, high = self.scene.blocks.extent(self.scene.wall)
        (length, height), count = high - low, self.scene.count_blocks()
        return f"<Wall {self.scene.title!r}: {count} block{'s' * (count != 1)}, {length:.4g} × {height:.4g} m>"

    def _repr_svg_(self) -> str:
        from .pictures.captions import to_svg
        from .pictures.flat import figure_of

        return to_svg(figure_of(self.scene)).decode()

    def _repr_png_(self) -> bytes:
        from .pictures.captions import to_png
        from .pictures.flat import figure_of

        return to_png(figure_of(self.scene))


def read(wall: str | Path) -> Wall:
    """Read a wall from a scene file, or a published wall by its name, for example ``"panel-01"``.

    Raises
    ------
    SceneError
        If there is no such file or it is not a valid wall.
    """
    from .compare.published import find_scene

    path = find_scene(str(path_of("wall", wall)))
    return Wall({"title": path.stem, **read_description(path)}, path.parent)


def _digest(file: Path) -> bytes | None:
    """Digest of a file; None if there is none."""
    return sha256(file.read_bytes()).digest() if file.is_file() else None


def _check_has_its_table(name: str, value: object) -> None:
    """Refuse a key that is given without the table it belongs to."""
    table = TABLE_OF.get(name, "wall")
    if table == "wall" and (name in TOP_LEVEL or "." in name):  # saves reading the schema
        return
    from .scene.schema import is_key_of

    if table != "wall" or is_key_of(table, name):
        raise SceneError(name, f'is a key of [{table}]; give it as {{"{table}.{name}": {abbreviated(value)}}}', value)
