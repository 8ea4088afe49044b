"""The straight line of the tip from one waypoint to the next, and the knots of a motion along it."""

import math
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.kernels.certificate.query import ANSWER_WIDTH
from sinuous.kernels.tables import Outcome
from sinuous.problem.target import Target


class TipLine:
    """The straight line from one target of the tip to another: positions on a line, orientations on a great circle.

    Parameters
    ----------
    begin, end : Target
        Both with a position, for the tip, and both with the same kind of orientation or none.
    """

    def __init__(self, begin: Target, end: Target) -> None:
        self.begin, self.end = begin, end

    @classmethod
    def between(cls, begin: tuple[Target, ...] | None, end: tuple[Target, ...]) -> "TipLine | None":
        """Return the straight line from one waypoint to the next; `None` where they do not ask for the same."""
        if begin is None or len(begin) != 1 or len(end) != 1 or _kind(begin[0]) != _kind(end[0]):
            return None
        return None if end[0].position is None or end[0].segment is not None else cls(begin[0], end[0])

    @property
    def oriented(self) -> bool:
        """Whether an orientation is asked of the tip."""
        return self.begin.direction is not None or self.begin.rotation is not None

    @property
    def length(self) -> float:
        """How far it is from one end to the other (length unit)."""
        assert self.begin.position is not None
        assert self.end.position is not None
        return float(np.linalg.norm(self.end.position - self.begin.position))

    @cached_property
    def angle(self) -> float:
        """How far the tip turns along it (rad)."""
        one, other = self.begin, self.end
        if one.direction is not None and other.direction is not None:
            return 2.0 * math.asin(min(1.0, 0.5 * float(np.linalg.norm(one.direction - other.direction))))
        if one.rotation is not None and other.rotation is not None:
            # The chord between two rotations is 2 sqrt(2) sin(angle / 2).
            chord = float(np.linalg.norm(one.rotation - other.rotation))
            return 2.0 * math.asin(min(1.0, chord / math.sqrt(8.0)))
        return 0.0

    def at(self, share: float) -> Target:
        """Return what is asked of the tip at a share of the line, from 0 to 1."""
        direction = None if self.begin.direction is None else self.direction(share)
        rotation = None if self.begin.rotation is None else self.rotations(share)
        return Target(self._place(share), direction=direction, rotation=rotation)

    def direction(self, share: float | Floats) -> Floats:
        """Return where the tangent points at a share of the line, or at many, where it is asked to point anywhere."""
        assert self.begin.direction is not None
        assert self.end.direction is not None
        if self._great_circle is None:
            return self.begin.direction if isinstance(share, float) else np.tile(self.begin.direction, (len(share), 1))
        across, whole = self._great_circle
        if isinstance(share, float):
            return math.cos(share * whole) * self.begin.direction + math.sin(share * whole) * across
        angles = share[:, None] * whole
        return np.asarray(np.cos(angles) * self.begin.direction + np.sin(angles) * across)

    @cached_property
    def _great_circle(self) -> tuple[Floats, float] | None:
        """Where the direction turns to (3,) and by how much (rad), opposite ones about any axis; `None` of the same."""
        assert self.begin.direction is not None
        assert self.end.direction is not None
        a, b = self.begin.direction, self.end.direction
        along = float(a @ b)
        across = b - along * a
        length = float(np.linalg.norm(across))
        if length < 1e-12:
            if along > 0.0:
                return None
            across = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
            length = float(np.linalg.norm(across))
        return across / length, math.atan2(length if along > -1.0 else 0.0, along)

    def rotations(self, share: float | Floats) -> Floats:
        """Return the orientation (3, 3) at a share of the line, or at many (k, 3, 3), where one is asked for."""
        assert self.begin.rotation is not None
        angle, axis = self._turn
        angles = np.asarray(share)[..., None, None] * angle
        turned = np.eye(3) + np.sin(angles) * axis + (1.0 - np.cos(angles)) * (axis @ axis)
        return np.asarray(self.begin.rotation @ turned)

    @cached_property
    def _turn(self) -> tuple[float, Floats]:
        """The angle (rad) from one rotation to the other, and the cross product with its axis (3, 3)."""
        from scipy.spatial.transform import Rotation  # noqa: PLC0415  # as long as all of this package

        assert self.begin.rotation is not None
        assert self.end.rotation is not None
        turn = Rotation.from_matrix(self.begin.rotation.T @ self.end.rotation).as_rotvec()
        angle = float(np.linalg.norm(turn))
        x, y, z = turn / max(angle, 1e-300)
        return angle, np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])

    def shares_of(self, poses: Floats) -> Floats:
        """Return the shares (k,) of the line that are nearest to poses (k, 4, 4): by places, or of a turn by angles."""
        assert self.begin.position is not None
        assert self.end.position is not None
        along = self.end.position - self.begin.position
        square = float(along @ along)
        if square > 0.0:
            return np.clip((poses[:, :3, 3] - self.begin.position) @ along / square, 0.0, 1.0)
        if self.angle == 0.0:
            return np.zeros(len(poses))
        if self.begin.rotation is None:
            ahead = self.direction(0.5 * math.pi / self.angle)  # across the first direction, in the plane of the turn
            sine, cosine = poses[:, :3, 2] @ ahead, poses[:, :3, 2] @ self.direction(0.0)
        else:
            turned = self.begin.rotation.T @ poses[:, :3, :3]
            sine = 0.5 * (turned * self._turn[1]).sum(axis=(1, 2))
            cosine = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1.0)
        return np.asarray(np.clip(np.arctan2(sine, cosine) / self.angle, 0.0, 1.0))

    def turned(self, poses: Floats, shares: Floats) -> float:
        """How far poses (k, 4, 4) are turned from the line at shares (k,) of it, at most (rad)."""
        if self.begin.direction is not None:
            cosines = poses[:, :3, 2] @ self.begin.direction
            if self._great_circle is not None:
                across, whole = self._great_circle
                angles = shares * whole
                cosines = np.cos(angles) * cosines + np.sin(angles) * (poses[:, :3, 2] @ across)
            return math.acos(max(-1.0, min(1.0, float(cosines.min()))))
        if self.begin.rotation is None:
            return 0.0
        # The chord between two rotations is 2 sqrt(2) sin(angle / 2).
        chord = float(np.linalg.norm(poses[:, :3, :3] - self.rotations(shares), axis=(1, 2)).max())
        return 2.0 * math.asin(min(1.0, chord / math.sqrt(8.0)))

    @cached_property
    def turn_rows(self) -> Floats:
        """How the tip turns along it (5, 3), where an orientation is asked; see `kernels.certificate.tip.turn_off`."""
        rows = np.zeros((5, 3))
        if self.begin.rotation is not None:
            _, cross = self._turn
            rows[0] = self.begin.rotation @ [cross[2, 1], cross[0, 2], cross[1, 0]]
            rows[1], rows[2:] = (self._turn[0], 3.0, 0.0), self.begin.rotation.T
            return rows
        assert self.begin.direction is not None
        rows[1, 1], rows[2] = 1.0, self.begin.direction
        if self._great_circle is not None:
            across, rows[1, 0] = self._great_circle
            rows[0] = np.cross(self.begin.direction, across)
        return rows

    def draw(self, shares: tuple[float, float], line: Floats) -> None:
        """Fill `line` (2, 3) with where the tip is meant to be at two shares of the line."""
        line[0], line[1] = self._place(shares[0]), self._place(shares[1])

    def _place(self, share: float) -> Floats:
        assert self.begin.position is not None
        assert self.end.position is not None
        if share in (0.0, 1.0):  # the waypoints themselves, to the last digit
            return self.end.position if share else self.begin.position
        return (1.0 - share) * self.begin.position + share * self.end.position


