"""The harness: an interrupted run goes on, and figures from elsewhere stay out."""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks.harness import INTERRUPTED, Experiment, Goal, Journal, Line, Plan, conduct


def steps(plan: Plan, *ends: float | BaseException) -> Experiment:
    """Two parts of one line each, the second of which takes as long as is said, or breaks."""
    left = list(ends)

    def first(_: Plan) -> Iterator[Line]:
        yield Line("steps", "first", 1e-3, "ms", Goal(1.0), solved=(9, 10))

    def second(_: Plan) -> Iterator[Line]:
        end = left.pop(0)
        if isinstance(end, BaseException):
            raise end
        yield Line("steps", "second", end, "ms")

    return Experiment.of("steps", plan, {"first": first, "second": second})


def test_results_are_written_and_say_where_they_come_from(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert conduct(steps(Plan(7), 2e-3), tmp_path, tmp_path) == 0
    text = (tmp_path / "steps.md").read_text()
    facts = {row.partition(":")[0] for row in text.splitlines()}
    assert {"- processor", "- python", "- numba", "- sinuous", "- seed"} <= facts
    assert "1 ms | held |" in text
    assert (tmp_path / "steps.txt").read_text() == f"# steps\n\n{text}"
    assert capsys.readouterr().out == text


def test_an_interrupted_run_goes_on_where_it_was(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert conduct(steps(Plan(), KeyboardInterrupt()), tmp_path) == INTERRUPTED
    assert "interrupted after 1 of 2 pieces" in capsys.readouterr().err
    assert conduct(steps(Plan(), 2e-3), tmp_path) == 0
    assert conduct(steps(Plan()), tmp_path) == 0
    assert "all of this was measured before" in capsys.readouterr().err


@pytest.mark.parametrize("plan", [Plan(1), Plan(0, quick=True)])
def test_another_seed_or_size_is_another_experiment(tmp_path: Path, plan: Plan) -> None:
    """What the first run measured is not read: the other breaks."""
    conduct(steps(Plan(), 2e-3), tmp_path)
    assert conduct(steps(plan, KeyboardInterrupt()), tmp_path) == INTERRUPTED


def test_a_wrong_claim_is_an_exit_code(tmp_path: Path) -> None:
    wrong = {"claims": lambda _: [Line("steps", "false claims", 2.0, "", Goal(0.0, correctness=True))]}
    assert conduct(Experiment.of("steps", Plan(), wrong), tmp_path) == 1
    assert "WRONG" in (tmp_path / "steps.md").read_text()


def test_what_was_being_written_when_a_run_was_killed_is_no_piece(tmp_path: Path) -> None:
    Journal(tmp_path, {"seed": 3}).add("a", math.inf, 0.0)
    (folder,) = tmp_path.iterdir()
    (folder / "1.new").write_bytes(b"\x80")
    again = Journal(tmp_path, {"seed": 3})
    assert again.pieces == {"a": math.inf}
    again.add("c", 3, 0.0)
    assert Journal(tmp_path, {"seed": 3}).pieces == again.pieces
    assert not Journal(tmp_path, {"seed": 4}).pieces
