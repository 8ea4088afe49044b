"""The search for robots: generations of candidates, near the best that are known or anywhere; and their space.

A candidate is a combination of listed values and a point of the ranges. It is drawn from the seed and from what the
generations before it found, and from nothing else; so a search that was interrupted goes on as if it had not been, and
any number of workers finds the same.

The space: fields of the robot file with ranges or lists of values.
"""

import itertools
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.robot import Robot
from sinuous.studies.tasks.assess import value_of, with_fields

MOST_CHOICES = 10_000
"""Most combinations of values that are listed."""

ENDS = {"length": (0, 1), "max_bend": (1, 1), "max_curvature": (1, 1), "radius": (0, 0)}
"""Fields of segments that only widen what a robot can do as they move to one end of their range, and between which ends
of it a robot that can do all of that lies: 0 the lower, 1 the upper."""


class Range(NamedTuple):
    """A field that may have any value between two."""

    field: str
    low: float
    high: float

    def value(self, share: float) -> float:
        """The value at a share of the range."""
        return self.low + share * (self.high - self.low)

    def share(self, value: float) -> float:
        """At which share of the range a value lies."""
        return (value - self.low) / (self.high - self.low)


class Choices(NamedTuple):
    """A field with some values."""

    field: str
    values: tuple[Any, ...]


class Space:
    """All robots that differ from a template in some fields.

    Parameters
    ----------
    template : Robot
    vary : mapping of str to (low, high) or list
        Fields as for `sweep`, and elements of lists: `base.position[2]`. A tuple of two numbers, or a mapping
        `{range: [low, high]}`, is a range; anything else lists values.

    Attributes
    ----------
    ranges : tuple of Range
    choices : tuple of Choices
    combinations : tuple of tuple
        Of the values of `choices`.
    segments : int
        Most segments of any of these robots.

    Raises
    ------
    InputError
        When there is no such field, a range is empty, or a value is not what it should be.
    """

    def __init__(self, template: Robot, vary: Any) -> None:
        checks.instance("template", template, Robot, "a Robot")
        if not isinstance(vary, Mapping) or not vary:
            raise InputError("vary", "", vary, "a mapping of fields to ranges or lists of values")
        read = [_read(str(field), value) for field, value in vary.items()]
        self.template = template
        self.ranges = tuple(each for each in read if isinstance(each, Range))
        self.choices = tuple(each for each in read if isinstance(each, Choices))
        count = int(np.prod([len(each.values) for each in self.choices], dtype=np.float64))
        if count > MOST_CHOICES:
            raise InputError("vary", f"lists {count} combinations", list(vary), f"at most {MOST_CHOICES}")
        self.combinations = tuple(itertools.product(*(each.values for each in self.choices)))
        self.segments = 1
        for combination in self.combinations:
            for share in (0.0, 1.0):  # a field that does not exist is refused now
                robot = self.robot(combination, np.full(len(self.ranges), share), refuse=True)
                self.segments = max(self.segments, 0 if robot is None else len(robot))

    @property
    def fields(self) -> tuple[str, ...]:
        """All fields: those with ranges, then those with lists."""
        return (*(each.field for each in self.ranges), *(each.field for each in self.choices))

    def values(self, combination: tuple[Any, ...], shares: Floats) -> dict[str, Any]:
        """Values of all fields at shares (d,) of the ranges."""
        inner = {each.field: each.value(float(share)) for each, share in zip(self.ranges, shares, strict=True)}
        return inner | {each.field: value for each, value in zip(self.choices, combination, strict=True)}

    def robot(self, combination: tuple[Any, ...], shares: Floats, refuse: bool = False) -> Robot | None:
        """Make a robot; `None` where these values together make none, unless that is to be refused."""
        try:
            return with_fields(self.template, self._ordered(self.values(combination, shares)), "vary")
        except InputError:
            if refuse:
                raise
            return None

    def shares_of(self, robot: Robot) -> tuple[int, Floats] | None:
        """Where a robot lies: the number of its combination, and the shares (d,); `None` where it is none of these."""
        shares = []
        for each in self.ranges:
            value = value_of(robot, each.field)
            if not isinstance(value, int | float) or not each.low <= value <= each.high:
                return None
            shares.append(each.share(value))
        values = tuple(value_of(robot, each.field) for each in self.choices)
        found = next((i for i, each in enumerate(self.combinations) if list(each) == list(values)), None)
        return None if found is None else (found, np.array(shares))

    def widest(self, combination: tuple[Any, ...]) -> tuple[Robot, float] | None:
        """Return a robot that can do whatever any robot of a combination can, and how far its base may have to move.

        `None` where no such robot is known.
        """
        values: dict[str, Any] = {}
        moved = 0.0
        for each in self.ranges:
            key = each.field.rpartition(".")[2]
            if re.fullmatch(r"base\.position\[\d\]", each.field):
                values[each.field] = each.value(0.5)
                moved += (0.5 * (each.high - each.low)) ** 2
            elif each.field == "radius" or (each.field.startswith("segments") and key in ENDS):
                ends = each.low, each.high
                low, high = (ends[i] for i in ENDS[key])
                values[each.field] = [low, high] if key == "length" else high
            else:
                return None
        values |= {each.field: value for each, value in zip(self.choices, combination, strict=True)}
        try:
            return with_fields(self.template, self._ordered(values), "vary"), moved**0.5
        except InputError:
            return None

    def _ordered(self, values: dict[str, Any]) -> dict[str, Any]:
        """The number of segments first: other fields may be those of one segment."""
        return dict(sorted(values.items(), key=lambda pair: pair[0] != "segments.count"))


