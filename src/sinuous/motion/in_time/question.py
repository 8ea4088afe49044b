"""From where to where a way in time is sought, and how fast the robot may be."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import VERDICT
from sinuous.kernels.body.proof import CLEAR
from sinuous.motion.timing import largest
from sinuous.robot.rates import Rates, Spread
from sinuous.robot.robot import Robot
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.between.steps import LOOSE_SECONDS, SLACK, Prover

ROUNDING = 1e-9
"""Share by which a step may be quicker than rates allow: rounding."""


class TimedWay(NamedTuple):
    """Knots (T, n, 3) from a start to a goal, their times (T,), and what is proved of the steps (T - 1, 14)."""

    q: Floats
    times: Floats
    answers: Floats


@dataclass(frozen=True)
class TimedQuestion:
    """What is asked of a search in time.

    Attributes
    ----------
    robot : Robot
    prover : Prover
        Of the scene whose obstacles move.
    start : ndarray (n, 3)
        Within all limits, and clear when it begins.
    begin : float
    end : float
        When the robot is at a goal; where `early`, at the latest.
    early : bool
        Whether it may be there before, as early as it can.
    goals : callable
        Takes configurations (m, n, 3) that are reached, and returns all goals so far (g, n, 3), within all limits.
    rates : Rates or None
    seed : int
    seconds_left : callable
    """

    robot: Robot
    prover: Prover
    start: Floats
    begin: float
    end: float
    early: bool
    goals: Callable[[Floats], Floats]
    rates: Rates | None
    seed: int
    seconds_left: Callable[[], float]

    @property
    def scene(self) -> Snapshot:
        """Where obstacles move."""
        return self.prover.scene

    @property
    def accelerations(self) -> Rates | None:
        """How fast rates may change; `None` where nothing says it."""
        return None if self.rates is None else self.rates.acceleration

    def speeds(self, moves: Floats) -> Floats:
        """How many times straight moves (m, n, 3) can be made in a unit of time (m,), by the rates."""
        return _largest(self.robot, self._spreads[0], moves)

    def gains(self, moves: Floats) -> Floats:
        """How much `speeds` may change in a unit of time (m,), by the accelerations."""
        return _largest(self.robot, self._spreads[1], moves)

    @cached_property
    def _spreads(self) -> tuple[Spread | None, Spread | None]:
        """Rates and accelerations of every segment and actuator."""
        both = self.rates, self.accelerations
        rates, accelerations = (None if each is None else each.spread(self.robot) for each in both)
        return rates, accelerations

    def least(self, moves: Floats) -> Floats:
        """Least durations (m,) of straight moves (m, n, 3) that the rates allow: a lower bound of those of any way."""
        durations: Floats = 1.0 / self.speeds(moves)
        return durations

    def soonest(self, move: Floats) -> float:
        """Return a lower bound of the duration of any way from rest to rest whose ends differ by `move` (n, 3).

        Under an acceleration a it takes at least 2 sqrt(d / a) to get as far as d.
        """
        return max(float(self.least(move[None])[0]), 2.0 / float(np.sqrt(self.gains(move[None])[0])))

    def clear(self, q0: Floats, q1: Floats, t0: float, t1: float) -> Floats | None:
        """Return what is proved of a step (14,), `None` where it is not clear."""
        pair, times = np.stack([q0, q1]), np.array([t0, t1])
        answer: Floats = self.prover.prove(pair, 1.0, LOOSE_SECONDS, times)[0]
        return answer if answer[VERDICT] == CLEAR else None

    def passes(self, q0: Floats, q1: Floats, t0: float, t1: float) -> Floats | None:
        """Return the same for a step that may be too quick for the rates: `None` where it is."""
        if t1 <= t0 or self.least((q1 - q0)[None])[0] > (t1 - t0) * (1.0 + ROUNDING):
            return None
        return self.clear(q0, q1, t0, t1)

    def tightened(self, way: TimedWay) -> TimedWay:
        """Join steps where that is clear, and bound the clearances of what is left as tightly as is usual.

        Where accelerations are limited no steps are joined: the speed would change more in the corners that are left.
        """
        q, times, answers = [way.q[0]], [way.times[0]], []
        at, last = 0, len(way.q) - 1
        while at < last:
            far = last - at if self.accelerations is None else 1
            joined = None
            while far > 1 and joined is None:
                if self.seconds_left() > 0.0:
                    joined = self.passes(q[-1], way.q[at + far], times[-1], way.times[at + far])
                far = far if joined is not None else far // 2
            answer = way.answers[at] if joined is None else joined
            at += max(1, far)
            tight = self.prover.prove(
                np.stack([q[-1], way.q[at]]), SLACK, LOOSE_SECONDS, np.array([times[-1], way.times[at]])
            )[0]
            q.append(way.q[at])
            times.append(way.times[at])
            answers.append(tight if tight[VERDICT] == CLEAR else answer)
        return TimedWay(np.stack(q), np.array(times), np.stack(answers))


def _largest(robot: Robot, most: Spread | None, moves: Floats) -> Floats:
    """Return the largest multiple of each move (m, n, 3) that is allowed (m,); infinite where nothing limits it."""
    return np.full(len(moves), np.inf) if most is None else largest(robot, most, moves)
