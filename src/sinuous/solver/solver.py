"""A robot in a scene, prepared once for many targets: one budget over all starts, and an honest status at the end."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self, Unpack

import numpy as np

from sinuous.answer.observer import GAIN
from sinuous.answer.residual import descend_within_limits
from sinuous.answer.route_class import RouteClass
from sinuous.answer.solution import Solution
from sinuous.answer.solutions import Solutions
from sinuous.answer.solve_again import SolveAgain
from sinuous.answer.step import Step
from sinuous.base import checks
from sinuous.base.arguments import Entry, HasArray, JointsAndBatch, Number, Stack, Truth, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.entrance import Renamed
from sinuous.base.errors import InputError, warn_of
from sinuous.base.frozen import call, text
from sinuous.base.progress import ProgressBar, no_work, work_time
from sinuous.kernels.compile import code_first
from sinuous.kernels.tables import BASE_BLOCKED, GIVEN, REMEMBERED, SOLVED, Budget, Outcome, answer_size
from sinuous.methods.method import Call, Options, name_of, prepare, ready
from sinuous.methods.newton import NEARLY_GRAZING, thinnest
from sinuous.model.rates import Changes, Rates
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem, base_blocked, check_sizes, input_warnings
from sinuous.problem.target import GoalArrays, Target, Targets, target_list
from sinuous.problem.target_sets import ManyProblems, TargetSets, read_target_sets
from sinuous.scene.scene import Scene, SceneLike, as_scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.attempts import UNDECIDED, FirstSolved, Follow, IKQuery, StartBatch
from sinuous.solver.control_step import ControlLoop
from sinuous.solver.distinct_solutions import (
    BY_ROUTE,
    BY_SHAPE,
    KINDS,
    DistinctOptions,
    DistinctSolutions,
    Kind,
    preference_cost,
)
from sinuous.solver.loaded_solve import STARTS, LoadCorrection, correct_starts, solve_under_load
from sinuous.solver.loaded_solve import unsolved_start as start_at
from sinuous.solver.many import Many, read_initial, read_workers
from sinuous.solver.options import SolveArguments, SolveOptions
from sinuous.solver.strategy import Strategy
from sinuous.solver.thread_pool import share_jobs

FEW = 10
"""Starts under load where the robot without load is proved to have no solution, which says nothing of the other."""

Initial = Solution | JointsAndBatch
"""What a solve may begin from: a solution, or a configuration (n, 3)."""

FEW_TARGETS = 32
"""Targets up to which many are solved without waiting for machine code: interpreted, as soon as it would be there."""

OWN_METHOD = "newton"
"""The method that goes on from where limits balance the targets."""

Initials = Solution | HasArray | Iterable[Solution | Entry]
"""What many solves may begin from: one for all, or one for each."""


class Solver:
    """A robot in a scene, prepared once for many targets; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene or list of obstacles, optional
        Live: after an update the next solve sees the new obstacles.
    ready : str or sequence of str
        Methods of the solver whose machine code is waited for now, see `warm`: before a control loop.
    **options
        The fields of `SolveOptions`: tolerance, method, prefer, time, max_starts, seed, routes, without, clearance,
        self_clearance.

    Attributes
    ----------
    robot : Robot
        With the clearances that the options demand.
    scene : Scene
    options : SolveOptions

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    def __init__(
        self,
        robot: Robot,
        scene: SceneLike | None = None,
        *,
        ready: str | Sequence[str] = (),
        **options: Unpack[SolveArguments],
    ) -> None:
        uses = _uses("ready", (ready,) if isinstance(ready, str) else ready)
        self._prepare(*_checked(robot, scene, options))
        (self if self._load is None else self._free)._prepared.load()
        self._strategy.load()
        self._warm(uses)

    @classmethod
    def _for_one_query(cls, robot: Robot, scene: SceneLike | None = None, **options: Unpack[SolveArguments]) -> Self:
        """Prepare a solver for one question: what routes need is compiled, or loaded, where the first starts fail."""
        return cls._of_checked(*_checked(robot, scene, options))

    @classmethod
    def _of_checked(cls, robot: Robot, scene: Scene, options: SolveOptions) -> Self:
        """Prepare a solver, as `_for_one_query` does, of what was checked before; nothing is warned of twice."""
        solver = object.__new__(cls)
        solver._prepare(robot, scene, options)
        return solver

    def _prepare(self, robot: Robot, scene: Scene, chosen: SolveOptions) -> None:
        """Get ready, with arguments that are checked."""
        self.robot, self.scene, self.options = robot, scene, chosen
        self.tolerance = chosen.tolerance.for_robot(robot)
        self.method = name_of(chosen.method)
        self._load: LoadCorrection | None = None
        if robot.has_external_load:
            self._load = LoadCorrection(robot, self.tolerance)
            self._free = self._of_checked(robot.changed(gravity=None), scene, replace(chosen, tolerance=self.tolerance))
            self._borrow(self._free)
            return
        method = ready(chosen.method, robot, scene, chosen.prefer)
        if method is not chosen.method:
            self.options = chosen = replace(chosen, method=method)
        self._prepared = prepare(method, robot, self.scene, self.tolerance, chosen.prefer)
        self._strategy = Strategy(robot, scene, self.tolerance, chosen)
        self._resolver = KeptOptions(chosen)
        self._first_budgets = [self._budget(given, chosen.time) for given in (0, 1)]
        self._shape = len(robot), 3
        self._no_initial: Floats = np.empty((0, *self._shape))
        self._place = self._take_scene()

    def _borrow(self, free: "Solver") -> None:
        """Share what a solver of the robot without load has prepared."""
        self._resolver, self._shape = KeptOptions(self.options), free._shape
        self._no_initial, self._strategy = free._no_initial, free._strategy

    def warm(self, *uses: str) -> None:
        """Wait until what these methods need is compiled, so that none of their calls waits, or is interpreted.

        Parameters
        ----------
        *uses : str
            `solve`, `solve_many`, `solve_all`, `step`; by default all of them.

        Raises
        ------
        InputError
            When there is no such method.
        """
        self._warm(_uses("warm", uses or tuple(READY)))

    def _warm(self, uses: Iterable[str]) -> None:
        """Use each of these methods once, in a way that is soon done."""
        with code_first():
            for use in uses:
                READY[use](self)

    once, prepared = Renamed("_for_one_query"), Renamed("_of_checked")
    loaded, build = Renamed("_restore_solution"), Renamed("_first_call")

    def solve(
        self,
        target: Targets,
        initial: Initial | None = None,
        *,
        within: Changes | None = None,
        time: Number | None = None,
    ) -> Solution:
        """Find a configuration that meets the target, or several targets at once.

        Parameters
        ----------
        target : Target or list of Target
        initial : Solution or array_like (n, 3), optional
            The configuration to begin from, before anything else is tried.
        within : Changes, optional
            `Rates(...) * dt`: nothing moves farther than that from `initial`, and the motion from there, linear in q,
            is proved clear. What is nearest to the target then is the answer, `rate_bound` where rates leave it short.
            Under load, where nothing bounds the body on the way and it is only clear at samples, it is `unproved`.
        time : float, optional
            Budget of this solve in seconds, instead of that of the solver.

        Returns
        -------
        Solution
            Always; look at its status.

        Raises
        ------
        InputError
            When an argument is not what it should be.
        """
        if self._load is not None:
            return self._solve_under_load(self._load, target, initial, within, time)
        began = work_time()
        place = self._place
        looked = place[0] is not self.scene.snapshot()
        if looked:
            place = self._place = self._take_scene()
        scene, blocked = place
        targets = self._targets(target)
        problem = Problem.prepared(self.robot, targets, scene, self.tolerance)
        given, reference = self._no_initial, None
        if initial is not None:
            given = self._given(initial)
            reference = given[0]
        budget = self._first_budgets[len(given)] if time is None else self._budget(len(given), time)
        if within is not None:
            return self._solve_within(problem, given, within, budget[3])
        if looked:  # which is in the budget, too
            budget = *budget[:3], max(0.0, budget[3] + began - work_time())
        starts = given
        if self.options.memory is not None and not len(given):
            starts = self._strategy.remembered(problem._rows[None])[0]
        if blocked:
            outcome = self._look(problem, given)
        else:
            outcome = self._prepared.run(problem, starts, budget, reference)
            if starts is not given and outcome.source == GIVEN and len(starts):
                outcome = outcome._replace(source=REMEMBERED)
        if outcome.code != SOLVED:
            if blocked is None and self._look_at_base(scene)[1]:
                outcome = self._look(problem, given)
            outcome = self._go_on(outcome, problem, given, budget[3])
        if self.options.memory is not None and outcome.code == SOLVED:
            self._strategy.learn(outcome.q[None], None if starts is given else starts[None])
        return Solution(problem, outcome, work_time() - began, self._resolver, given)

    def descend(self, target: Target, q: Floats, seconds: float) -> Floats | None:
        """Follow one configuration (n, 3) to one that meets a target of the tip; `None` where that fails.

        It is what `solve` does where `max_starts` is 1 and nothing is searched for, without a solution around it. Not
        under load.
        """
        problem = Problem.prepared(self.robot, (target,), self.scene.snapshot(), self.tolerance)
        outcome = self._descend(problem, q, seconds)
        return outcome.q if outcome.code == SOLVED else None

    def follow(self, targets: Targets, q: Floats | None) -> Solution | None:
        """Return what one configuration (n, 3), or the arc to the targets, is followed to; `None` where it fails.

        The same with a solution around it.
        """
        began, problem = work_time(), self._prepared_problem(targets)
        outcome = self._descend(problem, q, self.options.time)
        if outcome.code != SOLVED:
            return None
        given = self._no_initial if q is None else q[None]
        return Solution(problem, outcome, work_time() - began, self._resolver, given)

    def _descend(self, problem: Problem, q: Floats | None, seconds: float) -> Outcome:
        given = self._no_initial if q is None else np.array(q[None], order="C")
        budget = 0, int(q is None), self.options.seed, seconds
        return self._prepared.run(problem, given, budget, None if q is None else given[0])

    def _solve_under_load(
        self,
        load: LoadCorrection,
        target: Targets,
        initial: Initial | None,
        within: Changes | None,
        time: Number | None,
    ) -> Solution:
        """Correct solutions of the robot without load, one after the other."""
        began, seconds = work_time(), self.options.time if time is None else checks.number("time", time, low=0.0)
        given = self._given(initial)
        problem = self._prepared_problem(target)
        if within is not None:
            return self._solve_within(problem, given, within, seconds)
        outcome = self._loaded_outcome(load, problem, given, seconds)
        return Solution(problem, outcome, work_time() - began, self._resolver, given)

    def _loaded_outcome(self, load: LoadCorrection, problem: Problem, given: Floats, seconds: float) -> Outcome:
        starts = self._starts_under_load(problem, given, seconds)
        return solve_under_load(load, problem, starts, seconds, self.options.most_starts)

    def _starts_under_load(self, problem: Problem, given: Floats, seconds: float) -> Iterator[Outcome]:
        """Yield what is given, then solutions of the robot without load, from one start of its own after the other."""
        free = self._free
        unloaded = Problem.prepared(free.robot, problem.targets, problem.scene, self.tolerance)
        yield from (start_at(q) for q in given)
        first = free.solve(problem.targets, time=0.5 * seconds)._outcome
        yield first
        for i in range(1, STARTS if first.code in (SOLVED, *UNDECIDED) else FEW):
            budget = i, i + 1, self.options.seed, seconds
            yield free._prepared.run(unloaded, self._no_initial, budget)

    def _many_under_load(
        self, load: LoadCorrection, questions: ManyProblems, seconds: float, workers: int, bar: ProgressBar
    ) -> Solutions:
        """Solve many targets, each as `solve` does."""
        answers = np.empty((len(questions.target_sets), answer_size(len(self.robot))))

        def one(i: int) -> None:
            given = np.array(questions.initial[i], order="C")
            self._loaded_outcome(load, questions.problem(i), given, seconds).write(answers[i])
            bar.advance(1)

        share_jobs(one, range(len(answers)), workers)
        return Solutions(questions, answers, self._resolver)

    def _all_under_load(
        self, load: LoadCorrection, problem: Problem, wanted: DistinctOptions, given: Floats
    ) -> list[Solution]:
        """Several solutions of the loaded body: every start is corrected to its own."""
        dislike = preference_cost(self.robot, given[0] if len(given) else None)
        several = DistinctSolutions(problem, wanted, dislike)
        starts = self._starts_under_load(problem, given, wanted.seconds)
        for outcome in correct_starts(load, problem, starts, wanted.seconds):
            several.search.take(outcome)
            if not several.search.open:
                break
        own = self._resolver, given
        return [Solution(problem, outcome, outcome.seconds, *own, named) for outcome, named in several.best()]

    def _solve_within(self, problem: Problem, given: Floats, within: Changes, seconds: float) -> Solution:
        checks.instance("within", within, Changes, "Changes, like Rates(bend=1) * dt")
        if not len(given):
            raise InputError("initial", "missing", None, "where the changes begin")
        began = work_time()
        outcome = self._control.within(problem, given[0], within, seconds)
        return Solution(problem, outcome, work_time() - began, self._resolver, given, within=within)

    def _restore_solution(
        self,
        target: Targets,
        outcome: Outcome,
        seconds: float,
        initial: Initial | None = None,
        route_class: RouteClass | None = None,
    ) -> Solution:
        """Return the solution that this solver found before with this outcome, in so many seconds."""
        problem = self._prepared_problem(target)
        return Solution(problem, outcome, seconds, self._resolver, self._given(initial), route_class)

    def _first_call(self, target: Targets, initial: Initial | None = None) -> Call:
        """Return what `solve` would call first: the compiled function and its arguments, to be looked at or timed."""
        self.robot._refuse_load()
        budget = self._first_budgets[int(initial is not None)]
        return self._prepared.build(self._problem(target)[0], self._given(initial), budget)

    def solve_many(
        self,
        targets: Iterable[Targets] | None = None,
        initial: Initials | None = None,
        *,
        time: Number | None = None,
        workers: Whole | None = None,
        progress: Truth = False,
        **arrays: Unpack[GoalArrays],
    ) -> Solutions:
        """Solve independent targets, as `solve` does one by one, on all cores.

        Whatever the number of workers, each answer is that of `solve`, to the last bit, unless its time runs out.
        A target that is not solved, and not proved impossible, takes all of its time unless `max_starts` bounds it.

        Parameters
        ----------
        targets : iterable of (Target or list of Target), optional
            Or arrays, all for the tip:
        positions : array_like (m, 3), optional
        directions : array_like (m, 3), optional
            Of the tangent; any length but zero.
        rotations : array_like (m, 3, 3) or (m, 4), or Rotation of SciPy, optional
            Instead of `directions`: matrices, or quaternions wxyz.
        xyzw : array_like (m, 4), optional
            The same as quaternions in the order of SciPy and ROS, instead of `rotations`.
        initial : array_like (n, 3) or (m, n, 3), Solutions, or iterable of (Solution or array_like (n, 3)), optional
            One for all, or one for each.
        time : float, optional
            Budget of each solve in seconds, instead of that of the solver.
        workers : int, optional
            Most threads; by default one a core.
        progress : bool
            Whether to show on a terminal how many are done.

        Returns
        -------
        Solutions
            In the order of the targets: arrays over all of them, and a `Solution` of each that is asked for.

        Raises
        ------
        InputError
            When an argument is not what it should be, or there is not one of each for every target.
        """
        asked = read_target_sets(self.robot, targets, arrays)
        threads, shown = read_workers(workers), checks.truth("progress", progress)
        return self._solve_sets(asked, initial, time, threads, shown)

    def _solve_sets(
        self,
        asked: TargetSets,
        initial: Initials | None = None,
        time: Number | None = None,
        threads: int = 1,
        shown: bool = False,
    ) -> Solutions:
        """Solve target sets that are read already; see `solve_many`."""
        given = read_initial(self.robot, len(asked), initial)
        if self._load is not None:
            seconds = self.options.time if time is None else checks.number("time", time, low=0.0)
            questions = ManyProblems(self.robot, asked, self.scene.snapshot(), self.tolerance, given)
            with code_first(len(asked) > FEW_TARGETS), ProgressBar(len(asked) if shown else 0) as bar:
                return self._many_under_load(self._load, questions, seconds, threads, bar)
        scene, blocked = self._look_at_base()
        budget = self._budget(given.shape[1], self.options.time if time is None else time)
        questions = ManyProblems(self.robot, asked, scene, self.tolerance, given)
        with code_first(len(asked) > FEW_TARGETS), ProgressBar(len(asked) if shown else 0) as bar:
            many = Many(questions, self._prepared, self._strategy, threads, self.options.most_starts, bar.advance)
            many.begin(self._glance(given.shape[1]) if blocked else budget)
            if blocked:
                many.decide(BASE_BLOCKED)
            many.go_on(lambda outcome, problem, own: self._go_on(outcome, problem, own, budget[3]))
            many.learn()
        return many.solutions(self._resolver)

    def solve_all(
        self,
        target: Targets,
        initial: Initial | None = None,
        *,
        count: Whole = 8,
        apart: Number = 0.02,
        by: Kind | None = None,
        time: Number | None = None,
    ) -> list[Solution]:
        """Find several solutions, best first: one of every class of routes, or all distinct shapes.

        The first solution is looked for as `solve` does it, in half of the time and of the starts at most. Then every
        start is followed to its own solution; by route also starts along routes through other passages. Solutions
        belong to one class when the bodies were found to deform into each other and stay clear, so what differs passes
        some obstacle on another side, or goes through another door; `Solution.route_class` says which. The best one of
        each class is returned. By shape, two solutions are the same when no point of the backbone is farther from its
        counterpart than `apart`.

        The search ends with the starts, the time, a proof that there is no solution, or `CANDIDATES * count` distinct
        solutions (by route: of `count` classes); and after 1000 starts in a row that brought no new shape after the
        first, or by route 400 that brought no new class. The order: less bending first (sum of squared bends); with an
        initial configuration, less distance to it (bends in rad, lengths relative to the mean length of a segment).

        Parameters
        ----------
        target : Target or list of Target
        initial : Solution or array_like (n, 3), optional
        count : int
            Most solutions to return.
        apart : float
            Relative to the robot's mean length.
        by : str, optional
            `route` or `shape`; by default `route` among obstacles, `shape` without any.
        time : float, optional
            Budget in seconds, instead of that of the solver.

        Returns
        -------
        list of Solution
            All solved; empty when none was found.

        Raises
        ------
        InputError
            When an argument is not what it should be.
        """
        wanted = DistinctOptions(
            checks.integer("count", count, 1, 10_000),
            checks.number("apart", apart, low=0.0) * self.robot.mean_length,
            (BY_ROUTE if len(self.scene) else BY_SHAPE) if by is None else checks.choice("by", by, KINDS),
            self.options.most_starts,
            self.options.time if time is None else checks.number("time", time, low=0.0),
        )
        given = self._given(initial)
        if self._load is not None:
            return self._all_under_load(self._load, self._prepared_problem(target), wanted, given)
        problem, blocked = self._problem(target)
        if blocked:
            return []
        several = DistinctSolutions(problem, wanted, preference_cost(self.robot, None if initial is None else given[0]))
        question = IKQuery(problem, given, lambda: several.search.seconds_left, several=True)
        several.search.pursue(several.batches(self._strategy, question), self._follow(problem, given))
        own = self._resolver, given
        return [
            Solution(problem, outcome, outcome.seconds, *own, route_class) for outcome, route_class in several.best()
        ]

    def step(
        self,
        q: Solution | Step | JointsAndBatch,
        twist: Vector | None = None,
        dt: Number | None = None,
        *,
        target: Targets | None = None,
        rates: Rates | None = None,
        clearance: Number | None = None,
        velocity: JointsAndBatch | None = None,
        measured: Stack | None = None,
        places: Vector | None = None,
        gain: Number = GAIN,
        delay: Whole = 0,
    ) -> Step:
        """Go on from a configuration with a twist of the tip, or towards a target, for one step of a control loop.

        The damped least-squares step within limits, rates, obstacles and the body itself, for the scene as it is now.
        It is the exact one of the Jacobian, by the least motion, but near singular shapes, where nothing moves by more
        than 100 times the motion that is asked for (rad, and mean lengths of the robot). Without rates no place of the
        body moves farther than 100 times what is asked for, the motion of the tip and what is missing of a clearance;
        from contact, no farther than 10 times. Limits, those of tensions too, and rates are kept to the last digit. The
        motion from `q`, linear in q, is proved clear, or is as long as that is proved; only a start that is in contact
        already goes on without a proof, and then no gap becomes smaller.

        Parameters
        ----------
        q : Solution, Step or array_like (n, 3)
            Where the robot is. A limit that is exceeded there is not exceeded further.
        twist : array_like (6,) or (3,)
            Of the tool, in world axes, per second: `(omega, v)`, the angular velocity and then the velocity of its
            origin, as in `Robot.jacobian`; or the velocity alone, and the orientation is free.
        dt : float
            Seconds.
        target : Target or list of Target
            To go to instead: all the way in this step where nothing holds it back.
        rates : Rates, optional
            Rates and accelerations of joints hold without them, too.
        clearance : float, optional
            The body is pushed away from obstacles until it has this clearance, before anything else that is asked for.
            By default that of `prefer`, or just more than none.
        velocity : array_like (r, 3), optional
            Of all r rows in the step before, by default of `q` where that is a step: what an acceleration starts from.
            Limits, rates and obstacles come first.

        measured : array_like (3,), (4, 4), (n, 2) or (k, 3), optional
            Where the real robot is: the position or pose of its tool, the bends of its segments (from a fibre), or
            points of its body at `places`, in the world; NaN was not seen. What the model misses is taken for a
            disturbance that varies slowly, and the target is met by the real robot. `q` then has to be the step before,
            which carries what is known of it. Proofs are of the model: see `uncertainty` of the robot.
        places : array_like (k,), optional
            Shares of the length of the body, increasing, 1 = its end.
        gain : float
            Of the observer: share of what is new that a step takes over; less of it is slower, and less moved by noise.
        delay : int
            Control steps by which the measurement is late.

        Returns
        -------
        Step

        Raises
        ------
        InputError
            When an argument is not what it should be.
        """
        limits: dict[str, Any] = {"rates": rates, "clearance": clearance, "velocity": velocity}
        seen: dict[str, Any] = {"measured": measured, "places": places, "gain": gain, "delay": delay}
        return self._control.step(q, twist, dt, target=target, **limits, **seen)

    def __repr__(self) -> str:
        parts = f"{len(self.robot.segments)} segments", f"{len(self.scene)} obstacles", f"method={text(self.method)}"
        return call(type(self).__name__, [*parts, f"time={self.options.time:g}"])

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self)._of_checked, (self.robot, self.scene, self.options)

    @cached_property
    def _control(self) -> ControlLoop:
        return ControlLoop(self.robot, self.scene, self.options, self.tolerance)

    def _problem(self, target: Targets) -> tuple[Problem, bool]:
        """The problem in the scene as it is now, and whether the base is blocked in it."""
        scene, blocked = self._look_at_base()
        targets = self._targets(target)
        return Problem.prepared(self.robot, targets, scene, self.tolerance), blocked

    def _prepared_problem(self, target: Targets) -> Problem:
        """The problem in the scene as it is now; without a look at the base, which is for bodies without load."""
        return Problem.prepared(self.robot, self._targets(target), self.scene.snapshot(), self.tolerance)

    def _targets(self, target: Targets) -> tuple[Target, ...]:
        """Check one target or several; what most ask for, the tip alone, at once."""
        if isinstance(target, Target) and target.segment is None:
            return (target,)
        return target_list("target", target, self.robot)

    def _take_scene(self) -> tuple[Snapshot, bool | None]:
        """Return the scene as it is now, ready for kernels, and that nobody has looked at the base in it."""
        scene = self.scene.snapshot()
        if len(scene):
            _ = scene._kernel_group
        return scene, None

    def _look_at_base(self, scene: Snapshot | None = None) -> tuple[Snapshot, bool]:
        """Look at the base in a scene, by default in that of now; once, unless it was updated."""
        at = self.scene.snapshot() if scene is None else scene
        seen, blocked = self._place
        if seen is not at or blocked is None:
            blocked = base_blocked(self.robot, at)
            self._place = at, blocked
        return at, blocked

    def _budget(self, given: int, time: Number) -> Budget:
        """What the first call may spend, after so many initial configurations."""
        return 0, self._strategy.opening_starts(given), self.options.seed, checks.number("time", time, low=0.0)

    def _look(self, problem: Problem, given: Floats) -> Outcome:
        """Look at one start, so that errors are known, where the base is blocked."""
        return self._prepared.run(problem, given, self._glance(len(given)))._replace(code=BASE_BLOCKED)

    def _glance(self, given: int) -> Budget:
        """What a look at one start may spend, where there are so many initial configurations."""
        return 0, int(given == 0), self.options.seed, 0.0

    def _go_on(self, first: Outcome, problem: Problem, given: Floats, seconds: float) -> Outcome:
        """Ask the other start sources until something is decided."""
        if first.code in UNDECIDED:
            with no_work():  # compiling is no solving
                self._strategy.load()
        search = FirstSolved(first, self.options.max_starts, seconds)
        resting = first.bound and self.method == OWN_METHOD and not len(problem.scene)
        if resting and search.open:
            rested = descend_within_limits(problem, first.q, lambda: search.seconds_left)
            if rested is not first.q:
                search.take(self._from_rest(first, problem, rested, search.seconds_left))
        batches = self._strategy.batches(IKQuery(problem, given, lambda: search.seconds_left))
        search.pursue(batches, self._follow(problem, given))
        return search.outcome

    def _from_rest(self, first: Outcome, problem: Problem, rested: Floats, seconds: float) -> Outcome:
        """Go on from the best within the limits near the best start: descents stop short of corners of limits."""
        found = self._prepared.run(problem, np.array(rested[None]), (0, 0, self.options.seed, max(0.0, seconds)))
        return found._replace(source=first.source, starts=0)

    def _follow(self, problem: Problem, given: Floats) -> Follow:
        """How the starts of a batch are followed for this problem."""
        reference = given[0] if len(given) else None

        def follow(batch: StartBatch, seconds: float) -> Outcome:
            budget = (*batch.own, self.options.seed, seconds)
            return self._prepared.run(problem, batch.initial, budget, reference)

        return follow

    def configuration(self, key: str, initial: Initial) -> Floats:
        """Check what is called `key`: a solution, or a configuration (n, 3) of this robot; return the configuration."""
        given = initial.configuration if isinstance(initial, Solution) else initial
        return self.robot._one_configuration(key, given)

    def _given(self, initial: Initial | None) -> Floats:
        if initial is None:
            return self._no_initial
        if type(initial) is Solution and initial.configuration.shape == self._shape:  # checked when it was found
            return initial.configuration[None].copy()
        return self.configuration("initial", initial).reshape(1, len(self.robot), 3).copy()


