"""Every kind of false claim is seen: each is planted once."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.wild import trials
from benchmarks.wild.trials import (
    CLEARANCE,
    DEMAND,
    FALSE,
    LIMITS,
    OVERLAP,
    SELF_CLEARANCE,
    SELF_OVERLAP,
    TARGET,
    examine,
    refuted,
    solutions_of,
)
from benchmarks.wild.worlds import World
from sinuous.answer.solution import Solution
from sinuous.kernels.tables import BASE_BLOCKED, NO_ROUTE, OUT_OF_REACH, SOLVED, TARGET_BLOCKED
from sinuous.problem.target import Tolerance
from sinuous.solver.solver import Solver
from tests.benchmarks.tampering import moved

STRAIGHT = np.array([[[0.0, 0.0, 1.0]] * 3])
ROBOT = sn.Robot.uniform(3, (0.9, 1.1), 6.0, radius=0.1)


def world(obstacles: list[Any], tolerance: float = 1e-6) -> World:
    targets = [[sn.Target((0.0, 0.0, 3.0), direction=(0.0, 0.0, 1.0))]]
    return World(ROBOT, sn.Scene(obstacles), Tolerance(tolerance, tolerance), targets, STRAIGHT)


BESIDE = [sn.Sphere((0.5, 0.0, 1.5), 0.3)]


@pytest.fixture(scope="module")
def solution() -> Solution:
    (found,), _ = solutions_of(world(BESIDE))
    assert isinstance(found, Solution)
    assert found.solved
    return found


def changed(solution: Solution, **record: Any) -> Solution:
    outcome = solution._outcome._replace(**record)
    return Solution(solution.problem, outcome, solution.seconds, solution._resolver, solution._given)


def kinds(asked: World, said: Solution) -> set[str]:
    return set(refuted(asked, {0: said})[0])


def test_an_honest_answer_is_not_accused(solution: Solution) -> None:
    assert kinds(world(BESIDE), solution) == set()
    (trial,) = examine(world(BESIDE))
    assert trial.solved
    assert trial.seconds > 0.0


def test_a_target_that_is_missed(solution: Solution) -> None:
    assert kinds(world(BESIDE), moved(solution, (0, 2), 3e-6)) == {TARGET}


def test_a_limit_that_is_exceeded(solution: Solution) -> None:
    assert LIMITS in kinds(world(BESIDE, 1.0), moved(solution, (0, 2), 0.3))


def test_an_overlap(solution: Solution) -> None:
    assert kinds(world([sn.Sphere((0.5, 0.0, 1.5), 0.41)]), solution) >= {OVERLAP}


def test_a_clearance_that_is_overstated(solution: Solution) -> None:
    near = world([sn.Sphere((0.5, 0.0, 1.5), 0.39)])
    assert kinds(near, solution) == {CLEARANCE}
    assert kinds(world(BESIDE), changed(solution, clearance=0.11)) == {CLEARANCE}


def test_a_clearance_that_is_demanded_and_not_kept(solution: Solution) -> None:
    """The ball is 0.1 from the body."""
    for demand, false in ((0.0999, set()), (0.1001, {DEMAND})):
        asked = world(BESIDE)
        assert kinds(replace(asked, robot=ROBOT.changed(clearance=demand)), solution) == false


def test_a_body_that_is_unsure_is_measured_thicker(solution: Solution) -> None:
    unsure = ROBOT.changed(uncertainty=sn.Uncertainty(0.01))
    assert kinds(replace(world(BESIDE), robot=unsure), changed(solution, clearance=0.0899)) == set()
    assert kinds(replace(world(BESIDE), robot=unsure), changed(solution, clearance=0.0901)) == {CLEARANCE}


def test_a_body_that_runs_through_itself(solution: Solution) -> None:
    knot = np.array([[0.0, 0.0, 1.0], [5.9, 0.0, 1.0], [0.0, 0.0, 1.0]])
    assert kinds(world([], 10.0), changed(solution, q=knot)) >= {SELF_OVERLAP}


def test_a_self_clearance_that_is_overstated(solution: Solution, monkeypatch: pytest.MonkeyPatch) -> None:
    """A straight body is `(pi - 2) radius` from itself: that far apart are places which count, at least."""
    monkeypatch.setattr(Solution, "self_clearance", 0.11, raising=False)
    assert SELF_CLEARANCE not in kinds(world([], 10.0), solution)
    monkeypatch.setattr(Solution, "self_clearance", 2.6, raising=False)
    hairpin = np.array([[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
    assert SELF_CLEARANCE in kinds(world([], 10.0), changed(solution, q=hairpin))


@pytest.mark.parametrize("code", [OUT_OF_REACH, TARGET_BLOCKED, BASE_BLOCKED, NO_ROUTE])
def test_what_is_called_impossible(solution: Solution, code: int) -> None:
    said = changed(solution, code=code)
    assert kinds(world(BESIDE), said) == {str(said.status)}
    assert str(said.status) in FALSE


def test_what_is_merely_not_solved_is_no_claim(solution: Solution) -> None:
    assert solution._outcome.code == SOLVED
    assert kinds(world([sn.Sphere((0.5, 0.0, 1.5), 0.41)]), changed(solution, code=2)) == set()


def test_a_liar_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = trials.solutions_of

    def lying(asked: World) -> tuple[list[Solution], list[float]]:
        solutions, seconds = honest(asked)
        return [moved(each, (0, 0), 1e-3) for each in solutions if isinstance(each, Solution)], seconds

    monkeypatch.setattr(trials, "solutions_of", lying)
    (trial,) = examine(world(BESIDE))
    assert not trial.solved
    assert TARGET in trial.false


def test_a_call_that_ends_in_an_exception_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: Any) -> Solution:
        raise IndexError

    monkeypatch.setattr(Solver, "solve", failing)
    (trial,) = examine(world(BESIDE))
    assert not trial.solved
    assert trial.false == (trials.EXCEPTION,)
