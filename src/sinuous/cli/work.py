"""The commands solve, track and plan: read everything, then answer one file after the other."""

import time as clock
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import typer

from sinuous import checks
from sinuous.cli.answers.alternatives import Alternatives
from sinuous.cli.answers.asked import asked_of
from sinuous.cli.answers.journal import Journal
from sinuous.cli.answers.output import Answer, Output
from sinuous.cli.options import Options
from sinuous.cli.reading import Read, read_all, say_notes
from sinuous.errors import InputError
from sinuous.files.problem_file import ProblemFile
from sinuous.methods.registry import Choice
from sinuous.motion.configurations import check_limits
from sinuous.motion.following.entries import read_entry, write_entry
from sinuous.motion.following.tracker import Tracker
from sinuous.motion.job import motion_of, rates_in_time
from sinuous.motion.motion import Motion
from sinuous.motion.plan import MOST_SHORTCUTS, Planner
from sinuous.motion.track import read_deviation, timetable_of, wish
from sinuous.problem.suspicions import SuspiciousInput
from sinuous.progress import ProgressBar
from sinuous.solution.solution import Solution
from sinuous.solution.status import Status
from sinuous.solving.several import KINDS, Kind
from sinuous.solving.solver import Solver

SOLVED, UNSOLVED, INTERRUPTED = 0, 1, 130

MOST_ALTERNATIVES = 10_000

Question = Callable[[Any, ProblemFile, ProgressBar], Answer]
"""Asks what was prepared for a problem file."""

Prepared = Callable[..., Solver | Planner]
"""Prepares what is asked: a solver or a planner, of a problem file and options."""


def solve_files(files: list[str], options: Options, count: int | None = None, by: str | None = None) -> int:
    """Solve the target of every file, or find up to `count` solutions by route or shape; return the exit code."""
    options.check(files)
    kind = None if by is None else checks.choice("--by", by, KINDS)
    if by is not None and count is None:
        raise InputError("--by", "is for --all", by, "--all COUNT beside it")
    if count is not None:
        checks.integer("--all", count, 1, MOST_ALTERNATIVES)
        if options.why:
            raise InputError("--all", "stands beside --why", count, "one of --all, --why")
    read = read_all(files)
    for one in read:
        _refuse(one.problem, "path", "goal", "moving")
    alone = len(read) == 1 and count is None
    question = _solve if count is None else partial(_solve_all, count, kind)
    return _answer_all(read, options, question, partial(_solver, Solver.once if alone else Solver))


def track_files(files: list[str], options: Options, deviation: float | None = None) -> int:
    """Follow the path of every file; a single target is a path of one waypoint. Return the exit code."""
    options.check(files)
    if deviation is not None:
        checks.number("--deviation", deviation, above=0.0)
    read = [Read(with_room(one.problem, options.choice()), one.seconds) for one in read_all(files)]
    for one in read:
        _refuse(one.problem, "goal")
    asked = asked_of([one.problem for one in read], options, {"--deviation": str(deviation)})
    return _answer_on(read, options, partial(_track, deviation), _solver_at_first, asked)


def _solver(kind: Callable[..., Solver], problem: ProblemFile, **options: Any) -> Solver:
    return kind(problem.robot, problem.scene, **options)


def _solver_at_first(problem: ProblemFile, **options: Any) -> Solver:
    """Prepare a solver among obstacles as they are before they move."""
    scene = problem.scene
    return Solver(problem.robot, scene.at(0.0) if scene.snapshot().moves else scene, **options)


def with_room(problem: ProblemFile, method: Choice) -> ProblemFile:
    """Let a problem that says nothing of preferences wish for room on the way."""
    return problem if problem.prefer else problem.preferring(wish(problem.robot, method))


def plan_files(
    files: list[str], options: Options, *, shortcuts: int = 0, begin: float = 0.0, duration: float | None = None
) -> int:
    """Plan the motion that every file asks for; return the exit code."""
    options.check(files)
    checks.integer("--shortcuts", shortcuts, 0, MOST_SHORTCUTS)
    checks.number("--begin", begin)
    if duration is not None:
        checks.number("--duration", duration, above=0.0)
    read = read_all(files)
    for problem in (one.problem for one in read):
        _refuse(problem, "path")
        if problem.start is None:
            raise InputError("start", "missing", None, "where the motion begins", problem.file)
        if problem.goal is not None:
            try:
                check_limits(problem.robot, "goal", problem.goal)
            except InputError as error:
                raise error.in_file(problem.file) from None
    typed: dict[str, Any] = {"shortcuts": shortcuts, "begin": begin, "duration": duration}
    asked = asked_of([one.problem for one in read], options, {f"--{key}": str(value) for key, value in typed.items()})
    return _answer_on(read, options, _plan, partial(_planner, **typed), asked)


def _planner(problem: ProblemFile, **options: Any) -> Planner:
    """Prepare a planner; the rates of a file count where obstacles move."""
    try:
        return Planner(problem.robot, problem.scene, rates=rates_in_time(problem), **options)
    except InputError as error:
        raise error.in_file(problem.file) from None


def _refuse(problem: ProblemFile, *kinds: str) -> None:
    """Refuse a file that asks what is for another command."""
    if "path" in kinds and problem.is_path:
        what = "is for the command track"
        raise InputError("path", what, len(problem.waypoints), "target or targets", problem.file)
    if "moving" in kinds and problem.scene.snapshot().moves:
        which = next(iter(problem.scene.snapshot().courses))
        name = problem.scene.name(which)
        raise InputError("scene", f"{name} moves", name, "obstacles that stand still, or track or plan", problem.file)
    if "goal" in kinds and problem.goal is not None:
        raise InputError("goal", "is for the command plan", problem.goal.tolist(), "target or targets", problem.file)


