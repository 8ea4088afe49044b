"""What all experiments share: lines and tables of them, parts and plans, processes, the frame around a run.

From the ground up: one figure, with its goal and its times, and tables of these; the machine that figures come from;
what an experiment is; work in as many processes as there are cores; and the frame around every experiment (packages,
journal, progress, interrupt, and where the results go).
"""

import hashlib
import json
import math
import multiprocessing
import os
import pickle
import platform
import signal
import subprocess
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from datetime import datetime
from fnmatch import fnmatchcase
from functools import cache, partial
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from itertools import chain
from multiprocessing.queues import SimpleQueue
from pathlib import Path
from time import perf_counter, thread_time
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike
from rich.console import Console
from rich.progress import Progress

import benchmarks
import sinuous
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.base.system import pool_of
from sinuous.kernels.compile import cores
from sinuous.scene import sampling


@dataclass(frozen=True)
class Times:
    """Seconds of many runs, in short.

    Attributes
    ----------
    count : int
    median, p95, p99, worst : float
    """

    count: int
    median: float
    p95: float
    p99: float
    worst: float

    @classmethod
    def of(cls, seconds: ArrayLike) -> "Times":
        """Summarise at least one run."""
        values = np.asarray(seconds, np.float64)
        median, p95, p99 = np.percentile(values, [50, 95, 99]).tolist()
        return cls(len(values), median, p95, p99, float(values.max()))


Answer = TypeVar("Answer")


def timed(
    work: Callable[..., Answer], *given: Any, runs: int = 1, clock: Callable[[], float] = perf_counter, **options: Any
) -> tuple[Answer, float]:
    """Do something so often; return what came of it, and the least seconds that it took."""
    least = math.inf
    for _ in range(runs):
        began = clock()
        answer = work(*given, **options)
        least = min(least, clock() - began)
    return answer, least


UNITS = {"s": 1.0, "ms": 1e3, "us": 1e6}
"""Units of time, and how many of them a second has; other units are those of the number itself."""


@dataclass(frozen=True)
class Goal:
    """What a line is measured against.

    Attributes
    ----------
    value : float
        Bound, inclusive.
    at_most : bool
        Whether less is better.
    correctness : bool
        Whether missing it means that something is wrong, not merely slow.
    """

    value: float
    at_most: bool = True
    correctness: bool = False

    def held(self, reached: float) -> bool:
        """Whether a value is on the right side."""
        return reached <= self.value if self.at_most else reached >= self.value


class Trial(NamedTuple):
    """What came of a call: its number, seconds, status, what a judge found wrong (or ""), and what start won."""

    number: int | str
    seconds: float
    status: str
    wrong: str = ""
    start: str = ""

    def good(self, limit: float) -> bool:
        """Whether it says so within the limit (s), and no judge objects."""
        return self.status == "solved" and not self.wrong and self.seconds <= limit


@dataclass(frozen=True)
class Line:
    """One figure, its goal, and the times that it came from.

    Attributes
    ----------
    section, what : str
        Where it belongs, and what it is; together its name.
    reached : float
        In seconds where `unit` is one of time.
    unit : str
    goal : Goal, optional
    times : Times, optional
    solved : (int, int), optional
        How many answers the judge confirmed, out of how many.
    note : str
        How it was measured, or seeds that reproduce what went wrong.
    """

    section: str
    what: str
    reached: float
    unit: str = "us"
    goal: Goal | None = None
    times: Times | None = None
    solved: tuple[int, int] | None = None
    note: str = ""

    @property
    def held(self) -> bool | None:
        """Whether the goal is held; `None` where there is none."""
        return None if self.goal is None else self.goal.held(self.reached)

    @property
    def verdict(self) -> str:
        """One word for the table."""
        if self.goal is None:
            return ""
        return "held" if self.held else ("WRONG" if self.goal.correctness else "missed")


def counted(
    planned: str, false: str, what: str, trials: Sequence[Trial], limit: float, share: float | None = None
) -> Iterator[Line]:
    """Count what is planned within the limit (s), of which a share (%) may be wanted, and what a judge refutes."""
    names = missed(trials, limit)
    yield solved_within(limit, planned, what, trials, share, f"not within {limit:g} s: {names}" if names else "")
    yield refuted(false, what, {"": trials})


