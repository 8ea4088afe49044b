"""Slow and quick distances agree for everything that comes from files, arrays and functions."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.scene.obstacles import Obstacle
from tests.helpers import present, random_rotation
from tests.scene.shapes import ball, cube, inverted, together

RNG = np.random.default_rng(0)
TURN = random_rotation(RNG)


def ring(points: Any) -> Any:
    """Distance to a torus of radii 1 and 0.3."""
    return np.hypot(np.linalg.norm(points[..., :2], axis=-1) - 1.0, points[..., 2]) - 0.3


OBSTACLES: dict[str, Obstacle] = {
    "cube": sn.Mesh(cube(1.5)[0] @ TURN.T, cube()[1]),
    "hollow": sn.Mesh(*together(ball(3), inverted(cube(0.8)), cube(0.5, (1.7, 0, 0)))),
    "room": sn.Mesh(*ball(3), inside=True),
    "shell": sn.Mesh(ball(2)[0], ball(2)[1][5:]),
    "thick shell": sn.Mesh(ball(2)[0], ball(2)[1][5:], thickness=0.2),
    "cloud": sn.PointCloud(RNG.normal(size=(500, 3)), 0.1),
    "cloud of all sizes": sn.PointCloud(RNG.normal(size=(300, 3)), RNG.uniform(0.0, 0.4, 300)),
    "cells": sn.Grid(RNG.random((8, 9, 10)) < 0.1, (-1, -1, -1), 0.25),
    "field": sn.Field(ring, (-2, -2, -2), (2, 2, 2), 0.2),
}


@pytest.mark.parametrize("name", OBSTACLES)
def test_solutions_among_them_are_verified(name: str) -> None:
    """A robot that starts beside the obstacle, or within it, and must pass close to it."""
    obstacle = OBSTACLES[name]
    inside = bool(getattr(obstacle, "inside", False))
    base = sn.pose((0, 0, -0.8 if inside else -3.0))
    robot = sn.Robot.uniform(6, (0.1, 0.3) if inside else (0.6, 1.2), 2.0, radius=0.05, base=base)
    solver = sn.Solver(robot, [obstacle])
    rng, solved = np.random.default_rng(3), 0
    for _ in range(10):
        target = rng.uniform(-0.5, 0.5, 3) if inside else rng.uniform((-2, -2, -1), (2, 2, 2))
        solution = solver.solve(sn.Target(target))
        if solution.solved:
            solved += 1
            check = solution.verify()
            assert check.ok
            assert present(solution.clearance) <= check.clearance + 1e-9
    assert solved >= 4
