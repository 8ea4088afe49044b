"""What an experiment is: pieces of work, whose plain values are kept, and findings that are made of these alone."""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from importlib import import_module
from itertools import chain, count, takewhile
from typing import Any, Protocol

from benchmarks.harness import reference
from benchmarks.harness.lines import Line, together
from benchmarks.harness.plan import Plan

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


class Experiment(Protocol):
    """What the harness asks of an experiment."""

    name: str
    plan: Plan
    divisible: bool
    """Whether some of the pieces have findings of their own, so that an interrupted run has something to say."""

    def settings(self) -> dict[str, Any]:
        """Return plain values, all that the figures depend on besides machine, code, seed and size."""
        ...

    def pieces(self) -> Iterable[Piece]:
        """Return the work, in order."""
        ...

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterable[Piece]:
        """Return more work, after all pieces, to make sure of figures, which are named by section and what."""
        ...

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up what was measured, by the names of the pieces."""
        ...


class Indivisible:
    """An experiment whose findings need all of its pieces."""

    divisible = False

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterable[Piece]:
        """Nothing: its repeats are part of the experiment."""
        return ()


Measurement = Callable[[], Iterable[Line]]


class OfLines:
    """An experiment whose pieces each measure some lines, as often as there are rounds.

    Parameters
    ----------
    name : str
    plan : Plan
    """

    divisible = True

    def __init__(self, name: str, plan: Plan) -> None:
        self.name = name
        self.plan = plan

    def settings(self) -> dict[str, Any]:
        """Return nothing: seed and size determine everything; rounds and parts may be added to what is measured."""
        return {}

    def parts(self) -> Iterable[tuple[str, Measurement]]:
        """Return names, and what yields the lines of each."""
        raise NotImplementedError

    def pieces(self) -> Iterator[Piece]:
        """Every part, then every part again: a slow minute of the machine meets one round alone."""
        for number in range(self.plan.rounds):
            for name, measure in self.parts():
                yield _name(name, number), partial(_measured, measure)

    def again(self, pieces: dict[str, Any], doubtful: Collection[tuple[str, str]]) -> Iterator[Piece]:
        """One more round of the parts that have some of these figures."""
        for name, measure in self.parts():
            rounds = list(_rounds(name, pieces))
            if any((line.section, line.what) in doubtful for lines in rounds for line in lines):
                yield _name(name, len(rounds)), partial(_measured, measure)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Put all rounds of every figure together."""
        found: dict[tuple[str, str], list[Line]] = {}
        for name, _ in self.parts():
            for line in chain.from_iterable(_rounds(name, pieces)):
                found.setdefault((line.section, line.what), []).append(line)
        busy = max((measured["busy"] for measured in pieces.values()), default=0.0)
        return Findings([together(lines) for lines in found.values()], busy=busy)


def _name(part: str, number: int) -> str:
    return f"{part}, round {number}"


def _measured(measure: Measurement) -> dict[str, Any]:
    """Measure lines, and the reference workload before and after."""
    before = reference.look()
    lines = list(measure())
    after = reference.look()
    around, busy = 0.5 * (before.seconds + after.seconds), max(before.busy, after.busy)
    return {"reference": around, "busy": busy, "lines": [asdict(line) for line in lines]}


def _rounds(part: str, pieces: dict[str, Any]) -> Iterator[list[Line]]:
    """Lines of each round of a part that was measured."""
    names = takewhile(pieces.__contains__, (_name(part, number) for number in count()))
    for measured in map(pieces.__getitem__, names):
        yield [replace(Line.of(plain), reference=measured["reference"]) for plain in measured["lines"]]


class OfSections(OfLines):
    """An experiment of lines, one piece for each of its sections: files of the folder that is called as it is.

    Parameters
    ----------
    name : str
    plan : Plan
    sections : sequence of str
        Each a file with `measure(plan)`.
    """

    def __init__(self, name: str, plan: Plan, sections: Sequence[str]) -> None:
        super().__init__(name, plan)
        self._sections = sections

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """One section is one piece."""
        for section in self._sections:
            yield section, partial(import_module(f"benchmarks.{self.name}.{section}").measure, self.plan)
