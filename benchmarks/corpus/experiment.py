"""Asks the problems of the corpus, in processes, and writes the answers or compares them with those of a file."""

import gzip
import json
import multiprocessing
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from fnmatch import fnmatch
from pathlib import Path
from time import perf_counter, process_time
from typing import Annotated, Any, NamedTuple

import typer

import sinuous as sn
from benchmarks.corpus.answers import Difference, Problem, differences, plain
from benchmarks.corpus.pieces import PIECES
from benchmarks.harness.quiet import ignore_suspicions
from sinuous.cli.app import execute

SLOW = 3.0
"""Seconds after which an answer is not kept: budgets are several times as long, so that no clock decides anything."""

SHOWN = 3
"""Problems, and differences of each, that are shown of a piece."""

WIDE = 160
"""Characters of a value that are shown."""

DIFFERS = 1

Answers = dict[str, Any]
"""Plain answers by the names of problems."""


class Differing(NamedTuple):
    """A problem whose answer differs: where, and whether judges find the new answer right (None: they cannot say)."""

    name: str
    differences: list[Difference]
    right: bool | None


class Compared(NamedTuple):
    """What came of a piece: the number of problems, which differ, of which only words do, and seconds."""

    problems: int
    differing: list[Differing]
    reworded: list[Differing]
    seconds: float


def answer(problem: Problem) -> tuple[Any, Any]:
    """Ask; return the answer, and what is kept of it: of an exception its kind, and what it says."""
    try:
        found = problem.ask()
        return found, plain(found)
    except Exception as error:  # that too has to stay as it is
        kind = "InputError" if isinstance(error, sn.InputError) else type(error).__name__  # some are TypeErrors, too
        return None, {"raises": kind, "words": plain(str(error))}


def written(piece: str) -> tuple[Answers, list[str]]:
    """Answer all problems of a piece; return the answers, and the names of those that took too long to be kept."""
    ignore_suspicions()
    answers: Answers = {}
    slow = []
    for problem in PIECES[piece]():
        began = process_time()
        _, kept = answer(problem)
        if process_time() - began > SLOW:
            slow.append(problem.name)
        else:
            answers[problem.name] = kept
    return answers, slow


def compared(piece: str, before: Answers) -> Compared:
    """Answer the problems of a piece that a file has answers of, and look for differences."""
    ignore_suspicions()
    began = perf_counter()
    left, differing, reworded = dict(before), [], []
    for problem in PIECES[piece]():
        if problem.name not in left:
            continue
        found, after = answer(problem)
        apart = list(differences(left.pop(problem.name), json.loads(json.dumps(after))))
        if all(each.of_words for each in apart):
            reworded += [Differing(problem.name, apart, None)] if apart else []
            continue
        differing.append(Differing(problem.name, apart, judged(problem, found)))
    differing += [Differing(name, [Difference("", "a problem", "none")], None) for name in left]
    return Compared(len(before), differing, reworded, perf_counter() - began)


def judged(problem: Problem, found: Any) -> bool | None:
    """Whether judges find an answer right; `None` where there is none, or no judge."""
    return None if found is None or problem.right is None else problem.right(found)


def lines_of(piece: str, one: Compared) -> Iterator[str]:
    """Say what differs in a piece."""
    equal = one.problems - len(one.differing)
    yield f"{piece:<22}{one.problems:>9}{equal:>9}{len(one.differing):>11}{len(one.reworded):>11}{one.seconds:>9.0f}"
    rights = [each.right for each in one.differing if each.right is not None]
    if rights:
        yield f"    judges find {sum(rights)} of {len(rights)} that differ right"
    for each in (*one.differing[:SHOWN], *one.reworded[:1]):
        apart = [d for d in each.differences if not d.of_words] or each.differences
        worst = max((d.relative for d in apart), default=0.0)
        yield f"    {each.name}: {len(apart)} values differ, by at most {worst:.2g} of themselves"
        yield from (f"        {d.key}: {_short(d.before)} -> {_short(d.after)}" for d in apart[:SHOWN])


def _short(value: Any) -> str:
    return textwrap.shorten(repr(value), WIDE)


