"""The commands solve, track and plan: read all files, then answer one after the other.

An answer goes to standard output, a file, a table, a picture.
"""

import time as clock
import warnings
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np
import typer

from sinuous.answer.explanation import Explanation
from sinuous.answer.route_class import RouteClass
from sinuous.answer.solution import Solution
from sinuous.answer.solutions import column_names
from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.checks import Floats, written
from sinuous.base.documents import result_of
from sinuous.base.errors import InputError, SuspiciousInput, counted
from sinuous.base.progress import ProgressBar
from sinuous.cli.app import Plan, Solve, Track
from sinuous.cli.options import (
    INTERRUPTED,
    SOLVED,
    UNSOLVED,
    MotionOutput,
    Output,
    Remembering,
    Timed,
    is_page,
    names_in,
    numbered,
)
from sinuous.cli.reading import ReadProblem, read_all, remembered, say_notes
from sinuous.files.documents import json_line, result
from sinuous.motion.configurations import check_limits
from sinuous.motion.job import Job, motion_of
from sinuous.motion.knots import TrackedWaypoint, read_entry, read_outcome, write_entry, write_outcome
from sinuous.motion.motion import Motion
from sinuous.motion.pace import Pace
from sinuous.motion.plan import MOST_SHORTCUTS, Planner
from sinuous.motion.report import RECONFIGURE
from sinuous.motion.tables import write_csv
from sinuous.motion.track import tracker_of
from sinuous.motion.tracker import Tracker
from sinuous.problem.target import Targets
from sinuous.solver.distinct_solutions import KINDS, Kind
from sinuous.solver.memory import Memory
from sinuous.solver.solver import Solver

if TYPE_CHECKING:
    from sinuous.cli.journal import Journal

MOST_DRAWN = 8
"""Of several solutions, how many a picture has: the best ones."""


