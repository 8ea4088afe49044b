"""A control loop while a cloud of 50,000 points comes at the robot: ticks with their update, and contacts.

The cloud is a ball that goes through the place of the body and out again. The robot is asked to stay where its tip is;
it has to get out of the way. What is counted as contact is looked at after each tick, by a k-d tree, with the cloud
where it was then. The robot cannot see what comes: where the ball is faster than it may move, they meet.
"""

from collections.abc import Callable, Iterator
from time import perf_counter
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from sinuous.base.checks import Floats

SEGMENTS, POINTS, TICKS, LOOPS, DT = 5, 50_000, 300, 4, 1e-2
RATES = sn.Rates(bend=2.0, length=60.0)
RADIUS, GRAIN, SPEED, MARGIN = 35.0, 1.0, 40.0, 6.0
"""Of the ball and of its points; how fast it comes, length unit/s; the clearance that is wished for."""

AROUND = 40
"""Places of the backbone that are looked at, a segment."""

MOVED, SEEN = "moved as a whole (Scene.move)", "seen anew (Scene.update)"
WHAT = "loop at 100 Hz, a cloud of 50,000 points comes at the robot, {}: one tick with the update"
CONTACTS = "the same loops: ticks with a contact, by a k-d tree"


class Loop(NamedTuple):
    """Seconds of all ticks, ticks with a contact, and the least clearance."""

    seconds: list[float]
    contacts: int
    least: float


def measure(plan: Plan) -> Iterator[Line]:
    """Drive loops, the cloud once moved as a whole, and once given as new points."""
    contacts, least = 0, np.inf
    for how in (MOVED, SEEN):
        loops = [drive(1000 * plan.seed + i, how) for i in range(plan.count(LOOPS, 1))]
        times = Times.of([second for loop in loops for second in loop.seconds])
        yield Line(WHAT.format(how), "median", times.median, "us", None, times)
        yield Line(WHAT.format(how), "p99", times.p99, "us", None, times, noise=1.0)
        yield Line(WHAT.format(how), "worst", times.worst, "us", None, times, noise=3.0)
        contacts += sum(loop.contacts for loop in loops)
        least = min(least, *(loop.least for loop in loops))
    note = f"least clearance {least:.3g} of a body {SEGMENTS * 57.5:g} long"
    yield Line(CONTACTS, "ticks", contacts, "", Goal(0, correctness=True), note=note)


def drive(seed: int, how: str) -> Loop:
    """Drive one loop, and judge it."""
    rng = np.random.default_rng(seed)
    robot = sn.Robot.uniform(SEGMENTS, (45, 70), max_bend=2.4, radius=4)
    q = np.column_stack([rng.normal(0.0, 0.15, (SEGMENTS, 2)), np.full(SEGMENTS, 57.5)])
    ball, way = _ball(rng), _way(robot.tip(q)[:3, 3], rng)
    scene = sn.Scene([sn.PointCloud(ball + way(0.0), GRAIN, name="cloud")])
    ik = sn.Solver(robot, scene, routes=False)
    scene.update(ball + way(0.0))
    ik.step(q, np.zeros(6), DT, rates=RATES, clearance=MARGIN)
    seconds, contacts, least = [], 0, np.inf
    for tick in range(TICKS):
        here = way(tick * DT)
        fresh = ball + here
        began = perf_counter()
        if how == MOVED:
            scene.move("cloud", here - way(0.0))
        else:
            scene.update(fresh)
        q = ik.step(q, np.zeros(6), DT, rates=RATES, clearance=MARGIN).q
        seconds.append(perf_counter() - began)
        gap = _clearance(robot, q, cKDTree(fresh))
        contacts, least = contacts + (gap < 0.0), min(least, gap)
    return Loop(seconds, contacts, least)


def _ball(rng: np.random.Generator) -> Floats:
    """Points (m, 3) on a ball about the origin."""
    points = rng.normal(size=(POINTS, 3))
    ball: Floats = RADIUS * points / np.linalg.norm(points, axis=1, keepdims=True)
    return ball


def _way(tip: Floats, rng: np.random.Generator) -> Callable[[float], Floats]:
    """Where the ball is at a time: beside the tip at first, then towards it, up to where it was, and past it."""
    angle = rng.uniform(0.0, 2.0 * np.pi)
    side = np.array([np.cos(angle), np.sin(angle), 0.0])
    begin = tip + (RADIUS + 30.0) * side

    def at(t: float) -> Floats:
        place: Floats = begin - SPEED * t * side
        return place

    return at


def _clearance(robot: sn.Robot, q: Floats, tree: "cKDTree") -> float:
    """Least distance of the body from the points, less both radii."""
    distances = np.asarray(tree.query(robot.backbone(q, AROUND))[0])
    return float(distances.min()) - GRAIN - float(robot.radii[0])


PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {"clouds that come": measure}
