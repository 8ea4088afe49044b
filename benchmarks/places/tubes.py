"""What a body is led through: pipes, corridors between cells, bores, ducts, branching and tapering tubes."""

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from scipy.spatial import cKDTree

from benchmarks.places import solids
from benchmarks.places.cells import FLIP, SAMPLES, cell_between, channel, in_frame
from benchmarks.places.parts import WALL, Curve, about_z, arc, curve_of, draw_flat_shape, draw_shape, lengthened
from benchmarks.places.place import Sketch, sketch_of
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.scene.mesh import Mesh
from sinuous.scene.obstacles import Box, Obstacle

RINGS = 9
"""Rings of a mesh along one segment."""

STEP = 0.25
"""Between points of axes that a wall is made around on a grid, in radii of the body."""

BEHIND = (0.0, 2.0)
"""How far a pipe goes on behind the base, in radii of the body."""

STRAIGHT, CLOSED = 0.35, 0.3
"""Share of open pipes that are straight, and of those that are closed behind the base."""

REACH = (0.3, 0.75)
"""Of a shape, how much a bent pipe that begins at the base encloses."""

BETWEEN, GUIDE, CHANNEL = 1.6, (1.1, 1.35), 1.5
"""Inner radius of a pipe between base and target, of a guide tube; half the side of a channel. In radii of the body."""


def open_pipe(width: float, robot: Robot, rng: Generator) -> Sketch:
    """Put the base into one mouth of a pipe of `width` times the radius of the body, bent or straight."""
    straight = _first(robot, rng) if rng.random() < STRAIGHT else 0
    q, curve = tube_shape(robot, width, rng, range(straight))
    end = straight * RINGS if straight else curve.draw(REACH, rng)
    return _piped(robot, q, curve.poses[: end + 1], width, rng)


def guide_tube(robot: Robot, rng: Generator) -> Sketch:
    """Put the base into a straight tube that hardly leaves room; the shape bends beyond its mouth."""
    straight, width = _first(robot, rng), rng.uniform(*GUIDE)
    q, curve = tube_shape(robot, width, rng, range(straight))
    return _piped(robot, q, curve.poses[: straight * RINGS + 1], width, rng)