def _answer_on(
    read: list[Read], options: Options, question: Callable[..., Answer], kind: Prepared, asked: dict[str, str]
) -> int:
    """Answer all files, on from where the same command was interrupted."""
    with Journal(options.out or options.csv or options.plot, asked) as journal:
        code = _answer_all(read, options, partial(question, journal), kind, journal)
        if code != INTERRUPTED:
            journal.remove()
    return code


def _answer_all(
    read: list[Read], options: Options, question: Question, kind: Prepared, journal: Journal | None = None
) -> int:
    done = solved = 0
    total = sum(max(1, len(one.problem.waypoints)) for one in read)
    say_notes([one.problem for one in read])
    try:
        ahead = 0.0 if len(read) == 1 else _compile([one.problem for one in read], options, kind)
        with Output(options, len(read)) as output, ProgressBar(total) as bar:
            for one in read:
                with bar.hidden():
                    solver, prepare_seconds = _prepare(one.problem, options, kind)
                found = question(solver, one.problem, bar)
                with bar.hidden():
                    _write(output, one, found, prepare_seconds + ahead)
                ahead = 0.0
                if isinstance(found, Motion) and found.remaining and found.status is not Status.START_BLOCKED:
                    raise KeyboardInterrupt
                done += 1
                solved += found.solved
    except KeyboardInterrupt:
        on = ", the same command goes on" if journal is not None and journal.keeps else ""
        text = f"sinuous: interrupted after {done} of {len(read)} files; the results so far are written{on}"
        typer.echo(text, err=True)
        return INTERRUPTED
    return SOLVED if solved == len(read) else UNSOLVED


def _write(output: Output, one: Read, found: Answer, prepare_seconds: float) -> None:
    """Write an answer, with what explains it where that is wished for; an interrupt meanwhile leaves the answer."""
    asked = one.problem.file, found, one.seconds + prepare_seconds
    try:
        why = found.explain() if output.explains and isinstance(found, Solution) else None
    except KeyboardInterrupt:
        output.write(*asked)
        raise
    output.write(*asked, why)


def _compile(problems: list[ProblemFile], options: Options, kind: Prepared) -> float:
    """Compile what any of several problems needs, before the first is answered; return the seconds that it took."""
    kinds = {(len(problem.scene) > 0, bool(problem.prefer)): problem for problem in problems}
    return sum(_prepare(problem, options, kind)[1] for problem in kinds.values())


def _prepare(problem: ProblemFile, options: Options, kind: Prepared) -> tuple[Solver | Planner, float]:
    began = clock.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SuspiciousInput)  # the notes say it
        given = options.solve_options(problem.tolerance, problem.prefer)
        solver = kind(problem, **given)
    return solver, clock.perf_counter() - began


def _solve(solver: Solver, problem: ProblemFile, bar: ProgressBar) -> Solution:
    solution = solver.solve(problem.waypoints[0], problem.start)
    bar.advance()
    return solution


def _solve_all(count: int, by: Kind | None, solver: Solver, problem: ProblemFile, bar: ProgressBar) -> Alternatives:
    began = clock.perf_counter()
    found = solver.solve_all(problem.waypoints[0], problem.start, count=count, by=by)
    best = found[0] if found else solver.solve(problem.waypoints[0], problem.start)
    bar.advance()
    return Alternatives(tuple(found), best, clock.perf_counter() - began)


def _plan(journal: Journal, planner: Planner, problem: ProblemFile, bar: ProgressBar) -> Motion:
    """Plan the motion, or return the one that is in the journal."""
    assert problem.start is not None
    kept = next(journal.begin(), None)
    if kept is None:
        motion = planner.plan(problem.start, problem.ends)
        journal.add(motion.to_dict)
    else:
        try:
            motion = motion_of(problem, kept)
        except InputError:
            raise journal.unreadable() from None
    bar.advance()
    return motion


def _track(deviation: float | None, journal: Journal, solver: Solver, problem: ProblemFile, bar: ProgressBar) -> Motion:
    """Follow the path, on from where the journal ends; when interrupted, return what is there."""
    waypoints, started = len(problem.waypoints), problem.start is not None
    timetable = timetable_of(problem.scene, problem.times, waypoints, started)
    if timetable is not None:
        solver = Solver.prepared(solver.robot, timetable.live, solver.options)
    tracker, done = Tracker(solver, problem.start, read_deviation(solver, deviation), timetable), 0
    for values in journal.begin():
        try:
            tracker.go_on(problem.waypoints[done], read_entry(values, len(problem.robot)))
        except (KeyError, TypeError, ValueError, IndexError):
            raise journal.unreadable() from None
        done += 1
        bar.advance()
    try:
        for targets in problem.waypoints[done:] if tracker.blocked is None else ():
            tracker.go_to(targets)
            journal.add(partial(_added, tracker, done))
            done += 1
            bar.advance()
    except KeyboardInterrupt:
        if not done:
            raise
    return tracker.motion(len(problem.waypoints) - done, problem.times)


def _added(tracker: Tracker, waypoint: int) -> dict[str, Any]:
    return write_entry(tracker.entry(waypoint))
