"""The experiment as a whole: it runs, counts, says what is wrong, and goes on where it was."""

import json
import math
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from benchmarks.harness.conduct import INTERRUPTED, Output, conduct
from benchmarks.harness.plan import Plan
from benchmarks.judges.judge import judge
from benchmarks.judges.kinematics import tip_poses
from benchmarks.problems import random_configurations
from benchmarks.wild import audit, branches, calls, curled, doors, experiment, loaded, motions, replay, scan, worlds
from benchmarks.wild.audit import KINDS
from benchmarks.wild.experiment import Wild
from benchmarks.wild.tally import MANY, Tally
from benchmarks.wild.trials import FALSE, OVERLAP, Trial, examine
from benchmarks.wild.worlds import World
from sinuous.base.errors import InputError
from sinuous.problem.target import Target, Tolerance
from sinuous.solver.solver import Solver
from tests.cases import with_each


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run of few problems, without the scan."""
    monkeypatch.setattr(curled, "TOGETHER", 3)
    monkeypatch.setattr(doors, "BUDGET", 0.1)
    monkeypatch.setattr(audit, "KINDS", {"units": audit.units})
    monkeypatch.setattr(motions, "KINDS", {"timed": motions.timed})
    monkeypatch.setattr(loaded, "KINDS", {})
    monkeypatch.setattr(calls, "CALLS", {"check": calls.CALLS["check"]})
    monkeypatch.setattr(experiment, "_poses", lambda seed, count: iter(()))
    monkeypatch.setattr(Plan, "count", lambda self, full, quick: min(quick, 3))


@pytest.mark.usefixtures("short")
def test_it_runs_and_goes_on_where_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[World] = []

    def interrupted(world: World) -> list[Trial]:
        calls.append(world)
        if len(calls) == 8:
            raise KeyboardInterrupt
        return [Trial("solved", 0.001) for _ in world.targets]

    monkeypatch.setattr(experiment, "examine", interrupted)
    assert conduct(Wild(Plan(quick=True)), Output(tmp_path, json=True)) == INTERRUPTED
    assert json.loads(capsys.readouterr().out)["interrupted"]
    before = len(calls)
    assert conduct(Wild(Plan(quick=True)), Output(tmp_path, json=True)) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["correct"]
    assert [line["reached"] for line in report["lines"] if line["what"].startswith("false: ")] == [0] * len(FALSE)
    assert len(calls) - before == 8  # the block that was interrupted and the one after it, each once more to load
    assert set(report["problems"]) == {"3 segments", "5 segments", "8 segments", "wild", "units"}


@pytest.mark.usefixtures("short")
def test_a_false_claim_is_wrong_and_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def false(world: World) -> list[Trial]:
        return [Trial("solved", 0.001, (OVERLAP,) if i == 0 else ()) for i in range(len(world.targets))]

    monkeypatch.setattr(experiment, "examine", false)
    assert conduct(Wild(Plan(quick=True)), Output(tmp_path)) == 1
    out = capsys.readouterr().out
    assert "false: overlap: problems: 0.0, 1.0, 2.0" in out
    assert "WRONG" in out


def test_more_rounds_are_fresh_problems() -> None:
    names = [name for name, _ in Wild(Plan(rounds=2)).pieces()]
    blocks = experiment.BLOCKS + len(KINDS) * experiment.AUDITED + len(experiment._judges()) * experiment.MOVED
    assert len(names) == len(set(names)) == 3 + 3 + 1 + 2 * blocks


def tally(*parts: Iterable[Trial]) -> Tally:
    whole = []
    for world, trials in enumerate(parts):
        own = Tally()
        own.add(world, trials)
        whole.append(json.loads(json.dumps(own.plain())))
    return Tally.together(whole)


def test_what_is_late_or_false_is_not_solved() -> None:
    found = tally(
        [Trial("solved", 0.1), Trial("solved", 0.5), Trial("solved", 1.5), Trial("stalled", 0.2)],
        [Trial("solved", 0.1, (OVERLAP,)), Trial("no_route", 0.1, ("no_route",))],
    )
    assert found.failed == {"0.2": "solved, late", "0.3": "stalled", "1.0": "solved", "1.1": "no_route"}
    assert found.late == ["0.1"]
    assert found.false == {OVERLAP: ["1.0"], "no_route": ["1.1"]}
    within, quick = found.speed("s", "w", 30)
    assert (within.reached, within.solved, within.held) == (MANY * 4 / 6, (2, 6), False)
    assert quick.solved == (1, 6)
    assert found.claim("s", "w").reached == 2
    assert {line.what: line.reached for line in found.claims("s")}["false: overlap"] == 1
    assert all(line.correctness for line in found.claims("s"))


def test_problems_are_looked_at_again_by_their_names() -> None:
    lines = replay.replay(0, ["3.1", "5"])
    named = [line.split(":")[0].strip() for line in lines if line.startswith(("world", "  3.", "  5."))]
    assert named == ["world 3", "3.1", "world 5", *(f"5.{i}" for i in range(len(worlds.make(0, 5).targets)))]


@with_each("name", ["x", "-1", "3.48", "3.x", "1e3"])
def test_a_name_of_no_problem_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="--only"):
        replay.replay(0, [name])


def test_some_wild_worlds_are_solved_and_hold() -> None:
    for number in range(4):
        assert all(not trial.false for trial in examine(worlds.make(0, number)))


@pytest.mark.parametrize(("max_bend", "turns"), [(math.pi, 16), (4.0, 8)])
def test_the_scan_finds_what_is_hidden(max_bend: float, turns: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scan, "TURNS", turns)
    robot = branches.arm(max_bend)
    q = random_configurations(robot, 1, np.random.default_rng(8))[0]
    tip = tip_poses(robot, q[None])[0]
    found = scan.all_solutions(robot, tip, 0.06)
    target = Target(tip[:3, 3], rotation=tip[:3, :3])
    assert judge(robot, [target] * len(found), np.array(found), Tolerance(1e-8, 1e-8)).right.all()
    assert len(scan.distinct(robot, np.array([*found, q]), 0.06)) == len(found)


def test_a_solver_that_misses_a_branch_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    target = branches.random_poses(0, 4)[3]
    whole = branches.compare(target, math.pi)
    assert (whole.scanned, whole.found, whole.more, whole.false) == (2, 2, 0, 0)
    honest = Solver.solve_all
    monkeypatch.setattr(Solver, "solve_all", lambda *a, **k: honest(*a, **k)[:1])
    lacking = branches.compare(target, math.pi)
    assert (lacking.scanned, lacking.found) == (2, 1)
    share, *_ = branches.lines_of("poses", [whole, lacking])
    assert share.held is False
    assert "1: 1 of 2" in share.note
