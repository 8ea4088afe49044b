"""A wild world: one robot in one scene, and problems that each have a hidden solution there.

Robots are of all sorts: fixed and extensible segments, insertion stages, rigid links, tendons, chambers, joints, any
scale. Obstacles are of every kind about given bodies: some just beside them, some anywhere, now and then a room around
all.

Besides worlds of anything there are kinds that an audit of the proofs asked for: each strains one argument. Judges
share no code with the solver. Obstacles with huge coordinates are judged in extended precision. The shape of a robot
under load is its equilibrium, looked for anew; that this is at rest is held against Cosserat rods elsewhere
(`benchmarks.real`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.judges import kinematics
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.self_collision import Flags, look, surely_clear
from benchmarks.places import solids
from benchmarks.problems import ProblemSet, in_ball, random_configurations, target_at
from sinuous.base.checks import Floats
from sinuous.measures.obstacles import measure
from sinuous.model.joints import Fixed, Joint, Prismatic, Revolute
from sinuous.model.poses import least_rotation
from sinuous.scene.obstacles import Obstacle
from sinuous.statics.rest import bodies_at

SIZES = ((1, 4), (4, 9), (9, 17), (17, 41))
"""Ranges of the number of segments, each without its end."""

SIZE_SHARES = (0.4, 0.4, 0.13, 0.07)

UNITS = (-9.0, 9.0)
"""Powers of ten between which a segment is long."""

TIGHTEST = 0.98
"""Largest curvature of a hidden shape, of one over its radius: a body that avoids itself bends no tighter than that."""

JOINTED_SCALES, MOST_JOINTS, MOST_SEGMENTS = (-4.0, 3.0), 8, 6
"""The same of arms with joints; and how many joints, and segments, these have at most."""

SHAPE_DRAWS = 16
"""Times that shapes are drawn, more and more gently bent, until they are clear of themselves."""


def robot_with_shapes(count: int, rng: Generator, scales: tuple[float, float] = UNITS) -> tuple[sn.Robot, Floats]:
    """Draw a robot, and up to `count` configurations (m, n, 3) within its limits that are clear of themselves.

    `scales` are the powers of ten between which a segment is long.
    """
    size = int(rng.integers(*SIZES[rng.choice(len(SIZES), p=SIZE_SHARES)]))
    unit = 10.0 ** rng.uniform(*scales)
    segments = draw_segments(size, unit, rng)
    place: dict[str, Any] = {
        "mount": rng.uniform(0.0, 0.8) * unit if rng.random() < 0.15 else 0.0,
        "base": sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)) if rng.random() < 0.7 else None,
        "tool": sn.pose(0.5 * unit * in_ball(rng), rotation=rng.normal(size=4)) if rng.random() < 0.15 else None,
    }
    robot = sn.Robot(segments, **place)
    q = shapes_of(robot, count, rng)
    if len(q) and rng.random() < 0.15:
        robot = sn.Robot(_driven(segments, q, unit, rng), **place)
    return robot, q


def draw_segments(size: int, unit: float, rng: Generator) -> list[sn.Segment]:
    """Draw segments all alike, or each of its own sort; at least one can bend."""
    thin = rng.random() < 0.1
    radius = 0.0 if thin else unit * 10.0 ** rng.uniform(-3.0, -0.6)
    widest = rng.choice([math.pi, rng.uniform(0.4, math.pi), rng.uniform(math.pi, 6.0)], p=[0.15, 0.35, 0.5])
    tapered = not thin and rng.random() < 0.2
    alike = rng.random() < 0.5
    first = _bending(unit, widest, radius, rng)
    drawn = [first if alike else _any(unit, widest, radius, rng) for _ in range(size - 1)] + [first]
    if size > 1 and rng.random() < 0.15:
        drawn[0] = sn.Segment((0.0, unit * rng.uniform(0.5, 3.0)), 0.0, None, radius)  # an insertion stage
    if not tapered:
        return drawn
    return [each.changed(radius=each.radius * rng.uniform(0.5, 1.0)) for each in drawn]


def _any(unit: float, widest: float, radius: float, rng: Generator) -> sn.Segment:
    """Draw a segment that bends, a rigid link, or a straight one that stretches."""
    own = unit * rng.uniform(0.5, 1.5)
    kind = rng.choice(["bending", "rigid", "straight"], p=[0.82, 0.12, 0.06])
    if kind == "rigid":
        return sn.Segment((own, own), 0.0, None, radius)
    if kind == "straight":
        return sn.Segment((0.3 * own, own), 0.0, None, radius)
    return _bending(own, widest * rng.uniform(0.5, 1.0), radius, rng)


def _bending(own: float, max_bend: float, radius: float, rng: Generator) -> sn.Segment:
    low = own * rng.choice([1.0, rng.uniform(0.5, 0.95), 0.0], p=[0.5, 0.42, 0.08])
    curvature = rng.uniform(1.0, 6.0) / own if rng.random() < 0.25 else None
    return sn.Segment((low, own), max_bend, curvature, radius)


def shapes_of(robot: sn.Robot, count: int, rng: Generator) -> Floats:
    """Return shapes that are surely clear of themselves; those that fail are drawn anew, each time more gently bent."""
    found = np.empty((0, len(robot), 3))
    most = 1.0
    for _ in range(SHAPE_DRAWS):
        drawn = draw_shapes(robot, count - len(found), most, rng)
        found = np.concatenate([found, drawn[surely_clear(robot, drawn)]])
        if len(found) == count:
            break
        most *= 0.85
    return found


def draw_shapes(robot: sn.Robot, count: int, most: float, rng: Generator) -> Floats:
    """Draw shapes that use `most` of the bends they may have; a few segments are at the limit of their length."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    size = count, len(robot)
    share = rng.random(size)
    share = np.where(rng.random(size) < 0.05, np.round(share), share)
    lengths = low + (high - low) * share
    radii = np.array(robot.radii)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(radii > 0.0, TIGHTEST * lengths / radii, math.inf)
    norms = most * np.minimum(kinematics.bend_caps(robot, lengths), own) * np.sqrt(rng.random(size))
    angles = 2.0 * math.pi * rng.random(size)
    return np.stack([norms * np.cos(angles), norms * np.sin(angles), lengths], axis=-1)


