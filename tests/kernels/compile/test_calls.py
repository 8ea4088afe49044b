"""What kernels hand to each other arrives as it was, and so does what they return.

Numba by itself runs with versions that were not tried. That it does the same: `test_conformance`.

What is compiled is said before it begins, once, with what and how long.
"""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from sinuous.kernels import compile as compiling
from sinuous.kernels.compile import entry, kernel, shared, store, tiers
from sinuous.kernels.maths.vectors import Array


class Pair(NamedTuple):
    """Arrays of two kinds, a number and a flag.

    Attributes
    ----------
    table : array (n, m)
    marks : array (n,) int32
    height : float
    known : bool
    """

    table: Array
    marks: Array
    height: float
    known: bool


@kernel
def seen(array: Array) -> tuple[int, int, int, int, float]:
    """All that a kernel may ask of an array (n, m)."""
    n, m = array.shape
    return n, m, array.size, len(array), array[n - 1, m - 1] + array[0, m - 1]


@kernel
def bits(array: Array) -> tuple[Array, int]:
    """The numbers of an array (n,) as whole numbers; Numba compiles what this takes by itself."""
    return array[:2].view(np.int64), array.size


@kernel
def corner(array: Array) -> tuple[Array, int]:
    return array[1:, 1], 1


@kernel
def cube(array: Array) -> float:
    """The sum of some places of an array (a, b, c)."""
    return float(array[1, 2, 3] + 10.0 * array[0, 2, 1] + 100.0 * array.shape[0] * array.size)


@kernel
def turned(pair: Pair) -> Pair:
    return Pair(pair.table[::-1, :], pair.marks[1:], -pair.height, not pair.known)


@kernel
def perhaps(pair: Pair, wanted: bool) -> Pair | None:
    if wanted:
        return pair
    return None


@kernel
def fill(array: Array, value: float) -> None:
    for i in range(array.shape[0]):
        array[i] += value


@kernel
def is_large(value: float) -> bool:
    return value > 3.0


@kernel
def farthest(points: Array, pair: tuple[float, Array]) -> tuple[float, Array]:
    """A variable that changes in a loop, and others that live in it, or beyond."""
    best, most = pair, 0.0
    for i in range(points.shape[0]):
        row = points[i]
        if row[0] > best[0]:
            best = (row[0], row)
            most += row[1]
    return best[0] + most, best[1]


@shared
def sum_of(pair: Pair) -> float:
    total = pair.height if pair.known else 0.0
    for i in range(pair.marks.shape[0]):
        total += pair.marks[i] * pair.table[i, 0]
    return total


@entry
def all_of_it(table: Array, marks: Array, volume: Array, row: Array) -> Any:
    pair = turned(Pair(table, marks, 7.0, False))
    fill(row, 0.5)
    some, none = perhaps(pair, True), perhaps(pair, False)
    first = 0.0 if some is None else some.table[0, 1]
    second = 1.0 if none is None else none.table[0, 1]
    side, _ = corner(pair.table)
    whole, _ = bits(volume[0, 0])
    height, place = farthest(table, (2.0, row))
    return (
        seen(table),
        seen(pair.table),
        seen(table[:, 1:]),
        side[side.shape[0] - 1],
        cube(volume),
        cube(volume[:, ::-1, :]),
        sum_of(pair),
        sum_of(Pair(table, marks, 1.0, True)),
        first,
        second,
        is_large(first),
        row.sum(),
        whole[1],
        height + 100.0 * place[2],
    )


def arguments() -> tuple[Array, ...]:
    counted = np.arange(24.0)
    marks: Any = np.arange(4, dtype=np.int32)
    return counted[:12].reshape(4, 3).copy(), marks, counted.reshape(2, 3, 4).copy(), counted[:5].copy()


def test_arrays_and_results_are_those_of_python() -> None:
    expected = all_of_it.interpreted(*arguments())  # type: ignore[attr-defined]
    assert all_of_it(*arguments()) == expected
    assert expected[0] == (4, 3, 12, 4, 13.0)
    assert expected[1] == (4, 3, 12, 4, 13.0)


def test_arrays_of_other_layouts_keep_their_strides() -> None:
    table, marks, volume, row = arguments()
    other = np.asfortranarray(table), np.repeat(marks, 2)[::2], volume.transpose(0, 2, 1).copy().transpose(0, 2, 1)
    assert all_of_it(*other, np.repeat(row, 3)[::3]) == all_of_it.interpreted(*arguments())  # type: ignore[attr-defined]


@kernel
def third(values: tuple[float, float], i: int) -> float:
    return values[i]


@entry
def third_or(values: tuple[float, float], i: int) -> float:
    return third(values, i) + 1.0


def test_what_python_raises_is_zero_in_machine_code() -> None:
    assert third_or((2.0, 3.0), 1) == 4.0
    assert third_or((2.0, 3.0), 5) == 1.0
    with pytest.raises(IndexError):
        third_or.interpreted((2.0, 3.0), 5)  # type: ignore[attr-defined]


ROOT = Path(__file__).parents[3]

OTHER = """
import sys
import numba
numba.__version__ = "9.1.0"
from sinuous.kernels.compile import sources
from tests.kernels.compile import parts
assert sources.COMPILER == "numba"
assert not {f"sinuous.kernels.compile.{name}" for name in ("once",)} & sys.modules.keys()
assert parts.thrice_the_longest(3.0, 4.0) == 27.0
assert parts.twice_the_shortest(3.0, -4.0) == 6.0
print(sum(parts.thrice_the_longest.stats.cache_hits.values()))
"""


def test_with_another_version_numba_compiles_by_itself_and_its_code_is_kept(tmp_path: Path) -> None:
    words = {**os.environ, "SINUOUS_CACHE": str(tmp_path), "SINUOUS_KERNELS": "compiled"}
    for read in (0, 1):
        ran = subprocess.run(
            [sys.executable, "-c", OTHER], cwd=ROOT, env=words, capture_output=True, text=True, check=True
        )
        assert (ran.stdout, ran.stderr) == (f"{read}\n", "")


def test_another_compiler_is_refused() -> None:
    command, words = [sys.executable, "-c", "import sinuous.kernels.compile"], {**os.environ, "SINUOUS_COMPILER": "gcc"}
    ran = subprocess.run(command, env=words, capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert ran.stderr.splitlines()[-1].endswith("unknown SINUOUS_COMPILER 'gcc'; expected one of linked, numba")


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[int], Any]:
    """Make an entry, with a cache of its own, that belongs to a piece of so many seconds."""
    monkeypatch.setattr(store, "CACHE", tmp_path)
    monkeypatch.setattr(tiers, "_announced", [])

    def make(seconds: int) -> Any:
        name = f"{half.__module__.partition('.')[2]}.{half.__name__}"
        monkeypatch.setattr(tiers, "PIECES", (tiers.Piece("halves", seconds, (name,)),))
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
    monkeypatch.setattr(tiers, "_announced", [])
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