def _read(field: str, value: Any) -> Range | Choices:
    key = f"vary[{field!r}]"
    if isinstance(value, Mapping):
        if set(value) not in ({"range"}, {"values"}):
            raise InputError(key, "", dict(value), "{range: [low, high]} or {values: [...]}")
        inner = next(iter(value.values()))
        pair = isinstance(inner, list | tuple) and len(inner) == 2 and all(isinstance(e, int | float) for e in inner)
        if "range" in value and not pair:
            raise InputError(f"{key}.range", "", inner, "two numbers")
        value = tuple(inner) if "range" in value else list(inner) if isinstance(inner, list | tuple) else inner
    if isinstance(value, tuple) and len(value) == 2 and all(isinstance(each, int | float) for each in value):
        low, high = (checks.number(key, each) for each in value)
        if low >= high:
            raise InputError(key, "is empty", list(value), "(low, high) with low < high")
        return Range(field, low, high)
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise InputError(key, "", value, "a range (low, high), or a list of values")
    listed = tuple(each.tolist() if isinstance(each, np.generic) else each for each in value)
    if not listed:
        raise InputError(key, "is empty", list(listed), "at least one value")
    return Choices(field, listed)


GENERATION_SIZE = 16
"""Candidates of a generation."""

SCATTERED_GENERATIONS = 4
"""First generations, whose candidates are anywhere."""

ANYWHERE_FRACTION, OTHER_VALUES_FRACTION = 0.06, 0.15
"""Share of the later candidates that are anywhere, and of those with another combination."""

LEAST_STEP, LARGEST_STEP = 1e-3, 0.5
"""Sizes of steps, as shares of the ranges: any order of magnitude between the two is as likely."""

DESCENT_COUNT, DESCENT_PERIOD = 4, 6
"""Candidates that are led down by derivatives, and how many generations there are from one time to the next."""

MOST_PARENTS = 6
"""Most candidates that others are drawn near, beside those that nothing is better than."""

Whole = NDArray[np.int64]


class Drawn(NamedTuple):
    """Robots that are to be judged.

    Attributes
    ----------
    combination : ndarray of int (k,)
    shares : ndarray (k, d)
    begin : ndarray (k, t, N, 3)
        Where answers to the tasks are looked for; NaN: anywhere.
    source : ndarray of int (k,)
        The candidate that a descent goes on from; -1: none does.
    which : ndarray of int (k,)
        The objective that it lowers.
    """

    combination: Whole
    shares: Floats
    begin: Floats
    source: Whole
    which: Whole


