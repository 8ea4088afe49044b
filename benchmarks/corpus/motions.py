"""Motions: plans, also past what moves, tracks, the leader, times and blends, and steps of control loops."""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

import sinuous as sn
from benchmarks.corpus.answers import Problem
from benchmarks.judges.motions import wrong_in
from benchmarks.motion import known, leader, moving, p5
from benchmarks.places import make
from benchmarks.problems import path_through
from benchmarks.wild import audit, odd, worlds

TIME = 20.0
"""Seconds of a plan, or of a waypoint; those that take more than a fraction of it are not kept."""

FEW = 30
"""Segments times obstacles of a motion that is verified step by step, which is slow."""


def plans() -> Iterator[Problem]:
    """From one shape to another: among spheres, in known places, and to the targets of intricate ones."""
    for segments, count in ((3, 24), (4, 16), (6, 8)):
        for number in range(count):
            pair = p5.draw(segments, 1, number, 0)
            ask = partial(sn.plan, pair.robot, pair.start, pair.goal, pair.scene, time=TIME)
            yield Problem(f"{segments} segments {number}", ask, _right)
            yield Problem(f"{segments} segments {number}, shortened", partial(ask, shortcuts=5), _right)
    for number in range(8):
        pair = p5.draw(4, 1, number, 1)
        target = sn.Target(pair.robot.tip(pair.goal)[:3, 3])
        yield Problem(
            f"to a target {number}", partial(sn.plan, pair.robot, pair.start, target, pair.scene, time=TIME), _right
        )
    for family in known.FAMILIES:
        for seed in range(3):
            place = known.make(family, seed)
            ask = partial(sn.plan, place.robot, place.knots[0], place.knots[-1], place.scene, time=TIME)
            yield Problem(f"{family} {seed}", ask, _right)


def _right(motion: sn.Motion) -> bool:
    return motion.solved and not wrong_in(motion.robot, sn.Scene.of(motion.scene), motion.q)


def in_time() -> Iterator[Problem]:
    """Past obstacles that move: planned with rates and for a duration, tracked, and timed."""
    for seed in range(24):
        robot, scene, start, goal = moving.draw(seed)
        ask = partial(sn.plan, robot, start, goal, scene, time=TIME)
        yield Problem(f"{seed} with rates", partial(ask, rates=sn.Rates(moving.BEND, moving.LENGTH)), _right_in_time)
        yield Problem(f"{seed} for a duration", partial(ask, duration=moving.DURATION), _right_in_time)
        ends = robot.tip(np.stack([start, goal]))[:, :3, 3]
        path = [sn.Target((1.0 - share) * ends[0] + share * ends[1]) for share in np.linspace(0.0, 1.0, 7)[1:]]
        times = moving.DURATION * np.arange(1, 7) / 6.0
        yield Problem(
            f"{seed} tracked",
            partial(sn.track, robot, path, scene, start=start, times=times, time=TIME),
            _right_in_time,
        )


def _right_in_time(motion: sn.Motion) -> bool:
    return motion.solved and not moving.judged(motion)


def tracks() -> Iterator[Problem]:
    """Paths: behind random spheres, and along lines of the tip in wild worlds, short and shortened."""
    for segments, spheres in ((5, 10), (5, 50), (8, 30)):
        for seed in range(3):
            path = path_through(segments, spheres, np.random.default_rng([seed, segments, spheres]), 180)
            ask = partial(_tracked, path.robot, path.targets[:60], path.scene)
            yield Problem(f"{segments} segments, {spheres} spheres, {seed}", ask, lambda found: _right_steps(found[0]))
    for number in range(60):
        world, robot = worlds.make(3, number), worlds.make(3, number).robot
        ends = robot.tip(world.hidden[0])[:3, 3], robot.tip(world.hidden[-1])[:3, 3]
        path_of_tip = [sn.Target((1.0 - t) * ends[0] + t * ends[1]) for t in np.linspace(0.0, 1.0, 8)]
        ask = partial(_tracked, robot, path_of_tip, world.scene, start=world.hidden[0], max_starts=6)
        yield Problem(f"line {number}", ask, lambda found: _right_steps(found[0]))
        if number % 6 == 0:
            yield Problem(f"line {number}, shortened", partial(ask, shortest="configuration"))


