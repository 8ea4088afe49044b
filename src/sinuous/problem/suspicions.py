"""What may be meant, but hardly is: units that do not fit together, degrees for radians, a body too thick to bend."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from sinuous.base import words
from sinuous.model.limits import held_back
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.scene.extents import box_of
from sinuous.scene.snapshot import Snapshot

ODD = 300.0
"""How many times larger than the robot, or smaller, something is when it is probably in another length unit. Parts of
a few robot lengths in mm, beside a robot in m, are some hundred to some thousand times too large."""

FULL_TURN = 2.0 * math.pi


def suspicions(robot: Robot, scene: Snapshot) -> list[str]:
    """What is suspicious of a robot in a scene; one line each."""
    thick = held_back(robot.segments, robot.self_radii, robot.curvatures)
    return [*_of_bends(robot), *_of_loads(robot), *thick, *_of_obstacles(robot, scene)]


def all_suspicions(robot: Robot, scene: Snapshot, waypoints: Sequence[Sequence[Target]]) -> list[str]:
    """The same, with what is suspicious of the base and of targets: what a solve says in its status."""
    return [*suspicions(robot, scene), *_of_base(robot, scene.first), *_of_targets(robot, waypoints)]


def _of_bends(robot: Robot) -> Iterator[str]:
    for numbers, most in words.grouped({k: s.max_bend for k, s in enumerate(robot.segments, 1)}):
        if most > FULL_TURN * (1.0 + 1e-9):
            which = words.segments(numbers, len(robot))
            yield f"max_bend of {which} is {most:.4g} rad, more than a full turn; is it in degrees?"


def _of_loads(robot: Robot) -> Iterator[str]:
    """Compare what a robot carries with what bends it by a radian: a thousandth or thousandfold is another unit."""
    if robot.gravity is None and robot.payload:
        yield "the payload weighs nothing without gravity; gravity=(0, 0, -9.81) is that of the earth, for lengths in m"
    soft = [segment.stiffness.bend for segment in robot.segments if segment.stiffness is not None]
    if robot.gravity is None or not soft:
        return
    masses = [segment.mass * segment.length[1] for segment in robot.segments] + [each.mass for each in robot.payload]
    length = sum(segment.length[1] for segment in robot.segments)
    bent = sum(masses) * float(np.linalg.norm(robot.gravity)) * length**2 / min(soft)
    if bent > ODD or 0.0 < bent < 1.0 / ODD**2:
        much = "hangs like a thread" if bent > ODD else "is not bent at all"
        yield (
            f"weight x length^2 / stiffness is {bent:.3g}, the robot {much}; "
            "are gravity, mass and stiffness in one set of units?"
        )


def _of_obstacles(robot: Robot, scene: Snapshot) -> Iterator[str]:
    length = sum(segment.length[1] for segment in robot.segments)
    boxes = {i: box for i, each in enumerate(scene.obstacles) if (box := box_of(each)) is not None}
    if not boxes:
        return
    corners = np.array([*boxes.values()])
    sizes = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=-1)
    for i, size in zip(boxes, sizes, strict=True):
        if size > ODD * length:
            yield f"{scene.name(i)} is {size:.4g} large, the robot {length:.4g} long; are both in one length unit?"
    size = float(np.linalg.norm(corners[:, 1].max(axis=0) - corners[:, 0].min(axis=0)))
    if len(boxes) == len(scene) and ODD * size < length:
        yield f"all obstacles lie within {size:.4g}, the robot is {length:.4g} long; are both in one length unit?"


def _of_base(robot: Robot, scene: Snapshot) -> Iterator[str]:
    if len(scene) and robot.mount == 0.0:
        place = robot.base[:3, 3]
        if float(scene.at_most(place)) < robot.radii[0]:
            name = scene.name(int(scene.nearest(place)))
            yield f"the base touches {name}; where the robot stands on it or sits in it, say so with mount"


def _of_targets(robot: Robot, waypoints: Sequence[Sequence[Target]]) -> Iterator[str]:
    length = sum(segment.length[1] for segment in robot.segments)
    places = [target.position for targets in waypoints for target in targets if target.position is not None]
    far = max((float(np.linalg.norm(place - robot.base[:3, 3])) for place in places), default=0.0)
    if far > ODD * length:
        yield f"a target is {far:.4g} from the base, the robot {length:.4g} long; are both in one length unit?"
