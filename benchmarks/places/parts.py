"""What intricate places are made of: robots, hidden shapes, and closed surfaces.

Every twenty seeds in a row have all kinds of robots, from 3 segments to 20. Hidden shapes are smoothly bent, and
nowhere near themselves, so that a wall fits around them. Surfaces are triangles: lofts over rings, watertight because
every edge is made twice, and marching cubes.
"""

import itertools
import math
from collections.abc import Callable, Container, Sequence
from typing import NamedTuple

import igl
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.judges.kinematics import arc_poses
from sinuous.base.checks import Floats
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Obstacle

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
    segments = [
        sn.Segment(one.length, one.max_bend, radius=radius) for one, radius in zip(plain.segments, radii, strict=True)
    ]
    return sn.Robot(
        segments, mount=plain.mount, base=plain.base, tool=_tool(unit, rng) if rng.random() < 1 / 3 else None
    )


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

    def before(self, k: int) -> Floats:
        """Points (k + 1, 3) from the base to frame k."""
        return self.points[: k + 1]

    def after(self, k: int) -> Floats:
        """Points (m - k + 1, 3) from frame k to the tool."""
        return np.vstack([self.points[k:], self.end])


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
        if keeps_from_itself(curve, apart):
            return q, curve
    return None


Faces = NDArray[np.int64]

WALL = 0.8
"""Thickness of the walls of pipes, in radii of the body."""


class Surface(NamedTuple):
    """Triangles, counterclockwise as seen from outside of the solid.

    Attributes
    ----------
    vertices : ndarray (v, 3)
    faces : ndarray (f, 3)
    """

    vertices: Floats
    faces: Faces

    @property
    def turned(self) -> "Surface":
        """The same triangles, seen from the other side: the wall of a hollow."""
        return Surface(self.vertices, self.faces[:, ::-1].copy())


CORNERS = 0.5 * np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)
"""Of the cube of edge 1 about the origin, faces counterclockwise as seen from outside."""


def box_between(frame: Floats, low: Floats, high: Floats, name: str) -> sn.Box:
    """Return the box from corner `low` (3,) to corner `high` (3,) of a frame (4, 4)."""
    middle = frame[:3, 3] + frame[:3, :3] @ (0.5 * (low + high))
    return sn.Box(middle, high - low, frame[:3, :3], name=name)


def cuboid(center: Floats, size: Floats, rotation: Floats) -> Surface:
    """Return the triangles of a box with edges of lengths (3,) along the columns of a rotation (3, 3)."""
    return Surface(size * CORNERS @ rotation.T + center, FACES)


def solid(surface: Surface, name: str) -> Mesh:
    """Return the obstacle that a closed surface bounds."""
    return Mesh(surface.vertices, surface.faces, name=name)


LEVEL = 1e-9
"""Cosine up to which a face, or an edge, is across a direction."""


def beside(
    kind: str, at: Floats, away: Floats, off: float, size: Floats, turn: Floats, aside: Floats | float = 0.0
) -> Obstacle:
    """Return an obstacle whose place nearest to a point is `off` away from it.

    Parameters
    ----------
    kind : str
        A `box`, a `mesh` of its triangles, a `capsule` or `cylinder` along the first axis, a `sphere`, one to stay
        `inside` of, or a `half_space`.
    at, away : ndarray (3,)
        The point, and the unit vector from there to that place.
    off : float
    size : ndarray (3,)
        Edges of a box; else the length, and what it is thick.
    turn : ndarray (3, 3)
        Rotation whose columns are the axes.
    aside : ndarray (3,)
        Where along an edge or on a face that place is, from -1 to 1 on each axis.
    """
    radius, along = 0.5 * size[1], away @ turn
    shift = 0.5 * turn @ (size * np.where(np.abs(along) > LEVEL, np.sign(along), aside))
    if kind == "half_space":
        return sn.HalfSpace(at + off * away + shift - (shift @ away) * away, -away)
    if kind in ("sphere", "inside"):
        return sn.Sphere(at + (off + (radius if kind == "sphere" else -radius)) * away, radius, inside=kind == "inside")
    if kind in ("box", "mesh"):
        middle = at + off * away + shift
        return sn.Box(middle, size, turn) if kind == "box" else sn.Mesh(*cuboid(middle, size, turn))
    axis = turn[:, 0]
    across = away if kind == "capsule" else away - along[0] * axis
    thick = float(np.linalg.norm(across))
    middle = at + off * away + (shift @ axis) * axis + (radius / thick * across if thick > LEVEL else 0.0)
    half = 0.5 * size[0] * axis
    return (sn.Capsule if kind == "capsule" else sn.Cylinder)(middle - half, middle + half, radius)


