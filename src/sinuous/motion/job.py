"""A problem file as Python has it: read, changed, solved, saved, and joined with its results."""

from pathlib import Path
from typing import Any, TypeVar, Unpack, overload

from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.base.work_time import gc_paused
from sinuous.files.documents import read_results, read_values
from sinuous.files.nouns import known_entries, read_place, read_robot, read_scene
from sinuous.files.problem_file import ProblemFile, problem_of
from sinuous.model.robot import Robot
from sinuous.motion import report
from sinuous.motion.motion import Motion
from sinuous.motion.plan import PlanArguments, plan
from sinuous.motion.track import TimedArguments, track
from sinuous.scene.scene import Scene
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver


class Job(ProblemFile):
    """A robot, what stands around it, where it must be and how exactly: all that a problem file says.

    Parameters as for `ProblemFile`. `load` reads one, `save` writes one.
    """

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
        asked: TimedArguments = {"tolerance": self.tolerance, "rates": self.rates or None}
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


def motion_of(problem: ProblemFile, values: dict[str, Any]) -> Motion:
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
        job = problem_of(entries, file, Job)
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
        A Scene when it is a list, a Robot when there are `segments`, a Motion when there is a `motion`, else a Job.

    Raises
    ------
    InputError
        In one line with the name of the file, the key, the value and what was expected.
    """
    with checks.in_file(file):
        with gc_paused():  # see `read_problem`
            found = _noun_of(read_values(file), str(file))
        if kind is not None and not isinstance(found, kind):
            raise InputError("file", "", found, f"a {kind.__name__}")
        return found


def _noun_of(values: Any, file: str) -> Job | Robot | Scene | Motion:
    if isinstance(values, list):
        return read_scene(values, None, Path(file).parent)
    if isinstance(values, dict) and "segments" in values and "robot" not in values:
        return read_robot(values)
    checks.instance("file", values, dict, "a problem, a robot, a list of obstacles, or a motion")
    if "motion" in values:
        return _saved_motion(values, file)
    return problem_of(values, file, Job)
