"""The layout that docs/design.md promises: imports run downwards, those for types too, and never in a circle."""

import ast
import re
from functools import cache
from pathlib import Path

from tests.helpers import PACKAGE, parsed, statements_of

DESIGN = Path(__file__).parents[1] / "docs" / "design.md"
MAP = re.search(r"^## The map\n(.*?)^## |\Z", DESIGN.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
ROOMS = re.findall(r"^\| `(\w+)` \|", MAP[1] if MAP else "", re.MULTILINE)
"""Rooms as docs/design.md lists them, the lowest first: each imports from those before it."""

LOOSE = {"torch", "jax"}
"""Modules beside the rooms: layers for programs that need not be there. They may import anything."""

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
    "certificate": 3,
    "velocity": 4,
    "body": 2,
    "freespace": 2,
    "problem": 2,
    "fields": 1,
    "chain": 1,
    "maths": 0,
    "clock": 0,
    "compile": 0,
    "packing": 2,
    "tables": 0,
}

EDGES = ("__init__", "__main__")
"""The front door and the command may import anything."""

SOURCES = sorted(PACKAGE.rglob("*.py"))
MODULES = [file for file in SOURCES if file.stem not in EDGES]


def module(file: Path) -> str:
    return ".".join(file.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")


NAMES = {module(file) for file in SOURCES}


@cache
def imports(file: Path) -> tuple[str, ...]:
    """Modules of the package that a file imports, those for types too, without `sinuous.` in front."""
    found: list[str] = []
    for node in statements_of(file):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "sinuous":
            for alias in node.names:
                inner = f"{node.module}.{alias.name}".partition(".")[2]
                found.append(inner if inner in NAMES else (node.module or "").partition(".")[2])
    return tuple(dict.fromkeys(name for name in found if name))


def floor(name: str) -> tuple[int, int]:
    """Floor of a module, and within the kernels that of its room."""
    room, _, rest = name.partition(".")
    if room in LOOSE:
        return len(ROOMS), 0
    return ROOMS.index(room), KERNEL_FLOORS[rest.partition(".")[0]] if room == "kernels" and rest else 0


def test_the_map_names_every_room() -> None:
    assert {module(file).partition(".")[0] for file in MODULES} == {*ROOMS, *LOOSE}
    assert len(ROOMS) <= 16
    assert len(LOOSE) <= 5
    kernels = {module(file).split(".")[1] for file in MODULES if file.is_relative_to(PACKAGE / "kernels")}
    assert kernels == set(KERNEL_FLOORS)


def test_imports_run_downwards() -> None:
    upwards = [
        f"{module(file)} imports {name}"
        for file in MODULES
        for name in imports(file)
        if floor(name) > floor(module(file))
    ]
    assert not upwards, "\n".join(upwards)


def test_there_is_no_circle_of_imports() -> None:
    """Nor one of imports for types alone."""
    names = {module(file): file for file in SOURCES if file.parent != PACKAGE}
    state: dict[str, int] = {}

    def visit(name: str, path: tuple[str, ...]) -> None:
        if state.get(name) == 2 or name not in names:
            return
        assert state.get(name) != 1, " -> ".join((*path, name))
        state[name] = 1
        for other in imports(names[name]):
            if other != name:
                visit(other, (*path, name))
        state[name] = 2

    for name in names:
        visit(name, ())


def test_no_two_classes_have_one_name() -> None:
    """But a command of the shell has the name of the class whose work it does."""
    commands = PACKAGE / "cli" / "app.py"
    places: dict[str, list[str]] = {}
    for file in SOURCES:
        for node in statements_of(file):
            if isinstance(node, ast.ClassDef) and file != commands:
                places.setdefault(node.name, []).append(module(file))
    twice = [f"{name}: {', '.join(there)}" for name, there in places.items() if len(there) > 1]
    assert not twice, "\n".join(twice)


def is_described(name: str, text: str | None) -> bool:
    """Whether a text says which shape an array has: "`q` (n, 3)", or "q : ndarray" in a list of parameters."""
    shape, listed = rf"\b{name}`?\s\([^)]*[,)]", rf"^ *(\w+, )*{name}(, \w+)* : ndarray"
    return bool(re.search(f"{shape}|{listed}", text or "", re.MULTILINE))


def test_kernels_say_the_shape_of_every_array_that_they_are_given() -> None:
    kernels = PACKAGE / "kernels"
    for file in (file for file in kernels.rglob("*.py") if file.parent.name != "compile"):
        above = [ast.get_docstring(parsed(each)) for each in (file, kernels / "__init__.py")]
        for function in (node for node in statements_of(file) if isinstance(node, ast.FunctionDef)):
            arrays = [each.arg for each in function.args.args if ast.unparse(each.annotation or each) == "Array"]
            texts = [ast.get_docstring(function), *above]
            missing = [name for name in arrays if not any(is_described(name, text) for text in texts)]
            assert not missing, f"{module(file)}.{function.name}: {missing}"
