"""`python -m benchmarks corpus`: some thousand problems with their answers, to hold a change of form to the last bit.

    python -m benchmarks corpus write FILE        # with the code before: asks everything, and keeps the answers
    python -m benchmarks corpus write FILE        # once more, best beside load: drops what depends on the clock
    python -m benchmarks corpus compare FILE      # with the code after: exit code 1 where an answer differs

Problems are those of the experiments, made from seeds; budgets are numbers of starts and draws, and of seconds so many
that they never decide. Last bits depend on the processor and on the versions of NumPy and Numba: files are of one
machine, and not committed.

What an answer is made of is public. Sentences and messages may change: they are not compared.
An answer that differs is looked at by the judges of the other experiments, where these can: whether it is still right.
"""

import contextlib
import gzip
import inspect
import io
import json
import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from enum import Enum
from functools import cached_property, partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer

import sinuous as sn
from benchmarks import derivatives
from benchmarks.harness import chosen, in_processes
from benchmarks.judges.judge import wrong_in
from benchmarks.motion import known, moving, p5
from benchmarks.places import FAMILIES, Place, make
from benchmarks.places.place import right
from benchmarks.problems import full_poses, paper_poses
from benchmarks.real import captured_robot, rows_of
from benchmarks.wild import calls, experiment, worlds
from sinuous.cli.app import main as sinuous

SLOW = 3.0
"""Seconds after which an answer is not kept: budgets are several times as long, so that no clock decides anything."""

SHOWN, WIDE = 3, 160
"""Problems, and differences of each, that are shown of a piece; and characters of a value."""

DIFFERS = 1

BUDGET: dict[str, Any] = {"time": 30.0, "max_starts": 40}
"""Of a solve: the starts decide, not the seconds."""

FEW: dict[str, Any] = {"time": 30.0, "max_starts": 6}
"""The same where many problems are impossible."""

LEFT_OUT = (
    *("robot", "scene", "problem", "motor", "seconds", "prepare_seconds", "version"),
    *("sentence", "misses", "untried", "notes", "note", "deciding"),
)
"""What answers name of their questions, what no two runs, or versions, have in common, and what is said in words."""

NOUNS = (sn.Robot, sn.Scene)
"""What is told as it is in files."""

ROOT = Path(__file__).parents[1]

CHANGING = re.compile(rf"/[^\s']*/tmp\w{{8}}|{re.escape(str(ROOT))}|0x[0-9a-f]+")
"""What texts hold of one run: a folder for the time being, where the repository is, an address."""


class Problem(NamedTuple):
    """A question, its name within its piece, and whether independent judges find an answer right, where they can."""

    name: str
    ask: Callable[[], Any]
    right: Callable[[Any], bool] | None = None


class Difference(NamedTuple):
    """Where two answers differ: the way there, and what each has; `None` where it has nothing."""

    key: str
    before: Any
    after: Any

    @property
    def relative(self) -> float:
        """Of two numbers, the difference over the larger of them; else infinite."""
        numbers = [each for each in (self.before, self.after) if isinstance(each, int | float)]
        if len(numbers) < 2 or not np.isfinite(numbers).all():
            return np.inf
        return abs(numbers[0] - numbers[1]) / max(*map(abs, numbers), 1e-300)


def plain(value: Any) -> Any:
    """Return the plain values of an answer: of JSON, floats to the last bit."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Enum):
        value = value.value
    if isinstance(value, str):
        return CHANGING.sub("...", value)
    if value is None or isinstance(value, bool | int | float):
        return value
    names = getattr(value, "_fields", None)
    if names is not None:
        entries: Mapping[Any, Any] = {name: getattr(value, name) for name in names}
    elif isinstance(value, list | tuple):
        return [plain(each) for each in value]
    elif isinstance(value, Mapping):
        entries = value
    else:
        entries = value.to_dict() if isinstance(value, NOUNS) else dict(_public(value))
    return {str(key): plain(each) for key, each in entries.items() if key not in LEFT_OUT}


def _public(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield the public attributes of an answer, with their names, but for those that it refuses."""
    members = inspect.getmembers_static(type(value))
    own = {name for name, each in members if not inspect.isroutine(each) or isinstance(each, cached_property)}
    for name in sorted(own | getattr(value, "__dict__", {}).keys()):
        if not name.startswith("_") and name not in LEFT_OUT:
            with contextlib.suppress(sn.InputError, sn.NotSolvedError):
                yield name, getattr(value, name)


