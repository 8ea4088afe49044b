"""Work in processes: every item once, in order, and each process on a core of its own."""

import json
import os
import warnings
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from benchmarks.harness.conduct import INTERRUPTED, Output, conduct
from benchmarks.harness.experiment import Divided, OfLines
from benchmarks.harness.journal import Journal
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.solvers import parallel
from benchmarks.solvers.parallel import Abreast, in_processes
from sinuous.base.errors import warn_of


def square(number: int) -> int:
    return number * number


def cores_of(_: int) -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


def test_results_come_in_order() -> None:
    assert list(in_processes(square, range(7), chunk=2)) == [n * n for n in range(7)]
    assert list(in_processes(square, range(3), alone=True)) == [0, 1, 4]


def test_processes_keep_to_their_cores() -> None:
    assert set(in_processes(cores_of, range(3))) == {1}


def heard(_: int) -> int:
    """How many warnings of an odd problem are heard."""
    with warnings.catch_warnings(record=True) as caught:
        warn_of(["odd"])
    return len(caught)


def test_odd_problems_are_not_complained_of() -> None:
    assert set(in_processes(heard, range(3))) == {0}


def test_processes_end_when_what_gathers_stops() -> None:
    """As at an interrupt; afterwards there are new ones."""
    results = in_processes(square, range(1000))
    assert next(results) == 0
    before = parallel._pool()
    results.close()  # type: ignore[attr-defined]
    with pytest.raises(RuntimeError, match="shutdown"):
        before.submit(square, 1)
    assert list(in_processes(square, range(2))) == [0, 1]


def summed(shares: list[int]) -> list[Line]:
    return [Line("sums", "of squares", float(sum(shares)), "", note=f"{len(shares)} shares")]


class Squares(Abreast, OfLines):
    """Numbers that are squared in any order."""

    def __init__(self, count: int = 8) -> None:
        super().__init__("squares", Plan())
        self.count = count

    def parts(self) -> Iterator[tuple[str, Divided]]:
        yield "squares", Divided([partial(square, i) for i in range(self.count)], summed)


def test_an_interrupted_run_in_processes_loses_nothing_that_was_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    add = Journal.add

    def interrupted(journal: Journal, piece: str, measured: Any) -> None:
        if len(journal.pieces) == 3:
            raise KeyboardInterrupt
        add(journal, piece, measured)

    monkeypatch.setattr(Journal, "add", interrupted)
    assert conduct(Squares(), Output(tmp_path)) == INTERRUPTED
    assert "after 3 of 8 pieces" in capsys.readouterr().err
    assert json.loads((tmp_path / "squares.json").read_text())["lines"][0]["note"] == "3 shares"
    monkeypatch.setattr(Journal, "add", add)
    assert conduct(Squares(), Output(tmp_path)) == 0
    (line,) = json.loads((tmp_path / "squares.json").read_text())["lines"]
    assert (line["reached"], line["note"]) == (140.0, "8 shares")
    named = [json.loads(row).get("piece") for row in (tmp_path / "journal.jsonl").read_text().splitlines()]
    assert sorted(named[1:]) == [f"squares, {share} of 8, round 0" for share in range(1, 9)]


def test_what_breaks_in_a_process_ends_the_others() -> None:
    before = parallel._pool()
    with pytest.raises(TypeError):
        list(Squares().done([("none", partial(square, None))]))  # type: ignore[arg-type]
    with pytest.raises(RuntimeError, match="shutdown"):
        before.submit(square, 1)
