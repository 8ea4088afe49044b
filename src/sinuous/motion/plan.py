"""Plan a motion from a start to a goal, proved clear all the way."""

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any, Unpack, cast

import numpy as np

from sinuous import checks
from sinuous.arguments import Number, Whole
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.kernels.between.query import ANSWER_WIDTH
from sinuous.methods.registry import name_of
from sinuous.motion.configurations import blocked_by, check_limits, lever_metric, overlap_at, violated_by
from sinuous.motion.in_time.find import standing
from sinuous.motion.in_time.search import InTime
from sinuous.motion.motion import Motion
from sinuous.motion.planning.goals import FixedGoal, Goals, waypoints_of
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.watch import Watch
from sinuous.motion.planning.ways import find_way
from sinuous.motion.planning.workspaces import Workspace, Workspaces
from sinuous.motion.report import Report
from sinuous.motion.times import Timing, spread_times
from sinuous.problem.problem import check_sizes
from sinuous.problem.suspicions import suspicions, warn_of
from sinuous.problem.target import Target, Targets, target_list
from sinuous.reprs import call
from sinuous.robot.rates import Rates
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene, SceneLike, as_scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solving.between.steps import Steps, load_motions
from sinuous.solving.options import SolveArguments, SolveOptions
from sinuous.solving.planning.trees import Way
from sinuous.solving.solver import Initial, Solver

TIME = 5.0
"""Default budget of a plan, in seconds."""

MOST_SHORTCUTS = 1_000_000

Goal = Targets | Initial
"""Where a plan may end: at a target, at several that are met at once, or at a configuration."""


Made = Callable[..., Motion]
"""Makes the motion of a plan, of what is told of it."""


class PlanArguments(SolveArguments, total=False):
    """Options of `plan` as keyword arguments."""

    shortcuts: Whole
    rates: Rates | None
    begin: Number
    duration: Number | None


def plan(
    robot: Robot, start: Initial, goal: Goal, scene: SceneLike | None = None, **options: Unpack[PlanArguments]
) -> Motion:
    """Plan a motion from a start to a goal: the whole body proved clear of obstacles and of itself, all the way.

    The straight line in the space of configurations is tried first, then trees of configurations that grow towards each
    other from the start and from the goals (RRT-Connect, Kuffner & LaValle 2000). What can be left out of the way that
    is found is left out. With a target as goal, it is solved from the start first, and more configurations that meet
    it become goals while the trees grow.

    Where obstacles are `Moving`, the way is one through space and time: the straight line and ways past what stands
    still are paced, on, waiting or back (Kant & Zucker 1986), then a tree grows forwards in time (LaValle & Kuffner
    2001). It needs `rates` or a `duration`.

    Parameters
    ----------
    robot : Robot
    start : Solution or array_like (n, 3)
        The configuration that the robot is in.
    goal : Target, list of Target, Solution or array_like (n, 3)
        Where it must be: a target, several that are met at once, or a configuration.
    scene : Scene or list of obstacles, optional
    **options
        As for `Solver`, for solving the target; `time` is the budget of the plan, by default 5 s. `shortcuts`: how many
        random places of the way are tried to be joined directly, by default none. `begin`: the time at the start, by
        default 0. `duration`: how long the motion takes, by default 1 or, with `rates`, as short as is found. `rates`:
        how fast the robot may be, where obstacles move; else `Motion.timed` knows how fast a motion may be passed. With
        their `acceleration`, the motion is from rest to rest, and at a knot the speed changes by no more than that in
        the mean of the durations beside it; at both ends, in half of one. The same `seed` gives the same motion, unless
        the time runs out.

    Returns
    -------
    Motion
        Always; look at its status. It is `start_blocked` where the start overlaps or violates a limit,
        `target_blocked` where a configuration as goal overlaps (where obstacles move: when the motion ends, or what
        stands still); with a target what `solve` says of it, where it is not solved; `rate_bound` where rates allow no
        way of this duration to a configuration; `time_limit` where no motion was found, which does not mean that there
        is none. Its knots are the start alone in all these cases.

    Raises
    ------
    InputError
        When an argument is not what it should be, or a configuration as goal violates a limit.
    """
    return Planner(robot, scene, **options).plan(start, goal)


