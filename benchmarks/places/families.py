"""All families of places, what each is, and for which robots it is drawn.

Among them the scenes of balls that published codes were measured in (protocols P3 and P4), with targets from free
shapes; what a scanner, and what a triangulated model, makes of a place: points on all surfaces, or one mesh; and places
for robots of which it is a choice where they begin to bend: long insertion stages, and joints before the arm. What is
narrow is drawn about the bending part alone there, as for a robot without a stage or joints that begins there.
"""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.kinematics import link_poses, tip_poses
from benchmarks.places import cells, media, solids, tubes
from benchmarks.places.parts import SLENDER, arc, long_robot, robot_of, stout_robot, thin_robot, various_robot
from benchmarks.places.place import ROOM, Draw, Place, Sketch, Trap, settle, trapped
from benchmarks.problems import published_configurations, target_at
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint
from sinuous.model.robot import Robot
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display.surfaces import obstacle_surface

RADIUS = 0.01
"""Of the body; segments are 1 long, or 0.15 to 0.55."""

TOLERANCE = sn.Tolerance(0.7e-6, 0.7e-6)
"""Published codes were asked for an error of 1e-2 in se(3); ours is asked for 1e-6."""

SHORT = (0.15, 0.55)


def _icosahedron() -> list[tuple[float, ...]]:
    a, b = 0.5257, 0.8507
    signs = list(itertools.product((-1.0, 1.0), repeat=2))
    flat = [(0.0, s * a, t * b) for s, t in signs]
    return [vertex[-k:] + vertex[:-k] for vertex in flat for k in range(3)]


SCENES = (
    ([(0.8 * s * (i == 0), 0.8 * s * (i == 1), 0.8 * s * (i == 2)) for i in range(3) for s in (-1, 1)], 0.4),
    (list(itertools.product((-0.8, 0.8), repeat=3)), 0.4),
    (_icosahedron(), 0.4),
    (list(itertools.product((-0.8, 0.0, 0.8), (-0.4, 0.4, 1.2), (-0.8, 0.2, 1.2))), 0.2),
)
"""Centers and radius of the balls: corners of an octahedron, a cube and an icosahedron, and a lattice."""


@lru_cache
def _scene(number: int) -> sn.Scene:
    centers, radius = SCENES[number]
    return sn.Scene([sn.Sphere(center, radius) for center in centers])


@lru_cache
def _robot(count: int, short: bool) -> sn.Robot:
    return sn.Robot.uniform(count, SHORT if short else 1.0, math.pi, radius=RADIUS)


def fixed(seed: int) -> Place:
    """P3: three inextensible segments, position and rotation; scenes in turn."""
    return _draw("p3", seed, _robot(3, False), _scene(seed % 4), whole=True)


