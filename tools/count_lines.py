#!/usr/bin/env python3
"""Measure the source tree: lines per room, import cycles, untyped geometry, files that name a law, load or model.

``python tools/count_lines.py`` counts this tree, ``--root FOLDER`` another one, also one that is older than the package
``runningbond``. Only the standard library is needed.
"""

import argparse
import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

OUTSIDE = {"tests", "benchmarks", "examples", "tools", "docs", "build"}
"""Top-level folders that are not part of the package."""

DEMONSTRATION = {"models", "campaigns", "draws", "compare", "studies", "commands"}
"""Rooms that were one room ``compare`` before the package was made; draws was split off later."""

LOADS = re.compile(r"\bPointLoad\b")
LAWS = re.compile(r"\b(SOFTENING|COULOMB|softening_\w+|coulomb_(kernel|constants)|fracture_energy_1)\b")
MODELS = {"limit-nonassociated", "dem-static", "dem-dynamic", "fem"}
UNTYPED = re.compile(r"[Gg]eometry[^\n]*tuple\[Any\b")


def sources(root: Path) -> list[Path]:
    """Python files of the package."""
    packages = [path.parent for path in sorted(root.glob("*/__init__.py")) if path.parent.name not in OUTSIDE]
    return [*sorted(root.glob("*.py")), *(file for package in packages for file in sorted(package.rglob("*.py")))]


def room(root: Path, file: Path) -> str:
    """Room of a file: the folder below ``runningbond``, or the top-level folder elsewhere."""
    parts = file.relative_to(root).parts
    if parts[0] != "runningbond":
        return parts[0].removesuffix(".py")
    return parts[1] if len(parts) > 2 else "front door"


def text(file: Path) -> str:
    """Content of a source file."""
    return file.read_text(encoding="utf-8")


def lines(files: list[Path]) -> int:
    """Number of lines in files, with blank lines and documentation."""
    return sum(len(text(file).splitlines()) for file in files)


def module(root: Path, file: Path) -> str:
    """Import name of a file."""
    return ".".join(file.relative_to(root).with_suffix("").parts).removesuffix(".__init__")


def needs(root: Path, file: Path, modules: set[str]) -> set[str]:
    """Modules that a file imports when it is imported itself, without imports inside functions."""
    package = module(root, file).split(".") if file.name == "__init__.py" else module(root, file).split(".")[:-1]
    imported: set[str] = set()
    for node in ast.parse(text(file)).body:
        if isinstance(node, ast.Import):
            imported |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            target = ".".join([*base, *([node.module] if node.module else [])])
            imported |= {target, *(f"{target}.{alias.name}" for alias in node.names)}
    return imported & modules - {module(root, file)}


def cycles(graph: dict[str, set[str]]) -> list[list[str]]:
    """Groups of modules that import each other (strongly connected components, Tarjan 1972)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []

    def visit(name: str) -> Iterator[list[str]]:
        number[name] = low[name] = len(number)
        stack.append(name)
        for other in sorted(graph[name]):
            if other not in number:
                yield from visit(other)
            if other in stack:
                low[name] = min(low[name], low[other])
        if low[name] == number[name]:
            group = stack[stack.index(name) :]
            del stack[stack.index(name) :]
            if len(group) > 1:
                yield sorted(group)

    return [group for name in sorted(graph) if name not in number for group in visit(name)]


def names_a_model(content: str) -> bool:
    """Whether a source file has a model's name as a string."""
    strings = {node.value for node in ast.walk(ast.parse(content)) if isinstance(node, ast.Constant)}
    return bool(MODELS & {string for string in strings if isinstance(string, str)})


def report(root: Path) -> list[tuple[str, object]]:
    """Rows of the table: what is counted, and the count."""
    files = sources(root)
    by_room: dict[str, list[Path]] = {}
    for file in files:
        by_room.setdefault(room(root, file), []).append(file)
    rows: list[tuple[str, object]] = [(f"lines of {name}", lines(inside)) for name, inside in sorted(by_room.items())]
    demonstration = [file for name, inside in by_room.items() if name in DEMONSTRATION for file in inside]
    names = {module(root, file): file for file in files}
    groups = cycles({name: needs(root, file, set(names)) for name, file in names.items()})
    rows += [
        ("lines of models + campaigns + draws + compare + studies + commands", lines(demonstration)),
        ("lines of the package, without tests and benchmarks", lines(files)),
        ("modules", len(files)),
        ("module cycles", "; ".join(" ↔ ".join(group) for group in groups) or 0),
        ("geometry as tuple[Any, …]", sum(len(UNTYPED.findall(text(file))) for file in files)),
    ]
    kinds: dict[str, Callable[[str], bool]] = {
        "law": lambda content: bool(LAWS.search(content)),
        "load": lambda content: bool(LOADS.search(content)),
        "model": names_a_model,
    }
    for kind, names_one in kinds.items():
        rows.append((f"files that name a {kind} there is", sum(names_one(text(file)) for file in files)))
        example = root / "examples" / f"own_{kind}.py"
        rows.append((f"files of the package that {example.name} touches", 0 if example.exists() else "no such example"))
    return rows


def main() -> None:
    """Print the counts as a Markdown table."""
    parser = argparse.ArgumentParser(description="Count the house.")
    parser.add_argument("--root", type=Path, default=Path(__file__).parent.parent, help="the tree to count")
    print("| what | count |\n|---|---|")
    for name, value in report(parser.parse_args().root.resolve()):
        print(f"| {name} | {value} |")


if __name__ == "__main__":
    main()
