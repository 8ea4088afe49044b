"""A robot as a body of arcs: the tables that the kernels of statics read."""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.checks import Floats
from sinuous.kernels.statics import layout as t
from sinuous.robot.loads import Force, Load

if TYPE_CHECKING:
    from sinuous.robot.robot import Robot
    from sinuous.robot.segment import Segment

GIVE = 1e-4
"""How much a tendon without a stiffness stretches, relative to what bends of the body give way to its tension."""

KEPT = 64
"""Robots whose bodies are kept."""


class Lines(NamedTuple):
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
    arcs, loads, lines : ndarray (N, 9), (k, 10), (t, 10)
    slopes : int
        Rows for the lengths of lines in arcs.
    states : ndarray (N, 4)
        The state without load.
    tensions : ndarray (t,)
    """

    arcs: Floats
    loads: Floats
    lines: Floats
    slopes: int
    states: Floats
    tensions: Floats


class Body(NamedTuple):
    """What is the same in all configurations of a robot.

    Attributes
    ----------
    counts, ends : ndarray of int (n,)
        Arcs of every segment; the number of its last.
    owners : ndarray of int (N,)
        The segment of every arc, 0 = first.
    stiffness : ndarray (n, 3)
        EI, GJ and EA of every segment; infinite where it does not give.
    rest : ndarray (n, 2)
    pulled : ndarray of bool (n,)
        Whether tendons or chambers hold its bend, so that it has its own one without them.
    weights : ndarray (n, 3)
        Per length.
    lines : Lines
    carried : ndarray (k, 10)
        Loads of what the robot carries itself.
    """

    counts: NDArray[np.intp]
    ends: NDArray[np.intp]
    owners: NDArray[np.intp]
    stiffness: Floats
    rest: Floats
    pulled: NDArray[np.bool_]
    weights: Floats
    lines: Lines
    carried: Floats

    @property
    def gives(self) -> bool:
        """Whether anything gives way to loads."""
        return bool(np.isfinite(self.stiffness).any())


@lru_cache(maxsize=KEPT)
def body_of(robot: "Robot") -> Body:
    """Return the body of a robot."""
    segments = robot.segments
    counts = np.array([segment.arcs for segment in segments], np.intp)
    gravity = np.zeros(3) if robot.gravity is None else robot.gravity
    stiffness = np.array([_stiffness(segment) for segment in segments])
    lines = _lines(robot, stiffness[:, 0])
    return Body(
        counts,
        np.cumsum(counts) - 1,
        np.repeat(np.arange(len(segments)), counts),
        stiffness,
        np.array([segment.rest for segment in segments]),
        np.isin(np.arange(len(segments)), lines.sections[:, 1]),
        np.array([segment.mass for segment in segments])[:, None] * gravity,
        lines,
        _load_table(robot, np.cumsum(counts) - 1, ()),
    )


def _stiffness(segment: "Segment") -> tuple[float, float, float]:
    own = segment.stiffness
    return (t.RIGID,) * 3 if own is None else (own.bend, own.twist, own.stretch)


def _lines(robot: "Robot", bending: Floats) -> Lines:
    """Tendons and chambers through segments of these stiffnesses EI (n,)."""
    rows, at = [], 0
    lengths = np.array([0.5 * sum(segment.length) for segment in robot.segments])
    for k, segment in enumerate(robot.segments):
        for own, first in ((segment.tendons, 0), (segment.chambers, k)):
            for j in range(0 if own is None else len(own.angles)):
                through = bending[first : k + 1]
                if own is not None and np.isfinite(through).any():
                    bent = float((lengths[first : k + 1] / through).sum())
                    stretch = 1.0 / own.stiffnesses[j] if own.stiffness is not None else GIVE * own.radius**2 * bent
                    rows.append((at + j, first, k, own.arms[j], getattr(own, "straight", False), first == k, stretch))
            at += 0 if own is None else len(own.angles)
        at += segment.stage is not None
    pushes = [robot.actuators[row[0]].kind == "chamber" for row in rows]
    return Lines(
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
    body = body_of(robot)
    own = q[:, 2] / body.counts
    arcs = np.zeros((len(body.owners), t.ARC_WIDTH))
    if own.min() > 0.0:
        stiffness = body.stiffness / own[:, None]
    else:
        with np.errstate(divide="ignore", invalid="ignore"):
            stiffness = np.where(own[:, None] > 0.0, body.stiffness / own[:, None], t.RIGID)
    arcs[:, : t.REST_X] = stiffness[body.owners]
    bends = np.where(body.pulled[:, None], body.rest, q[:, :2]) / body.counts[:, None]
    arcs[:, t.REST_X : t.REST_LENGTH] = bends[body.owners]
    arcs[:, t.REST_LENGTH] = own[body.owners]
    arcs[:, t.WEIGHT :] = (body.weights * own[:, None])[body.owners]
    states = np.zeros((len(arcs), t.STATE_WIDTH))
    states[:, : t.TWIST] = (q[:, :2] / body.counts[:, None])[body.owners]
    states[:, t.LENGTH] = arcs[:, t.REST_LENGTH]
    if displacements is None and len(body.lines.actuators):
        displacements = robot.drive.displacements(q) + robot.drive.stretch(q)
    lines = _line_table(body, q, displacements)
    slopes = int((lines[:, t.LAST_ARC] - lines[:, t.FIRST_ARC] + 1.0).sum()) if len(lines) else 0
    pulls = body.carried if len(loads) == 0 else _load_table(robot, body.ends, loads)
    return Tables(arcs, pulls, lines, slopes, states, np.zeros(len(lines)))


def _line_table(body: Body, q: Floats, displacements: Floats | None) -> Floats:
    own = body.lines
    table = np.zeros((len(own.actuators), t.LINE_WIDTH))
    if displacements is None:
        return table
    first, last = own.sections.T
    table[:, t.FIRST_ARC], table[:, t.LAST_ARC] = body.ends[first] - body.counts[first] + 1, body.ends[last]
    table[:, t.ARM : t.STRAIGHT] = own.arms
    table[:, t.STRAIGHT], table[:, t.HELD], table[:, t.PUSHES] = own.straight, 1.0, own.pushes
    reach = np.cumsum(q[:, 2])[last]
    there = displacements[own.actuators]
    table[:, t.VALUE] = np.where(own.pushes, there, reach - there) + _chords(body, q)
    table[:, t.COMPLIANCE] = own.compliance
    table[1:, t.FIRST_SLOPE] = np.cumsum(table[:-1, t.LAST_ARC] - table[:-1, t.FIRST_ARC] + 1.0)
    return table


def _chords(body: Body, q: Floats) -> Floats:
    """By how much straight lines (t,) are longer than those along the arcs: negative, 0 where they are not straight."""
    own = body.lines
    if not own.straight.any():
        return np.zeros(len(own.straight))
    half = 0.5 * np.hypot(q[:, 0], q[:, 1]) / body.counts
    shares = np.sinc(half / math.pi) - 1.0
    along = shares * (q[:, 2] - own.arms @ q[:, :2].T)
    through = np.arange(len(q)) <= own.sections[:, 1:]
    return np.where(own.straight, np.where(through, along, 0.0).sum(axis=1), 0.0)


def _load_table(robot: "Robot", ends: NDArray[np.intp], loads: Sequence[Load]) -> Floats:
    """The rows of loads, and of what the robot carries, in the order of their arcs."""
    listed = [*robot.payload, *loads]
    table = np.zeros((len(listed), t.LOAD_WIDTH))
    for row, load in zip(table, listed, strict=True):
        row[t.LOAD_ARC] = ends[len(ends) - 1 if load.segment is None else load.segment - 1]
        row[t.OFFSET :] = load.position
        if isinstance(load, Force):
            row[t.FORCE : t.MOMENT], row[t.MOMENT : t.OFFSET] = load.force, load.moment
        elif robot.gravity is not None:
            row[t.FORCE : t.MOMENT] = load.mass * robot.gravity
    return table[np.argsort(table[:, t.LOAD_ARC], kind="stable")]
