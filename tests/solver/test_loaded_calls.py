"""What calls a solver for more than one target, under load: answers are those of `solve`, of the loaded body."""

import numpy as np
import pytest

import sinuous as sn
from tests.solver.test_loaded_solve import Q, arm

SECONDS = 20.0
"""No budget is meant to end."""


def targets(robot: sn.Robot) -> list[sn.Target]:
    shifted = [Q + shift * np.array([1.0, 1.0, 0.0]) for shift in (0.0, 0.1, -0.15)]
    return [sn.Target(robot.shape(q).tip[:3, 3]) for q in shifted]


def test_many_are_those_of_one_by_one_whatever_the_workers() -> None:
    robot = arm()
    solver, asked = sn.Solver(robot, time=SECONDS, max_starts=20), targets(robot)
    alone = [solver.solve(target) for target in asked]
    for workers in (1, 2):
        many = solver.solve_many(asked, workers=workers)
        assert many.q.tolist() == [each.q.tolist() for each in alone]
        assert many.solved.all()
    assert many[0].verify().ok
    near = solver.solve_many(asked, initial=Q)
    assert near.solved.all()
    assert near.q[0] == pytest.approx(Q, abs=1e-3), "the first target begins where it is met"


def test_several_shapes_meet_one_target() -> None:
    robot = arm()
    target = sn.Target(robot.shape(Q).tip[:3, 3])
    found = sn.solve_all(robot, target, count=3, time=SECONDS, max_starts=40)
    assert len(found) == 3
    assert all(each.solved and each.verify().ok for each in found)
    bends = [float((each.q[:, :2] ** 2).sum()) for each in found]
    assert bends == sorted(bends)
    places = [robot.shape(each.q).poses[:, :3, 3] for each in found]
    apart = [np.abs(places[i] - places[j]).max() for i in range(3) for j in range(i)]
    assert min(apart) > 1e-3


def test_a_batch_and_a_map_are_of_the_loaded_body() -> None:
    robot = arm()
    tip = robot.shape(Q).tip
    batch = sn.studies.solve_batch(robot, tip[None, :3, 3], time=SECONDS, max_starts=20)
    assert batch.solved == 1
    low, high = tip[:3, 3] - 0.001, tip[:3, 3] + 0.001
    reached = sn.studies.reach(robot, spacing=0.002, low=low, high=high, directions=tip[None, :3, 2], time=SECONDS)
    assert reached.share.max() == 1.0
