"""What is called impossible is impossible: no configuration is ever contradicted, and the clear cases are seen."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.kernels.solve import verdicts
from sinuous.kernels.solve.verdicts import POSSIBLE
from sinuous.measures.reach import bounds
from tests.helpers import Floats, kernel_problem, random_pose

TOLERANCE = (1e-3, 1e-2)


def verdict(
    robot: sn.Robot, targets: Any, scene: sn.Scene | None = None, tolerance: tuple[float, float] = TOLERANCE
) -> int:
    return verdicts.verdict_of(
        kernel_problem(robot, targets, scene, sn.Tolerance(*tolerance), margin=0.0, coarse_depth=2)
    )


def robots(seed: int) -> sn.Robot:
    rng = np.random.default_rng(seed)
    segments = [
        sn.Segment(sorted(rng.uniform(0.0, 1.5, 2)), rng.choice([0.0, 0.2, 0.6, 2.0]), rng.choice([0.2, 1.0, 9.0]))
        for _ in range(rng.integers(1, 6))
    ]
    tool = random_pose(rng, 0.3) if seed % 2 else None
    return sn.Robot(segments, base=random_pose(rng), tool=tool, radius=0.05)


def extreme(robot: sn.Robot, rng: np.random.Generator) -> Floats:
    """Draw a configuration, most of it on the limits, bent to one side: as far and as near as the robot gets."""
    out = []
    side = rng.uniform(-math.pi, math.pi)
    for segment in robot.segments:
        length = rng.choice([*segment.length, rng.uniform(*segment.length)])
        bend = min(segment.max_bend, segment.max_curvature * length) * rng.choice([0.0, 1.0, 1.0])
        angle = rng.choice([side, side, rng.uniform(-math.pi, math.pi)])
        out.append([bend * math.cos(angle), bend * math.sin(angle), length])
    return np.array(out)


@pytest.mark.parametrize("seed", range(25))
def test_what_is_attained_within_large_tolerances_is_never_impossible(seed: int) -> None:
    robot, rng = robots(seed), np.random.default_rng(seed)
    for _ in range(10):
        tip = robot.tip(extreme(robot, rng))
        near, angle = rng.uniform(0.01, 1.0, 2) * (robot.mean_length, 2.0)
        off, axis = (vector / np.linalg.norm(vector) for vector in rng.normal(size=(2, 3)))
        place = tip[:3, 3] + 0.999 * near * off
        rotation = Rotation.from_rotvec(0.999 * angle * axis).as_matrix() @ tip[:3, :3]
        for target in (sn.Target(place, direction=rotation[:, 2]), sn.Target(place, rotation=rotation)):
            assert all(b.needed <= b.available + 1e-9 for b in bounds(robot, target, sn.Tolerance(near, angle)))
            assert verdict(robot, target, tolerance=(near, angle)) == POSSIBLE


@pytest.mark.parametrize("seed", range(10))
def test_a_target_that_a_clear_body_attains_is_never_blocked(seed: int) -> None:
    robot = robots(seed)
    rng = np.random.default_rng(seed)
    q = extreme(robot, rng)
    end, tip = robot.forward(q)[-1], robot.tip(q)
    away = rng.normal(size=3)
    away /= np.linalg.norm(away)
    ball = sn.Scene([sn.Sphere(end[:3, 3] + away * (0.2 + 0.05 + 1e-9), 0.2)])  # touches the ball at the tip
    for target in (sn.Target(tip[:3, 3]), sn.Target(tip[:3, 3], rotation=tip[:3, :3]), sn.Target(direction=tip[:3, 2])):
        assert verdict(robot, target, ball) == POSSIBLE


def test_an_obstacle_about_the_mount_blocks_nothing_there() -> None:
    robot = sn.Robot.uniform(3, (0.5, 1.0), radius=0.1, mount=2.0)
    assert verdict(robot, sn.Target((0, 0, 1.5)), sn.Scene([sn.Sphere((0, 0, 1.5), 0.3)])) == POSSIBLE