def _driven(segments: list[sn.Segment], q: Floats, unit: float, rng: Generator) -> list[sn.Segment]:
    """Give some segments tendons, or some chambers, with limits that the shapes (m, n, 3) just keep.

    The others get tendons without limits: what no actuator bends would be locked.
    """
    by_tendons = rng.random() < 0.6
    driven = []
    for k, segment in enumerate(segments):
        driven.append(segment.changed(tendons=sn.Tendons(3, 0.1 * unit)) if segment.max_bend > 0.0 else segment)
        if segment.max_bend == 0.0 or rng.random() < 0.4:
            continue
        arm, first, slack = unit * rng.uniform(0.02, 0.2), rng.uniform(0.0, math.pi), rng.uniform(1.0001, 1.5)
        angles = first + 2.0 * math.pi * np.arange(3) / 3.0
        arms = arm * np.stack([np.cos(angles), np.sin(angles)])
        if by_tendons:
            pulled = q[:, : k + 1, :2].sum(axis=1) @ arms
            limits = min(0.0, slack * pulled.min()), max(0.0, slack * pulled.max())
            driven[k] = segment.changed(tendons=sn.Tendons(3, arm, first, displacement=limits))
            continue
        lengths = q[:, k, 2:] - q[:, k, :2] @ arms
        middle, extent = 0.5 * (lengths.min() + lengths.max()), slack * 0.5 * (lengths.max() - lengths.min())
        if lengths.min() >= 0.0:
            limits = max(0.0, middle - extent), middle + extent
            driven[k] = segment.changed(chambers=sn.Chambers(3, arm, first, length=limits))
    return driven


def jointed_robot(rng: Generator) -> sn.Robot:
    """Draw an arm with joints before its segments, or with joints alone, and bodies of links."""
    unit = 10.0 ** rng.uniform(*JOINTED_SCALES)
    joints: list[Joint] = []
    for i in range(int(rng.integers(1, MOST_JOINTS + 1))):
        axis = rng.normal(size=3) if rng.random() < 0.5 else np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
        place = unit * in_ball(rng) if rng.random() < 0.7 else np.zeros(3)
        origin = sn.pose(place, rotation=rng.normal(size=4)) if rng.random() < 0.6 else sn.pose(place)
        body = [_capsule(unit, rng) for _ in range(int(rng.choice([0, 1, 2], p=[0.5, 0.4, 0.1])))]
        kind = rng.choice(["revolute", "prismatic", "fixed"], p=[0.65, 0.2, 0.15]) if i else "revolute"
        touches = [str(rng.choice(["base", *(f"j{k}" for k in range(1, i + 1))]))] if rng.random() < 0.15 else []
        low = rng.uniform(-math.pi, 0.5)
        if kind == "fixed":
            joints.append(Fixed(origin, body=body))
        elif kind == "revolute":
            limits = None if rng.random() < 0.3 else (low, low + rng.uniform(0.1, 4.0))
            joints.append(Revolute(axis, limits, origin, body=body, touches=touches))
        else:
            limits = 0.4 * unit * low, 0.4 * unit * low + unit * rng.uniform(0.1, 2.0)
            joints.append(Prismatic(axis, limits, origin, body=body, touches=touches))
    size = int(rng.integers(0, MOST_SEGMENTS + 1))
    segments = draw_segments(size, unit, rng) if size else []
    return sn.Robot(
        segments,
        joints=joints,
        base=sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)) if rng.random() < 0.7 else None,
        tool=sn.pose(0.5 * unit * in_ball(rng), rotation=rng.normal(size=4)) if rng.random() < 0.3 else None,
    )


