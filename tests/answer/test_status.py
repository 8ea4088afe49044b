"""What proves that there is no solution: numbers that agree with the verdicts of the kernels."""

import math

import numpy as np
import pytest

from sinuous import Box, Problem, Robot, Scene, Segment, Solver, Sphere, Status, Target, Tolerance, pose
from sinuous.answer.status import unreachable
from sinuous.kernels.tables import OUT_OF_REACH
from tests.helpers import present, random_pose, with_each
from tests.kernels.solve.test_verdicts import TOLERANCE, extreme, robots, verdict

ROBOT = Robot.uniform(3, length=(0.8, 1.0), max_bend=0.5, radius=0.1)


def test_a_reason_is_given_exactly_where_the_verdict_says_so() -> None:
    agreed = {True: 0, False: 0}
    for seed in range(6):
        robot, rng = robots(seed), np.random.default_rng(seed)
        for _ in range(12):
            tip = robot.tip(extreme(robot, rng))
            place, other = tip[:3, 3] * rng.uniform(0.5, 1.5), random_pose(rng)
            for target in (
                Target(place),
                Target(place, direction=tip[:3, 2]),
                Target(place, direction=other[:3, 2]),
                Target(place, rotation=other[:3, :3]),
                Target(direction=other[:3, 2]),
            ):
                reason = unreachable(Problem(robot, target, tolerance=Tolerance(*TOLERANCE)))
                if reason is None or reason.needed - reason.available > 1e-6 * robot.mean_length:
                    assert (reason is not None) == (verdict(robot, target) == OUT_OF_REACH)
                    agreed[reason is not None] += 1
    assert min(agreed.values()) > 80


@with_each(
    ("target", "bound", "needed", "available"),
    [
        (Target((0, 0, 3.5)), "length", 3.5, 3.0),
        (Target((0, 0, 1.0)), "near", 2.4 * math.cos(0.75), 1.0),
        (Target((2.5, 0, 0.5)), "aside", 2.5, 3.0 * (1 - math.cos(1.5)) / 1.5),
        (Target((0, 0, 2.5), direction=(0, 0, -1)), "behind", None, None),
        (Target(direction=(0, 0, -1)), "turning", math.pi, 1.5),
    ],
)
def test_the_number_is_the_one_that_proves_it(
    target: Target, bound: str, needed: float | None, available: float | None
) -> None:
    solution = Solver(ROBOT).solve(target)
    assert solution.status is Status.OUT_OF_REACH
    reason = present(solution.reason)
    assert reason.needed > reason.available
    if needed is not None:
        assert reason.bound == bound
        assert reason.needed == pytest.approx(needed, abs=2e-3)
        assert reason.available == pytest.approx(available, abs=2e-3)
    assert str(reason) in str(solution)


def test_obstacles_are_called_by_their_names() -> None:
    robot = Robot.uniform(3, length=(0.8, 1.2), max_bend=2.0, radius=0.1, base=pose((0, 0, 0.5)))
    tank = Sphere((0, 1.0, 2.5), 0.4, name="tank")
    blocked = Solver(robot, [tank, Box((5, 5, 5), (1, 1, 1))]).solve(Target((0, 1.0, 2.15)))
    assert blocked.status is Status.TARGET_BLOCKED
    assert blocked.reason is not None
    assert (blocked.reason.bound, blocked.reason.obstacle) == ("target", "tank")
    assert blocked.reason.needed == pytest.approx(0.1)
    assert blocked.reason.available == pytest.approx(-0.05, abs=1e-3)

    based = Solver(robot, [tank, Box((0, 0, 0.5), (1, 1, 1), name="floor")]).solve(Target((0, 0, 2.5)))
    assert based.status is Status.BASE_BLOCKED
    assert based.reason is not None
    assert (based.reason.bound, based.reason.obstacle, based.reason.available) == ("base", "floor", -0.5)
    assert "the usual remedy is a longer mount" in str(based.reason)


def test_a_closed_place_names_its_wall_and_the_resolution() -> None:
    robot = Robot([Segment((0.8, 1.2), 2.0, radius=0.1)] * 3)
    walls = [Box(np.array([0, 0, 2.6]) + 0.5 * axis, np.where(axis, 0.1, 1.1)) for axis in (*np.eye(3), *-np.eye(3))]
    solution = Solver(robot, Scene(walls), time=60.0).solve(Target((0, 0, 2.5)))
    assert solution.status is Status.NO_ROUTE
    assert solution.reason is not None
    assert (solution.reason.bound, solution.reason.needed) == ("route", 0.1)
    assert solution.reason.available == pytest.approx(0.05)
    assert present(solution.reason.obstacle).startswith("box[")
    assert solution.to_dict()["reason"]["bound"] == "route"
    assert str(solution.reason).startswith(
        "no way from base to target is both wide enough for a body of radius 0.1 and at most 3.6 long, "
    )


WALL = Box((0, 0, 150), (400, 400, 10), name="wall")
"""Of finite size, in the open: a longer body gets around it."""


def test_no_route_is_said_of_width_and_length_together_and_no_remedy_contradicts_it() -> None:
    robot = Robot([Segment((40, 60), 2.0, radius=8)] * 4)
    solution = Solver(robot, [WALL], time=60.0).solve(Target((0, 0, 190)))
    assert solution.status is Status.NO_ROUTE
    assert present(solution.reason).longest == 240.0
    assert "both no longer than the robot and wide enough" in solution.sentence
    changes = {remedy.change.partition(" ")[0] for remedy in solution.explain(time=60.0).remedies}
    assert "length" in changes
    assert changes <= {"length", "obstacle", "target", "radius", "tolerance.position"}
    deepest = solution.explain(time=0.0).binding[0]
    assert solution.worst is not None
    assert (deepest.obstacle, deepest.segment) == ("wall", solution.worst.segment)
    assert deepest.value == pytest.approx(-solution.worst.amount, rel=0.01)


def test_of_an_elbow_it_is_the_length_up_to_there_that_counts() -> None:
    thin, thick = Segment((40, 60), 2.0, radius=4), Segment((40, 60), 2.0, radius=8)
    robot = Robot([thick, thick, thick, thin])
    solution = Solver(robot, [WALL], time=60.0).solve([Target((0, 0, 165), segment=3)])
    assert solution.status is Status.NO_ROUTE
    assert solution.reason is not None
    assert (solution.reason.longest, solution.reason.needed) == (180.0, 8.0)
