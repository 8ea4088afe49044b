"""The harness: an interrupted run goes on, figures from elsewhere stay out, what is worse is caught, noise passes."""

import dataclasses
import json
import math
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.harness import reference
from benchmarks.harness.baseline import Comparison, _kept, _line, compare
from benchmarks.harness.conduct import INTERRUPTED, NAME, Journal, Output, conduct
from benchmarks.harness.experiment import Experiment, Plan
from benchmarks.harness.lines import Goal, Line, together
from benchmarks.harness.reference import Look
from sinuous.base.errors import InputError
from sinuous.files.documents import json_line
from tests.cases import with_each


@pytest.fixture
def steady(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that is always equally fast."""
    monkeypatch.setattr(reference, "look", lambda: Look(5e-4, 0.0))


def steps(plan: Plan, *ends: float | BaseException) -> Experiment:
    """Two parts of one line each, the second of which takes as long as is said, in each round, or breaks."""
    left = list(ends)

    def first(_: Plan) -> Iterator[Line]:
        yield Line("steps", "first", 1e-3, "ms", Goal(1.0), solved=(9, 10))

    def second(_: Plan) -> Iterator[Line]:
        end = left.pop(0)
        if isinstance(end, BaseException):
            raise end
        yield Line("steps", "second", end, "ms")

    return Experiment.of("steps", plan, {"first": first, "second": second})


@pytest.mark.usefixtures("steady")
def test_results_are_written_and_say_where_they_come_from(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert conduct(steps(Plan(7), 2e-3), Output(tmp_path, record=tmp_path)) == 0
    written, text = json.loads((tmp_path / "steps.json").read_text()), (tmp_path / "steps.md").read_text()
    assert ([line["reached"] for line in written["lines"]], written["seed"]) == ([1e-3, 2e-3], 7)
    assert {"processor", "python", "numba", "sinuous"} <= set(written["machine"])
    assert "- processor: " in text
    assert (tmp_path / "steps.txt").read_text() == f"# steps\n\n{text}"
    assert capsys.readouterr().out == text


@pytest.mark.usefixtures("steady")
def test_an_interrupted_run_goes_on_where_it_was(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    output = Output(tmp_path)
    assert conduct(steps(Plan(), KeyboardInterrupt()), output) == INTERRUPTED
    assert "interrupted after 1 of 2 pieces" in capsys.readouterr().err
    assert conduct(steps(Plan(), 2e-3), output) == 0
    assert conduct(steps(Plan()), output) == 0
    assert "all of this was measured before" in capsys.readouterr().err


@pytest.mark.usefixtures("steady")
def test_a_baseline_is_kept_and_compared_with(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What seems worse is measured again before it counts."""
    baseline = tmp_path / "baseline.json"
    assert conduct(steps(Plan(), 2e-3), Output(tmp_path / "a", save_baseline=baseline)) == 0
    assert conduct(steps(Plan()), Output(tmp_path / "a", against=baseline)) == 0
    assert "2 figures compared: 0 worse, 0 better" in capsys.readouterr().out
    slower = Output(tmp_path / "b", against=baseline)
    assert conduct(steps(Plan(), 2e-2, 2.2e-2, 2.1e-2), slower) == 1
    (change,) = json.loads((tmp_path / "b" / "steps.json").read_text())["against"]["changes"]
    assert (change["what"], change["before"], change["now"], change["worse"]) == ("second", "2 ms", "21 ms", True)
    assert conduct(steps(Plan(), 2e-2, 2.1e-3), Output(tmp_path / "d", against=baseline)) == 0
    assert "second, round 1: measured again, for something seems worse" in capsys.readouterr().err
    with pytest.raises(InputError, match="--against"):
        conduct(steps(Plan(1)), Output(tmp_path / "c", against=baseline))
    assert not (tmp_path / "c").exists()


@pytest.mark.usefixtures("steady")
@pytest.mark.parametrize("plan", [Plan(1), Plan(0, quick=True)])
def test_another_seed_or_size_is_another_experiment(tmp_path: Path, plan: Plan) -> None:
    conduct(steps(Plan(), 2e-3), Output(tmp_path))
    with pytest.raises(InputError, match=r"(seed was 0, is 1|quick was False, is True)"):
        conduct(steps(plan), Output(tmp_path))


@pytest.mark.usefixtures("steady")
def test_a_wrong_claim_is_an_exit_code(tmp_path: Path) -> None:
    wrong = {"claims": lambda _: [Line("steps", "false claims", 2.0, "", Goal(0.0, correctness=True))]}
    assert conduct(Experiment.of("steps", Plan(), wrong), Output(tmp_path)) == 1
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


TIME = Line("cold", "solve", 9e-6, "us", Goal(15e-6), solved=(2000, 2000), reference=5e-4)
RATE = Line("clouds", "updates", 30.0, "/s", Goal(10.0, at_most=False), reference=5e-4)
RATIO = Line("rivals", "faster than others", 80.0, "x", Goal(50.0, at_most=False), reference=5e-4)
SHARE = Line("reachable", "solved", 100.0, "%", Goal(100.0, False, True), solved=(10_000, 10_000), reference=5e-4)
FALSE = Line("honesty", "false claims", 0.0, "", Goal(0, correctness=True), reference=5e-4)
LEAK = Line("endurance", "growth", 10.0, "KiB", Goal(1024.0, correctness=True), reference=5e-4)
EXTRA = Line("fields", "a mesh adds", 0.0, "us", Goal(20e-6), slack=2e-6, reference=5e-4)
PLACES = Line("clutter", "spheres", 100.0, "%", Goal(99.0, at_most=False), solved=(60, 60), reference=5e-4)
ALL = [TIME, RATE, RATIO, SHARE, FALSE, LEAK, EXTRA, PLACES]


def against(before: list[Line], now: list[Line]) -> Comparison:
    return compare([_line(json.loads(json_line(_kept(line)))) for line in before], now)


def changed(line: Line, reached: float, **others: object) -> Line:
    return dataclasses.replace(line, reached=reached, **others)  # type: ignore[arg-type]


@with_each(
    "now",
    [
        changed(TIME, 12e-6),
        changed(TIME, 9e-6, solved=(1998, 2000)),
        changed(TIME, math.inf),
        changed(RATE, 20.0),
        changed(RATIO, 60.0),
        changed(SHARE, 99.99, solved=(9999, 10_000)),
        changed(FALSE, 1.0),
        changed(LEAK, 1025.0),
        changed(EXTRA, 3e-6),
        changed(PLACES, 96.7, solved=(58, 60)),
    ],
)
def test_what_is_worse_is_caught(now: Line) -> None:
    found = against(ALL, [now if line.what == now.what else line for line in ALL])
    assert found.worse
    (change,) = found.changes
    assert change.what == now.what


@with_each(
    "now",
    [
        *ALL,
        changed(TIME, 11e-6),
        changed(TIME, 9e-6, solved=(1999, 2000)),
        changed(RATE, 25.0),
        changed(RATIO, 65.0),
        changed(LEAK, 900.0),
        changed(EXTRA, 1.9e-6),
        changed(PLACES, 98.3, solved=(59, 60)),
    ],
)
def test_noise_passes(now: Line) -> None:
    assert not against([line for line in ALL if line.what == now.what], [now]).changes


@given(st.floats(0.1, 10.0))
def test_a_slower_machine_is_no_slower_library(factor: float) -> None:
    other = 5e-4 * factor
    slow = [changed(TIME, 9e-6 * factor, reference=other), changed(RATE, 30.0 / factor, reference=other)]
    assert not against([TIME, RATE], slow).changes
    worse = [changed(TIME, 13e-6 * factor, reference=other), changed(RATE, 20.0 / factor, reference=other)]
    assert len([change for change in against([TIME, RATE], worse).changes if change.worse]) == 2


def test_of_several_rounds_the_middle_counts_and_of_correctness_the_worst() -> None:
    times = [Line("s", "t", value, solved=(right, 10)) for value, right in ((3.0, 9), (1.0, 10), (2.0, 10))]
    middle = together(times)
    assert (middle.reached, middle.rounds, middle.solved, middle.spread) == (2.0, (3.0, 1.0, 2.0), (9, 10), 1.0)
    shares = [Line("s", "t", value, "%", Goal(100, False, True)) for value in (100.0, 99.0, 100.0)]
    assert together(shares).reached == 99.0
