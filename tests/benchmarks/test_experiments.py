"""Every experiment runs at its smallest size, all claims hold, and a solver that lies, or is late, is found out."""

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks import clutter, derivatives, harness, methods, ways
from benchmarks.__main__ import KNOWN, experiment
from benchmarks.clutter import examine
from benchmarks.harness import Line, Plan, Trial, conduct
from benchmarks.motion import loops, moving, p5
from benchmarks.problems import among_spheres, arm, paper_poses
from benchmarks.speed import processes, solves
from benchmarks.speed.solves import solve_all
from benchmarks.ways import WAYS
from tests.benchmarks.tampering import moved

QUICK = Plan(quick=True)

SMALL = {
    "motion": ("P5, 3 segments", "known 40 balls, wandering"),
    "speed": ("reachable", "poses", "fields", "cold"),
    "clutter": ("spheres 12", "p4 direction"),
    "real": ("rod-tpu",),
    "derivatives": ("agreement free",),
    "view": ("files",),
    "inputs": ("obj", "npy"),
    "joints": (),
    "workspace": ("rods",),
    "table1": ("A", "C"),
    "tracking": ("10 spheres",),
    "segments": (),
    "methods": ("exact", "spheres, direction"),
}
"""Experiments, and parts of these that do not take long."""


@pytest.mark.filterwarnings("ignore::sinuous.SuspiciousInput")  # random problems are odd on purpose
@pytest.mark.parametrize("name", SMALL)
def test_experiments_run_at_their_smallest_size(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harness, "LOOK", 1e-3)
    monkeypatch.setattr(derivatives, "BESIDE", 1)
    monkeypatch.setattr(methods, "METHODS", ("newton", "opti_path", "dls"))
    assert conduct(experiment(name, Plan(1, quick=True), SMALL[name]), tmp_path) == 0
    text = (tmp_path / f"{name}.md").read_text()
    assert text.count("\n| ") >= 3 * max(1, len(SMALL[name]))
    if KNOWN[name][0] == "methods":
        assert "\n| newton" in text


