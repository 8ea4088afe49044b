"""Motions among spheres and boxes that move and turn: how many are planned and tracked, and whether a judge objects.

Half of the obstacles go to and fro, the others stand still. Start and goal are clear when the motion begins and ends. A
judge looks at many times of every motion that is called proved, at the obstacles where they are then, by distances that
share nothing with the kernels. Where no motion is found, nobody knows whether there is one.
"""

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

import sinuous as sn
from benchmarks.harness import Line, Plan, Trial, counted, timed
from benchmarks.judges import self_collision
from benchmarks.judges.clearances import GRACE, Clearances
from benchmarks.judges.judge import too_fast, wrong_at
from sinuous.base.checks import Floats
from sinuous.motion.plan import PlanArguments

SEGMENTS, OBSTACLES, PLACES, DURATION, SECONDS = 4, 16, 40, 6.0, 2.0
BEND, LENGTH = 1.0, 0.2
"""Rates, rad/s and length unit/s."""

LOOKS = 200
"""Times of a motion that are looked at."""

SECTION = "4 segments among 8 obstacles that move and 8 that do not"


def measure(plan: Plan) -> Iterator[Line]:
    """Plan and track in random places."""
    count, rates = plan.count(PLACES, 2), sn.Rates(BEND, LENGTH)
    asked: dict[str, Callable[[int], Trial]] = {
        f"planned with rates, {SECONDS:g} s": partial(planned, timing={"rates": rates}),
        f"planned for a duration, {SECONDS:g} s": partial(planned, timing={"duration": DURATION}),
        "tracked along a line of the tip, in time": tracked,
    }
    for what, ask in asked.items():
        trials = [ask(1000 * plan.seed + i) for i in range(count)]
        found = f"{SECTION}: {what}: proved motions in which a judge finds a contact, a limit or a rate violated"
        yield from counted(f"{SECTION}: {what}", found, "motions", trials, np.inf)


def draw(seed: int) -> tuple[sn.Robot, sn.Scene, Floats, Floats]:
    """A robot, obstacles, a start that is clear at time 0, and a goal that is clear at `DURATION` and later."""
    rng = np.random.default_rng([seed, SEGMENTS])
    robot = sn.Robot.uniform(SEGMENTS, (0.8, 1.2), max_bend=2.4, radius=0.05)
    while True:
        scene = sn.Scene([_obstacle(rng, moves=i % 2 == 0) for i in range(OBSTACLES)])
        ends = [_clear_shape(robot, scene.at(t), rng) for t in (0.0, DURATION)]
        if ends[0] is not None and ends[1] is not None:
            return robot, scene, ends[0], ends[1]


def planned(seed: int, timing: PlanArguments) -> Trial:
    """Plan one motion, and judge it."""
    robot, scene, start, goal = draw(seed)
    motion, seconds = timed(sn.plan, robot, start, goal, scene, time=SECONDS, **timing)
    wrong = judged(motion) if motion.solved else ""
    if motion.solved and "rates" in timing and too_fast(np.diff(motion.q, axis=0), np.diff(motion.times), BEND, LENGTH):
        wrong = "rates"
    return Trial(seed, seconds, str(motion.status), wrong)


def tracked(seed: int) -> Trial:
    """Follow a line of the tip, and judge the motion."""
    robot, scene, start, goal = draw(seed)
    ends = robot.tip(np.stack([start, goal]))[:, :3, 3]
    path = [sn.Target((1.0 - share) * ends[0] + share * ends[1]) for share in np.linspace(0.0, 1.0, 7)[1:]]
    track = partial(sn.track, start=start, times=DURATION * np.arange(1, 7) / 6.0, time=SECONDS, reconfigure="allow")
    motion, seconds = timed(track, robot, path, scene)
    return Trial(seed, seconds, str(motion.status), judged(motion) if motion.solved else "")


def judged(motion: sn.Motion) -> str:
    """Say what is wrong with a motion; or nothing."""
    robot, least = motion.robot, np.inf
    times = np.unique(np.concatenate([np.linspace(motion.times[0], motion.times[-1], LOOKS), motion.times]))
    q = motion.at(times)
    if wrong := wrong_at(robot, sn.Scene(), q):
        return wrong
    for t, shape in zip(times.tolist(), q, strict=True):
        scene = sn.Scene.of(motion.scene.at(t))
        least = min(least, float(Clearances(robot, scene).least(shape[None], 0.0)[0]))
    if least < -GRACE:
        return "overlap"
    return "clearance" if motion.clearance is not None and motion.clearance > least + GRACE else ""


def _obstacle(rng: np.random.Generator, *, moves: bool) -> sn.Sphere | sn.Box | sn.Moving:
    """A ball or a box, somewhere beside the base."""
    places = rng.uniform((-3.0, -3.0, 0.0), (3.0, 3.0, 4.0), (3, 3))
    far = np.hypot(places[:, 0], places[:, 1]) < 0.6
    places[far, 0] += 1.5
    size = float(rng.uniform(0.15, 0.45))
    if not moves:
        return sn.Sphere(places[0], size) if rng.random() < 0.5 else sn.Box(places[0], np.full(3, 1.5 * size))
    still = sn.Sphere((0, 0, 0), size) if rng.random() < 0.5 else sn.Box((0, 0, 0), rng.uniform(0.2, 0.8, 3))
    return sn.Moving(still, [0.0, 0.5 * DURATION, DURATION], places, rng.normal(size=(3, 4)))


def _clear_shape(robot: sn.Robot, scene: sn.Scene, rng: np.random.Generator) -> Floats | None:
    for _ in range(30):
        bends, angles = 1.8 * np.sqrt(rng.random(SEGMENTS)), rng.uniform(0.0, 2.0 * np.pi, SEGMENTS)
        lengths = rng.uniform(0.85, 1.15, SEGMENTS)
        q: Floats = np.stack([bends * np.cos(angles), bends * np.sin(angles), lengths], axis=-1)
        free = Clearances(robot, scene).least(q[None], 0.0)[0] > 0.02
        if free and self_collision.look(robot, q[None], 0.0).least[0] > 0.02:
            return q
    return None


PARTS: dict[str, Callable[[Plan], Iterator[Line]]] = {"obstacles that move": measure}
