"""What holds a configuration back: known cases, and the law: to widen what is named helps, and nothing else does."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

import sinuous as sn
from sinuous.answer.binding import find_binding
from sinuous.answer.remedies import Widening
from sinuous.answer.remedies import limits_of as limits_to_widen
from sinuous.answer.residual import residual_of

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.0), max_bend=0.5, radius=0.1)


def named(solution: sn.Solution) -> list[tuple[str, int | str | None, str | None]]:
    return [(each.constraint, each.segment, each.actuator or each.obstacle) for each in solution.binding]


def test_a_direction_is_held_by_all_bends_alone() -> None:
    solution = sn.solve(ROBOT, sn.Target(direction=(0, 0, -1)))
    assert sorted(named(solution)) == [("bend", k, None) for k in (1, 2, 3)]


def test_the_tendon_that_binds_is_named_and_its_opposite_too() -> None:
    robot = sn.Robot.uniform(1, (0.9, 1.1), 3.0, tendons=sn.Tendons(4, 0.1, displacement=(-0.1, 0.1)))
    solution = sn.solve(robot, sn.Target(direction=(np.sin(1.3), 0, np.cos(1.3))))
    assert solution.status is sn.Status.LIMIT_BOUND
    assert sorted(named(solution)) == [("actuator", 1, "s1.t1"), ("actuator", 1, "s1.t3")]
    assert sorted(each.value for each in solution.binding) == pytest.approx([-0.1, 0.1])
    for text in (solution.sentence, str(solution), solution._in_a_line()):
        assert "limits stop the best found: displacement of s1.t1 and s1.t3" in text


def test_a_wall_in_the_way_is_first() -> None:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)
    wall = sn.Box((0, 1, 1.5), (8, 0.2, 8), name="wall")
    solution = sn.solve(robot, sn.Target((0, 1.5, 1.6)), [wall, sn.Sphere((0, -3, 0), 0.5, name="far")], max_starts=20)
    assert solution.status is sn.Status.BLOCKED
    assert named(solution)[0][::2] == ("clearance", "wall")
    assert solution.binding[0].limit == 0.0
    assert solution.binding[0].value < 0.0
    assert all(each.obstacle != "far" for each in solution.binding)


@pytest.mark.parametrize(
    ("target", "obstacle", "status"),
    [
        ((0, 1.0, 2.15), sn.Sphere((0, 1.0, 2.5), 0.4, name="tank"), sn.Status.TARGET_BLOCKED),
        ((0, 0, 2.5), sn.Box((0, 0, 0), (1, 1, 1), name="floor"), sn.Status.BASE_BLOCKED),
    ],
)
def test_the_obstacle_of_a_proof_is_first(target: Any, obstacle: Any, status: sn.Status) -> None:
    robot = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)
    solution = sn.solve(robot, sn.Target(target), [obstacle])
    assert solution.status is status
    assert solution.reason is not None
    first = solution.binding[0]
    assert (first.constraint, first.obstacle) == ("clearance", obstacle.name)
    assert first.value == pytest.approx(solution.reason.available - solution.reason.needed)


def best_of(problem: sn.Problem, start: Any) -> tuple[Any, float]:
    """Minimise the residual within the limits by another method, from a configuration (n, 3); half of its square.

    Lengths count relative to the robot `MIXED`, however long that of the problem is.
    """
    unit = np.array([problem.robot.mean_length / MIXED.mean_length] * 3 + [1.0] * 3)

    def slacks(x: Any) -> Any:
        return np.array([limit.slack for limit in problem.robot.limit_set.sides(x.reshape(start.shape))])

    def merit(x: Any) -> float:
        return 0.5 * float(((unit * residual_of(problem, x.reshape(start.shape)).value) ** 2).sum())

    def slope(x: Any) -> Any:
        residual = residual_of(problem, x.reshape(start.shape))
        return -(unit**2 * residual.value) @ residual.jacobian

    x, least = start.ravel(), math.inf
    for _ in range(20):  # it stops early, and goes on when begun anew
        bounds: Any = {"type": "ineq", "fun": slacks}
        found = minimize(merit, x, jac=slope, method="SLSQP", constraints=bounds, options={"ftol": 1e-15})
        if found.fun > least * (1.0 - 1e-9):
            break
        x, least = found.x, float(found.fun)
    return x.reshape(start.shape), least


MIXED = sn.Robot(
    [
        sn.Segment((0.8, 1.0), 0.6),
        sn.Segment((0.7, 0.9), 1.0, max_curvature=0.9),
        sn.Segment((0.6, 1.1), 0.8, tendons=sn.Tendons(3, 0.1, displacement=(-0.1, 0.12))),
    ]
)


@pytest.mark.parametrize("seed", [1, 4, 7, 9])
def test_widening_what_is_named_helps_and_nothing_else_does(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = sn.Target(rng.normal(size=3) * [1.5, 1.5, 0.5] + [0, 0, 2.0], direction=rng.normal(size=3))
    solution = sn.solve(MIXED, target, max_starts=30)
    assert not solution.solved
    q, before = best_of(solution.problem, solution.q)
    binding = find_binding(solution.problem, q)
    held = {(each.segment, each.key) for each in binding}
    sides = {(limit.segment, limit.key) for limit in MIXED.limit_set.sides(q)}
    strongest = binding[0]
    assert best_of(wider(solution.problem, strongest.segment, strongest.key), q)[1] < before * (1.0 - 1e-5)
    for segment, key in sorted(sides - held):
        assert best_of(wider(solution.problem, segment, key), q)[1] > before * (1.0 - 2e-6), (segment, key)


def wider(problem: sn.Problem, segment: int | str | None, key: str | None) -> sn.Problem:
    """The problem with one side of one limit of one segment wider by a little."""
    assert isinstance(segment, int)
    assert key is not None
    name, _, end = key.partition("[")
    limits = limits_to_widen(problem.robot, name, segment)
    assert limits is not None
    ends = frozenset({int(end[0]) if end else 0})
    return problem.changed(robot=Widening(name, (segment,), limits, ends).applied(problem.robot, 1e-3))