def read(file: Path) -> dict[str, Answers]:
    """Read the answers of a file, by piece; of a piece that was written twice, those of the last time.

    Raises
    ------
    InputError
        When it is no such file.
    """
    try:
        with gzip.open(file, "rt", encoding="utf-8") as lines:
            return {entry["piece"]: entry["answers"] for entry in map(json.loads, lines)}
    except (OSError, ValueError, KeyError) as error:
        raise sn.InputError("FILE", f"cannot be read: {error}", str(file), "one that `corpus write` has made") from None


def chosen(patterns: Sequence[str] | None) -> list[str]:
    """Names of the pieces that fit any of some patterns, by default all.

    Raises
    ------
    InputError
        When a pattern fits none.
    """
    for pattern in patterns or ():
        if not any(fnmatch(name, pattern) for name in PIECES):
            raise sn.InputError("--piece", "", pattern, "a pattern, or one of " + "; ".join(PIECES))
    return [name for name in PIECES if not patterns or any(fnmatch(name, pattern) for pattern in patterns)]


File = Annotated[Path, typer.Argument(help="Answers, of this machine.")]
Pieces = Annotated[list[str] | None, typer.Option("--piece", help="Only this one, or those that a pattern fits.")]
Processes = Annotated[int, typer.Option(min=1, help="How many pieces are asked at once.")]

app = typer.Typer(add_completion=False, rich_markup_mode=None, help="Hold answers to the last bit to earlier ones.")


@app.command()
def write(file: File, piece: Pieces = None, processes: Processes = 2) -> None:
    """Write the answers of this code. Of pieces that FILE has already, drop from it what differs now."""
    known = read(file) if file.exists() else {}
    with _pool(processes) as pool:
        calls = {pool.submit(written, name): name for name in chosen(piece)}
        for call in as_completed(calls):
            name, (answers, dropped) = calls[call], call.result()
            if name in known:
                again = json.loads(json.dumps(answers))
                dropped = [key for key, each in known[name].items() if repr(each) != repr(again.get(key))]
                answers = {key: each for key, each in known[name].items() if key not in dropped}
            with gzip.open(file, "at", encoding="utf-8") as lines:
                lines.write(json.dumps({"piece": name, "answers": answers}) + "\n")
            said = f"   {len(dropped)} dropped: {'; '.join(dropped)}" if dropped else ""
            typer.echo(f"{name:<22}{len(answers):>9}{said}")


@app.command()
def compare(file: File, piece: Pieces = None, processes: Processes = 2) -> None:
    """Compare the answers of this code with those of FILE: exit code 1 where any differs."""
    answers = read(file)
    names = [name for name in chosen(piece) if name in answers]
    typer.echo(f"{'piece':<22}{'problems':>9}{'equal':>9}{'different':>11}{'reworded':>11}{'seconds':>9}")
    total, differing = 0, 0
    for name, one in _compared_in(processes, {name: answers[name] for name in names}):
        total, differing = total + one.problems, differing + len(one.differing)
        typer.echo("\n".join(lines_of(name, one)))
    absent = [name for name in chosen(piece) if name not in answers]
    typer.echo(f"{total} problems, {differing} different{'; not in FILE: ' if absent else ''}{'; '.join(absent)}")
    raise typer.Exit(DIFFERS if differing else 0)


def _pool(processes: int) -> ProcessPoolExecutor:
    spawn = multiprocessing.get_context("spawn")  # threads, as compiled code may have, are not safe to fork
    return ProcessPoolExecutor(processes, spawn, ignore_suspicions)


def _compared_in(processes: int, answers: Mapping[str, Answers]) -> Iterator[tuple[str, Compared]]:
    """Compare pieces, and yield each as soon as it is done; one process is this one."""
    if processes == 1:
        yield from ((name, compared(name, each)) for name, each in answers.items())
        return
    with _pool(processes) as pool:
        calls = {pool.submit(compared, name, each): name for name, each in answers.items()}
        for call in as_completed(calls):
            yield calls[call], call.result()


def run(arguments: Sequence[str] | None = None) -> int:
    """Run a command line, by default that of the process, and return its exit code."""
    return execute(typer.main.get_command(app), "python -m benchmarks corpus", arguments)
