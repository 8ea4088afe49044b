"""What an experiment is: pieces of work, whose plain values are kept, and findings that are made of these alone."""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from fnmatch import fnmatchcase
from functools import partial
from itertools import count
from statistics import fmean
from typing import Any, NamedTuple

from benchmarks.harness import reference
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
    text : str
        Markdown, which shows the pictures by their names.
    data : dict
        The same for programs.
    pictures : dict
        Matplotlib figures by name, without ending.
    wrong : int
        Claims of "solved" that verification rejected.
    busy : float
        Largest share of the processor that other processes had before or after a piece, 0 to 1.
    """

    lines: list[Line] = field(default_factory=list)
    text: str = ""
    data: dict[str, Any] = field(default_factory=dict)
    pictures: dict[str, Any] = field(default_factory=dict)
    wrong: int = 0
    busy: float = 0.0

    @property
    def correct(self) -> bool:
        """Whether no claim was wrong, and every goal of correctness was held; speed is another matter."""
        return self.wrong == 0 and all(line.held is not False for line in self.lines if line.correctness)


class Experiment:
    """What the harness asks of an experiment.

    Attributes
    ----------
    name : str
    plan : Plan
    divisible : bool
        Whether some of the pieces have findings of their own, so that an interrupted run has something to say.
    protocol : str
        What is counted, and how it is timed, in a sentence for the head of the report.
    """

    name: str
    plan: Plan
    divisible = False
    protocol = ""

    def settings(self) -> dict[str, Any]:
        """Return plain values, all that the figures depend on besides machine, code, seed and size."""
        return {}

    def pieces(self) -> Iterable[Piece]:
        """Return the work, in order."""
        raise NotImplementedError

    def done(self, pieces: Sequence[Piece]) -> Iterator[tuple[str, Any]]:
        """Do pieces, and yield name and values of each as soon as it is done: one after the other by default."""
        for name, measure in pieces:
            yield name, measure()

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterable[Piece]:
        """Return more work, after all pieces, to make sure of figures, which are named by section and what."""
        return ()

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up what was measured, by the names of the pieces."""
        raise NotImplementedError


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


class OfLines(Experiment):
    """An experiment whose parts each measure some lines, as often as there are rounds.

    Parameters
    ----------
    name : str
    plan : Plan
    measured : mapping of str to Part, optional
        The parts by their names; of those that override `parts`, nothing.
    """

    divisible = True

    fresh = False
    """Whether the shares of a part know of rounds themselves, and each has problems of its own."""

    def __init__(self, name: str, plan: Plan, measured: Mapping[str, Part] | None = None) -> None:
        self.name = name
        self.plan = plan
        self._measured = measured or {}
        self._only: frozenset[str] | None = None

    def parts(self) -> Iterator[tuple[str, Divided]]:
        """Return names, and what measures each in shares."""
        for name, measure in self._measured.items():
            yield name, Divided([partial(_plain_lines, measure, self.plan)], _read)

    def choose(self, patterns: Sequence[str]) -> None:
        """Measure some of the parts alone; see `chosen`."""
        self._only = chosen([name for name, _ in self.parts()], patterns)

    def _chosen(self) -> Iterator[tuple[str, Divided]]:
        return ((name, part) for name, part in self.parts() if self._only is None or name in self._only)

    def pieces(self) -> Iterator[Piece]:
        """Every part, then every part again: a slow minute of the machine meets one round alone."""
        for number in range(1 if self.fresh else self.plan.rounds):
            for name, part in self._chosen():
                yield from _round(name, part, number)

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterator[Piece]:
        """One more round of the parts that have some of these figures."""
        for name, part in self._chosen():
            rounds = list(_rounds(name, part, pieces))
            if not self.fresh and any((line.section, line.what) in doubtful for lines in rounds for line in lines):
                yield from _round(name, part, len(rounds))

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Put all rounds of every figure together."""
        found: dict[tuple[str, str], list[Line]] = {}
        for name, part in self._chosen():
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
