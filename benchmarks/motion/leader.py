"""Follow the leader (P9): three unit segments on a stage enter along curves, and lie on what the tip has passed.

The curves are those of a published planner (sampling-based follow-the-leader motion planning, RSS 2026), whose base
moves freely: 0.000 % of tip deviation, 1.6 to 2.1 % of mean and 5 to 9.2 % of largest shape deviation, in seconds.
"""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from time import process_time
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times, timed
from benchmarks.judges.clearances import GRACE
from benchmarks.judges.judge import overlap, samples
from benchmarks.judges.kinematics import body_places, body_points, moving
from sinuous.base.checks import Floats
from sinuous.statics.rest import bodies_at

SECTION = "follow the leader: 3 segments on a stage or on six axes; deviations in % of their length"
END = (-2.3, 0.0, 0.8)
FINE = 100_001
PLACES, BETWEEN = 30, 4
"""Places of every segment, and configurations of every step, that are judged."""

LOAD: dict[str, Any] = {"stiffness": sn.Stiffness(1.0, 0.8), "mass": 0.01, "arcs": 4, "gravity": (0.0, 0.0, -9.81)}
"""Of an arm whose tip its weight moves by a third of its length, held out straight."""

RINGS, GAP = 8, 0.15
"""Pairs of balls beside the curve, and how much room they leave beside the body."""


def bezier(*control: tuple[float, float, float]) -> Floats:
    """Points (FINE, 3) of a Bezier curve, by de Casteljau's construction."""
    t = np.linspace(0.0, 1.0, FINE)[:, None]
    parts = [np.broadcast_to(np.array(p, np.float64), (FINE, 3)) for p in control]
    while len(parts) > 1:
        parts = [(1.0 - t) * a + t * b for a, b in pairwise(parts)]
    return np.asarray(parts[0])


def three_quarters() -> Floats:
    """Points (FINE, 3) of the last three quarters of half a circle from the origin to `END`, the "C"."""
    end = np.array(END)
    out = np.cross(end, (0, 0, 1)) / np.linalg.norm(np.cross(end, (0, 0, 1)))
    angle = np.linspace(np.pi / 4.0, np.pi, FINE)[:, None]
    radius = 0.5 * np.linalg.norm(end)
    return np.asarray(0.5 * end - 0.5 * end * np.cos(angle) + radius * np.sin(angle) * out)


