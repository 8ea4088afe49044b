"""Walls of boxes and meshes: cells with doors around base or target, plates, keyholes, and small worlds of boxes."""

import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.places import solids
from benchmarks.places.parts import Curve, about_z, curve_of, draw_shape
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.problems import random_configurations
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure


def channel(frame: Floats, half: float, length: float, wall: float, name: str = "wall") -> list[sn.Box]:
    """Return four walls around the z axis of a frame (4, 4), `2 * half` apart, from its origin on."""
    inner = np.array([[-half, -half], [half, half]])
    low, high = inner[0] - wall, inner[1] + wall
    return wall_with_door(frame, np.append(low, 0.0), np.append(high, length), inner, name)


def wall_with_door(frame: Floats, low: Floats, high: Floats, door: Floats, name: str) -> list[sn.Box]:
    """Return the box from `low` (3,) to `high` (3,) but for a door right through it along z.

    `door` (2, 2) are the corners of the door in x and y.
    """
    (x, y), (u, v) = door
    pieces = (
        ([low[0], low[1]], [x, high[1]]),
        ([u, low[1]], [high[0], high[1]]),
        ([x, low[1]], [u, y]),
        ([x, v], [u, high[1]]),
    )
    return [
        solids.box_between(frame, np.append(a, low[2]), np.append(b, high[2]), f"{name} {i + 1}")
        for i, (a, b) in enumerate(pieces)
    ]


WALL = (0.4, 1.2)
"""Thickness of walls."""

MARGIN = (1.3, 6.0)
"""Distance of the shape from the walls of its cell, each wall with its own."""

NARROW, WIDE = (1.25, 1.8), (1.25, 5.0)
"""Half of the narrower and of the wider side of a door. All three in radii of the body."""

TILT = 0.35
"""Largest angle between the shape and the normal of the wall that it goes through, rad."""

SAMPLES = 12
"""Of a segment, where it is looked at in which cell it lies."""


class Cell(NamedTuple):
    """A room with one door.

    Attributes
    ----------
    frame : ndarray (4, 4)
        Its origin is in the middle of the door, on the outer face; its z axis leads out.
    low, high : ndarray (3,)
        Corners of the hollow in the frame; `high[2]` is the inner face of the wall with the door.
    half : ndarray (2,)
        Half of the sides of the door.
    wall : float
        Thickness.
    """

    frame: Floats
    low: Floats
    high: Floats
    half: Floats
    wall: float

    def boxes(self, name: str) -> list[sn.Box]:
        """Return its walls."""
        return [*self.shell(name), *self.front(name)]

    def shell(self, name: str) -> list[sn.Box]:
        """Return all walls but the one with the door."""
        low, high = self.low - self.wall, np.append(self.high[:2] + self.wall, self.high[2])
        around = wall_with_door(self.frame, low, high, np.array([self.low[:2], self.high[:2]]), name)
        back = np.append(self.low[:2], low[2]), np.append(self.high[:2], self.low[2])
        return [*around, solids.box_between(self.frame, *back, f"{name} back")]

    def front(self, name: str) -> list[sn.Box]:
        """Return the wall with the door."""
        low, high = self.low - self.wall, self.high + self.wall
        low[2] = self.high[2]
        return wall_with_door(self.frame, low, high, np.array([-self.half, self.half]), f"{name} front")

    def keeps_out(self, points: Floats, by: float) -> bool:
        """Whether points (m, 3) are beyond the door, or outside of all walls."""
        local = in_frame(self.frame, points)
        low, high = self.low - self.wall - by, self.high + self.wall + by
        ahead = local[:, 2] >= -1e-9 * self.wall
        return bool((ahead | (local < low).any(axis=1) | (local[:, :2] > high[:2]).any(axis=1)).all())


def in_frame(frame: Floats, points: Floats) -> Floats:
    """Return points (m, 3) of the world in a frame (4, 4)."""
    local: Floats = (points - frame[:3, 3]) @ frame[:3, :3]
    return local


def doorway(at: Floats, rng: Generator, inwards: bool = False) -> Floats:
    """Return the frame (4, 4) of a door that a shape goes through at the frame `at`; z leads out of the cell."""
    lean, roll = rng.uniform(0.0, TILT), rng.uniform(0.0, 2.0 * math.pi)
    normal = np.array([math.sin(lean) * math.cos(roll), math.sin(lean) * math.sin(roll), math.cos(lean)])
    turn = sn.pose(direction=-normal if inwards else normal)
    frame: Floats = at @ turn @ about_z(rng.uniform(0.0, 2.0 * math.pi))
    return frame


