"""What is compiled is kept under a name that tells all it depends on, and read only if it is what was written."""

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.kernels import compile as compiling
from sinuous.kernels.compiling import store
from sinuous.kernels.compiling.sources import sources_hash


def test_the_cache_is_named_by_the_sources() -> None:
    assert store.CACHE.name == sources_hash()
    assert store.CACHE.is_dir()


def test_caches_that_nobody_uses_are_removed_when_a_new_one_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    parent = tmp_path / "sinuous"
    monkeypatch.setattr(store, "places", lambda name: [parent / name])
    monkeypatch.setattr(store, "PACKAGE", tmp_path / "a file")
    (tmp_path / "a file").touch()  # no folder can be made there
    old, late, other = parent / ("0" * 16), parent / ("1" * 16), parent / "samples"
    for folder, days in ((old, 30), (late, 3), (other, 300)):
        folder.mkdir(parents=True)
        (folder / "kernel.code").touch()
        os.utime(folder, (time.time() - 86400 * days,) * 2)
    found = store.find_cache()
    assert found == parent / sources_hash()
    assert not old.exists()
    assert (late / "kernel.code").exists()
    assert other.exists()
    # One that is there already is used, and that it is used is noted: it removes nothing and is not removed.
    os.utime(found, (0.0, 0.0))
    os.utime(late, (0.0, 0.0))
    assert store.find_cache() == found
    assert time.time() - found.stat().st_mtime < 3600
    assert late.exists()


def half(x: float) -> float:
    return 0.5 * x


def third(x: float) -> float:
    return x / 3.0


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(store, "CACHE", tmp_path / "cache")
    return tmp_path / "cache"


def loads(entry: Any) -> int:
    """How many forms of an entry were read from the disk."""
    return sum(entry.stats.cache_hits.values())


def test_what_another_version_of_the_sources_compiled_is_taken_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    earlier, later, other = (tmp_path / name for name in ("0" * 16, "1" * 16, "other"))
    for folder, taken in ((earlier, 0), (later, 1), (other / "cache", 0)):
        monkeypatch.setattr(store, "CACHE", folder)
        half_of = compiling.entry(half)
        assert half_of(3.0) == 1.5
        assert loads(half_of) == taken
    (file,) = later.iterdir()
    assert file.read_bytes() == (earlier / file.name).read_bytes()


@pytest.mark.usefixtures("folder")
def test_what_was_compiled_is_read_for_the_same_arguments_alone() -> None:
    compiling.entry(half)(2.0)
    again = compiling.entry(half)
    assert again(3.0) == 1.5
    assert loads(again) == 1
    assert again(np.ones(2)[:1][0]) == 0.5
    assert again(3) == 1.5
    assert loads(again) == 1
    other = compiling.entry(third)
    assert other(3.0) == 1.0
    assert loads(other) == 0


def test_what_is_not_as_it_was_written_is_compiled_anew(folder: Path) -> None:
    compiling.entry(half)(2.0)
    (file,) = folder.iterdir()
    whole = file.read_bytes()
    for broken in (b"", whole[:10], whole[:-1], whole[:200] + b"x" + whole[201:]):
        file.write_bytes(broken)
        again = compiling.entry(half)
        assert again(2.0) == 1.0
        assert loads(again) == 0
        assert file.read_bytes()[: store.DIGEST_SIZE] != broken[: store.DIGEST_SIZE] or len(broken) != len(whole)
    assert loads(again) == 0
    last = compiling.entry(half)
    assert last(2.0) == 1.0
    assert loads(last) == 1


def test_the_code_of_another_function_is_not_taken_for_it(folder: Path) -> None:
    """As Numba's own cache would, where two processes write one file at once."""
    compiling.entry(half)(2.0)
    compiling.entry(third)(2.0)
    assert len({file.name for file in folder.iterdir()}) == 2
    made: Any = compiling.entry(half)
    context = made.targetctx
    names = {store.Store(f, kind)._path(s, context.codegen()) for f in (half, third) for kind in "ab" for s in "xy"}
    assert len(names) == 8


def test_a_folder_that_cannot_be_written_to_is_no_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setattr(store, "CACHE", tmp_path / "file" / "cache")
    assert compiling.entry(half)(2.0) == 1.0


USE = """
import sys
from pathlib import Path
from sinuous.kernels.compiling import store
from sinuous.kernels.compiling.sources import sources_hash
store.CACHE = Path(sys.argv[1])
from tests.kernels.compiling import parts
print(parts.twice_the_norm(3.0, 4.0), sum(parts.twice_the_norm.stats.cache_hits.values()))
print(sum(sum(one.stats.cache_hits.values()) for one in (parts.square, parts.norm)))
"""


def test_processes_that_compile_at_once_do_not_break_each_other(tmp_path: Path) -> None:
    """Both begin with nothing; whoever comes last reads what they wrote, whoever wrote it."""
    command = [sys.executable, "-c", USE, str(tmp_path)]
    here = Path(__file__).parents[3]
    both = [subprocess.Popen(command, cwd=here, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    said = [process.communicate()[0] for process in both]
    assert [each.split()[0] for each in said] == ["10.0", "10.0"]
    assert subprocess.run(command, cwd=here, capture_output=True, text=True, check=True).stdout.split() == [
        "10.0",
        "1",
        "0",
    ]
    for file in tmp_path.glob("twice*"):
        file.unlink()
    # The entry is gone, what it calls is not.
    assert subprocess.run(command, cwd=here, capture_output=True, text=True, check=True).stdout.split() == [
        "10.0",
        "0",
        "2",
    ]
    for file in tmp_path.glob("*"):
        if not file.name.startswith("norm"):
            file.unlink()
    assert subprocess.run(command, cwd=here, capture_output=True, text=True, check=True).stdout.split()[:2] == [
        "10.0",
        "0",
    ]
    assert not list(tmp_path.glob("*.code.*"))
