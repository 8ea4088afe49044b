"""Arms of all sorts with joints before the segments, or with joints alone: solved, planned and stepped, and judged."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges import links
from benchmarks.judges.judge import IMPOSSIBLE, ROUNDING, errors_at
from benchmarks.judges.motions import samples
from benchmarks.problems import in_ball
from benchmarks.wild import worlds
from benchmarks.wild.motions import TICK, TICK_SAMPLES, TICKS, Judged
from benchmarks.wild.obstacles import scene_beside
from benchmarks.wild.robots import draw_segments, draw_shapes
from benchmarks.wild.trials import CLEARANCE, LIMITS, OVERLAP, SELF_CLEARANCE, SELF_OVERLAP, TARGET
from benchmarks.wild.worlds import CLEAR, TOLERANCES, World
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint, Prismatic, Revolute
from sinuous.model.segment import Segment

SCALES = (-4.0, 3.0)
"""Powers of ten between which a segment is long."""

SHAPES = 12
"""Hidden solutions of one world, at most."""

MOST_JOINTS, MOST_SEGMENTS = 8, 6

PLACES = 97
"""Places along a capsule or a segment where one configuration is looked at."""

BUDGET = 0.3
"""Seconds for a solve, and for a plan."""


def make(seed: int, number: int) -> World:
    """Make world `number` of a seed: its hidden shapes are configurations (m, rows, 3)."""
    rng = np.random.default_rng([seed, 31, number])
    while True:
        unit = 10.0 ** rng.uniform(*SCALES)
        robot = _robot(unit, rng)
        q = _shapes(robot, rng)
        if len(q) == 0:
            continue
        scene = _scene(robot, links.body_places(robot, q), rng)
        if len(scene):
            q = q[links.clearances(robot, scene, q, PLACES) > CLEAR * robot.mean_length]
        if len(q):
            break
    position, angle = 10.0 ** rng.uniform(*TOLERANCES, 2)
    return World(robot, scene, sn.Tolerance(position * robot.mean_length, angle), _asked(robot, q, rng), q)


def _scene(robot: sn.Robot, bodies: links.Bodies, rng: Generator) -> sn.Scene:
    if not bodies:
        return sn.Scene()
    points = np.concatenate([points.reshape(-1, 3) for _, points, _ in bodies])
    radii = np.concatenate([np.full(points[..., 0].size, radius) for _, points, radius in bodies])
    return scene_beside(points, radii, robot.mean_length, rng)


def _robot(unit: float, rng: Generator) -> sn.Robot:
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
    segments: list[Segment] = draw_segments(size, unit, rng) if size else []
    return sn.Robot(
        segments,
        joints=joints,
        base=sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)) if rng.random() < 0.7 else None,
        tool=sn.pose(0.5 * unit * in_ball(rng), rotation=rng.normal(size=4)) if rng.random() < 0.3 else None,
    )


def _capsule(unit: float, rng: Generator) -> tuple[Floats, Floats, float]:
    start = 0.1 * unit * in_ball(rng)
    return start, start + unit * rng.uniform(0.0, 0.8) * in_ball(rng), unit * 10.0 ** rng.uniform(-2.5, -0.8)


def _shapes(robot: sn.Robot, rng: Generator) -> Floats:
    """Return configurations (m, rows, 3) that are clear of themselves."""
    low, high = np.array([joint.limits for joint in links.moving(robot.joints)]).T
    arm, count = links.arm_of(robot), 4 * SHAPES
    values = low + (high - low) * rng.random((count, len(low)))
    q = np.zeros((count, 0, 3)) if arm is None else draw_shapes(arm, count, rng.uniform(0.3, 1.0), rng)
    drawn = robot.with_joints(q, values)
    drawn = drawn[links.gaps(robot, drawn) > 0.0][:SHAPES]
    return np.asarray(drawn[links.gaps(robot, drawn, PLACES) > CLEAR * robot.mean_length])


def _ends(robot: sn.Robot, q: Floats) -> Floats:
    """Poses (m, n, 4, 4) of the ends of segments, the last with the tool; (m, 1, 4, 4) where there are none."""
    ends = links.segment_poses(robot, q)[:, 1 if robot.segments else 0 :].copy()
    ends[:, -1] = ends[:, -1] @ robot.tool
    return ends


def _asked(robot: sn.Robot, q: Floats, rng: Generator) -> list[list[sn.Target]]:
    kind = str(rng.choice(list(worlds.KINDS), p=list(worlds.KINDS.values())))
    questions = []
    for tip in _ends(robot, q)[:, -1]:
        place = None if kind.endswith("alone") else tip[:3, 3]
        direction = tip[:3, 2] if kind.startswith("direction") else None
        rotation = tip[:3, :3] if kind.startswith("rotation") else None
        questions.append([sn.Target(place, direction=direction, rotation=rotation)])
    return questions


def solved(seed: int, number: int) -> Judged:
    """Solve all problems of a world; nothing that is said of any may be false."""
    world = make(seed, number)
    robot, right = world.robot, 0
    solver = sn.Solver(robot, world.scene, tolerance=world.tolerance, time=BUDGET)
    for i, targets in enumerate(world.targets):
        found = solver.solve(targets)
        if found.status in IMPOSSIBLE:
            return Judged(True, f"{i} {found.status}")
        if not found.solved:
            continue
        right += 1
        if false := _false(world, found, i):
            return Judged(True, f"{i} {false}")
        if not found.verify().ok:
            return Judged(True, f"{i} not verified")
    return Judged(right == len(world.targets), "")


def _false(world: World, found: sn.Solution, i: int) -> str:
    """Say what is wrong with a solution of problem `i`; or nothing."""
    robot, q = world.robot, found.configuration[None]
    slack = links.ROUNDING * robot.mean_length
    position, angle = errors_at(_ends(robot, q), world.targets[i])
    near = float(links.clearances(robot, world.scene, q, PLACES)[0])
    said = found.self_clearance or 0.0
    gap = float(links.gaps(robot, q, PLACES, said)[0])
    wrong = {
        TARGET: position[0] > (world.tolerance.position or 0.0) + ROUNDING * robot.longest
        or angle[0] > world.tolerance.angle + ROUNDING,
        LIMITS: not links.keep_limits(robot, q).all(),
        OVERLAP: near < -slack,
        CLEARANCE: (found.clearance or 0.0) > near + slack,
        SELF_OVERLAP: gap < -slack,
        SELF_CLEARANCE: said > gap + slack,
    }
    return next((kind for kind, is_so in wrong.items() if is_so), "")


def planned(seed: int, number: int) -> Judged:
    """Plan from one hidden shape to another, and look at the whole motion."""
    world = make(seed, number)
    if len(world.hidden) < 2:
        return Judged(False, "")
    motion = sn.plan(world.robot, world.hidden[0], world.hidden[-1], world.scene, time=BUDGET)
    if motion.between != "proved" or len(motion.configuration) < 2:
        return Judged(False, str(motion.status) if motion.status in IMPOSSIBLE else "")
    way = samples(motion.configuration, max(4, 200 // (len(motion.configuration) - 1)))
    return Judged(True, links.wrong_among(world.robot, world.scene, way))


def ticks(seed: int, number: int) -> Judged:
    """Follow a target, or a twist, tick by tick while a ball moves, and look at each proved step."""
    world, rng = make(seed, number), np.random.default_rng([seed, 32, number])
    robot, unit, proved = world.robot, world.robot.mean_length, False
    far = robot.base[:3, 3] + 50.0 * robot.longest
    scene = sn.Scene([sn.Sphere(far, 0.1 * unit, name="ball"), *world.scene.obstacles])
    solver = sn.Solver(robot, scene, time=float(rng.choice([1e-3, 1e-2])))
    goal, twist, q = world.targets[-1], rng.normal(size=6) * ([1.0] * 3 + [unit] * 3), world.hidden[0]
    for _ in range(TICKS):
        bodies: Sequence[Any] = links.body_places(robot, q[None]) or [(0, robot.base[None, None, :3, 3], 0.0)]
        _, points, _ = bodies[int(rng.integers(len(bodies)))]
        scene.move("ball", position=points[0, -1] + unit * rng.uniform(0.1, 0.6) * rng.normal(size=3) - far)
        step = solver.step(q, dt=TICK, target=goal) if rng.random() < 0.5 else solver.step(q, twist, TICK)
        if step.proved:
            proved = True
            way = samples(np.stack([q, step.configuration]), TICK_SAMPLES)
            if false := links.wrong_among(robot, sn.Scene.of(step.scene), way):
                return Judged(True, false)
        q = np.array(step.configuration)
    return Judged(proved, "")


KINDS: dict[str, Callable[[int, int], Judged]] = {
    "arms with joints, solved": solved,
    "arms with joints, planned": planned,
    "arms with joints, ticks while an obstacle moves": ticks,
}
