"""Follow the leader (P9): three unit segments on a stage enter along curves, and lie on what the tip has passed.

The curves are those of a published planner (sampling-based follow-the-leader motion planning, RSS 2026), whose base
moves freely: 0.000 % of tip deviation, 1.6 to 2.1 % of mean and 5 to 9.2 % of largest shape deviation, in seconds.
"""

import time
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

import sinuous as sn
from benchmarks.harness.experiment import Plan
from benchmarks.harness.lines import Goal, Line, Times
from benchmarks.judges.kinematics import body_points
from sinuous.base.checks import Floats
from sinuous.statics.rest import bodies_at

SECTION = "follow the leader: 3 unit segments on a stage, radius 0.05; deviations in % of 3"
LENGTH = 3.0
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
    alone = {name: [curve] for name, curve in named.items()} | {"own shapes": list(shapes(plan))}
    for name, curves in alone.items():
        yield from _lines(name, curves, plan)
    for name, curve in named.items():
        yield from _lines(f"{name} through a tunnel", [curve], plan, gap=GAP)
    for name, curve in named.items():
        yield from _lines(f"{name} under load", [curve], plan, **LOAD)


def _lines(name: str, curves: list[Floats], plan: Plan, gap: float | None = None, **load: Any) -> Iterator[Line]:
    seconds, found, proved = list[float](), list[tuple[float, float, float]](), 0
    for curve in curves:
        axis = curve[1] - curve[0]
        arm = sn.Robot.uniform(3, 1.0, radius=0.05, base=sn.pose(curve[0], direction=axis), **load)
        robot = sn.on_stage(arm, float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()))
        scene = sn.Scene([] if gap is None else tunnel(curve, 0.05 + gap))
        points = curve[:: FINE // 200]
        motion = sn.follow_the_leader(robot, points, scene)
        for _ in range(plan.count(10, 2)):
            begin = time.perf_counter()
            motion = sn.follow_the_leader(robot, points, scene)
            seconds.append(time.perf_counter() - begin)
        proved += motion.solved
        found.append(deviations(robot, motion, curve))
    tip, shape, most = np.array(found).T
    times = Times.of(seconds)
    goal = None if load else Goal(0.1)
    yield Line(SECTION, f"{name}: time", times.median, "ms", goal, times, (proved, len(curves)))
    yield Line(SECTION, f"{name}: tip, at worst", tip.max(), "%", Goal(0.001))
    yield Line(SECTION, f"{name}: shape, mean", shape.mean(), "%", Goal(1.0))
    yield Line(SECTION, f"{name}: shape, at worst", most.max(), "%")


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


def deviations(robot: sn.Robot, motion: sn.Motion, curve: Floats) -> tuple[float, float, float]:
    """Largest deviation of the tip, mean and largest of the arm, % of its length, at knots and between them."""
    base = robot.base[:3, 3]
    line = base + np.linspace(0.0, 1.0, FINE, endpoint=False)[:, None] * (curve[0] - base)
    whole = np.concatenate([line, curve])
    at = np.arange((len(motion.q) - 1) * BETWEEN + 1) / BETWEEN
    q = motion.at(np.interp(at, np.arange(len(motion.q)), motion.times))
    body, arcs = bodies_at(robot, q)
    points = body_points(body, arcs, PLACES)[0][:, 1:]
    tree = cKDTree(whole)
    off = distances(tree, whole, points.reshape(-1, 3)).reshape(points.shape[:-1])
    share = 100.0 / LENGTH
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
