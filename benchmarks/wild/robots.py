"""Robots of all sorts: fixed and extensible segments, insertion stages, rigid links, tendons, chambers, any scale."""

import math
from typing import Any

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.judges.kinematics import arm_of, bend_caps, moving
from benchmarks.judges.self_collision import look, surely_clear
from benchmarks.problems import in_ball
from sinuous.base.checks import Floats
from sinuous.model.joints import Fixed, Joint, Prismatic, Revolute

SIZES = ((1, 4), (4, 9), (9, 17), (17, 41))
"""Ranges of the number of segments, each without its end."""

SIZE_SHARES = (0.4, 0.4, 0.13, 0.07)

SCALES = (-6.0, 3.5)
"""Powers of ten between which a segment is long: micrometres to kilometres."""

TIGHTEST = 0.98
"""Largest curvature of a hidden shape, of one over its radius: a body that avoids itself bends no tighter than that."""

JOINTED_SCALES, MOST_JOINTS, MOST_SEGMENTS = (-4.0, 3.0), 8, 6
"""The same of arms with joints; and how many joints, and segments, these have at most."""

DRAWS = 16
"""Times that shapes are drawn, more and more gently bent, until they are clear of themselves."""


def robot_with_shapes(count: int, rng: Generator, scales: tuple[float, float] = SCALES) -> tuple[sn.Robot, Floats]:
    """Draw a robot, and up to `count` configurations (m, n, 3) within its limits that are clear of themselves.

    `scales` are the powers of ten between which a segment is long.
    """
    size = int(rng.integers(*SIZES[rng.choice(len(SIZES), p=SIZE_SHARES)]))
    unit = 10.0 ** rng.uniform(*scales)
    segments = draw_segments(size, unit, rng)
    place: dict[str, Any] = {
        "mount": rng.uniform(0.0, 0.8) * unit if rng.random() < 0.15 else 0.0,
        "base": sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)) if rng.random() < 0.7 else None,
        "tool": sn.pose(0.5 * unit * in_ball(rng), rotation=rng.normal(size=4)) if rng.random() < 0.15 else None,
    }
    robot = sn.Robot(segments, **place)
    q = shapes_of(robot, count, rng)
    if len(q) and rng.random() < 0.15:
        robot = sn.Robot(_driven(segments, q, unit, rng), **place)
    return robot, q


def draw_segments(size: int, unit: float, rng: Generator) -> list[sn.Segment]:
    """Draw segments all alike, or each of its own sort; at least one can bend."""
    thin = rng.random() < 0.1
    radius = 0.0 if thin else unit * 10.0 ** rng.uniform(-3.0, -0.6)
    widest = rng.choice([math.pi, rng.uniform(0.4, math.pi), rng.uniform(math.pi, 6.0)], p=[0.15, 0.35, 0.5])
    tapered = not thin and rng.random() < 0.2
    alike = rng.random() < 0.5
    first = _bending(unit, widest, radius, rng)
    drawn = [first if alike else _any(unit, widest, radius, rng) for _ in range(size - 1)] + [first]
    if size > 1 and rng.random() < 0.15:
        drawn[0] = sn.Segment((0.0, unit * rng.uniform(0.5, 3.0)), 0.0, None, radius)  # an insertion stage
    if not tapered:
        return drawn
    return [each.changed(radius=each.radius * rng.uniform(0.5, 1.0)) for each in drawn]


def _any(unit: float, widest: float, radius: float, rng: Generator) -> sn.Segment:
    """Draw a segment that bends, a rigid link, or a straight one that stretches."""
    own = unit * rng.uniform(0.5, 1.5)
    kind = rng.choice(["bending", "rigid", "straight"], p=[0.82, 0.12, 0.06])
    if kind == "rigid":
        return sn.Segment((own, own), 0.0, None, radius)
    if kind == "straight":
        return sn.Segment((0.3 * own, own), 0.0, None, radius)
    return _bending(own, widest * rng.uniform(0.5, 1.0), radius, rng)


def _bending(own: float, max_bend: float, radius: float, rng: Generator) -> sn.Segment:
    low = own * rng.choice([1.0, rng.uniform(0.5, 0.95), 0.0], p=[0.5, 0.42, 0.08])
    curvature = rng.uniform(1.0, 6.0) / own if rng.random() < 0.25 else None
    return sn.Segment((low, own), max_bend, curvature, radius)


def shapes_of(robot: sn.Robot, count: int, rng: Generator) -> Floats:
    """Return shapes that are surely clear of themselves; those that fail are drawn anew, each time more gently bent."""
    found = np.empty((0, len(robot), 3))
    most = 1.0
    for _ in range(DRAWS):
        drawn = draw_shapes(robot, count - len(found), most, rng)
        found = np.concatenate([found, drawn[surely_clear(robot, drawn)]])
        if len(found) == count:
            break
        most *= 0.85
    return found


def draw_shapes(robot: sn.Robot, count: int, most: float, rng: Generator) -> Floats:
    """Draw shapes that use `most` of the bends they may have; a few segments are at the limit of their length."""
    low, high = np.array([segment.length for segment in robot.segments]).T
    size = count, len(robot)
    share = rng.random(size)
    share = np.where(rng.random(size) < 0.05, np.round(share), share)
    lengths = low + (high - low) * share
    radii = np.array(robot.radii)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.where(radii > 0.0, TIGHTEST * lengths / radii, math.inf)
    norms = most * np.minimum(bend_caps(robot, lengths), own) * np.sqrt(rng.random(size))
    angles = 2.0 * math.pi * rng.random(size)
    return np.stack([norms * np.cos(angles), norms * np.sin(angles), lengths], axis=-1)


