"""Control loops: how long a step takes, and whether limits, rates, obstacles and the body itself are kept.

At 1 kHz twists that change five times drive an arm among spheres. At 100 Hz an arm is asked to stay where its tip is
while a cloud of 50,000 points, a ball, goes through the place of its body and out again: it has to get out of the way.
What is counted as contact is looked at after each tick, by a k-d tree, with the cloud where it was then. The robot
cannot see what comes: where the ball is faster than it may move, they meet.
"""

from collections.abc import Callable, Iterator
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times, timed
from benchmarks.judges.judge import overlap, too_fast, within_limits
from sinuous.base.checks import Floats

SEGMENTS, SPHERES, TICKS, LOOPS, DT = 5, 40, 1000, 12, 1e-3
REPEATS = 5
"""How often every tick is taken: the answer is the same, and the least of its times is the one without others' work."""

BEND, LENGTH = 1.0, 20.0
"""Rates of a loop, rad/s and length unit/s."""

LOOKED_AT = 10
"""Ticks between two configurations that are judged for obstacles and the body itself."""

POINTS, CLOUD_TICKS, CLOUD_LOOPS, CLOUD_DT = 50_000, 300, 4, 1e-2
CLOUD_RATES = sn.Rates(bend=2.0, length=60.0)
BALL, GRAIN, SPEED, MARGIN = 35.0, 1.0, 40.0, 6.0
"""Radius of the ball and of its points; how fast it comes, length unit/s; the clearance that is wished for."""

STEP = (
    "loops of 1,000 ticks at 1 kHz, 5 segments, 40 spheres: one Solver.step from Python, with its proof; "
    "of every tick the least of 5 times"
)
WRONG = "loops: ticks in which a judge finds a limit, a rate, an obstacle or the body itself violated"
MOVED, SEEN = "moved as a whole (Scene.move)", "seen anew (Scene.update)"
WHAT = "loop at 100 Hz, a cloud of 50,000 points comes at the robot, {}: one tick with the update"
CONTACTS = "the same loops: ticks with a contact, by a k-d tree"


class Loop(NamedTuple):
    """What came of a loop: seconds of every tick, ticks that are wrong, and the least clearance, or ticks held back."""

    seconds: list[float]
    wrong: int
    least: float


def arm() -> sn.Robot:
    """Return the robot of all loops."""
    return sn.Robot.uniform(SEGMENTS, (45, 70), max_bend=2.4, radius=4)


def measure(plan: Plan) -> Iterator[Line]:
    """Drive loops among spheres with twists that change five times."""
    loops = [drive(1000 * plan.seed + i) for i in range(plan.count(LOOPS, 1))]
    times = Times.of([second for loop in loops for second in loop.seconds])
    held = sum(loop.least for loop in loops)
    yield Line(STEP, "median", times.median, "us", None, times, note=f"{held:g} of {times.count} were held back")
    yield Line(STEP, "p99", times.p99, "us", Goal(100e-6), times)
    yield Line(WRONG, "ticks", sum(loop.wrong for loop in loops), "", Goal(0, correctness=True))


def place(rng: np.random.Generator) -> tuple[sn.Robot, Floats, sn.Scene]:
    """A robot, a configuration, and spheres that leave it a little room."""
    robot = arm()
    q = np.column_stack([rng.normal(0.0, 0.35, (SEGMENTS, 2)), rng.uniform(48.0, 67.0, SEGMENTS)])
    body = robot.backbone(q, 30)
    spheres: list[sn.Sphere] = []
    while len(spheres) < SPHERES:
        center, radius = rng.normal((0.0, 0.0, 150.0), 130.0), float(rng.uniform(5.0, 25.0))
        if np.linalg.norm(body - center, axis=1).min() > radius + 7.0:
            spheres.append(sn.Sphere(center, radius))
    return robot, q, sn.Scene(spheres)


