"""The harness: an interrupted run goes on, and figures from elsewhere stay out."""

import json
import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from benchmarks.harness.conduct import INTERRUPTED, NAME, Journal, conduct
from benchmarks.harness.experiment import Experiment, Plan
from benchmarks.harness.lines import Goal, Line
from sinuous.base.errors import InputError


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
    written, text = json.loads((tmp_path / "steps.json").read_text()), (tmp_path / "steps.md").read_text()
    assert ([line["reached"] for line in written["lines"]], written["seed"]) == ([1e-3, 2e-3], 7)
    assert {"processor", "python", "numba", "sinuous"} <= set(written["machine"])
    assert "- processor: " in text
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
    conduct(steps(Plan(), 2e-3), tmp_path)
    with pytest.raises(InputError, match=r"(seed was 0, is 1|quick was False, is True)"):
        conduct(steps(plan), tmp_path)


def test_a_wrong_claim_is_an_exit_code(tmp_path: Path) -> None:
    wrong = {"claims": lambda _: [Line("steps", "false claims", 2.0, "", Goal(0.0, correctness=True))]}
    assert conduct(Experiment.of("steps", Plan(), wrong), tmp_path) == 1
    assert "WRONG" in (tmp_path / "steps.md").read_text()


@pytest.mark.parametrize("torn", ['{"piece": "b", "mea', '{"piece": "b", "measured": 2}', "\n", "3\n", "\0\0\0"])
def test_a_torn_end_of_a_journal_costs_that_line_only(tmp_path: Path, torn: str) -> None:
    Journal.open(tmp_path, {"seed": 3}).add("a", {"clearance": math.inf})
    with (tmp_path / NAME).open("a") as stream:
        stream.write(torn)
    again = Journal.open(tmp_path, {"seed": 3})
    assert again.pieces == {"a": {"clearance": None}}
    again.add("c", 3)
    assert Journal.open(tmp_path, {"seed": 3}).pieces == {"a": {"clearance": None}, "c": 3}
