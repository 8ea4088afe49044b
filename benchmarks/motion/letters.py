"""Letters and curves (P6): 150 poses between published handle poses, past two spheres; and a line in every branch (P7).

The handles, the spheres and the arm are those of a published solver's path following; how the tip goes from the first
handle to the last is ours: on the straight line, with the stroke of the curve or letter across it. The last handles of
all letters are 3.13 to 3.26 from the base, and the arm is 3 long: the poses near them are proved to be out of reach.
Six coordinates meet the six numbers of a pose in few shapes, mostly two, so it can be held against all of them whether
a pose that is not reached is one that cannot be.
"""

import math
from collections import Counter
from collections.abc import Iterator
from time import perf_counter

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.kinematics import body_points
from benchmarks.motion.judged import collides
from sinuous.base.checks import Floats
from sinuous.motion.motion import Motion
from sinuous.problem.target import Target

POSES, REPEATS = 150, 10

BUDGET = 0.05
"""Seconds for a pose that is not reached: some of those between the handles cannot be."""

RADIUS, BALL = 0.1, 0.3

TOLERANCE = sn.Tolerance(1e-8, 1e-8)

ERROR = "P6, letters and curves: mean error of the tip, in segments (published: 3e-3)"
POSE = (
    "P6: time of a pose that is reached, of each the least of all repeats "
    "(one core, warm, with the proof of every step; published: 6 to 14 ms)"
)
SOLVED = "P6: poses reached by proved motion"
MISSED = "P6: of every fifth pose that is not reached, those with a shape that meets it clear of the spheres"
LINE_POSE = "P7: time of a pose (one core, warm, with the proof of every step)"
FALSE = "P6 and P7: motions called proved in which a judge finds a collision"
BRANCHES = "P7, 30 poses on a line: whole branches, followed by proved motion (published: 2)"

Handle = tuple[tuple[float, float, float], tuple[float, float, float, float]]

UPRIGHT = (1.0, 0.0, 0.0, 0.0)

CASES: dict[str, tuple[Handle, Handle, tuple[tuple[float, float, float], ...]]] = {
    "sine": (
        ((0.48, 1.35, 1.54), (0.71, 0.71, 0.0, 0.0)),
        ((0.37, 0.86, 2.02), (0.71, 0.71, 0.0, 0.0)),
        ((0.1222, 1.0388, 0.0958), (0.4525, 0.8203, 1.3374)),
    ),
    "I": (
        ((-0.01, -2.45, 0.91), (0.83, 0.54, 0.06, 0.1)),
        ((0.75, -1.37, 2.75), UPRIGHT),
        ((-0.6, -0.92, 1.094), (0.01, -0.53, 0.35)),
    ),
    "C": (
        ((-0.01, -2.46, 0.9), (0.83, 0.54, 0.06, 0.1)),
        ((0.75, -1.31, 2.75), UPRIGHT),
        ((0.29, -0.66, 1.29), (0.33, -1.07, 0.6)),
    ),
    "R": (
        ((-0.11, -2.36, 0.87), (0.85, 0.49, 0.15, 0.14)),
        ((0.79, -1.26, 2.75), UPRIGHT),
        ((0.48, -0.77, 1.48), (0.19, -0.98, 0.63)),
    ),
    "A": (
        ((-0.01, -2.51, 0.76), (0.82, 0.47, 0.25, 0.2)),
        ((1.23, -1.25, 2.75), UPRIGHT),
        ((0.1088, -0.95, 0.2501), (0.7046, -0.6, 1.1528)),
    ),
}
"""First and last handle (position and quaternion wxyz) and centers of the spheres, in segments."""

STROKES = {
    "sine": lambda t: 0.1 * np.sin(4.0 * np.pi * t),
    "I": lambda t: 0.0 * t,
    "C": lambda t: 0.1 * np.sin(np.pi * t),
    "R": lambda t: 0.1 * np.abs(np.sin(2.0 * np.pi * t)) * (t < 0.5) + 0.1 * np.maximum(0.0, 2.0 * t - 1.0) * (1.0 - t),
    "A": lambda t: 0.1 * (1.0 - np.abs(2.0 * t - 1.0)),
}
"""How far the tip is from the straight line, across it, at shares of the way; in segments."""


def arm() -> sn.Robot:
    """Return the published arm: three segments of length 1, radius 0.1, three tendons."""
    return sn.Robot.uniform(3, 1.0, 2.0 * math.pi, radius=RADIUS, tendons=sn.Tendons(3, radius=0.08))


def poses(name: str) -> list[Target]:
    """Return the poses of a letter or curve."""
    (a, q0), (b, q1), _ = CASES[name]
    t = np.linspace(0.0, 1.0, POSES)
    along = np.subtract(b, a)
    across = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    places = a + t[:, None] * along + STROKES[name](t)[:, None] * across / np.linalg.norm(across)
    turns = Slerp([0.0, 1.0], Rotation.from_quat([q0, q1], scalar_first=True))(t)
    return list(Target.each(places, rotation=turns))