def differences(before: Any, after: Any, key: str = "") -> Iterator[Difference]:
    """Yield where plain values differ; NaN is equal to NaN, and 0.0 is not -0.0."""
    if isinstance(before, dict) and isinstance(after, dict):
        for name in {**before, **after}:
            yield from differences(before.get(name), after.get(name), f"{key}.{name}" if key else name)
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for i, (one, other) in enumerate(zip(before, after, strict=True)):
            yield from differences(one, other, f"{key}[{i}]")
    elif repr(before) != repr(after):
        yield Difference(key, before, after)


def places(names: Sequence[str]) -> Iterator[Problem]:
    """Solve in intricate places."""
    for name in names:
        for seed in range(4):
            place = make(name, seed)
            ask = partial(sn.solve, place.robot, place.targets, place.scene, tolerance=place.tolerance, **BUDGET)
            yield Problem(f"{name} {seed}", ask, partial(_right_in_place, place))


def _right_in_place(place: Place, found: sn.Solution) -> bool:
    return found.solved and right(place, found.configuration)


def wild(make: Callable[[int, int], worlds.World], count: int) -> Iterator[Problem]:
    """Solve the first problems of wild worlds, each with one solver; plan between shapes that are hidden there."""
    for number in range(count):
        world = make(0, number)
        solver = sn.Solver(world.robot, world.scene, tolerance=world.tolerance, **(BUDGET if world.possible else FEW))
        for i, targets in enumerate(world.targets[:6]):
            yield Problem(f"{number}.{i}", partial(solver.solve, targets), partial(_right_in_world, world, i))
        plan = partial(sn.plan, world.robot, world.hidden[0], world.hidden[-1], world.scene, time=20.0)
        yield Problem(f"{number} planned", plan, None if world.loaded else _clear)


def _right_in_world(world: worlds.World, i: int, found: sn.Solution) -> bool:
    return not experiment.refuted(world, {i: found})[i]


def _clear(motion: sn.Motion) -> bool:
    return motion.between != "proved" or not wrong_in(motion.robot, sn.Scene.of(motion.scene), motion.configuration)


def methods() -> Iterator[Problem]:
    """Every method on problems of the literature and on random ones, from one start and from ten."""
    sets = {
        "paper": paper_poses(),
        "full poses": full_poses(0, 12),
        **{f"clutter {i}": worlds.clutter(i, 8) for i in range(4)},
    }
    for name, problems in sets.items():
        for method in calls.METHODS:
            for starts in (1, 10):
                options: dict[str, Any] = {"method": method, "max_starts": starts, "time": 30.0, "routes": starts > 1}
                for i, target in enumerate(problems.targets):
                    ask = partial(sn.solve, problems.robot, target, problems.scene, tolerance=problems.tolerance)
                    yield Problem(f"{name} {i}, {method}, {starts} starts", partial(ask, **options))


def plans() -> Iterator[Problem]:
    """From one shape to another: among spheres, in places where a motion is known, and past what moves."""
    for segments, count in ((3, 24), (4, 16), (6, 8)):
        for number in range(count):
            pair = p5.draw(segments, 1, number, 0)
            ask = partial(sn.plan, pair.robot, pair.start, pair.goal, pair.scene, time=20.0)
            yield Problem(f"{segments} segments {number}", ask, _clear)
            yield Problem(f"{segments} segments {number}, shortened", partial(ask, shortcuts=5), _clear)
    for family in known.FAMILIES:
        place = known.make(family, 0)
        ask = partial(sn.plan, place.robot, place.knots[0], place.knots[-1], place.scene, time=20.0)
        yield Problem(family, ask, _clear)
    for seed in range(24):
        robot, scene, start, goal = moving.draw(seed)
        ask = partial(sn.plan, robot, start, goal, scene, time=20.0)
        yield Problem(f"moving {seed}", partial(ask, rates=sn.Rates(moving.BEND, moving.LENGTH)), _clear_in_time)
        yield Problem(f"moving {seed}, in time", partial(ask, duration=moving.DURATION), _clear_in_time)


