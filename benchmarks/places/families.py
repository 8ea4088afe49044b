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

Range = tuple[float, float]

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


PUBLISHED: dict[str, tuple[tuple[int, ...], Range | float, str]] = {
    "p3": ((3,), 1.0, "rotation"),
    "p4 direction": ((3, 4, 5, 6), SHORT, "direction"),
    "p4 pose": ((3, 4, 5, 6), SHORT, "rotation"),
}
"""Numbers of segments, in turn, their length, and what is asked for beside the position, by protocol."""


@lru_cache
def _robot(count: int, length: Range | float) -> sn.Robot:
    return sn.Robot.uniform(count, length, math.pi, radius=RADIUS)


def published(family: str, seed: int) -> Place:
    """Draw a free shape among balls, as published: 3 inextensible segments, or 3 to 6 extensible ones."""
    counts, length, asked = PUBLISHED[family]
    robot, scene = _robot(counts[seed // 4 % len(counts)], length), _scene(seed % 4)
    rng = np.random.default_rng([seed, len(robot), int(asked == "rotation")])
    while True:
        q = published_configurations(robot, 1, rng)[0]
        if least_clearance(robot, scene, q[None], 0.0)[0] > 0.0:
            break
    target = target_at(tip_poses(robot, q[None])[0], asked)
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
    within = tubes.past(robot, q, curve.poses[curve.draw(DEEP, rng) :], rng)
    return Sketch(robot, [tubes.around_target(within, width * radius, radius, rng).mesh("tube")], q)


SLEEVE_BEGINS, SLEEVE_ENDS = (0.0, 0.15), (0.5, 0.95)
"""Where a sleeve begins and ends, of the shape."""


def sleeve(robot: sn.Robot, rng: Generator) -> Sketch:
    """Put a tube that is open at both ends about most of the shape: shorter ways to the target lead past it."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    begin, end = curve.draw(SLEEVE_BEGINS, rng), curve.draw(SLEEVE_ENDS, rng)
    return Sketch(robot, [tubes.walled(curve.poses[begin : end + 1], width, radius, "sleeve")], q)


def port(robot: sn.Robot, rng: Generator) -> Sketch | None:
    """Put the target deep into a tube behind a wall with a port, larger than the robot is long."""
    radius, width = max(robot.radii), rng.uniform(*DEEP_WIDTH)
    q, curve = tubes.tube_shape(robot, width, rng)
    at, begin = curve.poses[curve.draw(PORT, rng)], curve.draw(BEHIND_PORT, rng)
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


def _named(*traps: Trap) -> dict[str, Trap]:
    """Traps by the names of their functions."""
    return {trap.__name__.replace("_", " "): trap for trap in traps}


WIDTHS = (2.2, 1.6, 1.3)
"""Inner radii of pipes, in radii of the body."""

_PLAIN: dict[str, Trap] = {
    **{f"spheres {count}": partial(media.spheres, count) for count in (12, 40, 100)},
    **{f"pipe {width}": partial(tubes.pipe, width) for width in WIDTHS},
    **_named(cells.plates, media.drum, media.shelf, tubes.duct),
}
SCANNED = ("spheres 40", "pipe 1.6", "plates", "drum", "shelf", "duct")

_TRAPS: dict[str, Trap] = {
    **{f"open pipe {width}": partial(tubes.open_pipe, width) for width in WIDTHS},
    **_named(tubes.pipe_between, tubes.guide_tube),
    "channel": tubes.open_channel,
    "bore": partial(tubes.bore, False),
    "square bore": partial(tubes.bore, True),
    **_named(cells.door_out, cells.door_in, cells.door_beside, cells.two_doors),
    "cells": partial(tubes.between_cells, True),
    "cells pipe": partial(tubes.between_cells, False),
    **_named(tubes.two_tubes, tubes.funnel, tubes.branches, tubes.box_duct, media.rods, media.sheets, media.disks),
    **_named(media.hoops, media.cables, media.profiles, media.assembly),
}
_LONG = _named(cells.folded)
_JUDGING = _named(
    *(tubes.helix, tubes.bronchi, tubes.stenosis, media.lattice, media.rubble),
    *(media.bundle, media.gyroid, media.slab, cells.keyholes, cells.nested),
)
SCANNED_TRAPS = (
    *("open pipe 1.6", "pipe between", "guide tube", "channel", "bore"),
    *("door out", "door in", "door beside", "two doors", "cells", "cells pipe"),
)
MESHED = ("square bore", "door out", "door in", "door beside", "two doors", "cells", "folded")


def _for(robots: Callable[[int, Generator], Robot], traps: Mapping[str, Trap]) -> dict[str, Draw]:
    """Traps as they are drawn for these robots."""
    return {name: partial(trapped, trap, robots) for name, trap in traps.items()}


def _scans(drawn: Mapping[str, Draw]) -> dict[str, Draw]:
    return {f"{name} scan": partial(scan, draw) for name, draw in drawn.items()}


def _words(drawn: Callable[..., object]) -> str:
    """What is drawn, as the docstring of the function says, or that of the trap."""
    while isinstance(drawn, partial):
        drawn = drawn.args[0] if drawn.func is trapped else drawn.func
    return (drawn.__doc__ or "").partition("\n")[0]


def _families() -> dict[str, Family]:
    """Places as they are drawn, as meshes, and as scans, each for its robots."""
    drawn = _for(robot_of, _PLAIN)
    drawn |= _scans({name: drawn[name] for name in SCANNED})
    traps = _for(various_robot, _TRAPS) | _for(long_robot, _LONG) | _for(thin_robot, _named(cells.hall))
    traps |= {f"{name} mesh": partial(meshed, traps[name]) for name in MESHED}
    traps |= _scans(_for(stout_robot, {name: _TRAPS[name] for name in SCANNED_TRAPS}))
    traps |= _scans(_for(partial(long_robot, stout=True), _LONG))
    traps |= _for(cells.any_robot, _named(cells.small_world)) | _for(various_robot, _JUDGING)
    on_joints: dict[str, Draw] = {
        name: partial(carried, joints)
        for name, joints in (("six axes", six_axes), ("driven base", driven), ("rail", railed))
    }
    traps |= {"stage": staged} | on_joints
    families = {
        # The name is part of what the draws begin with.
        name: Family(
            partial(settle, name, draw=draw), _words(draw), False, name in traps, name in _JUDGING, name in on_joints
        )
        for name, draw in (drawn | traps).items()
    }
    made = {name: partial(published, name) for name in PUBLISHED}
    return families | {name: Family(draw, _words(draw), published=True) for name, draw in made.items()}


FAMILIES = _families()
"""By their names, in the order of the benchmark."""
