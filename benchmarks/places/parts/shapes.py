"""Hidden shapes: smoothly bent, and nowhere near themselves, so that a wall fits around them."""

import math
from collections.abc import Callable, Container, Sequence
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.judges.kinematics import arc_poses
from sinuous.base.checks import Floats

TURNING = 0.9
"""Standard deviation of the change of the bending plane from one segment to the next, rad."""

LEAST_BEND, MOST_BEND = 0.2, 0.8
"""Range of hidden bends, of the largest that a segment has."""

LEAST_INSERTION = 0.3
"""Of its stroke: a stage that is all in would leave nothing of it in the place."""

TRIES = 40
"""Draws of one segment before the whole shape counts as caught in itself."""

SAMPLES = 10
"""Samples of a segment where its distance to the rest of the shape is looked at."""


class Curve(NamedTuple):
    """A backbone.

    Attributes
    ----------
    poses : ndarray (m, 4, 4)
        Frames along it, z the tangent; they do not turn about it.
    along : ndarray (m,)
        Arc length from the base.
    """

    poses: Floats
    along: Floats

    @property
    def points(self) -> Floats:
        """Positions (m, 3)."""
        return self.poses[:, :3, 3]

    @property
    def tangents(self) -> Floats:
        """Unit tangents (m, 3)."""
        return self.poses[:, :3, 2]


def arc(start: Floats, coordinates: Floats, samples: int) -> Floats:
    """Poses (samples + 1, 4, 4) along one arc (bend_x, bend_y, length) that leaves from the pose `start`."""
    parts = coordinates * np.linspace(0.0, 1.0, samples + 1)[:, None]
    poses: Floats = start @ arc_poses(parts[:, 0], parts[:, 1], parts[:, 2])
    return poses


def curve_of(robot: sn.Robot, q: Floats, samples: int) -> Curve:
    """Return the backbone of a configuration (n, 3), with `samples` intervals a segment."""
    pieces, parts = [robot.base[None]], q[:, None] * np.linspace(0.0, 1.0, samples + 1)[1:, None]
    for steps in arc_poses(parts[..., 0], parts[..., 1], parts[..., 2]):
        pieces.append(pieces[-1][-1] @ steps)
    steps = np.repeat(q[:, 2] / samples, samples)
    return Curve(np.concatenate(pieces), np.concatenate([[0.0], np.cumsum(steps)]))


def lengthened(poses: Floats, by: float) -> Floats:
    """Go on straight beyond the last of frames (m, 4, 4), so that the tip has room."""
    return np.concatenate([poses, arc(poses[-1], np.array([0.0, 0.0, by]), 2)[1:]])


def draw_shape(
    robot: sn.Robot,
    apart: float,
    rng: Generator,
    least_ahead: float = -1.0,
    straight: Container[int] = (),
    first: Floats | None = None,
) -> Floats:
    """Draw a configuration (n, 3) whose backbone keeps `apart` from itself.

    Places count as apart from each other when they are farther along the backbone than half a circle of that diameter.
    No tangent makes an angle with the base's whose cosine is less than `least_ahead`. The segments `straight` (0 is the
    first) do not bend. The first segments may be given (m, 3).
    """
    while True:
        q = _grow(robot, apart, rng, least_ahead, straight, () if first is None else first)
        if q is not None:
            return q


def keeps_from_itself(curve: Curve, apart: float) -> bool:
    """Whether a backbone keeps `apart` from itself; see `draw_shape`."""
    return _keeps_apart(curve.points, curve.along, curve.points, curve.along, apart)


def _grow(
    robot: sn.Robot,
    apart: float,
    rng: Generator,
    least_ahead: float,
    straight: Container[int],
    first: Sequence[Floats] | Floats,
) -> Floats | None:
    """Add one segment after the other, each free of those before; `None` where there is no way on."""
    found: list[Floats] = []
    pose = robot.base
    points, along = robot.base[None, :3, 3], np.zeros(1)
    plane = rng.uniform(0.0, 2.0 * math.pi)
    for k, segment in enumerate(robot.segments):
        for _ in range(TRIES):
            turned = plane + TURNING * rng.normal()
            coordinates = _draw_segment(segment, turned, rng) if k >= len(first) else first[k].copy()
            if k in straight:
                coordinates[:2] = 0.0
            poses = arc(pose, coordinates, SAMPLES)
            reached = along[-1] + np.linspace(0.0, coordinates[2], SAMPLES + 1)[1:]
            ahead = poses[:, :3, 2] @ robot.base[:3, 2]
            if ahead.min() >= least_ahead and _keeps_apart(points, along, poses[1:, :3, 3], reached, apart):
                break
        else:
            return None
        found.append(coordinates)
        pose, plane = poses[-1], turned
        points, along = np.concatenate([points, poses[1:, :3, 3]]), np.concatenate([along, reached])
    return np.array(found)


def _draw_segment(segment: sn.Segment, plane: float, rng: Generator) -> Floats:
    low, high = segment.length
    stage = low == 0.0
    length = rng.uniform(LEAST_INSERTION * high if stage else low, high)
    bend = segment.max_bend * rng.uniform(LEAST_BEND, MOST_BEND)
    return np.array([bend * math.cos(plane), bend * math.sin(plane), length])


def _keeps_apart(points: Floats, along: Floats, others: Floats, reached: Floats, apart: float) -> bool:
    gaps = np.linalg.norm(points[:, None] - others, axis=-1)
    far = reached - along[:, None] > 0.5 * math.pi * apart
    return bool(np.where(far, gaps, math.inf).min() > apart)


def offshoots(way: Floats, draw: Callable[[], Floats], wanted: int, tries: int, outside: float) -> list[Floats]:
    """Draw curves (k, 3) that leave a way (m, 3), until there are enough, with tubes of a radius around all.

    They come near to each other, and to the way, only where they leave it.
    """
    found: list[Floats] = []
    for _ in range(tries):
        branch = draw()
        gaps = np.asarray(cKDTree(np.concatenate([way, *found])).query(branch)[0])
        gone = np.linalg.norm(branch - branch[0], axis=-1) > 3.2 * outside
        if gone.any() and gaps[gone].min() > 2.1 * outside:
            found.append(branch)
        if len(found) == wanted:
            break
    return found


FLAT_BENDS, TURNED, FLAT_DRAWS, FLAT_SAMPLES = (0.1, 0.8), 0.35, 40, 9
"""Of flat shapes: bends, of the largest; share of segments from which on they bend to the other side; shapes drawn for
one; and frames of a segment."""


def draw_flat_shape(robot: sn.Robot, apart: float, plane: float, rng: Generator) -> tuple[Floats, Curve] | None:
    """Draw a configuration (n, 3) that bends in one plane (rad) and keeps `apart` from itself; and its backbone."""
    low, high, most = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    low = np.where(low == 0.0, LEAST_INSERTION * high, low)
    for _ in range(FLAT_DRAWS):
        bends = most * rng.uniform(*FLAT_BENDS, len(robot)) * np.cumprod(np.sign(rng.random(len(robot)) - TURNED))
        q = np.stack([bends * math.cos(plane), bends * math.sin(plane), rng.uniform(low, high)], axis=-1)
        curve = curve_of(robot, q, FLAT_SAMPLES)
        if keeps_from_itself(curve, apart):
            return q, curve
    return None
