"""`python -m benchmarks derivatives`: whether differences of answers agree with derivatives, and what these cost.

Answers of all kinds are made so that something is active in them: limits, actuators, obstacles, the body itself. They
are solved again, from the answer, after the parameters have moved a little both ways. In every family it is counted how
many answers are regular. Costs are those beyond the solve: by the target, and by everything.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import islice
from time import thread_time
from typing import Any

import numpy as np
from numpy.random import Generator
from scipy.spatial.transform import Rotation

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, Times, timed
from benchmarks.places import solids
from benchmarks.places.parts import about_z
from benchmarks.problems import direction
from sinuous.answer.derivatives.derivative import derivative_of
from sinuous.answer.derivatives.parameters import GROUPS, circles_of
from sinuous.base.arguments import LoadParameter, Parameter
from sinuous.base.checks import Floats
from sinuous.kernels.packing import MARGIN
from sinuous.kernels.tables import LENGTH_SCALE
from sinuous.model.poses import least_rotation
from sinuous.scene.moving import moved
from sinuous.scene.obstacles import Obstacle
from sinuous.statics.equilibrium import find_equilibrium
from sinuous.statics.response import GROUPS as LOADS

EXACT = 1e-12
"""Tolerances of answers and of their differences: mean lengths of the robot, rad."""


Question = tuple[sn.Problem, Floats]
"""What is asked, and the configuration (n, 3) to begin from."""


def solver_for(problem: sn.Problem) -> sn.Solver:
    """Return a solver that meets targets to rounding."""
    robot, scene = problem.robot, list(problem.scene.obstacles)
    tolerance = sn.Tolerance(EXACT * robot.mean_length, EXACT)
    return sn.Solver(robot, scene, tolerance=tolerance, routes=False, max_starts=8)


def answer(asked: Question) -> sn.Solution:
    """Solve from where it is said to begin."""
    problem, q = asked
    return solver_for(problem).solve(list(problem.targets), q)


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
    tool = sn.pose(xyzw=rng.normal(size=4), position=0.3 * size * rng.normal(size=3)) if rng.random() < 0.5 else None
    base = sn.pose(xyzw=rng.normal(size=4), position=2.0 * size * rng.normal(size=3))
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
    movable = int((robot.limits[:, 5:7] > 0.0) @ [2, 1] @ np.ones(len(robot)))
    tip, kind = robot.tip(q), rng.integers(0, 5)
    if kind == 0 and movable > 5:
        return [sn.Target(tip[:3, 3], direction=tip[:3, 2])]
    if kind == 1 and movable > 6:
        return [sn.Target(tip[:3, 3], rotation=tip[:3, :3])]
    if kind == 2:
        return [sn.Target(direction=tip[:3, 2])]
    if kind == 3 and movable > 6 and len(robot) > 2:
        before = robot.forward(q)[len(robot) - 2, :3, 2]
        return [sn.Target(tip[:3, 3]), sn.Target(direction=before, segment=len(robot) - 1)]
    return [sn.Target(tip[:3, 3])]


def solved_near(robot: sn.Robot, q: Floats, rng: Generator) -> sn.Solution:
    """Solve, from a configuration, for targets that it meets."""
    return answer((sn.Problem(robot, targets_at(robot, q, rng)), q))


def free(rng: Generator) -> sn.Solution:
    """Nothing is active."""
    robot = random_robot(rng, lines=rng.random() < 0.3)
    return solved_near(robot, random_shape(robot, rng), rng)


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
    return solved_near(robot.changed(segments=segments), q, rng)


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
    return solved_near(robot.changed(segments=segments), q, rng)


OBSTACLES = ("sphere", "inside", "box", "edge", "cylinder", "capsule", "half_space", "mesh")
"""What may be touched, see `beside`: a box at a face, or at an edge, and others beside their axes."""

SIZES = {"inside": (1.0, 20.0, 1.0), "cylinder": (3.0, 1.0, 1.0)}
"""Their sizes, where these are not equal along all axes."""


def touching(kind: str, rng: Generator, apart: float = 0.0) -> Question:
    """The body touches an obstacle: its gap is the one that solves keep, and `apart` mean lengths more.

    Returns a problem, and the configuration (n, 3) that answers it.
    """
    robot = random_robot(rng, thick=0.02)
    q = random_shape(robot, rng)
    k, s = int(rng.integers(len(robot))), rng.uniform(0.3, 0.7)
    part = q.copy()
    part[k] *= s
    here = robot.forward(part)[k]
    normal, tangent = rng.normal(size=3), here[:3, 2]
    normal -= normal @ tangent * tangent
    normal /= np.linalg.norm(normal)
    away = robot.radii[k] + (MARGIN + apart) * robot.mean_length
    size = 2.0 * float(rng.uniform(0.1, 0.4)) * q[k, 2] * np.array(SIZES.get(kind, (1.0, 1.0, 1.0)))
    turn = least_rotation(normal) @ about_z(rng.uniform(0.0, 2.0 * np.pi))[:3, :3]
    if kind == "edge":
        turn = turn @ Rotation.from_euler("x", rng.uniform(0.6, 0.9)).as_matrix()
    obstacle = solids.beside("box" if kind == "edge" else kind, here[:3, 3], normal, away, size, turn)
    return sn.Problem(robot, targets_at(robot, q, rng), [obstacle]), q


def beside_obstacles(rng: Generator) -> sn.Solution:
    """The body is near obstacles of any kind, and touches none."""
    return answer(touching(str(rng.choice(OBSTACLES)), rng, apart=float(10.0 ** rng.uniform(-4.0, -1.0))))


def at_obstacles(rng: Generator) -> sn.Solution:
    """The body touches an obstacle of any kind, unless the solve moves it away from there."""
    return answer(touching(str(rng.choice(OBSTACLES)), rng))


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
    return solved_near(thin.changed(radius=0.5 * max(1e-6 * size, least - gap * thin.mean_length)), q, rng)


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


def preferred(shape: str, rng: Generator) -> tuple[sn.Solution, sn.Preferences, Floats]:
    """Draw an answer near a start, which is preferred, and so are small bends; and what is preferred; and the start."""
    robot = random_robot(rng, lines=True)
    robot = robot.changed(segments=[each.changed(max_bend=3.5) for each in robot.segments])
    low, high = robot.limits[:, :2].T
    ways = np.array([direction(rng)[:2] for _ in range(len(robot))])
    q = np.column_stack([ways, low + rng.uniform(0.2, 0.8, len(robot)) * (high - low)])
    q[:, :2] *= rng.uniform(*SHAPES[shape], (len(robot), 1)) / np.linalg.norm(q[:, :2], axis=1, keepdims=True)
    asked = q + 0.02 * rng.normal(size=q.shape) * robot.limits[:, [5, 5, 6]]
    prefer = sn.Preferences(start=1.0, bends=float(rng.choice([0.0, 0.01])))
    solver = sn.Solver(robot, tolerance=sn.Tolerance(1e-9 * robot.mean_length, 1e-9), prefer=prefer, routes=False)
    return solver.solve(targets_at(robot, asked, rng), q), prefer, q


def loaded(rng: Generator) -> sn.answer.Equilibrium:
    """Draw a shape under load: of a robot of 1 to 3 elastic segments, in gravity, with a payload and a force."""
    rod = sn.Stiffness(bend=1.0, twist=rng.uniform(0.5, 1.5), stretch=10.0 ** rng.uniform(1.0, 3.0))
    segments = [sn.Segment((0.3, 0.6), radius=0.01)] * int(rng.integers(1, 4))
    carried = sn.Payload(rng.uniform(0.01, 0.1), 0.02 * rng.normal(size=3))
    robot = sn.Robot(segments, stiffness=rod, mass=0.3, arcs=4, gravity=3.0 * rng.normal(size=3), payload=carried)
    loads = [sn.Force(0.5 * rng.normal(size=3), 0.1 * rng.normal(size=3), position=0.05 * rng.normal(size=3))]
    return robot.shape(random_shape(robot, rng), loads)


Tangent = dict[Parameter, Floats]
"""How fast each group of parameters moves, as `Derivative.jvp` takes it."""

SHARES = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7)
"""How far parameters move: rad, and mean lengths of the robot. The step that agrees best counts: a large one leaves the
neighbourhood in which the answer is smooth, a small one drowns in rounding."""


def random_tangent(found: sn.Solution, rng: Generator) -> Tangent:
    """Let all parameters move at once: by rad, and by mean lengths of the robot."""
    return tangent(found, lambda *size: rng.normal(size=size))


def tangent(found: sn.Solution, draw: Callable[..., Floats]) -> Tangent:
    """Return the motion of all parameters whose numbers, rad and mean lengths of the robot, are drawn."""
    robot, problem = found.problem.robot, found.problem
    size, n = robot.mean_length, len(robot)
    twist = np.array([1.0, 1.0, 1.0, size, size, size])
    target = []
    for each in problem.targets:
        turns = each.direction is not None or each.rotation is not None
        target += [scale * draw(3) for scale in [size] * (each.position is not None) + [1.0] * turns]
    return {
        "target": np.concatenate(target),
        "base": twist * draw(6),
        "tool": twist * draw(6),
        "lengths": size * draw(n),
        "bends": draw(n),
        "curvatures": draw(n) / size,
        "radii": np.array(robot.radii) * draw(n),
        "tendons": size * draw(len(circles_of(robot))),
        "actuators": _of_circles(robot, size * draw(n, 3, 2)),
        "obstacles": np.tile(twist, len(problem.scene)) * draw(6 * len(problem.scene)),
        "initial": np.tile([1.0, 1.0, size], n) * draw(3 * n) * (robot.limits[:, [5, 5, 6]].ravel() > 0.0),
    }


def _of_circles(robot: sn.Robot, ends: Floats) -> Floats:
    """Let the limits of all lines of a circle move alike: those of the tendons and of the chambers of each segment."""
    kinds = ("tendon", "chamber", "stage", "linear")
    return np.ravel([ends[each.segment - 1, kinds.index(each.kind)] for each in robot.actuators])


def _shifted(pose: Floats, twist: Floats) -> Floats:
    """The pose (4, 4) that is turned, and shifted, apart."""
    new = pose.copy()
    new[:3, :3] = Rotation.from_rotvec(twist[:3]).as_matrix() @ pose[:3, :3]
    new[:3, 3] += twist[3:]
    return new


def _moved(obstacle: Obstacle, twist: Floats) -> Obstacle:
    """The obstacle, turned about its own place, and moved."""
    names = [name for name in ("start", "end", "center", "point") if hasattr(obstacle, name)]
    place = np.mean([getattr(obstacle, name) for name in names], axis=0) if names else np.zeros(3)
    about = _shifted(np.eye(4), twist)
    about[:3, 3] += place - about[:3, :3] @ place
    return moved(obstacle, about)


def _segment(robot: sn.Robot, k: int, way: Tangent, h: float) -> sn.Segment:
    own, ways = robot.segments[k], (way["lengths"], way["bends"], way["curvatures"], way["radii"])
    longer, bend, curvature, thicker = (h * float(each[k]) for each in ways)
    low, high = own.length
    length = low + longer if low == high else (low + longer, high + longer)
    changed = own.changed(length=length, max_bend=own.max_bend + bend, radius=own.radius + thicker)
    if np.isfinite(own.max_curvature):
        changed = changed.changed(max_curvature=own.max_curvature + curvature)
    lines: Any
    for kind, lines in (("tendons", own.tendons), ("chambers", own.chambers)):
        if lines is None:
            continue
        number = [(kind, k) == each[:2] for each in circles_of(robot)].index(True)
        lines = lines.changed(radius=lines.radius + h * way["tendons"][number])  # noqa: PLW2901
        mine = [i for i, each in enumerate(robot.actuators) if each.segment == k + 1 and f"{each.kind}s" == kind]
        key = "displacement" if kind == "tendons" else "length"
        limits = np.asarray(getattr(lines, key))
        if np.isfinite(limits).all():
            lines = lines.changed(**{key: tuple(limits + h * way["actuators"][2 * mine[0] : 2 * mine[0] + 2])})  # noqa: PLW2901
        own_kind: Any = {kind: lines}
        changed = changed.changed(**own_kind)
    return changed


def _targets(found: sn.Solution, way: Tangent, h: float) -> list[sn.Target]:
    listed, at = [], 0
    for own in found.problem.targets:
        position, axis, matrix = own.position, own.direction, own.rotation
        if position is not None:
            position, at = position + h * way["target"][at : at + 3], at + 3
        if axis is not None or matrix is not None:
            turn, at = Rotation.from_rotvec(h * way["target"][at : at + 3]).as_matrix(), at + 3
            axis, matrix = (None if each is None else turn @ each for each in (axis, matrix))
        listed.append(sn.Target(position, direction=axis, rotation=matrix, segment=own.segment))
    return listed


def question(found: sn.Solution, way: Tangent, h: float) -> Question:
    """Return what was asked, after the parameters have moved by `h` times a tangent; those that it lacks stay."""
    way = tangent(found, lambda *size: np.zeros(size)) | way
    robot, scene = found.problem.robot, list(found.problem.scene.obstacles)
    base, tool = _shifted(robot.base, h * way["base"]), _shifted(robot.tool, h * way["tool"])
    segments = [_segment(robot, k, way, h) for k in range(len(robot))]
    changed = robot.changed(segments=segments, base=base, tool=tool)
    scene = [_moved(each, h * way["obstacles"][6 * i : 6 * i + 6]) for i, each in enumerate(scene)]
    q, fixed = found.q + h * way["initial"].reshape(-1, 3), robot.limits[:, LENGTH_SCALE] == 0.0
    q[fixed, 2] += h * way["lengths"][fixed]
    return sn.Problem(changed, _targets(found, way, h), scene, found.problem.tolerance), q


def again(found: sn.Solution, way: Tangent, h: float) -> Floats | None:
    """Solve what was asked after the parameters have moved; nothing where that is impossible or fails."""
    try:
        again = answer(question(found, way, h))
    except sn.InputError:
        return None
    return again.q if again.solved else None


def minimum_again(found: sn.Solution, way: Tangent, h: float) -> Floats | None:
    """Find the minimum of what is preferred after the parameters have moved, from where it was.

    Near straight shapes minima curve: they are compared by two steps.
    """
    wish, near = found._wish(), found.derivative().configuration
    if wish is None or wish.reference is None:
        return None
    problem, initial = question(found, way, h)
    begin, reference = near + initial - found.q, wish.reference + initial - found.q
    moved = derivative_of(problem, begin, "target", True, wish._replace(reference=reference))
    return moved.configuration if moved.regular else None


def least_gaps(problem: sn.Problem, q: Floats) -> Floats:
    """Least distances (m,) of bodies (m, n, 3) from the obstacles, densely sampled and then refined.

    Each segment is refined by itself: the nearest place may be just before the end of one.
    """
    robot, scene = problem.robot, problem.scene
    m, n = q.shape[:2]
    width, shares = 1.0 / 400.0, np.tile(np.linspace(0.0, 1.0, 401), (m, n, 1))
    for _ in range(4):
        parts = np.repeat(np.repeat(q[:, None, None], n, axis=1), shares.shape[2], axis=2)
        for k in range(n):
            parts[:, k, :, k] *= shares[:, k, :, None]
        poses = robot.forward(parts.reshape(-1, n, 3)).reshape(*parts.shape[:3], n, 4, 4)
        places = np.stack([poses[:, k, :, k, :3, 3] for k in range(n)], axis=1)
        table = scene.distance(places.reshape(-1, 3)).reshape(places.shape[:3]) - np.array(robot.radii)[:, None]
        middle = np.take_along_axis(shares, table.argmin(axis=2)[..., None], axis=2)
        shares, width = np.clip(middle + width * np.linspace(-1.0, 1.0, 41), 0.0, 1.0), width / 20.0
    return np.asarray(table.min(axis=(1, 2)))


SIDES, TWO_STEPS = {1.0: 0.5, -1.0: -0.5}, {0.5: 4.0 / 3.0, -0.5: -4.0 / 3.0, 1.0: -1.0 / 6.0, -1.0: 1.0 / 6.0}
"""Weights of differences at shares of a step: central ones, and those of two steps, for what curves."""


def difference(at: Callable[[float], Floats | None], h: float, weights: Mapping[float, float]) -> Floats:
    """Return the difference of what is found at shares of a step, over the step; NaN where nothing is found at one."""
    total = np.zeros(())
    for share, weight in weights.items():
        there = at(share * h)
        if there is None:
            return np.full((), np.nan)
        total = total + weight * there
    return total / h


Again = Callable[[sn.Solution, Tangent, float], Floats | None]
"""From an answer, a tangent and a step along it to what is found there; nothing where that fails."""


def agreement(
    found: sn.Solution, motion: Floats, way: Tangent, weights: Mapping[float, float] = SIDES, at: Again = again
) -> float:
    """Compare a derivative (n, 3) along a tangent with differences, by default central ones of answers.

    Returns the least difference, relative to the larger; infinite where none was found.
    """
    scale, best = np.array([1.0, 1.0, found.problem.robot.mean_length]), np.inf
    for h in SHARES:
        change = difference(partial(at, found, way), h, weights)
        if np.isnan(change).any():
            continue
        size = max(float(np.linalg.norm(change / scale)), float(np.linalg.norm(motion / scale)), 1e-3)
        best = min(best, float(np.linalg.norm((change - motion) / scale)) / size)
        if best < 1e-8:
            break
    return best


ALL = tuple(GROUPS)
"""All groups of parameters."""


SECTION = "derivatives against central differences of answers that are solved again from them"
WRONG = 1e-6
"""Relative difference from which on a derivative that was called regular is wrong."""

MANY = 153_000
"""Answers that would be asked for if each draw made as many as it can; 100,000 are left."""

BESIDE = 16
"""Answers near each one that is drawn, whose targets are moved a little."""

DEAR = 6
"""The same where to compare one takes long."""

TOLD = 10
"""Most wrong ones that are named: the draw, and which of the answers beside it."""

AWAY = 0.01
"""How far their targets are moved: rad, and mean lengths of the robot."""


def measure(plan: Plan, family: str) -> Iterator[Line]:
    """Lines of a family: the share of regular answers, wrong ones among them, the worst of those that agree."""
    count, number = plan.count(MANY // (len(COMPARED) * (BESIDE + 1)), 12), list(COMPARED).index(family)
    total = regular = 0
    worst, wrong = 0.0, list[str]()
    for i in range(count):
        for j, each in enumerate(COMPARED[family](plan.rng(83, number, i))):
            total, regular = total + 1, regular + (each is not None)
            if each is not None and each <= WRONG:
                worst = max(worst, each)
            elif each is not None:
                wrong.append(f"{i}.{j}")
    yield Line(SECTION, f"{family}: regular", 100.0 * regular / max(total, 1), "%", note=f"of {total:,} answers")
    told = ", ".join(wrong[:TOLD])
    yield Line(SECTION, f"{family}: wrong among those", float(len(wrong)), "", Goal(0.0, correctness=True), note=told)
    yield Line(SECTION, f"{family}: largest difference of the others", worst, "", Goal(WRONG))


def _answers(family: str, rng: Generator) -> Iterator[float | None]:
    """Of answers, along a motion of all parameters at once the first, of the target those beside it."""
    for j, found in enumerate(_some(family, rng)):
        way = random_tangent(found, rng)
        if j:  # for the others targets alone, which needs no other robot
            way = {"target": way["target"]}
        derivative = found.derivative(ALL if j == 0 else "target")
        yield agreement(found, derivative.jvp(way), way) if derivative.regular else None


def _clearances(rng: Generator) -> Iterator[float | None]:
    """Of clearances beside obstacles, along a motion of all parameters at once."""
    for found in islice(_some("beside obstacles", rng), DEAR):
        derivative, way = found.derivative(ALL), random_tangent(found, rng)
        assert derivative.clearance is not None
        change = float(np.sum([derivative.clearance[name] @ way[name] for name in ALL]))
        motion = derivative.jvp(way)
        if not derivative.regular or not np.isfinite(change):
            yield None
            continue
        errors = [abs(difference(partial(_gap_at, found, way, motion), h, SIDES)[0] - change) for h in SHARES]
        yield float(min(errors)) / max(abs(change), found.problem.robot.mean_length)


def _gap_at(found: sn.Solution, way: Tangent, motion: Floats, h: float) -> Floats:
    return least_gaps(question(found, way, h)[0], (found.q + h * motion)[None])


def _preferred(rng: Generator) -> Iterator[float | None]:
    """Of answers that preferences have chosen, along motions of all parameters at once."""
    for shape in SHAPES:
        found, _, _ = preferred(shape, rng)
        if not found.solved:
            continue
        derivative = found.derivative(ALL)
        for _ in range(DEAR // len(SHAPES)):
            way = random_tangent(found, rng)
            motion = derivative.jvp(way)
            yield agreement(found, motion, way, TWO_STEPS, minimum_again) if derivative.regular else None


def _loaded(rng: Generator) -> Iterator[float | None]:
    """Of shapes under load: one parameter each, against shapes that are found anew, with two steps."""
    try:
        found = loaded(rng)
    except (sn.InputError, sn.NotSolvedError):
        return
    groups: tuple[LoadParameter, ...] = "loads", "payload", "gravity", "stiffness", "base", "q"
    derivative = found.derivative(groups)
    columns = [(name, i) for name in groups for i in range(len(derivative.labels(name)))]
    for at in rng.permutation(len(columns))[: BESIDE + 1]:
        if not derivative.regular:
            yield None
            continue
        name, i = columns[at]
        column = list(LOADS[name](found.question))[i]
        change = difference(partial(_states_at, column), 1e-3, TWO_STEPS) / column.scale
        scale = np.abs(derivative.states[name]).max()
        yield float(np.abs(derivative.states[name][..., i] - change).max() / scale)


def _states_at(column: Any, h: float) -> Floats:
    return find_equilibrium(column.changed(h * column.scale)).states


def _some(family: str, rng: Generator) -> Iterator[sn.Solution]:
    """An answer of a family, and others beside it."""
    first = draw(family, rng)
    if first is None:
        return
    yield first
    solver = solver_for(first.problem)
    for _ in range(BESIDE):
        q = first.q + AWAY * rng.normal(size=first.q.shape) * first.problem.robot.limits[:, [5, 5, 6]]
        if first.problem.robot.excess(q) > 0.0:
            continue
        targets = [_at(first, i, q) for i in range(len(first.problem.targets))]
        found = solver.solve(targets, q)
        if found.solved:
            yield found


def _at(found: sn.Solution, i: int, q: Floats) -> sn.Target:
    """What a target asks for, where a configuration has it."""
    target, robot = found.problem.targets[i], found.problem.robot
    last = target.segment is None or target.segment == len(robot)
    pose = robot.tip(q) if last else robot.forward(q)[(target.segment or 0) - 1]
    return sn.Target(
        None if target.position is None else pose[:3, 3],
        direction=None if target.direction is None else pose[:3, 2],
        rotation=None if target.rotation is None else pose[:3, :3],
        segment=target.segment,
    )


COMPARED: dict[str, Callable[[Generator], Iterator[float | None]]] = {
    **{family: partial(_answers, family) for family in FAMILIES},
    "clearances": _clearances,
    "preferred": _preferred,
    "under load": _loaded,
}
"""What is derived and compared with differences: relative differences, none where a derivative is not regular."""


COSTS = "time of a derivative beyond the solve (5 segments with tendons, thread time)"
SPHERES = 40
REPEATS = 20


def measure_costs(plan: Plan) -> Iterator[Line]:
    """A line for what is asked, in free space and among spheres."""
    tendons = sn.Tendons(3, 3.0, displacement=(-9.0, 9.0))
    robot, rng = sn.Robot.uniform(5, (80.0, 120.0), max_bend=2.0, radius=4.0, tendons=tendons), plan.rng(81)
    ways = rng.normal(size=(SPHERES, 3))
    ways[:, 2] = np.abs(ways[:, 2])
    spheres = [sn.Sphere(520.0 * way / np.linalg.norm(way) + (0.0, 0.0, 80.0), 60.0) for way in ways]
    for scene, where, more in (([], "", 0.0), (spheres, f" among {SPHERES} spheres", 10e-6)):
        solver, rng, answers = sn.Solver(robot, scene), plan.rng(82), list[sn.Solution]()
        while len(answers) < plan.count(500, 20):
            place = 200.0 * rng.normal(), 200.0 * rng.normal(), 350.0 + 30.0 * rng.normal()
            answers += [found for found in [solver.solve(sn.Target(place))] if found.solved]
        for wrt, what, goal in ((("target",), "by the target", 5e-6), (ALL, "by everything", 20e-6)):
            times = Times.of(list(_times(answers, wrt)))
            yield Line(COSTS, f"{what}{where}", times.median, "us", Goal(goal + more), times)


def _times(answers: Sequence[sn.Solution], wrt: tuple[Parameter, ...]) -> Iterator[float]:
    for each in answers[:3]:  # warm
        each.derivative(wrt)
    for each in answers:
        yield timed(lambda own=each: [own.derivative(wrt) for _ in range(REPEATS)], clock=thread_time)[1] / REPEATS


PARTS: dict[str, Part] = {
    "costs": measure_costs,
    **{f"agreement {family}": partial(measure, family=family) for family in COMPARED},
}
"""What is measured, in order: of agreement each family is one part, so that a run goes on after the last."""
