"""Where a plan may end: one configuration, or ever more of those that meet the targets."""

from dataclasses import replace

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import distances
from sinuous.robot.robot import Robot
from sinuous.solution.solution import Solution
from sinuous.solving.solver import Solver

AT_ONCE, MOST = 8, 64
"""Goals that are looked for at once, and how many there may be."""

APART = 0.02
"""Configurations nearer to each other than this, in robot lengths, are one goal; see `times.distances`."""


def waypoints_of(end: object) -> int:
    """How many waypoints a plan has that ends there: one with targets, none with a configuration."""
    return 0 if isinstance(end, np.ndarray) else 1


class FixedGoal:
    """One configuration (n, 3), whatever is reached."""

    def __init__(self, q: Floats) -> None:
        self._q = q[None]

    def __call__(self, reached: Floats) -> Floats:
        """Return it as the only goal (1, n, 3)."""
        return self._q


class Goals:
    """Configurations that meet the same targets: of what the start reaches, some are drawn to the targets each time.

    Parameters
    ----------
    solver : Solver
    first : Solution
        The first one.
    """

    def __init__(self, solver: Solver, first: Solution) -> None:
        once = replace(solver.options, max_starts=1, routes=False)
        self._solver = type(solver).prepared(solver.robot, solver.scene, once)
        self._targets = list(first.problem.targets)
        self.solutions = [first]

    def __call__(self, reached: Floats) -> Floats:
        """Return all goals (g, n, 3), after looking for more from some of what is reached (m, n, 3)."""
        if len(reached) > 1 and len(self.solutions) < MOST:
            for i in np.unique(np.linspace(0, len(reached) - 1, AT_ONCE).round().astype(np.intp)):
                solution = self._solver.solve(self._targets, reached[i])
                if solution.solved:
                    self._keep(solution)
        return np.stack([solution.q for solution in self.solutions])

    def _keep(self, solution: Solution) -> None:
        robot = self._solver.robot
        if all(_apart(robot, solution.q, other.q) > APART * robot.mean_length for other in self.solutions):
            self.solutions.append(solution)


def _apart(robot: Robot, one: Floats, other: Floats) -> float:
    return float(distances(robot, np.stack([one, other]))[0])
