"""Places full of something: struts, rubble, tubes, a porous solid, two plates with pillars; and crowds of parts.

Crowds are hundreds of parts: rods, sheets, hoops, trays of cables, frames of profiles, bodies of one STL. And things
that stand there: balls, a drum with blades, a shelf.
"""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from scipy.spatial import ConvexHull, cKDTree

import sinuous as sn
from benchmarks.places import solids
from benchmarks.places.parts import Curve, about_z, arc, curve_of, draw_flat_shape, draw_shape
from benchmarks.places.place import Sketch, sketch_of
from benchmarks.problems import direction
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Obstacle

APART = 4.0
"""Distance of the shape from itself."""

LEEWAY = 1.15
"""Least distance of what is solid from the shape."""

NEAR = 8.0
"""Distance from the shape up to which there is something."""

PITCH, STRUT = (5.0, 8.0), (0.2, 0.5)
"""Distance of parallel struts of a lattice, and their radius."""

BLOCKS, BLOCK = (60, 160), (0.6, 3.0)
"""How many blocks are tried for rubble, and their size."""

CORNERS = 12
"""Points whose convex hull is a block."""

TUBE, GAP = (0.8, 2.5), (1.2, 2.5)
"""Radius of the tubes of a bundle, and the gap between neighbours."""

TUBE_LENGTH = 24.0

PERIOD, SHEET = (9.0, 14.0), (0.25, 0.4)
"""Period of a gyroid, and half the thickness of its sheet."""

TUNNEL, CELL, DEEP = (1.3, 1.7), 0.6, 4.0
"""Radius of the tunnel through it, edge of the cells of its surface, and how far around the shape it is solid."""

SLAB, PILLAR, PILLARS = (1.25, 1.8), (0.5, 3.0), (10, 30)
"""Half the distance of two plates, radius of the pillars between them; and how many pillars are tried.

All lengths are in radii of the body.
"""

SLAB_BENDS = (0.2, 0.7)
"""Bends of a shape between plates, of the largest."""

MOST = 400
"""Obstacles of a place: those nearest to the shape are kept."""


def lattice(robot: sn.Robot, rng: Generator) -> Sketch:
    """Fill the space with struts along three axes, but for those that the shape would touch."""
    q, curve, radius = _drawn(robot, rng)
    pitch, thickness = radius * rng.uniform(*PITCH), radius * rng.uniform(*STRUT)
    turn, nodes = _turn(rng), _nodes(curve, pitch, NEAR * radius, rng)
    struts: list[Obstacle] = []
    for axis in range(3):
        step = pitch * np.eye(3)[axis]
        struts += [sn.Capsule(node @ turn.T, (node + step) @ turn.T, thickness) for node in nodes @ turn]
    return sketch_of(robot, _clear(struts, curve, radius), q, rng)


def rubble(robot: sn.Robot, rng: Generator) -> Sketch:
    """Heap boxes and convex stones around the shape."""
    q, curve, radius = _drawn(robot, rng)
    blocks: list[Obstacle] = []
    for _ in range(int(rng.integers(*BLOCKS))):
        away, size = rng.normal(size=3), radius * rng.uniform(*BLOCK)
        center = curve.points[rng.integers(len(curve.points))]
        center = center + away / np.linalg.norm(away) * (size + radius * rng.uniform(1.0, 4.0))
        if rng.random() < 0.5:
            box = sn.Box(center, size * rng.uniform(0.6, 1.6, 3), rng.normal(size=4))
            blocks += _clear([box], curve, radius)
        else:
            stone = _stone(center, size, curve, radius, rng)
            blocks += [] if stone is None else [stone]
    return sketch_of(robot, blocks, q, rng)


