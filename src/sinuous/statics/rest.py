"""A body at rest under load, as searches and proofs read it: quickly found from one beside it, without the noun."""

from collections.abc import Callable, Sequence
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels.statics import layout as t
from sinuous.model.robot import Robot
from sinuous.statics.body import Tables, body_of, lengths_of_lines, rolled, tables_of, unrolled
from sinuous.statics.equilibrium import longest_body, run

STEP = 1e-6
"""Of a coordinate, rad or length, by which stretches are seen to change: they are linear in pieces."""


class Rest:
    """The equilibrium under gravity and payload at a drive `q`; see `Equilibrium`.

    Parameters
    ----------
    robot : Robot
    q : ndarray (n, 3)
    before : Rest, optional
        Whose state the search begins in.
    displacements : ndarray (m,), optional
        Of the actuators; by default those that belong to `q`.

    Attributes
    ----------
    tables : Tables
    states : ndarray (N, 4) or None
        `None` where no stable equilibrium was found.
    tensions : ndarray (t,)
    """

    states: Floats | None
    tensions: Floats

    def __init__(
        self, robot: Robot, q: Floats, before: "Rest | None" = None, displacements: Floats | None = None
    ) -> None:
        from sinuous.kernels.statics.equilibrium import UNSTABLE  # noqa: PLC0415

        self.robot, self.q, self.displacements = robot, q, displacements
        if displacements is None and robot.drive.elastic is not None:
            self.displacements = robot.drive.displacements(q) + robot.drive.stretch(q)
        self.tables: Tables = tables_of(robot, q, (), self.displacements)
        begin = self.tables
        if before is not None and before.states is not None:
            change = self.tables.states - before.tables.states
            begin = begin._replace(states=before.states + change, tensions=before.tensions)
        found = run(robot, begin)
        self.states = None
        if found.reached >= 1.0 and found.record[UNSTABLE] == 0.0:
            self.states, self.tensions = found.states, found.tensions

    @cached_property
    def slopes(self) -> Floats:
        """How the states change with the drive (3 n, N, 4): the derivative of the equilibrium."""
        from sinuous.kernels.statics.drive import differentiate_equilibrium  # noqa: PLC0415

        robot, tables, found = self.robot, self.tables, self.found
        columns, pulls = np.empty((self.q.size, *found[0].shape)), np.empty((self.q.size, len(tables.lines)))
        drive = body_of(robot).sections, lines_that_follow(robot, self.q), np.array(self.q, order="C")
        differentiate_equilibrium(*tables.body(robot.base), *found, *drive, tables.buffer(), columns, pulls)
        return columns

    def answers(self, beside: Sequence[Tables], steps: Floats) -> Floats:
        """How the states change with p parameters (p, N, 4): tables with so much (p,) more of each."""
        from sinuous.kernels.statics.table_derivatives import differentiate_by_tables  # noqa: PLC0415

        own, found, over = self.tables, self.found, 1.0 / steps
        stiffness = own.arcs[:, [t.BEND_STIFFNESS, t.BEND_STIFFNESS, t.TORSION_STIFFNESS, t.STRETCH_STIFFNESS]]
        given = np.array([np.where(np.isinf(stiffness), each.states - own.states, 0.0) for each in beside])
        arcs, loads = np.array([each.arcs for each in beside]), np.array([each.loads for each in beside])
        others = arcs, loads, np.array([each.lines for each in beside])
        columns, pulls = np.empty((len(over), *found[0].shape)), np.empty((len(over), len(own.lines)))
        differentiate_by_tables(*own.body(self.robot.base), *found, *others, given, over, own.buffer(), columns, pulls)
        return columns

    @property
    def pulls(self) -> Floats:
        """Tensions of all actuators (m,), NaN of what is no line through what gives."""
        result = np.full(len(self.robot.drive), np.nan)
        result[body_of(self.robot).lines.actuators] = self.tensions
        return result

    @property
    def found(self) -> tuple[Floats, Floats]:
        """States and tensions."""
        assert self.states is not None
        return self.states, self.tensions

    @cached_property
    def tensions_kept(self) -> bool:
        """Whether there is an equilibrium, and the tensions of lines that stretch are within their limits."""
        return self.states is not None and not self.robot.limit_set.tension_violations(self.pulls)

    @cached_property
    def rolls(self) -> Floats:
        """By how much the ends of all arcs have rolled (N,), rad."""
        assert self.states is not None
        return np.cumsum(self.states[:, t.TORSION])

    @cached_property
    def arcs(self) -> Floats:
        """Configuration (N, 3) of the body as a robot of arcs, see `unrolled`."""
        return unrolled(self.found[0])

    def beside(self, coordinates: NDArray[np.intp], steps: Floats) -> Floats:
        """The same (c, N, 3) at drives of which one of the coordinates (c,) is a small step (c,) away: linear in it."""
        return unrolled(self.found[0] + steps[:, None, None] * self.slopes[coordinates])

    @property
    def shown(self) -> Floats:
        """The same; as nothing loads it, where no equilibrium was found."""
        return self.tables.states[:, [0, 1, 3]] if self.states is None else self.arcs

    @cached_property
    def frames(self) -> Floats:
        """Frames (1, N + 1, 12) of the base and of the ends of all arcs, without their roll."""
        from sinuous.kernels.chain import batch  # noqa: PLC0415

        result = np.empty((1, len(self.arcs) + 1, 12))
        rows = longest_body(self.robot).limits.copy() if self.robot.joints else packing.plain_rows(len(self.arcs))
        batch.frames_of(rows, self.arcs[None], packing.pose_row(self.robot.base), result)
        return result

    def pose(self, segment: int | None) -> Floats:
        """Pose (4, 4) of the end of a segment (1 = first), or of the tool."""
        own = body_of(self.robot)
        last = self.robot.end_row(segment)
        end, at_tip = own.ends[last - 1], last == len(self.robot)
        row, pose = self.frames[0, end + 1], np.eye(4)
        pose[:3, :3], pose[:3, 3] = row[:9].reshape(3, 3), row[9:]
        pose = pose @ rolled(float(self.rolls[end]))
        return pose @ self.robot.tool if at_tip else pose


