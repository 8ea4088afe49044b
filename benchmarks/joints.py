"""`python -m benchmarks joints`: inverse kinematics of arms with joints before the segments, or with joints alone.

And three segments that six axes lead along curves, follow the leader: along shapes of the arm itself, bent at random.

Poses are drawn by the judge's own kinematics from configurations within all limits, so each is reachable. What counts
is the time of the solve alone, the least of several runs, because the machine may be busy; answers are judged by code
that shares nothing with the kernels.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, Times, Trial, refuted
from benchmarks.judges.judge import right, wrong_at
from benchmarks.judges.kinematics import link_poses, moving
from benchmarks.mbm import panda
from benchmarks.motion.leader import Led, lines_of
from benchmarks.places.parts import curve_of
from benchmarks.problems import tip_targets
from benchmarks.wild.worlds import draw_jointed
from sinuous.model.joints import Joint, Prismatic, Revolute

TOLERANCE = sn.Tolerance(1e-6, 1e-6)
"""In m, and rad."""

RUNS = 5
"""Solves of each pose, of which the quickest counts."""

SPHERES, SPHERE = 40, 0.04
"""How many, and their radius in m."""

SECTION = (
    f"full poses to {TOLERANCE.position:g} m and {TOLERANCE.angle:g} rad from no start: time of the solve alone, least "
    f"of {RUNS}; {SPHERES} spheres of {SPHERE:g} m, whole body proved clear"
)

CURVES, BENT = 40, 1.0
"""Curves that an arm is led along, and largest bend of a segment in one, rad."""

FINE, GIVEN = 2000, 10
"""Points of a curve for each segment that it is measured against; and of these one in so many is given."""

LED = 2
"""Runs of each more, of which the least time counts."""


class Family(NamedTuple):
    """A kind of arm, among spheres or without; what it is to reach, in seconds."""

    name: str
    robot: Callable[[], sn.Robot]
    spheres: int
    goal: float


def rolled_and_fed() -> sn.Robot:
    """Roll and feed, then three inextensible segments: a bronchoscope, in m."""
    joints: list[Joint] = [Revolute((0.0, 0.0, 1.0), (-math.pi, math.pi)), Prismatic((0.0, 0.0, 1.0), (0.0, 0.3))]
    return sn.Robot([sn.Segment(0.1, 2.0, radius=0.005)] * 3, joints=joints)


def bare(joints: Sequence[Joint]) -> list[Joint]:
    """Joints without bodies of links."""
    return [joint.changed(body=()) for joint in joints]


def six_axes() -> sn.Robot:
    """Three segments on the first six joints of the Panda."""
    return sn.Robot([sn.Segment((0.08, 0.12), 2.0, radius=0.01)] * 3, joints=panda().joints[:6])


def six_axes_bare() -> sn.Robot:
    """The same without bodies of links, and thin."""
    return sn.Robot([sn.Segment((0.08, 0.12), 2.0)] * 3, joints=bare(panda().joints[:6]))


FAMILIES = (
    Family("roll, feed, three segments", rolled_and_fed, 0, 12e-6),
    Family("six axes, three segments", six_axes_bare, 0, 40e-6),
    Family("six axes, three segments, among spheres", six_axes, SPHERES, 80e-6),
    Family("seven axes of the Panda", lambda: sn.Robot(joints=bare(panda().joints)), 0, 15e-6),
)


def measure(plan: Plan, family: Family) -> Iterator[Line]:
    """Solve poses of a family."""
    robot, rng, count = family.robot(), np.random.default_rng(plan.seed), plan.count(1000, 2)
    trials = list[Trial]()
    while len(trials) < count:
        q = draw_jointed(robot, 1, 1.0, rng)[0]
        scene = sn.Scene()
        if family.spheres:
            centers = np.array((0.0, 0.0, 0.4)) + rng.uniform(-0.9, 0.9, (family.spheres, 3))
            scene = sn.Scene([sn.Sphere(center, SPHERE) for center in centers])
            if wrong_at(robot, scene, q[None]):
                continue  # nobody knows then whether the pose can be reached
        (target,) = tip_targets(robot, q[None], "rotation")
        solver = sn.Solver(robot, scene, tolerance=TOLERANCE)
        runs = [solver.solve(target) for _ in range(RUNS)]
        found = runs[0].configuration[None]
        wrong = ""
        if runs[0].solved:
            wrong = wrong_at(robot, scene, found) or "pose" * (not right(robot, [target], found, TOLERANCE).all())
        trials.append(Trial(len(trials), min(each.seconds for each in runs), str(runs[0].status), wrong))
    seconds = [trial.seconds for trial in trials if trial.good(math.inf)]
    times = Times.of(seconds or [math.nan])
    yield Line(SECTION, family.name, times.median, "us", Goal(family.goal), times, (len(seconds), count))
    yield refuted(SECTION, f"{family.name}: wrong", {"": trials})


def led_along(robot: sn.Robot, count: int, rng: np.random.Generator) -> Iterator[Led]:
    """Yield what leads the arm along shapes of its own, where its joints can carry it straight in."""
    alone = robot.changed(segments=())
    solver, length = sn.Solver(alone, max_starts=1, routes=False), sum(each.length[1] for each in robot.segments)
    lows, highs = np.array([joint.limits for joint in moving(robot.joints)]).T
    while count > 0:
        drawn = rng.uniform(lows, highs)
        carried = alone.with_joints(None, drawn)
        port, there = link_poses(robot, drawn[None])[0, -1], True
        for back in np.linspace(0.0, length, 31).tolist():
            found = solver.solve(sn.Target(port[:3, 3] - back * port[:3, 2], direction=port[:3, 2]), carried)
            carried, there = found.configuration, there and found.solved
        if not there:
            continue
        bend, side = rng.uniform(0.0, BENT, len(robot.segments)), rng.uniform(-np.pi, np.pi, len(robot.segments))
        q = np.stack([bend * np.cos(side), bend * np.sin(side), [each.length[1] for each in robot.segments]], axis=1)
        whole = curve_of(sn.Robot(robot.segments, base=port), q, FINE).points
        behind = port[:3, 3] - np.linspace(length, 0.0, FINE, endpoint=False)[:, None] * port[:3, 2]
        yield Led(robot, whole[::GIVEN], sn.Scene(), np.concatenate([behind, whole]))
        count -= 1


def lead(plan: Plan) -> Iterator[Line]:
    """Lead the arm along curves, and judge it."""
    robot = six_axes().changed(segments=[sn.Segment(0.1, 2.0, radius=0.01)] * 3)
    asked = led_along(robot, plan.count(CURVES, 2), np.random.default_rng(plan.seed))
    yield from lines_of("six axes and three segments", asked, LED, Goal(0.05))


PARTS: dict[str, Part] = {**{family.name: partial(measure, family=family) for family in FAMILIES}, "led": lead}
"""What is measured, in order."""
