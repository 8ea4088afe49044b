"""Goes from waypoint to waypoint, and proves the way."""

import time as clock
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import ANSWER_WIDTH
from sinuous.motion.motion import Motion
from sinuous.motion.start import blocked_by
from sinuous.motion.times import spread_times
from sinuous.problem.target import Targets
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solution.verification import Worst
from sinuous.solving.between import Prover, Steps, load_motions
from sinuous.solving.solver import Initial, Solver


class Knot(NamedTuple):
    """A configuration (n, 3) of the motion, and what is proved of the step that leads there (1, 14)."""

    q: Floats
    came: Floats | None


class Tracker:
    """A motion while it is found, waypoint after waypoint.

    Parameters
    ----------
    solver : Solver
    start : Solution or array_like (n, 3), optional
        The configuration that the robot is in.

    Attributes
    ----------
    blocked : Worst or None
        What keeps the robot from beginning at the start.

    Raises
    ------
    InputError
        When the start is no configuration of the robot.
    """

    def __init__(self, solver: Solver, start: Initial | None = None) -> None:
        scene = solver.scene.snapshot()
        load_motions(solver.robot, scene)
        self._solver, self._began = solver, clock.perf_counter()
        self._prover = Prover(solver.robot, scene)
        self._knots: list[Knot] = []
        self._tried: list[tuple[Solution, int | None]] = []
        self._approaches = start is not None
        self.blocked: Worst | None = None
        if start is not None:
            self._begin_at(solver.configuration("start", start))

    def _begin_at(self, q: Floats) -> None:
        self._knots.append(Knot(q, None))
        self.blocked = blocked_by(self._solver.robot, q, self._prover)

    def go_to(self, targets: Targets) -> Solution:
        """Solve the next waypoint from where the robot is, and prove the way there."""
        solution = self._solver.solve(targets, self._knots[-1].q if self._knots else None)
        if solution.solved:
            self._move_to(solution)
        self._tried.append((solution, len(self._knots) - 1 if solution.solved else None))
        return solution

    def _move_to(self, solution: Solution) -> None:
        if self._prover.scene is not solution.problem.scene:  # it was updated, and the robot moves after that
            self._prover = Prover(self._solver.robot, solution.problem.scene)
        if len(self._knots) == 1 and self._approaches and np.array_equal(self._knots[0].q, solution.q):
            self._approaches = False  # the robot is at its first waypoint already
            return
        came = self._prover.prove(np.stack([self._knots[-1].q, solution.q])) if self._knots else None
        self._knots.append(Knot(solution.q, came))

    def motion(self, remaining: int = 0) -> Motion:
        """Return the motion so far; `remaining` waypoints were not tried."""
        robot = self._solver.robot
        q = np.array([knot.q for knot in self._knots]).reshape(-1, len(robot), 3)
        answers = [knot.came for knot in self._knots if knot.came is not None]
        steps = Steps(np.concatenate(answers) if answers else np.zeros((0, ANSWER_WIDTH)))
        return Motion.made(
            *(robot, self._prover.scene, q, self._times(q), steps),
            solutions=[solution for solution, _ in self._tried],
            waypoint_knots=[knot for _, knot in self._tried],
            remaining=remaining,
            seconds=clock.perf_counter() - self._began,
            method=self._solver.method,
            seed=self._solver.options.seed,
            ended=None if self.blocked is None else Status.START_BLOCKED,
            worst=self.blocked,
        )

    def _times(self, q: Floats) -> Floats:
        """Times of the knots: the first one is at 0, and every waypoint takes 1."""
        knots = [knot for _, knot in self._tried]
        fixed = [(i + self._approaches, knot) for i, knot in enumerate(knots) if knot is not None]
        if self._approaches:
            fixed.insert(0, (0, 0))
        if not fixed:
            return np.empty(0)
        numbers, given = np.array(fixed).T
        return spread_times(self._solver.robot, q, given, numbers.astype(np.float64))
