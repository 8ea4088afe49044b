"""The benchmark of places: it runs, holds, and says it when a solver lies, gives up too early, or is too late."""

import dataclasses
import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import sinuous as sn
from benchmarks.__main__ import main
from benchmarks.clutter import figures, trials
from benchmarks.clutter.experiment import Clutter
from benchmarks.clutter.figures import lines_of, tasks_of
from benchmarks.clutter.trials import ARC, IPOPT, RANDOM, Attempt, Task, Trial, examine
from benchmarks.harness.conduct import INTERRUPTED, Output, conduct
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import right
from benchmarks.solvers.among_spheres import AmongSpheres
from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.problem.target import Tolerance
from sinuous.scene.obstacles import Box, Sphere
from sinuous.scene.scene import Scene

RIGHT = Attempt(1e-5, 1e-5, "solved", "arc", True, True)
LIE = Attempt(1e-5, 1e-5, "solved", "arc", True, False)
MISSED = Attempt(1e-2, 1e-2, "blocked", "random", False, False)
EXCUSE = Attempt(1e-5, 1e-5, "no_route", "arc", False, False)
LATE = Attempt(1.5, 1.5, "solved", "route", True, True)


def by_section(lines: Iterator[Line]) -> dict[str, Line]:
    return {line.section: line for line in lines}


def tried(*ours: Attempt, arc: Attempt = RIGHT) -> list[Trial]:
    return [Trial("spheres 12", seed, 1e-3, attempt, 0.3, {ARC: arc}) for seed, attempt in enumerate(ours)]


def some(*names: str) -> Clutter:
    """A quick run of some parts alone."""
    clutter = Clutter(Plan(quick=True))
    clutter.choose(names)
    return clutter


def test_a_quick_run_holds(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert conduct(some("spheres 12", "p4 direction"), Output(tmp_path)) == 0
    text, report = capsys.readouterr().out, json.loads((tmp_path / "clutter.json").read_text())
    assert report["correct"]
    assert "won by" in text
    assert {line["what"] for line in report["lines"]} == {"spheres 12", "p4 direction"}
    sections = {line["section"] for line in report["lines"]}
    assert sections == {
        figures.SOLVED,
        figures.FALSE,
        figures.MEDIAN,
        figures.TAIL,
        figures.WORST,
        figures.PROOF,
        figures.FIRST,
        *figures.ALONE.values(),
    }


def test_what_is_counted_is_in_the_head_of_the_report(tmp_path: Path) -> None:
    conduct(some("p3"), Output(tmp_path))
    head = (tmp_path / "clutter.md").read_text().partition("\n\n")[0]
    assert all(f"- {key}: " in head for key in ("seed", "sinuous", "python-fcl", "libigl"))
    assert f"- protocol: {Clutter.protocol}" in head
    assert "budget 1 s" in head


def test_without_a_choice_all_families_are_measured_and_far_meshes() -> None:
    assert [name for name, _ in Clutter(Plan()).parts()] == [*FAMILIES, "far", "halls"]


@pytest.mark.parametrize("family", ["duct", "p3"])
def test_shares_hold_every_place_once(family: str) -> None:
    shares = figures.divided(Plan(), family).shares
    assert [task for share in shares for task in cast("partial[Any]", share).args[0]] == tasks_of(Plan(), family)


def test_an_interrupted_family_says_what_it_has_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three places a piece: the second piece is interrupted at its last place."""
    tried_: list[int] = []

    def examined(task: Task) -> Trial:
        if task.seed == 5 and 5 not in tried_:
            tried_.append(5)
            raise KeyboardInterrupt
        tried_.append(task.seed)
        return dataclasses.replace(tried(RIGHT)[0], seed=task.seed)

    monkeypatch.setattr(figures, "examine", examined)
    monkeypatch.setattr(figures, "QUICK", 7)
    monkeypatch.setattr(figures, "TOGETHER", 3)
    assert conduct(some("duct"), Output(tmp_path)) == INTERRUPTED
    before = json.loads((tmp_path / "clutter.json").read_text())
    assert before["interrupted"]
    assert before["lines"][0]["solved"] == [3, 3]
    shown = capsys.readouterr()
    assert "Interrupted" in shown.out
    assert "after 1 of 3 pieces" in shown.err
    assert conduct(some("duct"), Output(tmp_path)) == 0
    assert tried_ == [0, 1, 2, 3, 4, 5, 3, 4, 5, 6]
    assert json.loads((tmp_path / "clutter.json").read_text())["lines"][0]["solved"] == [7, 7]


def test_a_trial_is_the_same_after_the_journal() -> None:
    (trial,) = tried(LIE, arc=MISSED)
    assert Trial.of(json.loads(json.dumps(dataclasses.asdict(trial)))) == trial


def test_every_family_is_measured_on_all_robots_or_all_scenes() -> None:
    for name, family in FAMILIES.items():
        tasks = tasks_of(Plan(seed=3), name)
        assert [task.seed for task in tasks] == list(range(3000, 3000 + (400 if family.published else 60)))
        assert all(ARC in task.compared for task in tasks)
        random = {task.seed % 20 for task in tasks if RANDOM in task.compared}
        assert len(random) == (0 if family.trap else 20)
        assert sum(IPOPT in task.compared for task in tasks) == (0 if family.trap else 4)


def test_only_what_a_judge_confirms_is_solved() -> None:
    line = by_section(lines_of("spheres 12", tried(RIGHT, LIE, MISSED, LATE, RIGHT)))[figures.SOLVED]
    assert line.reached == pytest.approx(40.0)
    assert line.solved == (2, 5)
    assert line.held is False
    assert "not solved: seeds 1 (solved), 2 (blocked), 3 (solved)" in line.note
    assert "won by arc 2, route 1" in line.note


@pytest.mark.parametrize("wrong", [LIE, EXCUSE])
def test_lies_and_excuses_are_defects(wrong: Attempt) -> None:
    for trials_ in (tried(RIGHT, wrong), tried(RIGHT, RIGHT, arc=wrong)):
        line = by_section(lines_of("spheres 12", trials_))[figures.FALSE]
        assert line.verdict == "WRONG"
        assert "seeds" in line.note
    assert by_section(lines_of("spheres 12", tried(RIGHT, MISSED, LATE)))[figures.FALSE].held


def test_what_others_claim_is_no_defect_of_ours() -> None:
    (trial,) = tried(RIGHT)
    other = dataclasses.replace(trial, others={ARC: RIGHT, IPOPT: LIE})
    assert by_section(lines_of("spheres 12", [other]))[figures.FALSE].held


def test_families_that_the_arc_solves_have_the_stricter_goal() -> None:
    easy = by_section(lines_of("spheres 12", tried(RIGHT)))[figures.MEDIAN]
    hard = by_section(lines_of("spheres 12", tried(RIGHT, arc=MISSED)))[figures.MEDIAN]
    assert easy.goal is not None
    assert hard.goal is not None
    assert (easy.goal.value, hard.goal.value) == (100e-6, 5e-3)


def test_a_place_is_solved_in_all_ways() -> None:
    trial = examine(Task("p3", 0, (ARC, RANDOM, IPOPT)))
    assert trial.ours.solved
    assert not trial.ours.false
    assert trial.proof is not None
    assert 0.0 < trial.proof < 1.0
    assert trial.ours.start in {"arc", "route", "random"}
    assert set(trial.others) == {ARC, RANDOM, IPOPT}
    assert trial.others[IPOPT].seconds > trial.ours.seconds


def test_a_solver_that_lies_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers without obstacles, handed over as if they were solved among them."""
    monkeypatch.setattr(trials, "Solver", lambda robot, _scene, **options: sn.Solver(robot, **options))
    assert any(examine(Task("spheres 100", seed)).ours.false for seed in range(4))


def test_a_solver_that_gives_up_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Solution, "solved", property(lambda _: False))
    monkeypatch.setattr(Solution, "status", property(lambda _: Status.TARGET_BLOCKED))
    assert examine(Task("p3", 0)).ours.false


