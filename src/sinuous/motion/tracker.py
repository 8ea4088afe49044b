"""Goes from waypoint to waypoint, and proves the way."""

import math
from collections.abc import Callable, Iterable

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.answer.worst import Worst
from sinuous.base.arguments import Reconfigure, Shortest
from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.kernels.certificate.query import ANSWER_WIDTH
from sinuous.motion.configurations import blocked_by, settle
from sinuous.motion.knots import Knot, TipLine, TrackedWaypoint
from sinuous.motion.motion import Motion
from sinuous.motion.path_solver import PathSolver
from sinuous.motion.planning.memory_search import MemorySearch, remember, search_memory
from sinuous.motion.planning.planners import find_path, find_timed_path
from sinuous.motion.planning.query import Deadline, ProvedPath, Query, TargetGoals
from sinuous.motion.planning.rrt_connect import RRTConnect
from sinuous.motion.report import Report
from sinuous.motion.shortening import metric_of, shorten
from sinuous.motion.timetable import Timetable, spread_times, with_start
from sinuous.motion.tip_steps import SLACK, TipSteps
from sinuous.problem.target import Target, Targets
from sinuous.solver.certificates.steps import Steps
from sinuous.solver.solver import Initial, Solver

SHORTCUTS = 10
"""How many are tried on a way around."""


