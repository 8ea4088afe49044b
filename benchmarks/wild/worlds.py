"""A wild world: one robot in one scene, and problems that each have a hidden solution there.

Besides worlds of anything there are kinds that an audit of the proofs asked for: each strains one argument. Judges
share no code with the solver. Obstacles with huge coordinates are judged in extended precision. The shape of a robot
under load is its equilibrium, looked for anew; that this is at rest is held against Cosserat rods elsewhere
(`benchmarks.real`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.bodies import needed_body, self_body
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.kinematics import body_points, segment_ends
from benchmarks.judges.self_collision import Flags, look, surely_clear
from benchmarks.places.parts.surfaces import Surface, joined
from benchmarks.wild.obstacles import block_surface, pose_rotation, scene_about
from benchmarks.wild.robots import TIGHTEST, jointed_robot, jointed_shapes, robot_with_shapes, shapes_of
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle
from sinuous.statics.rest import bodies_at

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


UNITS = (-9.0, 9.0)
"""Powers of ten between which a segment is long."""

HUGE, GAPS = (3.0, 12.0), (-12.0, -2.0)
"""Powers of ten of the size of huge obstacles, and of their gap to a body; both in lengths of a segment."""

BALLS = 6
"""Most obstacles that stand about a mount."""

CELLS = 24
"""Cells of a field or a grid along its longest edge."""

SHORT = 0.05
"""Budget of one solve, in seconds, of kinds whose problems are often impossible: what counts there are claims."""

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
    for ends in segment_ends(robot, q):
        more = [sn.Target(ends[segment][:3, 3], segment=segment)] if segment else []
        questions.append([target_at(ends[-1] @ robot.tool, kind), *more])
    return questions


def target_at(tip: Floats, kind: str) -> sn.Target:
    """Return the target that a pose (4, 4) of the tip meets, of one of the `KINDS`."""
    direction = tip[:3, 2] if kind.startswith("direction") else None
    rotation = tip[:3, :3] if kind.startswith("rotation") else None
    return sn.Target(None if kind.endswith("alone") else tip[:3, 3], direction=direction, rotation=rotation)


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
        segments = [_uneven(unit, rng) for _ in range(int(rng.integers(2, 7)))]
        longest = sum(segment.length[1] for segment in segments)
        base = sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4))
        robot = sn.Robot(segments, mount=rng.uniform(0.05, 1.0) * longest, base=base)
        unit_of[robot] = unit
        return robot, shapes_of(robot, SHAPES, rng)

    unit_of: dict[sn.Robot, float] = {}
    return _beside(drawn, lambda robot, points: _balls(points, unit_of[robot], (0.2, 0.02, 0.5), rng), rng)


def units(seed: int, number: int) -> World:
    """Wild worlds whose segments are 1e-9 to 1e9 long."""
    rng = np.random.default_rng([seed, 12, number])
    return _about(lambda: robot_with_shapes(SHAPES, rng, UNITS), rng)


def huge(seed: int, number: int) -> World:
    """One obstacle up to 1e12 times as large as the robot, or as far away, that a body touches, or nearly does.

    Few segments have to meet a whole pose, so that hardly any shape but the hidden one does. In half of the worlds the
    hidden shape overlaps the obstacle by a hair.
    """
    rng = np.random.default_rng([seed, 13, number])
    while True:
        unit = 10.0 ** rng.uniform(-1.0, 1.0)
        robot = sn.Robot(
            [_plain(unit, rng) for _ in range(int(rng.integers(1, 4)))], base=sn.pose(unit * rng.normal(size=3))
        )
        q = shapes_of(robot, 1, rng)
        for _ in range(DRAWS if len(q) else 0):
            points, along = body_points(robot, q, 200)
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
        return _solids(joined([block_surface(place, 0.5 * size, turn) for place in (middle, other)]))

    return _beside(lambda: robot_with_shapes(SHAPES, rng, (-1.0, 1.0)), two_boxes, rng)


def radii(seed: int, number: int) -> World:
    """Robots of thick and thin segments and of hinges without any thickness, folded."""
    rng = np.random.default_rng([seed, 15, number])
    while True:
        unit = 10.0 ** rng.uniform(-2.0, 2.0)
        robot = sn.Robot([_thick_or_thin(unit, rng) for _ in range(int(rng.integers(3, 9)))])
        q = shapes_of(robot, SHAPES, rng)
        if len(q):
            return World(robot, sn.Scene(), _tolerance(robot, rng), asked(robot, q, rng), q)


def bounds(seed: int, number: int) -> World:
    """Fields and grids that know bounds of distances to balls: a share of them, or no more than some value."""
    rng, seen = np.random.default_rng([seed, 16, number]), list[Floats]()

    def balls(robot: sn.Robot, points: Floats) -> list[Obstacle]:
        seen[:] = [points]
        return _balls(points, robot.mean_length, (0.3, 0.05, 0.4), rng)

    world = _beside(lambda: robot_with_shapes(SHAPES, rng, (-1.0, 1.0)), balls, rng)
    scene = sn.Scene([_bounding(list(world.scene.obstacles), seen[0], world.robot.mean_length, rng)])
    return replace(world, scene=scene, truth=world.scene, time=SHORT)


def demands(seed: int, number: int) -> World:
    """Robots that demand clearances, from obstacles and from themselves, of all segments or of each, or are unsure."""
    rng = np.random.default_rng([seed, 19, number])
    while True:
        robot, q = robot_with_shapes(SHAPES, rng, UNITS)
        scene = scene_about(robot, q, rng) if len(q) else sn.Scene()
        robot = demanding(robot, rng)
        if len(q):
            q = q[surely_clear(self_body(robot), q) & _gently_bent(robot, q)]
        if len(q) and len(scene):
            q = q[Clearances(needed_body(robot), scene).least(q, 0.0) > CLEAR * robot.mean_length]
        if len(q):
            return World(robot, scene, _tolerance(robot, rng), asked(robot, q, rng), q)


def loaded(seed: int, number: int) -> World:
    """Robots that bend under gravity and payload among obstacles, at drives whose bodies at rest are clear."""
    rng = np.random.default_rng([seed, 23, number])
    while True:
        robot = _loaded_robot(10.0 ** rng.uniform(-3.0, 3.0), rng)
        q = shapes_of(robot, 6, rng)
        q = q[standing(robot, q)]
        if len(q) == 0:
            continue
        body, arcs = bodies_at(robot, q)
        scene = scene_about(body, arcs, rng)
        clear = look(self_body(body), arcs, 0.0).least > 0.0
        if len(scene):
            clear &= Clearances(needed_body(body), scene).least(arcs, 0.0) > CLEAR * robot.mean_length
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


AUDITED: dict[str, Callable[[int, int], World]] = {
    "mounts with uneven segments": mounts,
    "units from 1e-9 to 1e9": units,
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


def _about(drawn: Drawn, rng: Generator) -> World:
    """The first world with clear shapes of those with obstacles of every kind about the bodies."""
    while True:
        robot, q = drawn()
        world = _world(robot, list(scene_about(robot, q, rng).obstacles), q, rng) if len(q) else None
        if world is not None:
            return world


def _beside(drawn: Drawn, obstacles: Callable[[sn.Robot, Floats], list[Obstacle]], rng: Generator) -> World:
    """The same with obstacles beside points (k, 3) of the bodies; some are drawn before another robot is."""
    while True:
        robot, q = drawn()
        for _ in range(DRAWS if len(q) else 0):
            world = _world(robot, obstacles(robot, body_points(robot, q, 12)[0].reshape(-1, 3)), q, rng)
            if world is not None:
                return world


def _world(robot: sn.Robot, obstacles: list[Obstacle], q: Floats, rng: Generator) -> World | None:
    """The world of those shapes that are clear; `None` where none is."""
    scene = sn.Scene(obstacles)
    if obstacles:
        q = q[Clearances(robot, scene).least(q, 0.0) > CLEAR * robot.mean_length]
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
    norms, radii = np.hypot(q[..., 0], q[..., 1]), np.array(self_body(robot).radii)
    return np.asarray((norms * radii <= TIGHTEST * q[..., 2]).all(axis=1))


def _tolerance(robot: sn.Robot, rng: Generator) -> sn.Tolerance:
    position, angle = 10.0 ** rng.uniform(*TOLERANCES, 2)
    return sn.Tolerance(position * robot.mean_length, angle)


def _uneven(unit: float, rng: Generator) -> sn.Segment:
    """A segment that turns at once, a rigid link, or an ordinary segment."""
    radius = unit * rng.uniform(0.002, 0.02)
    kind = rng.integers(3)
    if kind == 0:
        return sn.Segment(unit * rng.uniform(0.03, 0.2), rng.uniform(0.5, 2.5), radius=radius)
    if kind == 1:
        return sn.Segment(unit * rng.uniform(0.2, 1.0), 0.0, radius=radius)
    low, high = np.sort(unit * rng.uniform(0.2, 1.2, 2))
    return sn.Segment((float(low), float(high)), rng.uniform(0.5, 3.0), radius=radius)


def _plain(unit: float, rng: Generator) -> sn.Segment:
    low, high = unit * rng.uniform(0.5, 1.0), unit * rng.uniform(1.0, 1.5)
    return sn.Segment((low, high), rng.uniform(0.5, 3.0), radius=unit * rng.uniform(0.01, 0.1))


def _thick_or_thin(unit: float, rng: Generator) -> sn.Segment:
    """A thick segment, a thin one, or a hinge."""
    kind = rng.integers(3)
    if kind == 0:
        return sn.Segment(unit * rng.uniform(0.5, 1.5), rng.uniform(0.5, 3.0), radius=unit * rng.uniform(0.05, 0.15))
    if kind == 1:
        return sn.Segment(unit * rng.uniform(0.3, 1.5), rng.uniform(1.0, 6.0), radius=unit * rng.uniform(0.003, 0.03))
    return sn.Segment(unit * rng.uniform(1e-3, 0.05), rng.uniform(1.0, 3.1), radius=0.0)


def _huge(at: Floats, off: float, unit: float, rng: Generator) -> Obstacle:
    """An obstacle that begins `off` from a place. Its axes are those of the world, so no rotation of it is rounded."""
    size = unit * 10.0 ** rng.uniform(*HUGE)
    kind = rng.choice(["sphere", "room", "box", "half-space", "capsule", "cylinder"])
    axis, side = np.eye(3)[rng.integers(3)], rng.choice([-1.0, 1.0])
    away = rng.normal(size=3)
    away /= np.linalg.norm(away)
    if kind == "sphere":
        return sn.Sphere(at + (off + size) * away, size)
    if kind == "room":
        return sn.Sphere(at + (size - off) * away, size, inside=True)
    if kind == "half-space":
        return sn.HalfSpace(at + side * off * axis + size * (rng.normal(size=3) * (1.0 - axis)), -side * axis)
    if kind == "box":
        sides = size * rng.uniform(0.5, 2.0, 3)
        across = 0.4 * sides * rng.uniform(-1.0, 1.0, 3) * (1.0 - axis)
        return sn.Box(at + side * (off + 0.5 * sides @ axis) * axis + across, sides)
    other = np.roll(axis, 1)
    middle = at + side * (off + size) * axis + 0.4 * size * rng.uniform(-1.0, 1.0) * other
    return (sn.Capsule if kind == "capsule" else sn.Cylinder)(middle - size * other, middle + size * other, size)


def _loaded_robot(unit: float, rng: Generator) -> sn.Robot:
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
    both = joined([block_surface(np.zeros(3), half + grown, turn) for grown in (0.0, wall)])
    length, place = 0.2 * float(half.min()), np.append(half[:2] * rng.uniform(-0.5, 0.5, 2), half[2] + 0.5 * wall)
    base = sn.pose(turn @ place, direction=turn[:, 0])
    robot = sn.Robot.uniform(2, (0.8 * length, length), 0.5, radius=0.1 * wall, base=base)
    q = np.array([[[0.0, 0.0, length], [0.0, 0.0, 0.9 * length]]])
    scene = sn.Scene(_solids(both))
    return World(robot, scene, sn.Tolerance(1e-3 * length, 1e-3), asked(robot, q, rng, "position"), q, possible=False)


def _solids(surface: Surface) -> list[Any]:
    """A mesh as it is; where it is refused because its bodies overlap, each of its bodies."""
    mesh = sn.Mesh(surface.vertices, surface.faces)
    try:
        sn.Scene([mesh]).prepare()
    except sn.InputError:
        return list(mesh.bodies())
    return [mesh]
