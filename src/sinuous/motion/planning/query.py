"""What a planner is asked: from where to where, in which scene, until when; and what it answers."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.model.rates import Rates, Spread
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric
from sinuous.motion.timing import largest, motor_speeds
from sinuous.problem.target import Target
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import LOOSE_SECONDS, Prover, is_passable
from sinuous.solver.solver import Solver

GOALS_AT_ONCE = 8
"""Solves that look for more goals each time a planner asks for them."""

MOST_GOALS = 64
"""Goals of one plan; no more are looked for after that."""

APART = 0.02
"""Two configurations nearer to each other than this, in robot lengths, count as one goal; see `lever_metric`."""

ROUNDING = 1e-9
"""Share by which a step may be quicker than rates allow: rounding."""


class Deadline:
    """The seconds that a plan may take; compiling does not count.

    Parameters
    ----------
    seconds : float
        The budget.
    """

    def __init__(self, seconds: float) -> None:
        self._budget, self._began = seconds, work_time()

    @property
    def spent(self) -> float:
        """Seconds until now."""
        return work_time() - self._began

    def left(self) -> float:
        """Seconds that are left; negative after the end."""
        return self._budget - self.spent


class FixedGoal:
    """One configuration (n, 3) is the goal, whatever is reached."""

    def __init__(self, q: Floats) -> None:
        self.q = q

    def __call__(self, reached: Floats) -> Floats:
        """Return it as the only goal (1, n, 3)."""
        return self.q[None]


class TargetGoals:
    """Configurations that meet the same targets. Each call solves from some configurations that the start reaches.

    Parameters
    ----------
    solver : Solver
    targets : list of Target
    solutions : list of Solution
        Solved ones, of which there must be one when it is called.
    """

    def __init__(self, solver: Solver, targets: list[Target], solutions: list[Solution]) -> None:
        self._whole, self.targets, self.solutions = solver, targets, solutions

    @cached_property
    def _under_load(self) -> Solver:
        """What goes from one configuration to one goal, or nowhere; made when it is needed first."""
        whole = self._whole
        once = replace(whole.options, max_starts=1, routes=False, memory=None)
        return type(whole)._of_checked(whole.robot, whole.scene, once)

    def near(self, q: Floats) -> Floats | None:
        """Follow a configuration (n, 3) to one that meets the targets, which becomes a goal; `None` where it fails."""
        solution = self._follow(q)
        if solution is None:
            return None
        self.solutions.append(solution)
        return solution.configuration

    def __call__(self, reached: Floats) -> Floats:
        """Return all goals (g, n, 3), after looking for more from some of what is reached (m, n, 3)."""
        if len(reached) > 1 and len(self.solutions) < MOST_GOALS:
            for i in np.unique(np.linspace(0, len(reached) - 1, GOALS_AT_ONCE).round().astype(np.intp)):
                self._add(self._follow(reached[i]))
        return np.stack([solution.configuration for solution in self.solutions])

    def add_simplest(self) -> None:
        """Look for a goal from no configuration, but from the arc to the target.

        What is solved from the start keeps its turns and folds; a body without them is often reached straight.
        """
        self._add(self._follow(None))

    def _follow(self, q: Floats | None) -> Solution | None:
        """Follow one configuration (n, 3), or the arc to the targets, to the targets; `None` where that fails."""
        if not self._whole.robot.has_external_load:
            return self._whole.follow(self.targets, q)
        solution = self._under_load.solve(self.targets, q)
        return solution if solution.solved else None

    def _add(self, solution: Solution | None) -> None:
        if solution is not None and self._is_new(solution.configuration):
            self.solutions.append(solution)

    def solution_at(self, q: Floats) -> Solution:
        """Return the solution whose configuration (n, 3) this is."""
        return next(solution for solution in self.solutions if np.array_equal(solution.configuration, q))

    def _is_new(self, q: Floats) -> bool:
        robot = self._whole.robot
        moves = (np.stack([other.configuration for other in self.solutions]) - q) * lever_metric(robot)
        return bool(np.square(moves).sum(axis=(1, 2)).min() > (APART * robot.mean_length) ** 2)


class ProvedPath(NamedTuple):
    """Configurations from a start to a goal, each edge between neighbours proved clear.

    Attributes
    ----------
    q : ndarray (T, n, 3)
        The knots.
    answers : ndarray (T - 1, 14)
        What is proved of the edges; see `kernels.certificate.query`.
    times : ndarray (T,) or None
        When the robot is at each knot, where obstacles move.
    """

    q: Floats
    answers: Floats
    times: Floats | None = None


@dataclass(frozen=True)
class Query:
    """What a planner is asked among obstacles that stand still.

    Attributes
    ----------
    robot : Robot
    scene : Snapshot
    start : ndarray (n, 3)
        Within all limits and clear.
    goals : callable
        Takes configurations (m, n, 3) that the start is known to reach, and returns all goals so far (g, n, 3): within
        all limits and clear. There may be more of them each time.
    seed : int
    deadline : Deadline
    shortcuts : int
        How many random shortcuts are tried on a path that was found.
    """

    robot: Robot
    scene: Snapshot
    start: Floats
    goals: Callable[[Floats], Floats]
    seed: int
    deadline: Deadline
    shortcuts: int = 0

    def in_time(
        self, prover: Prover, begin: float, end: float, early: bool = False, rates: Rates | None = None
    ) -> "TimedQuery":
        """Ask the same of a planner in time; see `TimedQuery`."""
        return TimedQuery(**vars(self), prover=prover, begin=begin, end=end, early=early, rates=rates)


@dataclass(frozen=True, kw_only=True)
class TimedQuery(Query):
    """What a planner is asked among obstacles that move: the start is clear at the time `begin`.

    Goals need not be clear at all times.

    Attributes
    ----------
    prover : Prover
        Of the same scene.
    begin : float
    end : float
        When the robot is at a goal; where `early`, at the latest.
    early : bool
        Whether it may be there before, as early as it can.
    rates : Rates or None
    """

    prover: Prover
    begin: float
    end: float
    early: bool
    rates: Rates | None

    @property
    def accelerations(self) -> Spread | None:
        """How fast rates may change; `None` where nothing limits it."""
        return self._spreads[1]

    def speeds(self, q: Floats, moves: Floats) -> Floats:
        """How many times straight moves (m, n, 3) from `q` can be made in a unit of time (m,), by the rates."""
        most = self._spreads[0]
        if most is None:
            return np.full(len(moves), np.inf)
        return largest(self.robot, most, moves, motor_speeds(self.robot, most, q, moves))

    def gains(self, changes: Floats) -> Floats:
        """How much `speeds` may change in a unit of time (m,), by the accelerations, where `counted` do so (m, c)."""
        most, size = self._spreads[1], self.start.size
        if most is None:
            return np.full(len(changes), np.inf)
        motors = changes[:, size:] if most.limits_elastic(self.robot) else None
        return largest(self.robot, most, changes[:, :size].reshape(-1, *self.start.shape), motors)

    def counted(self, q: Floats) -> Floats:
        """What accelerations are counted in (..., c): configurations (..., n, 3), and values of motors that stretch."""
        flat, most = q.reshape(*q.shape[:-2], -1), self._spreads[1]
        if most is None or not most.limits_elastic(self.robot):
            return flat
        return np.concatenate([flat, self.robot.drive.values(q)], axis=-1)

    @cached_property
    def _spreads(self) -> tuple[Spread | None, Spread | None]:
        """Rates and accelerations of every row and actuator."""
        return (None, None) if self.rates is None else (self.rates.spread(self.robot), self.rates.further(self.robot))

    def least(self, q: Floats, moves: Floats) -> Floats:
        """Least durations (m,) of straight moves (m, n, 3) from `q` that the rates allow."""
        return 1.0 / self.speeds(q, moves)

    def soonest(self, q0: Floats, q1: Floats) -> float:
        """Return a lower bound of the duration of any path from rest at `q0` to rest at `q1` (n, 3).

        Under an acceleration a it takes at least 2 sqrt(d / a) to get as far as d.
        """
        move, drive = (q1 - q0)[None], self.robot.drive
        motors = None if drive.elastic is None else (drive.values(q1) - drive.values(q0))[None]
        fast, gain = (
            math.inf if most is None else float(largest(self.robot, most, move, motors)[0]) for most in self._spreads
        )
        return max(1.0 / fast, 2.0 / math.sqrt(gain))

    def prove(self, q0: Floats, q1: Floats, t0: float, t1: float) -> Floats | None:
        """Return what is proved of an edge (14,); `None` where it is not proved clear."""
        answer: Floats = self.prover.prove(np.stack([q0, q1]), 1.0, LOOSE_SECONDS, np.array([t0, t1]))[0]
        return answer if is_passable(answer) else None

    def prove_in_time(self, q0: Floats, q1: Floats, t0: float, t1: float) -> Floats | None:
        """Return the same for an edge that may be too quick for the rates; `None` where it is."""
        if t1 <= t0 or self.least(q0, (q1 - q0)[None])[0] > (t1 - t0) * (1.0 + ROUNDING):
            return None
        return self.prove(q0, q1, t0, t1)
