"""Chooses where a path begins, and the shape all along it.

A graph has a layer of shapes for each station of the path. Its edges are strands, on which the tip goes straight from
station to station, and slides from one strand to another, on which it stays where it is; both are proved. The shortest
way is that with the fewest slides, and of these the least motion. Slides are proved when a shortest way wants them
(lazy search: Bohlin & Kavraki 2000; ladder graphs of Descartes). Where there is no way, more strands are begun: at the
stations beyond those that are reached, from either end.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise
from typing import NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.base.progress import work_time
from sinuous.motion.configurations import lever_metric, random_configuration
from sinuous.motion.knots import Knot
from sinuous.motion.strands import Strand, backwards, slide, stations_along
from sinuous.motion.tip_steps import TipSteps
from sinuous.problem.target import Target
from sinuous.solver.solver import Solver

SOLVES = 1500
"""Solves that the search may take, of which each goes on from a shape beside."""

SOLVES_A_STATION = 40
"""More of them for each station."""

OTHERS, STARTS = 6, 200
"""Shapes that are looked for at a station by all that a solver does, and starts of that."""

BETWEEN = (0.25, 0.5, 0.75, 1.0)
"""Places between two stations that no strand leads between, by their share: whether they can be reached is asked."""

BATCH = 8
"""Strands that are begun before a way is looked for again."""

SLIDES = 4
"""Slides that are tried before more strands are begun."""

AGAIN = 3
"""Stations at which a slide from one strand to another is tried."""

APART = 0.01
"""Shapes nearer to each other than this, in mean lengths of the robot, are the same."""

SWITCH = 1e6
"""What a slide costs beside its length, in mean lengths of the robot."""


class FollowedPath(NamedTuple):
    """A path that is followed whole.

    Attributes
    ----------
    knots : list of Knot
    waypoints : list of int
        Numbers of the knots at which waypoints are reached.
    reconfigured : list of int
        Waypoints (1 = first) before which the robot changes its shape while the tip stays.
    """

    knots: list[Knot]
    waypoints: list[int]
    reconfigured: list[int]


class PathSolver:
    """Searches for a way along a whole path.

    Parameters
    ----------
    steps : TipSteps
    waypoints : sequence of tuple of Target
    start : Knot, optional
        The shape at the first waypoint, where that is given.
    """

    def __init__(self, steps: TipSteps, waypoints: Sequence[tuple[Target, ...]], start: Knot | None = None) -> None:
        self._steps, self._solver, robot = steps, steps.solver, steps.solver.robot
        self._stations = stations_along(robot, waypoints)
        self._levers, self._unit = lever_metric(robot), robot.mean_length
        self._rng = np.random.default_rng(self._solver.options.seed)
        self._strands: list[Strand] = []
        self._slides: dict[tuple[int, int, int], list[Knot]] = {}
        self._refused: dict[tuple[int, int], list[int]] = {}  # stations at which slides between two strands failed
        self._last = steps.meets + SOLVES + SOLVES_A_STATION * len(self._stations)
        self._until = work_time() + self._solver.options.time * len(waypoints)
        self._started, self._hopeless = start is not None, False
        options = replace(self._solver.options, max_starts=STARTS)
        self._whole = Solver._of_checked(robot, self._solver.scene, options)
        if start is not None:
            self._add(0, start)

    def solve(self, seeds: Sequence[tuple[int, Knot]]) -> FollowedPath | None:
        """Return a way along the whole path; `None` where none is found.

        Parameters
        ----------
        seeds : sequence of (int, Knot)
            Waypoints, 0 = first, and shapes there, to begin with.
        """
        at = {station.waypoint: i for i, station in enumerate(self._stations) if station.is_waypoint}
        for waypoint, seed in seeds:
            self._add(at[waypoint], seed)
        more = self._more_seeds()
        while True:
            way = self._proved_way()
            if way is not None:
                return self._followed(way)
            for station, knot in islice(more, BATCH):
                if not self._open:
                    return None
                self._add(station, knot)
            if self._hopeless:
                return None

    @property
    def _open(self) -> bool:
        return self._steps.meets < self._last and work_time() < self._until

    def _add(self, station: int, knot: Knot | None) -> None:
        """Begin a strand, unless there is one through the same shape."""
        if knot is None or any(
            strand.begin <= station <= strand.end and self._distance(strand.at(station), knot) < APART * self._unit
            for strand in self._strands
        ):
            return
        strand = Strand(station, knot)
        strand.extend(self._steps, self._stations)
        self._strands.append(strand)

    def _distance(self, one: Knot, other: Knot) -> float:
        return float(np.linalg.norm((one.q - other.q) * self._levers))

    # The way through the graph

    def _proved_way(self) -> list[tuple[int, int]] | None:
        """Return the shortest way, as stations and strands from there on, after its slides are proved."""
        tries = 0
        while (way := self._shortest_way()) is not None:
            slides = [(station, before, after) for (_, before), (station, after) in pairwise(way)]
            missing = next((each for each in slides if each not in self._slides), None)
            if missing is None:
                return way
            if tries == SLIDES or not self._open:
                return None
            tries += 1
            self._try_slide(*missing)
        return None

    def _try_slide(self, station: int, before: int, after: int) -> None:
        """Prove a slide, in both directions, or remember that it failed."""
        begin, end = self._strands[before].at(station), self._strands[after].at(station)
        targets = self._stations[station].targets
        knots = slide(self._steps, begin, end, targets)
        if knots is None:
            back = slide(self._steps, end, begin, targets)
            knots = None if back is None else backwards(end, back)
        if knots is None:
            self._refused.setdefault((min(before, after), max(before, after)), []).append(station)
        else:
            self._slides[station, before, after] = knots
            self._slides[station, after, before] = backwards(begin, knots)

    def _shortest_way(self) -> list[tuple[int, int]] | None:
        """Return the way with the fewest slides, by dynamic programming; `None` where strands do not overlap."""
        count, whole = len(self._strands), len(self._stations)
        costs = np.full(count, math.inf)
        came: list[tuple[np.ndarray, list[np.ndarray]]] = []
        for station in range(whole):
            covers = np.array([strand.begin <= station <= strand.end for strand in self._strands])
            if station:
                costs = costs + self._lengths(station)
            else:
                costs = np.where(covers & (not self._started or np.arange(count) == 0), 0.0, math.inf)
            switches = []
            if station < whole - 1:
                switch = self._switches(station, covers)
                for _ in range(2):
                    through = costs[:, None] + switch
                    best = through.argmin(axis=0)
                    reached = through[best, np.arange(count)]
                    better = reached < costs
                    switches.append(np.where(better, best, np.arange(count)))
                    costs = np.where(better, reached, costs)
            came.append((costs, switches))
        if not np.isfinite(costs).any():
            return None
        strand, way = int(costs.argmin()), list[tuple[int, int]]()
        for station in range(whole - 1, -1, -1):
            for switched in reversed(came[station][1]):
                if switched[strand] != strand:
                    way.append((station, strand))
                    strand = int(switched[strand])
        way.append((0, strand))
        return way[::-1]

    def _lengths(self, station: int) -> Floats:
        """Lengths of strands (K,) from the station before; infinite of those that do not come from there."""
        return np.array(
            [
                self._distance(strand.at(station - 1), strand.at(station)) / self._unit
                if strand.begin < station <= strand.end
                else math.inf
                for strand in self._strands
            ]
        )

    def _switches(self, station: int, covers: Floats) -> Floats:
        """Costs of slides (K, K) at a station."""
        count = len(self._strands)
        costs = np.full((count, count), math.inf)
        there = np.flatnonzero(covers)
        q = np.array([(self._strands[k].at(station).q * self._levers).ravel() for k in there])
        if len(there):
            far = np.linalg.norm(q[:, None] - q[None], axis=-1) / self._unit
            costs[np.ix_(there, there)] = SWITCH + far
        for (a, b), stations in self._refused.items():
            proved = (station, a, b) in self._slides
            if not proved and (station in stations or len(stations) >= AGAIN):
                costs[a, b] = costs[b, a] = math.inf
        np.fill_diagonal(costs, math.inf)
        return costs

    def _followed(self, way: list[tuple[int, int]]) -> FollowedPath:
        """Put the knots of a way together."""
        strand, switches = way[0][1], way[1:]
        knots = [self._strands[strand].at(0)]
        waypoints, reconfigured = list[int](), list[int]()
        for number, station in enumerate(self._stations):
            if number:
                own = self._strands[strand]
                knots += own.ways[number - 1 - own.begin]
            if station.is_waypoint:
                waypoints.append(len(knots) - 1)
            while switches and switches[0][0] == number:
                after = switches.pop(0)[1]
                knots += self._slides[number, strand, after]
                strand = after
                reconfigured.append(self._stations[number + 1].waypoint + 1)
        return FollowedPath(knots, waypoints, sorted(set(reconfigured)))

    # Where more strands begin

    def _more_seeds(self) -> Iterator[tuple[int, Knot | None]]:
        """Shapes at stations beyond those that are reached, from either end, and anywhere: near, drawn, and solved."""
        robot, whole = self._solver.robot, len(self._stations)
        asked, crossed = set[int](), set[int]()
        while True:
            first, last = self._reached()
            for station in (first + 1, last - 1):
                if not 0 <= station < whole or station in asked:
                    continue
                asked.add(station)
                found = self._whole.solve_all(list(self._stations[station].targets), count=OTHERS)
                yield from ((station, self._knot(each)) for each in found)
            between = set(range(first + 1, min(last + 1, whole))) - crossed
            crossed |= between
            if any(map(self._cannot_be_crossed, sorted(between))):
                self._hopeless = True
                return
            for station, strand in ((first, True), (last, False)):
                near = [each for each in self._strands if each.begin <= station <= each.end]
                if near:
                    own = near[int(self._rng.integers(len(near)))]
                    beyond = min(max(station + (1 if strand else -1), 0), whole - 1)
                    yield from self._met(beyond, self._near(own.at(station).q))
            yield from self._met(min(first + 1, whole - 1), random_configuration(robot, self._rng))
            yield from self._met(int(self._rng.integers(whole)), random_configuration(robot, self._rng))

    def _met(self, station: int, q: Floats) -> Iterator[tuple[int, Knot | None]]:
        found = self._steps.meet(self._stations[station].targets, q)
        yield station, None if found is None else self._knot(found)

    def _cannot_be_crossed(self, station: int) -> bool:
        """Whether no shape is found at a station that no strand comes to, or at places on the line that leads there."""
        line, (begin, end) = self._stations[station].line, self._stations[station].shares
        if line is None or any(each.begin < station <= each.end for each in self._strands):
            return False
        places = (line.at(begin + part * (end - begin)) for part in BETWEEN)
        return not all(self._whole.solve(place).solved for place in places)

    @staticmethod
    def _knot(found: Solution) -> Knot:
        return Knot(found.configuration, None, found.problem.targets, found)

    def _near(self, q: Floats) -> Floats:
        """Draw a configuration near one (n, 3)."""
        size = 10.0 ** self._rng.uniform(-1.0, 0.3)
        return q + size * self._rng.normal(size=q.shape) * [1.0, 1.0, 0.2 * self._unit / len(q)]

    def _reached(self) -> tuple[int, int]:
        """The last station that is reached from the first one, and the first from which the last one is reached."""
        count, whole = len(self._strands), len(self._stations)
        entry = np.array(
            [0 if each.begin == 0 and (not self._started or k == 0) else whole for k, each in enumerate(self._strands)]
        )
        leave = np.array([whole - 1 if each.end == whole - 1 else -1 for each in self._strands])
        for _ in range(count):
            for station, a, b in self._slides:
                if entry[a] <= station < entry[b]:
                    entry[b] = station
                if leave[b] >= station > leave[a]:
                    leave[a] = station
        first = max((each.end for k, each in enumerate(self._strands) if entry[k] < whole), default=-1)
        last = min((each.begin for k, each in enumerate(self._strands) if leave[k] >= 0), default=whole)
        return first, last
