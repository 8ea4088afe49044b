"""Solve one target: starts in order, one time budget over all of them, an honest status at the end."""

import time as clock
from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.methods import registry as methods
from sinuous.problem.problem import Preferences, Problem, Tolerance, as_scene, as_tolerance, check_sizes
from sinuous.problem.target import Target, Targets, target_list
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import ROUTE, Outcome, Solution, Status
from sinuous.solving.routes import Router
from sinuous.solving.search import Search

TIME = 1.0
"""Default budget of a solve, in seconds."""

STARTS = 1000
"""Default for the most starts of a solve."""

CANDIDATES = 4
"""Distinct solutions that `solve_all` gathers for each one that it returns."""

LOCAL = 6
"""Starts before ways through free space are looked for: they cost little, and mostly suffice."""

FIRST_CHUNK = 16
"""Starts in the first call of a method without obstacles; later calls take more, never much longer than `SLICE`."""

TOGETHER = 256
"""Most problems that `solve_many` hands over in one call, so that an interrupt is seen."""

SLICE = 0.1
"""Seconds after which a method returns to Python, so that an interrupt is seen."""

_STATUS = {
    methods.SOLVED: Status.SOLVED,
    methods.UNPROVED: Status.UNPROVED,
    methods.LATE: Status.TIME_LIMIT,
    methods.OUT_OF_REACH: Status.OUT_OF_REACH,
    methods.TARGET_BLOCKED: Status.TARGET_BLOCKED,
    methods.NO_ROUTE: Status.NO_ROUTE,
}


