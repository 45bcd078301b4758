"""Import of the package: lazy, with listed names, and safe beside user files of the same names."""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from setuptools import find_packages

import runningbond as rb
from tests.at_length import at_length

ROOT = Path(__file__).parents[2]
PLOTTING = {"matplotlib", "pyvista", "vtkmodules"}
HEAVY = {"numpy", "scipy", "numba", "gmsh", "joblib", "shapely", "ezdxf", "pandas"} | PLOTTING
METHODS = {"dem", "fem_interface", "homog", "meshing"}

FIVE_LINES = """
import runningbond as rb
mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
wall = rb.Wall.courses([[1, 1], [0.5, 1, 0.5]], block_width=0.4, block_height=0.2, thickness=0.2,
                       density=1800.0, friction=0.4, mortar=mortar)
result = wall.run("dem-static")
print(result.status, result.lower)
from dem import limit
print(limit(wall.scene).status)
"""


def python(*arguments: str, cwd: Path | None = None) -> str:
    """Output of a new interpreter."""
    surroundings = {**os.environ, "PYTHONPATH": str(ROOT)}
    answer = subprocess.run([sys.executable, *arguments], cwd=cwd, env=surroundings, capture_output=True, text=True)
    assert answer.returncode == 0, answer.stderr
    return answer.stdout


def test_import_loads_no_library_and_no_subpackage() -> None:
    loaded = python("-c", "import sys, runningbond; print(*sys.modules)").split()
    assert not HEAVY & {name.split(".")[0] for name in loaded}
    ours = {name for name in loaded if name.startswith("runningbond")}
    assert ours == {"runningbond", "runningbond.own_packages"}
    assert not METHODS & set(loaded)


def test_building_a_wall_loads_no_solver_or_plotting_library() -> None:
    lines = FIVE_LINES.split("result =")[0]
    loaded = python("-c", f"{lines}\nimport sys; print(*sys.modules)").split()
    assert not (PLOTTING | {"numba", "gmsh", "joblib"}) & set(loaded)


def test_changes_by_full_names_do_not_load_the_schema() -> None:
    lines = f"{FIVE_LINES.split('result =')[0]}\nwall = wall.with_({{'joint.friction': 0.5, 'title': 'rougher'}})"
    assert "runningbond.scene.schema" not in python("-c", f"{lines}\nimport sys; print(*sys.modules)").split()


def test_check_for_misspelt_keys_does_not_load_ezdxf() -> None:
    """Misspelt keys are found with the schema, whose example scenes include a drawing that does not exist."""
    lines = (
        "from runningbond.scene.schema import misspelt\nimport sys\nprint(misspelt({'wall': {'heigth': 0.6}}).remedy)"
    )
    said = python("-c", f"{lines}\nprint(*sys.modules)")
    assert said.startswith("is not a key of [wall]")
    assert "ezdxf" not in said.split()


def test_every_listed_name_exists() -> None:
    assert set(rb.__all__) <= set(dir(rb))
    assert all(hasattr(rb, name) for name in rb.__all__)


def test_unknown_name_is_refused() -> None:
    with pytest.raises(AttributeError, match="Wal"):
        getattr(rb, "Wal")  # noqa: B009 - mypy sees that it is not there


@pytest.fixture
def user_files(tmp_path: Path) -> Path:
    """Folder with user files named like subpackages, which the package must not import."""
    rooms = ("scene", "results", "joints", "compare", "dynamics", "limit", "pictures", "studies", "commands")
    for name in (*rooms, "wall", "sweeps", "tables", "dem_test"):
        (tmp_path / f"{name}.py").write_text(f"raise ImportError('{name}.py of the user was imported')\n")
    return tmp_path


def test_five_lines_run_beside_files_named_like_subpackages(user_files: Path) -> None:
    (user_files / "script.py").write_text(FIVE_LINES)
    assert [line.split()[0] for line in python("script.py", cwd=user_files).splitlines()] == ["collapse", "collapse"]


def test_commands_run_beside_files_named_like_subpackages(user_files: Path) -> None:
    answer = python("-m", "runningbond", "run", "panel-01", "--model", "limit", "--json", cwd=user_files)
    assert '"status": "collapse"' in answer
    (user_files / "wall.toml").write_text(_block("toml"))
    lines = "\n".join(f"assert command({line.split()!r}) == 0" for line in _commands())
    python("-c", f"from runningbond.commands.command_line import command\n{lines}", cwd=user_files)


