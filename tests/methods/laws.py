"""What every method promises, whatever it does inside."""

from typing import Any

import numpy as np

import sinuous as sn
from sinuous.base.arguments import MethodName
from sinuous.base.checks import Floats
from sinuous.methods import method as methods
from sinuous.methods.learned import Learned

ARM = sn.Robot.uniform(5, (45, 70), base=sn.pose(direction=(0, 0, -1)))

PAPER = (
    sn.Target((-60, 150, -230), direction=(-0.7071, 0, -0.7071)),
    sn.Target((-10, 40, -260), direction=(0, 0.2169, -0.9762)),
    sn.Target((150, -90, -220), direction=(0.5661, 0.2665, -0.7926)),
    sn.Target((40, -60, -180), direction=(0, 0, 1)),
)
"""The four poses of Sun & Wang's paper."""


def quick(method: MethodName, robot: sn.Robot) -> MethodName | Learned:
    """A method by its name; of `learned` with a network that has learned little: training takes seconds."""
    return Learned(sn.methods.train(robot, samples=300, width=8, rounds=1)) if method == "learned" else method


def shapes(robot: sn.Robot, count: int, max_bend: float, seed: int) -> Floats:
    """Configurations within the limits of length and bend."""
    rng = np.random.default_rng(seed)
    low, high, cap = robot.limits[:, :3].T
    bend = np.fmin(cap, max_bend) * rng.random((count, len(robot)))
    angle = 2.0 * np.pi * rng.random((count, len(robot)))
    return np.stack([bend * np.cos(angle), bend * np.sin(angle), rng.uniform(low, high, (count, len(robot)))], axis=-1)


def tip_targets(robot: sn.Robot, count: int, max_bend: float = 1.2, seed: int = 0, kind: str = "direction") -> Any:
    """Targets that some configuration meets."""
    asked: Any = {"position": None, "direction": np.s_[:3, 2], "rotation": np.s_[:3, :3]}[kind]
    poses = [robot.tip(q) for q in shapes(robot, count, max_bend, seed)]
    own: list[dict[str, Any]] = [{} if asked is None else {kind: pose[asked]} for pose in poses]
    return [sn.Target(pose[:3, 3], **each) for pose, each in zip(poses, own, strict=True)]


def solved_and_verified(solver: sn.Solver, targets: Any) -> int:
    """Count what is solved; what the method says of each is what the slow path finds."""
    count = 0
    for target in targets:
        solution = solver.solve(target)
        check = solution.verify()
        assert solution.solved == check.ok, (solution, check)
        if not solution.solved:
            assert solution.worst is not None
        elif solution.position_error is not None:
            assert abs(solution.position_error - check.position_error) < 1e-9 * solver.robot.mean_length
        count += solution.solved
    return count


def many_are_as_one(solver: sn.Solver, targets: Any) -> None:
    """Demand that a batch gives what a loop gives, and the same again."""
    one = [solver.solve(target) for target in targets]
    for single, together in zip(one, solver.solve_many(targets), strict=True):
        np.testing.assert_array_equal(single.q, together.q)
        assert (single.status, single.iterations, single.starts) == (
            together.status,
            together.iterations,
            together.starts,
        )


def keeps_its_limits(method: methods.Choice, robot: sn.Robot) -> None:
    """Demand that answers to what cannot be reached keep the limits as well."""
    solver = sn.Solver(robot, method=method, max_starts=3)
    rng = np.random.default_rng(0)
    for _ in range(20):
        aim = rng.normal(size=3)
        target = sn.Target(rng.normal(size=3) * robot.mean_length * rng.choice([0.05, 0.5, 3.0]), direction=aim)
        solution = solver.solve(target)
        assert np.isfinite(solution.q).all()
        assert robot.excess(solution.q) <= 1e-9 * robot.mean_length, solution
        assert not solution.solved or solution.verify().ok


LIMITED = sn.Robot(
    [
        sn.Segment((0, 120), 0.0),
        sn.Segment((30, 50), 1.2),
        sn.Segment((30, 50), 3.1, max_curvature=0.03),
        sn.Segment(40, 2.0),
        sn.Segment((20, 40), 0.8),
    ]
)
"""An insertion stage, a limit of curvature, an inextensible segment."""


def begins_from_an_initial_configuration(method: methods.Choice) -> None:
    """Demand that an initial configuration that meets the target is given back as it is."""
    solver = sn.Solver(ARM, method=method)
    for q, target in zip(shapes(ARM, 10, 1.2, 5), tip_targets(ARM, 10, 1.2, 5), strict=True):
        solution = solver.solve(target, initial=q)
        assert solution.start == "given"
        assert solution.starts == 1
        assert np.abs(ARM.backbone(solution.q) - ARM.backbone(q)).max() < 1e-3 * ARM.mean_length


def does_not_pretend(method: methods.Choice) -> None:
    """Demand that an answer through an obstacle is not called solved."""
    wall = sn.Scene([sn.Sphere((0, 0, -150), radius=40, name="ball")])
    solver = sn.Solver(ARM, wall, method=method, max_starts=2, tolerance=sn.Tolerance(1.0, 0.01))
    ahead = sn.Target((0, 0, -290))
    solution = solver.solve(ahead)
    if not solution.solved:
        assert solution.worst is not None
        assert not solution.verify().ok
    else:
        assert solution.verify().ok