def solve(
    robot: Robot,
    target: Targets,
    scene: SceneLike | None = None,
    *,
    initial: Initial | None = None,
    **options: Unpack[SolveArguments],
) -> Solution:
    """Find a configuration of `robot` that meets `target` in `scene`; parameters as for `Solver` and `Solver.solve`."""
    return Solver._for_one_query(robot, scene, **options).solve(target, initial)


def solve_all(
    robot: Robot,
    target: Targets,
    scene: SceneLike | None = None,
    *,
    initial: Initial | None = None,
    count: Whole = 8,
    apart: Number = 0.02,
    by: Kind | None = None,
    **options: Unpack[SolveArguments],
) -> list[Solution]:
    """Find several solutions, ranked: by route or by shape; parameters as for `Solver` and `Solver.solve_all`."""
    return Solver(robot, scene, **options).solve_all(target, initial, count=count, apart=apart, by=by)


@dataclass(frozen=True, init=False)
class KeptOptions(SolveAgain):
    """The options of a solver, kept by its solutions, so that they can solve again.

    Attributes
    ----------
    options : SolveOptions
    """

    options: SolveOptions = field(init=False)

    def __init__(self, options: SolveOptions) -> None:
        method = name_of(options.method)
        super().__init__(method, options.seed, options.time, options.max_starts, options.prefer)
        object.__setattr__(self, "options", options)

    def chooses(self, robot: Robot, clearance: float) -> bool:
        """Whether answers with this proved clearance are chosen by preferences, or moved out of contact."""
        if robot.has_external_load:  # targets are met by the loaded body, of which derivatives know nothing
            return True
        if self.preferences:
            return not self.preferences.satisfied(clearance)
        return clearance < math.inf and self.method == "newton" and clearance < NEARLY_GRAZING * thinnest(robot)

    def solve(
        self, problem: Problem, initial: Floats | None = None, within: Changes | None = None, **options: Any
    ) -> Solution:
        """Solve a problem; `options` replace those of the earlier solve."""
        chosen = replace(self.options, tolerance=problem.tolerance, **options)
        solver = Solver._of_checked(problem.robot, Scene.of(problem.scene), chosen)
        return solver.solve(problem.targets, initial, within=within)


