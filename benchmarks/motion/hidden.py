"""Hidden motions: to a shape, within all limits, and nowhere near themselves.

In one kind the straight body wanders through random shapes. In the others the tip leads in: the body is drawn back from
the hidden shape along itself. In one of these the whole body is, as far as a share of its length, and straightened
there. Backwards that is a way in that sweeps little where the hidden shape ends. In the other only what is beyond a
place of the shape slides back, to just before that place, and nothing is straightened: backwards the body comes out of
folds, through a hole at that place that it hardly needs wider than it is. The least squares of that are NumPy's, and
share nothing with the planner.
"""

import math

import numpy as np
from numpy.random import Generator

from benchmarks.judges.kinematics import segment_ends
from benchmarks.judges.motions import samples
from benchmarks.judges.self_collision import look
from benchmarks.places.parts.shapes import curve_of, draw_shape
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot

WANDERING, LEADING, THREADING = "wandering", "leading", "threading"
KINDS = (WANDERING, LEADING, THREADING)

APART = 4.0
"""Distance of the shapes from themselves, in radii of the body."""

ROOM = 0.2
"""Clearance from itself that the whole motion has, in radii of the body."""

SHAPES, FEW = (2, 4), 9
"""Range of the shapes that a wandering body goes through, the last is where it ends; robots of so many segments or more
go to the last one at once, because they hardly ever get from one shape to another without running into themselves."""

BACK = (0.25, 0.6)
"""Range of the share of its length that a leading body is drawn back by."""

HOLE, OUT = (0.45, 0.8), 0.04
"""Range of the share of its length where the hole of a threading body is, and how far the tip is drawn out of it."""

BEFORE = 0.5
"""What is as near before the hole slides, too, in segments."""

STEP = 0.02
"""Of a body that is drawn back, in its lengths."""

ROUNDS, DAMPING, NUDGE = 4, 1e-3, 1e-6
"""Steps of the least squares for each step back; their damping, as a share; and the step of finite differences."""

SAMPLES = 12
"""Intervals of a segment in the curve that it is drawn back along."""

FINE = 12
"""Configurations a step at most, and more than one where the motion is looked at whether it keeps clear of itself."""


def draw_motion(robot: Robot, kind: str, rng: Generator) -> Floats:
    """Draw the knots (T, n, 3) of a motion that is linear between them; see `keeps_apart`."""
    radius = max(robot.radii)
    count = int(rng.integers(*SHAPES)) if kind == WANDERING and len(robot) < FEW else 1
    shapes = [draw_shape(robot, APART * radius, rng) for _ in range(count)]
    if kind == THREADING:
        hole = rng.uniform(*HOLE)
        return np.stack(drawn_back(robot, shapes[0], 1.0 - hole + OUT, hole)[::-1])
    if kind == LEADING:
        shapes = drawn_back(robot, shapes[0], rng.uniform(*BACK))[::-1]
    return np.stack([straight(robot), *shapes])


def keeps_apart(robot: Robot, knots: Floats) -> bool:
    """Whether a motion through knots (T, n, 3) is nowhere near itself."""
    room = ROOM * max(robot.radii)
    return bool(look(robot, samples(knots, FINE), room).least.min() > room)


def straight(robot: Robot) -> Floats:
    """Return the straight robot (n, 3): every stage drawn in, every other segment at its mean length."""
    lengths = [
        segment.length[0] if segment.max_bend == 0.0 else 0.5 * sum(segment.length) for segment in robot.segments
    ]
    return np.stack([np.zeros(len(lengths)), np.zeros(len(lengths)), lengths], axis=-1)


def drawn_back(robot: Robot, q: Floats, share: float, hole: float | None = None) -> list[Floats]:
    """Return configurations (n, 3) from `q` to one whose tip is back by a share of the length.

    Ends of segments are to lie where the curve of `q` was so much before, the more the nearer they are to the tip; what
    would be behind the base is free. With a hole, at a share of the length, all ends beyond it count the same, and what
    is before it is free. Gauss and Newton, damped, with finite differences.
    """
    curve = curve_of(robot, q, SAMPLES)
    ends, length = np.cumsum(q[:, 2]), float(curve.along[-1])
    weights, free = np.arange(1, len(q) + 1) / len(q), 0.0
    if hole is not None:
        weights, free = np.ones(len(q)), (hole - BEFORE / len(q)) * length
    found = [q]
    for by in np.arange(1, math.floor(share / STEP) + 1) * STEP * length:
        places = np.stack([np.interp(ends - by, curve.along, axis) for axis in curve.points.T], axis=-1)
        held = np.where(ends - by > free, weights, 0.0)
        held[-1] = 1.0
        new = found[-1]
        for _ in range(ROUNDS):
            new = _step(robot, new, places, held[:, None])
        found.append(new)
    return found


def _step(robot: Robot, q: Floats, places: Floats, weights: Floats) -> Floats:
    """Bring the ends of segments nearer to places (n, 3)."""
    flat = q.ravel()
    nudges = np.tile([NUDGE, NUDGE, NUDGE * robot.mean_length / len(q)], len(q))
    tried = (flat + np.vstack([np.zeros(len(flat)), np.diag(nudges)])).reshape(-1, *q.shape)
    seen = (weights * (segment_ends(robot, tried)[:, 1:, :3, 3] - places)).reshape(len(tried), -1)
    jacobian = ((seen[1:] - seen[0]) / NUDGE).T
    normal = jacobian.T @ jacobian
    normal[np.diag_indices_from(normal)] += DAMPING * np.trace(normal) / len(normal)
    change = nudges / NUDGE * np.linalg.solve(normal, jacobian.T @ seen[0])
    return _within_limits(robot, (flat - change).reshape(q.shape))


def _within_limits(robot: Robot, q: Floats) -> Floats:
    """Return the configuration (n, 3) with lengths and bends (3 n) no greater than they may be."""
    low, high, most = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    bends = np.hypot(q[:, 0], q[:, 1])
    share = np.where(bends > most, most / np.maximum(bends, 1e-12), 1.0)
    return np.stack([share * q[:, 0], share * q[:, 1], np.clip(q[:, 2], low, high)], axis=-1)
