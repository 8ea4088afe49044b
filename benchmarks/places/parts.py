"""Whom intricate places are made for: robots, and hidden shapes.

Every twenty seeds in a row have all kinds of robots, from 3 segments to 20. Hidden shapes are smoothly bent, and
nowhere near themselves, so that a wall fits around them.
"""

import math
from collections.abc import Container, Sequence
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.kinematics import arc_poses
from sinuous.base.checks import Floats

WALL = 0.8
"""Thickness of the walls of pipes, in radii of the body."""

BENDS = {3: 2.4, 5: 2.4, 8: 2.0, 12: 1.6, 20: 1.2}
"""Number of bending segments, and the largest bend of each, rad."""

UNITS = (1.0, 60.0, 0.05)
"""Lengths of a segment: no result may hang on the unit of length."""

STRETCH = 0.2
SLENDERNESS = 0.1
"""Radius of the body, of a segment's length."""

STROKE, HOLDER = 1.5, 0.25
"""Longest insertion, and how far the holder of an insertion stage encloses the body, in lengths of a segment."""


def robot_of(seed: int, rng: Generator) -> sn.Robot:
    """Return the robot of a seed: number of segments in turn, half extensible, half with an insertion stage.

    The stage is one more segment before the others, straight, with a length from 0 to `STROKE`; half of the stages
    have a holder that obstacles do not concern (`mount`). The base is anywhere.
    """
    kinds = tuple(BENDS.items())
    count, max_bend = kinds[seed % 5]
    unit = UNITS[seed // 20 % 3]
    radius = SLENDERNESS * unit
    length = (1.0 - STRETCH) * unit, (1.0 + STRETCH) * unit
    segments = [sn.Segment(length if seed // 5 % 2 else unit, max_bend, radius=radius)] * count
    mount = 0.0
    if seed // 10 % 2:
        segments = [sn.Segment((0.0, STROKE * unit), 0.0, radius=radius), *segments]
        mount = float(rng.choice([0.0, HOLDER])) * unit
    return sn.Robot(segments, mount=mount, base=sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)))


def longest(seed: int, rng: Generator) -> sn.Robot:
    """Return the robot of 20 segments of a seed."""
    return robot_of(5 * seed + 4, rng)


SLENDER, STOUT = (0.05, 0.12), (0.15, 0.22)
"""Of the body of various robots: range of its radius at the base, of a segment's length."""

THIN = 0.018
"""Radius of thin robots, of a segment's length."""

TAPER = 0.7
"""Radius at the tip of those that taper, of that at the base."""

TOOL, SLANT = (0.05, 0.4), 0.5
"""Range of the length of a tool, in lengths of a segment; its largest angle with the tangent, rad."""


def various_robot(seed: int, rng: Generator, stout: bool = False) -> sn.Robot:
    """Return the robot of a seed with another body; a third of them have a tool.

    Half of the slender ones taper. Stout ones are for scans, which around others would have hundreds of thousands of
    points.
    """
    plain = robot_of(seed, rng)
    unit = UNITS[seed // 20 % 3]
    thickness, taper = (STOUT, 1.0) if stout else (SLENDER, rng.choice([1.0, TAPER]))
    radii = unit * rng.uniform(*thickness) * np.linspace(1.0, taper, len(plain))
    segments = [one.changed(radius=radius) for one, radius in zip(plain.segments, radii, strict=True)]
    return plain.changed(segments=segments, tool=_tool(unit, rng) if rng.random() < 1 / 3 else None)


def stout_robot(seed: int, rng: Generator) -> sn.Robot:
    """Return a stout robot of 3, 5 or 8 segments."""
    return various_robot(seed - seed % 5 + (0, 1, 2, 0, 1)[seed % 5], rng, stout=True)


def long_robot(seed: int, rng: Generator, stout: bool = False) -> sn.Robot:
    """Return a robot of 20 segments."""
    return various_robot(5 * seed + 4, rng, stout)


def thin_robot(seed: int, rng: Generator) -> sn.Robot:
    """Return a robot of 20 segments that is a thousand radii long."""
    plain = long_robot(seed, rng)
    return sn.Robot(plain.segments, radius=THIN * max(s.length[1] for s in plain.segments), base=plain.base)


def _tool(unit: float, rng: Generator) -> Floats:
    """A point ahead of the tip, to which the tool leads straight."""
    direction = np.array([0.0, 0.0, 1.0]) + np.append(rng.uniform(-1.0, 1.0, 2) * SLANT / math.sqrt(2.0), 0.0)
    return sn.pose(unit * rng.uniform(*TOOL) * direction / np.linalg.norm(direction), direction=direction)


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
    end : ndarray (3,)
        The tool.
    """

    poses: Floats
    along: Floats
    end: Floats

    @property
    def points(self) -> Floats:
        """Positions (m, 3)."""
        return self.poses[:, :3, 3]

    @property
    def tangents(self) -> Floats:
        """Unit tangents (m, 3)."""
        return self.poses[:, :3, 2]

    def draw(self, share: tuple[float, float], rng: Generator) -> int:
        """Draw the number of a frame that is within such a range of the whole."""
        return round(rng.uniform(*share) * (len(self.poses) - 1))

    def before(self, k: int) -> Floats:
        """Points (k + 1, 3) from the base to frame k."""
        return self.points[: k + 1]

    def after(self, k: int) -> Floats:
        """Points (m - k + 1, 3) from frame k to the tool."""
        return np.vstack([self.points[k:], self.end])

    def keeps(self, apart: float) -> bool:
        """Whether it keeps `apart` from itself; see `draw_shape`."""
        return _keeps_apart(self.points, self.along, self.points, self.along, apart)


def about_z(angle: float) -> Floats:
    """Return the pose (4, 4) that turns by an angle about z."""
    turned = np.eye(4)
    turned[:2, :2] = [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
    return turned


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
    steps, poses = np.repeat(q[:, 2] / samples, samples), np.concatenate(pieces)
    return Curve(poses, np.concatenate([[0.0], np.cumsum(steps)]), (poses[-1] @ robot.tool)[:3, 3])


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


FLAT_BENDS, TURNED, FLAT_DRAWS, FLAT_SAMPLES = (0.1, 0.8), 0.35, 40, 9
"""Of flat shapes: bends, of the largest; share of segments from which on they bend to the other side; shapes drawn for
one; and frames of a segment."""


def draw_flat_shape(
    robot: sn.Robot, apart: float, plane: float, rng: Generator, share: tuple[float, float] = FLAT_BENDS
) -> tuple[Floats, Curve] | None:
    """Draw a configuration (n, 3) that bends in one plane (rad) and keeps `apart` from itself; and its backbone.

    `share`: range of the bends, of the largest.
    """
    low, high, most = np.array([(*segment.length, segment.max_bend) for segment in robot.segments]).T
    low = np.where(low == 0.0, LEAST_INSERTION * high, low)
    for _ in range(FLAT_DRAWS):
        bends = most * rng.uniform(*share, len(robot)) * np.cumprod(np.sign(rng.random(len(robot)) - TURNED))
        q = np.stack([bends * math.cos(plane), bends * math.sin(plane), rng.uniform(low, high)], axis=-1)
        curve = curve_of(robot, q, FLAT_SAMPLES)
        if curve.keeps(apart):
            return q, curve
    return None
