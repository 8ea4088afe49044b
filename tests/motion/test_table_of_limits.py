"""Every verb keeps every kind of limit, or refuses in one line: a table of verbs, limits and robots.

A new verb is a row of `VERBS`, a new limit one of `LIMITS`. What verbs answer is judged by code that none of them uses.
What is refused today is written in `refuses`, so that a limit that nothing answers does not pass. All rows compile for
minutes of CPU where nothing is compiled; begin with `-k "LIMIT and free"`.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.measures.statics import lacking_stretch
from tests.motion.test_tension_limits import most_pulled

ROBOTS = ("free", "elastic", "loaded")
SLACK = 1e-9
WISHED = 1e-3
"""By how much accelerations of control steps may be exceeded: they are wishes, of a variance."""

MANY_WISHED = 0.1
"""The same of six motors: more wishes than a robot has freedoms give way to each other."""

MOST = 4
"""Steps of a way that are judged, about."""

LOOKS = np.linspace(0.0, 1.0, 3)
START = np.array([[0.1, 0.05, 0.1], [0.05, -0.1, 0.1]])
FAR = np.array([[1.3, 0.4, 0.13], [1.1, 0.3, 0.07]])
RATES = sn.Rates(bend=1.0, length=0.02)
MOTORS = sn.Rates(bend=1.0, length=0.02, actuator=0.003)
MOTORS_EVENLY = sn.Rates(bend=1.0, length=0.02, actuator=0.003, acceleration=sn.Rates(2.0, 0.05, actuator=0.01))
ACCELERATIONS = sn.Rates(bend=1.0, length=0.02, acceleration=sn.Rates(bend=2.0, length=0.05))


def segments(kind: str, **limits: Any) -> sn.Robot:
    """Two segments of a kind of robot; `limits` are those of each segment, or of its tendons."""
    lines: dict[str, Any] = {key: limits.pop(key) for key in ("displacement", "tension") if key in limits}
    stiff: dict[str, Any] = {} if kind == "free" else {"stiffness": 4000.0}
    own: dict[str, Any] = {"length": 0.1, "max_bend": 1.5, "radius": 0.004, **limits}
    whole: dict[str, Any] = {} if kind == "free" else {"stiffness": sn.Stiffness(0.02)}
    if kind == "loaded":
        whole |= {"gravity": (-9.81, 0.0, 0.0), "mass": 0.3, "arcs": 2}
    tendons = sn.Tendons(3, 0.004, 0.2, **stiff, **lines)
    return sn.Robot([sn.Segment(**own, tendons=tendons)] * 2, **whole)


def stuck(kind: str) -> sn.Robot:
    """A robot whose second segment holds its shape."""
    robot: Any = segments(kind)
    held: sn.Robot = robot.locked({2: (0.05, -0.1, 0.1)})
    return held


def jointed(kind: str) -> sn.Robot:
    """Segments on a roll and a feed, which have limits, rates and accelerations of their own."""
    roll = sn.Revolute(limits=(-0.3, 0.4), rate=0.5, acceleration=1.0, name="roll")
    feed = sn.Prismatic(limits=(-0.05, 0.02), rate=0.01, acceleration=0.03, name="feed")
    own: sn.Robot = segments(kind).changed(joints=[roll, feed])
    return own


JOINTS = np.array([0.3, -0.04]), np.array([-0.25, 0.01])
"""Values of the joints at the start, and far from it."""

LIMITS: dict[str, Callable[[str], sn.Robot]] = {
    "joint": jointed,
    "length": lambda kind: segments(kind, length=(0.08, 0.12)),
    "bend": lambda kind: segments(kind, max_bend=0.6),
    "curvature": lambda kind: segments(kind, length=(0.09, 0.11), max_curvature=6.0),
    "actuator": lambda kind: segments(kind, displacement=(-0.003, 0.003)),
    "tension": lambda kind: segments(kind, tension=(0.0, 30.0)),
    "rate": segments,
    "acceleration": segments,
    "plane": lambda kind: segments(kind, plane=0.5, max_bend=(-0.4, 0.7)),
    "locked": stuck,
    "rate of motors": segments,
    "rate of motors, lengths vary": lambda kind: segments(kind, length=(0.08, 0.12)),
    "acceleration of motors": segments,
}


class Went(NamedTuple):
    """A way that a verb answers: knots (T, n, 3), their times, and whether all between them is claimed, too."""

    q: Floats
    times: Floats
    claimed: bool


class Asked(NamedTuple):
    """What every verb is asked: from where to where a robot goes, and how fast it may."""

    robot: sn.Robot
    start: Floats
    goal: Floats
    rates: sn.Rates | None


def went(motion: sn.Motion) -> Went:
    return Went(motion.configuration, motion.times, motion.solved)


def tip_at(robot: sn.Robot, q: Floats) -> Floats:
    pose: Floats = robot.shape(q).tip if robot.has_external_load else robot.tip(q)
    return pose[:3, 3]


def place(asked: Asked) -> sn.Target:
    return sn.Target(tip_at(asked.robot, asked.goal))


def _accelerates(asked: Asked) -> bool:
    return asked.rates is not None and asked.rates.further(asked.robot) is not None


def solve(asked: Asked) -> Went:
    found = sn.solve(asked.robot, place(asked), initial=asked.start, time=1.0)
    return Went(found.configuration[None] if found.solved else asked.start[None], np.zeros(1), found.solved)


def solve_many(asked: Asked) -> Went:
    found = sn.Solver(asked.robot, time=1.0).solve_many([place(asked)] * 2, initial=asked.start)
    return Went(found.configuration[found.solved], np.zeros(int(found.solved.sum())), False)


def step(asked: Asked) -> Went:
    solver, q, dt = sn.Solver(asked.robot), [asked.start], 0.1
    far = 4.0 * (tip_at(asked.robot, asked.goal) - tip_at(asked.robot, asked.start))
    velocity, more = np.zeros_like(asked.start), _accelerates(asked)
    for _ in range(8):
        made = solver.step(q[-1], far, dt, rates=asked.rates, velocity=velocity if more else None)
        q, velocity = [*q, made.configuration], made.velocity
    return Went(np.array(q), dt * np.arange(float(len(q))), True)


def within(asked: Asked) -> Went:
    if _accelerates(asked):
        raise sn.InputError("within", "changes have no acceleration", asked.rates, "rates * dt")
    rates = asked.rates or RATES
    found = sn.Solver(asked.robot).solve(place(asked), asked.start, within=rates * 0.5)
    return Went(np.stack([asked.start, found.configuration]), np.array([0.0, 0.5]), found.status != "unproved")


def plan(asked: Asked) -> Went:
    return went(sn.plan(asked.robot, asked.start, asked.goal, rates=asked.rates, time=4.0))


def track(asked: Asked) -> Went:
    return went(sn.track(asked.robot, [place(asked)], start=asked.start, rates=asked.rates, time=2.0))


def shorten(asked: Asked) -> Went:
    middle = asked._replace(goal=0.5 * (asked.start + asked.goal))
    targets = [place(middle), place(asked)]
    options: Any = {"start": asked.start, "rates": asked.rates, "shortest": "configuration", "time": 2.0}
    return went(sn.track(asked.robot, targets, **options))


def lead(asked: Asked) -> Went:
    robot = sn.on_stage(asked.robot, 0.2)
    stage = len(asked.robot) - len(asked.robot.segments)
    curve = robot.backbone(np.insert(asked.goal, stage, [0.0, 0.0, 0.2], axis=0))
    found = sn.follow_the_leader(robot, curve[20 * (stage + 1) :], time=0.5, tip_deviation=2e-3)
    return Went(np.delete(found.configuration, stage, axis=1), found.times, found.solved)


def from_elsewhere(asked: Asked) -> Went:
    beyond = asked.robot.clamp(2.0 * asked.goal - asked.start)
    return went(sn.Motion(asked.robot, [asked.start, beyond, asked.goal]))


def timed(asked: Asked) -> Went:
    middle = asked.robot.clamp(0.5 * (asked.start + asked.goal) * [1.0, 0.9, 1.0])
    motion = sn.Motion(asked.robot, [asked.start, middle, asked.goal])
    if asked.rates is None:
        return went(motion.timed(ACCELERATIONS).resampled(20.0))
    trajectory = motion.timed(asked.rates, 0.0)
    times = np.linspace(0.0, trajectory.duration, 40)
    return Went(trajectory.at(times), times, False)


VERBS: dict[str, Callable[[Asked], Went]] = {
    "solve": solve,
    "solve_many": solve_many,
    "step": step,
    "within": within,
    "plan": plan,
    "track": track,
    "shorten": shorten,
    "follow_the_leader": lead,
    "Motion": from_elsewhere,
    "timed": timed,
}


WITHOUT_TIME = ("solve", "solve_many", "follow_the_leader", "Motion")
"""Verbs that know no rates."""

REFUSED = (("within", "acceleration", "any"), ("within", "acceleration of motors", "any"), ("any", "tension", "free"))
"""What is refused today: accelerations of a change, and tensions of tendons that are not elastic."""


def refuses(verb: str, limit: str, kind: str) -> bool:
    return any({verb, limit, kind, "any"} >= set(row) for row in REFUSED)


def asked_of(verb: str, limit: str, kind: str) -> Asked:
    robot = LIMITS[limit](kind)
    start, far = (START, FAR) if not robot.joints else map(robot.with_joints, (START, FAR), JOINTS)
    start, far = robot.clamp(start), robot.clamp(far)
    rates = {"rate": RATES, "acceleration": ACCELERATIONS, "joint": RATES, "acceleration of motors": MOTORS_EVENLY}
    own = MOTORS if limit.startswith("rate of motors") else rates.get(limit)
    if verb in WITHOUT_TIME or (verb, limit) == ("within", "joint"):
        own = None
    return Asked(robot, start, start + (0.4 if kind == "loaded" else 0.97) * (far - start), own)


def excesses(asked: Asked, way: Went) -> Iterator[tuple[str, float]]:
    """Yield by how much a way is outside of limits (rad, or mean lengths), at knots and between what is claimed."""
    robot, unit = asked.robot, asked.robot.mean_length
    pairs = list(pairwise(way.q)) if way.claimed and len(way.q) > 1 else [(q, q) for q in way.q]
    for one, other in pairs[:: max(1, len(pairs) // MOST)]:
        shares = LOOKS if one is not other else LOOKS[:1]
        shapes = [(1.0 - share) * one + share * other for share in shares]
        for q in shapes:
            yield from ((name, amount / size) for name, amount, size in _of_shape(robot, q, unit))
        if robot.drive.elastic is not None:
            yield "tension", lacking_stretch(robot, np.array(shapes)) / unit
        if robot.has_external_load and robot.limit_set.tension_rows is not None:
            yield "tension under load", most_pulled(robot, np.stack([one, other]), len(LOOKS)) / 30.0 - 1.0


def _of_shape(robot: sn.Robot, q: Floats, unit: float) -> Iterator[tuple[str, float, float]]:
    joints, q = robot.split(q)
    for joint, value in zip(robot.joints, joints.tolist(), strict=True):
        yield "joint", max(joint.limits[0] - value, value - joint.limits[1]), unit
    for k, segment in enumerate(robot.segments):
        bend, length = float(np.linalg.norm(q[k, :2])), float(q[k, 2])
        least, most = segment.length
        yield "length", max(least - length, length - most), unit
        cap = segment.max_bend if isinstance(segment.max_bend, float) else max(map(abs, segment.max_bend))
        yield "bend", bend - min(cap, (segment.max_curvature or np.inf) * length), 1.0
        plane = getattr(segment, "plane", None)
        if plane is not None:
            x, y = (
                np.cos(plane) * q[k, :2] @ [1.0, 0.0] + np.sin(plane) * q[k, 1],
                q[k, :2] @ [-np.sin(plane), np.cos(plane)],
            )
            yield "plane", max(abs(float(y)), float(x) - 0.7, -0.4 - float(x)), 1.0
        if getattr(segment, "locked", None) is not None:
            yield "locked", float(np.abs(q[k] - [0.05, -0.1, 0.1]).max()), 1.0
        if segment.tendons is not None and segment.tendons.stiffness is None:
            for angle in segment.tendons.angles:
                pulled = segment.tendons.radius * float(q[: k + 1, :2].sum(axis=0) @ [np.cos(angle), np.sin(angle)])
                low, high = segment.tendons.displacement
                yield "actuator", max(low - pulled, pulled - high), unit


def speeds(asked: Asked, way: Went) -> Iterator[tuple[str, float]]:
    """Yield by how much rates, and accelerations from knot to knot, are exceeded, relative to themselves."""
    assert asked.rates is not None
    joints, arcs = asked.robot.split(way.q)
    moved, times = np.diff(arcs, axis=0) / np.diff(way.times)[:, None, None], np.diff(way.times)
    turning = np.diff(joints, axis=0) / times[:, None]
    faster = np.abs(np.diff(turning, axis=0)) / (0.5 * (times[1:] + times[:-1]))[:, None]
    for i, joint in enumerate(asked.robot.joints):
        yield "rate of a joint", float(np.abs(turning[:, i]).max(initial=0.0)) / joint.rate - 1.0
        yield "acceleration", float(faster[:, i].max(initial=0.0)) / joint.acceleration - 1.0
    assert isinstance(asked.rates.bend, float)
    assert isinstance(asked.rates.length, float)
    yield "rate of bends", float(np.hypot(moved[..., 0], moved[..., 1]).max(initial=0.0)) / asked.rates.bend - 1.0
    yield "rate of lengths", float(np.abs(moved[..., 2]).max(initial=0.0)) / asked.rates.length - 1.0
    if asked.rates.actuator is not None:
        yield from _of_motors(asked, way)
    further = asked.rates.acceleration
    if further is not None:
        assert isinstance(further.bend, float)
        changes = np.diff(moved, axis=0) / (0.5 * (times[1:] + times[:-1]))[:, None, None]
        yield "acceleration", float(np.hypot(changes[..., 0], changes[..., 1]).max(initial=0.0)) / further.bend - 1.0


def _of_motors(asked: Asked, way: Went) -> Iterator[tuple[str, float]]:
    """Yield the same of what motors count: finely sampled on steps linear in q, and evenly from knot to knot."""
    rates, robot = asked.rates, asked.robot
    assert rates is not None
    assert isinstance(rates.actuator, float)
    times, looks = np.diff(way.times), np.linspace(0.0, 1.0, 257)[:, None, None]
    for one, other, dt in zip(way.q[:-1], way.q[1:], times.tolist(), strict=True):
        moved = np.abs(np.diff(robot.to_actuators((1.0 - looks) * one + looks * other), axis=0)).max()
        yield "rate of motors", float(moved) * (len(looks) - 1) / dt / rates.actuator - 1.0
    if rates.acceleration is not None:
        assert isinstance(rates.acceleration.actuator, float)
        speeds = np.diff(robot.to_actuators(way.q), axis=0) / times[:, None]
        faster = np.abs(np.diff(speeds, axis=0)) / (0.5 * (times[1:] + times[:-1]))[:, None]
        yield "acceleration of motors", float(faster.max(initial=0.0)) / rates.acceleration.actuator - 1.0


@pytest.mark.parametrize("kind", ROBOTS)
@pytest.mark.parametrize("limit", LIMITS)
@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_keeps_every_limit_or_refuses_in_a_line(verb: str, limit: str, kind: str) -> None:
    try:
        asked = asked_of(verb, limit, kind)
        way = VERBS[verb](asked)
    except sn.InputError as error:
        refusal = str(error)
    else:
        assert not refuses(verb, limit, kind)
        _judge(asked, way, verb == "step")
        return
    assert refuses(verb, limit, kind), refusal
    assert "\n" not in refusal


def _judge(asked: Asked, way: Went, wished: bool) -> None:
    allowed = {"acceleration": WISHED, "acceleration of motors": MANY_WISHED if wished else 1e-6}
    for name, excess in excesses(asked, way):
        assert excess <= 2.0 * SLACK, name
    if asked.rates is not None and len(way.q) > 1:
        for name, excess in speeds(asked, way):
            assert excess <= allowed.get(name, 1e-6), name


@pytest.mark.parametrize("limit", LIMITS)
@pytest.mark.parametrize("verb", ["solve", "step", "plan", "track", "timed"])
def test_a_verb_that_does_not_refuse_a_limit_finds_what_it_claims(verb: str, limit: str) -> None:
    """A table of ways that end where they begin would say nothing."""
    kind = "elastic" if limit == "tension" else "free"
    if refuses(verb, limit, kind):
        return
    asked = asked_of(verb, limit, kind)
    way = VERBS[verb](asked)
    assert len(way.q) > (0 if verb == "solve" else 1)
    assert way.claimed or (verb == "timed" and asked.rates is not None)


@pytest.mark.parametrize("verb", ["plan", "step"])
def test_ways_under_load_are_found_within_tensions(verb: str) -> None:
    assert VERBS[verb](asked_of(verb, "tension", "loaded")).claimed
