"""Every experiment runs at its smallest size, all claims hold, and a solver that lies, or is late, is found out."""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.layout_engine import ConstrainedLayoutEngine

import sinuous as sn
from benchmarks import design
from benchmarks.__main__ import Asked, main
from benchmarks.clutter import experiment as clutter
from benchmarks.clutter import explored, trials
from benchmarks.clutter.trials import Attempt, Task, Trial, examine
from benchmarks.clutter.ways import NAMES
from benchmarks.derivatives import agreement
from benchmarks.harness.conduct import Output, conduct
from benchmarks.harness.lines import Line
from benchmarks.harness.plan import Plan
from benchmarks.motion import known, loops, moving, p5
from benchmarks.paper import pictures
from benchmarks.paper.contest import Judge, solve_in_turns, tally
from benchmarks.paper.entrants import Entrant
from benchmarks.paper.scenes import paper_pose
from benchmarks.places import FAMILIES
from benchmarks.problems import among_spheres, arm, full_poses, paper_poses
from benchmarks.solvers.answers import solve_all
from benchmarks.speed import budgets, endurance, honesty
from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.solver.solver import Solver
from tests.benchmarks.tampering import moved

QUICK = Plan(quick=True)
NEWTON = [Entrant("newton", "newton")]

SMALL = {
    "speed": ("paper", "reachable", "growth", "poses", "fields", "cold"),
    "clutter": ("spheres 12", "p4 direction"),
    "motion": ("P5, 3 segments", "known 40 balls, wandering"),
    "many": ("workspace",),
    "real": ("rod-tpu",),
    "derivatives": ("agreement free",),
    "view": ("files",),
    "table1": (),
    "tracking": (),
    "segments": (),
    "methods": (),
}
"""Experiments, and parts of these that do not take long."""


@pytest.mark.parametrize("name", SMALL)
def test_experiments_run_at_their_smallest_size(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agreement, "BESIDE", 1)
    monkeypatch.setattr(pictures, "DPI", 50)
    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", lambda *_: None)  # half of the drawing
    methods = ("newton", "opti_path", "dls") if not SMALL[name] else ()
    asked = Asked(name, seed=1, quick=True, parts=SMALL[name], methods=methods)
    assert conduct(asked.experiment(), Output(tmp_path)) == 0
    report, text = json.loads((tmp_path / f"{name}.json").read_text()), (tmp_path / f"{name}.md").read_text()
    assert report["correct"]
    assert len(report["lines"]) + len(report.get("found", ())) >= len(SMALL[name])
    shown = re.findall(r"!\[[^]]+\]\((\w+\.png)\)", text)
    assert sorted(shown) == sorted(file.name for file in tmp_path.glob("*.png"))
    if methods:
        assert "takes account of limits on" in text
        assert text.count("\n| newton") >= 2