def _clear_in_time(motion: sn.Motion) -> bool:
    return motion.solved and not moving.judged(motion)


def called(what: str) -> Iterator[Problem]:
    """Ask odd robots in odd scenes for everything that is public, a kind of call each."""
    for number in range(60):
        yield Problem(f"{number}", partial(_called, what, number))


def _called(what: str, number: int) -> Any:
    return calls.CALLS[what][0](calls.Drawn(np.random.default_rng([61, number]), patient=True))


def derived() -> Iterator[Problem]:
    """Derivatives of answers with something active, and of shapes under load."""
    for family in derivatives.FAMILIES:
        for i in range(30):
            yield Problem(f"{family} {i}", partial(_derived, family, i))
    for i in range(40):
        yield Problem(f"under load {i}", partial(_derived_under_load, i))


def _derived(family: str, i: int) -> Any:
    found = derivatives.draw(family, np.random.default_rng([51, i]))
    if found is None:
        return None
    own = found.derivative(["target", "base", "lengths", *(["obstacles"] if len(found.problem.scene) else [])])  # type: ignore[list-item]
    return found, found.verify(), own, own.vjp(np.ones_like(found.q)), own.labels("target")


def _derived_under_load(i: int) -> Any:
    found = derivatives.loaded(np.random.default_rng([41, i]))
    return found, found.backbone(6), found.derivative(("loads",)), found.others(4) if i % 4 == 0 else None


def calibrations() -> Iterator[Problem]:
    """Robots of motion capture, fitted as told and by choice."""
    for name in ("v4", "v6"):
        robot = captured_robot(name)
        rows = rows_of(robot, f"{name}_train")
        for fit in (["offsets"], ["lengths", "angles"], ["stretch", "offsets", "circles"], None):
            some = slice(None, None, 40 if fit else 120)
            ask = partial(sn.studies.calibrate, robot, rows.actuators[some], rows.measured[some], fit=fit)
            yield Problem(f"{name}: {', '.join(fit or ['by choice'])}", ask)


def examples() -> Iterator[Problem]:
    """Files of the examples, by the command line, with what is printed as JSON."""
    for file in sorted((ROOT / "examples").glob("*.yaml")):
        verb = {"plan": "plan", "path": "track"}.get(file.stem[:4], "solve")
        yield Problem(f"{verb} {file.name}", partial(_printed, f"{verb} {file} --json --time 20"))
        yield Problem(f"check {file.name}", partial(_printed, f"check {file} --json"))


def _printed(typed: str) -> Any:
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()):
        code = sinuous(typed.split())
    text = out.getvalue()
    return {"code": code, "out": json.loads(text) if text.startswith(("{", "[")) else text}


TRAPS = [name for name, family in FAMILIES.items() if family.trap]
OTHERS = [name for name in FAMILIES if name not in TRAPS]

PIECES: dict[str, Callable[[], Iterator[Problem]]] = {
    **{f"places {i}": partial(places, OTHERS[i::2]) for i in range(2)},
    **{f"traps {i}": partial(places, TRAPS[i::4]) for i in range(4)},
    "wild worlds": partial(wild, worlds.make, 30),
    **{kind: partial(wild, make, 10) for kind, make in worlds.AUDITED.items()},
    "methods": methods,
    "plans": plans,
    **{f"calls of {what}": partial(called, what) for what in calls.CALLS},
    "derivatives": derived,
    "calibrations": calibrations,
    "command line": examples,
}
"""All pieces by name: each yields its problems, the same ones in the same order every time."""

Answers = dict[str, Any]
"""Plain answers by the names of problems."""


class Differing(NamedTuple):
    """A problem whose answer differs: where, and whether judges find the new answer right (None: they cannot say)."""

    name: str
    differences: list[Difference]
    right: bool | None


class Compared(NamedTuple):
    """What came of a piece: the number of problems, which differ, and seconds."""

    problems: int
    differing: list[Differing]
    seconds: float