def _driven(segments: list[sn.Segment], q: Floats, unit: float, rng: Generator) -> list[sn.Segment]:
    """Give some segments tendons, or some chambers, with limits that the shapes (m, n, 3) just keep.

    The others get tendons without limits: what no actuator bends would be locked.
    """
    by_tendons = rng.random() < 0.6
    driven = []
    for k, segment in enumerate(segments):
        driven.append(segment.changed(tendons=sn.Tendons(3, 0.1 * unit)) if segment.max_bend > 0.0 else segment)
        if segment.max_bend == 0.0 or rng.random() < 0.4:
            continue
        arm, first, slack = unit * rng.uniform(0.02, 0.2), rng.uniform(0.0, math.pi), rng.uniform(1.0001, 1.5)
        angles = first + 2.0 * math.pi * np.arange(3) / 3.0
        arms = arm * np.stack([np.cos(angles), np.sin(angles)])
        if by_tendons:
            pulled = q[:, : k + 1, :2].sum(axis=1) @ arms
            limits = min(0.0, slack * pulled.min()), max(0.0, slack * pulled.max())
            driven[k] = segment.changed(tendons=sn.Tendons(3, arm, first, displacement=limits))
            continue
        lengths = q[:, k, 2:] - q[:, k, :2] @ arms
        middle, extent = 0.5 * (lengths.min() + lengths.max()), slack * 0.5 * (lengths.max() - lengths.min())
        if lengths.min() >= 0.0:
            limits = max(0.0, middle - extent), middle + extent
            driven[k] = segment.changed(chambers=sn.Chambers(3, arm, first, length=limits))
    return driven


def jointed_robot(rng: Generator) -> sn.Robot:
    """Draw an arm with joints before its segments, or with joints alone, and bodies of links."""
    unit = 10.0 ** rng.uniform(*JOINTED_SCALES)
    joints: list[Joint] = []
    for i in range(int(rng.integers(1, MOST_JOINTS + 1))):
        axis = rng.normal(size=3) if rng.random() < 0.5 else np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
        place = unit * in_ball(rng) if rng.random() < 0.7 else np.zeros(3)
        origin = sn.pose(place, rotation=rng.normal(size=4)) if rng.random() < 0.6 else sn.pose(place)
        body = [_capsule(unit, rng) for _ in range(int(rng.choice([0, 1, 2], p=[0.5, 0.4, 0.1])))]
        kind = rng.choice(["revolute", "prismatic", "fixed"], p=[0.65, 0.2, 0.15]) if i else "revolute"
        touches = [str(rng.choice(["base", *(f"j{k}" for k in range(1, i + 1))]))] if rng.random() < 0.15 else []
        low = rng.uniform(-math.pi, 0.5)
        if kind == "fixed":
            joints.append(Fixed(origin, body=body))
        elif kind == "revolute":
            limits = None if rng.random() < 0.3 else (low, low + rng.uniform(0.1, 4.0))
            joints.append(Revolute(axis, limits, origin, body=body, touches=touches))
        else:
            limits = 0.4 * unit * low, 0.4 * unit * low + unit * rng.uniform(0.1, 2.0)
            joints.append(Prismatic(axis, limits, origin, body=body, touches=touches))
    size = int(rng.integers(0, MOST_SEGMENTS + 1))
    segments = draw_segments(size, unit, rng) if size else []
    return sn.Robot(
        segments,
        joints=joints,
        base=sn.pose(unit * rng.normal(size=3), rotation=rng.normal(size=4)) if rng.random() < 0.7 else None,
        tool=sn.pose(0.5 * unit * in_ball(rng), rotation=rng.normal(size=4)) if rng.random() < 0.3 else None,
    )


def _capsule(unit: float, rng: Generator) -> tuple[Floats, Floats, float]:
    start = 0.1 * unit * in_ball(rng)
    return start, start + unit * rng.uniform(0.0, 0.8) * in_ball(rng), unit * 10.0 ** rng.uniform(-2.5, -0.8)


def draw_jointed(robot: sn.Robot, count: int, most: float, rng: Generator) -> Floats:
    """Draw configurations (m, rows, 3) of an arm with joints, whose segments use `most` of the bends they may have."""
    low, high = np.array([joint.limits for joint in moving(robot.joints)]).T
    arm = arm_of(robot)
    values = low + (high - low) * rng.random((count, len(low)))
    return robot.with_joints(np.zeros((count, 0, 3)) if arm is None else draw_shapes(arm, count, most, rng), values)


def jointed_shapes(robot: sn.Robot, count: int, clear: float, rng: Generator) -> Floats:
    """Draw up to `count` configurations (m, rows, 3) of an arm with joints that are so far from themselves."""
    drawn = draw_jointed(robot, 4 * count, rng.uniform(0.3, 1.0), rng)
    drawn = drawn[look(robot, drawn, 0.0).least > 0.0][:count]
    return np.asarray(drawn[look(robot, drawn, clear).least > clear])
