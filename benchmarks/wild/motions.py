"""Motions of wild worlds, judged: timed in any unit of length, and tracked while an obstacle of a live scene moves."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.harness.lines import Goal, Line
from benchmarks.judges import self_collision
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import within_limits
from benchmarks.wild import audit
from benchmarks.wild.trials import GRACE
from sinuous import Motion, track
from sinuous.checks import Floats
from sinuous.problem.target import Target
from sinuous.robot.rates import Rates
from sinuous.robot.robot import Robot
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution

SECTION = "motions of wild worlds: what is called proved, looked at by the judges"

SAMPLES = 400
"""Configurations of a motion that are looked at."""

KNOTS = (3, 40)
"""Knots on the way from one hidden shape to the next."""

WAYPOINTS, BUDGET = 8, 0.2
"""Waypoints of a path in a live scene, and seconds for each."""

EXCESS = 1e-6
"""By how much of itself a rate may seem to be exceeded, by differences."""


class Judged(NamedTuple):
    """What came of one motion.

    Attributes
    ----------
    proved : bool
        Whether it is called proved.
    false : str
        What the judges refute of that; empty where they agree.
    """

    proved: bool
    false: str


def timed(seed: int, number: int) -> Judged:
    """Time a motion between hidden shapes of a world, in units of 1e-9 to 1e9, and look at the whole trajectory."""
    world, rng = audit.units(seed, number), np.random.default_rng([seed, 17, number])
    shapes = world.hidden[:3]
    if len(shapes) < 2:
        return Judged(False, "")
    knots = np.concatenate([_way(one, other, int(rng.integers(*KNOTS)), rng) for one, other in pairwise(shapes)])
    motion = Motion(world.robot, knots, world.scene)
    unit, (bend, length) = world.robot.mean_length, rng.uniform(0.1, 3.0, 2)
    rates = Rates(bend, unit * length)
    blend = float(rng.choice([0.0, 0.5])) * unit
    if blend > 0.0 or rng.random() < 0.5:
        rates = Rates(bend, unit * length, acceleration=Rates(*rng.uniform(0.1, 3.0, 2) * (1.0, unit)))
    trajectory = motion.timed(rates, blend)
    times = np.linspace(0.0, trajectory.duration, SAMPLES)
    q = trajectory.at(times)
    changes = np.abs(np.diff(q, axis=0)) / np.diff(times)[:, None, None]
    fastest = np.array([np.hypot(changes[..., 0], changes[..., 1]).max() / bend, changes[..., 2].max() / unit / length])
    if (fastest > 1.0 + EXCESS).any():
        return Judged(True, "rates")
    proved = motion.between == "proved"
    return Judged(proved, _refuted(world.robot, world.scene, q) if proved else "")


def live(seed: int, number: int) -> Judged:
    """Track a path while a ball comes near the body, and look at the whole motion in the scene that it names."""
    world, rng = audit.units(seed, number), np.random.default_rng([seed, 18, number])
    if len(world.hidden) < 2:
        return Judged(False, "")
    robot, unit = world.robot, world.robot.mean_length
    ends = robot.tip(world.hidden[0])[:3, 3], robot.tip(world.hidden[1])[:3, 3]
    path = [Target((1.0 - t) * ends[0] + t * ends[1]) for t in np.linspace(0.0, 1.0, WAYPOINTS)]
    far = robot.base[:3, 3] + 5.0 * unit
    scene = Scene([Sphere(far, 0.1 * unit, name="ball"), *world.scene.obstacles])
    seen: list[Solution] = []
    when, body = int(rng.integers(1, WAYPOINTS)), robot.backbone(world.hidden[0])
    near = body[rng.integers(len(body))] + 0.15 * unit * rng.normal(size=3)

    def move(solution: Solution) -> None:
        seen.append(solution)
        if len(seen) == when:
            scene.move("ball", position=near - far)

    motion = track(robot, path, scene, start=world.hidden[0], progress=move, time=BUDGET)
    if len(motion.q) < 2 or motion.between != "proved":
        return Judged(False, "")
    steps = max(1, SAMPLES // (len(motion.q) - 1))
    shares = np.arange(steps)[:, None, None] / steps
    q = np.concatenate([*((1.0 - shares) * a + shares * b for a, b in pairwise(motion.q)), motion.q[-1:]])
    return Judged(True, _refuted(robot, Scene.of(motion.scene), q))


KINDS = {"timed in units from 1e-9 to 1e9": timed, "tracked in a live scene": live}


def lines_of(kind: str, judged: list[Judged]) -> list[Line]:
    """Sum up motions of one kind."""
    proved = sum(each.proved for each in judged)
    wrong = [f"{i}: {each.false}" for i, each in enumerate(judged) if each.false]
    return [
        Line(SECTION, f"{kind}: proved", 100.0 * proved / len(judged), "%", None, None, (proved, len(judged))),
        Line(SECTION, f"{kind}: false claims", len(wrong), "", Goal(0, correctness=True), note=", ".join(wrong[:20])),
    ]


def _way(one: Floats, other: Floats, count: int, rng: Generator) -> Floats:
    """Knots (m, n, 3) from one shape to another, nearly in a straight line of configurations."""
    share = np.linspace(0.0, 1.0, count)[:, None, None]
    aside = 0.05 * rng.uniform() * share * (1.0 - share) * (other - one)[:, [1, 0, 2]]
    return (1.0 - share) * one + share * other + aside * [1.0, 1.0, 0.0]


def _refuted(robot: Robot, scene: Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3): a limit, an obstacle, the body itself; or nothing."""
    slack = GRACE * robot.mean_length
    if not within_limits(robot, q).all():
        return "limits"
    if len(scene) and Clearances(robot, scene).least(q, 0.0).min() < -slack:
        return "overlap"
    if robot.self_collision == "avoid" and self_collision.look(robot, q, 0.0).least.min() < -slack:
        return "overlap with itself"
    return ""