@pytest.mark.parametrize("name", NAMES)
def test_places_are_solved_in_all_ways(
    name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(explored, "ROUNDS", 1)
    typed = ["ways", name, "--piece", "spheres 12", "--count", "1", "--alone", "--record", str(tmp_path / "table")]
    assert main(typed) == 0
    rows = [[cell.strip() for cell in line.split("|")] for line in capsys.readouterr().out.splitlines()[2:]]
    assert {row[1] for row in rows} <= {"spheres 12", "all"}
    assert all(row[3].split("/")[0] == row[3].split("/")[1] and row[4] == "0" for row in rows)


def test_a_place_is_solved_again_and_drawn(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    picture = tmp_path / "place.png"
    assert main(["places", "spheres 12", "0", "--picture", str(picture)]) == 0
    assert capsys.readouterr().out.startswith("spheres 12, 0: solved by arc in ")
    assert picture.stat().st_size > 5_000


RIGHT = Attempt(1e-5, 1e-5, "solved", "arc", True, True)
LIE = Attempt(1e-5, 1e-5, "solved", "arc", True, False)
MISSED = Attempt(1e-2, 1e-2, "blocked", "random", False, False)
EXCUSE = Attempt(1e-5, 1e-5, "no_route", "arc", False, False)
LATE = Attempt(1.5, 1.5, "solved", "route", True, True)


def summed(*ours: Attempt, arc: Attempt = RIGHT) -> dict[str, Line]:
    found = [Trial("spheres 12", seed, 1e-3, attempt, arc) for seed, attempt in enumerate(ours)]
    return {line.section: line for line in clutter.lines_of("spheres 12", found)}


def test_of_places_only_what_a_judge_confirms_in_time_is_solved() -> None:
    line = summed(RIGHT, LIE, MISSED, LATE, RIGHT)[clutter.SOLVED]
    assert line.reached == pytest.approx(40.0)
    assert (line.solved, line.held) == ((2, 5), False)
    assert "not solved: seeds 1 (solved), 2 (blocked), 3 (solved)" in line.note


@pytest.mark.parametrize("wrong", [LIE, EXCUSE])
def test_lies_and_excuses_are_defects(wrong: Attempt) -> None:
    for lines in (summed(RIGHT, wrong), summed(RIGHT, RIGHT, arc=wrong)):
        assert lines[clutter.FALSE].verdict == "WRONG"
    assert summed(RIGHT, MISSED, LATE)[clutter.FALSE].held


def test_a_solver_that_lies_or_gives_up_about_a_place_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers without obstacles, handed over as if they were solved among them; and what is called blocked."""
    with monkeypatch.context() as patch:
        patch.setattr(trials, "Solver", lambda robot, _scene, **options: sn.Solver(robot, **options))
        assert any(examine(Task("spheres 100", seed)).ours.false for seed in range(4))
    monkeypatch.setattr(Solution, "solved", property(lambda _: False))
    monkeypatch.setattr(Solution, "status", property(lambda _: Status.TARGET_BLOCKED))
    assert examine(Task("p3", 0)).ours.false


def test_every_family_is_measured_and_every_place_once() -> None:
    names = [name for name, _ in clutter.Clutter(Plan()).parts()]
    assert names == list(FAMILIES)
    (_, world), *_ = clutter.Worlds(Plan(seed=3)).parts()
    share: Any = world.shares[1]
    assert [task.seed for task in share.args[0]] == list(range(300_100, 300_200))


def shifted(where: tuple[Any, int], by: float) -> Callable[..., Solution]:
    """A solver whose answers are wrong, without a word."""
    honest = Solver.solve
    return lambda self, *arguments, **options: moved(honest(self, *arguments, **options), where, by)


def test_an_answer_off_its_target_is_a_wrong_claim(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Solver, "solve", shifted((0, 0), 0.1))
    own = tally(solve_in_turns(NEWTON, paper_pose("A", 2), seconds=1.0, seed=0)["newton"])
    assert (own["right"], own["wrong"], own["target"]) == (0, 2, 2)
    answers = solve_all(Plan(), paper_poses(), "careless")
    assert not answers.confirmed.any()
    assert "FALSE: 0, 1, 2, 3" in answers.complaint


def test_an_answer_that_touches_is_a_wrong_claim() -> None:
    problems = among_spheres(arm(5, 2.4, radius=4.0), 40, 30, np.random.default_rng(3))
    blind = Solver(problems.robot, tolerance=problems.tolerance)
    records = [Judge(problems).record(i, blind.solve(target), 1e-5) for i, target in enumerate(problems.targets)]
    touching = [record for record in records if record["clearance"] < -1e-3]
    assert touching
    assert not any(record["right"] for record in touching)
    assert tally(records)["wrong"] >= len(touching)


def test_a_solver_that_lies_in_clutter_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(honesty, "TARGETS", 20)
    assert honesty.examine(1)[1:] == ([], [])
    monkeypatch.setattr(Solution, "solved", property(lambda _: True))
    assert any(honesty.examine(seed).false for seed in range(5))


def test_a_leak_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = Solver.solve
    kept: list[object] = []

    def forgetful(self: Solver, target: object) -> Solution:
        solution = honest(self, target)  # type: ignore[arg-type]
        kept.append((solution, bytearray(b"x") * 4000))
        return solution

    assert all(line.held for line in endurance._memory(QUICK, paper_poses()))
    monkeypatch.setattr(Solver, "solve", forgetful)
    monkeypatch.setattr(Plan, "count", lambda _self, full, _quick: full // 20)
    # What earlier tests have given back may take it all in, so that the process does not grow; Python's count does.
    _, traced = endurance._memory(Plan(), paper_poses())
    assert traced.held is False


def test_what_arrays_bring_and_how_budgets_are_kept_is_measured(monkeypatch: pytest.MonkeyPatch) -> None:
    one, two, ratio = endurance._arrays(QUICK, "poses", full_poses(0, 10), None)
    assert ratio.reached == pytest.approx(two.reached / one.reached)
    monkeypatch.setattr(budgets, "FAMILIES", [family for family in budgets.FAMILIES if family[0] == "along a wall"])
    lines = list(budgets.measure(QUICK))
    assert "used up their budgets" in lines[0].note
    assert all(line.reached >= 0.0 for line in lines)


def test_the_design_is_no_worse_than_the_template(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = design.problem(0, np.random.default_rng(0))
    monkeypatch.setattr(design, "problem", lambda *_: asked)
    assert next(line.reached for line in design.measure(QUICK) if line.what == "better than the template") == 1.0


def test_wrong_and_late_plans_count_as_such() -> None:
    right = p5.Trial(0, 1e-4, "solved", "", {})
    made = [right, right._replace(wrong="overlap"), right._replace(seconds=0.2), right._replace(status="time_limit")]
    lines = {line.section: line for line in p5.lines_of("here", made, 0.1, 99.5)}
    assert (lines[p5.PLANNED].reached, lines[p5.FALSE].reached, lines[p5.FALSE].held) == (25.0, 1, False)
    planned, false = known.lines_of("x", [known.Trial(1.0, "solved", ""), known.Trial(6.0, "solved", "overlap")])
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


@pytest.mark.parametrize("how", [loops.MOVED, loops.SEEN])
def test_a_short_loop_gets_out_of_the_way_of_a_cloud(monkeypatch: pytest.MonkeyPatch, how: str) -> None:
    monkeypatch.setattr(loops, "CLOUD_TICKS", 5)
    monkeypatch.setattr(loops, "POINTS", 2000)
    loop = loops.drive_from_cloud(1, how)
    assert loop.wrong == 0
    assert loop.least > 0.0


def test_motions_among_what_moves_are_judged() -> None:
    trial = moving.planned(2, {"rates": sn.Rates(moving.BEND, moving.LENGTH)})
    assert trial.solved
    assert trial.wrong == ""
    robot, straight = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05), np.tile([0.0, 0.0, 1.0], (3, 2, 1))

    def coming(near: float) -> sn.Moving:
        return sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 1, 2], [(2, 0, 1), (near, 0, 1), (2, 0, 1)])

    assert moving.judged(sn.Motion(robot, straight, [coming(0.5)])) == ""
    assert moving.judged(sn.Motion(robot, straight, [coming(0.3)])) == "overlap"
