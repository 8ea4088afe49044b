"""Answers of all kinds, made so that something is active in them: limits, actuators, obstacles, the body itself."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.places.scans import CORNERS, FACES
from sinuous.base.checks import Floats
from sinuous.kernels.packing import MARGIN
from sinuous.scene.obstacles import Obstacle

EXACT = 1e-12
"""Tolerances of answers and of their differences: mean lengths of the robot, rad."""


def solver_for(robot: sn.Robot, scene: list[Obstacle]) -> sn.Solver:
    """Return a solver that meets targets to rounding."""
    tolerance = sn.Tolerance(EXACT * robot.mean_length, EXACT)
    return sn.Solver(robot, scene, tolerance=tolerance, routes=False, max_starts=8)


def unit(rng: Generator, across: Floats | None = None) -> Floats:
    """Return a random direction (3,), across another one where that is given."""
    direction: Floats = rng.normal(size=3)
    if across is not None:
        direction -= direction @ across * across
    return direction / np.linalg.norm(direction)


def _placed(size: float, rng: Generator) -> Floats:
    """Return a random pose (4, 4) as far away as `size`."""
    turned = np.eye(4)
    turned[:3, :3] = Rotation.from_quat(rng.normal(size=4)).as_matrix()
    turned[:3, 3] = size * rng.normal(size=3)
    return turned


def random_robot(rng: Generator, lines: bool = False, thick: float = 0.0) -> sn.Robot:
    """Return a robot in any unit, anywhere: 2 to 6 segments, some of which stretch, some with a tool."""
    size = 10.0 ** rng.uniform(-2.0, 3.0)
    segments = []
    for _ in range(int(rng.integers(2, 7))):
        length = size * rng.uniform(0.5, 1.5)
        span = (0.6 * length, 1.4 * length) if rng.random() < 0.6 else length
        tendons = sn.Tendons(int(rng.integers(3, 5)), 0.05 * size, rng.uniform(0.0, 6.0)) if lines else None
        chambers = sn.Chambers(3, 0.04 * size) if lines and rng.random() < 0.3 else None
        segments.append(sn.Segment(span, rng.uniform(2.0, 3.0), None, thick * size, tendons, chambers))
    tool = _placed(0.3 * size, rng) if rng.random() < 0.5 else None
    base = _placed(2.0 * size, rng)
    return sn.Robot(segments, base=base, tool=tool)


def random_shape(robot: sn.Robot, rng: Generator) -> Floats:
    """Return a configuration (n, 3) well within the limits."""
    bends = rng.normal(size=(len(robot), 2))
    bends *= rng.uniform(0.2, 0.7, size=(len(robot), 1)) * robot.limits[:, 2:3] / np.linalg.norm(bends, axis=1)[:, None]
    low, high = robot.limits[:, 0], robot.limits[:, 1]
    lengths = low + rng.uniform(0.2, 0.8, size=len(robot)) * (high - low)
    return np.column_stack([bends, lengths])


def targets_at(robot: sn.Robot, q: Floats, rng: Generator) -> list[sn.Target]:
    """Return targets that a configuration meets, of no more numbers than can be moved."""
    tip = robot.tip(q)
    free = int((robot.limits[:, 5:7] > 0.0) @ [2, 1] @ np.ones(len(robot)))
    kind = rng.integers(0, 5)
    if kind == 0 and free > 5:
        targets = [sn.Target(tip[:3, 3], direction=tip[:3, 2])]
    elif kind == 1 and free > 6:
        targets = [sn.Target(tip[:3, 3], rotation=tip[:3, :3])]
    elif kind == 2:
        targets = [sn.Target(direction=tip[:3, 2])]
    elif kind == 3 and free > 6 and len(robot) > 2:
        before = robot.forward(q)[len(robot) - 2, :3, 2]
        targets = [sn.Target(tip[:3, 3]), sn.Target(direction=before, segment=len(robot) - 1)]
    else:
        targets = [sn.Target(tip[:3, 3])]
    return targets


def free(rng: Generator) -> sn.Solution:
    """Nothing is active."""
    robot = random_robot(rng, lines=rng.random() < 0.3)
    q = random_shape(robot, rng)
    return solver_for(robot, []).solve(targets_at(robot, q, rng), q)


def at_limits(rng: Generator) -> sn.Solution:
    """Some segments are at limits of their bends, curvatures or lengths."""
    robot = random_robot(rng)
    q = random_shape(robot, rng)
    segments = list(robot.segments)
    for k in rng.permutation(len(robot))[: int(rng.integers(1, 3))]:
        bend, (low, high) = float(np.hypot(*q[k, :2])), segments[k].length
        kind = rng.integers(0, 3 if high > low else 2)
        if kind == 0:
            segments[k] = segments[k].changed(max_bend=bend)
        elif kind == 1:
            segments[k] = segments[k].changed(max_curvature=bend / q[k, 2])
        else:
            segments[k] = segments[k].changed(length=(q[k, 2], high) if rng.random() < 0.5 else (low, q[k, 2]))
    robot = robot.changed(segments=segments)
    return solver_for(robot, []).solve(targets_at(robot, q, rng), q)


def at_actuators(rng: Generator) -> sn.Solution:
    """Some tendons and chambers are at their limits."""
    robot = random_robot(rng, lines=True)
    q = random_shape(robot, rng)
    values = dict(zip((each.name for each in robot.actuators), robot.to_actuators(q), strict=True))
    segments = list(robot.segments)
    k = int(rng.integers(len(robot)))
    own = [value for name, value in values.items() if name.startswith(f"s{k + 1}.t")]
    tendons = segments[k].tendons
    assert tendons is not None
    segments[k] = segments[k].changed(tendons=tendons.changed(displacement=(2.0 * min(*own, 0.0), max(*own, 0.0))))
    robot = robot.changed(segments=segments)
    return solver_for(robot, []).solve(targets_at(robot, q, rng), q)


def _frame(z: Floats, rng: Generator) -> Floats:
    x = unit(rng, z)
    return np.column_stack([x, np.cross(z, x), z])


Place = Callable[[Floats, Floats, float, float, Generator], Obstacle]
"""From a point, a normal, how far away, a size and random numbers to an obstacle that begins there."""


def _edge(p: Floats, normal: Floats, away: float, size: float, rng: Generator) -> Obstacle:
    turned = _frame(normal, rng) @ Rotation.from_euler("x", rng.uniform(0.6, 0.9)).as_matrix()
    edges = (np.array([0.0, y, z]) @ turned.T for y in (size, -size) for z in (size, -size))
    least = min(edges, key=lambda edge: edge @ normal)
    return sn.Box(p + away * normal - least, np.full(3, 2.0 * size), turned)


def _along(kind: type[sn.Cylinder] | type[sn.Capsule], half: float) -> Place:
    def make(p: Floats, normal: Floats, away: float, size: float, rng: Generator) -> Obstacle:
        middle, axis = p + (away + size) * normal, unit(rng, normal)
        return kind(middle - half * size * axis, middle + half * size * axis, size)

    return make


OBSTACLES: dict[str, Place] = {
    "sphere": lambda p, n, away, size, _: sn.Sphere(p + (away + size) * n, size),
    "inside": lambda p, n, away, size, _: sn.Sphere(p + (away - 20.0 * size) * n, 20.0 * size, inside=True),
    "box": lambda p, n, away, size, rng: sn.Box(p + (away + size) * n, np.full(3, 2.0 * size), _frame(n, rng)),
    "edge": _edge,
    "cylinder": _along(sn.Cylinder, 3.0),
    "capsule": _along(sn.Capsule, 1.0),
    "half_space": lambda p, n, away, _, rng: sn.HalfSpace(p + away * n, -n),
    "mesh": lambda p, n, away, size, rng: sn.Mesh(
        p + (away + size) * n + 2.0 * size * CORNERS @ _frame(n, rng).T, FACES
    ),
}


def touching(kind: str, rng: Generator, beside: float = 0.0, place: float | None = None) -> tuple[sn.Problem, Floats]:
    """The body touches an obstacle: its gap is the one that solves keep, and `beside` mean lengths more.

    It does so at the fraction `place` of a segment, by default anywhere but at the ends.

    Returns a problem, and the configuration (n, 3) that answers it.
    """
    robot = random_robot(rng, thick=0.02)
    q = random_shape(robot, rng)
    k, s = int(rng.integers(len(robot))), rng.uniform(0.3, 0.7) if place is None else place
    part = q.copy()
    part[k] *= s
    here = robot.forward(part)[k]
    normal = unit(rng, here[:3, 2])
    away = robot.radii[k] + (MARGIN + beside) * robot.mean_length
    size = float(rng.uniform(0.1, 0.4)) * q[k, 2]
    obstacle = OBSTACLES[kind](here[:3, 3], normal, away, size, rng)
    return sn.Problem(robot, targets_at(robot, q, rng), [obstacle]), q


def _answer(asked: tuple[sn.Problem, Floats]) -> sn.Solution:
    problem, q = asked
    return solver_for(problem.robot, list(problem.scene.obstacles)).solve(list(problem.targets), q)


def beside_obstacles(rng: Generator) -> sn.Solution:
    """The body is near obstacles of any kind, and touches none."""
    return _answer(touching(str(rng.choice(list(OBSTACLES))), rng, beside=float(10.0 ** rng.uniform(-4.0, -1.0))))


def at_obstacles(rng: Generator) -> sn.Solution:
    """The body touches an obstacle of any kind, unless the solve moves it away from there."""
    return _answer(touching(str(rng.choice(list(OBSTACLES))), rng))


def curled(rng: Generator) -> sn.Solution:
    """The body is near itself, or touches itself."""
    size = 10.0 ** rng.uniform(-2.0, 3.0)
    gap = float(rng.choice([MARGIN, 1e-3, 1e-2]))
    count, turn = int(rng.integers(4, 7)), rng.uniform(2.2, 2.8)
    lengths = size * rng.uniform(0.9, 1.1, count)
    q = np.column_stack([np.full(count, turn), np.linspace(0.0, 0.8, count), lengths])
    thin = sn.Robot([sn.Segment((0.8 * each, 1.2 * each), 4.0, radius=1e-9 * size) for each in lengths])
    points = thin.backbone(q, 40)
    along = np.concatenate([[0.0], np.cumsum(np.repeat(lengths / 40, 40))])
    far = np.abs(along[:, None] - along) > 1.5 * size
    least = np.where(far, np.linalg.norm(points[:, None] - points, axis=-1), np.inf).min()
    robot = thin.changed(radius=0.5 * max(1e-6 * size, least - gap * thin.mean_length))
    return solver_for(robot, []).solve(targets_at(robot, q, rng), q)


FAMILIES: dict[str, Callable[[Generator], sn.Solution]] = {
    "free": free,
    "limits": at_limits,
    "actuators": at_actuators,
    "beside obstacles": beside_obstacles,
    "at obstacles": at_obstacles,
    "curled": curled,
}
"""Kinds of answers."""


def draw(family: str, rng: Generator) -> sn.Solution | None:
    """Return a solved answer of a family, or nothing where that draw made none."""
    try:
        found = FAMILIES[family](rng)
    except sn.InputError:
        return None
    return found if found.solved else None


SHAPES = {"straight": (1e-4, 1e-2), "bent": (0.5, 2.0), "pi": (3.0, 3.14)}
"""Least and largest bend of the shapes that are preferred."""


class Preferred(NamedTuple):
    """An answer near a start, which is preferred, and so are small bends; and that start (n, 3)."""

    found: sn.Solution
    prefer: sn.Preferences
    start: Floats


def preferred(shape: str, rng: Generator) -> Preferred:
    """Draw an answer that preferences have chosen."""
    robot = random_robot(rng, lines=True)
    robot = robot.changed(segments=[each.changed(max_bend=3.5) for each in robot.segments])
    low, high = robot.limits[:, :2].T
    ways = np.array([unit(rng)[:2] for _ in range(len(robot))])
    q = np.column_stack([ways, low + rng.uniform(0.2, 0.8, len(robot)) * (high - low)])
    q[:, :2] *= rng.uniform(*SHAPES[shape], (len(robot), 1)) / np.linalg.norm(q[:, :2], axis=1, keepdims=True)
    asked = q + 0.02 * rng.normal(size=q.shape) * robot.limits[:, [5, 5, 6]]
    prefer = sn.Preferences(start=1.0, bends=float(rng.choice([0.0, 0.01])))
    solver = sn.Solver(robot, tolerance=sn.Tolerance(1e-9 * robot.mean_length, 1e-9), prefer=prefer, routes=False)
    return Preferred(solver.solve(targets_at(robot, asked, rng), q), prefer, q)


def loaded(rng: Generator) -> sn.answer.Equilibrium:
    """Draw a shape under load: of a robot of 1 to 3 elastic segments, in gravity, with a payload and a force."""
    rod = sn.Stiffness(bend=1.0, twist=rng.uniform(0.5, 1.5), stretch=10.0 ** rng.uniform(1.0, 3.0))
    segments = [sn.Segment((0.3, 0.6), radius=0.01)] * int(rng.integers(1, 4))
    carried = sn.Payload(rng.uniform(0.01, 0.1), 0.02 * rng.normal(size=3))
    robot = sn.Robot(segments, stiffness=rod, mass=0.3, arcs=4, gravity=3.0 * rng.normal(size=3), payload=carried)
    loads = [sn.Force(0.5 * rng.normal(size=3), 0.1 * rng.normal(size=3), position=0.05 * rng.normal(size=3))]
    return robot.shape(random_shape(robot, rng), loads)
