"""Plan a motion from a start to a goal, proved clear all the way."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from typing import Any, Self, Unpack, cast

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.arguments import Number, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import refuse_unknown, warn_of
from sinuous.base.frozen import call
from sinuous.kernels.certificate.query import ANSWER_WIDTH
from sinuous.methods.method import name_of
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.motion.configurations import blocked_by, check_limits, lever_metric, overlap_at, settle, violated_by
from sinuous.motion.motion import Motion
from sinuous.motion.pace import Pace
from sinuous.motion.planning.memory_search import MemorySearch, remember, search_memory
from sinuous.motion.planning.planners import find_path, find_timed_path, standing
from sinuous.motion.planning.query import ROUNDING, Deadline, FixedGoal, ProvedPath, Query, TargetGoals
from sinuous.motion.planning.rrt_connect import RRTConnect
from sinuous.motion.report import Report
from sinuous.motion.timetable import spread_times
from sinuous.problem.problem import check_sizes, input_warnings
from sinuous.problem.target import Target, Targets, is_place, target_list
from sinuous.scene.scene import Scene, SceneLike, as_scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.certificates.steps import Prover, Steps, load_motions
from sinuous.solver.options import SolveArguments, SolveOptions
from sinuous.solver.solver import Initial, Solver

TIME = 5.0
"""Default budget of a plan, in seconds."""

MOST_SHORTCUTS = 1_000_000

Goal = Targets | Initial
"""Where a plan may end: at a target, at several that are met at once, or at a configuration."""


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
    is found is left out. With a target as goal, it is solved from the start first, then from no configuration, and
    more configurations that meet it become goals while the trees grow.

    Where obstacles are `Moving`, the way is one through space and time: the straight line, and ways past obstacles as
    they stand at several times or past those that stand still, are paced, on, waiting or back (Kant & Zucker 1986),
    then a tree grows forwards in time (LaValle & Kuffner 2001). It needs `rates` or a `duration`.

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
        how fast the robot may be; `Motion.timed` passes the same way with accelerations on the way, and blends. With
        their `acceleration`, the motion is from rest to rest, and at a knot the speed changes by no more than that in
        the mean of the durations beside it; at both ends, in half of one. The same `seed` gives the same motion, unless
        the time runs out.

    Returns
    -------
    Motion
        Always; look at its status. It is `start_blocked` where the start overlaps or violates a limit by more than
        1e-3 (rad, or mean lengths of the robot; by less it is brought within, and `notes` say so),
        `target_blocked` where a configuration as goal overlaps (where obstacles move: when the motion ends, or what
        stands still); with a target what `solve` says of it, where it is not solved; `rate_bound` where rates allow no
        way of this duration to a configuration, or not so short a duration of the way that was found, whose times are
        longer then; `time_limit` where no motion was found, which does not mean that there
        is none. Its knots are the start alone in all these cases.

    Raises
    ------
    InputError
        When an argument is not what it should be, or a configuration as goal violates a limit.
    """
    return Planner._for_one_query(robot, scene, **options).plan(start, goal)


@dataclass(eq=False)
class PlanWork:
    """Memory for plans of a robot in a scene: what proves motions, what grows trees, and what walks in a memory."""

    scene: Snapshot
    prover: Prover
    trees: RRTConnect
    walks: MemorySearch | None = None


