"""What an experiment is: parts whose shares of work are measured, kept as plain values, and summed up as lines."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from fnmatch import fnmatchcase
from functools import partial
from itertools import count
from statistics import fmean
from typing import Any, NamedTuple

from benchmarks.harness import parallel, reference
from benchmarks.harness.lines import Line, together
from benchmarks.harness.plan import Plan
from sinuous.base.errors import InputError

Piece = tuple[str, Callable[[], Any]]
"""A name, and what to call for plain values: some seconds of work, which an interrupt may cost."""


@dataclass
class Findings:
    """What an experiment found.

    Attributes
    ----------
    lines : list of Line
        Figures, to be printed as tables and compared with a baseline.
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
    """Parts that each measure some lines, as often as there are rounds.

    Attributes
    ----------
    name : str
    plan : Plan
    parts : mapping of str to Divided
    protocol : str
        What is counted, and how it is timed, in a sentence for the head of the report.
    settings : mapping
        Plain values, all that the figures depend on besides machine, code, seed and size.
    fresh : bool
        Whether the shares know of rounds themselves, and each has problems of its own.
    abreast : bool
        Whether shares are done in as many processes as there are cores, each as soon as one is free: no process waits
        for the others between two parts, and what is timed has a core of its own. A quick run uses this process alone.
    """

    name: str
    plan: Plan
    parts: Mapping[str, Divided]
    protocol: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)
    fresh: bool = False
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
        """Every part, then every part again: a slow minute of the machine meets one round alone."""
        for number in range(1 if self.fresh else self.plan.rounds):
            for name, part in self.parts.items():
                yield from _round(name, part, number)

    def done(self, pieces: Sequence[Piece]) -> Iterator[tuple[str, Any]]:
        """Do pieces, and yield name and values of each as soon as it is done."""
        if self.abreast and not self.plan.quick:
            yield from parallel.as_done(pieces)
        else:
            yield from ((name, measure()) for name, measure in pieces)

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterator[Piece]:
        """One more round of the parts that have some of these figures, which are named by section and what."""
        for name, part in self.parts.items():
            rounds = list(_rounds(name, part, pieces))
            if not self.fresh and any((line.section, line.what) in doubtful for lines in rounds for line in lines):
                yield from _round(name, part, len(rounds))

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Put all rounds of every figure together, from the values of pieces by their names."""
        found: dict[tuple[str, str], list[Line]] = {}
        for name, part in self.parts.items():
            for lines in _rounds(name, part, pieces):
                for line in lines:
                    found.setdefault((line.section, line.what), []).append(line)
        busy = max((measured["busy"] for measured in pieces.values()), default=0.0)
        return Findings([together(lines) for lines in found.values()], busy=busy)


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


def _names(name: str, part: Divided, number: int) -> list[str]:
    """Names of the pieces of one round of a part; more shares may be added later."""
    more = [f"{name}, share {share}, round {number}" for share in range(1, len(part.shares))]
    return [f"{name}, round {number}", *more]


def _round(name: str, part: Divided, number: int) -> Iterator[Piece]:
    for piece, share in zip(_names(name, part, number), part.shares, strict=True):
        yield piece, partial(_measured, share)


def _measured(share: Callable[[], Any]) -> dict[str, Any]:
    """Measure a share, and the reference workload before and after."""
    before = reference.look()
    values = share()
    after = reference.look()
    around, busy = 0.5 * (before.seconds + after.seconds), max(before.busy, after.busy)
    return {"reference": around, "busy": busy, "values": values}


def _rounds(name: str, part: Divided, pieces: dict[str, Any]) -> Iterator[list[Line]]:
    """Lines of each round of a part that was measured: of whole rounds, or else of what there is of the first."""
    for number in count():
        named = _names(name, part, number)
        there = [pieces[piece] for piece in named if piece in pieces]
        if not there or (number > 0 and len(there) < len(named)):
            return
        around = fmean(measured["reference"] for measured in there)
        lines = part.summed([measured["values"] for measured in there])
        yield [replace(line, reference=around) for line in lines]