def _capsule(unit: float, rng: Generator) -> tuple[Floats, Floats, float]:
    start = 0.1 * unit * in_ball(rng)
    return start, start + unit * rng.uniform(0.0, 0.8) * in_ball(rng), unit * 10.0 ** rng.uniform(-2.5, -0.8)


def draw_jointed(robot: sn.Robot, count: int, most: float, rng: Generator) -> Floats:
    """Draw configurations (m, rows, 3) of an arm with joints, whose segments use `most` of the bends they may have."""
    low, high = np.array([joint.limits for joint in kinematics.moving(robot.joints)]).T
    arm = kinematics.arm_of(robot)
    values = low + (high - low) * rng.random((count, len(low)))
    return robot.with_joints(np.zeros((count, 0, 3)) if arm is None else draw_shapes(arm, count, most, rng), values)


def jointed_shapes(robot: sn.Robot, count: int, clear: float, rng: Generator) -> Floats:
    """Draw up to `count` configurations (m, rows, 3) of an arm with joints that are so far from themselves."""
    drawn = draw_jointed(robot, 4 * count, rng.uniform(0.3, 1.0), rng)
    drawn = drawn[look(robot, drawn, 0.0).least > 0.0][:count]
    return np.asarray(drawn[look(robot, drawn, clear).least > clear])


COUNTS = ((0, 1), (1, 8), (8, 61))
"""Ranges of the number of obstacles, each without its end."""

COUNT_SHARES = (0.15, 0.4, 0.45)

OBSTACLE_KINDS = {"sphere": 0.34, "box": 0.25, "capsule": 0.17, "cylinder": 0.18, "half_space": 0.06}

SOLIDS = ((0.02, 0.7), (0.02, 0.3), (0.02, 0.3))
"""Range of their length and of their two thicknesses, in lengths of a segment."""

RICH = 0.02
"""Share of scenes with a mesh, and of those with a cloud: preparing them takes longer than all the rest."""

SAMPLES = 12
"""Intervals of a segment at whose ends obstacles are kept off the bodies while a scene is drawn."""


def scene_about(robot: sn.Robot, q: Floats, rng: Generator) -> sn.Scene:
    """Draw a scene in which the bodies of configurations (m, n, 3) are clear, as far as samples of them say."""
    (points, radii), unit = _bodies(robot, q), robot.mean_length
    low, high = COUNTS[rng.choice(len(COUNTS), p=COUNT_SHARES)]
    count = int(rng.integers(low, high))
    drawn: list[Obstacle] = []
    if count and rng.random() < 0.2:
        drawn.append(_room(points, radii, unit, rng))
    kinds = rng.choice(list(OBSTACLE_KINDS), p=list(OBSTACLE_KINDS.values()), size=max(0, count - len(drawn)))
    drawn += [_solid(str(kind), *_place(points, radii, unit, rng), unit, rng) for kind in kinds]
    if count and rng.random() < RICH:
        drawn.append(_solid("mesh", *_place(points, radii, unit, rng), unit, rng))
    if count and rng.random() < RICH:
        cloud = points.mean(axis=0) + unit * np.array([in_ball(rng) for _ in range(100)])
        drawn.append(sn.PointCloud(_clear_of(points, radii, cloud, 0.02 * unit), 0.01 * unit))
    return sn.Scene([obstacle for obstacle in drawn if (measure(obstacle, points) > radii).all()])


def _bodies(robot: sn.Robot, q: Floats) -> tuple[Floats, Floats]:
    """Points (k, 3) of all backbones beyond the mount, and of links, and the radius (k,) of the body at each."""
    if robot.joints:
        bodies = kinematics.body_places(robot, q, SAMPLES) or [(0, robot.base[None, None, :3, 3], 0.0)]
        radii = [np.full(points[..., 0].size, radius) for _, points, radius in bodies]
        return np.concatenate([points.reshape(-1, 3) for _, points, _ in bodies]), np.concatenate(radii)
    points, along = kinematics.body_points(robot, q, SAMPLES)
    exposed = along >= robot.mount
    if not exposed.any():
        exposed[..., -1, -1] = True
    return points[exposed], np.broadcast_to(np.array(robot.radii)[:, None], along.shape)[exposed]


def _clear_of(points: Floats, radii: Floats, centers: Floats, room: float) -> Floats:
    """Those of the centers, or a far one, that leave the bodies some room."""
    gaps = np.linalg.norm(centers[:, None] - points, axis=-1) - radii
    kept = centers[gaps.min(axis=1) > room]
    return np.asarray(kept if len(kept) else points[:1] + 1e3 * (room + np.abs(points - points[0]).max()))


def _place(points: Floats, radii: Floats, unit: float, rng: Generator) -> tuple[Floats, Floats, float]:
    """Draw a place, the direction away from the body, and how far off the backbone an obstacle there has to begin."""
    i = rng.integers(len(points))
    away = in_ball(rng)
    away /= np.linalg.norm(away)
    gap = unit * (10.0 ** rng.uniform(-4.0, -1.0) if rng.random() < 0.5 else rng.uniform(0.0, 0.8))
    return points[i], away, float(radii[i]) + gap