def shapes(plan: Plan) -> Iterator[Floats]:
    """Backbones of arms of the same kind, bent at random by at most a quarter turn a segment."""
    rng, arm = plan.rng(9), sn.Robot.uniform(3, 1.0)
    for _ in range(plan.count(20, 3)):
        bend, side = rng.uniform(0.0, np.pi / 2.0, 3), rng.uniform(-np.pi, np.pi, 3)
        q = np.stack([bend * np.cos(side), bend * np.sin(side), np.ones(3)], axis=1)
        yield arm.backbone(q, FINE // 3)


def measure(plan: Plan) -> Iterator[Line]:
    """Lines of each curve, alone, under load and through a tunnel of balls, and of shapes of the arm itself."""
    named = {
        "bezier": bezier((0, 0, 0), (0, 0, 1.6), (2, 0, 1.3)),
        "S": bezier((0, 0, 0), (-0.575, 0, 0.9), (-1.725, 0, -0.1), END),
        "C": three_quarters(),
    }
    repeats = plan.count(10, 2)
    alone = {name: [curve] for name, curve in named.items()} | {"own shapes": list(shapes(plan))}
    for name, curves in alone.items():
        yield from lines_of(name, map(on_stage, curves), repeats, Goal(0.1))
    for name, curve in named.items():
        yield from lines_of(f"{name} through a tunnel", [on_stage(curve, GAP)], repeats, Goal(0.1))
    for name, curve in named.items():
        yield from lines_of(f"{name} under load", [on_stage(curve, **LOAD)], repeats)


class Led(NamedTuple):
    """An arm, the points (m, 3) that it is led along, what stands around, and the way (k, 3) that it is to lie on."""

    robot: sn.Robot
    points: Floats
    scene: sn.Scene
    way: Floats


def on_stage(curve: Floats, gap: float | None = None, **load: Any) -> Led:
    """Put an arm on a stage before a curve, alone or in a tunnel that leaves it such a gap."""
    arm = sn.Robot.uniform(3, 1.0, radius=0.05, base=sn.pose(curve[0], direction=curve[1] - curve[0]), **load)
    robot = sn.on_stage(arm, float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()))
    base = robot.base[:3, 3]
    line = base + np.linspace(0.0, 1.0, FINE, endpoint=False)[:, None] * (curve[0] - base)
    scene = sn.Scene([] if gap is None else tunnel(curve, 0.05 + gap))
    return Led(robot, curve[:: FINE // 200], scene, np.concatenate([line, curve]))


def lines_of(name: str, asked: Iterable[Led], repeats: int, goal: Goal | None = None) -> Iterator[Line]:
    """Lead arms so often, of which the least CPU time counts, and judge them."""
    seconds, found, proved, wrong = list[float](), list[tuple[float, float, float]](), 0, 0
    for led in asked:
        given = led.robot, led.points, led.scene
        motion, spent = timed(sn.follow_the_leader, *given, runs=1 + repeats, clock=process_time)
        seconds.append(spent)
        proved += motion.solved
        body, q = _bodies(led.robot, motion)
        wrong += bool(motion.solved and overlap(body, led.scene, q, GRACE * body.mean_length))
        found.append(deviations(body, q, led.way))
    tip, shape, most = np.array(found).T
    times = Times.of(seconds)
    yield Line(SECTION, f"{name}: time", times.median, "ms", goal, times, (proved, len(seconds)))
    yield Line(SECTION, f"{name}: tip, at worst", tip.max(), "%", Goal(0.001))
    yield Line(SECTION, f"{name}: shape, mean", shape.mean(), "%", Goal(1.0))
    yield Line(SECTION, f"{name}: shape, at worst", most.max(), "%")
    yield Line(SECTION, f"{name}: in which a judge finds a collision", wrong, "", Goal(0, correctness=True))


def tunnel(curve: Floats, away: float) -> list[sn.Sphere]:
    """Balls on both sides of a curve, in its plane, so far from it that they leave so much room."""
    at = np.linspace(0, len(curve) - 2, RINGS, dtype=np.intp)
    tangents = curve[at + 1] - curve[at]
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    normal = np.cross(curve[-1] - curve[0], curve[len(curve) // 4] - curve[0])
    aside = np.cross(tangents, normal / np.linalg.norm(normal))
    radius = 0.1
    return [
        sn.Sphere(p + side * (away + radius) * n, radius=radius)
        for p, n in zip(curve[at], aside, strict=True)
        for side in (-1, 1)
    ]


def _bodies(robot: sn.Robot, motion: sn.Motion) -> tuple[sn.Robot, Floats]:
    """The body at the knots of a motion and between them, at rest where it is loaded, and its configurations."""
    q = samples(motion.configuration, BETWEEN)
    return (robot, q) if robot.joints else bodies_at(robot, q)


def deviations(body: sn.Robot, q: Floats, way: Floats) -> tuple[float, float, float]:
    """Largest deviation of the tip, mean and largest of what bends, % of its length."""
    if body.joints:
        links = len(moving(body.joints))
        points = np.stack([own for link, own, _ in body_places(body, q, PLACES) if link > links], axis=1)
    else:
        points = body_points(body, q, PLACES)[0][:, 1:]
    off = distances(cKDTree(way), way, points.reshape(-1, 3)).reshape(points.shape[:-1])
    share = 100.0 / sum(segment.length[1] for segment in body.segments if segment.max_bend > 0.0)
    return float(off[:, -1, -1].max() * share), float(off.mean() * share), float(off.max() * share)


def distances(tree: cKDTree, whole: Floats, points: Floats) -> Floats:
    """Distances (m,) of points from the straight lines beside the nearest of many points of a curve."""
    _, nearest = tree.query(points)
    sides = []
    for i in (np.clip(nearest - 1, 0, len(whole) - 2), np.clip(nearest, 0, len(whole) - 2)):
        a, d = whole[i], whole[i + 1] - whole[i]
        share = np.clip(((points - a) * d).sum(axis=1) / (d * d).sum(axis=1), 0.0, 1.0)
        sides.append(np.linalg.norm(a + share[:, None] * d - points, axis=1))
    least: Floats = np.minimum(*sides)
    return least


PARTS = {"follow the leader": measure}
"""Pieces of the experiment, by name."""
