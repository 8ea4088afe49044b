"""What is compiled is kept under a name that tells all it depends on, and read only if it is what was written."""

import errno
import multiprocessing
import os
import re
import subprocess
import sys
import tempfile
import time
from contextlib import redirect_stderr
from io import StringIO
from multiprocessing.queues import SimpleQueue
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from sinuous.kernels import compile as compiling
from sinuous.kernels.compile import store


def test_there_is_one_store_for_a_user_wherever_the_sources_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SINUOUS_CACHE", str(tmp_path / "own"))
    assert store.find_cache() == tmp_path / "own" / "kernels"
    assert store.find_cache().is_dir()
    monkeypatch.delenv("SINUOUS_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    monkeypatch.setattr(sys, "platform", "linux")
    assert store.find_cache() == tmp_path / "xdg" / "sinuous" / "kernels"
    (tmp_path / "xdg" / "sinuous" / "kernels").chmod(0o777)  # others may write there
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    found = store.find_cache()
    assert found.parent.parent == (tmp_path if hasattr(os, "getuid") else tmp_path / "xdg")


def test_what_nobody_uses_is_removed_and_what_is_too_much(tmp_path: Path) -> None:
    now = time.time()
    for name, days, size in (("a.1.code", 40, 1), ("b.2.code", 3, 100), ("c.3.code", 2, 100), ("other", 99, 1)):
        (tmp_path / name).write_bytes(b"x" * size)
        os.utime(tmp_path / name, (now - 86400 * days,) * 2)
    store.remove_old(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {"b.2.code", "c.3.code", "other"}
    store.remove_old(tmp_path, 150)
    assert {file.name for file in tmp_path.iterdir()} == {"c.3.code", "other"}


def half(x: float) -> float:
    return 0.5 * x


def third(x: float) -> float:
    return x / 3.0


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(store, "_told", set())
    monkeypatch.setattr(store, "CACHE", tmp_path / "cache")
    return tmp_path / "cache"


def loads(entry: Any) -> int:
    """How many forms of an entry were read from the disk."""
    return sum(entry.stats.cache_hits.values())


def test_what_was_compiled_is_read_for_the_same_function_and_arguments_alone(folder: Path) -> None:
    compiling.entry(half)(2.0)
    again, other = compiling.entry(half), compiling.entry(third)
    assert [again(3.0), again(np.ones(2)[:1][0]), again(3), other(3.0)] == [1.5, 0.5, 1.5, 1.0]
    assert (loads(again), loads(other)) == (1, 0)
    assert len(list(folder.glob("*.code"))) == 3


def test_what_is_not_as_it_was_written_is_compiled_anew(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    compiling.entry(half)(2.0)
    (file,) = folder.glob("*.code")
    whole = file.read_bytes()
    for broken in (b"", whole[:10], whole[:-1], whole[:200] + b"x" + whole[201:]):
        file.write_bytes(broken)
        again = compiling.entry(half)
        assert again(2.0) == 1.0
        assert loads(again) == 0
        assert file.read_bytes()[: store.DIGEST_SIZE] != broken[: store.DIGEST_SIZE] or len(broken) != len(whole)
    assert loads(again) == 0
    assert capsys.readouterr().err == f"sinuous: {file} is damaged, and compiled again\n"
    last = compiling.entry(half)
    assert last(2.0) == 1.0
    assert loads(last) == 1


@pytest.mark.parametrize("full", [True, False], ids=["disk is full", "no folder"])
def test_what_cannot_be_kept_is_no_error_and_said_once(
    full: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def refuse(path: Path, data: bytes) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    (tmp_path / "file").touch()
    monkeypatch.setattr(store, "_told", set())
    monkeypatch.setattr(store, "CACHE", tmp_path if full else tmp_path / "file" / "cache")
    if full:
        monkeypatch.setattr(store, "_write", refuse)
    for made in (half, third):
        assert compiling.entry(made)(6.0) == made(6.0)
    assert re.fullmatch(r"sinuous: compiled code cannot be kept in .*\n", capsys.readouterr().err)


def test_what_was_compiled_of_other_sources_is_neither_kept_nor_read(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Somebody switched to another branch after this process had imported what it runs."""
    monkeypatch.setattr(store, "unchanged", lambda file: False)
    assert compiling.entry(half)(2.0) == 1.0
    assert not list(folder.glob("*.code"))
    assert capsys.readouterr().err.startswith("sinuous: sources were changed while this program ran")
    monkeypatch.undo()
    monkeypatch.setattr(store, "CACHE", folder)
    compiling.entry(half)(2.0)
    monkeypatch.setattr(store, "unchanged", lambda file: False)
    again = compiling.entry(half)
    assert again(2.0) == 1.0
    assert loads(again) == 0


class Used(NamedTuple):
    """What an entry returned, how many forms of it and of what it calls were read, and what was told."""

    value: float
    read: tuple[int, ...]
    told: str


def use(folder: Path, entry: str, calls: tuple[str, ...], said: SimpleQueue[Used]) -> None:
    """Use an entry of `parts` whose code is kept in a folder."""
    store.CACHE = folder
    from tests.kernels.compile import parts  # entries keep to the folder that there is when they are made

    used = [vars(parts)[entry], *(compiling.compiled_form(vars(parts)[name]) for name in calls)]
    with redirect_stderr(StringIO()) as told:
        value = used[0](3.0, 4.0)
    said.put(Used(value, tuple(map(loads, used)), told.getvalue()))


def used(folder: Path, entry: str, *calls: str, processes: int = 1) -> list[Used]:
    """What processes that begin now say, each of which has compiled and read nothing yet."""
    context = multiprocessing.get_context("spawn")
    said = context.SimpleQueue()
    begun = [context.Process(target=use, args=(folder, entry, calls, said)) for _ in range(processes)]
    for process in begun:
        process.start()
    for process in begun:
        process.join()
        assert process.exitcode == 0
    return [said.get() for _ in begun]


def test_processes_that_compile_at_once_do_not_break_each_other(tmp_path: Path) -> None:
    """Both begin with nothing; whoever comes last reads what they wrote, whoever wrote it."""
    what = tmp_path, "twice_the_norm", "square", "norm"
    assert [each.value for each in used(*what, processes=2)] == [10.0, 10.0]
    assert used(*what) == [(10.0, (1, 0, 0), "")]
    for file in tmp_path.glob("twice*"):
        file.unlink()
    assert used(*what) == [(10.0, (0, 1, 1), "")]  # the entry is gone, what it calls is not
    for file in tmp_path.glob("*"):
        if not file.name.startswith("norm"):
            file.unlink()
    assert used(*what) == [(10.0, (0, 0, 1), "")]
    assert not [file for file in tmp_path.iterdir() if len(file.suffixes) > 2]


ENTER = """
import sys
from pathlib import Path
from sinuous.kernels.compile import store
store.CACHE = Path(sys.argv[1])
from tests.kernels.compile import parts
print(parts.thrice_the_longest(3.0, 4.0), "numba.np.linalg" in sys.modules)
"""


def test_an_entry_is_read_with_the_shared_kernels_that_it_calls(tmp_path: Path) -> None:
    """What it takes to compile, half of a second, is imported only where something is compiled."""
    for compiles in (True, False):
        command, here = [sys.executable, "-c", ENTER, str(tmp_path)], Path(__file__).parents[3]
        ran = subprocess.run(command, cwd=here, capture_output=True, text=True, check=True)
        assert (ran.stdout, ran.stderr) == (f"27.0 {compiles}\n", "")
    what = tmp_path, "thrice_the_longest", "longest", "norm"
    assert used(*what) == [(27.0, (1, 1, 0), "")]
    (file,) = tmp_path.glob("longest*.code")
    file.unlink()
    assert used(*what) == [(27.0, (1, 0, 1), "")]
    (file,) = tmp_path.glob("longest*.code")
    file.write_bytes(file.read_bytes()[:-1])
    assert used(*what) == [(27.0, (1, 0, 1), f"sinuous: {file} is damaged, and compiled again\n")]
    assert used(*what) == [(27.0, (1, 1, 0), "")]