def _solid(kind: str, at: Floats, away: Floats, off: float, unit: float, rng: Generator) -> Obstacle:
    """Draw an obstacle that begins `off` from a place."""
    size, turn = unit * rng.uniform(*np.transpose(SOLIDS)), least_rotation(away) @ _turn(rng)
    return solids.beside(kind, at, away, off, size, turn, rng.uniform(-1.0, 1.0, 3))


def _turn(rng: Generator) -> Floats:
    """Draw a rotation; every other one about z alone, which leaves long obstacles across."""
    return pose_rotation(rng.normal(size=4) * ([1.0, 0.0, 0.0, 1.0] if rng.random() < 0.5 else 1.0))


def pose_rotation(quaternion: Floats) -> Floats:
    """Rotation (3, 3) of a quaternion of any norm."""
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


def _room(points: Floats, radii: Floats, unit: float, rng: Generator) -> Obstacle:
    """Draw a room that holds all bodies: a box, a ball, a cylinder, or a box of triangles."""
    rotation = pose_rotation(rng.normal(size=4))
    local = points @ rotation
    low, high = (local - radii[:, None]).min(axis=0), (local + radii[:, None]).max(axis=0)
    room = unit * 10.0 ** rng.uniform(-3.0, 0.0, 3)
    middle, half = rotation @ (0.5 * (low + high)), 0.5 * (high - low) + room
    kind = rng.choice(["box", "ball", "cylinder", "mesh"], p=[0.5, 0.23, 0.23, 0.04])
    if kind == "box":
        return sn.Box(middle, 2.0 * half, rotation, inside=True)
    if kind == "ball":
        return sn.Sphere(middle, float((np.linalg.norm(points - middle, axis=1) + radii).max() + room[0]), inside=True)
    if kind == "cylinder":
        across = local[:, :2] - (rotation.T @ middle)[:2]
        radius = float((np.linalg.norm(across, axis=1) + radii).max() + room[0])
        return sn.Cylinder(middle - half[2] * rotation[:, 2], middle + half[2] * rotation[:, 2], radius, inside=True)
    return sn.Mesh(*solids.cuboid(middle, 2.0 * half, rotation), inside=True)


LIMIT = 1.0
"""Budget of one solve, in seconds, where a kind has none of its own."""

SHAPES = 48
"""Hidden solutions of one world, at most, one a problem."""

CLEAR = 1e-6
"""Least clearance of a hidden solution, of the robot's mean length."""

TOLERANCES = (-8.0, -2.0)
"""Powers of ten between which tolerances lie: of the robot's mean length, and rad."""

KINDS = {"position": 0.2, "direction": 0.3, "rotation": 0.4, "direction alone": 0.05, "rotation alone": 0.05}
"""What is asked of the tip, and how often."""

INTERMEDIATE = 0.15
"""Share of worlds that ask for the place of another segment's end as well."""


HUGE, GAPS = (3.0, 12.0), (-12.0, -2.0)
"""Powers of ten of the size of huge obstacles, and of their gap to a body; both in lengths of a segment."""

BALLS = 6
"""Most obstacles that stand about a mount."""

CELLS = 24
"""Cells of a field or a grid along its longest edge."""

SHORT = 0.05
"""Budget of one solve, in seconds, of kinds whose problems are often impossible: what counts there are claims."""


class Sort(NamedTuple):
    """Ranges of length, largest bend (rad) and radius of a sort of segment, lengths in units; and if it stretches."""

    length: tuple[float, float]
    bend: tuple[float, float]
    radius: tuple[float, float]
    stretches: bool = False


UNEVEN = (
    Sort((0.03, 0.2), (0.5, 2.5), (0.002, 0.02)),  # turns at once
    Sort((0.2, 1.0), (0.0, 0.0), (0.002, 0.02)),  # a rigid link
    Sort((0.2, 1.2), (0.5, 3.0), (0.002, 0.02), stretches=True),
)
PLAIN = (Sort((0.5, 1.5), (0.5, 3.0), (0.01, 0.1), stretches=True),)
OF_ALL_RADII = (
    Sort((0.5, 1.5), (0.5, 3.0), (0.05, 0.15)),
    Sort((0.3, 1.5), (1.0, 6.0), (0.003, 0.03)),
    Sort((1e-3, 0.05), (1.0, 3.1), (0.0, 0.0)),  # a hinge
)

DRAWS = 30
"""Draws of a scene before another robot is drawn."""

LOADED, LOADED_BUDGET = (-2.0, 0.3), 0.2
"""Powers of ten of weight times the square of the length, of the stiffness EI; and seconds of a solve under load."""

JOINTED, JOINTED_BUDGET = 12, 0.3
"""Hidden solutions of one world of arms with joints, at most; and seconds of a solve of these, and of a plan."""


