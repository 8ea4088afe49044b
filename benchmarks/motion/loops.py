"""Control loops at 1 kHz: how long a step takes, and whether limits, rates, obstacles and the body itself are kept."""

from collections.abc import Callable, Iterator
from time import perf_counter
from typing import NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges import self_collision
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import within_limits
from sinuous.base.checks import Floats

SEGMENTS, SPHERES, TICKS, LOOPS, DT = 5, 40, 1000, 12, 1e-3
REPEATS = 5
"""How often every tick is taken: the answer is the same, and the least of its times is the one without others' work."""

RATES = sn.Rates(bend=1.0, length=20.0)
LOOKED_AT = 10
"""Ticks between two configurations that are judged for obstacles and the body itself."""

GRACE = 1e-9
"""What rounding may make of a rate, relative to it."""

STEP = (
    "loops of 1,000 ticks at 1 kHz, 5 segments, 40 spheres: one Solver.step from Python, with its proof; "
    "of every tick the least of 5 times"
)
WRONG = "loops: ticks in which a judge finds a limit, a rate, an obstacle or the body itself violated"
SINGULAR = "steps from singular shapes (straight, one arc): largest motion, of the motion asked for"
ERROR = "steps from singular shapes: largest error of the twist, of the twist asked for"


class Loop(NamedTuple):
    """What came of a loop: seconds of every tick, ticks that were held back, and what is wrong."""

    seconds: list[float]
    held_back: int
    wrong: int


def measure(plan: Plan) -> Iterator[Line]:
    """Drive loops among spheres with twists that change five times."""
    loops = [drive(1000 * plan.seed + i) for i in range(plan.count(LOOPS, 1))]
    times = Times.of([second for loop in loops for second in loop.seconds])
    held = sum(loop.held_back for loop in loops)
    yield Line(STEP, "median", times.median, "us", None, times, note=f"{held} of {times.count} were held back")
    yield Line(STEP, "p99", times.p99, "us", Goal(100e-6), times, noise=1.0)
    yield Line(WRONG, "ticks", sum(loop.wrong for loop in loops), "", Goal(0, correctness=True))


def place(rng: np.random.Generator) -> tuple[sn.Robot, Floats, sn.Scene]:
    """A robot, a configuration, and spheres that leave it a little room."""
    robot = sn.Robot.uniform(SEGMENTS, (45, 70), max_bend=2.4, radius=4)
    q = np.column_stack([rng.normal(0.0, 0.35, (SEGMENTS, 2)), rng.uniform(48.0, 67.0, SEGMENTS)])
    body = robot.backbone(q, 30)
    spheres: list[sn.Sphere] = []
    while len(spheres) < SPHERES:
        center, radius = rng.normal((0.0, 0.0, 150.0), 130.0), float(rng.uniform(5.0, 25.0))
        if np.linalg.norm(body - center, axis=1).min() > radius + 7.0:
            spheres.append(sn.Sphere(center, radius))
    return robot, q, sn.Scene(spheres)


def drive(seed: int) -> Loop:
    """Drive one loop, and judge it."""
    rng = np.random.default_rng(seed)
    robot, q, scene = place(rng)
    ik, knots, seconds, held = sn.Solver(robot, scene, routes=False), [q], [], 0
    ik.step(q, np.zeros(6), DT, rates=RATES)
    twist = np.zeros(6)
    for tick in range(TICKS):
        if tick % (TICKS // 5) == 0:
            twist = rng.normal(0.0, (0.3, 0.3, 0.3, 100.0, 100.0, 100.0))
        spent = []
        for _ in range(REPEATS):
            began = perf_counter()
            step = ik.step(q, twist, DT, rates=RATES)
            spent.append(perf_counter() - began)
        seconds.append(min(spent))
        held += step.status != "reached"
        q = step.q
        knots.append(q)
    return Loop(seconds, held, wrong_in(robot, scene, np.array(knots)))


def wrong_in(robot: sn.Robot, scene: sn.Scene, knots: Floats) -> int:
    """In how many ticks something is violated; by code that shares nothing with the kernels."""
    change = np.diff(knots, axis=0) / DT
    fast = np.hypot(change[..., 0], change[..., 1]).max(axis=1) > 1.0 * (1.0 + GRACE)
    fast |= np.abs(change[..., 2]).max(axis=1) > 20.0 * (1.0 + GRACE)
    looked = knots[::LOOKED_AT]
    touching = Clearances(robot, scene).least(looked, 0.0) < 0.0
    folded = self_collision.look(robot, looked, 0.0).least < 0.0
    return int(fast.sum() + (~within_limits(robot, knots)).sum() + (touching | folded).sum())


def singular(plan: Plan) -> Iterator[Line]:
    """Ask for twists at singular shapes and very near to them."""
    rng = np.random.default_rng(plan.seed)
    robot = sn.Robot.uniform(SEGMENTS, (45, 70), max_bend=2.4, radius=4)
    ik, unit = sn.Solver(robot), robot.mean_length
    scales, metric = np.array([1.0] * 3 + [1.0 / unit] * 3), np.array([1.0, 1.0, unit / SEGMENTS])
    motion = error = 0.0
    for bend in (0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0):
        for _ in range(plan.count(100, 10)):
            twist = rng.normal(0.0, 0.2, 6) / scales
            step = ik.step([[bend, 0.0, 57.5]] * SEGMENTS, twist, DT)
            asked = float(np.linalg.norm(scales * twist))
            motion = max(motion, float(np.linalg.norm(step.velocity / metric)) / asked)
            error = max(error, float(np.linalg.norm(scales * (step.twist - twist))) / asked)
    yield Line(SINGULAR, "rad and segments, of rad and robots", motion, "", Goal(101.0))
    yield Line(ERROR, "share", error, "", Goal(1.0))


PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {"control loops": measure, "singular shapes": singular}