def draw_half(radius: float, rng: Generator) -> Floats:
    """Draw half of the sides of a door; either may be the narrow one."""
    half = radius * np.array([rng.uniform(*NARROW), rng.uniform(*WIDE)])
    return half[::-1].copy() if rng.random() < 0.5 else half


def cell_around(points: Floats, frame: Floats, half: Floats, radius: float, rng: Generator) -> Cell | None:
    """Return the cell that points (m, 3) lie in, all of them behind the door; `None` where they do not."""
    local = in_frame(frame, points)
    wall = radius * rng.uniform(*WALL)
    if local[:, 2].max() > 1e-9 * radius:
        return None
    beside = half + 0.2 * radius
    low = local.min(axis=0) - radius * rng.uniform(*MARGIN, 3)
    high = local.max(axis=0) + radius * rng.uniform(*MARGIN, 3)
    low[:2], high[:2] = np.minimum(low[:2], -beside), np.maximum(high[:2], beside)
    high[2] = -wall
    low[2] = min(low[2], -2.0 * radius)
    return Cell(frame, low, high, half, wall)


def cell_between(
    inner: Floats, outer: Floats, frame: Floats, half: Floats, radius: float, rng: Generator
) -> Cell | None:
    """Return the same cell where points outside are beyond its door, or outside of all its walls."""
    cell = cell_around(inner, frame, half, radius, rng)
    return None if cell is None or not cell.keeps_out(outer, radius) else cell


FLIP = np.diag([1.0, -1.0, -1.0, 1.0])
"""Turns a frame about its x axis, so that z leads back."""


def cells_back_to_back(
    inner: Floats, outer: Floats, frame: Floats, half: Floats, radius: float, rng: Generator
) -> tuple[Cell, Cell] | None:
    """Return the cells around points on both sides of a wall that have the same door; `None` where one is not."""
    first = cell_around(inner, frame, half, radius, rng)
    other = cell_around(outer, frame @ FLIP, half, radius, rng)
    return None if first is None or other is None else (first, other)


SHARE = (0.25, 0.75)
"""Of the shape, how much is on one side of the door."""

DOOR_APART = 4.0
"""Distance of the shape from itself, in radii of the body."""

ASIDE = 0.2
"""Largest cosine of the angle between the base's tangent and the direction of a door that is beside or behind it."""

LATE = 0.9
"""Largest share of the shape before such a door."""

SHAPES = 20
"""Shapes drawn for one: few turn back."""

FOLDED, FOLDS = (0.5, 0.85), 0.45
"""Share of a folded shape in its room; largest diagonal of that part, of its length."""

HALL = 1000.0
"""Edge of a hall, in radii of the body."""

SLIT = (0.5, 0.9)
"""Half of the narrower side of a door that is too narrow, in the smallest radius of the body."""