def joined(surfaces: list[Surface]) -> Surface:
    """Return all triangles of several surfaces."""
    firsts = np.cumsum([0, *(len(surface.vertices) for surface in surfaces[:-1])])
    faces = [surface.faces + first for surface, first in zip(surfaces, firsts, strict=True)]
    return Surface(np.concatenate([s.vertices for s in surfaces]), np.concatenate(faces))


def loft(rings: Floats, poles: Floats) -> Surface:
    """Return the skin over rings (m, s, 3), closed by a fan to a pole at each end (2, 3).

    Rings run counterclockwise as seen from the end that they lead to.
    """
    m, s = rings.shape[:2]
    vertices = np.concatenate([rings.reshape(-1, 3), poles])
    first, last = np.arange(s), (m - 1) * s + np.arange(s)
    start = np.stack([np.full(s, m * s), np.roll(first, -1), first], axis=-1)
    end = np.stack([np.full(s, m * s + 1), last, np.roll(last, -1)], axis=-1)
    return Surface(vertices, np.concatenate([_bands(m, s, m - 1), start, end]))


def ring_loft(rings: Floats) -> Surface:
    """Return the skin over rings (m, s, 3) of which the last is followed by the first."""
    m, s = rings.shape[:2]
    return Surface(rings.reshape(-1, 3), _bands(m, s, m))


def _bands(m: int, s: int, count: int) -> Faces:
    """Triangles between ring k and the next of m, for the first `count` rings of s vertices."""
    k, j = np.meshgrid(np.arange(count), np.arange(s), indexing="ij")
    a, b = k * s + j, k * s + (j + 1) % s
    c, d = (k + 1) % m * s + j, (k + 1) % m * s + (j + 1) % s
    return np.concatenate([np.stack([a, b, d], axis=-1).reshape(-1, 3), np.stack([a, d, c], axis=-1).reshape(-1, 3)])


def tube(poses: Floats, radius: float, sides: int = 16, caps: int = 4) -> Surface:
    """Return the surface at `radius` around a curve given by frames (m, 4, 4), with half a ball at each end.

    No face is nearer to the curve than `radius`, but for what the steps between frames cut off.
    """
    outer = radius / math.cos(math.pi / sides)
    lean = np.linspace(0.0, 0.5 * math.pi, caps + 1)[1:-1]
    rings = [_ring(poses[0], outer * math.cos(a), -outer * math.sin(a), sides) for a in lean[::-1]]
    rings += [_ring(pose, outer, 0.0, sides) for pose in poses]
    rings += [_ring(poses[-1], outer * math.cos(a), outer * math.sin(a), sides) for a in lean]
    ends = [poses[0, :3, 3] - outer * poses[0, :3, 2], poses[-1, :3, 3] + outer * poses[-1, :3, 2]]
    return loft(np.array(rings), np.array(ends))


def ball(center: Floats, radius: float, sides: int) -> Surface:
    """Return a ball of `2 * sides * (sides - 1)` triangles."""
    lean = math.pi * np.arange(1, sides)[:, None] / sides
    turn = 2.0 * math.pi * np.arange(sides) / sides
    height = np.broadcast_to(-np.cos(lean), (sides - 1, sides))
    rings = np.stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn), height], axis=-1)
    poles = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    return loft(center + radius * rings, center + radius * poles)


def hollow(poses: Floats, inside: float, outside: float) -> Surface:
    """Return the wall between two radii around a curve, closed by half a ball at each end."""
    return joined([tube(poses, outside), tube(poses, inside).turned])


def open_tube(
    poses: Floats, inside: float | Floats, outside: float | Floats, bottom: bool = False, sides: int = 16
) -> Surface:
    """Return the wall between two radii, or radii (m,), around a curve given by frames (m, 4, 4).

    It is open at both ends, or (`bottom`) only at the last one.
    """
    widen = 1.0 / math.cos(math.pi / sides)
    radii = np.broadcast_to(outside, len(poses)), np.broadcast_to(inside, len(poses))
    outer, inner = ([_ring(pose, widen * r, 0.0, sides) for pose, r in zip(poses, own, strict=True)] for own in radii)
    if not bottom:
        return ring_loft(np.array([*outer, *inner[::-1]]))
    start, tangent, wall = poses[0, :3, 3], poses[0, :3, 2], float(radii[0][0] - radii[1][0])
    behind = _ring(poses[0], float(radii[0][0]) * widen, -wall, sides)
    return loft(np.array([behind, *outer, *inner[::-1]]), np.array([start - wall * tangent, start]))