def extensible(seed: int, whole: bool) -> Place:
    """P4: three to six extensible segments, position and direction or (`whole`) rotation; scenes and robots in turn."""
    family = "p4 pose" if whole else "p4 direction"
    return _draw(family, seed, _robot(3 + seed // 4 % 4, True), _scene(seed % 4), whole)


def _draw(family: str, seed: int, robot: sn.Robot, scene: sn.Scene, whole: bool) -> Place:
    """Draw shapes until one is free."""
    rng = np.random.default_rng([seed, len(robot), int(whole)])
    while True:
        q = published_configurations(robot, 1, rng)[0]
        if least_clearance(robot, scene, q[None], 0.0)[0] > 0.0:
            break
    tip = tip_poses(robot, q[None])[0]
    target = target_at(tip, "rotation" if whole else "direction")
    return Place(family, seed, robot, scene, (target,), TOLERANCE, q)


THICKNESS = 0.15
"""Radius of a point."""

LATTICE, CELL = 0.25, 0.55
"""Points lie on triangles this close together; of those in one cubic cell, one is kept.

No place of a surface is then farther from a point than LATTICE / sqrt(3) + CELL * sqrt(3) + NOISE = 1.12, which is
less than body and point together, 1.15: the middle of the body cannot get through.
"""

AROUND, EDGE, WALL = 20, 6, 12
"""Facets of an obstacle around what is round, along the edge of a box, and along the wall of a cylinder or capsule."""

NOISE = 0.02
"""Most that a point is beside the surface. All in radii of the body."""


def scan(draw: Draw, seed: int, rng: Generator) -> Sketch | None:
    """Replace all obstacles of another family by one cloud."""
    sketch = draw(seed, rng)
    if sketch is None:
        return None
    radius = min(sketch.robot.radii)
    room = (ROOM + THICKNESS + NOISE) * radius
    if least_clearance(sketch.robot, sn.Scene(sketch.obstacles), sketch.q[None], room)[0] < room:
        return None
    points = np.concatenate([_on(triangles(obstacle), LATTICE * radius) for obstacle in sketch.obstacles])
    points = _thinned(points, CELL * radius)
    noise = rng.uniform(-1.0, 1.0, points.shape) * NOISE * radius / math.sqrt(3.0)
    return sketch._replace(obstacles=[sn.PointCloud(points + noise, THICKNESS * radius, name="scan")])


def triangles(obstacle: Obstacle) -> Floats:
    """Corners (f, 3, 3) of triangles that cover the surface of an obstacle, or nearly so where it is round."""
    pieces = EDGE if isinstance(obstacle, sn.Box) else WALL
    surface = obstacle_surface(obstacle, np.zeros(3), 0.0, AROUND, pieces)
    return surface.vertices[surface.triangles]


def _on(corners: Floats, spacing: float) -> Floats:
    """Points (m, 3) on triangles (f, 3, 3): a lattice on each, its neighbours no farther apart than `spacing`."""
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=-1).max(axis=1)
    pieces = np.ceil(longest / spacing).astype(int)
    found = []
    for count in np.unique(pieces):
        weights = _lattice(max(int(count), 1))
        found.append(np.einsum("wc,fcx->fwx", weights, corners[pieces == count]).reshape(-1, 3))
    return np.concatenate(found)


def _lattice(count: int) -> Floats:
    i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
    i, j = i[i + j <= count], j[i + j <= count]
    return np.stack([i, j, count - i - j], axis=-1) / count


def _thinned(points: Floats, cell: float) -> Floats:
    """Keep one point of every cubic cell."""
    numbers = np.floor(points / cell).astype(np.int64)
    return points[np.unique(numbers, axis=0, return_index=True)[1]]


GAP = 0.01
"""By how much each box is smaller on every side, in radii of the body: bodies of one mesh may not touch."""


def meshed(draw: Draw, seed: int, rng: Generator) -> Sketch | None:
    """Replace all boxes of another family by one mesh."""
    sketch = draw(seed, rng)
    if sketch is None:
        return None
    boxes = [o for o in sketch.obstacles if isinstance(o, sn.Box)]
    others = [o for o in sketch.obstacles if not isinstance(o, sn.Box)]
    return sketch._replace(obstacles=[one_mesh(boxes, sketch.robot), *others])


def one_mesh(boxes: list[sn.Box], robot: sn.Robot) -> sn.Mesh:
    """Return boxes as one mesh."""
    gap = GAP * min(robot.radii)
    return solids.joined([solids.cuboid(box.center, box.size - 2.0 * gap, box.rotation) for box in boxes]).mesh("walls")


COUNTS, MOST_BEND = (2, 3, 5, 8), 2.2
"""Numbers of bending segments, in turn, and the largest bend of each (rad)."""

LENGTH = (0.08, 0.25)
"""Range of the length of a segment, in m: on a stage, and on joints."""

STAGE, PUSHED = (3.0, 50.0), (0.15, 0.9)
"""Longest insertion of a stage, in lengths of a segment; and how far it is in, of that."""

PORT, BEHIND_PORT = (0.05, 0.3), (0.4, 0.7)
"""Where a shape goes through a wall, and into a tube behind it, of its length."""

DEEP, DEEP_WIDTH = (0.02, 0.4), (1.25, 1.8)
"""Where a deep tube begins, of the shape, and its inner radius, in radii of the body."""


def deep(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put the target deep into a bent tube, closed at the bottom or open."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    within = tubes.past(robot, q, curve.poses[round(rng.uniform(*DEEP) * (len(curve.poses) - 1)) :], rng)
    return Sketch(robot, [tubes.around_target(within, width * radius, radius, rng).mesh("tube")], q)


SLEEVE_BEGINS, SLEEVE_ENDS = (0.0, 0.15), (0.5, 0.95)
"""Where a sleeve begins and ends, of the shape."""


def sleeve(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put a tube that is open at both ends about most of the shape: shorter ways to the target lead past it."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    begin, end = (round(rng.uniform(*share) * (len(curve.poses) - 1)) for share in (SLEEVE_BEGINS, SLEEVE_ENDS))
    return Sketch(robot, [tubes.walled(curve.poses[begin : end + 1], width, radius, "sleeve")], q)


def port(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the target deep into a tube behind a wall with a port, larger than the robot is long."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    last = len(curve.poses) - 1
    door, begin = round(rng.uniform(*PORT) * last), round(rng.uniform(*BEHIND_PORT) * last)
    at = curve.poses[door]
    if cells.in_frame(at, curve.points[begin:])[:, 2].min() < 2.0 * width * radius:
        return None
    wall = solids.plate(at, 2.0 * float(q[:, 2].sum()), width * radius, radius)
    within = tubes.past(robot, q, curve.poses[begin:], rng)
    tube = tubes.around_target(within, width * radius, radius, rng)
    return Sketch(robot, [wall.mesh("wall"), tube.mesh("tube")], q)


TRAPS: tuple[Trap, ...] = (deep, sleeve, port, cells.door_in, tubes.funnel)
"""What is narrow, in turn."""


def staged(seed: int, rng: Generator) -> Sketch | None:
    """Draw a trap for segments behind a long stage."""
    segments = _segments(seed, rng)
    base = sn.pose(rng.normal(size=3), rotation=rng.normal(size=4))
    sketch = _trap(seed)(sn.Robot(segments, base=base), rng)
    if sketch is None:
        return None
    longest = rng.uniform(*STAGE) * segments[0].length[1]
    pushed = np.array([0.0, 0.0, rng.uniform(*PUSHED) * longest])
    stage = sn.Segment((0.0, longest), max_bend=0.0, radius=segments[0].radius)
    robot = sn.Robot([stage, *segments], base=arc(base, -pushed, 1)[-1])
    return Sketch(robot, sketch.obstacles, np.vstack([pushed, sketch.q]))


def carried(joints: Callable[[Generator], list[Joint]], seed: int, rng: Generator) -> Sketch | None:
    """Draw a trap for segments behind joints."""
    robot = sn.Robot(_segments(seed, rng), joints=joints(rng))
    low, high = np.array([joint.limits for joint in robot.joints if not isinstance(joint, Fixed)]).T
    values = rng.uniform(low, high)
    mount = link_poses(robot, values[None])[0, -1]
    sketch = _trap(seed)(sn.Robot(robot.segments, base=mount), rng)
    return None if sketch is None else Sketch(robot, sketch.obstacles, robot.with_joints(sketch.q, values))


def six_axes(rng: Generator) -> list[Joint]:
    """An elbow robot of six axes, of any size."""
    upper, lower = rng.uniform(0.3, 0.6, 2)
    above, beyond = [((0, 0, 0.12), (0, 0, length - 0.1), 0.06) for length in (upper, lower)]
    axes = (
        ((0, 0, 1), 0.2, 2.9, ()),
        ((0, 1, 0), 0.15, 1.9, [above]),
        ((0, 1, 0), upper, 2.6, ()),
        ((0, 0, 1), 0.0, 2.9, [beyond]),
        ((0, 1, 0), lower, 2.0, ()),
        ((0, 0, 1), 0.0, 2.9, [((0, 0, 0.0), (0, 0, 0.06), 0.04)]),
    )
    moving = [sn.Revolute(axis, (-most, most), (0, 0, up), body=body) for axis, up, most, body in axes]
    return [*moving, Fixed((0, 0, 0.1))]


def driven(rng: Generator) -> list[Joint]:
    """A base that drives and turns, the arm at its front or on top of it."""
    body = [((-0.2, 0.0, 0.12), (0.2, 0.0, 0.12), 0.12)]
    axes = [sn.Prismatic((1, 0, 0), (-2, 2)), sn.Prismatic((0, 1, 0), (-2, 2)), sn.Revolute(body=body)]
    return [*axes, Fixed(sn.pose((0.2, 0.0, 0.3), direction=(1, 0, 0) if rng.random() < 0.5 else (0, 0, 1)))]


def railed(rng: Generator) -> list[Joint]:
    """A carriage on a rail, on which the arm is rolled; it stands across the rail, more or less."""
    lean = rng.uniform(-0.5, 0.5)
    carriage = sn.Prismatic((1, 0, 0), (0.0, rng.uniform(0.5, 2.0)), body=[((0, 0, 0), (0, 0, -0.05), 0.05)])
    return [carriage, sn.Revolute(origin=sn.pose((0, 0, 0.02), direction=(math.sin(lean), 0, math.cos(lean))))]


def _trap(seed: int) -> Trap:
    return TRAPS[seed // len(COUNTS) % len(TRAPS)]


def _segments(seed: int, rng: Generator) -> list[sn.Segment]:
    unit = rng.uniform(*LENGTH)
    radius = unit * rng.uniform(*SLENDER)
    length = (0.8 * unit, 1.2 * unit) if rng.random() < 0.5 else unit
    return [sn.Segment(length, MOST_BEND, radius=radius)] * COUNTS[seed % len(COUNTS)]


@dataclass(frozen=True)
class Family:
    """Places of one kind.

    Attributes
    ----------
    make : callable
        From a seed to a place.
    words : str
        What it is.
    published : bool
        Whether it repeats what others were measured on.
    trap : bool
        Whether it is narrow where a search begins or ends.
    joints : bool
        Whether robots have joints before the arm: what compares clearances of segments alone leaves these out.
    judging : bool
        Whether it is kept from tuning: no constant of the strategy was chosen on it, no mechanism is written for it.
        Whoever looks into one of these to mend a failure moves it to the others and writes a new one.
    """

    make: Callable[[int], Place]
    words: str
    published: bool = False
    trap: bool = False
    judging: bool = False
    joints: bool = False


Traps = Mapping[str, tuple[Trap, str]]
"""What is drawn around a robot, and what it is, by name."""

_PLAIN: Traps = {
    **{f"spheres {n}": (partial(media.spheres, n), f"{n} balls beside the hidden shape") for n in (12, 40, 100)},
    **{
        f"pipe {w}": (partial(tubes.pipe, w), f"closed curved pipe of {w} times the body's radius, a mesh")
        for w in (2.2, 1.6, 1.3)
    },
    "plates": (cells.plates, "2 to 6 plates with holes of 1.5 times the body's radius, meshes"),
    "drum": (media.drum, "rows of blades on a drum, meshes; the target deep between two blades"),
    "shelf": (media.shelf, "a shelf of boxes; the target deep in a compartment"),
    "duct": (tubes.duct, "closed duct of 1.7 times the body's radius with 2 to 4 dead ends, a mesh"),
}
SCANNED = ("spheres 40", "pipe 1.6", "plates", "drum", "shelf", "duct")

_TRAPS: Traps = {
    **{
        f"open pipe {w}": (
            partial(tubes.open_pipe, w),
            f"base in a mouth of a pipe of {w} times the body's radius, a mesh",
        )
        for w in (2.2, 1.6, 1.3)
    },
    "pipe between": (partial(tubes.pipe_between, 1.6), "an open pipe between base and target, a mesh"),
    "guide tube": (tubes.guide_tube, "base in a straight tube that hardly leaves room, a mesh"),
    "channel": (partial(tubes.open_channel, 1.5), "base in a straight channel of boxes"),
    "bore": (partial(tubes.bore, False), "target in a blind bore, the base outside, a mesh"),
    "square bore": (partial(tubes.bore, True), "target in a blind square bore, the base outside, boxes"),
    "door out": (cells.door_out, "base in a cell with one door, the target outside, boxes"),
    "door in": (cells.door_in, "target in a cell with one door, the base outside, boxes"),
    "door beside": (cells.door_beside, "base in a cell whose door is beside or behind it, boxes"),
    "two doors": (cells.two_doors, "two cells, and between them a door and one that is too narrow, boxes"),
    "cells": (partial(tubes.between_cells, True), "from cell to cell through a straight channel, boxes"),
    "cells pipe": (partial(tubes.between_cells, False), "from cell to cell through a bent pipe, boxes and a mesh"),
    "two tubes": (tubes.two_tubes, "base in one pipe, target in another, the open between them, meshes"),
    "funnel": (tubes.funnel, "target in a bent pipe whose mouth widens, the base outside, a mesh"),
    "branches": (tubes.branches, "base in a mouth of a pipe with a dead end on its way, a mesh"),
    "box duct": (tubes.box_duct, "a flat duct of rectangular section, from the base or beyond it, boxes"),
    "rods": (media.rods, "hundreds of rods thrown about, capsules"),
    "sheets": (media.sheets, "hundreds of thin sheets, boxes"),
    "disks": (media.disks, "a body that bends in one plane among hundreds of disks and bars there, balls and capsules"),
    "hoops": (media.hoops, "hoops, some of which the shape is threaded through, hundreds of capsules"),
    "cables": (media.cables, "trays of curved cables, hundreds of capsules"),
    "profiles": (media.profiles, "a frame of hundreds of profiles, boxes and cylinders"),
    "assembly": (media.assembly, "hundreds of pieces of a machine, in one mesh or a mesh each"),
}
_LONG: Traps = {"folded": (cells.folded, "20 segments folded in a cell before its door, boxes")}
_JUDGING: Traps = {
    "helix": (tubes.helix, "a helical pipe, open at both ends, the base before its mouth or in it, a mesh"),
    "bronchi": (tubes.bronchi, "a tree of tapering tubes, the base in its mouth, the target in a leaf, a mesh"),
    "stenosis": (tubes.stenosis, "a pipe with throats, the base before its mouth or in it, a mesh"),
    "lattice": (media.lattice, "struts along three axes, capsules"),
    "rubble": (media.rubble, "a heap of boxes and convex stones, meshes"),
    "bundle": (media.bundle, "parallel tubes as in a heat exchanger, cylinders"),
    "gyroid": (media.gyroid, "a porous solid with a tunnel, a mesh"),
    "slab": (media.slab, "two plates and pillars between them, half-spaces and cylinders"),
    "keyholes": (cells.keyholes, "thick walls with keyholes, meshes"),
    "nested": (cells.nested, "a cell within a cell, a door each, boxes"),
}
SCANNED_TRAPS = (
    *("open pipe 1.6", "pipe between", "guide tube", "channel", "bore"),
    *("door out", "door in", "door beside", "two doors", "cells", "cells pipe"),
)
MESHED = ("square bore", "door out", "door in", "door beside", "two doors", "cells", "folded")


def _for(robots: Callable[[int, Generator], Robot], traps: Traps) -> dict[str, tuple[Draw, str]]:
    """Traps as they are drawn for these robots."""
    return {name: (partial(trapped, trap, robots), words) for name, (trap, words) in traps.items()}


def _scans(drawn: Mapping[str, tuple[Draw, str]]) -> dict[str, tuple[Draw, str]]:
    return {f"{name} scan": (partial(scan, draw), f"a scan of {name}, a cloud") for name, (draw, _) in drawn.items()}


def _families() -> dict[str, Family]:
    """Places as they are drawn, as meshes, and as scans, each for its robots."""
    drawn = _for(robot_of, _PLAIN)
    drawn |= _scans({name: drawn[name] for name in SCANNED})
    hall = {"hall": (cells.hall, "base in a hall of 1000 radii with one door, boxes")}
    traps = _for(various_robot, _TRAPS) | _for(long_robot, _LONG) | _for(thin_robot, hall)
    traps |= {f"{name} mesh": (partial(meshed, traps[name][0]), f"a mesh of {name}") for name in MESHED}
    traps |= _scans(_for(stout_robot, {name: _TRAPS[name] for name in SCANNED_TRAPS}))
    traps |= _scans(_for(partial(long_robot, stout=True), _LONG))
    small = "any robot and shape, a door that it goes through, and boxes, quickly made"
    traps |= _for(cells.any_robot, {"small world": (cells.small_world, small)}) | _for(various_robot, _JUDGING)
    traps["stage"] = staged, "on a stage of 3 to 50 segments' lengths, what is narrow about the target, or between"
    on_joints = {
        "six axes": (six_axes, "on an elbow robot of six axes, the same"),
        "driven base": (driven, "on a base that drives and turns, the same"),
        "rail": (railed, "on a rail, and rolled, the same"),
    }
    traps |= {name: (partial(carried, joints), words) for name, (joints, words) in on_joints.items()}
    families = {
        # The name is part of what the draws begin with.
        name: Family(partial(settle, name, draw=draw), words, False, name in traps, name in _JUDGING, name in on_joints)
        for name, (draw, words) in (drawn | traps).items()
    }
    extended = "four scenes of balls, 3 to 6 extensible segments"
    published: dict[str, tuple[Callable[[int], Place], str]] = {
        "p3": (fixed, "four scenes of balls, 3 inextensible segments, position and rotation"),
        "p4 direction": (partial(extensible, whole=False), f"{extended}, position and direction"),
        "p4 pose": (partial(extensible, whole=True), f"{extended}, position and rotation"),
    }
    return families | {name: Family(made, words, published=True) for name, (made, words) in published.items()}


FAMILIES = _families()
"""By their names, in the order of the benchmark."""
