"""Stations of a path, strands of shapes along some of them, and slides to other shapes while the tip stays."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.certificate.query import ANSWER_WIDTH
from sinuous.model.robot import Robot
from sinuous.motion.configurations import lever_metric
from sinuous.motion.knots import Knot, TipLine
from sinuous.motion.tip_steps import TipSteps
from sinuous.problem.target import Target
from sinuous.solver.certificates.steps import Steps

FAR, TURN, MOST = 0.1, 0.5, 16
"""Most from one station to the next, in mean lengths of the robot and rad, and most of them between two waypoints."""

FINEST = 1.0 / 256.0
"""Share of a slide below which steps are not halved."""

LONGEST = 400
"""Most steps of a slide."""

GAIN = 0.25
"""Share of a step of a slide by which it has to come nearer to its end."""


class Station(NamedTuple):
    """A waypoint, or a place between two.

    Attributes
    ----------
    targets : tuple of Target
    waypoint : int
        Its number, or that of the next one, 0 = first.
    line : TipLine or None
        That leads here from the station before, if the tip has to follow one.
    shares : (float, float)
        The part of it.
    """

    targets: tuple[Target, ...]
    waypoint: int
    line: TipLine | None = None
    shares: tuple[float, float] = (0.0, 1.0)

    @property
    def is_waypoint(self) -> bool:
        """Whether it is one itself."""
        return self.shares[1] == 1.0


def stations_along(robot: Robot, waypoints: Sequence[tuple[Target, ...]]) -> list[Station]:
    """Divide a path into stations which are not far from each other."""
    stations = [Station(waypoints[0], 0)]
    for i, targets in enumerate(waypoints[1:], start=1):
        line = TipLine.between(waypoints[i - 1], targets)
        count = 1 if line is None else _parts(robot, line)
        for k in range(count):
            shares = k / count, (k + 1) / count
            last = line is None or k == count - 1
            stations.append(Station(targets if last or line is None else (line.at(shares[1]),), i, line, shares))
    return stations


def _parts(robot: Robot, line: TipLine) -> int:
    far, turn = line.length / (FAR * robot.mean_length), line.angle / TURN
    return int(np.clip(math.ceil(max(far, turn) - 1e-9), 1, MOST))


class Strand:
    """Shapes at stations one after the other, and the proved ways between them.

    Parameters
    ----------
    begin : int
        The first station.
    knot : Knot
        There.

    Attributes
    ----------
    begin : int
    knots : list of Knot
        At the stations.
    ways : list of list of Knot
        From each station to the next: knots after it, the last one at the next station.
    """

    def __init__(self, begin: int, knot: Knot) -> None:
        self.begin = begin
        self.knots, self.ways = [knot._replace(proof=None)], list[list[Knot]]()

    @property
    def end(self) -> int:
        """The last station."""
        return self.begin + len(self.ways)

    def at(self, station: int) -> Knot:
        """Return the knot at a station."""
        return self.knots[station - self.begin]

    def extend(self, steps: TipSteps, stations: Sequence[Station]) -> None:
        """Go on to both sides, as far as the tip can go straight."""
        while self.end + 1 < len(stations):
            station = stations[self.end + 1]
            way = self._lead(steps, self.knots[-1], station, station.targets, station.shares)
            if way is None:
                break
            self.knots.append(way[-1])
            self.ways.append(way)
        while self.begin > 0:
            station, targets = stations[self.begin], stations[self.begin - 1].targets
            way = self._lead(steps, self.knots[0], station, targets, station.shares[::-1])
            if way is None:
                break
            self.ways.insert(0, backwards(self.knots[0], way))
            self.knots.insert(0, way[-1])
            self.begin -= 1

    @staticmethod
    def _lead(
        steps: TipSteps, knot: Knot, station: Station, targets: tuple[Target, ...], shares: tuple[float, float]
    ) -> list[Knot] | None:
        found = steps.meet(targets, knot.begin)
        return None if found is None else steps.lead(knot, found, station.line, shares)


def backwards(first: Knot, way: Sequence[Knot]) -> list[Knot]:
    """Return the way from its last knot back to the first one, which it leads from: what is proved of it holds, too."""
    knots, turned = [first, *way], []
    for knot, after in zip(knots[-2::-1], knots[:0:-1], strict=True):
        assert after.proof is not None
        proof = Steps(after.proof.reshape(-1, ANSWER_WIDTH)).reversed().answers
        turned.append(knot._replace(proof=proof, line=after.line, shares=after.shares[::-1]))
    return turned


def slide(steps: TipSteps, begin: Knot, end: Knot, targets: tuple[Target, ...]) -> list[Knot] | None:
    """Go from one shape at a station to another while its targets are met; `None` where that is not found.

    Every knot is a place on the straight way to the end, led back to the targets; each step is proved.
    """
    line, levers = TipLine.between(targets, targets), lever_metric(steps.solver.robot)

    def left(q: Floats) -> float:
        return float(np.linalg.norm((end.q - q) * levers))

    whole = left(begin.q)
    knots, before, far, size = list[Knot](), begin, whole, whole
    while far > 0.0:
        size = min(size, far)
        knot = None
        if size == far and end.solution is not None:
            knot = steps.step(before, end.solution, line, (0.0, 1.0))
        elif size < far:
            found = steps.meet(targets, before.q + size / far * (end.q - before.q))
            if found is not None and left(found.q) < far - GAIN * size:
                knot = steps.step(before, found, line, (0.0, 1.0))
        if knot is not None:
            knots.append(knot)
            before, far, size = knot, left(knot.q), 2.0 * size
        elif size < FINEST * whole or len(knots) > LONGEST:
            return None
        else:
            size *= 0.5
    return knots
