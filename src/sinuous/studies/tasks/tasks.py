"""Tasks: a target, several at once, a path, a set, a move; and how each is done."""

import warnings
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple, Protocol

from sinuous.answer.binding import Binding, nearest_limits
from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.arguments import Number, Rows
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.base.frozen import Frozen
from sinuous.files.nouns import read_waypoints
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.plan import plan
from sinuous.motion.track import track
from sinuous.problem.target import Target, Targets, target_list, target_table
from sinuous.solver.solver import Solver

SOLVED = str(Status.SOLVED)
"""Status of a task that is done."""


class Done(NamedTuple):
    """What became of a task.

    Attributes
    ----------
    status : str
    share : float
        Of its targets that are met: 0 or 1 where there is one.
    clearance, self_clearance : float or None
        Least proved.
    seconds : float
        Of computing.
    duration : float or None
        How long the motion takes; of a target nothing.
    binds : str or None
        What holds it back, or, where it is done, the limit of which least is left.
    shapes : ndarray (k, n, 3) or None
        The configurations of its answers, where it is done.
    """

    status: str
    share: float
    clearance: float | None
    self_clearance: float | None
    seconds: float
    duration: float | None
    binds: str | None
    shapes: Floats | None = None

    def told(self) -> dict[str, Any]:
        """All but the shapes, by name."""
        return {key: value for key, value in self._asdict().items() if key != "shapes"}


class Task(Protocol):
    """Something that a robot may be able to do."""

    kind: str

    def check(self, robot: Robot) -> None:
        """Refuse what cannot be asked of this robot."""
        ...

    def do(self, solver: Solver) -> Done:
        """Try it."""
        ...


class Meet(Frozen):
    """Targets that are to be met at once."""

    kind = "target"
    targets: tuple[Target, ...]

    def __init__(self, targets: Targets) -> None:
        self._set(targets=target_list("target", targets))

    def check(self, robot: Robot) -> None:
        """Refuse a segment that the robot does not have."""
        target_table(robot, self.targets)

    def do(self, solver: Solver, start: Floats | None = None, explained: bool = True) -> Done:
        """Solve it, from a configuration where one is known; what holds it back takes longest to find."""
        found = solver.solve(self.targets, start)
        return _done(
            found, float(found.solved), None, binds_of([found]) if explained else None, found.configuration[None]
        )


class _Several(Frozen):
    """Waypoints, or targets each by itself, and perhaps a start."""

    targets: tuple[tuple[Target, ...], ...]
    start: Any = None

    def check(self, robot: Robot) -> None:
        """Refuse a segment that the robot does not have, and a start of another number of them."""
        for i, targets in enumerate(self.targets):
            with checks.inside(f"targets[{i}]"):
                target_table(robot, targets)
        if self.start is not None:
            checks.array("start", self.start, (len(robot), 3))