def _ring(pose: Floats, radius: float, ahead: float, sides: int) -> Floats:
    turn = 2.0 * math.pi * np.arange(sides) / sides
    local = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(sides, ahead)], axis=-1)
    ring: Floats = local @ pose[:3, :3].T + pose[:3, 3]
    return ring


def layered(pose: Floats, outlines: Sequence[tuple[Floats, float]], poles: Sequence[Floats] = ()) -> Surface:
    """Return the skin over outlines (s, 2), each across the z axis of `pose` at a height of its own.

    The last is followed by the first, or both are closed by a fan to one of two poles (3,).
    """
    rings = np.stack([np.column_stack([outline, np.full(len(outline), height)]) for outline, height in outlines])
    rings = rings @ pose[:3, :3].T + pose[:3, 3]
    return loft(rings, np.array(poles) @ pose[:3, :3].T + pose[:3, 3]) if len(poles) else ring_loft(rings)


def blind_bore(pose: Floats, hole: float, depth: float, half: float, bottom: float, sides: int = 24) -> Surface:
    """Return a block with a bore of radius `hole` from the origin of `pose` along z, closed at `depth`.

    The block is square, with half the edge `half`, and goes on `bottom` beyond the bore. `sides` as for `plate`.
    """
    circle, square = outlines_of(sides)
    inner, outer = hole / math.cos(math.pi / sides) * circle, half * square
    outlines = [(outer, depth + bottom), (outer, 0.0), (inner, 0.0), (inner, depth)]
    return layered(pose, outlines, [np.array([0.0, 0.0, height]) for height in (depth + bottom, depth)]).turned


def plate(pose: Floats, half: float, hole: float | Floats, thickness: float, sides: int = 24) -> Surface:
    """Return a square plate across the z axis of `pose`, with a hole around it.

    `hole` is a radius, or that of its outline in each of the directions (sides,) of `outlines_of`. `sides`, a multiple
    of 8, is also how often the outline is cut, so that it has its corners.
    """
    circle, square = outlines_of(sides)
    inner = np.broadcast_to(hole, sides)[:, None] / math.cos(math.pi / sides) * circle
    low, high = -0.5 * thickness, 0.5 * thickness
    return layered(pose, [(inner, low), (half * square, low), (half * square, high), (inner, high)])


def outlines_of(sides: int) -> tuple[Floats, Floats]:
    """Points (sides, 2) of the circle of radius 1 and of the square around it, in the same directions."""
    turn = 2.0 * math.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return circle, circle / np.abs(circle).max(axis=1, keepdims=True)


CUBE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
"""Corners of a cell, in the order that marching cubes takes them."""

SPAN = 1 << 20


def around(places: Floats, distance: float, cell: float, signed: Callable[[Floats], Floats]) -> Surface:
    """Return the surface between points where a function is negative and where it is not.

    Parameters
    ----------
    places : ndarray (m, 3)
        No part of the surface is farther from all of them than `distance`.
    distance, cell : float
        Edge of the cells; in the length unit.
    signed : callable
        From points (k, 3) to values (k,), negative in the solid.
    """
    reach = math.ceil(distance / cell) + 2
    block = np.stack(np.meshgrid(*[np.arange(-reach, reach)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    origin = places.min(axis=0) - (reach + 1) * cell
    coarse = np.unique(((places - origin) / (2.0 * cell)).astype(np.int64), axis=0) * np.int64(2)
    cells = _distinct((coarse[:, None] + block).reshape(-1, 3))
    corners = cells[:, None] + CUBE
    nodes, numbers = np.unique(_key(corners.reshape(-1, 3)), return_inverse=True)
    points = origin + cell * _from_key(nodes)
    values = signed(points)
    numbers = numbers.reshape(-1, 8)
    mixed = np.ptp(np.sign(values)[numbers], axis=1) > 0.0
    vertices, faces, _ = igl.marching_cubes(values, points, numbers[mixed])
    return Surface(vertices, faces)


def _key(cells: Faces) -> Faces:
    """One number for every triple of whole numbers."""
    key: Faces = (cells[:, 0] * SPAN + cells[:, 1]) * SPAN + cells[:, 2]
    return key


def _from_key(key: Faces) -> Faces:
    return np.stack([key // SPAN // SPAN, key // SPAN % SPAN, key % SPAN], axis=-1)


def _distinct(cells: Faces) -> Faces:
    return _from_key(np.unique(_key(cells)))