def balls() -> Place:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)
    target = sn.Target((0.5, 0, 2.5), direction=(0.2, 0, 1))
    scene = Scene([Sphere((0.25, 0.05, 1.4), 0.2), Sphere((1.5, 0, 1.5), 0.3)])
    return Place("balls", 0, robot, scene, (target,), Tolerance().for_robot(robot), np.zeros((3, 3)))


def test_ipopt_keeps_out_of_balls() -> None:
    place = balls()
    q, seconds = AmongSpheres(place.robot, place.scene, place.tolerance).solve(place.target, 0)
    assert seconds > 0.0
    assert right(place, q)
    without, _ = AmongSpheres(place.robot, Scene(), place.tolerance).solve(place.target, 0)
    assert not right(place, without)


def test_ipopt_takes_balls_only() -> None:
    robot = balls().robot
    assert AmongSpheres.takes(robot, balls().scene)
    assert not AmongSpheres.takes(robot, Scene([Box((0, 0, 9), (1, 1, 1))]))
    assert not AmongSpheres.takes(robot, Scene([Sphere((0, 0, 0), 9, inside=True)]))
    assert not AmongSpheres.takes(robot, make("spheres 100", 2).scene) or len(robot) * 10 * 100 <= 3000
    assert IPOPT not in examine(Task("shelf", 0, (IPOPT,))).others


def test_attempts_can_be_switched_off(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["clutter", "--quick", "--piece", "spheres 12", "--out", str(tmp_path), "--without"]
    assert main([*arguments, "gates,hops"]) == 2
    assert "'hops'" in capsys.readouterr().err
    assert main(["wild", "--without", "gates"]) == 2
    assert capsys.readouterr().err.startswith("--without: expected nothing with wild")
    assert main([*arguments, "gates,cells"]) == 0
    journal = next(tmp_path.glob("*.jsonl")).read_text().splitlines()[0]
    assert '"without": "cells,gates"' in journal.replace('":"', '": "')


def test_what_is_switched_off_reaches_the_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def noted(*given: Any, **options: Any) -> sn.Solver:
        seen.append(options.get("without"))
        return sn.Solver(*given, **options)

    monkeypatch.setattr(trials, "Solver", noted)
    assert examine(Task("spheres 12", 0, without=("gates",))).ours.solved
    assert seen == [("gates",)]
