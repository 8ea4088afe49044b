"""What a kernel depends on: its own file, all that this imports, and what compiles it."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from sinuous.kernels.compiling import sources

CACHED = (sources.sources_hash, sources.stamp_of, sources.imported_by, sources._texts)


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    """Forget what was read, before and after."""
    for cached in CACHED:
        cached.cache_clear()
    yield
    for cached in CACHED:
        cached.cache_clear()


def test_every_source_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    named = {file.relative_to(sources.PACKAGE).as_posix() for file in sources.sources()}
    assert {"kernels/tables.py", "kernels/maths/vectors.py", "methods/fabrik/links.py"} <= named
    before = sources.sources_hash()
    copied = [tmp_path / f"{i}.py" for i in range(len(named))]
    for copy, source in zip(copied, sources.sources(), strict=True):
        copy.write_bytes(source.read_bytes())
    monkeypatch.setattr(sources, "sources", lambda: copied)
    sources.sources_hash.cache_clear()
    assert sources.sources_hash() == before
    copied[-1].write_text("# a change")
    sources.sources_hash.cache_clear()
    assert sources.sources_hash() != before


LOADED = """
import importlib, sys
importlib.import_module(sys.argv[1])
print(*(name for name in sys.modules if name.startswith(("sinuous.kernels", "sinuous.methods"))))
"""


@pytest.mark.parametrize("module", ["kernels.velocity.query", "kernels.growing.grow", "methods.slinki.search"])
def test_nothing_that_python_loads_is_missed(module: str) -> None:
    command = [sys.executable, "-c", LOADED, f"sinuous.{module}"]
    loaded = set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())
    assert len(loaded) > 20
    assert loaded <= sources.reached_from(f"sinuous.{module}")


def test_a_stamp_changes_with_what_is_imported_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = dict(sources._texts())
    growing, step = (str(sources.PACKAGE / "kernels" / name) for name in ("growing/grow.py", "step/newton.py"))
    before = [sources.stamp_of(file) for file in (growing, step)]
    texts["sinuous.kernels.growing.grow"] += b"# a change"
    monkeypatch.setattr(sources, "_texts", lambda: texts)
    sources.stamp_of.cache_clear()
    assert sources.stamp_of(growing) != before[0]
    assert sources.stamp_of(step) == before[1]
    texts["sinuous.kernels.maths.vectors"] += b"# a change"
    sources.stamp_of.cache_clear()
    assert sources.stamp_of(step) != before[1]


def test_of_other_files_all_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "own.py"
    file.write_text("a = 1")
    before = sources.stamp_of(str(file))
    file.write_text("a = 2")
    sources.stamp_of.cache_clear()
    changed = sources.stamp_of(str(file))
    assert changed != before
    monkeypatch.setattr(sources, "sources_hash", lambda: "f" * 16)
    sources.stamp_of.cache_clear()
    assert sources.stamp_of(str(file)) != changed


def test_what_compiles_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    file = str(sources.PACKAGE / "kernels" / "maths" / "vectors.py")
    before = sources.stamp_of(file)
    monkeypatch.setattr(sources, "compilers", lambda: b"another compiler")
    sources.stamp_of.cache_clear()
    assert sources.stamp_of(file) != before
