"""`python -m benchmarks wild`: anything that can be built, with a hidden solution each, and every claim judged.

Wild worlds are solved problem by problem, and every claim is held against judges, and against the hidden solutions.
Motions of wild worlds are timed, planned, and tracked, stepped and solved while an obstacle moves, and judged.
"""

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness import Divided, Experiment, Goal, Line, Plan, Trial, counted, listed, timed
from benchmarks.judges.clearances import GRACE, Clearances
from benchmarks.judges.judge import IMPOSSIBLE, Flags, at_targets, overlap, samples, too_fast, within_limits, wrong_at
from benchmarks.judges.kinematics import measured_body, needed_body, self_body
from benchmarks.judges.self_collision import look
from benchmarks.wild import calls, worlds
from benchmarks.wild.worlds import LIMIT, Judged, World, standing
from sinuous.base.checks import Floats
from sinuous.statics.rest import bodies_at

TARGET, LIMITS, OVERLAP, SELF_OVERLAP = "target missed", "limits", "overlap", "overlap with itself"
DEMAND, REST = "less clearance than is demanded", "no equilibrium"
CLEARANCE, SELF_CLEARANCE = "clearance overstated", "self-clearance overstated"

EXCEPTION = "exception"


def solutions_of(world: World) -> list[tuple[sn.Solution | Exception, float]]:
    """Solve all problems, one by one, with the defaults of a user; and how long each took, in seconds."""
    solver = sn.Solver(world.robot, world.scene, tolerance=world.tolerance, time=world.time)

    def solve(targets: list[sn.Target]) -> sn.Solution | Exception:
        try:
            return solver.solve(targets)
        except Exception as error:  # whatever it is, it is counted
            return error

    return [timed(solve, targets) for targets in world.targets]


def examine(world: World) -> list[Trial]:
    """Solve all problems of a world, and judge all claims."""
    found = solutions_of(world)
    false = refuted(world, {i: each for i, (each, _) in enumerate(found) if isinstance(each, sn.Solution)})
    return [
        Trial(i, spent, EXCEPTION, EXCEPTION)
        if isinstance(each, Exception)
        else Trial(i, spent, str(each.status), ", ".join(false[i]))
        for i, (each, spent) in enumerate(found)
    ]


def refuted(world: World, solutions: Mapping[int, sn.Solution]) -> dict[int, tuple[str, ...]]:
    """What is false of solutions of some problems, by their numbers."""
    false: dict[int, tuple[str, ...]] = {
        i: (str(each.status),) if world.possible and each.status in IMPOSSIBLE else () for i, each in solutions.items()
    }
    claims = {i: each for i, each in solutions.items() if each.solved}
    if claims:
        wrong = _wrong(world, claims)
        false |= {i: tuple(kind for kind, where in wrong.items() if where[at]) for at, i in enumerate(claims)}
    return false


def _wrong(world: World, claims: Mapping[int, sn.Solution]) -> dict[str, Flags]:
    """Where solutions that are called solved are wrong, kind by kind; of a robot under load its body at rest counts."""
    robot, q = world.robot, np.array([each.configuration for each in claims.values()])
    slack, demanded = GRACE * robot.mean_length, np.zeros(len(q), bool)
    found = {LIMITS: ~within_limits(robot, q)}
    if world.loaded:
        found[REST] = ~standing(robot, q)
        if found[REST].any():
            return found
        shapes = [robot.shape(one) for one in q]
        met = [_at_targets(world, [i], each.body, each.arcs[None])[0] for i, each in zip(claims, shapes, strict=True)]
        found[TARGET] = ~np.array(met)
        robot, q = bodies_at(robot, q)
    else:
        found[TARGET] = ~_at_targets(world, list(claims), robot, q)
    if len(world.scene):
        scene, said = world.truth or world.scene, _said(claims, "clearance")
        gaps = Clearances(measured_body(robot), scene).least(q, max(0.0, float(np.nan_to_num(said).max())))
        found |= {OVERLAP: gaps < -slack, CLEARANCE: said > gaps + slack}
        if np.any(robot.clearance):
            demanded |= Clearances(needed_body(robot), scene).least(q, 0.0) < -slack
    gaps, thick = look(robot, q, 0.0).least, self_body(robot)
    left = gaps if thick is robot else look(thick, q, 0.0).least
    found |= {SELF_OVERLAP: gaps < -slack, DEMAND: demanded | (left < -slack)}
    most = left + float(np.min(robot.self_clearance)) + slack
    return found | {SELF_CLEARANCE: _said(claims, "self_clearance") > most}


def _said(claims: Mapping[int, sn.Solution], name: str) -> Floats:
    """A bound that every solution claims; NaN where it claims none."""
    values = [getattr(solution, name, None) for solution in claims.values()]
    return np.array([np.nan if value is None else value for value in values], np.float64)