class Solver:
    """A robot in a scene, prepared once for many targets; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
    tolerance : Tolerance, optional
        Default: 1e-4 of the robot's mean length, and 1e-3 rad.
    method : str or Options
        Name of the algorithm, or its options, like `OptiPath(iterations=100)`.
    prefer : Preferences, optional
        What to like better among solutions.
    time : float
        Budget of one solve over all its starts, in seconds.
    starts : int
        Most starts of one solve.
    seed : int
        Of the scattered starts; the same seed gives the same answer, unless the time runs out.
    routes : bool
        Whether to look for ways through free space when the first starts fail; for `newton` alone, because other
        methods are to be seen as they are.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    def __init__(
        self,
        robot: Robot,
        scene: Any = None,
        *,
        tolerance: Tolerance | None = None,
        method: methods.Choice = "newton",
        prefer: Preferences | None = None,
        time: float = TIME,
        starts: int = STARTS,
        seed: int = 0,
        routes: bool = True,
    ) -> None:
        if not isinstance(robot, Robot):
            raise InputError("robot", "of the wrong kind", robot, "a Robot")
        if prefer is not None and not isinstance(prefer, Preferences):
            raise InputError("prefer", "of the wrong kind", prefer, "Preferences")
        self.robot = robot
        self.scene: Scene = as_scene(scene)
        check_sizes(robot, self.scene)
        self.tolerance = as_tolerance(tolerance).for_robot(robot)
        self.prefer = prefer or Preferences()
        self.method = methods.name_of(method)
        self.time = checks.number("time", time, low=0.0)
        self.starts = checks.integer("starts", starts, 1, 10**9)
        self.seed = checks.integer("seed", seed, 0, 2**31 - 1)
        self._prepared = methods.prepare(method, robot, self.scene, self.tolerance, self.prefer)
        by_ways = checks.truth("routes", routes) and len(self.scene) > 0 and self.method == "newton"
        self._router = Router(robot, self.scene, self.tolerance) if by_ways else None
        self._first = LOCAL if self._router else FIRST_CHUNK
        self._no_start: Floats = np.empty((0, len(robot), 3))
        self._looked_at_base = self.scene.tables, _base_blocked(robot, self.scene)

    def solve(self, target: Targets, start: "Solution | Any" = None) -> Solution:
        """Find a configuration that meets the target, or several targets at once.

        Parameters
        ----------
        target : Target or list of Target
        start : Solution or array_like (n, 3), optional
            Where to begin, before anything else is tried.

        Returns
        -------
        Solution
            Always; look at its status.

        Raises
        ------
        InputError
            When target or start is not what it should be.
        """
        began = clock.perf_counter()
        targets = (target,) if isinstance(target, Target) else target_list("target", target)
        problem = Problem.prepared(self.robot, targets, self.scene, self.tolerance)
        rows = problem.rows
        given = self._no_start if start is None else self._given(start)
        outcome = self._prepared.run(rows, given, 0, min(self.starts, self._first), self.seed, self.time)
        if outcome.code != methods.SOLVED:
            outcome = self._go_on(outcome, problem, given)
        return self._solution(problem, outcome, clock.perf_counter() - began)

    def solve_many(
        self, targets: Iterable[Targets], starts: Iterable["Solution | Any"] | None = None
    ) -> list[Solution]:
        """Solve independent targets, as `solve` does one by one, in few calls of the compiled code.

        Quicker than a loop, and other threads run meanwhile: two threads with a `solve` of some microseconds each
        mostly wait for each other.

        Parameters
        ----------
        targets : iterable of (Target or list of Target)
        starts : iterable of (Solution or array_like (n, 3)), optional
            One for each.

        Returns
        -------
        list of Solution
            In the order of `targets`.

        Raises
        ------
        InputError
            When a target or start is not what it should be, or their numbers differ.
        """
        asked = [(t,) if isinstance(t, Target) else target_list(f"targets[{i}]", t) for i, t in enumerate(targets)]
        problems = [Problem.prepared(self.robot, each, self.scene, self.tolerance) for each in asked]
        given = np.empty((len(problems), 0, len(self.robot), 3))
        if starts is not None:
            listed = [self._given(start) for start in starts]
            if len(listed) != len(problems):
                raise InputError("starts", "not one for each target", len(listed), f"{len(problems)} starts")
            given = np.stack(listed) if listed else given
        solutions: list[Solution] = []
        for first, last in _runs_of_equal([len(problem.targets) for problem in problems]):
            rows = np.stack([problem.rows for problem in problems[first:last]])
            found = self._prepared.run_many(
                rows, given[first:last], 0, min(self.starts, self._first), self.seed, self.time
            )
            for i, outcome in enumerate(found):
                best = outcome
                if outcome.code != methods.SOLVED:
                    best = self._go_on(outcome, problems[first + i], given[first + i])
                solutions.append(self._solution(problems[first + i], best, best.seconds))
        return solutions

    def solve_all(
        self, target: Targets, start: "Solution | Any" = None, *, count: int = 8, apart: float = 0.02
    ) -> list[Solution]:
        """Find several distinct solutions, best first.

        Every start in its order is followed to its own solution. Two solutions are the same when no point of the
        backbone is farther from its counterpart than `apart`. The search ends with the starts, the time, or
        `CANDIDATES * count` distinct ones. Their order: less bending first (sum of squared bends), with a start, less
        distance to it (bends in rad, lengths relative to the mean length of a segment).

        Parameters
        ----------
        target : Target or list of Target
        start : Solution or array_like (n, 3), optional
        count : int
            Most solutions to return.
        apart : float
            Relative to the robot's mean length.

        Returns
        -------
        list of Solution
            All solved; empty when none was found.
        """
        wanted = checks.integer("count", count, 1, 10_000)
        separation = checks.number("apart", apart, low=0.0) * self.robot.mean_length
        began = clock.perf_counter()
        targets = (target,) if isinstance(target, Target) else target_list("target", target)
        problem = Problem.prepared(self.robot, targets, self.scene, self.tolerance)
        given = self._no_start if start is None else self._given(start)
        found: list[Solution] = []
        shapes: list[Floats] = []
        ends = began + self.time
        followed = self._each_start(problem, given, lambda: ends - clock.perf_counter())
        for number, outcome in enumerate(islice(followed, self.starts)):
            if outcome.starts == 0 or outcome.code in (methods.OUT_OF_REACH, methods.TARGET_BLOCKED):
                break
            if outcome.code != methods.SOLVED:
                continue
            shape = self.robot.backbone(outcome.q, 8)
            if all(np.linalg.norm(shape - other, axis=-1).max() > separation for other in shapes):
                shapes.append(shape)
                found.append(self._solution(problem, outcome._replace(starts=number + 1), clock.perf_counter() - began))
            if len(found) >= CANDIDATES * wanted:
                break
        reference = None if start is None else given[0]
        return sorted(found, key=lambda solution: self._dislike(solution.q, reference))[:wanted]

    def _each_start(self, problem: Problem, given: Floats, seconds_left: Callable[[], float]) -> Iterator[Outcome]:
        """Follow every start on its own: the first few, ways through free space, then all others."""
        if self._base_blocked:
            return
        numbers = iter(range(self.starts))
        for number in islice(numbers, self._first):
            if seconds_left() > 0.0:
                yield self._prepared.run(problem.rows, given, number, number + 1, self.seed, seconds_left())
        for routes in self._router.search(problem, seconds_left) if self._router is not None else ():
            for start in routes.starts:
                if seconds_left() > 0.0:
                    outcome = self._prepared.run(problem.rows, start[None].copy(), 0, 1, self.seed, seconds_left())
                    yield outcome._replace(kind=ROUTE)
        for number in numbers:
            if seconds_left() <= 0.0:
                return
            yield self._prepared.run(problem.rows, given, number, number + 1, self.seed, seconds_left())

    @property
    def _base_blocked(self) -> bool:
        """Looked at again when the scene was updated."""
        tables, blocked = self._looked_at_base
        if self.scene.tables is not tables:
            tables = self.scene.tables
            blocked = _base_blocked(self.robot, self.scene)
            self._looked_at_base = tables, blocked
        return blocked

    def _dislike(self, q: Floats, reference: Floats | None) -> float:
        """By what `solve_all` orders."""
        if reference is None:
            return float((q[:, :2] ** 2).sum())
        unit = self.robot.mean_length / len(self.robot)
        return float((((q - reference) / [1.0, 1.0, unit]) ** 2).sum())

    def _solution(self, problem: Problem, outcome: Outcome, seconds: float) -> Solution:
        return Solution(problem, self._status(outcome), outcome, seconds, self.method, self.seed)

    def _given(self, start: Any) -> Floats:
        if isinstance(start, Solution):
            start = start.q
        given = checks.array("start", start, (len(self.robot), 3))
        return given.reshape(1, len(self.robot), 3).copy()

    def _go_on(self, best: Outcome, problem: Problem, given: Floats) -> Outcome:
        """Try ways through free space and starts at random in turn, until something is decided."""
        search = Search(best, self.starts, self.time)
        number = best.starts
        ways = iter(()) if self._router is None else self._router.search(problem, lambda: search.seconds_left)
        while search.open:
            routes = next(ways, None)
            if routes is None:
                self._scatter(search, problem, given, number, self.starts)
                break
            search.spend(routes.seconds)
            if routes.closed:
                search.close(routes.cell)
            self._follow(search, problem, routes.starts)
            self._scatter(search, problem, given, number, routes.then)
            number += routes.then
        return search.outcome

    def _follow(self, search: Search, problem: Problem, starts: Floats) -> None:
        """Start from the chain laid into ways."""
        starts = starts[: search.starts_left]
        if search.open and len(starts):
            found = self._prepared.run(problem.rows, starts, 0, len(starts), self.seed, search.seconds_left)
            search.take(found._replace(kind=ROUTE))

    def _scatter(self, search: Search, problem: Problem, given: Floats, number: int, count: int) -> None:
        """Go on with starts from `number` on, so many, in chunks."""
        last = number + count
        while search.open and number < last:
            end = min(last, number + search.affordable(SLICE))
            found = self._prepared.run(problem.rows, given, number, end, self.seed, search.seconds_left)
            search.take(found)
            if found.starts == 0:  # the method has no more
                return
            number = end

    def _status(self, outcome: Outcome) -> Status:
        if self._base_blocked:
            return Status.BASE_BLOCKED
        if outcome.code in _STATUS:
            return _STATUS[outcome.code]
        if outcome.clearance < 0.0:
            return Status.BLOCKED
        return Status.LIMIT_BOUND if outcome.bound else Status.STALLED


def _runs_of_equal(counts: list[int]) -> list[tuple[int, int]]:
    """Cut a list where its values change, and into pieces of at most `TOGETHER`: (first, last) of every piece."""
    cuts = [0]
    for i in range(1, len(counts)):
        if counts[i] != counts[i - 1] or i - cuts[-1] >= TOGETHER:
            cuts.append(i)
    return list(zip(cuts, [*cuts[1:], len(counts)], strict=True)) if counts else []


def _base_blocked(robot: Robot, scene: Scene) -> bool:
    """Prove that the body overlaps an obstacle where it leaves its mount, whatever the configuration.

    Where the whole robot may be shorter than its mount, nothing is proved. The backbone at arc length `mount` is
    within `mount * bend / 2` of the straight line, where `bend` is the most that it can have turned till there.
    """
    if len(scene) == 0:
        return False
    turned, reached, radius = 0.0, 0.0, robot.radii[0]
    if robot.mount > 0.0:
        for segment, own in zip(robot.segments, robot.radii, strict=True):
            # Lengths vary: this may be the segment that leaves the mount, and so may any before it.
            radius = min(radius, own)
            turned += min(segment.max_bend, segment.max_curvature * segment.length[1])
            reached += segment.length[0]
            if reached > robot.mount:
                break
        else:
            return False
    sway = robot.mount * min(2.0, 0.5 * turned)
    leaves = robot.base[:3, 3] + robot.mount * robot.base[:3, 2]
    return bool(scene.at_most(leaves) + sway < radius)


def solve(
    robot: Robot,
    target: Targets,
    scene: Any = None,
    *,
    start: "Solution | Any" = None,
    tolerance: Tolerance | None = None,
    method: methods.Choice = "newton",
    prefer: Preferences | None = None,
    time: float = TIME,
    starts: int = STARTS,
    seed: int = 0,
) -> Solution:
    """Find a configuration of `robot` that meets `target` in `scene`; parameters as for `Solver` and `Solver.solve`."""
    solver = Solver(
        robot, scene, tolerance=tolerance, method=method, prefer=prefer, time=time, starts=starts, seed=seed
    )
    return solver.solve(target, start)


def solve_all(
    robot: Robot,
    target: Targets,
    scene: Any = None,
    *,
    start: "Solution | Any" = None,
    count: int = 8,
    apart: float = 0.02,
    tolerance: Tolerance | None = None,
    method: methods.Choice = "newton",
    prefer: Preferences | None = None,
    time: float = TIME,
    starts: int = STARTS,
    seed: int = 0,
) -> list[Solution]:
    """Find several distinct solutions, ranked; parameters as for `Solver` and `Solver.solve_all`."""
    solver = Solver(
        robot, scene, tolerance=tolerance, method=method, prefer=prefer, time=time, starts=starts, seed=seed
    )
    return solver.solve_all(target, start, count=count, apart=apart)