def _warm_solve(solver: Solver) -> None:
    solver.solve(_beyond_reach(solver), np.array(solver.robot.straight), time=0.0)
    solver._strategy.load(anew=True)


def _warm_many(solver: Solver) -> None:
    solver.solve_many([_beyond_reach(solver)], time=0.0)


def _warm_step(solver: Solver) -> None:
    solver.step(np.array(solver.robot.straight), (0.0,) * 6, 1.0)


READY: dict[str, Callable[[Solver], None]] = {
    "solve": _warm_solve,
    "solve_many": _warm_many,
    "solve_all": _warm_solve,
    "step": _warm_step,
}
"""Methods of a solver that can be waited for, and how each is used once."""


def _uses(key: str, given: Sequence[str]) -> list[str]:
    return [checks.choice(key, use, tuple(READY)) for use in given]


def _beyond_reach(solver: Solver) -> Target:
    """A target that is soon seen to be impossible."""
    return Target((0.0, 0.0, 9.0 * len(solver.robot) * solver.robot.mean_length))


def _checked(robot: Robot, scene: SceneLike | None, options: Mapping[str, Any]) -> tuple[Robot, Scene, SolveOptions]:
    """Check what a solver is made of, and warn of what looks wrong."""
    checks.instance("robot", robot, Robot, "a Robot")
    place, chosen = as_scene(scene), SolveOptions.of(options)
    check_sizes(robot, place)
    if chosen.memory is not None:
        chosen.memory.check(robot)
    if isinstance(chosen.method, Options):
        chosen.method.refuse(robot)
    warn_of(input_warnings(robot, place.snapshot()))
    return chosen.demanded_of(robot), place, chosen
