"""Python calls entries alone: other kernels have no wrapper for it outside of the tests, and would crash."""

import ast
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

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


def module_of(file: Path) -> str:
    """Name of a file of the package as an import has it."""
    return ".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts)


def imported(file: Path) -> set[tuple[str, str]]:
    """Module and name of what a file imports from the kernels."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return {
        (node.module or "", alias.name)
        for node in ast.walk(tree)
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
        if file not in kernels and imported(file) & inner:
            assert ("sinuous.kernels.compile", "entry") in imported(file), (
                f"{file} imports an inner kernel without an entry to call it from"
            )
    assert not decorated(PACKAGE / "kernels" / "chain" / "batch.py", "kernel")


def test_the_cache_is_named_by_the_sources() -> None:
    assert compiling.CACHE.name == compiling._sources_hash()
    assert compiling.CACHE.is_dir()


def test_every_source_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    named = {file.relative_to(PACKAGE).as_posix() for file in compiling._sources()}
    assert {"kernels/tables.py", "kernels/maths/vectors.py", "methods/fabrik/links.py"} <= named
    before = compiling._sources_hash()
    copied = [tmp_path / f"{i}.py" for i in range(len(named))]
    for copy, source in zip(copied, compiling._sources(), strict=True):
        copy.write_bytes(source.read_bytes())
    monkeypatch.setattr(compiling, "_sources", lambda: copied)
    assert compiling._sources_hash() == before
    copied[-1].write_text("# a change")
    assert compiling._sources_hash() != before


def test_caches_that_nobody_uses_are_removed_when_a_new_one_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parent = tmp_path / "sinuous"
    monkeypatch.setattr(compiling, "places", lambda name: [parent / name])
    monkeypatch.setattr(compiling, "__file__", str(tmp_path / "a file" / "compile.py"))
    (tmp_path / "a file").touch()  # no folder can be made there
    old, late, other = parent / ("0" * 16), parent / ("1" * 16), parent / "samples"
    for folder, days in ((old, 30), (late, 3), (other, 300)):
        (folder / "inner").mkdir(parents=True)
        (folder / "inner" / "kernel.nbi").touch()
        os.utime(folder, (time.time() - 86400 * days,) * 2)
    found = compiling._find_cache()
    assert found == parent / compiling._sources_hash()
    assert not old.exists()
    assert (late / "inner" / "kernel.nbi").exists()
    assert other.exists()
    # One that is there already is used, and that it is used is noted: it removes nothing and is not removed.
    os.utime(found, (0.0, 0.0))
    os.utime(late, (0.0, 0.0))
    assert compiling._find_cache() == found
    assert time.time() - found.stat().st_mtime < 3600
    assert late.exists()


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[int], Any]:
    """Make an entry, with a cache of its own, that belongs to a piece of so many seconds."""
    monkeypatch.setattr(compiling, "CACHE", tmp_path)
    monkeypatch.setattr(compiling, "_told", [])

    def make(seconds: int) -> Any:
        name = compiling.name_of(half)
        monkeypatch.setattr(compiling, "PIECES", (compiling.Piece("halves", seconds, (name,)),))
        return compiling.entry(half)

    return make


def half(x: float) -> float:
    return 0.5 * x


def test_compiling_is_announced_with_what_and_how_long_and_loading_is_not(
    fresh: Callable[[int], Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert fresh(9)(2.0) == 1.0
    said = "sinuous: compiling halves, once on this machine (about 9 s); 'sinuous warm' compiles everything ahead\n"
    assert capsys.readouterr().err == said
    monkeypatch.setattr(compiling, "_told", [])
    again = fresh(9)
    assert again(4.0) == 2.0
    assert sum(again.stats.cache_hits.values()) == 1
    assert capsys.readouterr().err == ""


def test_compiling_a_piece_is_announced_once_in_a_process(
    fresh: Callable[[int], Any], capsys: pytest.CaptureFixture[str]
) -> None:
    entry = fresh(9)
    entry(2.0)
    entry(2)
    assert capsys.readouterr().err.count("compiling") == 1
    assert len(entry.signatures) == 2


def test_what_takes_no_time_is_not_announced(fresh: Callable[[int], Any], capsys: pytest.CaptureFixture[str]) -> None:
    fresh(1)(2.0)
    assert capsys.readouterr().err == ""


def test_another_can_be_told(fresh: Callable[[int], Any], capsys: pytest.CaptureFixture[str]) -> None:
    told: list[compiling.Piece] = []
    entry = fresh(9)
    with compiling.told_to(told.append):
        entry(2.0)
    assert [piece.what for piece in told] == ["halves"]
    assert capsys.readouterr().err == ""
    assert compiling._tellers == [compiling._print]


def test_whole_numbers_are_of_one_kind() -> None:
    """Numba would compile a kernel again for every constant that it is called with."""

    @compiling.kernel
    def double(x: int) -> int:
        return 2 * x

    @compiling.entry
    def twelve() -> int:
        return double(1) + double(2) + double(3)

    assert twelve() == 12
    assert len(double.compiled.signatures) == 1  # type: ignore[attr-defined]


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
