"""The straight way of the tip from one waypoint to the next, and how far a motion leaves it."""

import math

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from sinuous.checks import Floats
from sinuous.problem.target import Target


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
        if share in (0.0, 1.0):  # the waypoints themselves, to the last digit
            return self.end.position if share else self.begin.position
        place: Floats = (1.0 - share) * self.begin.position + share * self.end.position
        return place


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
