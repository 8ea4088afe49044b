"""Motions of wild worlds, judged: timed, planned, and tracked, stepped and solved while an obstacle moves."""

import threading
from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.clearances import GRACE
from benchmarks.judges.judge import IMPOSSIBLE, within_limits
from benchmarks.judges.motions import overlap, samples, too_fast, wrong_at
from benchmarks.wild import worlds
from benchmarks.wild.trials import Judged
from benchmarks.wild.worlds import World, standing
from sinuous.base.checks import Floats
from sinuous.statics.rest import bodies_at

SAMPLES, LOADED_SAMPLES, JOINTED_SAMPLES = 400, 100, 200
"""Configurations of a motion that are looked at, of one under load, and of one with joints."""

KNOTS = (3, 40)
"""Knots on the way from one hidden shape to the next."""

TICKS, LOADED_TICKS, TICK, TICK_SAMPLES = 20, 6, 0.02, 20
"""Ticks of a control loop, and of one under load; seconds of each, and configurations of each that are looked at."""

RACES, SHORT = 12, 0.02
"""Solves while another thread moves an obstacle, and seconds for each."""

WAYPOINTS, BUDGET = 8, 0.2
"""Waypoints of a path in a live scene, and seconds for each."""


def timed(seed: int, number: int) -> Judged:
    """Time a motion between hidden shapes of a world, in units of 1e-9 to 1e9, and look at the whole trajectory."""
    world, rng = worlds.units(seed, number), np.random.default_rng([seed, 17, number])
    shapes = world.hidden[:3]
    if len(shapes) < 2:
        return Judged(False, "")
    knots = np.concatenate([_way(one, other, int(rng.integers(*KNOTS)), rng) for one, other in pairwise(shapes)])
    if not within_limits(world.robot, knots).all():
        return Judged(False, "")
    motion = sn.Motion(world.robot, knots, world.scene)
    unit, (bend, length) = world.robot.mean_length, rng.uniform(0.1, 3.0, 2)
    rates = sn.Rates(bend, unit * length)
    blend = float(rng.choice([0.0, 0.5])) * unit
    if blend > 0.0 or rng.random() < 0.5:
        rates = sn.Rates(bend, unit * length, acceleration=sn.Rates(*rng.uniform(0.1, 3.0, 2) * (1.0, unit)))
    trajectory = motion.timed(rates, blend)
    times = np.linspace(0.0, trajectory.duration, SAMPLES)
    q = trajectory.at(times)
    if too_fast(np.diff(q, axis=0), np.diff(times), bend, unit * length):
        return Judged(True, "rates")
    proved = motion.between == "proved"
    return Judged(proved, _refuted(world, world.scene, q) if proved else "")


def live(seed: int, number: int) -> Judged:
    """Track a path while a ball comes near the body, and look at the whole motion in the scene that it names."""
    world, rng = worlds.units(seed, number), np.random.default_rng([seed, 18, number])
    if len(world.hidden) < 2:
        return Judged(False, "")
    robot = world.robot
    ends = robot.tip(world.hidden[0])[:3, 3], robot.tip(world.hidden[1])[:3, 3]
    path = [sn.Target((1.0 - t) * ends[0] + t * ends[1]) for t in np.linspace(0.0, 1.0, WAYPOINTS)]
    scene, far = _with_ball(world, 0.1)
    seen: list[sn.Solution] = []
    when, body = int(rng.integers(1, WAYPOINTS)), robot.backbone(world.hidden[0])
    near = body[rng.integers(len(body))] + 0.15 * robot.mean_length * rng.normal(size=3)

    def move(solution: sn.Solution) -> None:
        seen.append(solution)
        if len(seen) == when:
            scene.move("ball", position=near - far)

    return _judged(world, sn.track(robot, path, scene, start=world.hidden[0], progress=move, time=BUDGET))


def ticks(draw: Callable[[int, int], World], seed: int, number: int) -> Judged:
    """Follow a target, or a twist, tick by tick while a ball moves towards the body, and look at each proved step."""
    world, rng = draw(seed, number), np.random.default_rng([seed, 20, number])
    robot, unit = world.robot, world.robot.mean_length
    scene, far = _with_ball(world, 0.1)
    limited = not robot.joints and rng.random() < 0.5
    most = [rng.uniform(0.5, 5.0), unit * rng.uniform(0.1, 3.0)] if limited else [np.inf, np.inf]
    rates = sn.Rates(most[0], most[1]) if limited else None
    solver = sn.Solver(robot, scene, time=float(rng.choice([1e-4, 1e-3, 1e-2])))
    goal, twist = world.targets[-1], rng.normal(size=6) * ([1.0] * 3 + [unit] * 3)
    q, proved = world.hidden[0], False
    for _ in range(LOADED_TICKS if world.loaded else TICKS):
        body = robot.shape(q).backbone(5) if world.loaded else robot.backbone(q)
        place = body[rng.integers(len(body))] + unit * rng.uniform(0.1, 0.6) * rng.normal(size=3)
        scene.move("ball", position=place - far)
        if rng.random() < 0.5:
            step = solver.step(q, dt=TICK, target=goal, rates=rates)
        else:
            step = solver.step(q, twist, TICK, rates=rates)
        if step.proved:
            proved = True
            way = samples(np.stack([q, step.configuration]), TICK_SAMPLES)
            if false := _refuted(world, sn.Scene.of(step.scene), way):
                return Judged(True, false)
        if too_fast((step.configuration - q)[None], TICK, *most):
            return Judged(True, "rates")
        q = np.array(step.configuration)
    return Judged(proved, "")