def answer(problem: Problem) -> tuple[Any, Any]:
    """Ask; return the answer, and what is kept of it: of an exception its kind, and what it says."""
    try:
        found = problem.ask()
        return found, json.loads(json.dumps(plain(found)))
    except Exception as error:  # that too has to stay as it is
        kind = "InputError" if isinstance(error, sn.InputError) else type(error).__name__  # some are TypeErrors, too
        return None, {"raises": kind}


def written(piece: str) -> tuple[Answers, list[str]]:
    """Answer all problems of a piece; return the answers, and the names of those that took too long to be kept."""
    answers, slow = Answers(), list[str]()
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
    began, left = perf_counter(), dict(before)
    differing = list[Differing]()
    for problem in PIECES[piece]():
        if problem.name not in left:
            continue
        found, after = answer(problem)
        if apart := list(differences(left.pop(problem.name), after)):
            fine = None if found is None or problem.right is None else problem.right(found)
            differing.append(Differing(problem.name, apart, fine))
    differing += [Differing(name, [Difference("", "a problem", "none")], None) for name in left]
    return Compared(len(before), differing, perf_counter() - began)


def lines_of(piece: str, one: Compared) -> Iterator[str]:
    """Say what differs in a piece."""
    equal = one.problems - len(one.differing)
    yield f"{piece:<32}{one.problems:>9}{equal:>9}{len(one.differing):>11}{one.seconds:>9.0f}"
    rights = [each.right for each in one.differing if each.right is not None]
    if rights:
        yield f"    judges find {sum(rights)} of {len(rights)} that differ right"
    for each in one.differing[:SHOWN]:
        worst = max(d.relative for d in each.differences)
        yield f"    {each.name}: {len(each.differences)} values differ, by at most {worst:.2g} of themselves"
        yield from (f"        {d.key}: {_short(d.before)} -> {_short(d.after)}" for d in each.differences[:SHOWN])


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


File = Annotated[Path, typer.Argument(help="Answers, of this machine.")]
Alone = Annotated[bool, typer.Option("--alone", help="In this process, instead of one for each core.")]
Pieces = Annotated[list[str] | None, typer.Option("--piece", help="Only this one, or those that a pattern fits.")]

app = typer.Typer(add_completion=False, rich_markup_mode=None, help="Hold answers to the last bit to earlier ones.")


@app.command()
def write(file: File, piece: Pieces = None, alone: Alone = False) -> None:
    """Write the answers of this code. Of pieces that FILE has already, drop from it what differs now."""
    before, asked = read(file) if file.exists() else {}, chosen(list(PIECES), piece or ["*"])
    names = [name for name in PIECES if name in asked]
    for name, (answers, slow) in zip(names, in_processes(written, names, alone), strict=True):
        old = before.get(name, answers)
        dropped = slow if old is answers else [key for key in old if repr(old[key]) != repr(answers.get(key))]
        kept = {key: each for key, each in old.items() if key not in dropped}
        with gzip.open(file, "at", encoding="utf-8") as lines:
            lines.write(json.dumps({"piece": name, "answers": kept}) + "\n")
        said = f"   {len(dropped)} dropped: {'; '.join(dropped)}" if dropped else ""
        typer.echo(f"{name:<32}{len(kept):>9}{said}")


@app.command()
def compare(file: File, piece: Pieces = None, alone: Alone = False) -> None:
    """Compare the answers of this code with those of FILE: exit code 1 where any differs."""
    answers, asked = read(file), chosen(list(PIECES), piece or ["*"])
    names, absent = ([name for name in PIECES if name in asked and (name in answers) is held] for held in (True, False))
    typer.echo(f"{'piece':<32}{'problems':>9}{'equal':>9}{'different':>11}{'seconds':>9}")
    found = []
    for name, one in zip(names, in_processes(_compared, [(name, answers[name]) for name in names], alone), strict=True):
        found.append(one)
        typer.echo("\n".join(lines_of(name, one)))
    total, differing = sum(one.problems for one in found), sum(len(one.differing) for one in found)
    typer.echo(f"{total} problems, {differing} different{'; not in FILE: ' if absent else ''}{'; '.join(absent)}")
    raise typer.Exit(DIFFERS if differing else 0)


def _compared(asked: tuple[str, Answers]) -> Compared:
    return compared(*asked)