def _at_targets(world: World, problems: list[int], robot: Any, q: Floats) -> Flags:
    """Whether the shapes of a body meet all targets of these problems."""
    asked = zip(*(world.targets[i] for i in problems), strict=True)
    return np.all([at_targets(robot, targets, q, world.tolerance) for targets in asked], axis=0)


def tallied(make: Callable[[int], World], numbers: range) -> list[Trial]:
    """Solve and judge worlds; return what came of their problems, numbered by worlds and within these."""
    examine(make(numbers[0]))  # loads what is compiled, which nobody's time should count
    found = [(number, trial) for number in numbers for trial in examine(make(number))]
    return [trial._replace(number=f"{number}.{trial.number}") for number, trial in found]


def lines_of(section: str, what: str, most: float | None, trials: Sequence[Trial]) -> Iterator[Line]:
    """Sum up worlds: what share of problems is solved in time, which may be wanted (%), and false claims."""
    yield from counted(section, f"{section}: false claims", what, trials, LIMIT, most)


def lines_of_judged(section: str, kind: str, good: str, false: str, judged: Sequence[Judged]) -> Iterator[Line]:
    """Sum up motions or calls of one kind: how many are good, and which false."""
    count = sum(each.good for each in judged)
    wrong = [f"{i}: {each.false}" for i, each in enumerate(judged) if each.false]
    yield Line(section, f"{kind}: {good}", 100.0 * count / len(judged), "%", None, None, (count, len(judged)))
    yield Line(section, f"{kind}: {false}", len(wrong), "", Goal(0, correctness=True), note=listed(wrong))


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


def timed_motion(seed: int, number: int) -> Judged:
    """Time a motion between hidden shapes of a world, in units of 1e-9 to 1e9, and look at the whole trajectory."""
    world, rng = worlds.make(seed, number), np.random.default_rng([seed, 17, number])
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
    world, rng = worlds.make(seed, number), np.random.default_rng([seed, 18, number])
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

    on_the_way = replace(world, possible=False)  # waypoints are no hidden shapes, and the ball may come onto one
    return _judged(on_the_way, sn.track(robot, path, scene, start=world.hidden[0], progress=move, time=BUDGET))


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
    return (worlds.demands if number % 2 else worlds.make)(seed, number)


KINDS: dict[str, Callable[[int, int], Judged]] = {
    "timed in units from 1e-9 to 1e9": timed_motion,
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


SECTION = "wild problems, each with a hidden solution that is clear of obstacles and of itself; budget 1 s"
AUDIT = (
    "what an audit of the proofs strained, each problem with a hidden solution; budget 1 s, of bounds and huge 0.05 s, "
    "under load 0.2 s, with joints 0.3 s"
)

CALLS = "public calls of odd robots"
SECTIONS = (
    "motions of wild worlds: what is called proved, looked at by the judges",
    "public calls of odd robots in odd scenes: whether each ends in an answer",
)

BLOCK, BLOCKS, AUDITED = 22, 100, 10
"""Worlds of one share, about a thousand problems; shares of one run, 100,000 problems; those of one audited kind."""

MADE, MADES = 100, 5
"""Motions, or calls, of one share; shares of one kind of these, in one run."""

WANTED = 99.97
"""Percent of the problems that are to be solved within the budget."""


def wild(plan: Plan) -> Experiment:
    """First what is short: what an audit asked for, motions and calls; then wild worlds."""
    seed, count = plan.seed, plan.count
    parts: dict[str, Divided] = {}

    def shares(work: Callable[[range], Any], size: int, many: int) -> list[Callable[[], Any]]:
        return [partial(work, range(i * size, (i + 1) * size)) for i in range(many)]

    for kind, make in worlds.AUDITED.items():
        work, summed = partial(tallied, partial(make, seed)), partial(lines_of, AUDIT, kind, None)
        parts[kind] = Divided(shares(work, count(BLOCK, 10), count(AUDITED, 1)), summed)
    for kind, judge in (KINDS | {CALLS: calls.called}).items():
        words = ("answered", "exceptions") if kind == CALLS else ("proved", "false claims")
        summed = partial(lines_of_judged, SECTIONS[kind == CALLS], kind, *words)
        parts[kind] = Divided(shares(partial(made, judge, seed), count(MADE, 2), count(MADES, 1)), summed)
    work, summed = partial(tallied, partial(worlds.make, seed)), partial(lines_of, SECTION, "wild", WANTED)
    parts["wild"] = Divided(shares(work, count(BLOCK, 10), count(BLOCKS, 1)), summed)
    return Experiment("wild", plan, parts)


def made(judge: Callable[[int, int], Judged], seed: int, numbers: range) -> list[Judged]:
    """Make and judge motions, or calls."""
    return [judge(seed, number) for number in numbers]