class Planner:
    """A robot in a scene, prepared once for many plans.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
        Live: after an update the next plan sees the new obstacles.
    **options
        As for `plan`.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    def __init__(self, robot: Robot, scene: SceneLike | None = None, **options: Unpack[PlanArguments]) -> None:
        given: dict[str, Any] = dict(options)
        if not isinstance(robot, Robot):
            raise InputError("robot", "", robot, "a Robot")
        self._shortcuts = checks.integer("shortcuts", given.pop("shortcuts", 0), 0, MOST_SHORTCUTS)
        self._timing = Timing.of(robot, {key: given.pop(key) for key in Timing._fields if key in given})
        self._robot, self._scene, self._options = robot, as_scene(scene), SolveOptions.of({"time": TIME, **given})
        self._timing.check(self._scene.snapshot())
        check_sizes(robot, self._scene)
        warn_of(suspicions(robot, self._scene.snapshot()))
        load_motions(robot, self._scene.snapshot())
        self._workspaces = Workspaces(robot)
        work = self._workspaces.take(standing(self._scene.snapshot()))
        work.trees.load()
        self._workspaces.give_back(work)
        # What is kept of a robot is looked up now: the first plan takes no longer than others.
        violated_by(robot, np.zeros((len(robot), 3)))
        lever_metric(robot)

    def __repr__(self) -> str:
        sizes = [f"{len(self._robot)} segments", f"{len(self._scene)} obstacles"]
        return call("Planner", [*sizes, f"time={self._options.time:g}"])

    def plan(self, start: Initial, goal: Goal) -> Motion:
        """Plan a motion from a start to a goal; see the function `plan`."""
        begin, end = self._configuration("start", start), self._end(goal)
        if self._scene.snapshot().moves:
            return self._plan_in_time(begin, end)
        if not isinstance(end, np.ndarray):
            _ = self._solver  # loaded now, because compiling is no planning
        spent, work = Watch(self._options.time), self._workspaces.take(self._scene.snapshot())
        try:
            return self._plan_still(begin, end, spent, work)
        finally:
            self._workspaces.give_back(work)

    def _plan_still(self, begin: Floats, end: Floats | list[Target], spent: Watch, work: Workspace) -> Motion:
        """Plan a motion among obstacles that stand still."""
        made, scene = partial(self._made, spent, begin), work.scene
        worst = blocked_by(self._robot, begin, work.prover)
        if worst is not None:
            return made(scene, ended=Status.START_BLOCKED, blocking=worst, remaining=waypoints_of(end))
        if isinstance(end, np.ndarray):
            worst = overlap_at(self._robot, end, work.prover)
            if worst is not None:
                return made(scene, ended=Status.TARGET_BLOCKED, blocking=worst)
            goals: FixedGoal | Goals = FixedGoal(end)
        else:
            solution = self._solver.solve(end, begin)
            spent.but_for(solution.seconds)
            if not solution.solved:
                return made(scene, solutions=(solution,), waypoint_knots=(None,))
            goals, scene = Goals(self._solver, solution), solution.problem.scene
        seed, shortcuts = self._options.seed, self._shortcuts
        trees = work.trees if scene is work.scene else None
        question = Question(self._robot, scene, begin, goals, seed, shortcuts, spent, trees)
        return self._arrived(made, question, goals)

    def _plan_in_time(self, begin: Floats, end: Floats | list[Target]) -> Motion:
        """Plan a motion among obstacles that move."""
        scene = self._scene.snapshot()
        if not isinstance(end, np.ndarray):  # loaded now, because compiling is no planning
            Solver.prepared(self._robot, Scene.of(scene.at(self._timing.begin)), self._options)
        spent = Watch(self._options.time)
        way, told = InTime(self._robot, scene, self._options, self._timing, spent.seconds_left).find(begin, end)
        if way is None:
            return self._made(spent, begin, scene, **told)
        return self._made(spent, begin, scene, Way(way.q, way.answers), way.times, **told)

    @cached_property
    def _solver(self) -> Solver:
        """Solves targets; without any, nothing is compiled for it."""
        return Solver.prepared(self._robot, self._scene, self._options)

    def _configuration(self, key: str, given: Initial) -> Floats:
        return checks.array(key, given.q if isinstance(given, Solution) else given, (len(self._robot), 3))

    def _arrived(self, made: Made, question: Question, goals: FixedGoal | Goals) -> Motion:
        """Look for a way, and say which of the goals it leads to."""
        way = find_way(question)
        solutions = tuple(goals.solutions) if isinstance(goals, Goals) else ()
        if way is None:
            first = solutions[:1]
            return made(question.scene, ended=Status.TIME_LIMIT, solutions=first, waypoint_knots=(None,) * len(first))
        met = tuple(solution for solution in solutions if np.array_equal(solution.q, way.q[-1]))[:1]
        return made(question.scene, way, solutions=met, waypoint_knots=(len(way.q) - 1,) * len(met))

    def _made(
        self,
        spent: Watch,
        start: Floats,
        scene: Snapshot,
        way: Way | None = None,
        times: Floats | None = None,
        **told: Any,
    ) -> Motion:
        robot = self._robot
        q, answers = (start[None], np.zeros((0, ANSWER_WIDTH))) if way is None else way
        fixed = np.array([0] if way is None else [0, len(q) - 1])
        if times is None:
            times = self._timing.spread(spread_times(robot, q, fixed, np.arange(float(len(fixed)))))
        method, seed = name_of(self._options.method), self._options.seed
        found = Report(seconds=spent.seconds, method=method, seed=seed, **told)
        return Motion.made(robot, scene, q, times, Steps(answers), found)

    def _end(self, goal: Goal) -> Floats | list[Target]:
        """The configuration (n, 3) or the targets that are meant."""
        if isinstance(goal, Target):
            return [goal]
        if isinstance(goal, list | tuple) and any(isinstance(each, Target) for each in goal):
            return list(target_list("goal", goal))
        end = self._configuration("goal", cast(Initial, goal))
        check_limits(self._robot, "goal", end)
        return end