def solved_within(
    limit: float, section: str, what: str, trials: Sequence[Trial], share: float | None = None, note: str = ""
) -> Line:
    """Count what is solved within the limit (s) and found right, of which a share (%) may be wanted."""
    good, goal = sum(trial.good(limit) for trial in trials), None if share is None else Goal(share, at_most=False)
    times = Times.of([trial.seconds for trial in trials])
    return Line(section, what, 100.0 * good / len(trials), "%", goal, times, (good, len(trials)), note)


def missed(trials: Sequence[Trial], limit: float) -> str:
    """Name what is not solved within the limit (s) or found wrong, each with what is wrong, or else its status."""
    return listed([f"{trial.number} ({trial.wrong or trial.status})" for trial in trials if not trial.good(limit)])


def refuted(false: str, what: str, found: Mapping[str, Sequence[Trial]]) -> Line:
    """Count what a judge refutes, and name it: by number, of kinds that have names also by these."""
    named = [f"{name} {trial.number} ({trial.wrong})" for name, own in found.items() for trial in own if trial.wrong]
    return Line(false, what, len(named), "", Goal(0, correctness=True), note=listed(named).strip())


SHOWN = 40
"""Most names in a note."""


def listed(names: Sequence[str | int]) -> str:
    """Say the first names, and how many more there are."""
    return ", ".join(map(str, names[:SHOWN])) + (f" and {len(names) - SHOWN} more" if len(names) > SHOWN else "")


def table(rows: Sequence[Sequence[str]], *, words: bool = False) -> str:
    """Return a table whose first row is its headings: the first column to the left, others to the right.

    With `words` all columns stand to the left.
    """
    widths = [max(3, *(len(row[column]) for row in rows)) for column in range(len(rows[0]))]
    left = [words or column == 0 for column in range(len(widths))]
    ruler = ["-" * width if first else "-" * (width - 1) + ":" for width, first in zip(widths, left, strict=True)]
    lines = []
    for row in [rows[0], ruler, *rows[1:]]:
        placed = zip(row, widths, left, strict=True)
        cells = [cell.ljust(width) if first else cell.rjust(width) for cell, width, first in placed]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


HEADINGS = ["what", "goal", "reached", "", "solved", "runs", "median", "p95", "p99", "worst"]


def tables_of(lines: Sequence[Line]) -> list[str]:
    """One table a section, then the notes of its lines; at the end how many goals were held."""
    if not lines:
        return []
    parts = []
    for section in dict.fromkeys(line.section for line in lines):
        own = [line for line in lines if line.section == section]
        parts += [f"## {section}", table([HEADINGS, *map(_row, own)])]
        parts += [f"{line.what}: {line.note}" for line in own if line.note]
    held = [line.held for line in lines if line.goal is not None]
    return [*parts, f"{held.count(True)} of {len(held)} goals held."]


def _row(line: Line) -> list[str]:
    goal = "" if line.goal is None else f"{'<=' if line.goal.at_most else '>='} {number(line.goal.value, line.unit)}"
    solved = "" if line.solved is None else f"{line.solved[0]}/{line.solved[1]}"
    return [line.what, goal, number(line.reached, line.unit), line.verdict, solved, *_times(line)]


def _times(line: Line) -> list[str]:
    if line.times is None:
        return [""] * 5
    t = line.times
    unit = line.unit if line.unit in UNITS else ("us" if t.median < 1e-3 else "ms")
    return [str(t.count), *(number(value, unit) for value in (t.median, t.p95, t.p99, t.worst))]


def number(value: float, unit: str) -> str:
    """Text of a value, times in seconds, in its unit."""
    scaled = value * UNITS.get(unit, 1.0)
    if not math.isfinite(scaled):
        return "none"
    digits = 5 if unit == "%" and scaled > 99.0 else 3  # what is not quite all
    text = f"{scaled:.0f}" if scaled == round(scaled) or abs(scaled) >= 1000 else f"{scaled:.{digits}g}"
    return f"{text} {unit}".strip()


LOOK = 0.05
"""Seconds of a look at how busy the machine is."""

PACKAGES = ("numpy", "scipy", "numba", "casadi", "libigl", "ompl")


def describe() -> dict[str, str]:
    """Processor, system, versions, commit and date, as text."""
    return {
        "date": datetime.now().astimezone().isoformat(timespec="seconds"),
        "processor": _processor(),
        "cores": str(cores()),
        "system": platform.platform(),
        "python": platform.python_version(),
        "sinuous": sinuous.__version__ + _commit(),
        **{name: _version(name) for name in PACKAGES},
    }


