"""Inverse kinematics under gravity and payload: what is solved, how quickly, and whether a Cosserat rod agrees."""

import time
from collections.abc import Iterator
from functools import partial

import numpy as np

import sinuous as sn
from benchmarks.harness.experiment import Part
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.cosserat import shoot
from sinuous.base.checks import Floats

SECTION = "inverse kinematics under gravity and payload, sections of 4 arcs"

GRAVITY = np.array([0.0, 0.0, -9.81])

ROD = sn.Stiffness(bend=0.01, twist=0.008)

MASS, CARRIED = 0.05, 0.01
"""Of the body, kg / m; of the payload, kg. It moves the tips of these robots by some 30 % of their length."""

STIFF = 1e6
"""EA of the judge's rod, N: it does not stretch."""

NEAR = 0.5
"""Percent of the length by which the judge's tip may be off."""


def robot_of(sections: int) -> sn.Robot:
    """A robot that hangs, stands or lies, as its drive makes it."""
    segment = sn.Segment((0.07, 0.13), max_bend=2.0, radius=0.005, stiffness=ROD, mass=MASS, arcs=4)
    return sn.Robot([segment] * sections, gravity=GRAVITY, payload=sn.Payload(CARRIED))


def solves(sections: int, spheres: int, goal: float, plan: Plan) -> list[Line]:
    """Targets that are known to be reached by a loaded body that is clear; a few answers are computed as a rod."""
    count, judged, random = plan.count(60, 10), plan.count(8, 2), np.random.default_rng(sections + spheres)
    robot, scene = robot_of(sections), list(_balls(random, spheres))
    solver, targets = sn.Solver(robot, scene), list(_targets(random, robot, scene, count))
    solver.solve(targets[0])  # kernels are loaded
    seconds, answers = [], []
    for target in targets:
        began = time.thread_time()
        answers.append(solver.solve(target))
        seconds.append(time.thread_time() - began)
    answered = [(found, target) for found, target in zip(answers, targets, strict=True) if found.solved]
    solved, wrong = len(answered), sum(not found.verify().ok for found, _ in answered)
    errors = [_off(robot, found.q, target) for found, target in answered[:judged]]
    what = f"{sections} sections" + (f" among {spheres} spheres" if spheres else "")
    times = Times.of(seconds)
    agrees = 100.0 * float(np.mean(np.array(errors) <= NEAR))
    return [
        Line(SECTION, f"{what}: a solve", times.median, "ms", Goal(goal), times, (solved, count)),
        Line(SECTION, f"{what}: solved", 100.0 * solved / count, "%", Goal(99.9, at_most=False)),
        Line(SECTION, f"{what}: answers that do not verify", float(wrong), "", Goal(0.0, correctness=True)),
        Line(SECTION, f"{what}: tip of a Cosserat rod off by, median", float(np.median(errors)), "%"),
        Line(
            SECTION,
            f"{what}: off by at most {NEAR} %",
            agrees,
            "% of answers",
            note=f"{judged} answers; worst {max(errors):.2g} %",
        ),
    ]


def _balls(random: np.random.Generator, count: int) -> Iterator[sn.Sphere]:
    while count > 0:
        place = random.uniform(-0.35, 0.35, 3)
        if np.linalg.norm(place) > 0.1:
            count -= 1
            yield sn.Sphere(place, 0.025)


def _targets(random: np.random.Generator, robot: sn.Robot, scene: list[sn.Sphere], count: int) -> Iterator[sn.Target]:
    while count > 0:
        bends = random.uniform(-1.0, 1.0, (len(robot), 2))
        q = np.concatenate([bends, random.uniform(0.08, 0.12, (len(robot), 1))], axis=1)
        try:
            shape = robot.shape(q)
        except sn.InputError:
            continue
        if shape.stable and sn.check(robot, q, scene).ok:
            count -= 1
            yield sn.Target(shape.tip[:3, 3])


def _off(robot: sn.Robot, q: Floats, target: sn.Target) -> float:
    """Distance of the judge's tip from the target, in percent of the length."""
    rests = np.array([[-y / length, x / length, 0.0] for x, y, length in q])
    loads = np.zeros((len(q), 6))
    loads[-1, :3] = CARRIED * GRAVITY
    stiffness, weights = np.array([[ROD.bend, ROD.twist, STIFF]] * len(q)), np.tile(MASS * GRAVITY, (len(q), 1))
    reaction = robot.shape(q).reaction
    guess = -np.concatenate([reaction[3:], reaction[:3]])
    tip = shoot(q[:, 2], stiffness, rests, weights, loads, robot.base, guess)[-1][:3, 3]
    assert target.position is not None
    return 100.0 * float(np.linalg.norm(tip - target.position)) / robot.mean_length


PARTS: dict[str, Part] = {
    f"load-{sections}-{spheres}": partial(solves, sections, spheres, goal)
    for sections, spheres, goal in ((3, 0, 0.5e-3), (5, 0, 0.5e-3), (5, 40, 1e-3))
}
"""What is measured, by name."""
