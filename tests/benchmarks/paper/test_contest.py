"""What counts is what verification confirms, whatever a method says."""

import time
from typing import Any

import numpy as np
import pytest

from benchmarks.paper import contest
from benchmarks.paper.contest import BLOCK, Judge, Tally, follow_in_turns, judge_track, solve_in_turns
from benchmarks.paper.entrants import ALONE, FAITHFUL, STEP, Entrant, divide, entrants, gradients, roster
from benchmarks.paper.scenes import paper_pose, path_through
from benchmarks.problems import ProblemSet, among_spheres, arm, reachable
from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.base.errors import InputError
from sinuous.kernels.tables import FAILED
from sinuous.methods.registry import METHODS, name_of
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.scene import Scene
from sinuous.solver.solver import Solver
from tests.benchmarks.tampering import moved

OURS = [Entrant("newton", "newton")]


def test_right_answers_are_confirmed_and_summed_up() -> None:
    problems = reachable(arm(5, 2.4), BLOCK + 3, np.random.default_rng(0))
    (records,) = solve_in_turns(OURS, problems, seconds=1.0, seed=0).values()
    assert len(records) == BLOCK + 3
    assert all(record["right"] and record["claimed"] and record["seconds"] > 0.0 for record in records)
    assert "q" not in records[0]
    tally = Tally.of(records)
    assert (tally.runs, tally.right, tally.wrong, tally.percent) == (BLOCK + 3, BLOCK + 3, 0, 100.0)
    assert 0.0 < tally.times.median <= tally.times.worst
    assert 0.0 < tally.position <= 1e-4 * problems.robot.mean_length


def test_a_solve_is_repeated_when_the_processor_was_away(monkeypatch: pytest.MonkeyPatch) -> None:
    honest, calls = Solver.solve, 0

    def interrupted(self: Solver, *arguments: Any) -> Solution:
        nonlocal calls
        calls += 1
        if calls in (2, 3):  # the first warms up
            time.sleep(0.2)
        return honest(self, *arguments)

    monkeypatch.setattr(contest, "STOLEN", 0.1)
    monkeypatch.setattr(Solver, "solve", interrupted)
    (record,) = solve_in_turns(OURS, paper_pose("A", 1), seconds=1.0, seed=0)["newton"]
    assert calls >= 4
    assert record["seconds"] < 0.2
    assert record["right"]


def shifted(monkeypatch: pytest.MonkeyPatch, segment: int, coordinate: int, by: float) -> None:
    """Make every answer wrong, without a word."""
    honest = Solver.solve

    def careless(self: Solver, *arguments: Any) -> Solution:
        return moved(honest(self, *arguments), (segment, coordinate), by)

    monkeypatch.setattr(Solver, "solve", careless)


def test_an_answer_off_its_target_is_a_wrong_claim(monkeypatch: pytest.MonkeyPatch) -> None:
    shifted(monkeypatch, 0, 0, 0.1)
    tally = Tally.of(solve_in_turns(OURS, paper_pose("A", 2), seconds=1.0, seed=0)["newton"])
    assert (tally.right, tally.wrong) == (0, 2)
    assert np.isnan(tally.times.median)


def test_an_answer_outside_its_limits_is_a_wrong_claim() -> None:
    """Straight and too long: the tip is where it should be all the same."""
    robot = arm(2, 2.4)
    problems = ProblemSet(robot, [Target((0, 0, -150))], Scene(), Tolerance(1.0, 0.0175))
    solution = Solver(robot, tolerance=problems.tolerance).solve(Target((0, 0, -140)))
    assert solution.solved
    long = moved(solution, (slice(None), 2), 5.0)
    record = Judge(problems).record(0, long, 1e-5, keep=True)
    assert record["claimed"]
    assert not record["right"]
    assert record["position"] < 1.0
    assert record["excess"] == pytest.approx(5.0, abs=1.0)
    assert len(record["q"]) == 2


def test_an_answer_that_touches_is_a_wrong_claim() -> None:
    problems = among_spheres(arm(5, 2.4, radius=4.0), 40, 30, np.random.default_rng(3))
    blind = Solver(problems.robot, tolerance=problems.tolerance)
    records = [Judge(problems).record(i, blind.solve(t), 1e-5, keep=False) for i, t in enumerate(problems.targets)]
    touching = [record for record in records if record["clearance"] < -1e-3]
    assert touching
    assert not any(record["right"] for record in touching)
    assert Tally.of(records).wrong >= len(touching)


def test_an_answer_that_is_right_but_not_claimed_does_not_count() -> None:
    problems = paper_pose("B", 1)
    solution = Solver(problems.robot, tolerance=problems.tolerance).solve(problems.targets[0])
    claimed = solution._outcome._replace(code=FAILED, clearance=1.0, bound=False)
    solution = Solution(solution.problem, claimed, solution.seconds, solution._resolver, solution._given)
    assert solution.status is Status.STALLED
    record = Judge(problems).record(0, solution, 1e-5, keep=False)
    assert not record["right"]
    assert not record["claimed"]


def test_paths_are_followed_by_all_from_the_last_shape() -> None:
    problems = path_through(5, 10, np.random.default_rng(0), 36)
    found = follow_in_turns([*OURS, Entrant("again", "newton")], problems, seconds=1.0, seed=0)
    records, again = (judge_track(Judge(problems), followed, keep=True) for followed in found.values())
    assert [record["q"] for record in records] == [record["q"] for record in again]
    assert all(record["right"] for record in records)
    assert sum(record["start"] == "given" for record in records) > 30
    motions = [record["motion"] for record in records[1:]]
    steps = np.diff(np.array([target.position for target in problems.targets]), axis=0)
    assert (np.array(motions) > np.linalg.norm(steps, axis=-1) - 0.1).all()
    assert "motion" not in records[0]
    assert 0.0 < records[0]["prepared"] < 1.0


def test_everyone_takes_part_where_their_capabilities_reach() -> None:
    everyone = entrants()
    assert {entrant.label for entrant in everyone} == {*METHODS, FAITHFUL, STEP, ALONE}
    able, unable = divide(everyone, paper_pose("A", 1))
    assert unable == {}
    able, unable = divide(everyone, path_through(5, 3, np.random.default_rng(0), 12))
    assert {entrant.label for entrant in able} | set(unable) == {entrant.label for entrant in everyone}
    assert all(entrant.capabilities.obstacles or name_of(entrant.method) == "learned" for entrant in able)
    assert unable["dls"] == "does not avoid obstacles"
    turned = ProblemSet(arm(5, 2.4), [Target((0, 0, -250), rotation=np.eye(3))], Scene(), Tolerance(1.0, 0.0175))
    assert divide(everyone, turned)[1]["fabrikc"] == "target.rotation: takes a target without rotation"
    listed = roster(everyone, unable)
    assert "no: does not avoid obstacles" in listed
    assert all(f"| {entrant.label} " in listed for entrant in everyone)


def test_only_those_that_are_named_take_part() -> None:
    assert [entrant.label for entrant in entrants(["dls", "newton"])] == ["dls", "newton"]
    assert [entrant.label for entrant in gradients(["newton", "dls"])] == ["newton"]
    assert len(gradients()) == 3
    with pytest.raises(InputError, match="magic"):
        entrants(["magic"])