def _tracked(robot: sn.Robot, path: Any, scene: Any, **options: Any) -> Any:
    motion = sn.track(robot, path, scene, time=TIME, **{"max_starts": 20, **options})
    return motion, [(each.status, each.start, each.starts, each.iterations) for each in motion.solutions]


def _right_steps(motion: sn.Motion) -> bool:
    return motion.between != "proved" or not wrong_in(motion.robot, sn.Scene.of(motion.scene), motion.q)


def timed() -> Iterator[Problem]:
    """Motions through shapes of wild worlds with their times: with and without accelerations, stopped and blended."""
    for number in range(60):
        world, rng = audit.units(4, number), np.random.default_rng([71, number])
        if len(world.hidden) > 1:
            yield Problem(f"{number}", partial(_timed, world.robot, world.scene, world.hidden[:3], rng))


def _timed(robot: sn.Robot, scene: sn.Scene, shapes: Any, rng: np.random.Generator) -> Any:
    ways = [
        one + t * (other - one) for one, other in pairwise(shapes) for t in np.linspace(0.0, 1.0, 5)[:-1, None, None]
    ]
    motion = sn.Motion(robot, [*ways, shapes[-1]], scene)
    unit, (bend, length) = robot.mean_length, rng.uniform(0.1, 3.0, 2)
    blend = float(rng.choice([0.0, 0.5])) * unit
    slow = sn.Rates(*rng.uniform(0.1, 3.0, 2) * (1.0, unit)) if blend or rng.random() < 0.5 else None
    found = motion.timed(sn.Rates(bend, unit * length, acceleration=slow), blend)
    t = np.linspace(0.0, found.duration, 12)
    return (
        motion,
        motion.verify() if len(robot) * (1 + len(scene)) < FEW else None,
        motion.reversed(),
        found.duration,
        found.stops,
        found.at(t),
        found.velocity(t),
        found.acceleration(t),
    )