class Tracker:
    """A motion while it is found, waypoint after waypoint.

    Parameters
    ----------
    solver : Solver
    start : Solution or array_like (n, 3), optional
        The configuration that the robot is in.
    deviation : float
        How far the tip may be from the straight line between waypoints (length unit).
    timetable : Timetable, optional
        Where obstacles move: its live scene is that of the solver.
    reconfigure : str
        Whether the tip may leave that line, see `track`.

    Attributes
    ----------
    blocked : Worst or None
        What keeps the robot from beginning at the start.

    Raises
    ------
    InputError
        When the start is no configuration of the robot.
    """

    def __init__(
        self,
        solver: Solver,
        start: Initial | None = None,
        deviation: float = math.inf,
        timetable: Timetable | None = None,
        reconfigure: Reconfigure = "refuse",
    ) -> None:
        self._timetable = timetable
        self._steps = TipSteps(solver, deviation, timetable)
        self._solver, self._began = solver, work_time()
        self._outdated = 0  # number of knots, from the first on, whose steps were proved before the last update
        self._knots: list[Knot] = []
        self._tried: list[tuple[Solution, int | None]] = []
        self._at: tuple[Target, ...] | None = None
        self._reconfigure = reconfigure
        self._reconfigured: list[int] = []
        self._walks: MemorySearch | None = None
        self._approaches = self._started = start is not None
        self.blocked: Worst | None = None
        self._notes: tuple[str, ...] = ()
        if start is not None:
            self._begin_at(solver.configuration("start", start))
        self._done = [self._now()]

    def _begin_at(self, q: Floats) -> None:
        begin = 0.0 if self._timetable is None else self._timetable.begin
        q, self._notes = settle(self._solver.robot, "start", q)
        self._knots.append(Knot(q, None, fixed=True, time=begin))
        self.blocked = blocked_by(self._solver.robot, q, self._steps.prover, begin)

    @property
    def tried(self) -> int:
        """How many waypoints were tried."""
        return len(self._tried)

    def follow(
        self,
        waypoints: Iterable[Targets],
        entries: Iterable[TrackedWaypoint] = (),
        progress: Callable[[Solution], object] | None = None,
    ) -> None:
        """Go to all waypoints, one after the other, unless the start is blocked.

        Parameters
        ----------
        waypoints : iterable of Target or list of Target
        entries : iterable of Entry
            What the first waypoints added, where a tracker that was interrupted has found them before.
        progress : callable, optional
            Called with the solution of each waypoint.
        """
        if self.blocked is not None:
            return
        known = iter(entries)
        for targets in waypoints:
            entry = next(known, None)
            solution = self.go_to(targets) if entry is None else self.go_on(targets, entry)
            if progress is not None:
                progress(solution)
        if self._reconfigured and self._reconfigure == "refuse" and self._timetable is None:
            self._follow_otherwise()

    def _follow_otherwise(self) -> None:
        """Look for another way along the whole path, where all that is wrong is that its line was left."""
        if self.motion().status not in (Status.LEFT_PATH, Status.UNPROVED):
            return
        waypoints = [solution.problem.targets for solution, _ in self._tried]
        begun = [self._knots[knot]._replace(solution=solution) for solution, knot in self._tried if knot is not None]
        solver = PathSolver(self._steps, waypoints, begun[0] if self._started else None)
        found = solver.solve([(number - 1, begun[number - 1]) for number in (1, *self._reconfigured)])
        if found is not None:
            kept = (self._tried[0][1] or 0) + 1 if self._started else 0
            self._knots = [*self._knots[:kept], *found.knots[min(1, kept) :]]
            solutions = [
                found.knots[at].solution or before for at, (before, _) in zip(found.waypoints, self._tried, strict=True)
            ]
            self._tried = [(one, at + max(0, kept - 1)) for one, at in zip(solutions, found.waypoints, strict=True)]
            self._reconfigured = found.reconfigured
            self._at = waypoints[-1]

    def go_to(self, targets: Targets) -> Solution:
        """Solve the next waypoint from where the robot is, and move there on a way that is proved, where one is found.

        The tip goes straight there, with as many knots as that takes. Where it cannot, because the body is stopped by
        an obstacle or a limit, the robot changes its configuration on another way; where no way is found either, the
        step is left unproved.
        """
        self._set_time_of_next()
        solution = self._solver.solve(targets, self._knots[-1].begin if self._knots else None)
        if solution.solved:
            solution = self._move_to(solution)
        self._keep(solution)
        return solution

    def _set_time_of_next(self) -> None:
        """Let obstacles that move be where they are when the next waypoint is."""
        if self._timetable is not None:
            self._timetable.set_time(self._timetable.of(len(self._tried)))

    def _keep(self, solution: Solution) -> None:
        """Count a waypoint that was tried."""
        self._tried.append((solution, len(self._knots) - 1 if solution.solved else None))
        self._done.append(self._now())

    def _now(self) -> tuple[int, bool, float]:
        """How many knots there are, whether the way from the start is a step of its own, and seconds so far."""
        return len(self._knots), self._approaches, work_time() - self._began

    def entry(self, waypoint: int) -> TrackedWaypoint:
        """Return what a waypoint (0 = first) added; see `follow`."""
        solution, (count, approaches, seconds) = self._tried[waypoint][0], self._done[waypoint + 1]
        knots, reconfigured = self._knots[self._done[waypoint][0] : count], waypoint + 1 in self._reconfigured
        return TrackedWaypoint(solution._outcome, solution.seconds, knots, reconfigured, approaches, seconds)

    def go_on(self, targets: Targets, entry: TrackedWaypoint) -> Solution:
        """Take the next waypoint as it was found before, by a tracker that was interrupted."""
        self._set_time_of_next()
        initial = self._knots[-1].q if self._knots else None
        solution = self._solver._restore_solution(targets, entry.outcome, entry.solve_seconds, initial)
        self._knots += entry.knots
        if entry.knots and solution.solved:  # the last one is the waypoint
            self._knots[-1] = self._knots[-1]._replace(solution=solution)
        self._approaches = entry.approaches
        if entry.reconfigured:
            self._reconfigured.append(len(self._tried) + 1)
        if solution.solved:
            self._at = solution.problem.targets
        self._began = work_time() - entry.seconds
        self._keep(solution)
        return solution

    def _move_to(self, solution: Solution) -> Solution:
        """Move to a waypoint; return its solution, which another may replace that is nearer."""
        when = self._when()
        self._take_scene_of(solution)
        if not self._knots:
            self._knots.append(Knot(solution.configuration, None, solution.problem.targets, solution, time=when))
        elif self._timetable is None and self._stays(solution):
            self._approaches = False  # the robot is at its first waypoint already
        else:
            solution = self._go_straight(solution) or self._go_around(solution)
        self._at = solution.problem.targets
        return solution

    def _take_scene_of(self, solution: Solution) -> None:
        """Prove from now on in the scene that a solution was found in: the robot moves after an update."""
        if self._steps.take_scene_of(solution):
            self._outdated = len(self._knots)

    def _prove_anew(self) -> None:
        """Prove in the scene of now what was proved before it was updated: a motion is proved in one scene."""
        count, self._outdated = self._outdated, 0
        if count > 1:
            answers = self._steps.prover.prove(np.array([knot.q for knot in self._knots[:count]]), SLACK)
            for i, proof in enumerate(np.split(answers, count - 1), start=1):
                self._knots[i] = self._knots[i]._replace(proof=proof)

    def _stays(self, solution: Solution) -> bool:
        """Whether a robot that is at its start is at the first waypoint already."""
        return len(self._knots) == 1 and self._approaches and np.array_equal(self._knots[0].q, solution.configuration)

    def _go_straight(self, solution: Solution) -> Solution | None:
        """Lead the tip straight to a waypoint; see `TipSteps.lead`."""
        line = TipLine.between(self._at, solution.problem.targets)
        prover = self._steps.prover
        knots = self._steps.lead(self._knots[-1], solution, line, end=self._when())
        if prover is not self._steps.prover:  # there was an update meanwhile
            self._outdated = len(self._knots) + len(knots or ())
        if knots is None:
            return None
        self._knots += knots
        return knots[-1].solution

    def _go_around(self, solution: Solution) -> Solution:
        """Change the configuration to one of a waypoint on any path; the step is not proved where none is found.

        Where obstacles move, the robot is at the waypoint when the waypoint is.
        """
        self._reconfigured.append(len(self._tried) + 1)
        last, when, times = self._knots[-1], self._when(), None
        if self._timetable is not None:
            self._timetable.set_time(when)
            times = np.array([last.time, when])
        goals = TargetGoals(self._solver, list(solution.problem.targets), [solution])
        path = self._find_path(last, when, goals)
        if path is None:
            proof = self._steps.prover.prove(self._steps.two(last.q, solution.configuration), SLACK, times=times)
            self._knots.append(Knot(solution.configuration, proof, solution.problem.targets, solution, time=when))
            return solution
        steps = np.split(path.answers, len(path.answers))
        at = np.zeros(len(path.q)) if path.times is None else path.times
        between = zip(path.q[1:-1], steps[:-1], at[1:-1].tolist(), strict=True)
        self._knots += [Knot(q, proof, time=t) for q, proof, t in between]
        reached = goals.solution_at(path.q[-1])
        self._knots.append(Knot(reached.configuration, steps[-1], reached.problem.targets, reached, time=when))
        return reached

    def _find_path(self, last: Knot, when: float, goals: TargetGoals) -> ProvedPath | None:
        """Plan a path from where the robot is to a waypoint, in the time that a solve may take."""
        robot, options, scene = self._solver.robot, self._solver.options, self._steps.prover.scene
        if self._timetable is None:
            trees = RRTConnect(robot, scene)
            self._walks = search_memory(options.memory, robot, scene, trees, self._walks)
            query = Query(robot, scene, last.q, goals, options.seed, Deadline(options.time), SHORTCUTS)
            path = None if self._walks is None else self._walks.find_path(query, goals)
            if path is None:
                path = find_path(query, trees)
                remember(options.memory, robot, path)
            return path
        query = Query(robot, scene, last.q, goals, options.seed, Deadline(options.time))
        return find_timed_path(query.in_time(self._steps.prover, last.time, when))

    def _when(self) -> float:
        """When the robot is at the next waypoint, where obstacles move; otherwise 0."""
        return 0.0 if self._timetable is None else self._timetable.of(len(self._tried))

    def shorten(self, shortest: Shortest) -> None:
        """Make the motion so far shorter in configurations or actuators, all knots together."""
        if len(self._knots) < 3 or self.blocked is not None:
            return
        self._prove_anew()
        robot = self._solver.robot
        durations = np.diff(self.motion().times)
        self._knots = shorten(robot, self._knots, metric_of(robot, shortest), durations, self._meet, self._steps.prove)
        self._tried = [
            (solution if at is None else self._knots[at].solution or solution, at) for solution, at in self._tried
        ]

    def _meet(self, knot: Knot, q: Floats) -> Knot | None:
        """Meet the targets of a knot from a configuration beside it."""
        if self._timetable is not None:
            self._timetable.set_time(knot.time)
        found = self._steps.meet(knot.targets, q)
        return None if found is None else knot._replace(q=found.configuration, proof=None, solution=found)

    def motion(self, remaining: int = 0, times: Floats | None = None) -> Motion:
        """Return the motion so far; `remaining` waypoints were not tried, `times` (m,) are those of all waypoints."""
        self._prove_anew()
        robot = self._solver.robot
        q = np.array([knot.q for knot in self._knots]).reshape(-1, len(robot), 3)
        answers = [knot.proof for knot in self._knots if knot.proof is not None]
        proofs = np.concatenate(answers) if answers else np.zeros((0, ANSWER_WIDTH))
        steps = Steps(proofs, robot._least_clearances)
        found = Report(
            solutions=tuple(solution for solution, _ in self._tried),
            waypoint_knots=tuple(knot for _, knot in self._tried),
            reconfigured=tuple(self._reconfigured),
            reconfigure=self._reconfigure,
            deviation=self._steps.deviation,
            remaining=remaining,
            seconds=work_time() - self._began,
            method=self._solver.method,
            seed=self._solver.options.seed,
            ended=None if self.blocked is None else Status.START_BLOCKED,
            blocking=self.blocked,
            notes=self._notes,
        )
        when = self._times(q, times) if self._timetable is None else np.array([knot.time for knot in self._knots])
        return Motion.made(robot, self._steps.prover.scene, q, when, steps, found)

    def _times(self, q: Floats, of_waypoints: Floats | None = None) -> Floats:
        """Times of the knots: the first one is at 0, and every waypoint takes 1, unless they have times."""
        knots = [knot for _, knot in self._tried]
        fixed = [(i + self._approaches, knot) for i, knot in enumerate(knots) if knot is not None]
        if self._approaches:
            fixed.insert(0, (0, 0))
        if not fixed:
            return np.empty(0)
        numbers, given = np.array(fixed).T
        when = numbers.astype(np.float64)
        if of_waypoints is not None:
            when = (with_start(of_waypoints) if self._approaches else of_waypoints)[numbers]
        return spread_times(self._solver.robot, q, given, when)
