"""A plan among obstacles that move: what keeps it from beginning or ending, where it ends, and the way."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.configurations import blocked_by, overlap_at
from sinuous.motion.in_time.find import find_in_time, standing
from sinuous.motion.in_time.question import ROUNDING, TimedQuestion, TimedWay
from sinuous.motion.planning.goals import FixedGoal, Goals, waypoints_of
from sinuous.motion.times import Timing
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solving.between.steps import Prover
from sinuous.solving.options import SolveOptions
from sinuous.solving.solver import Solver


class Found(NamedTuple):
    """A way, where one was found, and what is told of the motion."""

    way: TimedWay | None
    told: dict[str, Any]


class InTime:
    """Looks for one motion among obstacles that move.

    Parameters
    ----------
    robot : Robot
    scene : Snapshot
    options : SolveOptions
    timing : Timing
    seconds_left : callable
    """

    def __init__(
        self,
        robot: Robot,
        scene: Snapshot,
        options: SolveOptions,
        timing: Timing,
        seconds_left: Callable[[], float],
    ) -> None:
        self._robot, self._scene, self._options, self._timing = robot, scene, options, timing
        self._seconds_left, self._prover = seconds_left, Prover(robot, scene)

    def find(self, start: Floats, end: Floats | list[Target]) -> Found:
        """Find a way from a start (n, 3) to a configuration (n, 3) or to targets that are met at once."""
        worst = blocked_by(self._robot, start, self._prover, self._timing.begin)
        if worst is not None:
            told = {"ended": Status.START_BLOCKED, "blocking": worst, "remaining": waypoints_of(end)}
            return Found(None, told)
        if isinstance(end, np.ndarray):
            return self._to_configuration(start, end)
        return self._to_targets(start, end)

    def _to_configuration(self, start: Floats, end: Floats) -> Found:
        question = self._question(start, FixedGoal(end), end)
        late = None if question.early else question.end
        place = Prover(self._robot, standing(self._scene)) if late is None else self._prover
        worst = overlap_at(self._robot, end, place, late or 0.0)
        if worst is not None:
            return Found(None, {"ended": Status.TARGET_BLOCKED, "blocking": worst})
        if late is not None and question.soonest(end - start) > (late - question.begin) * (1.0 + ROUNDING):
            return Found(None, {"ended": Status.RATE_BOUND})
        way = find_in_time(question)
        return Found(way, {"ended": Status.TIME_LIMIT} if way is None else {})

    def _to_targets(self, start: Floats, end: list[Target]) -> Found:
        """Solve the targets among what is there when the motion ends, or else among what stands still."""
        duration = self._timing.duration
        place = standing(self._scene) if duration is None else self._scene.at(self._timing.begin + duration)
        solver = Solver.prepared(self._robot, Scene.of(place), self._options)
        solution = solver.solve(end, start)
        if not solution.solved:
            return Found(None, {"solutions": (solution,), "waypoint_knots": (None,)})
        goals = Goals(solver, solution)
        way = find_in_time(self._question(start, goals, solution.q))
        if way is None:
            return Found(None, {"ended": Status.TIME_LIMIT, "solutions": (solution,), "waypoint_knots": (None,)})
        met = next(each for each in goals.solutions if np.array_equal(each.q, way.q[-1]))
        there = self._there(end, met, float(way.times[-1]))
        return Found(way, {"solutions": (there,), "waypoint_knots": (len(way.q) - 1,)})

    def _there(self, targets: list[Target], met: Solution, when: float) -> Solution:
        """Return the same solution, solved again among all that is there when the motion ends."""
        if self._timing.duration is not None:
            return met
        again = Solver.prepared(self._robot, Scene.of(self._scene.at(when)), self._options).solve(targets, met.q)
        return again if np.array_equal(again.q, met.q) else met

    def _question(self, start: Floats, goals: Callable[[Floats], Floats], goal: Floats) -> TimedQuestion:
        timing = self._timing
        asked = TimedQuestion(
            robot=self._robot,
            prover=self._prover,
            start=start,
            begin=timing.begin,
            end=timing.begin,
            early=timing.duration is None,
            goals=goals,
            rates=timing.rates,
            seed=self._options.seed,
            seconds_left=self._seconds_left,
        )
        return replace(asked, end=timing.end(self._scene, asked.soonest(goal - start)))