def planned(draw: Callable[[int, int], World], seed: int, number: int) -> Judged:
    """Plan from one hidden shape to another, and look at the whole motion."""
    world = draw(seed, number)
    if len(world.hidden) < 2:
        return Judged(False, "")
    return _judged(world, sn.plan(world.robot, world.hidden[0], world.hidden[-1], world.scene, time=BUDGET))


def raced(seed: int, number: int) -> Judged:
    """Solve while another thread moves an obstacle, and look at each answer in the scene that it names."""
    world, rng = strained(seed, number), np.random.default_rng([seed, 22, number])
    scene, far = _with_ball(world, 0.2)
    body = world.robot.backbone(world.hidden[0])
    places = body + 0.3 * world.robot.mean_length * rng.normal(size=body.shape)
    done = threading.Event()

    def move() -> None:
        while not done.is_set():
            for place in places:
                scene.move("ball", position=place - far)

    mover = threading.Thread(target=move)
    mover.start()
    try:
        solver = sn.Solver(world.robot, scene, tolerance=world.tolerance, time=SHORT)
        found = [solver.solve(targets) for targets in world.targets[:RACES]]
    finally:
        done.set()
        mover.join()
    solved = [each for each in found if each.solved]
    wrong = [_refuted(world, sn.Scene.of(each.problem.scene), each.q[None]) for each in solved]
    return Judged(bool(solved), next(filter(None, wrong), ""))


def strained(seed: int, number: int) -> World:
    """A world in any unit; every second one of a robot that demands clearances."""
    return (worlds.demands if number % 2 else worlds.units)(seed, number)


KINDS: dict[str, Callable[[int, int], Judged]] = {
    "timed in units from 1e-9 to 1e9": timed,
    "tracked in a live scene": live,
    "ticks of a control loop in a live scene": partial(ticks, strained),
    "plans between hidden shapes": partial(planned, strained),
    "solved while another thread moves an obstacle": raced,
    "planned under load": partial(planned, worlds.loaded),
    "ticks under load": partial(ticks, worlds.loaded),
    "arms with joints, planned": partial(planned, worlds.jointed),
    "arms with joints, ticks while an obstacle moves": partial(ticks, worlds.jointed),
}


def _way(one: Floats, other: Floats, count: int, rng: Generator) -> Floats:
    """Knots (m, n, 3) from one shape to another, nearly in a straight line of configurations."""
    share = np.linspace(0.0, 1.0, count)[:, None, None]
    aside = 0.05 * rng.uniform() * share * (1.0 - share) * (other - one)[:, [1, 0, 2]]
    return (1.0 - share) * one + share * other + aside * [1.0, 1.0, 0.0]


def _with_ball(world: World, size: float) -> tuple[sn.Scene, Floats]:
    """The scene of a world with a ball that is far away, and where that is."""
    far: Floats = world.robot.base[:3, 3] + 5.0 * world.robot.mean_length
    return sn.Scene([sn.Sphere(far, size * world.robot.mean_length, name="ball"), *world.scene.obstacles]), far


def _judged(world: World, motion: sn.Motion) -> Judged:
    """Look at a whole motion, in the scene that it names, where it is called proved."""
    knots = motion.configuration
    if len(knots) < 2 or motion.between != "proved":
        return Judged(False, str(motion.status) if motion.status in IMPOSSIBLE and world.possible else "")
    few = JOINTED_SAMPLES if world.robot.joints else LOADED_SAMPLES if world.loaded else SAMPLES
    return Judged(True, _refuted(world, sn.Scene.of(motion.scene), samples(knots, max(1, few // (len(knots) - 1)))))


def _refuted(world: World, scene: sn.Scene, q: Floats) -> str:
    """Say what is wrong with configurations (m, n, 3) of a robot, of one under load with its body at rest."""
    robot = world.robot
    if not world.loaded:
        return wrong_at(robot, scene, q)
    if not within_limits(robot, q).all():
        return "limits"
    if not standing(robot, q).all():
        return "no equilibrium"
    body, arcs = bodies_at(robot, q)
    return overlap(body, scene, arcs, GRACE * robot.mean_length)