@dataclass(frozen=True)
class World:
    """Problems in one scene.

    Attributes
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    targets : list of list of Target
        One list a problem: its targets are to be met at once.
    hidden : ndarray (m, n, 3)
        A solution of each, clear of obstacles and of itself.
    possible : bool
        Whether that is so: else the hidden shapes overlap something, and it is not known whether there is a solution.
    truth : Scene or None
        The obstacles that judges look at, where `scene` knows bounds of their distances only.
    time : float
        Budget of one solve, in seconds.
    loaded : bool
        Whether gravity bends the robot: its body is then the one at rest.
    """

    robot: sn.Robot
    scene: sn.Scene
    tolerance: sn.Tolerance
    targets: list[list[sn.Target]]
    hidden: Floats
    possible: bool = True
    truth: sn.Scene | None = None
    time: float = LIMIT
    loaded: bool = False


class Judged(NamedTuple):
    """What came of one motion, or call: whether it is called proved, or ended in an answer; and what is false of it."""

    good: bool
    false: str


def make(seed: int, number: int) -> World:
    """Make world `number` of a seed."""
    rng = np.random.default_rng([seed, 9, number])
    return _about(lambda: robot_with_shapes(SHAPES, rng), rng)


def asked(robot: sn.Robot, q: Floats, rng: Generator, kind: str | None = None) -> list[list[sn.Target]]:
    """Return targets for every shape, all of one of the `KINDS`: by default any."""
    kind = str(rng.choice(list(KINDS), p=list(KINDS.values()))) if kind is None else kind
    several = len(robot.segments) > 1 and rng.random() < INTERMEDIATE
    segment = int(rng.integers(1, len(robot.segments))) if several else 0
    questions = []
    for ends in kinematics.segment_ends(robot, q):
        more = [sn.Target(ends[segment][:3, 3], segment=segment)] if segment else []
        questions.append([target_at(ends[-1] @ robot.tool, kind), *more])
    return questions


def standing(robot: sn.Robot, drives: Floats) -> Flags:
    """Whether the body of a robot under load is at rest at drives (m, n, 3), and stays there."""

    def stands(q: Floats) -> bool:
        try:
            return robot.shape(q).stable
        except sn.InputError:
            return False

    return np.array([stands(q) for q in drives], bool)


def mounts(seed: int, number: int) -> World:
    """Robots whose mount holds short segments that bend and long ones that do not, with obstacles about the mount."""
    rng = np.random.default_rng([seed, 11, number])

    def drawn() -> tuple[sn.Robot, Floats]:
        unit = 10.0 ** rng.uniform(-2.0, 2.0)
        segments = [_sorted(UNEVEN, unit, rng) for _ in range(int(rng.integers(2, 7)))]
        longest = sum(segment.length[1] for segment in segments)
        base = sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4))
        robot = sn.Robot(segments, mount=rng.uniform(0.05, 1.0) * longest, base=base)
        return robot, shapes_of(robot, SHAPES, rng)

    def balls(robot: sn.Robot, points: Floats) -> list[Obstacle]:
        return _balls(points, robot.mean_length / len(robot), (0.4, 0.04, 1.0), rng)

    return _about(drawn, rng, balls)


def huge(seed: int, number: int) -> World:
    """One obstacle up to 1e12 times as large as the robot, or as far away, that a body touches, or nearly does.

    Few segments have to meet a whole pose, so that hardly any shape but the hidden one does. In half of the worlds the
    hidden shape overlaps the obstacle by a hair.
    """
    rng = np.random.default_rng([seed, 13, number])
    while True:
        unit = 10.0 ** rng.uniform(-1.0, 1.0)
        robot = sn.Robot(
            [_sorted(PLAIN, unit, rng) for _ in range(int(rng.integers(1, 4)))], base=sn.pose(unit * rng.normal(size=3))
        )
        q = shapes_of(robot, 1, rng)
        for _ in range(DRAWS if len(q) else 0):
            points, along = kinematics.body_points(robot, q, 200)
            radii = np.broadcast_to(np.array(robot.radii)[:, None], along.shape).reshape(-1)
            i, side = int(rng.integers(along.size)), rng.choice([-1.0, 1.0])
            gap = side * unit * 10.0 ** rng.uniform(*GAPS)
            obstacle = _huge(points.reshape(-1, 3)[i], float(radii[i]) + gap, unit, rng)
            found = float(Clearances(robot, sn.Scene([obstacle])).least(q)[0])
            if abs(found) < unit * 10.0 ** GAPS[1]:
                targets = asked(robot, q, rng, "rotation")
                possible = found > CLEAR * unit
                return World(
                    robot, sn.Scene([obstacle]), sn.Tolerance(1e-9 * unit, 1e-9), targets, q, possible, time=SHORT
                )


