"""IPOPT among balls, by way of casadi: the same targets, the same limits, the body as places on every segment."""

from time import perf_counter
from typing import Any, ClassVar

import casadi
import numpy as np

from benchmarks.problems import random_configurations
from benchmarks.solvers.peers import start_of, symbolic_frames
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene

PLACES = 10
"""Places on every segment that are kept out of every ball."""

MOST_ROWS = 3000
"""Constraints beyond which a program takes too long to build."""

PATIENCE = 3.0
"""Seconds for one start."""


class AmongSpheres:
    """Half the square of the residual as the objective; bends, and every place against every ball, as constraints.

    The clearance asked of a place includes what a straight body could sag between two, so that the judge, who looks
    in between, finds nothing. Derivatives, first and second, are exact.

    Parameters
    ----------
    robot : Robot
    scene : Scene
        Of balls; see `takes`.
    tolerance : Tolerance
        With its position filled in.
    """

    STARTS: ClassVar[int] = 3
    """The single arc, then random configurations."""

    @classmethod
    def takes(cls, robot: Robot, scene: Scene) -> bool:
        """Whether a scene is of balls, and not of too many."""
        balls = all(isinstance(obstacle, Sphere) and not obstacle.inside for obstacle in scene.obstacles)
        return balls and robot.mount == 0.0 and len(robot) * PLACES * len(scene) <= MOST_ROWS

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance) -> None:
        self._robot = robot
        x, goal, weight = casadi.SX.sym("x", 3 * len(robot)), casadi.SX.sym("goal", 12), casadi.SX.sym("weight", 2)
        frames = symbolic_frames(robot, x, PLACES)
        rotation, position = frames[-1][-1]
        miss = (position - goal[:3]) / robot.mean_length
        lean = weight[0] * casadi.sumsqr(rotation[:, 2] - goal[9:])
        turn = weight[1] * casadi.sumsqr(casadi.vec(rotation) - goal[3:])
        bends = [x[3 * k] ** 2 + x[3 * k + 1] ** 2 for k in range(len(robot))]
        rows = [row for k, places in enumerate(frames) for row in self._clear(k, places, scene)]
        low = [(-segment.max_bend, -segment.max_bend, segment.length[0]) for segment in robot.segments]
        high = [(segment.max_bend, segment.max_bend, segment.length[1]) for segment in robot.segments]
        self._limits: dict[str, Any] = {
            "lbx": np.ravel(low),
            "ubx": np.ravel(high),
            "lbg": [0.0] * (len(bends) + len(rows)),
            "ubg": [segment.max_bend**2 for segment in robot.segments] + [casadi.inf] * len(rows),
        }
        program = {
            "x": x,
            "p": casadi.vertcat(goal, weight),
            "f": 0.5 * (casadi.sumsqr(miss) + lean + turn),
            "g": casadi.vertcat(*bends, *rows),
        }
        exact = (tolerance.position or 0.0) / robot.mean_length
        quiet: Any = {"print_level": 0, "sb": "yes", "max_wall_time": PATIENCE, "tol": 1e-2 * exact}
        self._run = casadi.nlpsol("ik", "ipopt", program, {"ipopt": quiet, "print_time": False})

    def _clear(self, k: int, places: list[tuple[Any, Any]], scene: Scene) -> list[Any]:
        """One row for each place of segment `k` and each ball, at least 0 where they are apart."""
        unit, radius = self._robot.mean_length, self._robot.radii[k]
        between = 0.5 * self._robot.segments[k].length[1] / PLACES
        rows = []
        for _, place in places:
            for ball in scene.obstacles:
                assert isinstance(ball, Sphere)
                needed = (ball.radius + radius) ** 2 + between**2
                rows.append((casadi.sumsqr(place - ball.center) - needed) / unit**2)
        return rows

    def solve(self, target: Target, start: int) -> tuple[Floats, float]:
        """Return the configuration (n, 3) where it ended from start number `start`, and the seconds that it took."""
        begin = start_of(self._robot, target)
        if start > 0:
            begin = random_configurations(self._robot, 1, np.random.default_rng(start))[0].ravel()
        goal, weight = np.zeros(12), np.zeros(2)
        goal[:3] = np.array(target.position)
        if target.direction is not None:
            goal[9:], weight[0] = target.direction, 1.0
        elif target.rotation is not None:
            goal[3:], weight[1] = target.rotation.T.ravel(), 1.0
        began = perf_counter()
        answer = self._run(x0=begin, p=np.concatenate([goal, weight]), **self._limits)
        seconds = perf_counter() - began
        q = np.array(answer["x"]).reshape(-1, 3)
        return self._held(q), seconds

    def _held(self, q: Floats) -> Floats:
        """Put lengths within their bounds, which IPOPT keeps to a relative 1e-8."""
        low, high = np.array([segment.length for segment in self._robot.segments]).T
        result = q.copy()
        result[:, 2] = q[:, 2].clip(low, high)
        caps = np.array([segment.max_bend for segment in self._robot.segments])
        norms = np.hypot(q[:, 0], q[:, 1])
        result[:, :2] *= np.minimum(1.0, caps / np.maximum(norms, 1e-300))[:, None]
        return result