class Follow(_Several):
    """A path that is to be followed, all of it proved clear.

    Parameters
    ----------
    targets : iterable of Target or list of Target
        The waypoints; the targets of a list are met at once.
    start : array_like (n, 3), optional
        The configuration that the robot is in; then it has to have n segments.
    """

    kind = "path"

    def __init__(self, targets: Iterable[Targets], start: Rows | None = None) -> None:
        self._set(targets=read_waypoints("targets", targets), start=_start(start))

    def do(self, solver: Solver) -> Done:
        """Follow it."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)  # the solver has said it
            motion = track(
                solver.robot, self.targets, solver.scene, start=self.start, reconfigure="allow", **vars(solver.options)
            )
        share = sum(solution.solved for solution in motion.solutions) / len(self.targets)
        return _done(motion, share, motion.duration, binds_of(motion.solutions), motion.configuration)


class Cover(_Several):
    """Targets of which a share is to be met, each by itself.

    Parameters
    ----------
    targets : iterable of Target or list of Target
        The targets of a list are met at once.
    share : float
        How many of them have to be met for the task to be done, as a share.
    """

    kind = "set"
    share: float

    def __init__(self, targets: Iterable[Targets], share: Number = 1.0) -> None:
        needed = checks.number("share", share, above=0.0, high=1.0)
        self._set(targets=read_waypoints("targets", targets), share=needed)

    def do(self, solver: Solver) -> Done:
        """Solve each."""
        found = solver.solve_many([list(targets) for targets in self.targets], workers=1)
        solved = found[found.solved]
        share = len(solved) / len(found)
        status = SOLVED if share >= self.share else str(found[~found.solved][0].status)
        proved = (
            _least(solved.clearance) if len(solver.scene) else None,
            _least(solved.self_clearance) if solver.robot.avoids_itself else None,
        )
        shapes = solved.configuration if status == SOLVED else None
        return Done(status, share, *proved, float(found.seconds.sum()), None, binds_of(found), shapes)


class Move(Frozen):
    """A motion to targets that is to be planned, all of it proved clear.

    Parameters
    ----------
    goal : Target or list of Target
        Where the robot must be in the end; the targets of a list are met at once.
    start : array_like (n, 3), optional
        The configuration that the robot is in; then it has to have n segments. By default it is straight, with segments
        of mean length.
    """

    kind = "plan"
    goal: tuple[Target, ...]
    start: Any

    def __init__(self, goal: Targets, start: Rows | None = None) -> None:
        self._set(goal=target_list("goal", goal), start=_start(start))

    def check(self, robot: Robot) -> None:
        """Refuse a segment that the robot does not have, and a start of another number of them."""
        with checks.inside("goal"):
            target_table(robot, self.goal)
        if self.start is not None:
            checks.array("start", self.start, (len(robot), 3))

    def do(self, solver: Solver) -> Done:
        """Plan it."""
        start = solver.robot.straight if self.start is None else self.start
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)  # the solver has said it
            motion = plan(solver.robot, start, list(self.goal), solver.scene, **vars(solver.options))
        duration = motion.duration if motion.solved else None
        worst = None if motion.worst is None else motion.worst.obstacle or motion.worst.constraint
        return _done(motion, float(motion.solved), duration, binds_of(motion.solutions) or worst, motion.configuration)


def _start(start: Rows | None) -> Floats | None:
    return None if start is None else checks.array("start", start, (None, 3))


def _least(values: Floats) -> float | None:
    return float(values.min()) if len(values) else None


def _done(answer: Solution | Motion, share: float, duration: float | None, binds: str | None, shapes: Floats) -> Done:
    """What became of a task, by its answer."""
    proved, done = (answer.clearance, answer.self_clearance), shapes if answer.solved else None
    return Done(str(answer.status), share, *proved, answer.seconds, duration, binds, done)


def binds_of(solutions: Iterable[Solution]) -> str | None:
    """What holds solutions back most often; where all are solved, the limit that is nearest most often."""
    listed = list(solutions)
    failed = [found for found in listed if not found.solved]
    names: Counter[str] = Counter()
    for found in failed or listed:
        near = found.binding[:1] if failed else nearest_limits(found.problem, found.configuration, 1)
        names.update(_word(each) for each in near)
        if failed and not near and found.reason is not None:
            names.update([found.reason.obstacle or found.reason.bound])
    return names.most_common(1)[0][0] if names else None


def _word(binding: Binding) -> str:
    """A limit or an obstacle, whatever the number of segments."""
    if binding.obstacle is not None:
        return binding.obstacle
    return {"clearance": "obstacles", "self_clearance": "itself"}.get(binding.constraint, binding.constraint)


def read_tasks(tasks: Any) -> dict[str, Task]:
    """Check tasks: by name, or listed, when they are called `task 1`, `task 2`, ...

    Raises
    ------
    InputError
        That names the task.
    """
    if isinstance(tasks, Mapping):
        named = {str(name): task for name, task in tasks.items()}
    elif isinstance(tasks, Iterable) and not isinstance(tasks, str | bytes):
        named = {f"task {i}": task for i, task in enumerate(tasks, 1)}
    else:
        raise InputError("tasks", "", tasks, "a mapping or a list of tasks")
    if not named:
        raise InputError("tasks", "", tasks, "at least one task")
    return {name: _task(name, task) for name, task in named.items()}


def _task(name: str, task: Any) -> Task:
    if hasattr(task, "do") and hasattr(task, "check"):
        return task
    if not isinstance(task, Target | list | tuple):
        raise InputError(
            f"tasks[{name!r}]",
            "",
            task,
            "a Target, a list of them to be met at once, Follow(path), Cover(targets), or Move(goal)",
        )
    with checks.inside(f"tasks[{name!r}]"):
        return Meet(task)