def measure_letters(plan: Plan) -> Iterator[Line]:
    """Follow every letter and curve."""
    robot = arm()
    wrong = 0
    for name, (_, _, centers) in CASES.items():
        targets, scene = poses(name), sn.Scene([sn.Sphere(center, BALL) for center in centers])
        repeats = [_timed(robot, targets, scene) for _ in range(plan.count(REPEATS, 1) + 1)]
        motion = repeats[-1][0]
        least = np.min([seconds for _, seconds in repeats[1:]], axis=0)
        found = Times.of(least[[solution.solved for solution in motion.solutions]])
        solved = sum(solution.solved for solution in motion.solutions)
        wrong += motion.solved and bool(collides(robot, scene, motion.q))
        ended = Counter(str(solution.status) for solution in motion.solutions if not solution.solved)
        unsolved = "".join(f"{count} {status}, " for status, count in sorted(ended.items()))
        note = f"{unsolved}{len(motion.q)} knots, reconfigured {len(motion.reconfigured)} times"
        reached = solved - len(motion.unproved_steps)
        yield Line(SOLVED, name, 100.0 * reached / POSES, "%", None, solved=(reached, POSES), note=note)
        missed, tried = _missed(robot, targets, scene, motion)
        yield Line(MISSED, name, missed, "", Goal(0.0), note=f"of {tried}")
        yield Line(ERROR, name, _error(robot, targets, motion), "", Goal(1e-6), noise=3.0)
        yield Line(POSE, name, found.median, "us", Goal(100e-6), found)
    yield Line(FALSE, "letters", wrong, "", Goal(0.0, correctness=True))


def _timed(robot: sn.Robot, targets: list[Target], scene: sn.Scene) -> tuple[Motion, Floats]:
    """Follow poses; return the motion, and the seconds of every pose with all that was proved of the way there."""
    stamps = [perf_counter()]

    def stamp(_: sn.Solution) -> None:
        stamps.append(perf_counter())

    motion = sn.track(robot, targets, scene, tolerance=TOLERANCE, deviation=0.01, time=BUDGET, progress=stamp)
    return motion, np.diff(stamps)


def _missed(robot: sn.Robot, targets: list[Target], scene: sn.Scene, motion: Motion) -> tuple[int, int]:
    """How many poses that are not solved some shape meets that is clear of the spheres, of how many.

    All shapes that meet a pose are looked for without spheres, and held against these by samples.
    """
    free, missed = sn.Solver(robot, tolerance=TOLERANCE, time=0.5), 0
    poses = zip(targets, motion.solutions, strict=True)
    unsolved = [target for target, solution in poses if not solution.solved][::5]
    for target in unsolved:
        found = [solution.q for solution in free.solve_all(target, by="shape", count=16)]
        missed += bool(found) and float(max(sn.check(robot, np.array(found), scene=scene).clearance)) > 0.0
    return missed, len(unsolved)


def _error(robot: sn.Robot, targets: list[Target], motion: Motion) -> float:
    """Mean distance of the tip from the poses that are solved, by independent kinematics."""
    pairs = zip(targets, motion.solutions, strict=True)
    off = [
        np.linalg.norm(body_points(robot, solution.q[None], 1)[0][0].reshape(-1, 3)[-1] - target.position)
        for target, solution in pairs
        if solution.solved and target.position is not None
    ]
    return float(np.mean(off)) if off else math.inf


def measure_line(plan: Plan) -> Iterator[Line]:
    """Follow a line of 30 poses from every solution of the first."""
    robot = sn.Robot.uniform(3, 1.0, math.pi)
    turned = Rotation.from_rotvec([math.pi / 3.0, 0.0, 0.0]).as_matrix()
    places: Floats = np.stack([np.linspace(-0.5, 0.5, 30), np.full(30, -0.2), np.full(30, 2.7)], axis=-1)
    targets = list(Target.each(places, rotation=np.broadcast_to(turned, (30, 3, 3))))
    branches = sn.solve_all(robot, targets[0], by="shape", tolerance=TOLERANCE)
    times, whole = [], 0
    for branch in branches:
        for _ in range(plan.count(REPEATS, 1)):
            began = perf_counter()
            motion = sn.track(robot, targets, start=branch, tolerance=TOLERANCE, deviation=0.01)
            times.append((perf_counter() - began) / len(targets))
        whole += motion.solved and not motion.reconfigured
    found = Times.of(times)
    yield Line(BRANCHES, f"of {len(branches)} at the first pose", whole, "", Goal(2.0, at_most=False), found)
    yield Line(LINE_POSE, "every branch", found.median, "us", Goal(100e-6), found)


PARTS = {"letters": measure_letters, "line": measure_line}
