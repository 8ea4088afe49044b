"""SLInKi as a method."""

import numpy as np

import sinuous as sn
from sinuous.methods.slinki import Slinki
from tests.helpers import refused
from tests.methods import laws


def test_it_goes_round_obstacles() -> None:
    rng = np.random.default_rng(2)
    robot = sn.Robot.uniform(5, (45, 70), 2.0, radius=4, mount=10)
    solved = 0
    for _ in range(4):
        around = rng.uniform((-150, -150, 60), (150, 150, 280), (25, 3))
        solver = sn.Solver(robot, [sn.Sphere(center, 15) for center in around], method="slinki", max_starts=3)
        solved += laws.solved_and_verified(solver, laws.tip_targets(robot, 10, 1.5, kind="position"))
    assert solved >= 25


def test_a_tool_and_a_batch() -> None:
    robot = sn.Robot(laws.ARM.segments, tool=sn.pose((0, 0, 20)))
    solver = sn.Solver(robot, method="slinki")
    assert laws.solved_and_verified(solver, laws.tip_targets(robot, 10)) == 10
    laws.many_are_as_one(solver, laws.tip_targets(robot, 10))


def test_limits_and_obstacles() -> None:
    laws.keeps_its_limits(Slinki(nodes=300), laws.LIMITED)
    laws.does_not_pretend("slinki")


def test_what_it_cannot_mean_is_refused() -> None:
    refused("nodes", lambda: Slinki(nodes=1))
    refused("directions", lambda: Slinki(directions=2))
    refused("weight", lambda: Slinki(weight=-1.0))
    refused(
        "target.rotation", lambda: sn.Solver(laws.ARM, method="slinki").solve(sn.Target((0, 0, 9), rotation=np.eye(3)))
    )