def stepped(
    solver: sn.Solver, q: Floats, twists: Floats, dt: float, rates: sn.Rates | None = None
) -> tuple[list[float], list[sn.answer.Step]]:
    """Step along twists (T, 6) or (T, 3), each from where the last step ended; return the least time of each, too."""
    seconds, steps = list[float](), list[sn.answer.Step]()
    solver.step(q, np.zeros(twists.shape[1]), dt, rates=rates)  # kernels are loaded
    for twist in twists:
        step, spent = timed(solver.step, q, twist, dt, rates=rates, runs=REPEATS)
        seconds.append(spent)
        steps.append(step)
        q = step.q
    return seconds, steps


def drive(seed: int) -> Loop:
    """Drive one loop, and judge it."""
    rng = np.random.default_rng(seed)
    robot, q, scene = place(rng)
    twists = np.repeat([rng.normal(0.0, (0.3, 0.3, 0.3, 100.0, 100.0, 100.0)) for _ in range(5)], TICKS // 5, axis=0)
    seconds, steps = stepped(sn.Solver(robot, scene, routes=False), q, twists, DT, sn.Rates(BEND, LENGTH))
    knots = np.array([q, *(step.q for step in steps)])
    return Loop(seconds, wrong_ticks(robot, scene, knots), sum(step.status != "reached" for step in steps))


def wrong_ticks(robot: sn.Robot, scene: sn.Scene, knots: Floats) -> int:
    """In how many ticks something is violated; by code that shares nothing with the kernels."""
    fast = sum(too_fast(change[None], DT, BEND, LENGTH) for change in np.diff(knots, axis=0))
    touching = sum(bool(overlap(robot, scene, q[None], 0.0)) for q in knots[::LOOKED_AT])
    return fast + int((~within_limits(robot, knots)).sum()) + touching


def measure_clouds(plan: Plan) -> Iterator[Line]:
    """Drive loops, the cloud once moved as a whole, and once given as new points."""
    contacts, least = 0, np.inf
    for how in (MOVED, SEEN):
        loops = [drive_from_cloud(1000 * plan.seed + i, how) for i in range(plan.count(CLOUD_LOOPS, 1))]
        times = Times.of([second for loop in loops for second in loop.seconds])
        for what in ("median", "p99", "worst"):
            yield Line(WHAT.format(how), what, getattr(times, what), "us", None, times)
        contacts += sum(loop.wrong for loop in loops)
        least = min(least, *(loop.least for loop in loops))
    note = f"least clearance {least:.3g} of a body {SEGMENTS * 57.5:g} long"
    yield Line(CONTACTS, "ticks", contacts, "", Goal(0, correctness=True), note=note)


def drive_from_cloud(seed: int, how: str) -> Loop:
    """Drive one loop away from a cloud that comes: beside the tip at first, then to where that was, and past it."""
    rng, robot = np.random.default_rng(seed), arm()
    q = np.column_stack([rng.normal(0.0, 0.15, (SEGMENTS, 2)), np.full(SEGMENTS, 57.5)])
    points = rng.normal(size=(POINTS, 3))
    ball = BALL * points / np.linalg.norm(points, axis=1, keepdims=True)
    angle = rng.uniform(0.0, 2.0 * np.pi)
    side = np.array([np.cos(angle), np.sin(angle), 0.0])
    begin = robot.tip(q)[:3, 3] + (BALL + 30.0) * side
    scene = sn.Scene([sn.PointCloud(ball + begin, GRAIN, name="cloud")])
    ik = sn.Solver(robot, scene, routes=False)
    scene.update(ball + begin)
    ik.step(q, np.zeros(6), CLOUD_DT, rates=CLOUD_RATES, clearance=MARGIN)
    seconds, gaps = [], []
    for tick in range(CLOUD_TICKS):
        way = -SPEED * tick * CLOUD_DT * side
        fresh = ball + begin + way
        began = perf_counter()
        if how == MOVED:
            scene.move("cloud", way)
        else:
            scene.update(fresh)
        q = ik.step(q, np.zeros(6), CLOUD_DT, rates=CLOUD_RATES, clearance=MARGIN).q
        seconds.append(perf_counter() - began)
        gaps.append(float(np.min(cKDTree(fresh).query(robot.backbone(q, 40))[0])) - GRAIN - float(robot.radii[0]))
    return Loop(seconds, sum(gap < 0.0 for gap in gaps), min(gaps))


PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {"control loops": measure, "clouds that come": measure_clouds}
