"""The straight line of the tip from one waypoint to the next, and the knots of a motion along it."""

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.kernels.certificate.query import ANSWER_WIDTH
from sinuous.kernels.tables import Outcome
from sinuous.problem.target import Target

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation


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

    def at(self, share: float) -> Target:
        """Return what is asked of the tip at a share of the line, from 0 to 1."""
        direction = None if self.begin.direction is None else self.direction(share)
        rotation = None if self.begin.rotation is None else self.rotation(share)
        return Target(self._place(share), direction=direction, rotation=rotation)

    def direction(self, share: float) -> Floats:
        """Return where the tangent points at a share of the line, where it is asked to point anywhere."""
        assert self.begin.direction is not None
        assert self.end.direction is not None
        return _turned(self.begin.direction, self.end.direction, share)

    def rotation(self, share: float | Floats) -> "Rotation":
        """Return the orientation at a share of the line, or at many, where one is asked for."""
        from scipy.spatial.transform import Rotation, Slerp  # noqa: PLC0415  # as long as all of this package

        assert self.begin.rotation is not None
        assert self.end.rotation is not None
        ends = Rotation.from_matrix(np.stack([self.begin.rotation, self.end.rotation]))
        return Slerp([0.0, 1.0], ends)(share)

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
    return math.cos(angle) * a + math.sin(angle) * across / length


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
