"""Figures as people and programs read them."""

import dataclasses
import json
import math
from dataclasses import asdict
from typing import Any

import numpy as np
import pytest

from benchmarks.harness.experiment import Findings, OfLines
from benchmarks.harness.lines import Goal, Line, together
from benchmarks.harness.plan import Plan
from benchmarks.harness.report import Report
from benchmarks.harness.times import Times, exponent
from sinuous.files.results import json_line


def report(*lines: Line) -> Report:
    return Report(OfLines("some", Plan()), {}, Findings(list(lines)))


def again(line: Line) -> Line:
    """A line as a journal gives it back."""
    plain: dict[str, Any] = json.loads(json_line(asdict(line)))
    return Line.of(plain)


def test_times_are_summarised() -> None:
    times = Times.of(np.arange(1, 101))
    assert (times.count, times.median, times.worst) == (100, 50.5, 100.0)
    assert times.p95 == pytest.approx(95.05)
    assert times.p99 == pytest.approx(99.01)


def test_exponent_is_the_slope() -> None:
    sizes = (5, 10, 20, 40)
    assert exponent(sizes, [3e-6 * n**1.3 for n in sizes]) == pytest.approx(1.3)


def test_goals_can_be_missed() -> None:
    assert Goal(1.0).held(1.0)
    assert not Goal(1.0).held(1.1)
    assert not Goal(50.0, at_most=False).held(49.0)
    assert not Goal(50.0).held(math.nan)


def test_only_correctness_makes_a_report_wrong() -> None:
    slow = Line("s", "slow", 2.0, "s", Goal(1.0))
    wrong = Line("s", "wrong", 1, "", Goal(0, correctness=True), note="seed 7")
    assert report(slow).findings.correct
    found = report(slow, wrong)
    assert not found.findings.correct
    assert not found.to_dict()["correct"]
    assert "missed" in found.to_text()
    assert "WRONG" in found.to_text()
    assert "seed 7" in found.to_text()
    assert "0 of 2 goals held." in found.to_text()


def test_what_is_not_finite_is_null_in_json() -> None:
    line = Line("s", "broken", math.inf, "s", Goal(1.0), Times(0, *[math.nan] * 4))
    (written,) = json.loads(json_line(report(line).to_dict()))["lines"]
    assert written["reached"] is None
    assert written["times"]["median"] is None
    assert written["held"] is False


def test_a_journal_gives_lines_back() -> None:
    whole = Line("s", "w", 2.5, "ms", Goal(1.0, False, True), Times(3, 1.0, 2.0, 3.0, 4.0), (2, 3), "n", 0.5, 1e-6)
    assert again(whole) == whole
    plain = Line("s", "w", 1.0)
    assert again(plain) == plain


@pytest.mark.parametrize("at_most", [True, False])
def test_what_was_not_finite_holds_no_goal_when_it_comes_back(at_most: bool) -> None:
    broken = again(Line("s", "w", math.inf, "s", Goal(1.0, at_most), Times(0, *[math.nan] * 4)))
    assert broken.held is False
    assert broken.times is not None
    assert math.isnan(broken.times.median)


def test_of_several_rounds_the_middle_counts_and_of_correctness_the_worst() -> None:
    times = [Line("s", "t", value, solved=(right, 10)) for value, right in ((3.0, 9), (1.0, 10), (2.0, 10))]
    middle = together(times)
    assert (middle.reached, middle.rounds, middle.solved, middle.spread) == (2.0, (3.0, 1.0, 2.0), (9, 10), 1.0)
    slow = [dataclasses.replace(line, reference=1e-3) for line in times[:2]] + [Line("s", "t", 4.0, reference=2e-3)]
    assert together(slow).rounds == (6.0, 2.0, 4.0)  # as on the machine of the middle one
    rates = [Line("s", "t", value, "/s", reference=ref) for value, ref in ((10.0, 1e-3), (6.0, 2e-3), (8.0, 1e-3))]
    assert together(rates).rounds == (10.0, 12.0, 8.0)
    shares = [Line("s", "t", value, "%", Goal(100, False, True)) for value in (100.0, 99.0, 100.0)]
    assert together(shares).reached == 99.0
    counts = [Line("s", "t", value, "", Goal(0, correctness=True)) for value in (0, 0, 3)]
    assert together(counts).reached == 3
    assert together(counts[:1]) is counts[0]
    assert counts[0].spread is None
    assert together([Line("s", "t", math.nan), *times]).reached == 3.0