def bodies(seed: int, number: int) -> World:
    """Meshes of two boxes that overlap, or nearly touch, nearer to each other than their samples.

    In half of the worlds one box lies within the other, and the base between their faces: it is in the solid.
    """
    rng = np.random.default_rng([seed, 14, number])
    if number % 2:
        return _within_wall(rng)

    def two_boxes(robot: sn.Robot, points: Floats) -> list[Obstacle]:
        size = robot.mean_length * rng.uniform(0.1, 0.6, 3)
        middle = points[rng.integers(len(points))] + size * rng.normal(size=3)
        turn = pose_rotation(rng.normal(size=4))
        share = rng.integers(2) + rng.choice([-1.0, 1.0]) * 10.0 ** rng.uniform(-3.0, -0.5)
        other = middle + turn @ (share * size * np.eye(3)[rng.integers(3)])
        return _solids(solids.joined([solids.cuboid(place, size, turn) for place in (middle, other)]))

    return _about(lambda: robot_with_shapes(SHAPES, rng, (-1.0, 1.0)), rng, two_boxes)


def radii(seed: int, number: int) -> World:
    """Robots of thick and thin segments and of hinges without any thickness, folded."""
    rng = np.random.default_rng([seed, 15, number])

    def drawn() -> tuple[sn.Robot, Floats]:
        unit = 10.0 ** rng.uniform(-2.0, 2.0)
        robot = sn.Robot([_sorted(OF_ALL_RADII, unit, rng) for _ in range(int(rng.integers(3, 9)))])
        return robot, shapes_of(robot, SHAPES, rng)

    return _about(drawn, rng, lambda *_: [])


def bounds(seed: int, number: int) -> World:
    """Fields and grids that know bounds of distances to balls: a share of them, or no more than some value."""
    rng, seen = np.random.default_rng([seed, 16, number]), list[Floats]()

    def balls(robot: sn.Robot, points: Floats) -> list[Obstacle]:
        seen[:] = [points]
        return _balls(points, robot.mean_length, (0.3, 0.05, 0.4), rng)

    world = _about(lambda: robot_with_shapes(SHAPES, rng, (-1.0, 1.0)), rng, balls)
    scene = sn.Scene([_bounding(list(world.scene.obstacles), seen[0], world.robot.mean_length, rng)])
    return replace(world, scene=scene, truth=world.scene, time=SHORT)


def demands(seed: int, number: int) -> World:
    """Robots that demand clearances, from obstacles and from themselves, of all segments or of each, or are unsure."""
    rng = np.random.default_rng([seed, 19, number])

    def drawn() -> tuple[sn.Robot, Floats]:
        plain, q = robot_with_shapes(SHAPES, rng)
        robot = demanding(plain, rng)
        return robot, q[surely_clear(kinematics.self_body(robot), q) & _gently_bent(robot, q)]

    return _about(drawn, rng)


def loaded(seed: int, number: int) -> World:
    """Robots that bend under gravity and payload among obstacles, at drives whose bodies at rest are clear."""
    rng = np.random.default_rng([seed, 23, number])
    while True:
        robot = loaded_robot(10.0 ** rng.uniform(-3.0, 3.0), rng)
        q = robot.clamp(shapes_of(robot, 6, rng))  # segments that no tendon moves are straight
        q = q[standing(robot, q)]
        if len(q) == 0:
            continue
        body, arcs = bodies_at(robot, q)
        scene = scene_about(body, arcs, rng)
        clear = look(kinematics.self_body(body), arcs, 0.0).least > 0.0
        if len(scene):
            clear &= Clearances(kinematics.needed_body(body), scene).least(arcs, 0.0) > CLEAR * robot.mean_length
        if clear.any():
            q, kind = q[clear], str(rng.choice(["position", "direction", "rotation"]))
            targets = [[target_at(robot.shape(each).tip, kind)] for each in q]
            tolerance = sn.Tolerance().for_robot(robot)
            return World(robot, scene, tolerance, targets, q, time=LOADED_BUDGET, loaded=True)


def jointed(seed: int, number: int) -> World:
    """Arms with joints before the segments, or with joints alone."""
    rng = np.random.default_rng([seed, 31, number])

    def drawn() -> tuple[sn.Robot, Floats]:
        robot = jointed_robot(rng)
        return robot, jointed_shapes(robot, JOINTED, CLEAR * robot.mean_length, rng)

    return replace(_about(drawn, rng), time=JOINTED_BUDGET)


CLUTTERED, ABOUT = (-1.3, -0.5), 4
"""Powers of ten between which a segment in clutter is long; and shapes that obstacles leave room for."""


