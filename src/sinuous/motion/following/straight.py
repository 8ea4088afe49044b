"""The straight way of the tip from one waypoint to the next, and how far a motion leaves it."""

import math

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from sinuous.checks import Floats
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot

LOOKS = 8
"""Pieces of a step between whose ends the tip's way is looked at, where the bound alone is not enough."""


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

    def deviation(self, robot: Robot, ends: tuple[Floats, Floats], shares: tuple[float, float], enough: float) -> float:
        """Return an upper bound of how far the tip is from the line while it moves from one share of it to another.

        Parameters
        ----------
        robot : Robot
        ends : (ndarray (n, 3), ndarray (n, 3))
            First and last configuration of the step, linear in q.
        shares : (float, float)
            Where on the line these are meant to be.
        enough : float
            What is not above this need not be bounded more tightly (length unit).
        """
        acceleration = tip_acceleration(ends[0].tolist(), ends[1].tolist())
        if acceleration <= 8.0 * enough:  # both ends are on the line, within the tolerance of their targets
            return acceleration / 8.0
        t = np.linspace(0.0, 1.0, LOOKS + 1)[:, None, None]
        tips = robot.tip((1.0 - t) * ends[0] + t * ends[1])[:, :3, 3]
        return _distance(tips, self._place(shares[0]), self._place(shares[1])) + acceleration / (8.0 * LOOKS * LOOKS)

    def _place(self, share: float) -> Floats:
        assert self.begin.position is not None
        assert self.end.position is not None
        place: Floats = (1.0 - share) * self.begin.position + share * self.end.position
        return place


def tip_acceleration(q0: list[list[float]], q1: list[list[float]]) -> float:
    """Return an upper bound of the tip's acceleration while q goes linearly from `q0` to `q1` (n, 3) in a unit of time.

    So the tip stays within an eighth of it of the chord of its way. Derivation: `kernels.between.sweep`.
    """
    total = turning = 0.0
    for (x0, y0, l0), (x1, y1, l1) in zip(q0, q1, strict=True):
        before, turning = turning, turning + math.hypot(x1 - x0, y1 - y0)
        total += max(l0, l1) * (before * before + before * turning + turning * turning) / 3.0
        total += abs(l1 - l0) * (before + turning)
    return total


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


def _distance(points: Floats, a: Floats, b: Floats) -> float:
    """Largest distance of points (k, 3) from the line segment between two places."""
    along = b - a
    square = float(along @ along)
    share = np.clip((points - a) @ along / square, 0.0, 1.0) if square > 0.0 else np.zeros(len(points))
    return float(np.linalg.norm(points - a - share[:, None] * along, axis=-1).max())