def bundle(robot: sn.Robot, rng: Generator) -> Sketch:
    """Stand parallel tubes around the shape, as in a heat exchanger, but for those that it would touch."""
    q, curve, radius = _drawn(robot, rng)
    thick, gap = radius * rng.uniform(*TUBE), 2.0 * radius * rng.uniform(*GAP)
    pitch, axes = 2.0 * thick + gap, _turn(rng)
    flat = curve.points @ axes[:, :2]
    near = cKDTree(flat)
    low, high = flat.min(axis=0) - NEAR * radius, flat.max(axis=0) + NEAR * radius
    tubes: list[Obstacle] = []
    for row, y in enumerate(np.arange(low[1], high[1], 0.5 * math.sqrt(3.0) * pitch)):
        for x in np.arange(low[0] + 0.5 * pitch * (row % 2), high[0], pitch):
            distance, closest = near.query([x, y])
            if distance < NEAR * radius:
                middle = axes @ np.array([x, y, curve.points[closest] @ axes[:, 2]])
                half = 0.5 * TUBE_LENGTH * radius * axes[:, 2]
                tubes.append(sn.Cylinder(middle - half, middle + half, thick))
    return sketch_of(robot, _clear(tubes, curve, radius), q, rng)


def gyroid(robot: sn.Robot, rng: Generator) -> Sketch:
    """Lead the shape through a porous solid, the sheet of a gyroid, with a tunnel about the shape."""
    q, _, radius = _drawn(robot, rng)
    period, sheet, tunnel = (radius * rng.uniform(*one) for one in (PERIOD, SHEET, TUNNEL))
    turn, shift = _turn(rng), rng.uniform(0.0, 2.0 * math.pi, 3)
    axis = cKDTree(curve_of(robot, q, math.ceil(q[:, 2].max() / (0.25 * radius))).points)

    def signed(points: Floats) -> Floats:
        x, y, z = (2.0 * math.pi / period * points @ turn + shift).T
        wave = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        gap = axis.query(points)[0]
        thick = np.abs(wave) * period / (2.0 * math.pi * 1.5) - sheet
        return np.asarray(np.maximum.reduce([thick, tunnel - gap, gap - DEEP * radius]))

    surface = solids.around(np.asarray(axis.data), DEEP * radius, CELL * radius, signed)
    return sketch_of(robot, [surface.mesh("gyroid")], q, rng)


