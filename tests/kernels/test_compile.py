"""Python calls entries alone: other kernels would run as Python, a thousand times as slowly."""

import ast
from functools import cache
from pathlib import Path

import sinuous
from sinuous.kernels import compile as compiling

PACKAGE = Path(sinuous.__file__).parent


@cache
def parsed(file: Path) -> ast.Module:
    return ast.parse(file.read_text(encoding="utf-8"))


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
        for node in ast.walk(parsed(file))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sinuous.kernels")
        for alias in node.names
    }


def test_only_entries_are_called_from_python() -> None:
    kernels = sorted([*(PACKAGE / "kernels").rglob("*.py"), *(PACKAGE / "methods").rglob("*.py")])
    inner, entries = (
        {(module_of(file), name) for file in kernels for name in decorated(file, mark)} for mark in ("kernel", "entry")
    )
    assert {"search", "search_many", "prefer"} <= {name for _, name in entries}
    assert not inner & entries
    for file in PACKAGE.rglob("*.py"):
        if file not in kernels and (names := imported(file)) & inner:
            assert ("sinuous.kernels.compile", "entry") in names, (
                f"{file} imports an inner kernel without an entry to call it from"
            )
    assert not decorated(PACKAGE / "kernels" / "chain" / "batch.py", "kernel")


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


def test_an_inner_kernel_is_one_to_kernels_and_another_to_python() -> None:
    @compiling.kernel
    def double(x: float) -> float:
        return 2.0 * x

    @compiling.entry
    def six() -> float:
        return double(3.0)

    assert double(2.0) == 4.0
    assert six() == 6.0
    assert double(2.0) == 4.0