class RobotCandidates(NamedTuple):
    """Robots, and what they reached.

    Attributes
    ----------
    combination : ndarray of int (k,)
    shares : ndarray (k, d)
    done : ndarray of int (k,)
    share : ndarray (k,)
    objectives : ndarray (k, o)
        Infinite where they do not count.
    failed : ndarray of int (k,)
        The first task that is not done; -1: none; -2: it was not tried.
    answers : ndarray (k, t, N, 3)
    source : ndarray of int (k,)
        As it was drawn.
    tried : ndarray of int (k,)
        How many were judged for it.
    """

    combination: Whole
    shares: Floats
    done: Whole
    share: Floats
    objectives: Floats
    failed: Whole
    answers: Floats
    source: Whole
    tried: Whole

    @classmethod
    def joined(cls, parts: Sequence["RobotCandidates"]) -> "RobotCandidates":
        """One after the other."""
        return cls(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def front(objectives: Floats) -> Whole:
    """Numbers of those (k, o) that no other is better than, by the first objective; of equal ones the first."""
    order = np.lexsort(objectives.T[::-1])
    kept: list[int] = []
    for i in order:
        own = objectives[i]
        if np.isfinite(own).all() and not any((objectives[j] <= own).all() for j in kept):
            kept.append(int(i))
    return np.array(kept, np.int64)


class RobotSearch:
    """Draws generations.

    Parameters
    ----------
    open_combinations : sequence of int
        Those that no proof has cut.
    ranges : int
        How many.
    seed : int
    answers : (int, int)
        How many tasks there are, and most segments.
    known : (int, ndarray (d,)), optional
        The template, where it is one of these robots.
    descends : bool
        Whether candidates can be led down by derivatives.
    """

    def __init__(
        self,
        open_combinations: Sequence[int],
        ranges: int,
        seed: int,
        answers: tuple[int, int] = (0, 1),
        known: tuple[int, Floats] | None = None,
        descends: bool = False,
    ) -> None:
        self._open, self._ranges, self._seed, self._known = np.array(open_combinations), ranges, seed, known
        self._nothing, self._descends = np.full((GENERATION_SIZE, *answers, 3), np.nan), descends

    def generation(self, number: int, found: Sequence[RobotCandidates]) -> Drawn:
        """Draw a generation, after those that were `found` before it."""
        rng = np.random.default_rng([self._seed, number])
        if number < SCATTERED_GENERATIONS or not found:
            combination, shares = self._scattered(rng, GENERATION_SIZE)
            if number == 0 and self._known is not None:
                combination[0], shares[0] = self._known
            nowhere = np.full(GENERATION_SIZE, -1)
            return Drawn(combination, shares, self._nothing, nowhere, nowhere)
        joined = RobotCandidates.joined(found)
        if self._descends and (number - SCATTERED_GENERATIONS) % DESCENT_PERIOD == 0:
            source, which = self._sources(joined)
            if len(source):
                return Drawn(joined.combination[source], joined.shares[source], joined.answers[source], source, which)
        return self._near(rng, joined)

    @staticmethod
    def _sources(found: RobotCandidates) -> tuple[Whole, Whole]:
        """Candidates to go down from, and by which objective: the best, and the best of those that were anywhere."""
        source: list[int] = []
        which: list[int] = []
        counts = np.isfinite(found.objectives).all(axis=1) & (found.source < 0)
        counts[found.source[found.source >= 0]] = False
        for i in range(DESCENT_COUNT):
            objective = i % found.objectives.shape[1]
            left = np.flatnonzero(counts)
            early = left[left < SCATTERED_GENERATIONS * GENERATION_SIZE]
            left = early if i and len(early) else left
            if len(left):
                fresh = left[~np.isin(found.combination[left], found.combination[source])]
                own = fresh if len(fresh) else left
                best = int(own[np.argmin(found.objectives[own, objective])])
                source.append(best)
                which.append(objective)
                counts[best] = False
        return np.array(source, np.int64), np.array(which, np.int64)

    def _scattered(self, rng: Generator, count: int) -> tuple[Whole, Floats]:
        """Candidates anywhere: in each range one in each of as many equal parts (Latin hypercube)."""
        parts = np.array([rng.permutation(count) for _ in range(self._ranges)]).reshape(self._ranges, count).T
        shares = (parts + rng.random((count, self._ranges))) / count
        turns = np.resize(rng.permutation(self._open), count)
        return turns, shares

    def _near(self, rng: Generator, found: RobotCandidates) -> Drawn:
        """Candidates near parents: along some of the ranges, by steps of any size, and up to the ends of them."""
        parents = self._parents(found)
        chosen = rng.choice(parents, GENERATION_SIZE)
        combination, shares = found.combination[chosen].copy(), found.shares[chosen].copy()
        begin = found.answers[chosen].copy()
        away, other = self._scattered(rng, GENERATION_SIZE)
        for i in range(GENERATION_SIZE):
            kind = rng.random()
            if kind < ANYWHERE_FRACTION:
                combination[i], shares[i], begin[i] = away[i], other[i], np.nan
                continue
            if kind < ANYWHERE_FRACTION + OTHER_VALUES_FRACTION:
                combination[i] = away[i]
            size = np.exp(rng.uniform(np.log(LEAST_STEP), np.log(LARGEST_STEP)))
            moves = rng.random(self._ranges) < 0.5
            if self._ranges and not moves.any():
                moves[rng.integers(self._ranges)] = True
            shares[i] = np.clip(shares[i] + size * moves * rng.normal(size=self._ranges), 0.0, 1.0)
        begin[combination != found.combination[chosen]] = np.nan
        nowhere = np.full(GENERATION_SIZE, -1)
        return Drawn(combination, shares, begin, nowhere, nowhere)

    @staticmethod
    def _parents(found: RobotCandidates) -> Whole:
        """The front of those that count; without any, those that do most."""
        best = front(found.objectives)
        tried = np.flatnonzero(found.failed != -2)
        order = tried[np.lexsort((-found.share[tried], -found.done[tried]))][:MOST_PARENTS]
        if not len(best):
            return order
        own = found.objectives[:, 0]
        near = np.flatnonzero(np.isfinite(own))
        return np.union1d(best, near[np.argsort(own[near], kind="stable")][:MOST_PARENTS])