def clutter(seed: int, count: int) -> ProblemSet:
    """Return anything that can be built, and targets: of clear configurations, and as many of any others.

    The latter overlap something, or themselves, more often than not, and are often impossible.
    """
    rng = np.random.default_rng([seed, 24])
    while True:
        robot, q = robot_with_shapes(count - count // 2, rng, CLUTTERED)
        scene = scene_about(robot, q[:ABOUT], rng) if len(q) else sn.Scene()
        if len(scene):
            break
    q = np.concatenate([q, random_configurations(robot, count - len(q), rng)])
    kinds, tips = ["position", "direction", "rotation"], kinematics.tip_poses(robot, q)
    targets = [target_at(tip, str(rng.choice(kinds))) for tip in tips]
    return ProblemSet(robot, targets, scene, sn.Tolerance().for_robot(robot))


AUDITED: dict[str, Callable[[int, int], World]] = {
    "mounts with uneven segments": mounts,
    "obstacles with huge coordinates": huge,
    "overlapping bodies in a mesh": bodies,
    "fields and grids with bounds": bounds,
    "several radii and hinges": radii,
    "demanded clearances": demands,
    "robots under load": loaded,
    "arms with joints": jointed,
}


Drawn = Callable[[], tuple[sn.Robot, Floats]]
"""Draws a robot, and shapes (m, n, 3) of it that are clear of themselves; perhaps none."""


Placed = Callable[[sn.Robot, Floats], list[Obstacle]]
"""Draws obstacles for a robot, from points (k, 3) of its bodies."""


def _about(drawn: Drawn, rng: Generator, placed: Placed | None = None) -> World:
    """The first world with clear shapes: some scenes are drawn, of every kind by default, before another robot is."""
    while True:
        robot, q = drawn()
        for _ in range(DRAWS if len(q) else 0):
            if placed is None:
                obstacles = list(scene_about(robot, q, rng).obstacles)
            else:
                obstacles = placed(robot, kinematics.body_points(robot, q, 12)[0].reshape(-1, 3))
            world = _world(robot, obstacles, q, rng)
            if world is not None:
                return world


def _world(robot: sn.Robot, obstacles: list[Obstacle], q: Floats, rng: Generator) -> World | None:
    """The world of those shapes that are clear; `None` where none is."""
    scene = sn.Scene(obstacles)
    if obstacles:
        q = q[Clearances(kinematics.needed_body(robot), scene).least(q, 0.0) > CLEAR * robot.mean_length]
    return World(robot, scene, _tolerance(robot, rng), asked(robot, q, rng), q) if len(q) else None


def _balls(points: Floats, unit: float, sizes: tuple[float, float, float], rng: Generator) -> list[Obstacle]:
    """Balls near points: how far off, and least and largest radius, in units."""
    off, low, high = sizes
    balls: list[Obstacle] = []
    for _ in range(int(rng.integers(1, BALLS))):
        center = points[rng.integers(len(points))] + off * unit * rng.normal(size=3)
        balls.append(sn.Sphere(center, unit * rng.uniform(low, high)))
    return balls


def demanding(robot: sn.Robot, rng: Generator) -> sn.Robot:
    """The robot with at least one of the three demands."""
    size, which = robot.mean_length, int(rng.integers(1, 8))

    def some(most: float) -> float | list[float]:
        alike = rng.random() < 0.5
        values = size * 10.0 ** rng.uniform(-4.0, math.log10(most), len(robot)) * (rng.random(len(robot)) < 0.8)
        return float(values.max()) if alike else values.tolist()

    return robot.changed(
        clearance=some(0.1) if which & 1 else 0.0,
        self_clearance=some(0.05) if which & 2 else 0.0,
        uncertainty=sn.Uncertainty(some(0.05)) if which & 4 else None,
    )


def _gently_bent(robot: sn.Robot, q: Floats) -> Flags:
    """Whether shapes (m, n, 3) bend no tighter than a body as thick as is demanded."""
    norms, radii = np.hypot(q[..., 0], q[..., 1]), np.array(kinematics.self_body(robot).radii)
    return np.asarray((norms * radii <= TIGHTEST * q[..., 2]).all(axis=1))


def _tolerance(robot: sn.Robot, rng: Generator) -> sn.Tolerance:
    position, angle = 10.0 ** rng.uniform(*TOLERANCES, 2)
    return sn.Tolerance(position * robot.mean_length, angle)


def _sorted(sorts: tuple[Sort, ...], unit: float, rng: Generator) -> sn.Segment:
    """Draw a segment of one of these sorts."""
    sort = sorts[rng.integers(len(sorts))]
    low, high = sorted(unit * rng.uniform(*sort.length, 2))
    length = (low, high) if sort.stretches else high
    return sn.Segment(length, rng.uniform(*sort.bend), radius=unit * rng.uniform(*sort.radius))


def _huge(at: Floats, off: float, unit: float, rng: Generator) -> Obstacle:
    """An obstacle that begins `off` from a place. Its axes are those of the world, so no rotation of it is rounded."""
    size = unit * 10.0 ** rng.uniform(*HUGE) * rng.uniform(0.5, 2.0, 3)
    turn = np.roll(np.eye(3), rng.integers(3), axis=1)
    kind = str(rng.choice(["sphere", "inside", "box", "half_space", "capsule", "cylinder"]))
    away = rng.choice([-1.0, 1.0]) * turn[:, rng.integers(3)]
    if kind in ("sphere", "inside"):
        away = in_ball(rng)
        away /= np.linalg.norm(away)
    return solids.beside(kind, at, away, off, size, turn, rng.uniform(-0.8, 0.8, 3))


def loaded_robot(unit: float, rng: Generator) -> sn.Robot:
    """A robot of 1 to 5 segments of 1 to 4 arcs, whose weight bends it a little or much."""
    count, arcs = int(rng.integers(1, 6)), int(rng.integers(1, 5))
    longest = count * 1.2 * unit
    gravity, mass = 9.81 * rng.normal(size=3), 10.0 ** rng.uniform(-3.0, 3.0)
    carried = mass * longest * rng.uniform(0.0, 1.0) if rng.random() < 0.6 else 0.0
    weight = float(np.linalg.norm(gravity)) * (mass * longest + carried)
    bend = weight * longest**2 / 10.0 ** rng.uniform(*LOADED)
    twist = bend * rng.uniform(0.6, 1.0) if rng.random() < 0.5 else None
    stretch = bend / unit**2 * 10.0 ** rng.uniform(2.0, 4.0) if rng.random() < 0.3 else None
    rod, driven, radius = sn.Stiffness(bend, twist, stretch), rng.random() < 0.3, unit * 10.0 ** rng.uniform(-2.5, -1.0)
    segments: list[sn.Segment] = []
    for _ in range(count):
        low, gives = unit * rng.choice([1.2, rng.uniform(0.6, 1.1)]), rng.random() < 0.85 or not segments
        segment = sn.Segment((low, 1.2 * unit), rng.uniform(0.5, 3.0), radius=radius, mass=mass)
        if gives:
            tendons = sn.Tendons(3, 0.08 * unit) if driven else None
            segment = segment.changed(tendons=tendons, stiffness=rod, arcs=arcs)
        segments.append(segment)
    base = sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4))
    payload = sn.Payload(carried) if carried > 0.0 else None
    robot = sn.Robot(segments, base=base, gravity=gravity, payload=payload)
    return demanding(robot, rng) if rng.random() < 0.3 else robot