def led() -> Iterator[Problem]:
    """Follow the leader along curves: alone, under load, through a tunnel, and in and out with derivatives."""
    curves = {
        "bezier": leader.bezier((0, 0, 0), (0, 0, 1.6), (2, 0, 1.3)),
        "S": leader.bezier((0, 0, 0), (-0.575, 0, 0.9), (-1.725, 0, -0.1), leader.END),
        "C": leader.three_quarters(),
    }
    arm, rng = sn.Robot.uniform(3, 1.0), np.random.default_rng(72)
    for i in range(12):
        bend, side = rng.uniform(0.0, np.pi / 2.0, 3), rng.uniform(-np.pi, np.pi, 3)
        q = np.stack([bend * np.cos(side), bend * np.sin(side), np.ones(3)], axis=1)
        curves[f"own shape {i}"] = arm.backbone(q, leader.FINE // 3)
    for name, curve in curves.items():
        kinds = {"": ({}, None), " in a tunnel": ({}, leader.GAP), " under load": (leader.LOAD, None)}
        for kind, (load, gap) in kinds.items():
            if not kind or not name.startswith("own"):
                yield Problem(f"{name}{kind}", partial(_led, curve, load, gap))


def _led(curve: Any, load: dict[str, Any], gap: float | None) -> Any:
    arm = sn.Robot.uniform(3, 1.0, radius=0.05, base=sn.pose(curve[0], direction=curve[1] - curve[0]), **load)
    robot = sn.on_stage(arm, float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()))
    points = curve[:: leader.FINE // 200]
    scene = sn.Scene([] if gap is None else leader.tunnel(curve, 0.05 + gap))
    motion = sn.follow_the_leader(robot, points, scene, time=TIME)
    halfway = [0.5 * (motion.times[0] + motion.times[-1])]
    own = None if load else motion.derivative(points, halfway, ("advance", "lengths"))
    return motion, motion.deviation(points), own


def steps() -> Iterator[Problem]:
    """Control loops of some ticks with a twist, a target, or measurements, while a ball comes near."""
    for number in range(80):
        world = audit.units(5, number)
        yield Problem(
            f"{number}", partial(_ticks, world.robot, world.scene, world.hidden[0], world.targets[-1], number)
        )
    for number in range(120):
        rng = np.random.default_rng([73, number])
        robot = odd.robot(rng)
        scene, q, target = odd.scene(robot, rng), odd.shape(robot, rng), odd.target(robot, rng)
        yield Problem(f"odd {number}", partial(_ticks, robot, scene, q, target, number, ball=False))


def _ticks(robot: sn.Robot, scene: sn.Scene, q: Any, target: Any, number: int, ball: bool = True) -> Any:
    rng, unit = np.random.default_rng([74, number]), robot.mean_length
    far = robot.base[:3, 3] + 5.0 * unit
    live = sn.Scene([sn.Sphere(far, 0.1 * unit, name="ball"), *scene.obstacles]) if ball else scene
    rates = sn.Rates(*(rng.uniform(0.1, 3.0, 2) * (1.0, unit))) if number % 2 else None
    solver, kind = sn.Solver(robot, live, time=TIME, max_starts=4), number % 3
    found: list[sn.answer.Step] = []
    for _ in range(6):
        if ball:
            body = robot.backbone(found[-1].q if found else q)
            live.move("ball", position=body[rng.integers(len(body))] + 0.4 * unit * rng.normal(size=3) - far)
        given: dict[str, Any] = {"rates": rates, "dt": 0.02}
        if kind == 0:
            given["twist"] = rng.normal(size=6) * ([1.0] * 3 + [unit] * 3)
        else:
            given["target"] = target
        if kind == 2 and found and not robot.has_external_load:
            given["measured"] = robot.tip(found[-1].q)[:3, 3] + 1e-3 * unit * rng.normal(size=3)
        found.append(solver.step(found[-1] if found else q, **given))
    return found


def intricate() -> Iterator[Problem]:
    """Plans in intricate places, from the hidden shape to positions of the tip a fifth of the length away."""
    for family in ("spheres 12", "shelf", "plates", "lattice", "rubble", "two doors"):
        for seed in range(4):
            place, rng = make(family, seed), np.random.default_rng([76, seed])
            for way in rng.normal(size=(2, 3)):
                off = 0.2 * place.robot.mean_length * way / np.linalg.norm(way)
                target = sn.Target(place.robot.tip(place.hidden_q)[:3, 3] + off)
                ask = partial(sn.plan, place.robot, place.hidden_q, target, place.scene, time=0.5 * TIME, max_starts=6)
                yield Problem(f"{family} {seed} by {off[0]:.3g}", ask, _right)


def live() -> Iterator[Problem]:
    """Tracks in a scene that changes under way, and plans under load."""
    for number in range(20):
        world = audit.units(9, number)
        yield Problem(f"live {number}", partial(_live, world.robot, world.scene, world.hidden, number))
    for number in range(12):
        hanging = audit.loaded(2, number)
        ends = hanging.hidden[0], hanging.hidden[-1]
        yield Problem(f"under load {number}", partial(sn.plan, hanging.robot, *ends, hanging.scene, time=TIME))


def _live(robot: sn.Robot, scene: sn.Scene, shapes: Any, number: int) -> sn.Motion:
    rng, unit = np.random.default_rng([75, number]), robot.mean_length
    ends = robot.tip(shapes[0])[:3, 3], robot.tip(shapes[-1])[:3, 3]
    path = [sn.Target((1.0 - t) * ends[0] + t * ends[1]) for t in np.linspace(0.0, 1.0, 8)]
    far, body = robot.base[:3, 3] + 5.0 * unit, robot.backbone(shapes[0])
    near = body[rng.integers(len(body))] + 0.15 * unit * rng.normal(size=3)
    changing = sn.Scene([sn.Sphere(far, 0.1 * unit, name="ball"), *scene.obstacles])
    seen: list[sn.Solution] = []

    def move(solution: sn.Solution) -> None:
        seen.append(solution)
        if len(seen) == number % 7 + 1:
            changing.move("ball", position=near - far)

    return sn.track(robot, path, changing, start=shapes[0], progress=move, time=TIME, max_starts=6)


PIECES: dict[str, Callable[[], Iterator[Problem]]] = {
    "plans": plans,
    "plans in places": intricate,
    "plans in time": in_time,
    "tracks": tracks,
    "live and loaded": live,
    "times": timed,
    "leader": led,
    "control steps": steps,
}