def _kind(target: Target) -> tuple[bool, bool, bool, int | None]:
    asked = (target.position, target.direction, target.rotation)
    position, direction, rotation = (one is not None for one in asked)
    return position, direction, rotation, target.segment


class Knot(NamedTuple):
    """A configuration of the motion, and the step that leads there.

    Attributes
    ----------
    q : ndarray (n, 3)
    proof : ndarray (1, 14) or None
        What is proved of the step that leads there; the first knot has none.
    targets : tuple of Target
        What is asked there; nothing on a path around obstacles.
    solution : Solution or None
        The one that it was taken from.
    line : TipLine or None
        The line that the tip follows in the step that leads there, where it has to.
    shares : (float, float)
        The part of that line.
    fixed : bool
        Whether it has to stay: the start.
    time : float
        When the robot is there, where obstacles move.
    """

    q: Floats
    proof: Floats | None
    targets: tuple[Target, ...] = ()
    solution: Solution | None = None
    line: TipLine | None = None
    shares: tuple[float, float] = (0.0, 1.0)
    fixed: bool = False
    time: float = 0.0

    @property
    def clear(self) -> tuple[float, float]:
        """Proved clearance and self-clearance there; 0 where they are not known."""
        if self.solution is None or not self.solution.solved:
            return 0.0, 0.0
        outcome = self.solution._outcome
        return outcome.clearance, outcome.self_clearance

    @property
    def begin(self) -> Solution | Floats:
        """What a solve may go on from there: the solution, which is not checked again, if there is one."""
        return self.q if self.solution is None else self.solution


