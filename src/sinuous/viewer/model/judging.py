"""What is said of a shape that was bent by hand: how far it is from the targets, and what it violates."""

from dataclasses import dataclass

import numpy as np

from sinuous.checks import Floats
from sinuous.measures.body import segment_ends
from sinuous.measures.reach import target_errors
from sinuous.problem.target import Target
from sinuous.robot.limits import Violation
from sinuous.robot.robot import Robot
from sinuous.scene.nearest import least_gap
from sinuous.scene.snapshot import Snapshot

SAMPLES = 16
"""Places of a segment that are held against the obstacles."""


@dataclass(frozen=True)
class Near:
    """Where a body is nearest to the obstacles.

    Attributes
    ----------
    obstacle : str
        Its name.
    distance : float
        From the surface of the body; negative in an overlap.
    body, surface : ndarray (3,)
        The nearest places on both surfaces.
    """

    obstacle: str
    distance: float
    body: Floats
    surface: Floats


@dataclass(frozen=True)
class Judgement:
    """What holds of a shape.

    Attributes
    ----------
    position_error, angle_error : float or None
        Largest over the targets; None where none is asked for.
    violations : tuple
        Limits that it is beyond: which, segment (1 = first), by how much.
    """

    position_error: float | None
    angle_error: float | None
    violations: tuple[Violation, ...]


def judge(robot: Robot, targets: tuple[Target, ...], q: Floats) -> Judgement:
    """Hold a configuration (n, 3) against targets and limits."""
    ends = segment_ends(robot, q)
    errors = [target_errors(robot, target, ends) for target in targets]
    placed = [off for target, (off, _) in zip(targets, errors, strict=True) if target.position is not None]
    turned = [turn for target, (_, turn) in zip(targets, errors, strict=True) if _is_turned(target)]
    return Judgement(max(placed, default=None), max(turned, default=None), tuple(robot.violations(q)))


def _is_turned(target: Target) -> bool:
    return target.direction is not None or target.rotation is not None


def nearest(robot: Robot, scene: Snapshot, q: Floats) -> Near | None:
    """Where the body beyond its mount is nearest to the obstacles; None without any."""
    if not len(scene):
        return None
    points = robot.backbone(q, SAMPLES)
    along = np.concatenate([[0.0], np.cumsum(np.repeat(q[:, 2] / SAMPLES, SAMPLES))])
    radii = np.concatenate([np.repeat(robot.radii, SAMPLES), [robot.radii[-1]]])
    free = along >= min(robot.mount, along[-1])
    found = least_gap(points[free], radii[free], scene)
    if found.place is None or found.obstacle is None:
        return None
    point, radius = points[free][found.place], float(radii[free][found.place])
    away = scene.gradient(point)
    size = float(np.linalg.norm(away))
    away = away / size if size > 0.0 else away
    return Near(found.obstacle, found.distance, point - radius * away, point - (found.distance + radius) * away)