def kept_rests(robot: Robot, most: int | None = None) -> Callable[[Floats], Rest]:
    """Return what finds the body at rest at a drive (n, 3); those at the last drives, so many at most, are kept."""
    rest = lru_cache(most)(lambda numbers: Rest(robot, np.frombuffer(numbers).reshape(-1, 3).copy()))
    return lambda q: rest(q.tobytes())


def lines_that_follow(robot: Robot, q: Floats) -> Floats:
    """How lengths of lines follow the drive near `q` (n, 3), see `lengths_of_lines`: stretches in one piece of them."""
    own, drive = body_of(robot), robot.drive
    if len(own.line_table) == 0 or drive.elastic is None:
        return lengths_of_lines(own, np.zeros(len(drive)), drive.jacobian)
    steps = np.concatenate([np.zeros((1, q.size)), STEP * np.eye(q.size)])
    stretch = drive.stretch(q + steps.reshape(-1, *q.shape))
    follow = drive.jacobian + (stretch[1:] - stretch[0]).T / STEP
    return lengths_of_lines(own, drive.displacements(q) + stretch[0] - follow @ q.ravel(), follow)


class Way:
    """The state that is linear between two shapes, while the motors run evenly from one to the other.

    Parameters
    ----------
    one, other : Rest
        Both in equilibrium, of one robot.
    """

    def __init__(self, one: Rest, other: Rest) -> None:
        self._one, self._other = one, other

    def drive(self, share: float) -> tuple[Floats, Floats | None]:
        """Where the drive is at a share of the way (n, 3), and the displacements of actuators (m,) that stretch."""
        one, other = self._one, self._other
        q: Floats = (1.0 - share) * one.q + share * other.q
        if one.displacements is None or other.displacements is None:
            return q, None
        return q, (1.0 - share) * one.displacements + share * other.displacements

    def rest(self, share: float) -> Rest:
        """The loaded body there, looked for from the first shape."""
        q, displacements = self.drive(share)
        return Rest(self._one.robot, q, self._one, displacements)


def bodies_at(robot: Robot, q: Floats) -> tuple[Robot, Floats]:
    """The body of a robot and its shapes (T, N, 3) at drives (T, n, 3); the robot and `q` where nothing bends it."""
    if not robot.has_external_load:
        return robot, q
    body = longest_body(robot)
    return body, np.array([Rest(robot, one).shown for one in q]).reshape(-1, len(body), 3)


def stretches_allowed(robot: Robot) -> Floats:
    """Least and most that lines under load (t, 2) may stretch, as their limits of tension say; those may be slack."""
    own, limits = body_of(robot).lines, robot.limit_set.tensions.copy()
    limits[limits[:, 0] <= 0.0, 0] = -np.inf
    return limits[own.actuators] * own.compliance[:, None]


def pulls_at(robot: Robot, q: Floats) -> Floats | None:
    """Tensions (m,) of all actuators that a load needs at a drive (n, 3); `None` without one, or any equilibrium."""
    if not robot.has_external_load or np.isinf(robot.limit_set.tensions).all():
        return None
    rest = Rest(robot, np.array(q, order="C"))
    return None if rest.states is None else rest.pulls
