"""The straight way of the tip from one waypoint to the next, and how far a motion leaves it."""

import math

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from sinuous import packing
from sinuous.checks import Floats
from sinuous.kernels.between.tip import leave_line
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot


class Straight:
    """The straight way from one target of the tip to another: positions on a line, orientations on a great circle.

    Parameters
    ----------
    begin, end : Target
        Both with a position, for the tip, and both with the same kind of orientation or none.
    """

    def __init__(self, begin: Target, end: Target) -> None:
        self.begin, self.end = begin, end

    @classmethod
    def between(cls, begin: tuple[Target, ...] | None, end: tuple[Target, ...]) -> "Straight | None":
        """Return the straight way from one waypoint to the next; `None` where they do not ask for the same."""
        if begin is None or len(begin) != 1 or len(end) != 1 or _kind(begin[0]) != _kind(end[0]):
            return None
        return None if end[0].position is None or end[0].segment is not None else cls(begin[0], end[0])

    def at(self, share: float) -> Target:
        """Return what is asked of the tip at a share of the way, from 0 to 1."""
        direction = rotation = None
        if self.begin.direction is not None and self.end.direction is not None:
            direction = _turned(self.begin.direction, self.end.direction, share)
        if self.begin.rotation is not None and self.end.rotation is not None:
            ends = Rotation.from_matrix(np.stack([self.begin.rotation, self.end.rotation]))
            rotation = Slerp([0.0, 1.0], ends)(share)
        return Target(self._place(share), direction=direction, rotation=rotation)

    def draw(self, shares: tuple[float, float], line: Floats) -> None:
        """Fill `line` (2, 3) with where the tip is meant to be at two shares of the way."""
        line[0], line[1] = self._place(shares[0]), self._place(shares[1])

    def _place(self, share: float) -> Floats:
        assert self.begin.position is not None
        assert self.end.position is not None
        if share in (0.0, 1.0):
            return self.end.position if share else self.begin.position
        place: Floats = (1.0 - share) * self.begin.position + share * self.end.position
        return place


class Tip:
    """Bounds how far the tip of a robot leaves straight lines, one motion after the other.

    Parameters
    ----------
    robot : Robot
    """

    def __init__(self, robot: Robot) -> None:
        self._group, self._q = packing.robot_group(robot), np.empty((len(robot), 3))
        self._frames, self._line = np.empty((len(robot) + 1, 12)), np.zeros((2, 3))
        self._bound(np.zeros((2, len(robot), 3)), 0.0)  # compiled, or loaded

    def deviation(self, ends: Floats, way: Straight, shares: tuple[float, float], enough: float) -> float:
        """Return an upper bound of how far the tip is from the line while it moves from one share of it to another.

        Parameters
        ----------
        ends : ndarray (2, n, 3)
            First and last configuration of the step, linear in q.
        way : Straight
        shares : (float, float)
            Where on the line these are meant to be.
        enough : float
            What is not above this need not be bounded more tightly (length unit).
        """
        way.draw(shares, self._line)
        return self._bound(ends, enough)

    def _bound(self, ends: Floats, enough: float) -> float:
        bound: float = leave_line(self._group, ends, self._line, enough, self._q, self._frames)
        return bound


def _kind(target: Target) -> tuple[bool, bool, bool, int | None]:
    asked = (target.position, target.direction, target.rotation)
    position, direction, rotation = (one is not None for one in asked)
    return position, direction, rotation, target.segment


def _turned(a: Floats, b: Floats, share: float) -> Floats:
    """Turn unit vector `a` by a share of the angle to `b`; opposite ones about any axis across."""
    across = b - (a @ b) * a
    length = float(np.linalg.norm(across))
    if length < 1e-12:
        if a @ b > 0.0:
            return a
        across = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
        length = float(np.linalg.norm(across))
    angle = share * math.atan2(length if a @ b > -1.0 else 0.0, float(a @ b))
    turned: Floats = math.cos(angle) * a + math.sin(angle) * across / length
    return turned