def pipe_between(robot: Robot, rng: Generator) -> Sketch:
    """Put a pipe, bent or straight, around the middle of the shape: base and target are outside."""
    n = len(robot)
    first = int(rng.integers(1, n - 1))
    straight = range(first, first + 1 + (n - first) // 3) if rng.random() < STRAIGHT else range(0)
    q, curve = tube_shape(robot, BETWEEN, rng, straight)
    begin, end = straight.start * RINGS, min(straight.stop * RINGS, len(curve.poses) - 1)
    if not straight:
        begin, end = curve.draw((0.15, 0.4), rng), curve.draw((0.6, 0.85), rng)
    return sketch_of(robot, [walled(curve.poses[begin : end + 1], BETWEEN, max(robot.radii), "pipe")], q, rng)


def open_channel(robot: Robot, rng: Generator) -> Sketch:
    """Put the base into a straight channel of four boxes."""
    straight = _first(robot, rng)
    q, curve = tube_shape(robot, math.sqrt(2.0) * CHANNEL, rng, range(straight))
    poses = backwards(curve.poses[: straight * RINGS + 1], max(robot.radii), rng)
    length = float(np.linalg.norm(poses[-1, :3, 3] - poses[0, :3, 3]))
    radius = max(robot.radii)
    return sketch_of(robot, channel(poses[0], CHANNEL * radius, length, WALL * radius), q, rng)


def _first(robot: Robot, rng: Generator) -> int:
    """How many segments from the base lie straight: some must be left to bend."""
    stage = robot.segments[0].max_bend == 0.0
    return int(stage + rng.integers(0 if stage else 1, max(2, (len(robot) - stage) // 2)))


def tube_shape(robot: Robot, width: float, rng: Generator, straight: range = range(0)) -> tuple[Floats, Curve]:
    """Draw a shape with room for a tube of this width, in radii of the body; return its curve, too."""
    q = draw_shape(robot, 2.1 * (width + WALL) * max(robot.radii), rng, straight=straight)
    return q, curve_of(robot, q, RINGS)


def walled(poses: Floats, width: float, radius: float, name: str, bottom: bool = False) -> Mesh:
    """Return the wall about frames (m, 4, 4) of an open pipe of this width, in radii of the body."""
    return solids.open_tube(poses, width * radius, (width + WALL) * radius, bottom).mesh(name)


def backwards(poses: Floats, radius: float, rng: Generator) -> Floats:
    """Begin a little behind the first of the frames (m, 4, 4)."""
    start = poses[:1].copy()
    start[0, :3, 3] -= radius * rng.uniform(*BEHIND) * start[0, :3, 2]
    return np.concatenate([start, poses])


def _piped(robot: Robot, q: Floats, poses: Floats, width: float, rng: Generator) -> Sketch:
    """Put a wall around frames (m, 4, 4) that begin at the base."""
    radius = max(robot.radii)
    enclosed = backwards(poses, radius, rng)
    closed = rng.random() < CLOSED
    if closed:
        enclosed[0, :3, 3] = poses[0, :3, 3] - 1.2 * radius * poses[0, :3, 2]
    return sketch_of(robot, [walled(enclosed, width, radius, "pipe", bottom=closed)], q, rng)


CORRIDOR_WIDTH = (1.3, 1.8)
"""Inner radius of a pipe, half the side of a channel, in radii of the body."""


def between_cells(straight: bool, robot: Robot, rng: Generator) -> Sketch | None:
    """Put base and target into two cells: a straight channel of boxes leads between them, or a bent pipe, a mesh."""
    radius, width, n, held = max(robot.radii), rng.uniform(*CORRIDOR_WIDTH), len(robot), range(0)
    if straight:
        first = int(rng.integers(1, n - 1))
        held = range(first, min(n - 1, first + 1 + n // 5))
    q, _ = tube_shape(robot, width, rng, held)
    curve, door = curve_of(robot, q, SAMPLES), np.full(2, width * radius)
    begin, end = held.start * SAMPLES, held.stop * SAMPLES
    if not straight:
        begin, end = curve.draw((0.2, 0.4), rng), curve.draw((0.5, 0.8), rng)
    at_base = cell_between(curve.before(begin), curve.after(begin), curve.poses[begin], door, radius, rng)
    at_target = cell_between(curve.after(end), curve.before(end), curve.poses[end] @ FLIP, door, radius, rng)
    if at_base is None or at_target is None:
        return None
    wall: list[Obstacle] = [walled(curve.poses[begin : end + 1], width, radius, "pipe")]
    if straight:
        length = float(np.linalg.norm(curve.points[end] - curve.points[begin]))
        wall = [*channel(curve.poses[begin], width * radius, length, WALL * radius, "channel")]
    return sketch_of(robot, [*at_base.boxes("base cell"), *at_target.boxes("target cell"), *wall], q, rng)


TUBE_WIDTH = (1.25, 2.5)
"""Inner radius of a tube."""

PAST = (1.2, 3.0)
"""How far a tube goes on beyond the tip, or the tool. Both in radii of the body."""

BLIND = 0.5
"""Share of the tubes about a target that are closed at the bottom."""

GAP_BEGINS, GAP_ENDS = (0.15, 0.45), (0.6, 0.85)
"""Where the tube of the base ends, and where that of the target begins, of the shape."""

FUNNEL_BEGINS, WIDENED, CONE = (0.3, 0.7), (1.5, 3.0), 0.25
"""Where a funnel begins, of the shape; how much wider it is there; and how much of it is a cone."""


def two_tubes(robot: Robot, rng: Generator) -> Sketch:
    """Put the base into one tube and the target into another, with the open between."""
    radius, (near, far) = max(robot.radii), rng.uniform(*TUBE_WIDTH, 2)
    q, curve = tube_shape(robot, max(near, far), rng)
    begin, end = curve.draw(GAP_BEGINS, rng), curve.draw(GAP_ENDS, rng)
    first = walled(backwards(curve.poses[: begin + 1], radius, rng), near, radius, "base tube")
    within = past(robot, q, curve.poses[end:], rng)
    other = around_target(within, far * radius, radius, rng)
    return sketch_of(robot, [first, other.mesh("target tube")], q, rng)


def funnel(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the target into a tube, open at both ends, whose mouth widens; the base is before it."""
    radius, width, widened = max(robot.radii), rng.uniform(*TUBE_WIDTH), rng.uniform(*WIDENED)
    q, curve = tube_shape(robot, width * widened, rng)
    begin = curve.draw(FUNNEL_BEGINS, rng)
    poses = past(robot, q, curve.poses[begin:], rng)
    share = np.linspace(0.0, 1.0, len(poses))
    inside = width * radius * (1.0 + (widened - 1.0) * np.clip(1.0 - share / CONE, 0.0, 1.0))
    return sketch_of(robot, [solids.open_tube(poses, inside, inside + WALL * radius).mesh("funnel")], q, rng)


def past(robot: Robot, q: Floats, poses: Floats, rng: Generator) -> Floats:
    """Return poses (m, 4, 4) that go on beyond the tip, and beyond the tool."""
    tool = curve_of(robot, q, SAMPLES).end - poses[-1, :3, 3]
    ahead = max(0.0, float(tool @ poses[-1, :3, 2]))
    return lengthened(poses, ahead + max(robot.radii) * rng.uniform(*PAST))


def around_target(poses: Floats, inside: float, radius: float, rng: Generator) -> solids.Surface:
    """Return the wall about frames (m, 4, 4) that the shape enters by the first one; the last is closed or open."""
    if rng.random() >= BLIND:
        return solids.open_tube(poses, inside, inside + WALL * radius)
    return solids.open_tube(poses[::-1] @ FLIP, inside, inside + WALL * radius, bottom=True)


BORE_WIDTH, BLOCK, BOTTOM = (1.3, 1.8), (3.0, 8.0), (1.1, 3.0)
"""Inner radius of a bore; half the edge of the block; how far the bottom is beyond the tip. In radii of the body."""


def bore(square: bool, robot: Robot, rng: Generator) -> Sketch | None:
    """Drill a round bore into a block, a mesh; or leave a square one between four boxes and one at the bottom."""
    radius = max(robot.radii)
    width, block = radius * rng.uniform(*BORE_WIDTH), radius * rng.uniform(*BLOCK)
    q, frame, depth = _drilled(robot, rng)
    tool = in_frame(frame, curve_of(robot, q, SAMPLES).end[None])[0]
    if float(np.linalg.norm(tool[:2])) >= width - 0.2 * radius:  # the tool is in the wall
        return None
    made: list[Obstacle] = [solids.blind_bore(frame, width, depth, block, radius).mesh("block")]
    if square:
        low, high = np.array([-block, -block, depth]), np.array([block, block, depth + radius])
        made = [*channel(frame, width, depth, block - width), solids.box_between(frame, low, high, "bottom")]
    return sketch_of(robot, made, q, rng)


def _drilled(robot: Robot, rng: Generator) -> tuple[Floats, Floats, float]:
    """Configuration whose last segments are straight, frame (4, 4) of the mouth with z into the bore, and its depth."""
    n, radius = len(robot), max(robot.radii)
    count = int(rng.integers(1, max(2, n // 3)))
    q = draw_shape(robot, 4.0 * radius, rng, straight=range(n - count, n))
    curve = curve_of(robot, q, SAMPLES)
    mouth = curve.poses[round(rng.uniform(n - count, n - 0.5) * SAMPLES)]
    local = in_frame(mouth, np.stack([curve.points[-1], curve.end]))
    depth = float(local[0, 2] + max(radius * rng.uniform(*BOTTOM), local[1, 2] - local[0, 2] + 0.3 * radius))
    return q, mouth, depth


BRANCH_WIDTH = (1.4, 2.2)
"""Inner radius of a pipe."""

BRANCH_CELL = 0.75
"""Edge of the cells of the grid that the wall is made on."""

BRANCH = (10.0, 25.0)
"""Length of the dead end. All three in radii of the body."""

WHERE, ANGLE = (0.2, 0.75), (0.6, 0.5 * math.pi)
"""Where it leaves the pipe, of the shape, and at what angle, rad: a T or a Y."""

OPENED, TRIES = 0.5, 20
"""Share of the pipes that are open behind the base, too; and draws of a branch."""


def branches(robot: Robot, rng: Generator) -> Sketch | None:
    """Put the shape into a pipe that is open beyond the tip, with a dead end on its way."""
    radius, width = max(robot.radii), rng.uniform(*BRANCH_WIDTH)
    q = draw_shape(robot, 2.2 * (width + WALL) * radius, rng)
    curve = curve_of(robot, q, math.ceil(q[:, 2].max() / (STEP * radius)))
    dead = offshoots(curve.points, partial(_dead_end, curve.poses, radius, rng), 1, TRIES, (width + WALL) * radius)
    if not dead:
        return None
    tool = np.linspace(curve.points[-1], curve_of(robot, q, SAMPLES).end, 20)
    axes = np.concatenate([curve.points, *dead, tool])
    beyond = np.linspace(0.0, (width + 2.0) * radius, 20)[:, None]
    open_at = [tool[-1] + beyond * curve.tangents[-1]]
    if rng.random() < OPENED:
        open_at.append(curve.points[0] - beyond * curve.tangents[0])
    hollow = np.concatenate([axes, *open_at])
    outer, inner = np.full(len(axes), (width + WALL) * radius), np.full(len(hollow), width * radius)
    surface = lumen(axes, outer, hollow, inner, BRANCH_CELL * radius)
    return sketch_of(robot, [surface.mesh("pipe")], q, rng)


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


def lumen(axes: Floats, outer: Floats, hollow: Floats, inner: Floats, cell: float) -> solids.Surface:
    """Return the wall within radii (m,) of points (m, 3) that leaves radii (k,) of points (k, 3) hollow."""
    walls, hollows = cKDTree(axes), cKDTree(hollow)

    def signed(places: Floats) -> Floats:
        (out, i), (within, j) = walls.query(places), hollows.query(places)
        return np.asarray(np.maximum(out - outer[i], inner[j] - within))

    return solids.around(axes, float(outer.max()), cell, signed)


def _dead_end(poses: Floats, radius: float, rng: Generator) -> Floats:
    """Draw a straight branch (k, 3) that leaves a pipe (m, 4, 4)."""
    at = poses[round(rng.uniform(*WHERE) * (len(poses) - 1))]
    turn, angle = rng.uniform(0.0, 2.0 * math.pi), rng.uniform(*ANGLE)
    sideways = at[:3, :2] @ [math.cos(turn), math.sin(turn)]
    gone = np.arange(0.0, radius * rng.uniform(*BRANCH), STEP * radius)[:, None]
    return np.asarray(at[:3, 3] + gone * (math.cos(angle) * at[:3, 2] + math.sin(angle) * sideways))


DUCT_WIDTH = (1.25, 3.0)
"""Half of each side of the section."""

SHEET = 0.8
"""Thickness of the walls. Both in radii of the body."""

BEGINS, ENDS, DUCT_WITHIN = (0.1, 0.35), (0.5, 0.95), 0.6
"""Where a duct begins and ends, of the shape; and share of those that begin at the base."""

EVERY = 3
"""Frames of the shape from one box of a wall to the next."""


def box_duct(robot: Robot, rng: Generator) -> Sketch | None:
    """Lead a duct around a flat shape, from the base or from a place beyond it."""
    radius, (width, height) = max(robot.radii), rng.uniform(*DUCT_WIDTH, 2)
    plane = rng.uniform(0.0, 2.0 * math.pi)
    found = draw_flat_shape(robot, 2.2 * (width + SHEET) * radius, plane, rng)
    if found is None:
        return None
    q, curve = found
    at_base = rng.random() < DUCT_WITHIN
    begin, end = 0 if at_base else curve.draw(BEGINS, rng), curve.draw(ENDS, rng)
    poses = curve.poses[begin : end + 1 : EVERY] @ about_z(plane)
    if at_base:
        poses = backwards(poses, radius, rng)
    return sketch_of(robot, _walls(poses, width * radius, height * radius, SHEET * radius), q, rng)


def _walls(poses: Floats, width: float, height: float, sheet: float) -> list[Box]:
    """Boxes along both sides of frames (m, 4, 4) whose x axes lie in the plane, and a floor and a ceiling."""
    boxes, points = list[Box](), poses[:, :3, 3]
    for side, name in ((-1.0, "left"), (1.0, "right")):
        edge = points + side * (width + 0.5 * sheet) * poses[:, :3, 0]
        for a, b in pairwise(edge):
            length = float(np.linalg.norm(b - a))
            along, normal = (b - a) / length, poses[0, :3, 1]
            size = sheet, 2.0 * height, length + 0.2 * sheet
            boxes.append(Box(0.5 * (a + b), size, np.column_stack([np.cross(normal, along), normal, along]), name=name))
    local = in_frame(poses[0], points)
    margin = width + sheet
    low, high = local.min(axis=0) - margin, local.max(axis=0) + margin
    for side, name in ((-1.0, "floor"), (1.0, "ceiling")):
        low[1], high[1] = sorted((side * height, side * (height + sheet)))
        boxes.append(solids.box_between(poses[0], low.copy(), high.copy(), name))
    return boxes


FRAMES = 60
"""Least number of frames along a shape that a wall is made on."""

VESSEL_WIDTH = (1.3, 1.8)
"""Inner radius of a helix, in radii of the body."""

BEFORE, VESSEL_WITHIN = (0.01, 0.07), 0.3
"""How far before the mouth the base stands, of the length; and the share of bases that stand in the mouth."""

BEYOND = (0.6, 0.95)
"""Where a tube ends that the tip leaves, of the length."""

COILED, TORSION = (0.4, 0.9), (0.3, 1.2)
"""Bends of a coil, of the largest; and how far its bending plane turns from segment to segment, rad."""

TRUNK, LEAF = (2.0, 2.6), (1.3, 1.6)
"""Inner radius of a tree at its mouth and at the tip, in radii of the body."""

TWIGS, TWIG = (2, 4), (8.0, 20.0)
"""How many twigs leave the way to the tip, and their length in radii of the body."""

TWIG_WIDTH, TWIG_BEND = 0.8, (0.7, 1.6)
"""Inner radius of a twig, of that of the branch it leaves; and the angle by which it bends away, rad."""

VESSEL_CELL = 0.6
"""Edge of the cells of the walls of a tree, in radii of the body."""

THROATS, THROAT, CHAMBER = (1, 3), (1.25, 1.5), (1.8, 3.0)
"""How many throats a pipe has; and its inner radius there and between them, in radii of the body."""


def helix(robot: Robot, rng: Generator) -> Sketch | None:
    """Coil the shape into a pipe that is open at both ends; the tip is beyond it."""
    radius, width = max(robot.radii), rng.uniform(*VESSEL_WIDTH)
    q = _coil(robot, rng)
    curve = curve_of(robot, q, _samples(robot))
    if not curve.keeps(2.1 * (width + WALL) * radius):
        return None
    poses = _vessel_piped(curve, radius, rng)
    return sketch_of(robot, [walled(poses, width, radius, "helix")], q, rng)


def stenosis(robot: Robot, rng: Generator) -> Sketch:
    """Draw the shape through a pipe that is narrow in a few places and wide between them."""
    radius = max(robot.radii)
    wide = rng.uniform(*CHAMBER)
    q = draw_shape(robot, 2.1 * (wide + WALL) * radius, rng)
    poses = _vessel_piped(curve_of(robot, q, _samples(robot)), radius, rng)
    share, count = np.linspace(0.0, 1.0, len(poses)), int(rng.integers(THROATS[0], THROATS[1] + 1))
    inside = np.full(len(poses), wide)
    for center in (np.arange(count) + rng.uniform(0.2, 0.8, count)) / count:
        throat = rng.uniform(*THROAT)
        inside = np.minimum(inside, throat + (wide - throat) * (1.0 - np.exp(-(((share - center) * 6.0 * count) ** 2))))
    wall = solids.open_tube(poses, radius * inside, radius * (inside + WALL))
    return sketch_of(robot, [wall.mesh("vessel")], q, rng)


def bronchi(robot: Robot, rng: Generator) -> Sketch | None:
    """Lead the shape from the mouth of a tree of tubes, which taper, into one of its leaves."""
    radius, (begin, end) = max(robot.radii), (rng.uniform(*TRUNK), rng.uniform(*LEAF))
    q = draw_shape(robot, 2.2 * (begin + WALL) * radius, rng)
    samples = math.ceil(q[:, 2].max() / (STEP * radius))
    poses = lengthened(curve_of(robot, q, samples).poses, end * radius)
    main, widths = poses[:, :3, 3], radius * np.linspace(begin, end, len(poses))
    draw = partial(_offshoot, poses, radius, TWIG_BEND, TWIG, rng)
    most = int(rng.integers(TWIGS[0], TWIGS[1] + 1))
    twigs = offshoots(main, draw, most, most, (begin + WALL) * radius)
    if not twigs:
        return None
    tree = cKDTree(main)
    room_at = [np.full(len(twig), TWIG_WIDTH * widths[tree.query(twig[0])[1]]) for twig in twigs]
    points, inside = np.concatenate([main, *twigs]), np.concatenate([widths, *room_at])
    mouth = poses[0, :3, 3] - np.linspace(0.0, (begin + 2.0) * radius, 20)[:, None] * poses[0, :3, 2]
    hollow, room = np.concatenate([points, mouth]), np.concatenate([inside, np.full(20, begin * radius)])
    surface = lumen(points, inside + WALL * radius, hollow, room, VESSEL_CELL * radius)
    return sketch_of(robot, [surface.mesh("tree")], q, rng)


def _samples(robot: Robot) -> int:
    return max(9, math.ceil(FRAMES / len(robot)))


def _coil(robot: Robot, rng: Generator) -> Floats:
    """A configuration (n, 3) whose bends are alike and whose bending plane turns evenly."""
    share, turn, plane = rng.uniform(*COILED), rng.uniform(*TORSION) * rng.choice([-1.0, 1.0]), rng.uniform(0.0, 6.28)
    rows = []
    for k, segment in enumerate(robot.segments):
        low, high = segment.length
        angle, bend = plane + k * turn, share * segment.max_bend
        rows.append([bend * math.cos(angle), bend * math.sin(angle), rng.uniform(max(low, 0.3 * high), high)])
    return np.array(rows)


def _vessel_piped(curve: Curve, radius: float, rng: Generator) -> Floats:
    """The frames (m, 4, 4) of a pipe around a shape: from its mouth, at the base or ahead of it, to where it ends."""
    end = curve.draw(BEYOND, rng) + 1
    if rng.random() < VESSEL_WITHIN:
        return backwards(curve.poses[:end], radius, rng)
    return curve.poses[max(1, curve.draw(BEFORE, rng)) : end]


def pipe(width: float, robot: Robot, rng: Generator) -> Sketch:
    """Wall in the hidden shape with a pipe of `width` times the radius of the body."""
    radius = min(robot.radii)
    outside = (width + WALL) * radius
    q = draw_shape(robot, 2.1 * outside, rng)
    poses = lengthened(curve_of(robot, q, RINGS).poses, width * radius)
    return Sketch(robot, [solids.hollow(poses, width * radius, outside).mesh("pipe")], q)


DUCT_INSIDE, DUCT_OUTSIDE = 1.7, 2.6
"""Radii of the wall, in radii of the body."""

DUCT_FEWEST, DUCT_MOST = 2, 4
DEAD_END = (10.0, 20.0)
"""Length of a dead end, in radii of the body."""

DEAD_END_BEND = (0.6, 1.8)
"""Of a dead end, away from the right way, rad."""

DUCT_CELL = 1.0
"""Of the grid that the wall is made on, in radii of the body."""

DUCT_TRIES = 30


def duct(robot: Robot, rng: Generator) -> Sketch | None:
    """Wall in the hidden shape and some dead ends that leave it."""
    radius = min(robot.radii)
    q = draw_shape(robot, 2.1 * DUCT_OUTSIDE * radius, rng)
    samples = math.ceil(max(q[:, 2]) / (STEP * radius))
    main = lengthened(curve_of(robot, q, samples).poses, DUCT_INSIDE * radius)
    draw = partial(_offshoot, main, radius, DEAD_END_BEND, DEAD_END, rng)
    wanted = int(rng.integers(DUCT_FEWEST, DUCT_MOST + 1))
    ends = offshoots(main[:, :3, 3], draw, wanted, DUCT_TRIES, DUCT_OUTSIDE * radius)
    if len(ends) < DUCT_FEWEST:
        return None
    axes = np.concatenate([main[:, :3, 3], *ends])
    outer, inner = (np.full(len(axes), size * radius) for size in (DUCT_OUTSIDE, DUCT_INSIDE))
    return Sketch(robot, [lumen(axes, outer, axes, inner, DUCT_CELL * radius).mesh("duct")], q)


def _offshoot(
    main: Floats, radius: float, bends: tuple[float, float], lengths: tuple[float, float], rng: Generator
) -> Floats:
    """Draw an arc that leaves the way somewhere, to any side but the one that the way bends to."""
    at = int(rng.uniform(0.15, 0.85) * len(main))
    ahead = main[min(at + 20, len(main) - 1), :3, 3] - main[at, :3, 3]
    side = main[at, :3, :2].T @ ahead
    plane = math.atan2(-side[1], -side[0]) + rng.uniform(-1.0, 1.0)
    bend, length = rng.uniform(*bends), radius * rng.uniform(*lengths)
    coordinates = np.array([bend * math.cos(plane), bend * math.sin(plane), length])
    points: Floats = arc(main[at], coordinates, math.ceil(length / (STEP * radius)))[:, :3, 3]
    return points