class Workspaces:
    """Workspaces of one robot. Each is lent to one plan at a time, so that threads may share them.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._free: list[PlanWork] = []

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._robot,)

    @contextmanager
    def lent(self, scene: Snapshot) -> Iterator[PlanWork]:
        """Lend a workspace for a scene in which nothing moves: one that was given back, or a new one."""
        work = self._take(scene)
        try:
            yield work
        finally:
            self._free.append(work)

    def _take(self, scene: Snapshot) -> PlanWork:
        while self._free:
            try:
                work = self._free.pop()
            except IndexError:  # another thread was quicker
                break
            if work.scene is scene:
                return work
        prover = Prover(self._robot, scene)
        return PlanWork(scene, prover, RRTConnect(self._robot, scene, prover))


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
        self._prepare(robot, scene, options)
        self._load()

    @classmethod
    def _for_one_query(cls, robot: Robot, scene: SceneLike | None, **options: Unpack[PlanArguments]) -> Self:
        """Prepare a planner for one plan: what is compiled, or loaded, is so where it is needed first."""
        planner = object.__new__(cls)
        planner._prepare(robot, scene, options)
        return planner

    def _prepare(self, robot: Robot, scene: SceneLike | None, options: PlanArguments) -> None:
        """Check all arguments."""
        given: dict[str, Any] = dict(options)
        refuse_unknown(given, PlanArguments.__annotations__)
        checks.instance("robot", robot, Robot, "a Robot")
        self._shortcuts = checks.integer("shortcuts", given.pop("shortcuts", 0), 0, MOST_SHORTCUTS)
        self._pace = Pace.of(robot, **{key: given.pop(key) for key in ("rates", "duration", "begin") if key in given})
        self._scene, self._options = as_scene(scene), SolveOptions.of({"time": TIME, **given}) if given else _options()
        self._robot = robot = self._options.demanded_of(robot)
        self._pace.check(self._scene.snapshot())
        check_sizes(robot, self._scene)
        if self._options.memory is not None:
            self._options.memory.check(robot)
        warn_of(input_warnings(robot, self._scene.snapshot()))
        self._workspaces = Workspaces(robot)

    def _load(self) -> None:
        """Compile all that a plan needs, or load it, and look up what is kept of a robot: no plan waits for that."""
        robot = self._robot
        load_motions(robot, self._scene.snapshot())
        with self._workspaces.lent(standing(self._scene.snapshot())) as work:
            if not robot.has_external_load:
                work.trees.load()
        violated_by(robot, np.zeros((len(robot), 3)))
        lever_metric(robot)

    def __repr__(self) -> str:
        sizes = [f"{len(self._robot.segments)} segments", f"{len(self._scene)} obstacles"]
        return call("Planner", [*sizes, f"time={self._options.time:g}"])

    def plan(self, start: Initial, goal: Goal) -> Motion:
        """Plan a motion from a start to a goal; see the function `plan`."""
        begin, notes = settle(self._robot, "start", self._configuration("start", start))
        end, more = self._end(goal)
        scene = self._scene.snapshot()
        if scene.moves:
            return self._plan_in_time(scene, begin, end, within=not notes).with_notes(notes + more)
        if not isinstance(end, np.ndarray):
            _ = self._solver  # loaded now, because compiling is no planning
        deadline = Deadline(self._options.time)
        with self._workspaces.lent(scene) as work:
            return self._plan_still(work, deadline, begin, end, within=not notes).with_notes(notes + more)

    def _plan_still(
        self, work: PlanWork, deadline: Deadline, begin: Floats, end: Floats | list[Target], *, within: bool
    ) -> Motion:
        """Plan a motion among obstacles that stand still: along motions that a memory holds, or by trees.

        `within`: whether the start is known to keep all limits.
        """
        report = self._blocked(begin, end, (work.prover, work.prover), within)
        if report is not None:
            return self._made(work.scene, deadline, begin, report)
        goals = FixedGoal(end) if isinstance(end, np.ndarray) else TargetGoals(self._solver, end, [])
        query = Query(self._robot, work.scene, begin, goals, self._options.seed, deadline, self._shortcuts)
        work.walks = search_memory(self._options.memory, self._robot, work.scene, work.trees, work.walks)
        path = None if work.walks is None else work.walks.find_path(query, goals)
        if path is None:
            if not isinstance(end, np.ndarray):
                solution = self._solver.solve(end, begin)
                if not solution.solved:
                    return self._made(work.scene, deadline, begin, _of_waypoint(solution))
                goals = TargetGoals(self._solver, end, [solution])
                query = replace(query, scene=solution.problem.scene, goals=goals)
            path = find_path(query, work.trees if query.scene is work.scene else None)
            remember(self._options.memory, self._robot, path)
        return self._made(query.scene, deadline, begin, _arrived(path, goals), path)

    def _plan_in_time(self, scene: Snapshot, begin: Floats, end: Floats | list[Target], *, within: bool) -> Motion:
        """Plan a motion among obstacles that move; `within` as before.

        Where the duration is given, the goal is solved, and must be clear, among what is there then; otherwise among
        what stands still.
        """
        duration = self._pace.duration
        there = standing(scene) if duration is None else scene.at(self._pace.begin + duration)
        solver = None
        if not isinstance(end, np.ndarray):  # loaded now, because compiling is no planning
            solver = Solver._of_checked(self._robot, Scene.of(there), self._options)
        deadline, prover = Deadline(self._options.time), Prover(self._robot, scene)
        made = partial(self._made, scene, deadline, begin)
        report = self._blocked(begin, end, (prover, Prover(self._robot, there)), within)
        if report is not None:
            return made(report)
        goals: FixedGoal | TargetGoals
        if solver is None:
            goals, goal = FixedGoal(cast(Floats, end)), cast(Floats, end)
        else:
            solution = solver.solve(cast(list[Target], end), begin)
            if not solution.solved:
                return made(_of_waypoint(solution))
            goals, goal = TargetGoals(solver, list(solution.problem.targets), [solution]), solution.configuration
        still, pace = Query(self._robot, scene, begin, goals, self._options.seed, deadline), self._pace
        query = still.in_time(prover, pace.begin, pace.begin, duration is None, pace.rates)
        query = replace(query, end=pace.end(scene, query.soonest(begin, goal)))
        if solver is None and not query.early:
            soonest, window = query.soonest(begin, goal), query.end - query.begin
            if soonest > window * (1.0 + ROUNDING):
                return made(Report(ended=Status.RATE_BOUND))
        path = find_timed_path(query)
        report = _arrived(path, goals)
        if path is not None and path.times is not None and query.early and report.solutions:
            report = replace(report, solutions=(self._again(report.solutions[0], scene.at(float(path.times[-1]))),))
        return made(report, path)

    def _again(self, solution: Solution, scene: Snapshot) -> Solution:
        """Return the same solution, solved again among all that is there when the motion ends."""
        solver = Solver._of_checked(self._robot, Scene.of(scene), self._options)
        again = solver.solve(list(solution.problem.targets), solution.configuration)
        return again if np.array_equal(again.configuration, solution.configuration) else solution

    def _blocked(
        self, begin: Floats, end: Floats | list[Target], provers: tuple[Prover, Prover], within: bool
    ) -> Report | None:
        """Say what keeps the robot from beginning, or from being at a configuration as goal; `None`: nothing does.

        `provers`: of the scenes at both ends.
        """
        to_configuration = isinstance(end, np.ndarray)
        worst = blocked_by(self._robot, begin, provers[0], self._pace.begin, within)
        if worst is not None:
            return Report(ended=Status.START_BLOCKED, blocking=worst, remaining=0 if to_configuration else 1)
        worst = overlap_at(self._robot, end, provers[1]) if isinstance(end, np.ndarray) else None
        return None if worst is None else Report(ended=Status.TARGET_BLOCKED, blocking=worst)

    @cached_property
    def _solver(self) -> Solver:
        """Solves targets; without any, nothing is compiled for it."""
        return Solver._of_checked(self._robot, self._scene, self._options)

    def _configuration(self, key: str, given: Initial) -> Floats:
        own = given.configuration if isinstance(given, Solution) else given
        return self._robot._one_configuration(key, own)

    def _made(
        self, scene: Snapshot, deadline: Deadline, start: Floats, report: Report, path: ProvedPath | None = None
    ) -> Motion:
        """Make the motion along a path, or one that stays at the start."""
        robot = self._robot
        found = path or ProvedPath(start[None], np.zeros((0, ANSWER_WIDTH)))
        times = found.times
        if times is None:
            fixed = np.unique([0, len(found.q) - 1])
            times = self._pace.spread(spread_times(robot, found.q, fixed, np.arange(float(len(fixed)))))
        told = replace(report, seconds=deadline.spent, method=name_of(self._options.method), seed=self._options.seed)
        motion = Motion.made(robot, scene, found.q, times, Steps(found.answers, robot._least_clearances), told)
        return motion if scene.moves else self._pace.kept(motion)

    def _end(self, goal: Goal) -> tuple[Floats | list[Target], tuple[str, ...]]:
        """The configuration (n, 3) or the targets that are meant, and what is to be said of them."""
        listed = isinstance(goal, list | tuple) and any(isinstance(each, Target) for each in goal)
        if listed or isinstance(goal, Target) or is_place(goal):
            return list(target_list("goal", goal, self._robot)), ()
        return check_limits(self._robot, "goal", self._configuration("goal", cast(Initial, goal)))


@cache
def _options() -> SolveOptions:
    """Options where nothing is said."""
    return SolveOptions.of({"time": TIME})


def _of_waypoint(solution: Solution) -> Report:
    """Tell that the motion does not come to a waypoint, for which there may be a solution."""
    return Report(solutions=(solution,), waypoint_knots=(None,))


def _arrived(path: ProvedPath | None, goals: FixedGoal | TargetGoals) -> Report:
    """Tell to which of the goals a path leads, or that none was found in time."""
    if path is None:
        report = _of_waypoint(goals.solutions[0]) if isinstance(goals, TargetGoals) else Report()
        return replace(report, ended=Status.TIME_LIMIT)
    if isinstance(goals, FixedGoal):
        return Report()
    return Report(solutions=(goals.solution_at(path.q[-1]),), waypoint_knots=(len(path.q) - 1,))
