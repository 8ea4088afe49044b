"""A problem file as Python has it: read, changed, solved, saved, and joined with its results."""

import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Self, TypeVar, Unpack, overload

from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.base.arguments import JointsAndBatch, OneEach, Reconfigure, Vector
from sinuous.base.checks import Floats
from sinuous.base.documents import described, plain, write_document
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, text
from sinuous.base.progress import gc_paused
from sinuous.files.documents import read_results, read_values
from sinuous.files.nouns import (
    QUESTIONS,
    known_entries,
    problem_arguments,
    read_place,
    read_robot,
    read_scene,
    read_waypoints,
)
from sinuous.model.rates import UNLIMITED, Rates
from sinuous.model.robot import Robot, demanding
from sinuous.motion import report
from sinuous.motion.motion import Motion
from sinuous.motion.plan import PlanArguments, plan
from sinuous.motion.track import TimedArguments, track
from sinuous.problem.problem import Preferences, Problem, check_sizes, problem_warnings
from sinuous.problem.target import Target, Targets, Tolerance, Workspace, as_tolerance
from sinuous.scene.mesh import Mesh
from sinuous.scene.scene import Scene, SceneLike, as_scene
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver


class Job(Frozen):
    """A robot, what stands around it, where it must be and how exactly: all that a problem file says.

    `load` reads one, `save` writes one.

    Parameters
    ----------
    robot : Robot
    target : Target or list of Target, optional
        To be met at once.
    scene : Scene or list of obstacles, optional
    path : iterable of Target or list of Target, optional
        Waypoints to be met one after the other, instead of `target`.
    goal : array_like (n, 3), optional
        The configuration where a plan ends, instead of `target`.
    times : array_like (m,), optional
        Of all waypoints of a path, increasing.
    tolerance : Tolerance, optional
    start : array_like (n, 3), optional
        Where the first solve, or a motion, begins.
    prefer : Preferences, optional
    rates : Rates, optional
        How fast the robot may move.
    reconfigure : str
        Whether the tip may leave the line between two waypoints, see `track`: `refuse` or `allow`.
    workspace : Workspace, optional
        What a map of the workspace asks.
    clearance, self_clearance : float or array_like (n,), optional
        Distance from obstacles, and from itself, that the body has to keep, instead of what the robot demands.
    file : str
        Its name, as it was given; empty when it is not from a file.

    Attributes
    ----------
    waypoints : tuple of tuple of Target
        One after the other; the targets of one waypoint are met at once. None where a configuration is the goal.
    times : ndarray (m,) or None
    is_path : bool
        Whether it speaks of a path; otherwise there is one waypoint, or a goal.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    robot: Robot
    scene: Scene
    waypoints: tuple[tuple[Target, ...], ...]
    times: Floats | None
    is_path: bool
    goal: Floats | None
    tolerance: Tolerance
    start: Floats | None
    prefer: Preferences
    rates: Rates
    reconfigure: Reconfigure
    workspace: Workspace
    file: str

    def __init__(
        self,
        robot: Robot,
        target: Targets | None = None,
        scene: SceneLike | None = None,
        *,
        path: Iterable[Targets] | None = None,
        goal: JointsAndBatch | None = None,
        times: Vector | None = None,
        tolerance: Tolerance | None = None,
        start: JointsAndBatch | None = None,
        prefer: Preferences | None = None,
        rates: Rates | None = None,
        reconfigure: Reconfigure = "refuse",
        workspace: Workspace | None = None,
        clearance: OneEach | None = None,
        self_clearance: OneEach | None = None,
        file: str = "",
    ) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        asked = [key for key, value in (("target", target), ("path", path), ("goal", goal)) if value is not None]
        if len(asked) > 1:
            raise InputError("target", f"cannot be combined with {asked[1]}", target, "one of target, path, goal")
        checks.instance("prefer", prefer, Preferences | None, "Preferences")
        checks.instance("rates", rates, Rates | None, "Rates")
        checks.instance("workspace", workspace, Workspace | None, "a Workspace")
        if rates is not None:
            with checks.inside("rates"):
                rates.check(robot)
        place = as_scene(scene)
        check_sizes(robot, place)
        targets: Any = path if path is not None else [target] if target is not None else None
        waypoints = () if targets is None else read_waypoints(asked[0], targets, robot)
        if times is not None and path is None:
            raise InputError("times", "needs a path", times, "those of a path")
        self._set(
            robot=demanding(robot, clearance, self_clearance),
            scene=place,
            waypoints=waypoints,
            times=None if times is None else checks.increasing("times", times, len(waypoints)),
            is_path=path is not None,
            goal=None if goal is None else robot._one_configuration("goal", goal),
            tolerance=as_tolerance(tolerance),
            start=None if start is None else robot._one_configuration("start", start),
            prefer=prefer or Preferences(),
            rates=UNLIMITED if rates is None else rates,
            reconfigure=checks.choice("reconfigure", reconfigure, report.RECONFIGURE),
            workspace=Workspace() if workspace is None else workspace,
            file=file,
        )

    def _content(self) -> dict[str, Any]:
        """All but the name of the file; the scene as it is now."""
        return {**super()._content(), "scene": self.scene.snapshot(), "file": None}

    @property
    def notes(self) -> tuple[str, ...]:
        """What is not as it should be: the defects of all meshes and what became of them, and what is suspicious."""
        defects = [
            f"{self.scene.name(i)}: {defect}"
            for i, obstacle in enumerate(self.scene.obstacles)
            if isinstance(obstacle, Mesh)
            for defect in obstacle.defects
        ]
        suspicious = problem_warnings(self.robot, self.scene.snapshot(), self.waypoints)
        return (*defects, *suspicious, *self.robot.coordinate_notes, *self.robot.joint_notes)

    def _shown(self) -> Iterator[str]:
        yield from (text(self.file),) if self.file else ()
        yield f"{len(self.robot.segments)} segments"
        targets = f"{len(self.waypoints)} waypoints" if self.is_path else f"{sum(map(len, self.waypoints))} targets"
        yield "a goal" if self.goal is not None else targets
        yield f"{len(self.scene)} obstacles"

    def demanding(self, clearance: OneEach | None, self_clearance: OneEach | None) -> Self:
        """Return the same with other clearances that the body has to keep, where they are given."""
        other = object.__new__(type(self))
        other._set(**{**vars(self), "robot": demanding(self.robot, clearance, self_clearance)})
        return other

    @property
    def ends(self) -> tuple[Target, ...] | Floats:
        """Where a plan ends: at the targets, or at the goal (n, 3)."""
        return self.waypoints[0] if self.goal is None else self.goal

    def problem(self, waypoint: int = 0) -> Problem:
        """Return the question that one waypoint asks."""
        return Problem(self.robot, self.waypoints[waypoint], self.scene, self.tolerance)

    def _refuse(self, *kinds: str) -> None:
        """Refuse what this asks, where it is nothing or one of these kinds of questions: those of `track` or `plan`."""
        file = self.file or None
        if not self.waypoints and self.goal is None:
            raise InputError("target", "missing", ["robot", "scene"], "one of target, targets, path, goal", file)
        if "path" in kinds and self.is_path:
            raise InputError("path", "is for track", len(self.waypoints), "target or targets", file)
        if "goal" in kinds and self.goal is not None:
            raise InputError("goal", "is for plan", self.goal.tolist(), "target or targets", file)
        if "no start" in kinds and self.start is None:
            raise InputError("start", "missing", None, "where the motion begins", file)

    def to_dict(self, folder: str | Path = ".") -> dict[str, Any]:
        """Return what a problem file in `folder` says; what has its default is left out.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file.
        """
        parts = {
            "robot": self.robot.to_dict(),
            "scene": self.scene.entries(folder),
            **self._question(),
            "tolerance": described(self.tolerance),
            "start": None if self.start is None else self.start.tolist(),
            "prefer": described(self.prefer),
            "rates": described(self.rates),
            "reconfigure": "" if self.reconfigure == "refuse" else self.reconfigure,
            "workspace": described(self.workspace),
        }
        return {key: value for key, value in parts.items() if value}

    def _question(self) -> dict[str, Any]:
        if self.goal is not None:
            return {"goal": self.goal.tolist()}
        listed = [[described(target) for target in targets] for targets in self.waypoints]
        if self.is_path:
            path = [targets[0] if len(targets) == 1 else targets for targets in listed]
            return {"path": path} | ({} if self.times is None else {"times": plain(self.times)})
        if not listed:
            return {}
        return {"target": listed[0][0]} if len(listed[0]) == 1 else {"targets": listed[0]}

    def save(self, file: str | Path) -> None:
        """Write a problem file, JSON when it is called so, YAML otherwise; read again, it is equal.

        Obstacles that were read from files stay there; the new file names them. All else stands in the new file.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file, or the file cannot be written.
        """
        write_document(file, self.to_dict(Path(file).parent))

    def solver(self, **options: Unpack[SolveArguments]) -> Solver:
        """Prepare a solver; `options` as for `Solver`, which replace those of the file."""
        return Solver(self.robot, self.scene, **self._options(options))

    def solve(self, **options: Unpack[SolveArguments]) -> Solution:
        """Meet the target, or several at once; `options` as for `Solver`.

        Raises
        ------
        InputError
            When it speaks of a path, or an option is not what it should be.
        """
        self._refuse("path", "goal")
        solver = Solver._for_one_query(self.robot, self.scene, **self._options(options))
        return solver.solve(self.waypoints[0], self.start)

    def track(self, **options: Unpack[TimedArguments]) -> Motion:
        """Follow the path, each target from the last; a single target is a path of one. `options` as for `track`.

        Raises
        ------
        InputError
            When it speaks of a goal, or an option is not what it should be.
        """
        self._refuse("goal")
        asked: TimedArguments = {
            "tolerance": self.tolerance,
            "rates": self.rates or None,
            "reconfigure": self.reconfigure,
        }
        if self.prefer:
            asked["prefer"] = self.prefer
        given: TimedArguments = {**asked, **options}
        return track(self.robot, self.waypoints, self.scene, start=self.start, times=self.times, **given)

    def plan(self, **options: Unpack[PlanArguments]) -> Motion:
        """Plan a motion from `start` to the target, to several at once, or to the goal. `options` as for `plan`.

        Raises
        ------
        InputError
            When it speaks of a path or has no start, or an option is not what it should be.
        """
        self._refuse("path", "no start")
        assert self.start is not None
        asked: PlanArguments = {"tolerance": self.tolerance, "prefer": self.prefer, "rates": self.rates or None}
        given: PlanArguments = {**asked, **options}
        return plan(self.robot, self.start, self.ends, self.scene, **given)

    def result(self, file: str | Path) -> Solution | Motion:
        """Read what was found for this problem: a result of the command line, or one `to_dict` as a line of JSON.

        Parameters
        ----------
        file : path
            JSON lines; of several, the one that names the file of this problem.

        Raises
        ------
        InputError
            When there is no such result, or it does not fit the problem.
        """
        with checks.in_file(file):
            line, values = self._own(read_results(Path(file)))
            with checks.inside(f"line {line}"):
                if self.goal is not None or "waypoints" in values:
                    return motion_of(self, values)
                return Solution.from_dict(values, self.problem())

    def _own(self, results: list[tuple[int, dict[str, Any]]]) -> tuple[int, dict[str, Any]]:
        if len(results) == 1:
            return results[0]
        here = Path(self.file).absolute()
        found = [each for each in results if Path(str(each[1].get("file", ""))).absolute() == here]
        if not found:
            names = [each[1].get("file") for each in results]
            raise InputError("file", "there are others", names, f"a result of {self.file or 'this problem'}")
        return found[-1]

    def _options(self, given: SolveArguments) -> SolveArguments:
        return {"tolerance": self.tolerance, "prefer": self.prefer, **given}


def read_problem(file: str | Path, question: bool = True) -> Job:
    """Read a problem file, JSON when it is called so, YAML otherwise; `docs/format.md` has its keys.

    Without its `question`: its target, path or goal is not read, and it may be a robot alone.

    Raises
    ------
    InputError
        When it cannot be read or cannot be meant: one line with the name of the file, the key, the value and what was
        expected.
    """
    with checks.in_file(file), gc_paused():  # a long path is some hundred thousand values
        return job_of(read_values(file), str(file), question)


def job_of(value: Any, file: str, question: bool = True) -> Job:
    """Make a job of the plain values of a problem file of this name; see `read_problem`."""
    return Job(**problem_arguments(value, file, question))


def motion_of(problem: Job, values: dict[str, Any]) -> Motion:
    """Make the motion that was found for a problem of its result as plain values.

    Raises
    ------
    InputError
        When they are none of it.
    """
    scene = problem.scene.snapshot()
    if problem.goal is not None:
        return Motion.restored(values, (), (problem.robot, scene))
    return Motion.from_dict(values, map(problem.problem, range(len(problem.waypoints))), scene)


SAVED = ("robot", "scene", "path", "tolerance", "motion")
"""Keys of the file of a motion."""


def _saved_motion(values: dict[str, Any], file: str) -> Motion:
    """Make a motion of its file; see `Motion.save`."""
    entries = known_entries(values, SAVED, ["robot", "motion"])
    found = entries.pop("motion")
    if "path" in entries:
        job = job_of(entries, file)
        robot, scene, problems = job.robot, job.scene, tuple(map(job.problem, range(len(job.waypoints))))
    else:
        robot, scene = read_place(entries, Path(file).parent)
        problems = ()
    around = scene.snapshot()
    with checks.inside("motion"):
        untried = found.get("remaining", 0) if isinstance(found, dict) else 0
        asked = len(problems) + checks.integer("remaining", untried, 0, report.MOST_WAYPOINTS)
        return Motion.restored(found, problems, (robot, around), around if around.moves else None, asked)


Noun = TypeVar("Noun", Job, Robot, Scene, Motion)


@overload
def load(file: str | Path) -> Any: ...
@overload
def load(file: str | Path, kind: type[Noun]) -> Noun: ...
def load(file: str | Path, kind: type[Any] | None = None) -> Any:
    """Read a problem file, or a robot, the obstacles of a scene, or a motion in a file of its own.

    JSON when the file is called so, YAML otherwise; `docs/format.md` has the keys.

    Parameters
    ----------
    file : path
    kind : type, optional
        What it must be: Job, Robot, Scene or Motion.

    Returns
    -------
    Job, Robot, Scene or Motion
        A Scene when it is a list, a Robot when there are `segments`, a Motion when there is a `motion`, else a Job;
        without a target, path or goal, it asks nothing.

    Raises
    ------
    InputError
        In one line with the name of the file, the key, the value and what was expected.
    """
    checks.instance("file", file, str | os.PathLike, "the name of a file")
    with checks.in_file(file):
        with gc_paused():  # see `read_problem`
            found = _noun_of(read_values(file), str(file))
        if kind is not None and not isinstance(found, kind):
            raise InputError("file", "", found, f"a {kind.__name__}")
        return found


def _noun_of(values: Any, file: str) -> Job | Robot | Scene | Motion:
    if isinstance(values, list):
        return read_scene(values, None, Path(file).parent)
    if (
        isinstance(values, dict)
        and ("segments" in values or "joints" in values)
        and not {"robot", "motion"} & {*values}
    ):
        return read_robot(values, Path(file).parent)
    checks.instance("file", values, dict, "a problem, a robot, a list of obstacles, or a motion")
    if "motion" in values:
        return _saved_motion(values, file)
    return job_of(values, file, question=any(key in values for key in QUESTIONS))
