"""Robots that bend under gravity and payload: solves, plans and ticks, each claim judged of the loaded body.

The shape of a judged configuration is its equilibrium, looked for anew from the shape without load; that this is at
rest is held against Cosserat rods elsewhere (`benchmarks.real`). All else is NumPy's.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from benchmarks.judges import self_collision
from benchmarks.judges.bodies import measured_body, needed_body, self_body
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import ROUNDING, target_errors, within_limits
from benchmarks.wild import audit
from benchmarks.wild.motions import Judged, between, overlapping
from benchmarks.wild.obstacles import scene_about
from benchmarks.wild.robots import shapes_of
from benchmarks.wild.trials import GRACE, IMPOSSIBLE
from benchmarks.wild.worlds import CLEAR
from sinuous import InputError, Motion, Payload, Solution, Solver, Stiffness, Tendons, plan, pose
from sinuous.base.checks import Floats
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from sinuous.statics.rest import bodies_at

UNITS = (-3.0, 3.0)
"""Powers of ten between which a segment is long."""

SHAPES, DRAWS = 6, 20
"""Hidden shapes of a robot, and draws of a robot before one is found that stands under its load."""

LOADED = (-2.0, 0.3)
"""Powers of ten of weight times the square of the length, of the stiffness EI."""

BUDGET, TICKS, TICK = 0.2, 6, 0.02
"""Seconds of a solve or a plan; ticks of a control loop; seconds of each."""

SAMPLES, TICK_SAMPLES = 100, 10
"""Shapes of a motion and of a tick that are looked at."""


@dataclass(frozen=True)
class Hanging:
    """A robot under load among obstacles, and drives (m, n, 3) whose loaded shapes are clear."""

    robot: Robot
    scene: Scene
    hidden: Floats
    targets: list[Target]


def make(seed: int, number: int) -> Hanging:
    """Make robot `number` of a seed, its obstacles, and a target for each hidden shape."""
    rng = np.random.default_rng([seed, 23, number])
    while True:
        robot = _robot(10.0 ** rng.uniform(*UNITS), rng)
        q = _standing(robot, shapes_of(robot, SHAPES, rng))
        if len(q) == 0:
            continue
        body, arcs = bodies_at(robot, q)
        scene = scene_about(body, arcs, rng)
        clear = self_collision.look(self_body(body), arcs, 0.0).least > 0.0
        if len(scene):
            clear &= Clearances(needed_body(body), scene).least(arcs, 0.0) > CLEAR * robot.mean_length
        if clear.any():
            return Hanging(robot, scene, q[clear], _asked(robot, q[clear], rng))


def solved(seed: int, number: int) -> Judged:
    """Solve for the tip of each hidden shape."""
    world = make(seed, number)
    found = [Solver(world.robot, world.scene, time=BUDGET).solve(target) for target in world.targets]
    wrong = (_false(each, target) for each, target in zip(found, world.targets, strict=True))
    return Judged(any(each.solved for each in found), next(filter(None, wrong), ""))


def planned(seed: int, number: int) -> Judged:
    """Plan from one hidden shape to another, and look at the whole motion where it is called proved."""
    world = make(seed, number)
    motion = plan(world.robot, world.hidden[0], world.hidden[-1], world.scene, time=BUDGET)
    if len(motion.q) < 2 or motion.between != "proved":
        return Judged(False, "")
    return Judged(True, _refuted(world.robot, world.scene, _along(motion)))


def ticks(seed: int, number: int) -> Judged:
    """Follow a target tick by tick while a ball moves towards the body, and look at each proved step."""
    world, rng = make(seed, number), np.random.default_rng([seed, 24, number])
    robot, unit = world.robot, world.robot.mean_length
    far = robot.base[:3, 3] + 5.0 * unit
    scene = Scene([Sphere(far, 0.1 * unit, name="ball"), *world.scene.obstacles])
    solver, q, proved = Solver(robot, scene, time=0.01), world.hidden[0], False
    rates = Rates(rng.uniform(0.5, 5.0), unit * rng.uniform(0.1, 3.0))
    for _ in range(TICKS):
        places = robot.shape(q).backbone(5)
        place = places[rng.integers(len(places))] + unit * rng.uniform(0.1, 0.6) * rng.normal(size=3)
        scene.move("ball", position=place - far)
        step = solver.step(q, dt=TICK, target=world.targets[-1], rates=rates)
        if step.proved:
            way = between(step.initial, step.q, TICK_SAMPLES)
            if false := _refuted(robot, Scene.of(step.scene), np.concatenate([way, step.q[None]])):
                return Judged(True, false)
        q, proved = step.q, proved or step.proved
    return Judged(proved, "")


KINDS = {
    "solved under load": solved,
    "planned under load": planned,
    "ticks under load": ticks,
}


def _robot(unit: float, rng: Generator) -> Robot:
    """A robot of 1 to 5 segments of 1 to 4 arcs, whose weight bends it a little or much."""
    count, arcs = int(rng.integers(1, 6)), int(rng.integers(1, 5))
    longest = count * 1.2 * unit
    gravity, mass = 9.81 * rng.normal(size=3), 10.0 ** rng.uniform(-3.0, 3.0)
    carried = mass * longest * rng.uniform(0.0, 1.0) if rng.random() < 0.6 else 0.0
    weight = float(np.linalg.norm(gravity)) * (mass * longest + carried)
    bend = weight * longest**2 / 10.0 ** rng.uniform(*LOADED)
    twist = bend * rng.uniform(0.6, 1.0) if rng.random() < 0.5 else None
    stretch = bend / unit**2 * 10.0 ** rng.uniform(2.0, 4.0) if rng.random() < 0.3 else None
    stiffness, driven = Stiffness(bend, twist, stretch), rng.random() < 0.3
    radius = unit * 10.0 ** rng.uniform(-2.5, -1.0)
    segments: list[Segment] = []
    for _ in range(count):
        low, gives = unit * rng.choice([1.2, rng.uniform(0.6, 1.1)]), rng.random() < 0.85 or not segments
        tendons = Tendons(3, 0.08 * unit) if driven and gives else None
        segments.append(
            Segment(
                (low, 1.2 * unit),
                rng.uniform(0.5, 3.0),
                radius=radius,
                tendons=tendons,
                stiffness=stiffness if gives else None,
                mass=mass,
                arcs=arcs if gives else 1,
            )
        )
    robot = Robot(
        segments,
        base=pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)),
        gravity=gravity,
        payload=Payload(carried) if carried > 0.0 else None,
    )
    return audit.demanding(robot, rng) if rng.random() < 0.3 else robot


def _standing(robot: Robot, drives: Floats) -> Floats:
    """Those drives (m, n, 3) at which the loaded body is at rest, and stays there."""
    kept = []
    for q in drives:
        try:
            shape = robot.shape(q)
        except InputError:
            continue
        if shape.stable:
            kept.append(q)
    return np.array(kept).reshape(-1, len(robot), 3)


def _asked(robot: Robot, drives: Floats, rng: Generator) -> list[Target]:
    """The tips of loaded shapes: a position, a direction beside it, or a whole pose."""
    kind, tips = int(rng.integers(3)), [robot.shape(q).tip for q in drives]
    return [
        Target(
            tip[:3, 3],
            direction=tip[:3, 2] if kind == 1 else None,
            rotation=tip[:3, :3] if kind == 2 else None,
        )
        for tip in tips
    ]


def _false(found: Solution, target: Target) -> str:
    """Say what is wrong with an answer; nothing, where it claims nothing."""
    robot, scene = found.problem.robot, Scene.of(found.problem.scene)
    if found.status in IMPOSSIBLE:
        return str(found.status)
    if not found.solved:
        return ""
    shape, slack, tolerance = robot.shape(found.q), GRACE * robot.mean_length, found.problem.tolerance
    body, arcs = shape.body, shape.arcs[None]
    position, angle = (float(error[0]) for error in target_errors(body, [target], arcs))
    if position > (tolerance.position or 0.0) + ROUNDING * robot.mean_length or angle > tolerance.angle + ROUNDING:
        return "target missed"
    if len(scene) and found.clearance is not None:
        gap = float(Clearances(measured_body(body), scene).least(arcs, max(0.0, found.clearance))[0])
        if found.clearance > gap + slack:
            return "clearance overstated"
    return _refuted(robot, scene, found.q[None])


def _along(motion: Motion) -> Floats:
    """Drives (k, n, 3) along a motion, about `SAMPLES` of them, and its last."""
    count = max(1, math.ceil(SAMPLES / (len(motion.q) - 1)))
    ways = [between(one, other, count) for one, other in zip(motion.q[:-1], motion.q[1:], strict=True)]
    return np.concatenate([*ways, motion.q[-1:]])


def _refuted(robot: Robot, scene: Scene, q: Floats) -> str:
    """Say what is wrong with drives (m, n, 3) or with the loaded body there; or nothing."""
    if not within_limits(robot, q).all():
        return "limits"
    if len(_standing(robot, q)) < len(q):
        return "no equilibrium"
    body, arcs = bodies_at(robot, q)
    return overlapping(body, scene, arcs, GRACE * robot.mean_length)