def test_readme_runs_beside_files_named_like_subpackages(user_files: Path) -> None:
    (user_files / "wall.toml").write_text(_block("toml"))
    (user_files / "script.py").write_text("import matplotlib\nmatplotlib.use('Agg')\n" + _block("python"))
    assert python("script.py", cwd=user_files).startswith("collapse")


EVERY_MODEL = (
    FIVE_LINES.split("mortar =")[0]
    + """
wall = rb.Wall.running_bond(length=0.8, height=0.4, block_width=0.4, block_height=0.2, thickness=0.2, density=1800.0,
                            friction=0.4, normal_stiffness=1e9, shear_stiffness=1e9, young=1e10)
for model in ("limit", "homog", "dem-static", "fem"):
    try:
        print(wall.run(model).status)
    except rb.SceneError as error:
        print(error.remedy)
"""
)


def test_folders_named_like_methods_are_not_imported(tmp_path: Path) -> None:
    """An editable installation finds the suite last, and would take such results folders for empty packages."""
    for name in METHODS:
        (tmp_path / name).mkdir()
    (tmp_path / "script.py").write_text(_with_editable_finder(EVERY_MODEL))
    answer = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True)
    assert answer.stdout.split() == ["collapse"] * 4, answer.stderr


def _with_editable_finder(lines: str) -> str:
    """Script that imports the suite as after `pip install -e`: by a finder that comes after the usual ones."""
    finder = """
import sys
from importlib.machinery import PathFinder
class Finder:
    @staticmethod
    def find_spec(name, path=None, target=None):
        return PathFinder.find_spec(name, [{root!r}]) if path is None and name in {names!r} else None
sys.path[:] = [each for each in sys.path if each != {root!r}]
sys.meta_path[:] = [each for each in sys.meta_path if "editable" not in str(each).lower()] + [Finder]
"""
    return finder.format(root=str(ROOT), names={"runningbond", *METHODS}) + lines


@pytest.mark.parametrize(
    ("name", "models"),
    [
        ("dem", {"dem-static", "fem"}),
        ("homog", {"homog"}),
        *at_length(("fem_interface", {"fem"}), ("meshing", {"fem"})),
    ],
)
def test_script_named_like_a_method_is_refused_by_models_that_need_it(
    tmp_path: Path, name: str, models: set[str]
) -> None:
    """It would be imported in place of the method, and thereby run a second time."""
    (tmp_path / f"{name}.py").write_text(EVERY_MODEL)
    said = python(f"{name}.py", cwd=tmp_path).splitlines()
    told = f"{tmp_path / name}.py would be imported in place of the suite's package {name}: let it have another name"
    assert said == [told if model in models else "collapse" for model in ("limit", "homog", "dem-static", "fem")]


def test_commands_ignore_user_files_named_like_methods(tmp_path: Path) -> None:
    for name in METHODS:
        (tmp_path / f"{name}.py").write_text(f"raise ImportError('{name}.py of the user was imported')\n")
    for line in ("run panel-01 --model dem-static", "run panel-01 --model homog", "mesh panel-01 --out wall.vtu"):
        python("-m", "runningbond", *line.split(), cwd=tmp_path)


def _block(language: str) -> str:
    return (ROOT / "README.md").read_text().split(f"```{language}\n")[1].split("```")[0]


def _commands() -> list[str]:
    """Commands of the README that need no display and are fast."""
    start = ".venv/bin/runningbond "
    readme = (ROOT / "README.md").read_text().splitlines()
    lines = [line.removeprefix(start) for line in readme if line.startswith(start)]
    return [line for line in lines if line.split()[0] in ("advise", "mesh") or line.endswith("--model limit")]


def test_distribution_contains_runningbond_and_the_four_methods() -> None:
    with (ROOT / "pyproject.toml").open("rb") as file:
        packages = find_packages(str(ROOT), **tomllib.load(file)["tool"]["setuptools"]["packages"]["find"])
    assert {package.split(".")[0] for package in packages} == {"runningbond", *METHODS}


def test_version_equals_that_of_the_distribution() -> None:
    stated = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert rb.__version__ == stated
