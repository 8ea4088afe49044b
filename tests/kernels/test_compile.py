"""Python calls entries alone: other kernels have no wrapper for it outside of the tests, and would crash."""

import ast
from pathlib import Path

import pytest

import sinuous
from sinuous.kernels import compile as compiling

PACKAGE = Path(sinuous.__file__).parent


def decorated(file: Path, name: str) -> set[str]:
    """Functions of a file that stand under the decorator `name`."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return {
        node.name
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef)
        and any(isinstance(mark, ast.Name) and mark.id == name for mark in node.decorator_list)
    }


def imported(file: Path) -> set[str]:
    """Names that a file imports from the kernels."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sinuous.kernels")
        for alias in node.names
    }


def test_only_entries_are_called_from_python() -> None:
    kernels = sorted((PACKAGE / "kernels").glob("*.py"))
    inner = set().union(*(decorated(file, "kernel") for file in kernels))
    entries = set().union(*(decorated(file, "entry") for file in kernels))
    assert {"search", "search_many", "prefer"} <= entries
    assert not inner & entries
    for file in PACKAGE.rglob("*.py"):
        if file.parent.name != "kernels" and imported(file) & inner:
            assert "entry" in imported(file), f"{file} imports an inner kernel without an entry to call it from"
    assert not decorated(PACKAGE / "kernels" / "batch.py", "kernel")


def test_the_cache_is_named_by_the_sources() -> None:
    assert compiling.ALL_CALLABLE
    assert compiling.CACHE.name == compiling._sources_hash()
    assert compiling.CACHE.is_dir()


class Uncompiled:
    """What `announce` sees of an entry that is not loaded yet."""

    signatures = ()
    __name__ = "search"
    __module__ = "sinuous.methods.opti_path.search"

    def __call__(self) -> None: ...


def test_compiling_is_announced_for_every_method_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiling, "CACHE", tmp_path)
    compiling.announce(Uncompiled())
    (tmp_path / "search.search-1.py311.nbi").touch()
    compiling.announce(Uncompiled())
    assert capsys.readouterr().err.count("compiling the kernels") == 2
    (tmp_path / "opti_path.search-1.py311.nbi").touch()
    compiling.announce(Uncompiled())
    assert capsys.readouterr().err == ""
