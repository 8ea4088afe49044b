"""What a kernel depends on: its own file, all that this imports, and what compiles it."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from sinuous.kernels.compile import sources

CACHED = (sources.sources_hash, sources.stamp_of, sources.imported_by, sources.read_sources, sources._reached)


def forget() -> None:
    """Forget what was read."""
    for cached in CACHED:
        cached.cache_clear()


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], Path]]:
    """Let copies of all sources stand for them; returns what finds one by its name."""
    for file in sources.sources():
        copied = tmp_path / file.relative_to(sources.PACKAGE)
        copied.parent.mkdir(parents=True, exist_ok=True)
        copied.write_bytes(file.read_bytes())
    before = sources.sources_hash()
    monkeypatch.setattr(sources, "PACKAGE", tmp_path)
    forget()
    assert sources.sources_hash() == before
    yield lambda name: tmp_path / name
    forget()


GROWING, STEP, VECTORS = "kernels/growing/grow.py", "kernels/step/newton.py", "kernels/maths/vectors.py"


@pytest.mark.parametrize(
    ("changed", "meant"), [(GROWING, {GROWING}), (VECTORS, {GROWING, STEP, VECTORS}), ("methods/dls.py", set[str]())]
)
def test_a_stamp_changes_with_what_is_imported_alone(
    copy: Callable[[str], Path], changed: str, meant: set[str]
) -> None:
    stamps = {name: sources.stamp_of(str(copy(name))) for name in (GROWING, STEP, VECTORS)}
    whole = sources.sources_hash()
    copy(changed).write_text(copy(changed).read_text() + "# a change")
    assert {name for name in stamps if not sources.unchanged(str(copy(name)))} == meant
    assert {name: sources.stamp_of(str(copy(name))) for name in stamps} == stamps  # of what was imported
    forget()
    assert {name for name in stamps if sources.stamp_of(str(copy(name))) != stamps[name]} == meant
    assert sources.sources_hash() != whole


def test_what_was_changed_and_changed_back_is_not_what_was_read(copy: Callable[[str], Path]) -> None:
    """Nobody knows what was imported meanwhile; and of other files nobody knows what they import."""
    file = copy(VECTORS)
    assert sources.unchanged(str(copy(GROWING)))
    text = file.read_bytes()
    file.write_text("# a change")
    file.write_bytes(text)
    for name in (GROWING, "own.py"):
        assert not sources.unchanged(str(copy(name)))
    file.unlink()
    assert not sources.unchanged(str(copy(GROWING)))


@pytest.mark.parametrize("name", ["VERSION", "COMPILER"])
def test_what_compiles_counts_but_for_its_text(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    files = [str(sources.PACKAGE / VECTORS), __file__]  # the other depends on all sources
    assert not [file for file in sources.sources() if file.parent.name == "compile"]
    before = [sources.stamp_of(file) for file in files]
    monkeypatch.setattr(sources, name, "another")
    forget()
    assert not set(before) & {sources.stamp_of(file) for file in files}
    monkeypatch.undo()
    forget()


LOADED = """
import importlib, os, sys
import numba, scipy.linalg
for module in sys.argv[1:]:
    if not (child := os.fork()):
        importlib.import_module(f"sinuous.{module}")
        print(module, *(name for name in sys.modules if name.startswith(("sinuous.kernels", "sinuous.methods"))))
        sys.stdout.flush()
        os._exit(0)
    if os.waitpid(child, 0)[1]:
        sys.exit(f"{module} cannot be loaded")
"""
MODULES = ("kernels.velocity.query", "kernels.growing.grow", "methods.slinki")


@pytest.fixture(scope="module")
def loaded_for() -> dict[str, list[str]]:
    """What each module loads, by its name: in processes that are forked from one that has loaded other packages."""
    command = [sys.executable, "-c", LOADED, *MODULES]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return {line.split()[0]: line.split()[1:] for line in lines}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be forked here")
@pytest.mark.parametrize("module", MODULES)
def test_nothing_that_python_loads_is_missed(module: str, loaded_for: dict[str, list[str]]) -> None:
    loaded = {name for name in loaded_for[module] if not name.startswith("sinuous.kernels.compile")}
    assert len(loaded) > 20
    statics = {"sinuous.kernels.statics", "sinuous.kernels.statics.layout"}
    nouns_alone = {"sinuous.kernels.packing", *(statics if module == "methods.slinki" else ())}  # no kernel calls these
    assert loaded - nouns_alone <= sources.reached_from(f"sinuous.{module}")