@dataclass(frozen=True)
class Alternatives:
    """What `solve --all` found.

    Attributes
    ----------
    solutions : tuple of Solution
        Distinct, all solved, best first; perhaps none.
    best : Solution
        The first of them; where there is none, what a plain solve says of the target.
    seconds : float
        Of the whole search.
    """

    solutions: tuple[Solution, ...]
    best: Solution
    seconds: float

    @property
    def solved(self) -> bool:
        """Whether there is a solution."""
        return self.best.solved

    def to_dict(self) -> dict[str, Any]:
        """Return what they have in common, and each, as plain values in the order of the file format."""
        best = result_of(self.best, "status base worst reason")
        return {**best, "seconds": self.seconds, **result_of(self.best, "method seed"), **result_of(self, "solutions")}

    def __str__(self) -> str:
        if not self.solutions:
            return str(self.best)
        count = f"{counted(len(self.solutions), 'distinct solution')}, best first"
        classes = {each.route_class.number: each.route_class for each in self.solutions if each.route_class is not None}
        rows = [["", *(["class"] if classes else []), "bend", "length", "clearance", "position", "angle", "start"]]
        rows += [[str(i), *_class(each, classes), *_cells(each)] for i, each in enumerate(self.solutions, 1)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
        words = [f"  {route_class}" for _, route_class in sorted(classes.items())]
        return "\n".join([f"Alternatives: {self.best.status} ({count})", *lines, *words])


def _class(solution: Solution, classes: dict[int, RouteClass]) -> list[str]:
    """Number of the class of a solution, where there are classes."""
    own = solution.route_class
    return [] if not classes else ["-" if own is None else str(own.number)]


def _cells(solution: Solution) -> list[str]:
    """All bends (rad) and lengths together, proved clearance, errors, and the kind of start."""
    numbers = (
        float(np.hypot(solution.configuration[:, 0], solution.configuration[:, 1]).sum()),
        float(solution.configuration[:, 2].sum()),
        solution.clearance,
        solution.position_error,
        solution.angle_error,
    )
    return [*("-" if number is None else f"{number:.3g}" for number in numbers), solution.start]


Answer = Solution | Motion | Alternatives


class AnswerWriter:
    """Writes each answer as soon as it is there, so that an interrupt loses none.

    Parameters
    ----------
    output : Output
        Where answers go.
    files : int
        How many problem files there are.
    """

    def __init__(self, output: Output, files: int) -> None:
        self._output, self._files, self._columns = output, files, names_in(output.columns)
        self._done = 0
        self._out: TextIO | None = None
        if output.out is not None:
            with written(output.out, "--out"):
                self._out = output.out.open("w", encoding="utf-8", newline="\n")

    def __enter__(self) -> "AnswerWriter":
        return self

    def __exit__(self, *_: object) -> None:
        if self._out is not None:
            self._out.close()

    def write(self, file: str, answer: Answer, prepare_seconds: float, why: float | None) -> None:
        """Write the answer to a problem file, and what explains it; an interrupt leaves the answer.

        `why`: seconds for explaining it; `None`: it is not explained.
        """
        try:
            explanation = answer.explain(why) if why is not None and isinstance(answer, Solution) else None
        except KeyboardInterrupt:
            self._write(file, answer, prepare_seconds, None)
            raise
        self._write(file, answer, prepare_seconds, explanation)

    def _write(self, file: str, answer: Answer, prepare_seconds: float, why: Explanation | None) -> None:
        self._done += 1
        if self._output.json or self._out is not None:  # of a long path, a line is more work than solving it
            remedies = {} if why is None else {"remedies": why.to_dict()["remedies"]}
            line = json_line(result(file, answer.to_dict() | remedies, prepare_seconds))
            if self._out is not None:
                self._out.write(line + "\n")
                self._out.flush()
        text = f"{file}: {str(answer).split(': ', 1)[1]}" if why is None else f"{file}: {why}"
        typer.echo(line if self._output.json else text)
        table = numbered(self._output.csv, self._done, self._files)
        if table is not None:
            self._write_table(table, answer)
        picture = numbered(self._output.plot, self._done, self._files)
        if picture is not None:
            _draw(picture, answer)

    def _write_table(self, file: Path, answer: Answer) -> None:
        if isinstance(answer, Alternatives):
            write_csv(file, answer.solutions or (answer.best,), self._columns)
        elif isinstance(answer, Motion) and not answer.solved and len(answer.configuration) < 2:
            say_notes({str(file): ("not written: no motion was found",)})
        elif isinstance(answer, Motion):
            rate = self._output.rate if isinstance(self._output, MotionOutput) else None
            _write_rows(file, answer, rate, self._columns)
        else:
            write_csv(file, (answer,), self._columns)


def _write_rows(file: Path, motion: Motion, rate: float | None, columns: list[str] | None) -> None:
    """Write a motion as a table; that lines between its rows are not proved is a note, on standard error."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", SuspiciousInput)
        motion.to_csv(file, rate, columns)
    say_notes({str(file): tuple(str(each.message) for each in said)})


def _draw(file: Path, answer: Answer) -> None:
    if is_page(file):
        from sinuous.view.page.show import show  # noqa: PLC0415

        show(*(answer.solutions or [answer.best] if isinstance(answer, Alternatives) else [answer]), path=file)
    else:
        from sinuous.view.pictures.reports import write_picture  # noqa: PLC0415

        drawn = (answer.solutions[:MOST_DRAWN] or answer.best) if isinstance(answer, Alternatives) else answer
        write_picture(file, drawn)


def write_solution(solution: Solution) -> dict[str, Any]:
    """Return what a journal keeps of a solution: plain values, numbers to the last digit."""
    own = solution.route_class
    outcome, route_class = write_outcome(solution._outcome), None if own is None else own.to_dict()
    return {"outcome": outcome, "seconds": solution.seconds, "route_class": route_class}


def read_solution(solver: Solver, targets: Targets, start: Floats | None, values: dict[str, Any]) -> Solution:
    """Return the solution that `write_solution` wrote, as `solver` found it from `start`.

    Raises
    ------
    KeyError, TypeError, ValueError
        When `values` are something else.
    """
    outcome = read_outcome(values["outcome"], len(solver.robot))
    own = values["route_class"]
    route_class = None if own is None else RouteClass.from_dict(own)
    return solver._restore_solution(targets, outcome, values["seconds"], start, route_class)


EXPLAINING = 2.0
"""Seconds for `--why`."""

MOST_ALTERNATIVES = 10_000
"""Most solutions that `--all` may ask for."""

Asked = Solve | Track | Plan

Prepare = Callable[..., Any]
"""Prepares what answers a problem file: a solver, tracker or planner, of the file and of options of `Solver`."""

Find = Callable[[Any, Job, "Journal | None", Callable[[], None]], Answer]
"""Finds the answer to a problem file by what was prepared, with a journal, and a call for each step that is done."""


def solve_files(asked: Solve) -> int:
    """Solve the target of every file, or find several solutions by route or shape; return the exit code."""
    count, by = asked.all, asked.by
    _check(asked)
    kind = None if by is None else checks.choice("--by", by, KINDS)
    if by is not None and count is None:
        raise InputError("--by", "is for --all", by, "--all COUNT, too")
    if count is not None:
        checks.integer("--all", count, 1, MOST_ALTERNATIVES)
        if asked.why:
            raise InputError("--all", "cannot be combined with --why", count, "one of --all, --why")
    why = _explaining_time(asked)
    read = read_all(asked.files, asked.solving.demands)
    for one in read:
        one.problem._refuse("path", "goal")
        _refuse_moving(one.problem)
    made = Solver._for_one_query if len(read) == 1 and count is None else Solver

    def prepare(problem: Job, **options: Any) -> Solver:
        return made(problem.robot, problem.scene, **options)

    find = _solve if count is None else partial(_solve_all, count, kind)
    return _answer_all(asked, read, prepare, find, {"all": count, "by": by}, why)


def _check(asked: Asked) -> None:
    """Refuse options that cannot be meant, before any problem file is read."""
    asked.solving.arguments()
    asked.output.check(asked.files)
    if not isinstance(asked, Solve):
        asked.timed.check()


def track_files(asked: Track) -> int:
    """Follow the path of every file; a single target is a path of one waypoint. Return the exit code."""
    timed, deviation = asked.timed, asked.deviation
    _check(asked)
    if deviation is not None:
        checks.number("--deviation", deviation, above=0.0)
    if asked.reconfigure is not None:
        checks.choice("--reconfigure", asked.reconfigure, RECONFIGURE)
    read = read_all(asked.files, asked.solving.demands)
    for one in read:
        one.problem._refuse("goal")
        _check_timed(one.problem, timed)
        if timed.duration is not None and one.problem.times is not None:
            raise InputError(
                "--duration", "cannot be combined with times", timed.duration, "one of both", one.problem.file
            )

    def prepare(problem: Job, **options: Any) -> Tracker:
        options["prefer"] = problem.prefer or None  # without any, those of `track`
        times = _paces(problem, timed)[1]
        reconfigure = asked.reconfigure or problem.reconfigure
        own: dict[str, Any] = {
            "start": problem.start,
            "times": times,
            "deviation": deviation,
            "reconfigure": reconfigure,
        }
        return tracker_of(problem.robot, len(problem.waypoints), problem.scene, **own, **options)

    _say_nominal(read, asked.output)
    find = partial(_track, timed)
    return _answer_all(
        asked, read, prepare, find, {"deviation": deviation, "reconfigure": asked.reconfigure, **vars(timed)}
    )


def plan_files(asked: Plan) -> int:
    """Plan the motion that every file asks for; return the exit code."""
    timed = asked.timed
    _check(asked)
    checks.integer("--shortcuts", asked.shortcuts, 0, MOST_SHORTCUTS)
    checks.number("--begin", asked.begin)
    read = read_all(asked.files, asked.solving.demands)
    for problem in (one.problem for one in read):
        problem._refuse("path", "no start")
        _check_timed(problem, timed)
        if problem.goal is not None:
            with checks.in_file(problem.file):
                check_limits(problem.robot, "goal", problem.goal)
    typed: dict[str, Any] = {"shortcuts": asked.shortcuts, "begin": asked.begin, "duration": timed.duration}

    def prepare(problem: Job, **options: Any) -> Planner:
        with checks.in_file(problem.file):
            return Planner(problem.robot, problem.scene, rates=problem.rates or None, **typed, **options)

    _say_nominal(read, asked.output)
    find = partial(_plan, timed)
    return _answer_all(asked, read, prepare, find, typed | vars(timed))


def _check_timed(problem: Job, timed: Timed) -> None:
    """Refuse `--timed` where nothing says how fast the robot may be, or obstacles move."""
    if timed.timed and not problem.rates:
        raise InputError("rates", "missing, and --timed needs them", None, "how fast the robot may be", problem.file)
    if timed.timed and problem.scene.snapshot().moves:
        raise InputError("--timed", "obstacles move", True, "rates alone, which are kept in any case", problem.file)


def _paces(problem: Job, timed: Timed) -> tuple[Pace, Floats | None]:
    """How fast the path of a file is followed, and the times of its waypoints where they have any."""
    pace = Pace.of(problem.robot, problem.rates, timed.duration, times=problem.times)
    own = pace.waypoints(len(problem.waypoints), problem.start is not None)
    return pace, own if problem.times is None else problem.times


def _say_nominal(read: list[ReadProblem], output: MotionOutput) -> None:
    """Say of tables for motors that nothing says how fast these are, so that times in them are nominal."""
    for problem in (one.problem for one in read if output.csv is not None):
        if problem.robot.actuators and not problem.rates and problem.times is None:
            say_notes({problem.file: ("no rates: the times of --csv are nominal, not those that motors need",)})


def _refuse_moving(problem: Job) -> None:
    """Refuse obstacles that move, past which a robot has to move, too."""
    scene = problem.scene.snapshot()
    if scene.moves:
        name = problem.scene.name(next(iter(scene.courses)))
        raise InputError("scene", f"{name} moves", name, "obstacles that stand still, or track or plan", problem.file)


def _explaining_time(asked: Solve) -> float | None:
    """Seconds that `--why` may take for each file; `None` without it."""
    if asked.why_time is None:
        return EXPLAINING if asked.why else None
    if not asked.why:
        raise InputError("--why-time", "is for --why", asked.why_time, "--why, too")
    return checks.number("--why-time", asked.why_time, low=0.0)


def _answer_all(
    asked: Asked,
    read: list[ReadProblem],
    prepare: Prepare,
    find: Find,
    typed: Mapping[str, object],
    why: float | None = None,
) -> int:
    """Answer all files, on from where the same command was interrupted; return the exit code.

    `typed` are options of one command alone on which its answers depend; `why` are seconds for explaining each.
    """
    solving, output, done, solved, within = asked.solving, asked.output, 0, 0, ""
    problems = [one.problem for one in read]
    total = sum(max(1, len(problem.waypoints)) for problem in problems)
    robots = {problem.file: problem.robot for problem in problems}
    for file, robot in robots.items() if output.columns is not None else ():
        with checks.in_file(file):
            checks.names_of("--columns", names_in(output.columns), column_names(robot))
    with _journal(problems, asked, typed) as journal, remembered(solving.memory, robots) as memory:
        say_notes({problem.file: problem.notes for problem in problems})
        ready = partial(_prepare, solving, prepare, memory)
        try:
            ahead = 0.0 if len(read) == 1 else _compile(problems, ready)
            with AnswerWriter(output, len(read)) as answers, ProgressBar(total) as bar:
                for one in read:
                    with bar.hidden():
                        prepared, seconds = ready(one.problem)
                    found = find(prepared, one.problem, journal, bar.advance)
                    with bar.hidden():
                        if isinstance(found, Motion) and found.notes:
                            say_notes({one.problem.file: found.notes})
                        answers.write(one.problem.file, found, one.seconds + seconds + ahead, why)
                    ahead = 0.0
                    if isinstance(found, Motion) and found.remaining and found.status is not Status.START_BLOCKED:
                        tried = len(found.solutions)
                        within = f", with {tried} of {tried + found.remaining} waypoints of {one.problem.file}"
                        raise KeyboardInterrupt
                    done += 1
                    solved += found.solved
        except KeyboardInterrupt:
            on = ", the same command goes on" if journal else ""
            said = f"sinuous: interrupted after {done} of {len(read)} files{within}"
            typer.echo(f"{said}; the results so far are written{on}", err=True)
            return INTERRUPTED
        if journal is not None:
            journal.remove()
    return SOLVED if solved == len(read) else UNSOLVED


def _journal(
    problems: list[Job], asked: Asked, typed: Mapping[str, object]
) -> "AbstractContextManager[Journal | None]":
    """Return a journal where answers go into a file."""
    if asked.output.file is None:
        return nullcontext()
    from sinuous.cli.journal import Journal, record_of  # noqa: PLC0415

    return Journal(asked.output.file, record_of(problems, asked.solving, typed))


def _compile(problems: list[Job], ready: Callable[[Job], tuple[Any, float]]) -> float:
    """Compile what any of several problems needs, before the first is answered; return the seconds that it took."""
    kinds = {(len(problem.scene) > 0, bool(problem.prefer)): problem for problem in problems}
    return sum(ready(problem)[1] for problem in kinds.values())


def _prepare(solving: Remembering, prepare: Prepare, memory: Memory | None, problem: Job) -> tuple[Any, float]:
    began = clock.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousInput)  # the notes say it
        prepared = prepare(problem, **{**solving.arguments(problem.tolerance, problem.prefer), "memory": memory})
    return prepared, clock.perf_counter() - began


def _once(
    journal: "Journal | None",
    advance: Callable[[], None],
    read: Callable[[dict[str, Any]], Any],
    find: Callable[[], Any],
    write: Callable[[Any], dict[str, Any]],
) -> Any:
    """Return the answer that is in the journal; where there is none, find it, and keep it there."""
    kept = _read(journal, read)
    answer = kept[0] if kept else find()
    if journal is not None and not kept:
        journal.add(partial(write, answer))
    advance()
    return answer


def _solve(solver: Solver, problem: Job, journal: "Journal | None", advance: Callable[[], None]) -> Solution:
    """Meet the target."""
    asked = problem.waypoints[0], problem.start
    read, find = partial(read_solution, solver, *asked), partial(solver.solve, *asked)
    solution: Solution = _once(journal, advance, read, find, write_solution)
    return solution


def _solve_all(
    count: int, by: Kind | None, solver: Solver, problem: Job, journal: "Journal | None", advance: Callable[[], None]
) -> Alternatives:
    """Find several solutions."""
    asked = problem.waypoints[0], problem.start

    def read(values: dict[str, Any]) -> Alternatives:
        best, *found = (read_solution(solver, *asked, each) for each in values["solutions"])
        return Alternatives(tuple(found), best, values["seconds"])

    def find() -> Alternatives:
        began = clock.perf_counter()
        found = solver.solve_all(*asked, count=count, by=by)
        best = found[0] if found else solver.solve(*asked)
        return Alternatives(tuple(found), best, clock.perf_counter() - began)

    def write(answer: Alternatives) -> dict[str, Any]:
        solutions = [write_solution(each) for each in (answer.best, *answer.solutions)]
        return {"solutions": solutions, "seconds": answer.seconds}

    answer: Alternatives = _once(journal, advance, read, find, write)
    return answer


def _plan(
    timed: Timed, planner: Planner, problem: Job, journal: "Journal | None", advance: Callable[[], None]
) -> Motion:
    """Plan the motion."""
    assert problem.start is not None
    find = partial(planner.plan, problem.start, problem.ends)
    return _in_time(_once(journal, advance, partial(motion_of, problem), find, Motion.to_dict), problem, timed)


def _track(
    timed: Timed, tracker: Tracker, problem: Job, journal: "Journal | None", advance: Callable[[], None]
) -> Motion:
    """Follow the path, on from where the journal ends; when interrupted, return what is there."""
    count = len(problem.waypoints)
    kept: list[TrackedWaypoint] = _read(journal, lambda values: read_entry(values, len(problem.robot)))

    def progress(_: Solution) -> None:
        waypoint = tracker.tried - 1
        if journal is not None and waypoint >= len(kept):
            journal.add(lambda: write_entry(tracker.entry(waypoint)))
        advance()

    try:
        tracker.follow(problem.waypoints, kept, progress)
    except KeyboardInterrupt:
        if tracker.tried in (0, count):
            raise
    pace, times = _paces(problem, timed)
    return _in_time(pace.kept(tracker.motion(count - tracker.tried, times)), problem, timed)


def _in_time(motion: Motion, problem: Job, timed: Timed) -> Motion:
    """Pass a motion as fast as rates and accelerations allow, where that is asked for."""
    if not timed.timed or len(motion.configuration) < 2:
        return motion
    with checks.in_file(problem.file):
        return motion.timed(problem.rates, timed.blend or 0.0).as_motion()


def _read(journal: "Journal | None", read: Callable[[dict[str, Any]], Any]) -> list[Any]:
    """Begin with the next problem, and read its entries in the journal."""
    if journal is None:
        return []
    try:
        return [read(values) for values in journal.begin()]
    except (KeyError, TypeError, ValueError, IndexError):  # an InputError is a ValueError
        raise journal.unreadable() from None
