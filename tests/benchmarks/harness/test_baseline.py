"""The gate: what is worse is caught, what is the same passes, and a slower machine is no slower library."""

import dataclasses
import json
import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.harness import reference
from benchmarks.harness.baseline import Comparison, Figure, check, compare, load, save
from benchmarks.harness.experiment import Findings, OfLines
from benchmarks.harness.lines import Goal, Line, together
from benchmarks.harness.plan import Plan
from benchmarks.harness.report import Report
from sinuous.base.errors import InputError
from tests.cases import with_each

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
    return compare([Figure.of(line) for line in before], now)


def changed(line: Line, reached: float, **others: object) -> Line:
    return dataclasses.replace(line, reached=reached, **others)  # type: ignore[arg-type]


def test_an_equal_run_passes() -> None:
    found = against(ALL, ALL)
    assert not found.worse
    assert (found.changes, found.compared, found.missing, found.new) == ([], len(ALL), [], [])


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
    assert f"| {now.what} " in found.to_text("baseline.json")
    assert "### Worse" in found.to_text("baseline.json")


@with_each(
    "now",
    [
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


def test_what_is_better_is_told_and_passes() -> None:
    better = [changed(TIME, 5e-6), changed(RATE, 60.0), changed(RATIO, 160.0)]
    found = against([TIME, RATE, RATIO], better)
    assert not found.worse
    assert [change.what for change in found.changes] == [line.what for line in better]
    assert "### Better" in found.to_text("baseline.json")


@given(st.floats(0.1, 10.0))
def test_a_slower_machine_is_no_slower_library(factor: float) -> None:
    other = 5e-4 * factor
    slow = [changed(TIME, 9e-6 * factor, reference=other), changed(RATE, 30.0 / factor, reference=other)]
    assert not against([TIME, RATE], slow).changes
    worse = [changed(TIME, 13e-6 * factor, reference=other), changed(RATE, 20.0 / factor, reference=other)]
    assert len([change for change in against([TIME, RATE], worse).changes if change.worse]) == 2


@given(st.floats(1e-9, 1e3), st.floats(1e-9, 1e3))
def test_worse_one_way_is_better_the_other(before: float, now: float) -> None:
    there = against([changed(TIME, before)], [changed(TIME, now)]).changes
    back = against([changed(TIME, now)], [changed(TIME, before)]).changes
    assert [change.worse for change in there] == [not change.worse for change in back]


def test_figures_that_spread_may_change_by_more() -> None:
    noisy = together([changed(TIME, value) for value in (8e-6, 9e-6, 11e-6)])
    assert Figure.of(noisy).tolerance == pytest.approx(2.0 / 3.0)
    assert not against([noisy], [changed(TIME, 14e-6)]).changes
    assert against([noisy], [changed(TIME, 16e-6)]).worse


def test_the_best_round_counts() -> None:
    """One slow round is the machine's."""
    assert not against([TIME], [together([changed(TIME, value) for value in (30e-6, 9e-6, 20e-6)])]).worse


def test_what_is_not_measured_any_more_is_missed() -> None:
    found = against([TIME, RATE], [TIME, RATIO])
    assert found.worse
    assert found.missing == ["clouds: updates"]
    assert found.new == ["rivals: faster than others"]
    assert not compare([Figure.of(line) for line in (TIME, RATE)], [TIME], whole=False).worse


def test_what_never_was_finite_is_no_loss() -> None:
    broken = changed(TIME, math.nan)
    assert not against([broken], [broken]).changes
    assert not against([broken], [TIME]).worse


def written(file: Path, *lines: Line) -> Path:
    save(file, Report(OfLines("some", Plan(3)), {"processor": "one"}, Findings(list(lines))))
    return file


def test_a_baseline_comes_back_as_it_was_kept(tmp_path: Path) -> None:
    file = written(tmp_path / "some.json", *ALL, changed(TIME, math.inf, what="broken"))
    held = load(file, "--against")
    assert held["figures"][:-1] == [Figure.of(line) for line in ALL]
    assert held["figures"][-1].reached is None
    assert json.loads(file.read_text())["machine"] == {"processor": "one"}
    now = {"experiment": "some", "seed": 3, "quick": False, "settings": {}}
    check(held, now, "--against")
    for key, value in (("seed", 4), ("quick", True), ("experiment", "other"), ("settings", {"a": 1})):
        complaint = f"--against: expected a baseline measured with {key} {value!r}, got {now[key]!r}"
        with pytest.raises(InputError, match=f"^{re.escape(complaint)}$"):
            check(held, {**now, key: value}, "--against")


@pytest.mark.parametrize("content", ["", "{}", '{"figures": [{}]}', '{"figures": [3]}', "[]"])
def test_what_is_no_baseline_is_refused(tmp_path: Path, content: str) -> None:
    file = tmp_path / "some.json"
    with pytest.raises(
        InputError, match=r"^--against: expected a file that --save-baseline wrote, .*\(cannot be read: No such file"
    ):
        load(file, "--against")
    file.write_text(content)
    with pytest.raises(
        InputError, match=r"^--against: expected a file that --save-baseline wrote, got '.*some\.json'$"
    ):
        load(file, "--against")


def test_the_reference_workload_takes_its_time() -> None:
    seconds, busy = reference.look()
    assert 1e-5 < seconds < 60.0
    assert 0.0 <= busy < 1.0