def slab(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Bend the shape in a plane between two plates, with pillars beside it."""
    radius = max(robot.radii)
    found = draw_flat_shape(robot, APART * radius, 0.0, rng, SLAB_BENDS)
    if found is None:
        return None
    q, curve = found
    half, normal = radius * rng.uniform(*SLAB), robot.base[:3, 1]
    plates = [sn.HalfSpace(robot.base[:3, 3] - way * half * normal, way * normal) for way in (1.0, -1.0)]
    pillars: list[Obstacle] = []
    for _ in range(int(rng.integers(*PILLARS))):
        size, turn = radius * rng.uniform(*PILLAR), rng.uniform(0.0, 2.0 * math.pi)
        away = math.cos(turn) * robot.base[:3, 0] + math.sin(turn) * robot.base[:3, 2]
        foot = curve.points[rng.integers(len(curve.points))] + (size + radius * rng.uniform(LEEWAY, 3.0)) * away
        pillars.append(sn.Cylinder(foot - 1.5 * half * normal, foot + 1.5 * half * normal, size))
    return sketch_of(robot, [*plates, *_clear(pillars, curve, radius)], q, rng)


def _drawn(robot: sn.Robot, rng: Generator) -> tuple[Floats, Curve, float]:
    radius = max(robot.radii)
    q = draw_shape(robot, APART * radius, rng)
    return q, curve_of(robot, q, 12), radius


def _nodes(curve: Curve, pitch: float, near: float, rng: Generator) -> Floats:
    """Corners (m, 3) of a cubic grid that are near the shape."""
    origin = rng.uniform(0.0, pitch, 3)
    reach = math.ceil(near / pitch)
    block = np.stack(np.meshgrid(*[np.arange(-reach, reach + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.unique(np.floor((curve.points - origin) / pitch).astype(np.int64), axis=0)
    nodes: Floats = origin + pitch * np.unique((cells[:, None] + block).reshape(-1, 3), axis=0)
    return nodes[cKDTree(curve.points).query(nodes)[0] < near]


def _clear(obstacles: list[Obstacle], curve: Curve, radius: float) -> list[Obstacle]:
    """The obstacles that leave the shape alone; of many, those that are nearest to it."""
    gaps = [float(measure(obstacle, curve.points).min()) for obstacle in obstacles]
    kept = [i for i in np.argsort(gaps, kind="stable") if gaps[i] > LEEWAY * radius]
    return [obstacles[i] for i in kept[:MOST]]


def _stone(center: Floats, size: float, curve: Curve, radius: float, rng: Generator) -> sn.Mesh | None:
    """A convex stone; `None` where it may touch the shape: a face must lie between it and each point."""
    corners = center + 0.8 * size * rng.normal(size=(CORNERS, 3)) / math.sqrt(3.0)
    hull = ConvexHull(corners)
    beyond = (curve.points @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
    if beyond.min() < LEEWAY * radius:
        return None
    a, b, c = (corners[hull.simplices[:, i]] for i in range(3))
    outwards = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) > 0.0
    faces = np.where(outwards[:, None], hull.simplices, hull.simplices[:, ::-1]).astype(np.int64)
    used, numbers = np.unique(faces, return_inverse=True)
    return solids.Surface(corners[used], numbers.reshape(faces.shape)).mesh("stone")


CROWD_LEEWAY, AROUND = 1.2, 10.0
"""Least distance of parts of a crowd from the shape; how far about it there are parts."""

PARTS, MADE = (200, 900), 4
"""How many parts there are in a place, at most; and how many are drawn for each of them."""

ROD, ROD_LENGTH = (0.08, 0.6), (6.0, 40.0)
"""Radius of rods, and their length."""

DISK, BAR_LENGTH = (0.3, 2.5), (2.0, 14.0)
"""Radius of disks in the plane of a body, and length of bars."""

THIN, SHEET_SIZE = (0.05, 0.25), (1.0, 7.0)
"""Half the thickness of sheets, and their edges."""

HOOP, HOOP_THICKNESS, HOOP_PARTS = (1.6, 6.0), (0.1, 0.4), (8, 14)
"""Radius of hoops, that of the bar they are bent of, and of how many capsules each is made."""

CABLE, CABLE_LENGTH, CABLE_PARTS, CABLE_BEND = (0.15, 0.5), (12.0, 40.0), (8, 18), 0.35
"""Radius of cables, length of a tray of them, of how many capsules each is made, and how much it turns from one to the
next, rad."""

CABLES, SAG = (4, 12), 0.3
"""Cables side by side on a tray, and how much each deviates from the next, in radii."""

PROFILE, PROFILE_LENGTH = (0.3, 1.0), (4.0, 20.0)
"""Edges of the section of profiles, and their length."""

PIECE, PIECE_LENGTH, PIECES, PIECE_WALL = (0.2, 0.9), (4.0, 25.0), (100, 400), 0.3
"""Radius of the pieces of an assembly, length of long ones, how many there are at most, and thickness of walls in radii
of a piece. All other lengths are in radii of the body."""


def rods(robot: sn.Robot, rng: Generator) -> Sketch:
    """Throw straight rods around the shape, at random."""

    def rod(place: Floats, radius: float) -> list[Obstacle]:
        half = 0.5 * radius * rng.uniform(*ROD_LENGTH) * direction(rng)
        return [sn.Capsule(place - half, place + half, radius * rng.uniform(*ROD))]

    return _crowd(robot, rng, rod, 1)


def sheets(robot: sn.Robot, rng: Generator) -> Sketch:
    """Throw thin sheets around the shape: in half of the places they stand nearly parallel, as fins do."""
    common = rng.normal(size=4) if rng.random() < 0.5 else None

    def sheet(place: Floats, radius: float) -> list[Obstacle]:
        size = 2.0 * radius * np.array([*rng.uniform(*SHEET_SIZE, 2), rng.uniform(*THIN)])
        return [sn.Box(place, size, rng.normal(size=4) if common is None else common + 0.1 * rng.normal(size=4))]

    return _crowd(robot, rng, sheet, 1)


def disks(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Bend a body that bends in one plane between disks and bars of that plane: balls and capsules."""
    segments = [one.changed(plane=0.0 if one.max_bend else None) for one in robot.segments]
    robot = robot.changed(segments=segments, tool=None)
    radius, (ahead, normal, aside) = max(robot.radii), robot.base[:3, [2, 1, 0]].T
    found = draw_flat_shape(robot, APART * radius, 0.0, rng)
    if found is None:
        return None

    def disk(place: Floats, radius: float) -> list[Obstacle]:
        place = place - (place - robot.base[:3, 3]) @ normal * normal
        if rng.random() < 0.5:
            return [sn.Sphere(place, radius * rng.uniform(*DISK))]
        turn, length = rng.uniform(0.0, math.pi), radius * rng.uniform(*BAR_LENGTH)
        half = 0.5 * length * (math.cos(turn) * aside + math.sin(turn) * ahead)
        return [sn.Capsule(place - half, place + half, radius * rng.uniform(*ROD))]

    return _crowd(robot, rng, disk, 1, drawn=(*found, radius))


def hoops(robot: sn.Robot, rng: Generator) -> Sketch:
    """Thread the shape through hoops, and hang more of them around it, each of capsules."""
    radius = max(robot.radii)

    def hoop(place: Floats, across: Floats) -> list[Obstacle]:
        count, thickness = int(rng.integers(*HOOP_PARTS)), radius * rng.uniform(*HOOP_THICKNESS)
        size = radius * rng.uniform(*HOOP) + thickness
        turns = 2.0 * math.pi * np.arange(count + 1) / count
        corners = place + size * (np.cos(turns)[:, None] * across[:, 0] + np.sin(turns)[:, None] * across[:, 1])
        return [sn.Capsule(a, b, thickness) for a, b in pairwise(corners)]

    def any_hoop(place: Floats, _: float) -> list[Obstacle]:
        return hoop(place, _turn(rng))

    def threaded(curve: Curve) -> list[Obstacle]:
        pose = curve.poses[rng.integers(len(curve.poses))]
        tilt = np.linalg.qr(pose[:3, :3] + 0.15 * rng.normal(size=(3, 3)))[0]
        return hoop(pose[:3, 3] + 0.3 * radius * rng.normal(size=3), tilt)

    return _crowd(robot, rng, any_hoop, HOOP_PARTS[1], threaded)


def cables(robot: sn.Robot, rng: Generator) -> Sketch:
    """Lead trays of curved cables past the shape."""

    def tray(place: Floats, radius: float) -> list[Obstacle]:
        count, parts = int(rng.integers(*CABLES)), int(rng.integers(*CABLE_PARTS))
        thickness = radius * rng.uniform(*CABLE)
        step = radius * rng.uniform(*CABLE_LENGTH) / parts
        frame = _turn(rng)
        ways = [frame[:, 0]]
        for _ in range(parts - 1):
            way = ways[-1] + CABLE_BEND * rng.normal(size=3)
            ways.append(way / np.linalg.norm(way))
        line = np.cumsum([np.zeros(3), *(step * np.array(ways))], axis=0)
        made: list[Obstacle] = []
        for i in range(count):
            own = place + line - line.mean(axis=0) + 2.2 * thickness * (i - 0.5 * count) * frame[:, 1]
            own = own + SAG * thickness * rng.normal(size=own.shape)
            made += [sn.Capsule(a, b, thickness) for a, b in pairwise(own)]
        return made

    return _crowd(robot, rng, tray, CABLES[1] * CABLE_PARTS[1])


def profiles(robot: sn.Robot, rng: Generator) -> Sketch:
    """Stand the shape in a frame of profiles: boxes and cylinders along three axes, and some that are oblique."""
    axes = _turn(rng)

    def profile(place: Floats, radius: float) -> list[Obstacle]:
        length, oblique = radius * rng.uniform(*PROFILE_LENGTH), rng.random() < 0.2
        turn = _turn(rng) if oblique else np.roll(axes, int(rng.integers(3)), axis=1)
        turn = turn * np.sign(np.linalg.det(turn))
        if rng.random() < 0.5:
            size = np.array([*(2.0 * radius * rng.uniform(*PROFILE, 2)), length])
            return [sn.Box(place, size, turn)]
        half = 0.5 * length * turn[:, 2]
        return [sn.Cylinder(place - half, place + half, radius * rng.uniform(*PROFILE))]

    return _crowd(robot, rng, profile, 1)


def assembly(robot: sn.Robot, rng: Generator) -> Sketch:
    """Stand the shape among pieces of a machine: bodies of one mesh, as of one file, or meshes of their own."""
    q, curve, radius = _drawn(robot, rng)
    made = [bar, bolt, bracket, pipe, housing, washer]
    wanted, kept = int(rng.integers(*PIECES)), list[sn.Mesh]()
    for place in _places(curve, radius, MADE * wanted, rng):
        size = radius * rng.uniform(*PIECE)
        piece = made[int(rng.integers(len(made)))](size, radius * rng.uniform(*PIECE_LENGTH), rng)
        turn = sn.pose(rotation=rng.normal(size=4))[:3, :3]
        corners = (piece.vertices - piece.vertices.mean(axis=0)) @ turn.T + place
        mesh = solids.Surface(corners, piece.faces).mesh(f"piece {len(kept)}")
        reach = float(np.linalg.norm(corners - place, axis=1).max()) + LEEWAY * radius
        near = curve.points[np.linalg.norm(curve.points - place, axis=1) < reach]
        if not len(near) or float(measure(mesh, near).min()) > LEEWAY * radius:
            kept.append(mesh)
        if len(kept) == wanted:
            break
    if kept and rng.random() < 0.5:
        one = solids.joined([solids.Surface(mesh.vertices, mesh.faces) for mesh in kept])
        return sketch_of(robot, one.mesh("assembly").bodies(), q, rng)
    return sketch_of(robot, kept, q, rng)


def bar(size: float, length: float, _: Generator) -> solids.Surface:
    """Return a bar with round ends, of some radius and length."""
    return solids.tube(np.array([np.eye(4), sn.pose((0.0, 0.0, length))]), size, sides=8, caps=2)


def bolt(size: float, length: float, _: Generator) -> solids.Surface:
    """Return a bolt with a head of six sides."""
    circle, shank = solids.outlines_of(6)[0], 0.5 * length
    outlines = [(size, 0.0), (size, shank), (1.8 * size, shank), (1.8 * size, shank + size)]
    ends = [np.array([0.0, 0.0, height]) for height in (0.0, shank + size)]
    return solids.layered(np.eye(4), [(radius * circle, height) for radius, height in outlines], ends)


def bracket(size: float, length: float, rng: Generator) -> solids.Surface:
    """Return an angle of two flanges."""
    wide, flange, thick = 0.3 * length, size * rng.uniform(2.0, 6.0), PIECE_WALL * size
    outline = [(0.0, 0.0), (flange, 0.0), (flange, thick), (thick, thick), (thick, flange), (0.0, flange)]
    outlines = [(np.array(outline), height) for height in (0.0, wide)]
    return solids.layered(np.eye(4), outlines, [np.array([0.5 * thick, 0.5 * thick, height]) for height in (0.0, wide)])


def pipe(size: float, length: float, rng: Generator) -> solids.Surface:
    """Return a pipe with a bend, open at both ends."""
    bend = rng.uniform(0.2, 1.5)
    return solids.open_tube(arc(np.eye(4), np.array([bend, 0.0, length]), 7), size, (1.0 + PIECE_WALL) * size, sides=12)


def housing(size: float, _: float, rng: Generator) -> solids.Surface:
    """Return a block with a bore."""
    hole = size * rng.uniform(1.0, 4.0)
    return solids.blind_bore(np.eye(4), hole, 2.0 * hole, 1.4 * hole, 0.4 * hole, sides=16)


def washer(size: float, _: float, rng: Generator) -> solids.Surface:
    """Return a plate with a hole."""
    hole = size * rng.uniform(1.0, 6.0)
    return solids.plate(np.eye(4), 2.0 * hole, hole, PIECE_WALL * size, sides=16)


def _turn(rng: Generator) -> Floats:
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def _places(curve: Curve, radius: float, count: int, rng: Generator) -> Floats:
    """Places (m, 3) evenly spread within some distance of the shape."""
    low, high = curve.points.min(axis=0) - AROUND * radius, curve.points.max(axis=0) + AROUND * radius
    near, found = cKDTree(curve.points), np.zeros((0, 3))
    while len(found) < count:
        drawn = rng.uniform(low, high, (4 * count, 3))
        found = np.concatenate([found, drawn[near.query(drawn)[0] < AROUND * radius]])
    return found[:count]


def _crowd(
    robot: sn.Robot,
    rng: Generator,
    part: Callable[[Floats, float], list[Obstacle]],
    each: int,
    threaded: Callable[[Curve], list[Obstacle]] | None = None,
    drawn: tuple[Floats, Curve, float] | None = None,
) -> Sketch:
    """Draw parts, of up to `each` obstacles, and keep those that leave the shape alone, until there are enough."""
    q, curve, radius = _drawn(robot, rng) if drawn is None else drawn
    wanted, kept = int(rng.integers(*PARTS)), list[Obstacle]()
    tries = max(8, MADE * wanted // each)
    for i, place in enumerate(_places(curve, radius, tries, rng)):
        made = threaded(curve) if threaded is not None and 3 * i < tries else part(place, radius)
        if all(float(measure(own, curve.points).min()) > CROWD_LEEWAY * radius for own in made):
            kept += made
        if len(kept) >= wanted:
            break
    return sketch_of(robot, kept, q, rng)


LEAST_RADIUS, MOST_RADIUS = 1.5, 5.0
LEAST_GAP, MOST_GAP = 0.15, 10.0
"""Range of the clearance that a ball beside the hidden shape leaves; cubes of an even draw, so that most are close.

All four in radii of the body.
"""


def spheres(count: int, robot: sn.Robot, rng: Generator) -> Sketch:
    """Put `count` balls beside the hidden shape, each beside a place of its own."""
    radius = min(robot.radii)
    q = draw_shape(robot, 3.0 * radius, rng)
    curve = curve_of(robot, q, 20)
    found: list[sn.Sphere] = []
    while len(found) < count:
        ball = _beside(robot, curve, rng)
        if np.linalg.norm(curve.points - ball.center, axis=-1).min() >= ball.radius + (1.0 + LEAST_GAP) * radius:
            found.append(ball)
    return Sketch(robot, found, q)


def _beside(robot: sn.Robot, curve: Curve, rng: Generator) -> sn.Sphere:
    unit = min(robot.radii)
    size = unit * rng.uniform(LEAST_RADIUS, MOST_RADIUS)
    gap = unit * (LEAST_GAP + (MOST_GAP - LEAST_GAP) * rng.random() ** 3)
    place = curve.points[rng.integers(len(curve.points))]
    return sn.Sphere(place + (size + unit + gap) * direction(rng), size)


BLADE_GAP = (2.8, 3.6)
"""Distance of neighbouring blades, from middle to middle, at the tip."""

HEIGHT, WIDTH, HUB = (6.0, 12.0), (5.0, 9.0), (6.0, 12.0)
"""Of a blade, along the radius and along the axis; radius of the drum. All in radii of the body."""

DRUM_THICKNESS = 0.5
TWIST = (-0.25, 0.25)
"""By how much a blade turns about the radius from root to end, rad."""

DRUM_ROWS = (1, 3)
STEPS = 6
"""Pieces of a blade from root to end."""


def drum(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Stand the drum before the hidden tip, its axis in the plane that the tip bends in, and grow blades around it."""
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng)
    tip = curve_of(robot, q, 2).poses[-1]
    outwards = -tip[:3, 2]
    axis = tip[:3, :2] @ (q[-1, :2] / np.linalg.norm(q[-1, :2]))
    hub = radius * rng.uniform(*HUB)
    height, width = radius * rng.uniform(*HEIGHT), radius * rng.uniform(*WIDTH)
    above = radius * rng.uniform(1.2, 2.0)
    center = tip[:3, 3] - outwards * (hub + above)
    count = int(2.0 * math.pi * (hub + above) / (radius * rng.uniform(*BLADE_GAP)))
    twist = rng.uniform(*TWIST)
    # Rows lie on either side of the one with the target, and the target's is not always in the middle of it.
    middle = rng.uniform(-0.3, 0.3) * width
    rows, before = int(rng.integers(*DRUM_ROWS)), int(rng.integers(0, 2))
    frame = np.stack([outwards, np.cross(axis, outwards), axis], axis=-1)
    pitch = width + 1.5 * radius
    half = (abs(middle) + rows * pitch) * axis
    obstacles: list[Obstacle] = [sn.Cylinder(center - half, center + half, hub, name="drum")]
    for row in range(rows):
        lift = middle + (row - min(before, rows - 1)) * pitch
        first = 0.5 if row == min(before, rows - 1) else rng.random()
        blades = [
            _blade(2.0 * math.pi * (j + first) / count, hub, height, width, lift, DRUM_THICKNESS * radius, twist)
            for j in range(count)
        ]
        placed = solids.joined(blades)
        surface = solids.Surface(placed.vertices @ frame.T + center, placed.faces)
        obstacles.append(surface.mesh(f"blades {row + 1}"))
    return Sketch(robot, obstacles, q)


def _blade(
    angle: float, hub: float, height: float, width: float, lift: float, thickness: float, twist: float
) -> solids.Surface:
    """One blade about the z axis, with its root a little in the drum."""
    shares = np.linspace(0.0, 1.0, STEPS + 1)
    corners = 0.5 * np.array([[-thickness, -width], [thickness, -width], [thickness, width], [-thickness, width]])
    rings = []
    for share in shares:
        turned = corners @ about_z(twist * share)[:2, :2].T
        ring = np.stack([np.full(4, 0.98 * hub + share * height), turned[:, 0], lift + turned[:, 1]], axis=-1)
        rings.append(ring @ about_z(angle)[:3, :3].T)
    stacked = np.array(rings)
    return solids.loft(stacked, stacked[[0, -1]].mean(axis=1))


OPENING = (3.5, 6.0)
"""Width and height of a compartment inside."""

DEPTH, BOARD = (5.0, 10.0), 0.4
"""Of a compartment; thickness of boards. All in radii of the body."""

COLUMNS, SHELF_ROWS = (2, 5), (2, 5)


def shelf(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put the shelf around the hidden tip, open to where it comes from."""
    radius = min(robot.radii)
    q = draw_shape(robot, 4.0 * radius, rng)
    tip = curve_of(robot, q, 2).poses[-1]
    board = BOARD * radius
    sizes = np.array([*(radius * rng.uniform(*OPENING, 2)), radius * rng.uniform(*DEPTH)])
    counts = np.array([rng.integers(*COLUMNS), rng.integers(*SHELF_ROWS)])
    cell = rng.integers(0, counts)
    pitch = sizes[:2] + board
    # The tip: off the middle of its compartment, and near its back.
    off = rng.uniform(-0.5, 0.5, 2) * (sizes[:2] - 3.0 * radius)
    low = np.array([*(-(cell + 0.5) * pitch - off), radius * rng.uniform(1.3, 2.5) - sizes[2]])
    high = np.array([*(low[:2] + counts * pitch), low[2] + sizes[2]])
    half = 0.5 * board
    back = np.array([*(low[:2] - half), high[2]]), np.array([*(high[:2] + half), high[2] + board])
    boards = [solids.box_between(tip, *back, "back")]
    for axis, kind in enumerate(("side", "shelf")):
        for i in range(counts[axis] + 1):
            a, b = low.copy(), high.copy()
            a[1 - axis] -= half
            b[1 - axis] += half
            a[axis], b[axis] = low[axis] + i * pitch[axis] - half, low[axis] + i * pitch[axis] + half
            boards.append(solids.box_between(tip, a, b, f"{kind} {i + 1}"))
    return Sketch(robot, boards, q)
