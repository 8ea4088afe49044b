"""A robot as a body of arcs: the tables that the kernels of statics read."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels.statics import layout as t
from sinuous.model.loads import Force, Load

if TYPE_CHECKING:
    from sinuous.model.robot import Robot
    from sinuous.model.segment import Segment

GIVE = 1e-4
"""How much a tendon without a stiffness stretches, relative to what bends of the body give way to its tension."""

KEPT = 64
"""Robots whose bodies are kept."""


class ElasticLines(NamedTuple):
    """Tendons and chambers that run through what gives, (t,) each.

    Attributes
    ----------
    actuators : ndarray of int
        Which of the actuators of the robot.
    sections : ndarray of int (t, 2)
        The first and the last segment that it runs through.
    arms : ndarray (t, 2)
    straight, pushes : ndarray of bool
    compliance : ndarray
    """

    actuators: NDArray[np.intp]
    sections: NDArray[np.intp]
    arms: Floats
    straight: NDArray[np.bool_]
    pushes: NDArray[np.bool_]
    compliance: Floats


class Tables(NamedTuple):
    """What a search for equilibria begins with; see `sinuous.kernels.statics.layout`.

    Attributes
    ----------
    arcs, loads, lines : ndarray (N, 22), (k, 10), (t, 10)
    slopes : int
        Rows for the lengths of lines in arcs.
    of_lines : ndarray (t, 3 n + 1)
        How lengths of lines follow the drive; see `sinuous.kernels.statics.drive`.
    states : ndarray (N, 4)
        The state without load.
    tensions : ndarray (t,)
    """

    arcs: Floats
    loads: Floats
    lines: Floats
    slopes: int
    of_lines: Floats
    states: Floats
    tensions: Floats

    def body(self, base: Floats) -> tuple[Floats, Floats, Floats, Floats, int]:
        """What kernels read of a body at rest: the pose of its base (4, 4) as a row, arcs, loads, lines and slopes."""
        return packing.pose_row(base), self.arcs, self.loads, self.lines, self.slopes

    def buffer(self) -> Floats:
        """Scratch for a search, or for derivatives."""
        from sinuous.kernels.statics.newton import workspace_size  # noqa: PLC0415

        return np.empty(workspace_size(len(self.arcs), len(self.lines), self.slopes))


class Body(NamedTuple):
    """What is the same in all configurations of a robot.

    Attributes
    ----------
    counts, ends : ndarray of int (n,)
        Arcs of every segment; the number of its last. Joints and links are segments of one arc here, which never give.
    owners : ndarray of int (N,)
        The segment of every arc, 0 = first.
    stiffness : ndarray (n, 3)
        EI, GJ and EA of every segment; infinite where it does not give.
    rest : ndarray (n, 2)
    pulled : ndarray of bool (n,)
        Whether tendons or chambers hold its bend, so that it has its own one without them.
    sections : ndarray (n, 23)
        The same as kernels read it, and weights per length.
    lines : ElasticLines
    line_table : ndarray (t, 10)
        The same as kernels read it, for no drive.
    carried : ndarray (k, 10)
        Loads of what the robot carries itself.
    """

    counts: NDArray[np.intp]
    ends: NDArray[np.intp]
    owners: NDArray[np.intp]
    stiffness: Floats
    rest: Floats
    pulled: NDArray[np.bool_]
    sections: Floats
    lines: ElasticLines
    line_table: Floats
    carried: Floats

    @property
    def gives(self) -> bool:
        """Whether anything gives way to loads."""
        return bool(np.isfinite(self.stiffness).any())

    @property
    def weights(self) -> Floats:
        """Of segments, per length (n, 3)."""
        return self.sections[:, t.HEAVY : t.SECTION_TAIL]

    @property
    def slopes(self) -> int:
        """Rows for the lengths of lines in arcs."""
        return int((self.line_table[:, t.LAST_ARC] - self.line_table[:, t.FIRST_ARC] + 1.0).sum())


@lru_cache(maxsize=KEPT)
def body_of(robot: "Robot") -> Body:
    """Return the body of a robot."""
    segments = robot.rows
    counts = np.array([segment.arcs for segment in segments], np.intp)
    gravity = np.zeros(3) if robot.gravity is None else robot.gravity
    stiffness = np.array([_stiffness(segment) for segment in segments])
    lines = _lines(robot, stiffness[:, 0])
    rest = np.array([segment.rest for segment in segments])
    pulled = np.isin(np.arange(len(segments)), lines.sections[:, 1])
    weights = np.array([segment.mass for segment in segments])[:, None] * gravity
    ends, tails = np.cumsum(counts) - 1, np.zeros((len(segments), t.TAIL_WIDTH))
    tails[:, 0] = [segment.rigid for segment in segments]
    for row, own in zip(tails, robot._rigid.rows, strict=False):
        row[1:] = packing.pose_row(own.tail)[0]
    return Body(
        counts,
        ends,
        np.repeat(np.arange(len(segments)), counts),
        stiffness,
        rest,
        pulled,
        np.concatenate([counts[:, None], stiffness, rest, pulled[:, None], weights, tails], axis=1),
        lines,
        _line_table(lines, counts, ends),
        _load_table(robot, ends, ()),
    )


def _stiffness(segment: "Segment") -> tuple[float, float, float]:
    own = segment.stiffness
    return (t.RIGID,) * 3 if own is None else (own.bend, own.twist, own.stretch)


def _lines(robot: "Robot", bending: Floats) -> ElasticLines:
    """Tendons and chambers through segments of these stiffnesses EI (n,)."""
    rows, at = [], 0
    lengths = np.array([0.5 * sum(segment.length) for segment in robot.rows])
    for k, segment in enumerate(robot.rows):
        for own, first in ((segment.tendons, robot.drive.before), (segment.chambers, k)):
            for j in range(0 if own is None else len(own.angles)):
                through = bending[first : k + 1]
                if own is not None and np.isfinite(through).any():
                    bent = float((lengths[first : k + 1] / through).sum())
                    stretch = 1.0 / own.stiffnesses[j] if own.stiffness is not None else GIVE * own.radius**2 * bent
                    rows.append((at + j, first, k, own.arms[j], getattr(own, "straight", False), first == k, stretch))
            at += 0 if own is None else len(own.angles)
        at += segment.stage is not None
    pushes = [robot.actuators[row[0]].kind == "chamber" for row in rows]
    return ElasticLines(
        np.array([row[0] for row in rows], np.intp),
        np.array([row[1:3] for row in rows], np.intp).reshape(-1, 2),
        np.array([row[3] for row in rows]).reshape(-1, 2),
        np.array([row[4] for row in rows], np.bool_),
        np.array(pushes, np.bool_),
        np.array([row[6] for row in rows], np.float64),
    )


def tables_of(robot: "Robot", q: Floats, loads: Sequence[Load], displacements: Floats | None = None) -> Tables:
    """Return the tables of a robot whose drive makes it `q` (n, 3) without load.

    Tendons and chambers have these `displacements` (m,), by default those that belong to `q`.
    """
    from sinuous.kernels.statics.drive import fill_body_tables  # noqa: PLC0415

    body = body_of(robot)
    if displacements is None and len(body.lines.actuators):
        displacements = robot.drive.displacements(q) + robot.drive.stretch(q)
    of_lines = lengths_of_lines(body, displacements)
    arcs, states = np.empty((len(body.owners), t.ARC_WIDTH)), np.empty((len(body.owners), t.STATE_WIDTH))
    lines = body.line_table.copy()
    fill_body_tables(body.sections, of_lines, np.array(q, np.float64, order="C"), arcs, lines, states)
    pulls = body.carried if len(loads) == 0 else _load_table(robot, body.ends, loads)
    return Tables(arcs, pulls, lines, body.slopes, of_lines, states, np.zeros(len(lines)))


def lengths_of_lines(body: Body, displacements: Floats | None, follow: Floats | None = None) -> Floats:
    """How lengths of lines follow the drive (t, 3 n + 1), for displacements (m,) of the actuators.

    These stay what they are, or change with the drive as `follow` (m, 3 n) says and are that for a drive of zero.
    """
    own, count = body.lines, len(body.counts)
    result = np.zeros((len(own.actuators), 3 * count + 1))
    if len(result):
        assert displacements is not None
        sides = np.where(own.pushes, 1.0, -1.0)
        result[:, -1] = sides * displacements[own.actuators]
        through = (np.arange(count) >= own.sections[:, :1]) & (np.arange(count) <= own.sections[:, 1:])
        result[:, 2:-1:3] = ~own.pushes[:, None] & through
        if follow is not None:
            result[:, :-1] += sides[:, None] * follow[own.actuators]
    return result


def _line_table(own: ElasticLines, counts: NDArray[np.intp], ends: NDArray[np.intp]) -> Floats:
    table = np.zeros((len(own.actuators), t.LINE_WIDTH))
    first, last = own.sections.T
    table[:, t.FIRST_ARC], table[:, t.LAST_ARC] = ends[first] - counts[first] + 1, ends[last]
    table[:, t.ARM : t.STRAIGHT] = own.arms
    table[:, t.STRAIGHT], table[:, t.HELD], table[:, t.PUSHES] = own.straight, 1.0, own.pushes
    table[:, t.COMPLIANCE] = own.compliance
    table[1:, t.FIRST_SLOPE] = np.cumsum(table[:-1, t.LAST_ARC] - table[:-1, t.FIRST_ARC] + 1.0)
    return table


def _load_table(robot: "Robot", ends: NDArray[np.intp], loads: Sequence[Load]) -> Floats:
    """The rows of loads, and of what the robot carries, in the order of their arcs."""
    listed = [*robot.payload, *loads]
    table = np.zeros((len(listed), t.LOAD_WIDTH))
    for row, load in zip(table, listed, strict=True):
        row[t.LOAD_ARC] = ends[robot.end_row(load.segment) - 1]
        row[t.LOAD_OFFSET :] = load.position
        if isinstance(load, Force):
            row[t.FORCE : t.MOMENT], row[t.MOMENT : t.LOAD_OFFSET] = load.force, load.moment
        elif robot.gravity is not None:
            row[t.FORCE : t.MOMENT] = load.mass * robot.gravity
    return table[np.argsort(table[:, t.LOAD_ARC], kind="stable")]


def unrolled(states: Floats) -> Floats:
    """Bodies (..., N, 3) as robots of arcs, in states (..., N, 4): bends turned so that none is twisted."""
    twists = states[..., t.TORSION]
    turns = np.cumsum(twists, axis=-1) - twists
    cosine, sine = np.cos(turns), np.sin(turns)
    result = np.empty((*twists.shape, 3))
    result[..., 0] = cosine * states[..., 0] - sine * states[..., 1]
    result[..., 1] = sine * states[..., 0] + cosine * states[..., 1]
    result[..., 2] = states[..., t.LENGTH]
    return result


def rolled(angle: float) -> Floats:
    """Return a roll about z as a pose (4, 4)."""
    result = np.eye(4)
    result[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return result