@pytest.mark.filterwarnings("ignore::sinuous.SuspiciousInput")
@pytest.mark.parametrize("name", WAYS)
def test_places_are_solved_in_all_ways(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(harness, "LOOK", 1e-3)
    monkeypatch.setattr(ways, "ROUNDS", 1)
    assert conduct(experiment(name, QUICK, ("spheres 12",)), tmp_path) == 0
    lines = (tmp_path / f"{name}.md").read_text().splitlines()
    rows = [[cell.strip() for cell in line.split("|")] for line in lines if line.startswith("| ")]
    solved = {row[1]: row[5].split("/") for row in rows if "/" in row[5]}
    assert {way.removeprefix("spheres 12, ") for way in solved} == set(WAYS[name].against)
    assert all(good == count for good, count in solved.values())


RIGHT = Trial(0, 1e-5, "solved", "", "arc")
LIE = Trial(0, 1e-5, "solved", "refuted", "arc")
MISSED = Trial(0, 1e-2, "blocked", "", "random")
EXCUSE = Trial(0, 1e-5, "no_route", "impossible", "arc")
LATE = Trial(0, 1.5, "solved", "", "route")


def summed(*trials: Trial) -> dict[str, Line]:
    found = [trial._replace(number=seed) for seed, trial in enumerate(trials)]
    lines = [*clutter.lines_of("spheres 12", found), *clutter.total_of({"spheres 12": found})]
    return {line.section: line for line in lines}


def test_of_places_only_what_a_judge_confirms_in_time_is_solved() -> None:
    line = summed(RIGHT, LIE, MISSED, LATE, RIGHT)[clutter.SOLVED]
    assert line.reached == pytest.approx(40.0)
    assert (line.solved, line.held) == ((2, 5), False)
    assert line.note == "p95 over 50 ms; worst over 1000 ms; not solved: 1 (refuted), 2 (blocked), 3 (solved)"


@pytest.mark.parametrize("wrong", [LIE, EXCUSE])
def test_lies_and_excuses_are_defects(wrong: Trial) -> None:
    assert summed(RIGHT, wrong)[clutter.FALSE].verdict == "WRONG"
    assert summed(RIGHT, MISSED, LATE)[clutter.FALSE].held


def test_a_solver_that_lies_or_gives_up_about_a_place_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers without obstacles, handed over as if they were solved among them; and what is called blocked."""
    with monkeypatch.context() as patch:
        patch.setattr(clutter, "Solver", lambda robot, _scene, **options: sn.Solver(robot, **options))
        assert any(examine("spheres 100", seed).wrong for seed in range(4))
    monkeypatch.setattr(sn.Solution, "solved", property(lambda _: False))
    monkeypatch.setattr(sn.Solution, "status", property(lambda _: sn.Status.TARGET_BLOCKED))
    assert examine("p3", 0).wrong


def shifted(where: tuple[Any, int], by: float) -> Callable[..., sn.Solution]:
    """A solver whose answers are wrong, without a word."""
    honest = sn.Solver.solve
    return lambda self, *arguments, **options: moved(honest(self, *arguments, **options), where, by)


def test_an_answer_off_its_target_is_a_wrong_claim(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sn.Solver, "solve", shifted((0, 0), 0.1))
    monkeypatch.setattr(methods, "METHODS", ("newton",))
    part = methods.table1(QUICK).parts["A"]
    lines = {line.what: line for line in part.summed([each for share in part.shares for each in share()])}
    assert lines["newton"].solved == (0, 2)
    assert "2 off the target" in lines["newton"].note
    assert lines['wrong claims of "solved"'].held is False
    assert ["false claim" in trial.wrong for trial in solve_all(paper_poses())] == [True] * 4


def test_an_answer_that_touches_is_a_wrong_claim() -> None:
    problems = among_spheres(arm(5, 2.4, radius=4.0), 40, 30, np.random.default_rng(3))
    blind = sn.Solver(problems.robot, tolerance=problems.tolerance)
    judge = methods.Judge(problems)
    records = [judge.record(i, blind.solve(target), 1e-5) for i, target in enumerate(problems.targets)]
    touching = [record for record in records if record["clearance"] < -1e-3]
    assert touching
    assert not any(record["right"] for record in touching)
    *_, wrong = methods.lines_of("s", [{"records": {"blind": records}, "refused": {}}])
    assert wrong.reached >= len(touching)


@pytest.mark.filterwarnings("ignore::sinuous.SuspiciousInput")
def test_a_solver_that_lies_in_clutter_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(solves, "TARGETS", 20)
    assert not any(trial.wrong for trial in solves.examine(1))
    monkeypatch.setattr(sn.Solution, "solved", property(lambda _: True))
    assert any("false claim" in trial.wrong for seed in range(5) for trial in solves.examine(seed))


def test_a_leak_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = sn.Solver.solve
    kept: list[object] = []

    def forgetful(self: sn.Solver, target: object) -> sn.Solution:
        solution = honest(self, target)  # type: ignore[arg-type]
        kept.append((solution, bytearray(b"x") * 4000))
        return solution

    assert all(line.held for line in processes._memory(QUICK, paper_poses()))
    monkeypatch.setattr(sn.Solver, "solve", forgetful)
    monkeypatch.setattr(Plan, "count", lambda _self, full, _quick: full // 20)
    # What earlier tests have given back may take it all in, so that the process does not grow; Python's count does.
    _, traced = processes._memory(Plan(), paper_poses())
    assert traced.held is False


def test_wrong_and_late_plans_count_as_such() -> None:
    right = Trial(0, 1e-4, "solved", "")
    assert pickle.loads(pickle.dumps(right)) == right  # from one process to another
    made = [right, right._replace(wrong="overlap"), right._replace(seconds=0.2), right._replace(status="time_limit")]
    lines = {line.section: line for line in p5.lines_of("here", made, 0.1, 99.5)}
    assert (lines[p5.PLANNED].reached, lines[p5.FALSE].reached, lines[p5.FALSE].held) == (25.0, 1, False)
    late = [Trial(0, 1.0, "solved", ""), Trial(1, 6.0, "solved", "overlap")]
    planned, false = harness.counted("planned", "false", "x", late, 5.0)
    assert (planned.reached, false.reached) == (50.0, 1)


def test_loops_are_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(loops, "TICKS", 20)
    assert loops.drive(1).wrong == 0
    robot, q, scene = loops.place(np.random.default_rng(0))
    knots = np.tile(q, (21, 1, 1))
    assert loops.wrong_ticks(robot, scene, knots) == 0
    fast, long = knots.copy(), knots.copy()
    fast[5:, 0, 0] += 0.002
    long[:, 0, 2] = 80.0
    assert loops.wrong_ticks(robot, scene, fast) == 1
    assert loops.wrong_ticks(robot, scene, long) >= 21
    middle = robot.backbone(q)[len(q) * 10]
    assert loops.wrong_ticks(robot, sn.Scene([sn.Sphere(middle, 5.0)]), knots) == 3


def test_motions_among_what_moves_are_judged() -> None:
    trial = moving.planned(2, {"rates": sn.Rates(moving.BEND, moving.LENGTH)})
    assert trial.good(np.inf)
    robot, straight = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05), np.tile([0.0, 0.0, 1.0], (3, 2, 1))

    def coming(near: float) -> sn.Moving:
        return sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 1, 2], [(2, 0, 1), (near, 0, 1), (2, 0, 1)])

    assert moving.judged(sn.Motion(robot, straight, [coming(0.5)])) == ""
    assert moving.judged(sn.Motion(robot, straight, [coming(0.3)])) == "overlap"
