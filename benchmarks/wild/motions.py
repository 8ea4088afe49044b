"""Motions of wild worlds, judged: timed, planned, and tracked, stepped and solved while an obstacle moves."""

import threading
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.harness.lines import Goal, Line
from benchmarks.judges import self_collision
from benchmarks.judges.bodies import needed_body, self_body
from benchmarks.judges.clearances import Clearances
from benchmarks.judges.judge import within_limits
from benchmarks.wild import audit
from benchmarks.wild.trials import GRACE
from benchmarks.wild.worlds import World
from sinuous import Motion, Solver, plan, track
from sinuous.answer.solution import Solution
from sinuous.base.checks import Floats
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Sphere
from sinuous.scene.scene import Scene

SECTION = "motions of wild worlds: what is called proved, looked at by the judges"

SAMPLES = 400
"""Configurations of a motion that are looked at."""

KNOTS = (3, 40)
"""Knots on the way from one hidden shape to the next."""

TICKS, TICK, TICK_SAMPLES = 20, 0.02, 20
"""Ticks of a control loop, seconds of each, and configurations of each that are looked at."""

RACES, SHORT = 12, 0.02
"""Solves while another thread moves an obstacle, and seconds for each."""

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
    if not within_limits(world.robot, knots).all():
        return Judged(False, "")
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
    return Judged(True, _refuted(robot, Scene.of(motion.scene), _along(motion.q)))


def ticks(seed: int, number: int) -> Judged:
    """Follow a target, or a twist, tick by tick while a ball moves towards the body, and look at each proved step."""
    world, rng = _strained(seed, number), np.random.default_rng([seed, 20, number])
    robot, unit = world.robot, world.robot.mean_length
    far = robot.base[:3, 3] + 5.0 * unit
    scene = Scene([Sphere(far, 0.1 * unit, name="ball"), *world.scene.obstacles])
    most = np.array([rng.uniform(0.5, 5.0), unit * rng.uniform(0.1, 3.0)]) if rng.random() < 0.5 else np.full(2, np.inf)
    rates = Rates(*most.tolist()) if np.isfinite(most).all() else None
    solver = Solver(robot, scene, time=float(rng.choice([1e-4, 1e-3, 1e-2])))
    goal, twist = world.targets[-1], rng.normal(size=6) * ([1.0] * 3 + [unit] * 3)
    q, proved = world.hidden[0], False
    for _ in range(TICKS):
        body = robot.backbone(q)
        place = body[rng.integers(len(body))] + unit * rng.uniform(0.1, 0.6) * rng.normal(size=3)
        scene.move("ball", position=place - far)
        if rng.random() < 0.5:
            step = solver.step(q, dt=TICK, target=goal, rates=rates)
        else:
            step = solver.step(q, twist, TICK, rates=rates)
        false = (
            _refuted(robot, Scene.of(step.scene), between(step.initial, step.q, TICK_SAMPLES)) if step.proved else ""
        )
        proved, false = proved or step.proved, false or _too_fast(most, step.q - step.initial)
        if false:
            return Judged(True, false)
        q = step.q
    return Judged(proved, "")


def planned(seed: int, number: int) -> Judged:
    """Plan from one hidden shape to another, and look at the whole motion."""
    world = _strained(seed, number)
    if len(world.hidden) < 2:
        return Judged(False, "")
    motion = plan(world.robot, world.hidden[0], world.hidden[-1], world.scene, time=BUDGET)
    if len(motion.q) < 2 or motion.between != "proved":
        return Judged(False, "")
    return Judged(True, _refuted(world.robot, world.scene, _along(motion.q)))


def raced(seed: int, number: int) -> Judged:
    """Solve while another thread moves an obstacle, and look at each answer in the scene that it names."""
    world, rng = _strained(seed, number), np.random.default_rng([seed, 22, number])
    robot, unit = world.robot, world.robot.mean_length
    far = robot.base[:3, 3] + 5.0 * unit
    scene = Scene([Sphere(far, 0.2 * unit, name="ball"), *world.scene.obstacles])
    body = robot.backbone(world.hidden[0])
    places = body + 0.3 * unit * rng.normal(size=body.shape)
    done = threading.Event()

    def move() -> None:
        while not done.is_set():
            for place in places:
                scene.move("ball", position=place - far)

    mover = threading.Thread(target=move)
    mover.start()
    try:
        solver = Solver(robot, scene, tolerance=world.tolerance, time=SHORT)
        found = [solver.solve(targets) for targets in world.targets[:RACES]]
    finally:
        done.set()
        mover.join()
    solved = [each for each in found if each.solved]
    wrong = [_refuted(robot, Scene.of(each.problem.scene), each.q[None]) for each in solved]
    return Judged(bool(solved), next(filter(None, wrong), ""))


KINDS = {
    "timed in units from 1e-9 to 1e9": timed,
    "tracked in a live scene": live,
    "ticks of a control loop in a live scene": ticks,
    "plans between hidden shapes": planned,
    "solved while another thread moves an obstacle": raced,
}


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


def _strained(seed: int, number: int) -> World:
    """A world in any unit; every second one of a robot that demands clearances."""
    return (audit.demands if number % 2 else audit.units)(seed, number)


def _along(q: Floats) -> Floats:
    """Configurations (k, n, 3) along a motion with knots (m, n, 3), about `SAMPLES` of them."""
    count = max(1, SAMPLES // (len(q) - 1))
    return np.concatenate([*(between(a, b, count) for a, b in pairwise(q)), q[-1:]])


def between(one: Floats, other: Floats, count: int) -> Floats:
    """Configurations (count, n, 3) from one to before another, linear in q."""
    shares = np.arange(count)[:, None, None] / count
    return np.asarray((1.0 - shares) * one + shares * other)


def _too_fast(most: Floats, change: Floats) -> str:
    """Say whether a tick changes bends or lengths by more than the rates (2,) allow."""
    fastest = np.array([np.hypot(change[:, 0], change[:, 1]).max(), np.abs(change[:, 2]).max()]) / TICK
    return "rates" if (fastest > most * (1.0 + EXCESS)).any() else ""


def _refuted(robot: Robot, scene: Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3): a limit, an obstacle, the body itself; or nothing."""
    if not within_limits(robot, q).all():
        return "limits"
    return overlapping(robot, scene, q, GRACE * robot.mean_length)


def overlapping(body: Robot, scene: Scene, q: Floats, slack: float) -> str:
    """Say whether a body in configurations (m, n, 3) overlaps an obstacle or itself by more than `slack`."""
    if len(scene) and Clearances(needed_body(body), scene).least(q, 0.0).min() < -slack:
        return "overlap"
    if body.self_collision == "avoid" and self_collision.look(self_body(body), q, 0.0).least.min() < -slack:
        return "overlap with itself"
    return ""
