"""What is not compiled yet is interpreted, and compiled beside it, in processes that end with the program."""

import multiprocessing
import os
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from multiprocessing.queues import SimpleQueue
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sinuous.base.progress import AbandonedError
from sinuous.kernels import compile as compiling
from sinuous.kernels.compile import helpers, store, tiers
from sinuous.kernels.maths.vectors import Array
from tests.base.processes import alive, until
from tests.kernels.compile import parts

HERE = Path(__file__).parents[3]


class Orders(list[helpers.CompileOrder]):
    """A foreman without helpers."""

    taken = True

    def order(self, order: helpers.CompileOrder) -> bool:
        """Note it."""
        self.append(order)
        return self.taken


@pytest.fixture
def orders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Orders:
    """Let entries of this file belong to a piece that takes 9 s, in a store of its own, and nothing be compiled."""
    monkeypatch.setattr(store, "CACHE", tmp_path)
    monkeypatch.setattr(tiers, "MODE", "auto")
    monkeypatch.setattr(tiers, "_told", [])
    monkeypatch.setattr(tiers, "_spent", defaultdict(float))
    monkeypatch.setattr(tiers, "begun", lambda: True)
    monkeypatch.setattr(tiers, "_announced", [])
    monkeypatch.setattr(tiers, "PIECES", (piece(9),))
    noted = Orders()
    monkeypatch.setattr(tiers, "foreman", noted)
    return noted


def piece(seconds: int, **more: Any) -> tiers.Piece:
    names = (half, fill)
    entries = tuple(f"{one.__module__.partition('.')[2]}.{one.__name__}" for one in names)
    return tiers.Piece("halves", seconds, entries, **more)


def half(x: float) -> float:
    return 0.5 * x


def fill(out: Array, x: float) -> int:
    """Fill an array, whose first place counts how often it is begun, until somebody asks for the time."""
    out[0] += 1.0
    for i in range(1, out.shape[0]):
        out[i] = x
    return 1


def test_a_call_without_code_is_interpreted_and_its_code_ordered_once_it_is_there_that_is_called(
    orders: Orders, capsys: pytest.CaptureFixture[str]
) -> None:
    entry: Any = compiling.entry(half)
    assert entry(3.0) == 1.5
    assert entry(4.0) == 2.0
    assert entry.signatures == []
    first, second = orders
    assert (first.name, first.path) == ("half", second.path)
    said = capsys.readouterr().err
    assert said == (
        "sinuous: first use of some kernels on this machine: they are compiled in the background (about 9 s); "
        "until then answers take longer; 'sinuous warm' compiles everything ahead\n"
    )
    other: Any = compiling.entry(half)  # as a helper
    with tiers.code_first():
        other(1.0)
    assert first.path.exists()
    assert entry(5.0) == 2.5
    assert len(entry.signatures) == 1
    assert sum(entry.stats.cache_hits.values()) == 1
    assert len(orders) == 2


WAITS = ["heavy", "large", "code first", "no helpers", "compiled", "sources changed"]


@pytest.mark.parametrize("why", WAITS)
def test_a_call_waits_for_its_code_where_that_is_better(
    why: str, orders: Orders, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tiers, "PIECES", (piece(9, most={"heavy": 0, "large": 3}.get(why)),))
    monkeypatch.setattr(tiers, "MODE", "compiled" if why == "compiled" else "auto")
    orders.taken = why != "no helpers"
    entry: Any = compiling.entry(fill)
    if why == "sources changed":
        monkeypatch.setattr(store, "unchanged", lambda file: False)
    with tiers.code_first(why == "code first"):
        assert entry(np.zeros(4), 1.5) == 1
    assert (len(entry.signatures), len(orders)) == (1, why == "no helpers")
    assert "compiling halves" in capsys.readouterr().err
    assert tiers._Waiting.count == 0


@pytest.mark.parametrize("there", [True, False], ids=["code is there", "long enough"])
def test_an_interpreted_call_is_abandoned_and_made_again_with_its_code(
    there: bool, orders: Orders, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once the code is there, or compiling it makes the answer little later; and everything is as it was before."""
    entry: Any = compiling.entry(fill)
    values, ends = np.zeros(5), []

    def interpreted(out: Array, x: float, end: Callable[[], bool]) -> int:
        out[:3] = -9.0
        ends.append(end())
        if there:
            with tiers.code_first():
                compiling.entry(fill)(np.zeros(5), 1.0)  # as a helper
        else:
            monkeypatch.setattr(time, "thread_time", lambda: 1e9)
        ends.append(end())
        raise AbandonedError

    entry._compile_for_args = tiers.tiered(compiling.entry(fill), interpreted)._compile_for_args
    assert entry(values, 2.0) == 1
    assert ends == [False, True]
    np.testing.assert_array_equal(values, [1.0, 2.0, 2.0, 2.0, 2.0])
    assert len(orders) == 1
    monkeypatch.undo()


@pytest.fixture
def foreman() -> Iterator[helpers.Foreman]:
    made = helpers.Foreman(1)
    yield made
    made.dismiss()


def order(folder: Path, name: str = "twice_the_norm", signature: Any = None) -> helpers.CompileOrder:
    """An order of the entry of `parts`, in a store there."""
    from numba import types

    signature = signature or (types.float64, types.float64)
    return helpers.CompileOrder(parts.__name__, name, signature, folder / f"{name}.code")


def home(folder: Path) -> dict[str, str]:
    """Words of the environment of helpers, with which they have a store of their own, and find the tests."""
    return {"SINUOUS_CACHE": str(folder), "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE / "src")])}


@pytest.fixture
def at_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name, word in home(tmp_path).items():
        monkeypatch.setenv(name, word)
    return tmp_path / "kernels"


def test_a_helper_compiles_into_the_store_and_says_what_it_cannot(foreman: helpers.Foreman, at_home: Path) -> None:
    wrong, right = order(at_home, "nothing"), order(at_home)
    assert foreman.order(wrong)
    assert foreman.order(right)
    assert until(lambda: bool(list(at_home.glob("twice*.code"))))
    assert until(lambda: not foreman.order(wrong))
    assert foreman.order(right)
    assert not foreman.given_up


def give_order(folder: Path, words: dict[str, str], said: "SimpleQueue[int]") -> None:
    """Order something, say which process compiles it, and go on for a while."""
    os.environ.update(words)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    assert helpers.foreman.order(order(folder))
    while not helpers.foreman._processes:
        time.sleep(0.01)
    said.put(helpers.foreman._processes[0].pid)
    time.sleep(60)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_helpers_end_with_their_program(end: int, tmp_path: Path) -> None:
    context = multiprocessing.get_context("spawn")
    said = context.SimpleQueue()
    program = context.Process(target=give_order, args=(tmp_path / "kernels", home(tmp_path), said))
    program.start()
    helper = said.get()
    os.kill(program.pid or 0, end)
    program.join()
    assert until(lambda: not alive(helper))
