"""What may be meant but hardly is: lengths in units that do not fit together, degrees for radians; a line each.

Every length is compared with that of the robot. Nothing is changed for what is suspicious.
"""

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from sinuous.base import words
from sinuous.model.joints import Revolute, joint_names
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.scene.mesh import Mesh
from sinuous.scene.point_cloud import PointCloud
from sinuous.scene.snapshot import Snapshot

ODD = 300.0
"""How many times larger than the robot, or smaller, something is when it is probably in another length unit. Parts of
a few robot lengths in mm, beside a robot in m, are some hundred to some thousand times too large."""

ODD_FILE = 100.0
"""The same of meshes and clouds, whose files do not say their unit."""

THIN, LINE = 1e4, 5e5
"""How many times longer than its radius, or than the arm of its tendons, a robot is when these are in another unit; one
that is thinner still is meant as a line."""

LONG_TOOL = 10.0
"""How many times longer than the robot its tool is when that is in another unit."""

SHORT_TOOL, NO_TOOL = 400.0, 1e5
"""How many times longer than the tool a segment is when the tool is in another unit; one that is shorter still is a
small change of a tool, as of a difference quotient."""

TIGHT, SLACK = 50.0, 300.0
"""How many times smaller, or larger, than what the largest bends need the limits of tendons are in another unit."""

KEPT = 64
"""Robots of which is kept what is suspicious."""

FULL_TURN = 2.0 * math.pi


def suspicions(robot: Robot, scene: Snapshot) -> list[str]:
    """What is suspicious of a robot in a scene; one line each."""
    return [*_of_robot(robot), *_of_obstacles(robot, scene)]


def all_suspicions(robot: Robot, scene: Snapshot, waypoints: Sequence[Sequence[Target]]) -> list[str]:
    """The same, with what is suspicious of the base and of targets: what a solve says in its status."""
    return [*suspicions(robot, scene), *_of_base(robot, scene.first), *_of_targets(robot, waypoints)]


@lru_cache(maxsize=KEPT)
def _of_robot(robot: Robot) -> tuple[str, ...]:
    """What is suspicious of a robot alone."""
    thick = robot.thick_notes
    return *_of_angles(robot), *_of_lengths(robot), *_of_loads(robot), *thick


def _longest(robot: Robot) -> float:
    return robot.longest or robot.mean_length


def _of_angles(robot: Robot) -> Iterator[str]:
    for numbers, most in words.grouped({k: s.max_bend for k, s in enumerate(robot.segments, 1)}):
        if most > FULL_TURN * (1.0 + 1e-9):
            which = words.segments(numbers, len(robot.segments))
            yield f"max_bend of {which} is {most:.4g} rad, more than a full turn; is it in degrees?"
    for k, segment in enumerate(robot.segments, 1):
        if float(np.hypot(*segment.rest)) > FULL_TURN * (1.0 + 1e-9):
            yield f"rest of segment {k} is more than a full turn; is it in degrees?"
        if segment.plane is not None and abs(segment.plane) > FULL_TURN * (1.0 + 1e-9):
            yield f"plane of segment {k} is at {segment.plane:.4g} rad, more than a full turn; is it in degrees?"
        for key in ("tendons", "chambers"):
            lines = getattr(segment, key)
            if lines is None:
                continue
            sizes = np.abs(lines.angles)
            if sizes.max() > 2.0 * FULL_TURN or sizes.min() > FULL_TURN * (1.0 + 1e-9):
                said = ", ".join(f"{angle:.4g}" for angle in lines.angles[:4])
                yield f"{key} of segment {k} stand at {said} rad, more than a full turn; are these degrees?"
    for joint, name in zip(robot.joints, joint_names(robot.joints), strict=True):
        most = max(map(abs, joint.limits))
        if isinstance(joint, Revolute) and most > 2.0 * FULL_TURN * (1.0 + 1e-9):  # wrists may turn once, both ways
            yield f"joint '{name}' turns up to {most:.4g} rad, more than two full turns; are its limits in degrees?"