class TrackedWaypoint(NamedTuple):
    """What a waypoint added.

    Attributes
    ----------
    outcome : Outcome
        Of its solve.
    solve_seconds : float
        Of that alone.
    knots : list of Knot
        Those that lead there. They stay where they are.
    reconfigured : bool
    approaches : bool
        Whether the way from the start to the first waypoint is a step of its own.
    seconds : float
        Of all the work up to here.
    """

    outcome: Outcome
    solve_seconds: float
    knots: list[Knot]
    reconfigured: bool
    approaches: bool
    seconds: float


def write_entry(entry: TrackedWaypoint) -> dict[str, Any]:
    """Return plain values, numbers to the last digit; some may be infinite or NaN."""
    knots = [
        [knot.q.tolist(), None if knot.proof is None else knot.proof[0].tolist(), knot.time] for knot in entry.knots
    ]
    return {**entry._asdict(), "outcome": write_outcome(entry.outcome), "knots": knots}


def read_entry(values: dict[str, Any], segments: int) -> TrackedWaypoint:
    """Return what `write_entry` wrote.

    Raises
    ------
    KeyError, TypeError, ValueError
        When it is something else.
    """
    knots = [
        Knot(
            _configuration(q, segments),
            None if came is None else np.array(came, np.float64).reshape(1, ANSWER_WIDTH),
            fixed=True,
            time=float(time),
        )
        for q, came, time in values["knots"]
    ]
    rest = {key: values[key] for key in ("solve_seconds", "reconfigured", "approaches", "seconds")}
    return TrackedWaypoint(read_outcome(values["outcome"], segments), knots=knots, **rest)


def write_outcome(outcome: Outcome) -> dict[str, Any]:
    """Return what was found by a solve as plain values; see `write_entry`."""
    entries = outcome._asdict().items()
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in entries}


def read_outcome(values: dict[str, Any], segments: int) -> Outcome:
    """Return what `write_outcome` wrote; see `read_entry`."""
    route = None if values["route"] is None else np.array(values["route"], np.float64).reshape(-1, 3)
    return Outcome(**{**values, "q": _configuration(values["q"], segments), "route": route})


def _configuration(values: list[list[float]], segments: int) -> Floats:
    return np.array(values, np.float64).reshape(segments, 3)