def door_out(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell with one door, the target outside."""
    q, curve, k = _drawn(robot, rng)
    return _cell_at_base(robot, q, curve, k, rng)


def door_in(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the target into a cell with one door, the base outside."""
    q, curve, k = _drawn(robot, rng)
    frame = doorway(curve.poses[k], rng, inwards=True)
    return _in_cell(robot, q, frame, curve.after(k), curve.before(k), rng)


def door_beside(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell whose door is beside or behind it: the tangent forbids the shortest route."""
    for _ in range(SHAPES):
        q, curve, _ = _drawn(robot, rng)
        ways = curve.points - curve.points[0]
        behind = ways @ curve.tangents[0] <= ASIDE * np.linalg.norm(ways, axis=1)
        last = len(ways) - 1
        doors = [k for k in range(round(SHARE[0] * last), round(LATE * last)) if behind[k]]
        found = _cell_at_base(robot, q, curve, int(rng.choice(doors)), rng) if doors else None
        if found is not None:
            return found
    return None


def folded(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Fold most of the robot into the cell at its base."""
    q, curve, k = _drawn(robot, rng, FOLDED)
    points = curve.before(k)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    if np.linalg.norm(np.ptp(in_frame(curve.poses[k], points), axis=0)) > FOLDS * length:
        return None
    return _cell_at_base(robot, q, curve, k, rng)


def hall(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell so large that a search which looks everywhere has much to look at."""
    q, curve, k = _drawn(robot, rng)
    frame, radius = doorway(curve.poses[k], rng), max(robot.radii)
    cell = cell_around(curve.before(k), frame, draw_half(radius, rng), radius, rng)
    if cell is None:
        return None
    spare = np.maximum(HALL * radius - (cell.high - cell.low), 0.0)
    share = np.append(rng.random(2), 1.0)
    large = cell._replace(low=cell.low - share * spare, high=cell.high + (1.0 - share) * spare)
    return sketch_of(robot, large.boxes("hall"), q, rng) if large.keeps_out(curve.after(k), radius) else None


def two_doors(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put base and target into two cells whose common wall has two doors, of which one is too narrow."""
    q, curve, k = _drawn(robot, rng)
    frame, radius = doorway(curve.poses[k], rng), max(robot.radii)
    cells = cells_back_to_back(curve.before(k), curve.after(k), frame, draw_half(radius, rng), radius, rng)
    common = None if cells is None else common_wall(*cells, min(robot.radii), rng)
    return None if common is None else sketch_of(robot, common, q, rng)


def _drawn(robot: sn.Robot, rng: Generator, share: tuple[float, float] = SHARE) -> tuple[Floats, Curve, int]:
    """Draw a shape, and the number of the frame where it goes through a wall."""
    q = draw_shape(robot, DOOR_APART * max(robot.radii), rng)
    curve = curve_of(robot, q, SAMPLES)
    return q, curve, curve.draw(share, rng)


def _cell_at_base(robot: sn.Robot, q: Floats, curve: Curve, k: int, rng: Generator) -> Sketch | None:
    return _in_cell(robot, q, doorway(curve.poses[k], rng), curve.before(k), curve.after(k), rng)


def _in_cell(robot: sn.Robot, q: Floats, door: Floats, inner: Floats, outer: Floats, rng: Generator) -> Sketch | None:
    radius = max(robot.radii)
    cell = cell_between(inner, outer, door, draw_half(radius, rng), radius, rng)
    return None if cell is None else sketch_of(robot, cell.boxes("cell"), q, rng)


def common_wall(first: Cell, other: Cell, thin: float, rng: Generator) -> list[sn.Box] | None:
    """Walls of two cells on both sides of a wall with the door of the first, and a slit beside it.

    `None` where no room is left for the slit.
    """
    flipped, wall = np.sort([other.low[:2] * [1.0, -1.0], other.high[:2] * [1.0, -1.0]], axis=0), first.wall
    low = np.append(np.minimum(first.low[:2], flipped[0]) - wall, -0.5 * wall)
    high = np.append(np.maximum(first.high[:2], flipped[1]) + wall, 0.5 * wall)
    both = np.maximum(first.low[:2], flipped[0]), np.minimum(first.high[:2], flipped[1])
    slit = thin * np.array([rng.uniform(*SLIT), rng.uniform(1.0, 4.0)])
    centers = rng.uniform(both[0] + slit, np.maximum(both[1] - slit, both[0] + slit), (20, 2))
    right = centers[:, 0] - slit[0] > first.half[0] + 0.3 * thin
    if not right.any() or (both[1] - both[0] < 2.0 * slit).any():
        return None
    center = centers[right][0]
    seam = 0.5 * (first.half[0] + center[0] - slit[0])
    left_high, right_low = high.copy(), low.copy()
    left_high[0] = right_low[0] = seam
    real, false = np.array([-first.half, first.half]), np.array([center - slit, center + slit])
    return [
        *first._replace(high=np.append(first.high[:2], -0.5 * wall)).shell("base cell"),
        *other._replace(high=np.append(other.high[:2], -0.5 * wall)).shell("target cell"),
        *wall_with_door(first.frame, low, left_high, real, "door"),
        *wall_with_door(first.frame, right_low, high, false, "slit"),
    ]


PLATE_FEWEST, PLATE_MOST = 2, 6
AHEAD = 0.3
"""Least cosine of the angle between the hidden shape and where it begins: plates across a coil would have to be small.
"""

PLATE_HOLE, PLATE_THICKNESS = 1.5, 0.5
PLATE_SMALLEST, LARGEST = 12.0, 16.0
"""Half the edge of a plate: the largest one that does not cut the hidden shape elsewhere.

All lengths in radii of the body.
"""


def plates(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put two to six plates across the hidden shape, evenly along it but for a little."""
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng, AHEAD)
    curve = curve_of(robot, q, 40)
    count = int(rng.integers(PLATE_FEWEST, PLATE_MOST + 1))
    shares = 0.2 + 0.7 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count
    found: list[sn.Mesh] = []
    for share in shares:
        pose = curve.poses[round(share * (len(curve.poses) - 1))]
        half = largest_half(curve, pose, radius)
        if half < PLATE_SMALLEST * radius:
            return None
        surface = solids.plate(pose, half, PLATE_HOLE * radius, PLATE_THICKNESS * radius)
        found.append(surface.mesh(f"plate {len(found) + 1}"))
    return Sketch(robot, found, q)


def largest_half(curve: Curve, pose: Floats, radius: float) -> float:
    """Return half the edge of the plate that leaves 1.5 radii to all of the curve that does not go through its hole."""
    local = (curve.points - pose[:3, 3]) @ pose[:3, :3]
    across = np.abs(local[:, :2]).max(axis=1)
    near = (np.abs(local[:, 2]) < 2.0 * radius) & (across > PLATE_HOLE * radius)
    return min(LARGEST * radius, float(across[near].min(initial=math.inf)) - 2.0 * radius)


WALLS, KEYHOLE_THICKNESS = (1, 3), (0.5, 4.0)
"""How many walls there are, and how thick."""

HOLE, SLOT, SLOT_END = 1.4, 0.5, (2.5, 5.0)
"""Radius of the round part of a keyhole, half the width of its slot, and how far from the middle that ends."""

SMALLEST = 8.0
"""Half the edge of a wall at least."""

KEYHOLE_APART = 4.0
"""Distance of the shape from itself. All lengths are in radii of the body."""

SIDES = 48

INNER, OUTER = (0.15, 0.4), (0.55, 0.8)
"""Where the shape leaves the inner and the outer cell, of its length."""


def keyholes(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put thick walls across the shape, each with an opening like a keyhole."""
    radius = max(robot.radii)
    q = draw_shape(robot, KEYHOLE_APART * radius, rng)
    curve, count = curve_of(robot, q, 40), int(rng.integers(WALLS[0], WALLS[1] + 1))
    walls: list[sn.Mesh] = []
    for share in 0.2 + 0.7 * (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count:
        at = doorway(curve.poses[round(share * (len(curve.poses) - 1))], rng)
        half = largest_half(curve, at, radius)
        if half < SMALLEST * radius:
            return None
        thickness, end = radius * rng.uniform(*KEYHOLE_THICKNESS), radius * rng.uniform(*SLOT_END)
        walls.append(solids.plate(at, half, _keyhole(radius, end), thickness, SIDES).mesh(f"wall {len(walls) + 1}"))
    return sketch_of(robot, walls, q, rng)


def nested(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the base into a cell within a larger cell, each with a door of its own; the target is outside."""
    q = draw_shape(robot, KEYHOLE_APART * max(robot.radii), rng)
    curve, radius = curve_of(robot, q, SAMPLES), max(robot.radii)
    first, second = (curve.draw(share, rng) for share in (INNER, OUTER))
    inner_door, outer_door = doorway(curve.poses[first], rng), doorway(curve.poses[second], rng)
    before, after = curve.before(first), curve.after(first)
    inner = cell_between(before, after, inner_door, draw_half(radius, rng), radius, rng)
    outer = cell_around(curve.before(second), outer_door, draw_half(radius, rng), radius, rng)
    if inner is None or outer is None:
        return None
    low, high = inner.low - inner.wall, np.append(inner.high[:2] + inner.wall, 0.0)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1), indexing="ij"), axis=-1).reshape(-1, 3)
    within = in_frame(outer_door, corners @ inner_door[:3, :3].T + inner_door[:3, 3])
    spare = 3.0 * radius
    if within[:, 2].max() > outer.high[2]:
        return None
    lower, upper = np.minimum(outer.low, within.min(axis=0) - spare), outer.high.copy()
    upper[:2] = np.maximum(upper[:2], within.max(axis=0)[:2] + spare)
    outer = outer._replace(low=lower, high=upper)
    if not outer.keeps_out(curve.after(second), radius):
        return None
    return sketch_of(robot, [*inner.boxes("inner cell"), *outer.boxes("outer cell")], q, rng)


def _keyhole(radius: float, end: float) -> Floats:
    """Radii (SIDES,) of a hole whose slot leads along x, in the directions of `outlines_of`."""
    ahead = solids.outlines_of(SIDES)[0]
    slot = np.minimum(end, SLOT * radius / np.maximum(np.abs(ahead[:, 1]), 1e-9))
    return np.maximum(HOLE * radius, np.where(ahead[:, 0] > 0.0, slot * math.cos(math.pi / SIDES), 0.0))


COUNT = (2, 7)
BEND, STRETCH, WORLD_THICKNESS, MOUNT = (0.8, 3.0), 0.4, (0.03, 0.13), 0.3
"""Range of the largest bend, rad; most that segments differ in length; range of the radius, and longest mount, of a
segment's length."""

WALL_SIZE = (6.0, 30.0)
"""Range of half the edge of a wall that stands alone, in radii of the body."""

MOST_BOXES = 6
BOX_SIZE = (0.1, 1.0)
"""Range of the edges of a box, of the extent of the shape."""

LEEWAY = 1.15
"""Least distance of a box from the shape, in radii of the body."""


def small_world(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Draw any shape of a robot, and put a door where the shape passes: in a wall, or in that of a cell."""
    q, radius = random_configurations(robot, 1, rng)[0], max(robot.radii)
    curve = curve_of(robot, q, SAMPLES)
    k = curve.draw((0.15, 0.9), rng)
    kind, half = int(rng.integers(3)), draw_half(radius, rng)
    frame = doorway(curve.poses[k], rng, inwards=kind == 2)
    if kind == 0:
        doors = _wall(frame, half, radius, rng)
    else:
        inner, outer = (curve.before(k), curve.after(k)) if kind == 1 else (curve.after(k), curve.before(k))
        cell = cell_between(inner, outer, frame, half, radius, rng)
        if cell is None:
            return None
        doors = cell.boxes("cell")
    if min(measure(box, curve.points).min() for box in doors) < radius and robot.mount == 0.0:
        return None
    return sketch_of(robot, [*doors, *_boxes(curve, radius, rng)], q, rng)


def any_robot(_: int, rng: Generator) -> sn.Robot:
    """Draw a robot of any size, alike or different segments, some with an insertion stage or a mount."""
    unit = 10.0 ** rng.uniform(-2.0, 2.0)
    radius = unit * rng.uniform(*WORLD_THICKNESS)
    max_bend, stretch = rng.uniform(*BEND), rng.choice([0.0, STRETCH]) * rng.random()
    lengths = unit * (1.0 + rng.choice([0.0, 0.4]) * rng.uniform(-1.0, 1.0, int(rng.integers(*COUNT))))
    segments = [sn.Segment((length * (1.0 - stretch), length), max_bend, radius=radius) for length in lengths]
    if rng.random() < 0.25:
        segments.insert(0, sn.Segment((0.0, unit * rng.uniform(0.5, 2.0)), 0.0, radius=radius))
    mount = rng.choice([0.0, 0.0, MOUNT]) * unit * rng.random()
    return sn.Robot(segments, mount=mount, base=sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)))


def _wall(frame: Floats, half: Floats, radius: float, rng: Generator) -> list[sn.Box]:
    """Return a wall of any size around a door."""
    low, high = -half - radius * rng.uniform(*WALL_SIZE, 2), half + radius * rng.uniform(*WALL_SIZE, 2)
    thick = 0.5 * radius * rng.uniform(0.4, 2.0)
    return wall_with_door(frame, np.append(low, -thick), np.append(high, thick), np.array([-half, half]), "wall")


def _boxes(curve: Curve, radius: float, rng: Generator) -> list[sn.Box]:
    """Return boxes that leave the shape alone."""
    points = curve.points
    size = float(np.linalg.norm(np.ptp(in_frame(curve.poses[0], points), axis=0)))
    found = list[sn.Box]()
    for _ in range(int(rng.integers(0, MOST_BOXES + 1))):
        center = points[rng.integers(len(points))] + 0.4 * size * rng.normal(size=3)
        box = sn.Box(center, size * rng.uniform(*BOX_SIZE, 3) ** 2, rng.normal(size=4), name=f"box {len(found) + 1}")
        if measure(box, points).min() > LEEWAY * radius:
            found.append(box)
    return found
