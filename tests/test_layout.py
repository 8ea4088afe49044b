"""The layout that docs/design.md promises: imports run downwards, those for types too, and never in a circle."""

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import sinuous

PACKAGE = Path(sinuous.__file__).parent

FLOORS = {
    "cli": 6,
    "pictures": 6,
    "assessing": 5,
    "designing": 5,
    "exploring": 5,
    "batch": 5,
    "calibration": 5,
    "workspace": 5,
    "viewer": 6,
    "display": 5,
    "torch": 5,
    "jax": 5,
    "motion": 5,
    "solving": 4,
    "methods": 3,
    "problem": 2,
    "solution": 2,
    "derivatives": 2,
    "measures": 2,
    "files": 2,
    "export": 1,
    "robot": 1,
    "statics": 1,
    "scene": 1,
    "poses": 1,
    "packing": 0,
    "kernels": 0,
    "checks": 0,
    "errors": 0,
    "progress": 0,
    "caches": 0,
    "work_time": 0,
    "words": 0,
    "processes": 0,
    "arguments": 0,
    "reprs": 0,
    "groups": 0,
    "frozen": 0,
    "gc_pause": 0,
    "guesses": 0,
    "signatures": 0,
    "notebook": 0,
    "writing": 0,
}

KERNEL_FLOORS = {
    "derivative": 5,
    "solve": 5,
    "fitting": 4,
    "growing": 4,
    "tubes": 2,
    "planning": 6,
    "roadmap": 3,
    "statics": 2,
    "step": 3,
    "between": 3,
    "velocity": 4,
    "body": 2,
    "freespace": 2,
    "problem": 2,
    "fields": 1,
    "chain": 1,
    "maths": 0,
    "clock": 0,
    "compile": 0,
    "compiling": 0,
    "tables": 0,
}

EDGES = ("__init__", "__main__")
"""The front door and the command may import anything."""

SOURCES = sorted(PACKAGE.rglob("*.py"))
MODULES = [file for file in SOURCES if file.stem not in EDGES]


def module(file: Path) -> str:
    return ".".join(file.relative_to(PACKAGE).with_suffix("").parts)


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


@cache
def imports(file: Path, at_run_time_only: bool) -> tuple[str, ...]:
    """Modules of the package that a file imports, without `sinuous.` in front."""
    found: list[str] = []
    for node in walk(parsed(file), at_run_time_only):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "sinuous":
            for alias in node.names:
                inner = f"{node.module}.{alias.name}".partition(".")[2]
                there = PACKAGE / Path(*inner.split("."))
                is_module = there.with_suffix(".py").exists() or there.is_dir()
                found.append(inner if is_module else (node.module or "").partition(".")[2])
    return tuple(dict.fromkeys(name for name in found if name))


def walk(node: ast.AST, at_run_time_only: bool) -> Iterator[ast.AST]:
    """All statements but those that only a type checker sees."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.expr):
            continue
        checked = isinstance(child, ast.If) and isinstance(child.test, ast.Name) and child.test.id == "TYPE_CHECKING"
        if not (at_run_time_only and checked):
            yield child
            yield from walk(child, at_run_time_only)


def floor(name: str) -> tuple[int, int]:
    """Floor of a module, and within the kernels that of its room."""
    room, _, rest = name.partition(".")
    return FLOORS[room], KERNEL_FLOORS[rest.partition(".")[0]] if room == "kernels" and rest else 0


def test_every_room_has_a_floor() -> None:
    rooms = {module(file).partition(".")[0] for file in MODULES}
    assert rooms == set(FLOORS) & rooms
    kernels = {module(file).split(".")[1] for file in MODULES if file.is_relative_to(PACKAGE / "kernels")}
    assert kernels == set(KERNEL_FLOORS)


def test_imports_run_downwards() -> None:
    upwards = [
        f"{module(file)} imports {name}"
        for file in MODULES
        for name in imports(file, at_run_time_only=False)
        if floor(name) > floor(module(file))
    ]
    assert not upwards, "\n".join(upwards)


def test_there_is_no_circle_of_imports() -> None:
    names = {module(file): file for file in MODULES}
    state: dict[str, int] = {}

    def visit(name: str, path: tuple[str, ...]) -> None:
        if state.get(name) == 2 or name not in names:
            return
        assert state.get(name) != 1, " -> ".join((*path, name))
        state[name] = 1
        for other in imports(names[name], at_run_time_only=True):
            visit(other, (*path, name))
        state[name] = 2

    for name in names:
        visit(name, ())


def test_no_two_classes_have_one_name() -> None:
    """But a command of the shell has the name of the class whose work it does."""
    commands = PACKAGE / "cli" / "app.py"
    places: dict[str, list[str]] = {}
    for file in SOURCES:
        for node in parsed(file).body:
            if isinstance(node, ast.ClassDef) and file != commands:
                places.setdefault(node.name, []).append(module(file))
    twice = [f"{name}: {', '.join(there)}" for name, there in places.items() if len(there) > 1]
    assert not twice, "\n".join(twice)