def busy() -> float:
    """Share of the time in which other processes had the processor, 0 to 1, while this one wanted it."""
    began, worked = perf_counter(), thread_time()
    while (spent := perf_counter() - began) < LOOK:
        pass
    return max(0.0, 1.0 - (thread_time() - worked) / spent)


def _processor() -> str:
    listing = Path("/proc/cpuinfo")
    if listing.exists():
        for line in listing.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _commit() -> str:
    """Commit of the working tree that the package lies in, if it lies in one; a plus marks changes since."""
    asked = ["git", "describe", "--always", "--exclude=*", "--abbrev=12", "--dirty=+"]
    try:
        run = subprocess.run(asked, cwd=Path(__file__).parent, capture_output=True, text=True, check=True, timeout=10)
    except (OSError, subprocess.SubprocessError):
        return ""
    return f" ({run.stdout.strip()})"


@dataclass(frozen=True)
class Plan:
    """A run.

    Attributes
    ----------
    seed : int
    quick : bool
        Whether to cut all counts down, to see in seconds that everything runs.
    """

    seed: int = 0
    quick: bool = False

    def count(self, full: int, quick: int) -> int:
        """Choose between the two sizes of an experiment."""
        return quick if self.quick else full

    def rng(self, *stream: int) -> Generator:
        """Return random numbers of their own for every experiment, which the seed determines."""
        return np.random.default_rng([self.seed, *stream])


Piece = tuple[str, Callable[[], Any]]
"""A name, and what to call: some seconds of work, which an interrupt may cost."""


class Divided(NamedTuple):
    """A measurement in shares, each of which is a piece: an interrupt costs one of them, not all.

    Attributes
    ----------
    shares : list of callable
        Each returns a list that can be pickled.
    summed : callable
        From what all shares have listed, in their order, to the lines. After an interrupt some is missing.
    """

    shares: Sequence[Callable[[], list[Any]]]
    summed: Callable[[list[Any]], Iterable[Line]]


Part = Callable[[Plan], Iterable[Line]]
"""From a plan to the lines of a part of an experiment."""


@dataclass(frozen=True)
class Experiment:
    """Parts that each measure some lines.

    Attributes
    ----------
    name : str
    plan : Plan
    parts : mapping of str to Divided
    protocol : str
        What is counted, and how it is timed, in a sentence for the head of the report.
    total : callable, optional
        From what the shares of each part have listed, by part, to the lines that sum these up.
    """

    name: str
    plan: Plan
    parts: Mapping[str, Divided]
    protocol: str = ""
    total: Callable[[Mapping[str, list[Any]]], Iterable[Line]] | None = None

    @classmethod
    def of(cls, name: str, plan: Plan, measured: Mapping[str, Part]) -> "Experiment":
        """Return one of parts that are measured in one go each."""
        return cls(name, plan, {part: Divided([partial(_listed, own, plan)], list) for part, own in measured.items()})

    def only(self, patterns: Sequence[str]) -> "Experiment":
        """Return the experiment with some of the parts alone; see `chosen`."""
        names = chosen(list(self.parts), patterns)
        return replace(self, parts={name: part for name, part in self.parts.items() if name in names})

    def pieces(self) -> Iterator[Piece]:
        """All shares of all parts."""
        for name, part in self.parts.items():
            yield from zip(_names(name, part), part.shares, strict=True)

    def lines(self, pieces: Mapping[str, Any]) -> list[Line]:
        """Sum up all parts of which something was measured, from the results of pieces by their names."""
        found = {}
        for name, part in self.parts.items():
            if there := [pieces[piece] for piece in _names(name, part) if piece in pieces]:
                found[name] = list(chain.from_iterable(there))
        lines = [line for name, there in found.items() for line in self.parts[name].summed(there)]
        return [*lines, *self.total(found)] if found and self.total is not None else lines


def chosen(names: Sequence[str], patterns: Sequence[str]) -> frozenset[str]:
    """Return the names that are given, or fit a pattern like `P5*`.

    Raises
    ------
    InputError
        Where one fits none.
    """
    found: set[str] = set()
    for pattern in patterns:
        fitting = {name for name in names if name == pattern or fnmatchcase(name, pattern)}
        if not fitting:
            raise InputError("--piece", "", pattern, "a pattern like 'P5*', or one of " + "; ".join(names))
        found |= fitting
    return frozenset(found)


def _listed(measure: Part, plan: Plan) -> list[Line]:
    return list(measure(plan))


def _names(name: str, part: Divided) -> list[str]:
    return [name, *(f"{name}, share {share}" for share in range(1, len(part.shares)))]


