"""What an experiment is: parts whose shares of work are measured, kept as plain values, and summed up as lines.

Its plan says how large a run is, what its random numbers begin with, and how it shows that it is alive; its report says
what was found and where: for people Markdown, for programs JSON.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from fnmatch import fnmatchcase
from functools import partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.random import Generator
from rich.console import Console
from rich.progress import Progress

from benchmarks.harness import parallel
from benchmarks.harness.lines import Line, tables_of
from benchmarks.harness.machine import busy
from sinuous.base.errors import InputError

Item = TypeVar("Item")

_shown: list[str] = []
"""What has a progress bar."""


@dataclass(frozen=True)
class Plan:
    """A run.

    Attributes
    ----------
    seed : int
    quick : bool
        Whether to cut all counts down, to see in seconds that everything runs.
    rounds : int
        Of `wild`, each with fresh problems.
    """

    seed: int = 0
    quick: bool = False
    rounds: int = 1

    def count(self, full: int, quick: int) -> int:
        """Choose between the two sizes of an experiment."""
        return quick if self.quick else full

    def rng(self, *stream: int) -> Generator:
        """Return random numbers of their own for every experiment, which the seed determines."""
        return np.random.default_rng([self.seed, *stream])

    def track(self, items: Iterable[Item], what: str, total: int) -> Iterator[Item]:
        """Go through items with a progress bar, in terminals; what runs within shows none of its own.

        The bar has no thread of its own, which would disturb what is timed: it is drawn between two items.
        """
        console = Console(stderr=True)
        if not console.is_terminal or _shown:
            yield from items
            return
        _shown.append(what)
        try:
            with Progress(console=console, auto_refresh=False, transient=True) as progress:
                task = progress.add_task(what, total=total)
                for item in items:
                    yield item
                    progress.update(task, advance=1, refresh=True)
        finally:
            _shown.clear()


Piece = tuple[str, Callable[[], Any]]
"""A name, and what to call for plain values: some seconds of work, which an interrupt may cost."""


@dataclass
class Findings:
    """What an experiment found.

    Attributes
    ----------
    lines : list of Line
        Figures, to be printed as tables.
    busy : float
        Largest share of the processor that other processes had before or after a piece, 0 to 1.
    """

    lines: list[Line] = field(default_factory=list)
    busy: float = 0.0

    @property
    def correct(self) -> bool:
        """Whether every goal of correctness was held; speed is another matter."""
        return all(line.held is not False for line in self.lines if line.correctness)


class Divided(NamedTuple):
    """A measurement in shares, each of which is a piece: an interrupt costs one of them, not all.

    Attributes
    ----------
    shares : list of callable
        Each returns plain values.
    summed : callable
        From the plain values of shares, in their order, to the lines. After an interrupt some are missing.
    """

    shares: Sequence[Callable[[], Any]]
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
    settings : mapping
        Plain values, all that the figures depend on besides machine, code, seed and size.
    abreast : bool
        Whether shares are done in as many processes as there are cores, each as soon as one is free: no process waits
        for the others between two parts, and what is timed has a core of its own. A quick run uses this process alone.
    """

    name: str
    plan: Plan
    parts: Mapping[str, Divided]
    protocol: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    abreast: bool = False

    @classmethod
    def of(cls, name: str, plan: Plan, measured: Mapping[str, Part]) -> "Experiment":
        """Return one of parts that are measured in one go each."""
        parts = {part: Divided([partial(_plain_lines, measure, plan)], _read) for part, measure in measured.items()}
        return cls(name, plan, parts)

    def only(self, patterns: Sequence[str]) -> "Experiment":
        """Return the experiment with some of the parts alone; see `chosen`."""
        names = chosen(list(self.parts), patterns)
        return replace(self, parts={name: part for name, part in self.parts.items() if name in names})

    def pieces(self) -> Iterator[Piece]:
        """All shares of all parts."""
        for name, part in self.parts.items():
            for piece, share in zip(_names(name, part), part.shares, strict=True):
                yield piece, partial(_measured, share)

    def done(self, pieces: Sequence[Piece]) -> Iterator[tuple[str, Any]]:
        """Do pieces, and yield name and values of each as soon as it is done."""
        if self.abreast and not self.plan.quick:
            yield from parallel.as_done(pieces)
        else:
            yield from ((name, measure()) for name, measure in pieces)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up all parts of which something was measured, from the values of pieces by their names."""
        lines: list[Line] = []
        for name, part in self.parts.items():
            there = [pieces[piece]["values"] for piece in _names(name, part) if piece in pieces]
            lines += part.summed(there) if there else []
        return Findings(lines, max((measured["busy"] for measured in pieces.values()), default=0.0))


BUSY = 0.1
"""Share of the processor that other processes may have before times mean little."""


@dataclass(frozen=True)
class Report:
    """The findings of one run.

    Attributes
    ----------
    experiment : Experiment
    machine : dict of str to str
    findings : Findings
    interrupted : bool
        Whether some of the pieces are missing.
    """

    experiment: Experiment
    machine: dict[str, str]
    findings: Findings
    interrupted: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON; times in seconds."""
        plan, found = self.experiment.plan, self.findings
        return {
            "experiment": self.experiment.name,
            "machine": self.machine,
            "seed": plan.seed,
            "quick": plan.quick,
            "rounds": plan.rounds,
            "settings": dict(self.experiment.settings),
            "protocol": self.experiment.protocol,
            "interrupted": self.interrupted,
            "correct": found.correct,
            "busy": found.busy,
            "lines": [{**asdict(line), "held": line.held} for line in found.lines],
        }

    def to_text(self) -> str:
        """Return the report for people, as Markdown."""
        plan, found = self.experiment.plan, self.findings
        shown = {**self.machine, "seed": str(plan.seed)}
        if self.experiment.protocol:
            shown["protocol"] = self.experiment.protocol
        if plan.rounds > 1:
            shown["rounds"] = str(plan.rounds)
        parts = ["\n".join(f"- {key}: {value}" for key, value in shown.items() if value != "not installed")]
        if plan.quick:
            parts.append("A quick run: counts are cut down, figures mean little.")
        if found.busy > BUSY:
            parts.append(
                f"BUSY: other processes had up to {100.0 * found.busy:.0f} % of the processor while this was measured; "
                "times mean little."
            )
        parts += tables_of(found.lines)
        if self.interrupted:
            parts.append("Interrupted: this is what was measured until then.")
        return "\n\n".join(parts) + "\n"


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


def _plain_lines(measure: Part, plan: Plan) -> list[dict[str, Any]]:
    return [asdict(line) for line in measure(plan)]


def _read(values: list[list[dict[str, Any]]]) -> list[Line]:
    return [Line.of(plain) for lines in values for plain in lines]


def _names(name: str, part: Divided) -> list[str]:
    return [name, *(f"{name}, share {share}" for share in range(1, len(part.shares)))]


def _measured(share: Callable[[], Any]) -> dict[str, Any]:
    """Measure a share, and how busy the machine is before and after."""
    before = busy()
    values = share()
    return {"busy": max(before, busy()), "values": values}
