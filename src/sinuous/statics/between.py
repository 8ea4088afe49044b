"""How far a loaded body leaves the straight way between two of its shapes; see `kernels.statics.departure`."""

from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels.statics import layout as t
from sinuous.model.robot import Robot
from sinuous.statics.body import body_of
from sinuous.statics.rest import Rest


def bounded(robot: Robot) -> bool:
    """Whether the way of this robot between loaded shapes can be bounded: lines follow arcs that do not twist."""
    own = body_of(robot)
    twists = np.isfinite(own.stiffness[:, 1])
    within = np.arange(len(robot))
    through = (within >= own.lines.sections[:, :1]) & (within <= own.lines.sections[:, 1:])
    return not own.lines.straight.any() and not (through & twists).any()


def bounded_aside(robot: Robot) -> bool:
    """Whether it can also be bounded where the drive leaves the straight line: nothing stretches lines by itself."""
    return robot.drive.elastic is None and bounded(robot)


class Leave(NamedTuple):
    """By how much a body leaves a way; infinite: not bounded.

    Attributes
    ----------
    aside, turn : float
        Any place of it; and how far its end is turned (rad).
    stretches : ndarray (t,)
        By how much the stretches of lines leave the straight way, see `Body.lines`; empty where nothing is bounded.
    """

    aside: float
    turn: float
    stretches: Floats = np.empty(0)


UNBOUNDED = Leave(np.inf, np.inf)


def leave(one: Rest, other: Rest, bow: Floats | None = None) -> Leave:
    """How far the body leaves the way that is linear in `Rest.arcs`.

    Parameters
    ----------
    one, other : Rest
        Both in equilibrium, of one robot.
    bow : ndarray (n, 3), optional
        How far a drive on a parabola leaves the straight line between both, at most: every bend (rad) and length.
        Tendons that stretch are not bounded then: their stretch is not linear in the drive.
    """
    from sinuous.kernels.statics.departure import DEPARTURE_WIDTH, measure_departure, measure_size  # noqa: PLC0415

    robot, own, lines = one.robot, body_of(one.robot), one.tables.lines.copy()
    if one is other and bow is None:
        return Leave(0.0, 0.0, np.zeros(len(lines)))
    if not (bounded(robot) if bow is None else bounded_aside(robot)):
        return UNBOUNDED
    ends = [(each.q, each.tables.lines[:, t.LINE_VALUE], *each.found) for each in (one, other)]
    q, held, x, tensions = (np.array(pair) for pair in zip(*ends, strict=True))
    aside = np.zeros_like(one.q) if bow is None else np.array(bow, order="C")
    found, stretches = np.empty(DEPARTURE_WIDTH), np.empty(len(lines))
    buffer = np.empty(measure_size(len(one.q), len(own.owners), len(lines), own.slopes))
    tables = packing.pose_row(robot.base), own.sections, own.carried, lines, own.slopes
    measure_departure(*tables, q, held, x, tensions, aside, buffer, found, stretches)
    return Leave(float(found[0]), float(found[1]), stretches)


def stretches_between(one: Rest, other: Rest, left: Leave) -> Floats:
    """Least and most (t, 2) that lines stretch on the way between two shapes, which the body leaves by so much.

    What a line would stretch by is linear in the state, and in the drive, which runs evenly; it is negative where the
    line is slack. Infinite where nothing is bounded.
    """
    ends = np.array([_stretches(each) for each in (one, other)])
    off = left.stretches if left.aside < np.inf else np.full(ends.shape[1], np.inf)
    return np.stack([ends.min(axis=0) - off, ends.max(axis=0) + off], axis=1)


def _stretches(rest: Rest) -> Floats:
    """What lines (t,) stretch by, negative of slack ones."""
    states, tensions = rest.found
    result = tensions * rest.tables.lines[:, t.COMPLIANCE]
    for i in np.flatnonzero((tensions <= 0.0) & (rest.tables.lines[:, t.PUSHES] == 0.0)).tolist():
        line = rest.tables.lines[i]
        through = slice(int(line[t.FIRST_ARC]), int(line[t.LAST_ARC]) + 1)
        long = states[through, t.LENGTH] - states[through, :2] @ line[t.ARM : t.ARM + 2]
        result[i] = min(0.0, float(long.sum() - line[t.LINE_VALUE]))
    return np.asarray(result)