Item = TypeVar("Item")
Result = TypeVar("Result")


def ignore_suspicions() -> None:
    """Keep warnings of suspicious input to ourselves: random problems are odd on purpose."""
    warnings.simplefilter("ignore", SuspiciousInput)


def divided(
    plan: Plan,
    work: Callable[[Item], Any],
    items: Sequence[Item],
    together: int,
    summed: Callable[[list[Any]], Iterable[Line]],
) -> Divided:
    """Return the measurement that works on items in processes, so many in one share, and sums up the results."""
    shares = [partial(_worked, work, items[i : i + together], plan.quick) for i in range(0, len(items), together)]
    return Divided(shares, summed)


def _worked(work: Callable[[Item], Result], items: Sequence[Item], alone: bool) -> list[Result]:
    return list(in_processes(work, items, alone))


def in_processes(work: Callable[[Item], Result], items: Iterable[Item], alone: bool = False) -> Iterator[Result]:
    """Yield results in the order of the items, made in as many processes as there are cores, or (`alone`) in this one.

    Every process keeps to a core of its own, where the system lets it. An interrupt is left to the process that
    gathers.
    """
    if alone:
        yield from map(work, items)
        return
    try:
        yield from _pool().map(work, items)
    except (KeyboardInterrupt, GeneratorExit):
        _stop()
        raise


@cache
def _pool() -> ProcessPoolExecutor:
    """Return the processes, which stay until the end: each loads the kernels once."""
    cores = _cores()
    waiting = multiprocessing.get_context("spawn").SimpleQueue()
    for core in cores:
        waiting.put(core)
    return pool_of(len(cores), _begin, waiting)


def _stop() -> None:
    """Let the processes finish what they are at, and end."""
    pool = _pool()
    _pool.cache_clear()
    pool.shutdown(cancel_futures=True)


def _cores() -> list[int]:
    if hasattr(os, "sched_getaffinity"):
        return sorted(os.sched_getaffinity(0))
    return list(range(os.cpu_count() or 1))


