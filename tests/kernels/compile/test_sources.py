"""What a kernel depends on: its own file, all that this imports, and what compiles it."""

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from sinuous.kernels.compile import sources

CACHED = (sources.sources_hash, sources.stamp_of, sources.imported_by, sources.read_sources, sources._reached)


def forget() -> None:
    """Forget what was read."""
    for cached in CACHED:
        cached.cache_clear()


@pytest.fixture(autouse=True)
def nothing_kept() -> Iterator[None]:
    """Forget what was read, before and after."""
    forget()
    yield
    forget()


def copies(folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Copy all sources into a folder, and let the copies stand for them."""
    copied = [folder / file.relative_to(sources.PACKAGE) for file in sources.sources()]
    for copy, source in zip(copied, sources.sources(), strict=True):
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(source.read_bytes())
    monkeypatch.setattr(sources, "sources", lambda: copied)
    monkeypatch.setattr(sources, "PACKAGE", folder)
    forget()
    return copied


def test_every_source_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    named = {file.relative_to(sources.PACKAGE).as_posix() for file in sources.sources()}
    assert {"kernels/tables.py", "kernels/maths/vectors.py", "methods/fabrik/links.py"} <= named
    before = sources.sources_hash()
    copied = copies(tmp_path, monkeypatch)
    assert sources.sources_hash() == before
    copied[-1].write_text("# a change")
    forget()
    assert sources.sources_hash() != before


def test_how_sources_are_compiled_counts_by_its_version_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    named = {file.relative_to(sources.PACKAGE).as_posix() for file in sources.sources()}
    assert not any(name.startswith("kernels/compil") for name in named)
    before = sources.sources_hash()
    monkeypatch.setattr(sources, "VERSION", sources.VERSION + 1)
    forget()
    assert sources.sources_hash() != before


def test_what_was_read_is_compared_with_what_lies_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    copied = copies(tmp_path, monkeypatch)
    places = [file.relative_to(tmp_path).as_posix() for file in copied]
    growing, vectors = (copied[places.index(f"kernels/{name}.py")] for name in ("growing/grow", "maths/vectors"))
    elsewhere = copied[places.index("methods/dls.py")]
    of = str(growing)
    assert sources.unchanged(of)
    text, stamp = vectors.read_bytes(), sources.stamp_of(of)
    elsewhere.write_text("# a change")
    assert sources.unchanged(of)
    vectors.write_text("# a change")
    assert not sources.unchanged(of)
    vectors.write_bytes(text)  # again as it was, but nobody knows what was imported meanwhile
    assert not sources.unchanged(of)
    assert sources.stamp_of(of) == stamp
    vectors.unlink()
    assert not sources.unchanged(of)
    assert not sources.unchanged(str(tmp_path / "own.py"))


LOADED = """
import importlib, sys
importlib.import_module(sys.argv[1])
print(*(name for name in sys.modules if name.startswith(("sinuous.kernels", "sinuous.methods"))))
"""


@pytest.mark.parametrize("module", ["kernels.velocity.query", "kernels.growing.grow", "methods.slinki"])
def test_nothing_that_python_loads_is_missed(module: str) -> None:
    command = [sys.executable, "-c", LOADED, f"sinuous.{module}"]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()
    loaded = {name for name in said if not name.startswith("sinuous.kernels.compil")}
    assert len(loaded) > 20
    assert loaded <= sources.reached_from(f"sinuous.{module}")


def test_a_stamp_changes_with_what_is_imported_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = dict(sources.read_sources())
    growing, step = (str(sources.PACKAGE / "kernels" / name) for name in ("growing/grow.py", "step/newton.py"))
    before = [sources.stamp_of(file) for file in (growing, step)]

    def change(name: str) -> None:
        texts[name] = texts[name]._replace(text=texts[name].text + b"# a change")

    change("sinuous.kernels.growing.grow")
    monkeypatch.setattr(sources, "read_sources", lambda: texts)
    sources.stamp_of.cache_clear()
    assert sources.stamp_of(growing) != before[0]
    assert sources.stamp_of(step) == before[1]
    change("sinuous.kernels.maths.vectors")
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