def _bounding(balls: list[Obstacle], points: Floats, unit: float, rng: Generator) -> Obstacle:
    """A field or a grid whose values are bounds of the distance to balls, and says so where it has to.

    Nothing said, a function may give lower bounds, and distances in a grid are exact below the largest of them.
    """
    centers, radii = (np.array([getattr(ball, name) for ball in balls]) for name in ("center", "radius"))
    cut = rng.random() < 0.5
    share, most = (1.0, unit * 10.0 ** rng.uniform(-2.0, 0.0)) if cut else (rng.uniform(0.2, 0.9), np.inf)
    known: dict[str, Any] = {"truncated": most} if cut and rng.random() < 0.5 else {}
    low, high = points.min(axis=0) - 0.5 * unit, points.max(axis=0) + 0.5 * unit
    spacing = float((high - low).max()) / CELLS

    def bound(places: Floats) -> Floats:
        gaps = np.linalg.norm(places[:, None] - centers, axis=-1) - radii
        return np.asarray(np.minimum(share * gaps.min(axis=1), most))

    if rng.random() < 0.5:
        return sn.Field(bound, low, high, spacing, **known)
    axes = [np.arange(a, b + spacing, spacing) for a, b in zip(low, high, strict=True)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = bound(places.reshape(-1, 3)).reshape(places.shape[:3])
    return sn.Grid(values, low, spacing, **known if cut else {"exact": False})


def _within_wall(rng: Generator) -> World:
    """A thin robot in the solid between the faces of two boxes of one mesh."""
    half, wall, turn = rng.uniform(0.2, 0.5, 3), 10.0 ** rng.uniform(-3.0, -1.0), pose_rotation(rng.normal(size=4))
    both = solids.joined([solids.cuboid(np.zeros(3), 2.0 * (half + grown), turn) for grown in (0.0, wall)])
    length, place = 0.2 * float(half.min()), np.append(half[:2] * rng.uniform(-0.5, 0.5, 2), half[2] + 0.5 * wall)
    base = sn.pose(turn @ place, direction=turn[:, 0])
    robot = sn.Robot.uniform(2, (0.8 * length, length), 0.5, radius=0.1 * wall, base=base)
    q = np.array([[[0.0, 0.0, length], [0.0, 0.0, 0.9 * length]]])
    scene = sn.Scene(_solids(both))
    return World(robot, scene, sn.Tolerance(1e-3 * length, 1e-3), asked(robot, q, rng, "position"), q, possible=False)


def _solids(surface: solids.Surface) -> list[Any]:
    """A mesh as it is; where it is refused because its bodies overlap, each of its bodies."""
    mesh = sn.Mesh(surface.vertices, surface.faces)
    try:
        sn.Scene([mesh]).prepare()
    except sn.InputError:
        return list(mesh.bodies())
    return [mesh]