def _begin(cores: "SimpleQueue[int]") -> None:
    """Take a core, on which threads that libraries start stay too, and be quiet.

    Samples of places are not kept on disk: nobody asks for them again, and what other scenes have there would go.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    ignore_suspicions()
    sampling.WORTH_KEEPING = math.inf
    core = cores.get()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    os.environ.setdefault("IGL_NUM_THREADS", "1")  # else every process would use all cores


INTERRUPTED = 130

NEEDED = {"igl": "libigl"} | {name: name for name in ("casadi", "distributed", "matplotlib", "trimesh")}
"""Modules that a plain installation does not bring, and the packages that do."""

MOMENTARY = ("date", "sinuous", "casadi")
"""Facts of a machine that may change while an experiment goes on; the hash of the sources stands for the version."""

BUSY = 0.1
"""Share of the processor that other processes may have before times mean little."""


def code_version() -> str:
    """Hash of all sources of library and benchmarks: figures from different code do not belong into one table."""
    digest = hashlib.sha256()
    for folder in (Path(str(package.__file__)).parent for package in (sinuous, benchmarks)):
        for source in sorted(folder.rglob("*.py")):
            digest.update(str(source.relative_to(folder)).encode() + b"\0" + source.read_bytes())
    return digest.hexdigest()[:12]


class Journal:
    """The pieces of one experiment that were measured under the same settings, each in a file.

    Parameters
    ----------
    folder : Path
        Made when it is not there.
    settings : dict
        Plain values, all that the figures depend on: what was measured under others is no part of this experiment.

    Attributes
    ----------
    pieces : dict
        What shares came to, by the names of pieces.
    busy : float
        Largest share of the processor that other processes had before or after one of these, 0 to 1.

    Raises
    ------
    InputError
        When the folder is a file.
    """

    def __init__(self, folder: Path, settings: dict[str, Any]) -> None:
        if folder.exists() and not folder.is_dir():
            raise InputError("--out", "is a file", str(folder), "a folder")
        self._folder = folder / hashlib.sha256(json.dumps(settings).encode()).hexdigest()[:12]
        self._folder.mkdir(parents=True, exist_ok=True)
        kept = [pickle.loads(file.read_bytes()) for file in self._folder.glob("*.piece")]
        self.pieces: dict[str, Any] = {piece: values for piece, values, _ in kept}
        self.busy: float = max((busy for *_, busy in kept), default=0.0)

    def add(self, piece: str, values: Any, busy: float) -> None:
        """Keep what was measured, on disk before this returns."""
        new = self._folder / f"{len(self.pieces)}.new"
        new.write_bytes(pickle.dumps((piece, values, busy)))
        new.replace(new.with_suffix(".piece"))  # whole, whatever stops the computer
        self.pieces[piece], self.busy = values, max(self.busy, busy)


def require() -> None:
    """Refuse to begin without packages.

    Raises
    ------
    InputError
        That names all that are missing.
    """
    missing = [package for module, package in NEEDED.items() if find_spec(module) is None]
    if missing:
        raise InputError("benchmarks", "not installed", missing, "the packages of pip install -e '.[bench]'")


def conduct(experiment: Experiment, folder: Path | None = None, record: Path | None = None) -> int:
    """Measure what the journal of the folder lacks, write the results, and print them.

    Parameters
    ----------
    experiment : Experiment
    folder : Path, optional
        Of journal and results; default: `bench-` and the name of the experiment.
    record : Path, optional
        Folder of pages of results (`docs/results`), in which to keep what was found.

    Returns
    -------
    int
        Exit code: 0 when all claims and every goal of correctness held, whatever the speed; 1 when not; 130 when
        interrupted.

    Raises
    ------
    InputError
        When the folder is a file.
    """
    folder = Path(f"bench-{experiment.name}") if folder is None else folder
    facts, work = describe(), list(experiment.pieces())
    journal = Journal(folder, _settings(experiment, facts))
    lacking = [(name, measure) for name, measure in work if name not in journal.pieces]
    interrupted = True
    try:
        if not lacking:
            _say("all of this was measured before; another --out measures it again")
        for name, measure in _tracked(experiment.name, lacking):
            before = busy()
            journal.add(name, measure(), max(before, busy()))
        interrupted = False
    except KeyboardInterrupt:
        done = sum(name in journal.pieces for name, _ in work)
        _say(f"interrupted after {done} of {len(work)} pieces; the same command goes on from there")
    finally:  # whatever ended it: what was measured until then took minutes
        lines = experiment.lines(journal.pieces)
        text = report(experiment, facts, journal, lines, interrupted)
        (folder / f"{experiment.name}.md").write_text(text, encoding="utf-8")
        if record is not None:
            record.mkdir(parents=True, exist_ok=True)
            (record / f"{experiment.name}.txt").write_text(f"# {experiment.name}\n\n{text}", encoding="utf-8")
        sys.stdout.write(text)
        sys.stdout.flush()
        _say(f"results are in {folder}")
    return INTERRUPTED if interrupted else int(any(line.verdict == "WRONG" for line in lines))


def _tracked(what: str, pieces: Sequence[Piece]) -> Iterator[Piece]:
    """Go through pieces; in a terminal with a bar, drawn between two: a thread would disturb what is timed."""
    console = Console(stderr=True)
    off = not console.is_terminal
    with Progress(console=console, auto_refresh=False, transient=True, disable=off) as progress:
        task = progress.add_task(what, total=len(pieces))
        for piece in pieces:
            yield piece
            progress.update(task, advance=1, refresh=True)


def _settings(experiment: Experiment, facts: dict[str, str]) -> dict[str, Any]:
    return {
        "experiment": experiment.name,
        "seed": experiment.plan.seed,
        "quick": experiment.plan.quick,
        "protocol": experiment.protocol,
        **{key: value for key, value in facts.items() if key not in MOMENTARY},
        "code": code_version(),
    }


def report(
    experiment: Experiment, facts: dict[str, str], journal: Journal, lines: Sequence[Line], interrupted: bool
) -> str:
    """Return what was found and where, as Markdown."""
    plan = experiment.plan
    shown = {**facts, "seed": str(plan.seed)}
    if experiment.protocol:
        shown["protocol"] = experiment.protocol
    parts = ["\n".join(f"- {key}: {value}" for key, value in shown.items() if value != "not installed")]
    if plan.quick:
        parts.append("A quick run: counts are cut down, figures mean little.")
    if journal.busy > BUSY:
        parts.append(
            f"BUSY: other processes had up to {100.0 * journal.busy:.0f} % of the processor while this was measured; "
            "times mean little."
        )
    parts += tables_of(lines)
    if interrupted:
        parts.append("Interrupted: this is what was measured until then.")
    return "\n\n".join(parts) + "\n"


def _say(message: str) -> None:
    sys.stderr.write(f"benchmarks: {message}\n")
