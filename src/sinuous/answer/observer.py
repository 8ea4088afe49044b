"""By how much a real robot was elsewhere than its model, as an observer estimates it step by step.

The disturbance `d` of a place is taken as slowly varying: `d += gain (measured - modelled - d)`, a first-order filter.
Targets are moved by `-d`, so that the real place meets them, whatever is wrong with the model (output-disturbance
observer; Maciejowski 2002, section 2.6).
"""

import math
from typing import NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Stack, Vector, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.poses import rotation_of
from sinuous.model.robot import Robot
from sinuous.problem.problem import ask_body
from sinuous.problem.target import Target

GAIN = 0.1
"""Share of what is new that a control step takes over, by default: about a quarter of the noise passes."""

MOST_DELAY = 100
"""Ticks."""

POSE = 4
"""Rows and columns of a pose."""


class Observed(NamedTuple):
    """What is known of the disturbance.

    Attributes
    ----------
    shares : ndarray (k,)
        Places that were measured: shares of the length of the body, increasing.
    shifts : ndarray (k, 3)
        By how much they were elsewhere, length unit, in world axes.
    turn : ndarray (3,)
        By how much the tip was turned: rotation vector, rad, in world axes.
    past : tuple of ndarray (n, 3)
        Configurations of the model at the last control steps, the newest last.
    """

    shares: Floats
    shifts: Floats
    turn: Floats
    past: tuple[Floats, ...]

    def shift_at(self, share: float) -> Floats:
        """The shift (3,) at a share of the length; the base has none."""
        own = np.concatenate([[0.0], self.shares]), np.concatenate([np.zeros((1, 3)), self.shifts])
        return np.array([np.interp(share, own[0], own[1][:, i]) for i in range(3)])


class Reading(NamedTuple):
    """A measurement: places, where they are (k, 3), and the rotation (3, 3) of the tip if it is known."""

    shares: Floats
    points: Floats
    rotation: Floats | None


def update_observer(
    robot: Robot,
    q: Floats,
    before: Observed | None,
    measured: Stack | None,
    places: Vector | None,
    gain: Number,
    delay: Whole,
) -> Observed | None:
    """The disturbance after a control step whose model is at `q` (n, 3); see `Solver.step`."""
    share = checks.number("gain", gain, above=0.0, high=1.0)
    ago = checks.integer("delay", delay, 0, MOST_DELAY)
    if measured is None and before is None:
        return None
    past = (*(() if before is None else before.past), q)[-MOST_DELAY - 1 :]
    if measured is None:
        assert before is not None
        return before._replace(past=past)
    then = past[max(0, len(past) - 1 - ago)]
    if robot.has_external_load:  # the model is the loaded body
        asked = ask_body(robot, then, ())
        robot, then = asked.body, asked.arcs
    reading = _read(robot, then, measured, places)
    known = before if before is not None and np.array_equal(before.shares, reading.shares) else None
    shifts = np.zeros((len(reading.shares), 3)) if known is None else known.shifts
    turn = np.zeros(3) if known is None else known.turn
    new = reading.points - np.array([_place(robot, then, each) for each in reading.shares])
    seen = np.isfinite(new)
    first = 1.0 if known is None else share  # nothing better is known then
    shifts = shifts + first * np.where(seen, new - shifts, 0.0)
    if reading.rotation is not None and np.isfinite(reading.rotation).all():
        turn = turn + first * (vector_of(reading.rotation @ robot.tip(then)[:3, :3].T) - turn)
    return Observed(reading.shares, shifts, turn, past)


def correct_targets(robot: Robot, target: Target, observed: Observed) -> Target:
    """The target for the model with which the real place meets `target`."""
    ends = _ends(robot, observed.past[-1])
    share = float(ends[robot.end_row(target.segment) - 1] / ends[-1]) if ends[-1] > 0.0 else 1.0
    back = rotation_of(-share * observed.turn)
    return Target(
        None if target.position is None else target.position - observed.shift_at(share),
        direction=None if target.direction is None else back @ target.direction,
        rotation=None if target.rotation is None else back @ target.rotation,
        segment=target.segment,
    )


def _read(robot: Robot, q: Floats, measured: Stack, places: Vector | None) -> Reading:
    try:
        given = np.array(measured, np.float64)
    except (ValueError, TypeError):
        given = np.zeros(0)
    n, before, tip = len(robot.segments), robot.drive.before, np.array([1.0])
    if given.shape == (3,) and places is None:
        return Reading(tip, given[None], None)
    if given.shape == (POSE, POSE) and places is None:
        return Reading(tip, given[None, :3, 3], given[:3, :3])
    if given.shape == (n, 2) and places is None:
        bent = np.array(q)
        bent[before:, :2] = given
        poses = robot.forward(bent)[before:]
        poses[-1] = robot.tip(bent)
        ends = _ends(robot, q)[before:]
        return Reading(ends / ends[-1], poses[:, :3, 3], poses[-1, :3, :3])
    if given.ndim != 2 or given.shape[1] != 3 or places is None or n == 0:
        expected = f"a position (3,), a pose (4, 4), bends ({n}, 2), or points (k, 3) with places"
        raise InputError("measured", "", measured, expected)
    shares = checks.array("places", places, (len(given),), "as many shares as points")
    if not (shares[0] > 0.0 and (np.diff(shares) > 0.0).all() and shares[-1] <= 1.0):
        raise InputError("places", "", shares.tolist(), "increasing shares of the length of the body, at most 1")
    return Reading(shares, given, None)


def _ends(robot: Robot, q: Floats) -> Floats:
    """Lengths of the body up to the ends of all rows (n,); joints and links have none."""
    return np.cumsum(np.where(np.arange(len(q)) < robot.drive.before, 0.0, q[:, 2]))


def _place(robot: Robot, q: Floats, share: float) -> Floats:
    """Position (3,) of a place of the model; the tool at the end."""
    if share >= 1.0:
        return robot.tip(q)[:3, 3]
    ends = _ends(robot, q)
    at = share * ends[-1]
    k = int(np.searchsorted(ends, at))
    cut = q.copy()
    cut[k] *= (at - (ends[k - 1] if k else 0.0)) / q[k, 2]
    return robot.forward(cut)[k, :3, 3]


def vector_of(rotation: Floats) -> Floats:
    """Rotation vector of a rotation of less than half a turn."""
    axis = 0.5 * np.array(
        [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    )
    sine, cosine = float(np.linalg.norm(axis)), 0.5 * (float(np.trace(rotation)) - 1.0)
    return axis * (math.atan2(sine, cosine) / sine if sine > 0.0 else 1.0)
