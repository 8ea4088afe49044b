"""The corpus: a piece is equal to itself, and what was changed in its answers is found."""

import gzip
import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from benchmarks import corpus
from benchmarks.__main__ import main
from benchmarks.corpus import PIECES, Problem, compared, written

ARM = sn.Robot.uniform(3, (45, 70), max_bend=2.0, radius=4.0)


def small() -> Iterator[Problem]:
    """Five problems, the last of which is refused."""
    for x in (0.0, 20.0, 40.0, 1e5):
        ask = partial(sn.solve, ARM, sn.Target((x, 0.0, 150.0)), time=30.0, max_starts=4)
        yield Problem(f"at {x:g}", ask, lambda found: found.verify().ok)
    yield Problem("refused", partial(sn.solve, ARM, sn.Target((0.0, 0.0, 150.0)), seed=-1))


@pytest.fixture(autouse=True)
def _piece(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PIECES, "small", small)


def test_a_piece_is_equal_to_itself() -> None:
    answers, slow = written("small")
    assert not slow
    found = compared("small", json.loads(json.dumps(answers)))
    assert (found.problems, found.differing) == (5, [])


def test_the_last_bit_of_a_number_counts_and_judges_say_that_the_answer_is_right() -> None:
    answers, _ = written("small")
    answers["at 20"]["q"][1][0] = float(np.nextafter(answers["at 20"]["q"][1][0], 9.0))
    [other] = compared("small", answers).differing
    assert (other.name, [each.key for each in other.differences], other.right) == ("at 20", ["q[1][0]"], True)


def test_an_exception_of_another_kind_differs() -> None:
    answers, _ = written("small")
    answers["refused"]["raises"] = "TypeError"
    assert [each.name for each in compared("small", answers).differing] == ["refused"]


@pytest.mark.parametrize(("change", "code"), [(0.0, 0), (1e-12, 1)])
def test_files_are_compared_by_the_command(
    change: float, code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    answers, _ = written("small")
    answers["at 40"]["position_error"] += change
    file = tmp_path / "answers.gz"
    with gzip.open(file, "wt") as lines:
        lines.write(json.dumps({"piece": "small", "answers": answers}) + "\n")
    assert main(["corpus", "compare", str(file), "--piece", "small", "--alone"]) == code
    assert f"5 problems, {code} different" in capsys.readouterr().out
    assert corpus.read(file)["small"].keys() == answers.keys()


@pytest.mark.parametrize("arguments", [["compare", "nowhere.gz"], ["compare", __file__, "--piece", "none"], ["look"]])
def test_what_cannot_be_meant_is_refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["corpus", *arguments]) == 2
    assert capsys.readouterr().err.count("\n") == 1
