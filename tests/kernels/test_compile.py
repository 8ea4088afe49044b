"""Python calls entries alone: other kernels would run as Python, a thousand times as slowly."""

import ast
from importlib import import_module
from pathlib import Path
from types import FunctionType, ModuleType

from sinuous.kernels import compile as compiling
from sinuous.kernels.compile.sources import read_sources
from sinuous.kernels.compile.store import ENTRIES
from tests.helpers import PACKAGE, parsed, statements_of


def decorated(file: Path, name: str) -> set[str]:
    """Functions of a file that stand under the decorator `name`."""
    if f"@{name}" not in file.read_text(encoding="utf-8"):
        return set()
    return {
        node.name
        for node in parsed(file).body
        if isinstance(node, ast.FunctionDef)
        and any(isinstance(mark, ast.Name) and mark.id == name for mark in node.decorator_list)
    }


def module_of(file: Path) -> str:
    """Name of a file of the package as an import has it."""
    return ".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts)


def imported(file: Path) -> set[tuple[str, str]]:
    """Module and name of what a file imports from the kernels."""
    if "sinuous.kernels" not in file.read_text(encoding="utf-8"):
        return set()
    return {
        (node.module or "", alias.name)
        for node in statements_of(file)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sinuous.kernels")
        for alias in node.names
    }


def reached() -> set[tuple[str, str]]:
    """Module and name of all kernels that entries call, and of those that these call in turn."""
    for name in read_sources():
        import_module(name)
    due, found = [entry.py_func for entry in ENTRIES.values()], set[FunctionType]()
    while due:
        function = due.pop()
        for name in function.__code__.co_names:
            one = function.__globals__.get(name)
            parts = vars(one) if isinstance(one, ModuleType) else {name: one}
            for each in {*function.__code__.co_names} & parts.keys():
                called = parts[each]
                if isinstance(called, FunctionType) and called.__module__ in read_sources() and called not in found:
                    found.add(called)
                    due.append(called)
    return {(each.__module__, each.__name__) for each in found}


FOR_BOTH = {("sinuous.kernels.fitting.query", "ball_radius"), ("sinuous.kernels.certificate.sweep", "sweep_size")}
"""What Python calls as Python as well: a loop over segments, once for a solver, and the size of a buffer."""


def test_only_entries_are_called_from_python() -> None:
    kernels = sorted([*(PACKAGE / "kernels").rglob("*.py"), *(PACKAGE / "methods").rglob("*.py")])
    inner = reached()
    entries = {(module_of(file), name) for file in kernels for name in decorated(file, "entry")}
    assert {"search", "search_many", "prefer"} <= {name for _, name in entries}
    assert len(inner) > 500
    for file in PACKAGE.rglob("*.py"):
        if file not in kernels:
            assert not imported(file) & (inner - entries - FOR_BOTH), f"{file} imports an inner kernel"


def test_whole_numbers_are_of_one_kind() -> None:
    """Numba would compile a kernel again for every constant that it is called with."""

    @compiling.kernel
    def double(x: int) -> int:
        return 2 * x

    @compiling.entry
    def twelve() -> int:
        return double(1) + double(2) + double(3)

    assert twelve() == 12
    assert len(compiling.compiled_form(double).signatures) == 1
