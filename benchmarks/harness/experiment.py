"""What an experiment is: parts whose shares of work are measured, and summed up as lines.

Its plan says how large a run is, and what its random numbers begin with.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import partial
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.harness.lines import Line
from benchmarks.harness.machine import busy
from sinuous.base.errors import InputError


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


class Measured(NamedTuple):
    """What a share came to, and what share of the processor other processes had before or after, 0 to 1."""

    values: Any
    busy: float


Piece = tuple[str, Callable[[], Measured]]
"""A name, and what to call: some seconds of work, which an interrupt may cost."""


class Divided(NamedTuple):
    """A measurement in shares, each of which is a piece: an interrupt costs one of them, not all.

    Attributes
    ----------
    shares : list of callable
        Each returns what can be pickled.
    summed : callable
        From what shares returned, in their order, to the lines. After an interrupt some are missing.
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
    """

    name: str
    plan: Plan
    parts: Mapping[str, Divided]
    protocol: str = ""
    settings: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, name: str, plan: Plan, measured: Mapping[str, Part]) -> "Experiment":
        """Return one of parts that are measured in one go each."""
        parts = {
            part: Divided([partial(_listed, measure, plan)], chain.from_iterable) for part, measure in measured.items()
        }
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

    def lines(self, pieces: Mapping[str, Measured]) -> list[Line]:
        """Sum up all parts of which something was measured, from the results of pieces by their names."""
        lines: list[Line] = []
        for name, part in self.parts.items():
            there = [pieces[piece].values for piece in _names(name, part) if piece in pieces]
            lines += part.summed(there) if there else []
        return lines


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


def _measured(share: Callable[[], Any]) -> Measured:
    before = busy()
    values = share()
    return Measured(values, max(before, busy()))