def _of_lengths(robot: Robot) -> Iterator[str]:
    """Compare the radii, tool and limits of tendons of a robot with its length."""
    length = _longest(robot)
    ask = "are both in one length unit?"
    for key, radii, most in (
        ("radius", [segment.radius for segment in robot.segments], 1.0),
        ("radius of the tendons", [s.tendons.radius for s in robot.rows if s.tendons is not None], 1.0),
    ):
        odd = [radius for radius in radii if radius > most * length or length / LINE < radius < length / THIN]
        if odd:
            yield f"the {key} is {odd[0]:.4g}, the robot {length:.4g} long; {ask}"
    tool = float(np.linalg.norm(robot.tool[:3, 3]))
    segment_length = max((segment.length[1] for segment in robot.segments), default=length)
    if tool > LONG_TOOL * length or segment_length / NO_TOOL < tool < segment_length / SHORT_TOOL:
        yield f"the tool is {tool:.4g} long, the robot {length:.4g}; {ask}"
    for k, segment in enumerate(robot.segments, 1):
        if segment.tendons is None or segment.max_bend == 0.0:
            continue
        limits = np.abs(segment.tendons.displacements)
        most = float(limits[np.isfinite(limits)].max(initial=0.0))
        needed = segment.tendons.radius * segment.max_bend
        if 0.0 < most * TIGHT < needed or most > SLACK * needed * len(robot.segments):
            yield f"tendons of segment {k} move by at most {most:.4g}, its largest bend takes {needed:.4g}; {ask}"


def _of_loads(robot: Robot) -> Iterator[str]:
    """Compare what a robot carries with what bends it by a radian: a thousandth or thousandfold is another unit."""
    if robot.gravity is None and robot.payload:
        yield "the payload weighs nothing without gravity; gravity=(0, 0, -9.81) is that of the earth, for lengths in m"
    soft = [segment.stiffness.bend for segment in robot.rows if segment.stiffness is not None]
    if robot.gravity is None or not soft:
        return
    masses = [segment.mass * segment.length[1] for segment in robot.rows] + [each.mass for each in robot.payload]
    length = _longest(robot)
    bent = sum(masses) * float(np.linalg.norm(robot.gravity)) * length**2 / min(soft)
    if bent > ODD or 0.0 < bent < 1.0 / ODD**2:
        much = "hangs like a thread" if bent > ODD else "is not bent at all"
        yield (
            f"weight x length^2 / stiffness is {bent:.3g}, the robot {much}; "
            "are gravity, mass and stiffness in one set of units?"
        )


def _of_obstacles(robot: Robot, scene: Snapshot) -> Iterator[str]:
    length = _longest(robot)
    sizes, together = scene._sizes
    large = {} if max(sizes.values(), default=0.0) <= min(ODD, ODD_FILE) * length else sizes
    for i, size in large.items():
        of_file = isinstance(scene.obstacles[i], Mesh | PointCloud)
        if size > (ODD_FILE if of_file else ODD) * length:
            yield f"{scene.name(i)} is {size:.4g} large, the robot {length:.4g} long; are both in one length unit?"
    if sizes and len(sizes) == len(scene) and ODD * together < length:
        yield f"all obstacles lie within {together:.4g}, the robot is {length:.4g} long; are both in one length unit?"


def _of_base(robot: Robot, scene: Snapshot) -> Iterator[str]:
    if len(scene) and robot.mount == 0.0:
        place = robot.base[:3, 3]
        if float(scene.at_most(place)) < robot.radii[0]:
            name = scene.name(int(scene.nearest(place)))
            yield f"the base touches {name}; where the robot stands on it or sits in it, say so with mount"


def _of_targets(robot: Robot, waypoints: Sequence[Sequence[Target]]) -> Iterator[str]:
    length = _longest(robot)
    places = [target.position for targets in waypoints for target in targets if target.position is not None]
    distances = [float(np.linalg.norm(place - robot.base[:3, 3])) for place in places]
    far = max(distances, default=0.0)
    if far > ODD * length:
        yield f"a target is {far:.4g} from the base, the robot {length:.4g} long; are both in one length unit?"
    elif 0.0 < far * ODD < length:
        yield f"every target is within {far:.4g} of the base, the robot {length:.4g} long; are both in one length unit?"
