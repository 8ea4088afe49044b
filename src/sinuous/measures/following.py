"""How far a body is off a curve that it should follow, by sampling; kinematics are those of SciPy's rotations."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sinuous.base.arguments import Rows
from sinuous.base.checks import Floats
from sinuous.base.frozen import call
from sinuous.model.joints import RigidRow
from sinuous.model.robot import Robot
from sinuous.problem.curve import Curve

PLACES = 50
"""Places of every segment."""

TOGETHER = 200_000
"""Places that are looked at together."""

HERE = 1e-6
"""What is nearer to the base begins there, in lengths of the robot."""

SMALL = 1e-6
"""Bends below which series stand for quotients."""


@dataclass(frozen=True, eq=False, repr=False)
class Deviation:
    """Distances from a curve, over all sampled configurations of a motion; in the length unit.

    The shape is that of the segments that can bend: a straight stage is no merit.

    Attributes
    ----------
    tip, tip_mean : float
        Largest and mean distance of the tip.
    shape, shape_mean : float
        Largest and mean distance of places of the body.
    length : float
        Greatest length of the segments that can bend.
    """

    tip: float
    tip_mean: float
    shape: float
    shape_mean: float
    length: float

    @property
    def shares(self) -> dict[str, float]:
        """The same as shares of `length`."""
        return {key: getattr(self, key) / self.length for key in ("tip", "tip_mean", "shape", "shape_mean")}

    def __repr__(self) -> str:
        tip, tip_mean, shape, shape_mean = (f"{100.0 * share:.3g}" for share in self.shares.values())
        return call("Deviation", [f"tip {tip} %, mean {tip_mean} %", f"shape {shape} %, mean {shape_mean} %"])


def deviation(robot: Robot, q: Floats, curve: Curve) -> Deviation:
    """Measure how far the body in configurations (T, n, 3) is off a curve."""
    bending = [k for k, segment in enumerate(robot.rows) if segment.max_bend > 0.0 and segment.length[1] > 0.0]
    chosen = bending or list(range(len(robot)))
    tips, shapes = [], []
    for part in together(len(q), q.shape[1]):
        places = body_places(robot, q[part])
        shapes.append(curve.distance(places[:, chosen]).ravel())
        tips.append(curve.distance(places[:, -1, -1]))
    tip, shape = np.concatenate(tips), np.concatenate(shapes)
    length = sum(robot.rows[k].length[1] for k in chosen)
    return Deviation(float(tip.max()), float(tip.mean()), float(shape.max()), float(shape.mean()), length)


def line_in_front(robot: Robot, curve: Rows | Curve) -> Curve:
    """Return the curve with a straight line from the base in front, where it begins elsewhere.

    Where joints carry the robot, the line is as long as its segments at most, and leads straight on into the curve.
    """
    own = curve if isinstance(curve, Curve) else Curve(curve)
    base = robot.base[:3, 3]
    if robot.joints:
        behind = sum(segment.length[1] for segment in robot.segments)
        return own if own.lead >= behind else Curve(own.points, start=own.points[0] - behind * own.tangent(own.lead))
    if np.linalg.norm(own.start - base) <= HERE * robot.mean_length:
        return own
    return Curve(own.points if own.lead == 0.0 else np.concatenate([own.start[None], own.points]), start=base)


def together(count: int, segments: int) -> Iterator[slice]:
    """Yield parts of so many configurations that are looked at together."""
    most = max(1, TOGETHER // (segments * PLACES))
    return (slice(i, i + most) for i in range(0, count, most))


def body_places(robot: Robot, q: Floats) -> Floats:
    """Places (T, n, PLACES + 1, 3) of the backbone in configurations (T, n, 3), evenly spaced on every segment."""
    return backbones(robot, q, np.zeros(q.shape[:2]))[0]


def backbones(robot: Robot, q: Floats, begin: Floats) -> tuple[Floats, Floats]:
    """Places (T, n, PLACES + 1, 3) of the backbone in configurations (T, n, 3), and its unit tangents there.

    They are evenly spaced on every segment from the share `begin` (T, n) of it up to its end.
    """
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    frame = Rotation.from_matrix(np.broadcast_to(robot.base[:3, :3], (len(q), 3, 3)))
    start = np.broadcast_to(robot.base[:3, 3], (len(q), 3))
    points, tangents = np.empty((2, *q.shape[:2], PLACES + 1, 3))
    for k in range(q.shape[1]):
        shares = begin[:, k, None] + (1.0 - begin[:, k, None]) * np.linspace(0.0, 1.0, PLACES + 1)
        bend, length = q[:, k, :2], q[:, k, 2]
        angle = np.hypot(bend[:, 0], bend[:, 1])[:, None] * shares
        straight = angle < SMALL
        safe = np.where(straight, 1.0, angle)
        ahead = np.where(straight, 1.0 - angle**2 / 6.0, np.sin(safe) / safe)
        aside = np.where(straight, 0.5, (1.0 - np.cos(safe)) / safe**2)
        local = np.stack([shares**2 * aside * bend[:, i, None] for i in (0, 1)] + [shares * ahead], axis=-1)
        along = np.stack([shares * ahead * bend[:, i, None] for i in (0, 1)] + [np.cos(angle)], axis=-1)
        turn = frame.as_matrix()
        points[:, k] = start[:, None] + np.einsum("tij,tsj->tsi", turn, length[:, None, None] * local)
        tangents[:, k] = np.einsum("tij,tsj->tsi", turn, along)
        start = points[:, k, -1]
        frame = frame * Rotation.from_rotvec(np.stack([-bend[:, 1], bend[:, 0], np.zeros(len(q))], axis=-1))
        row = robot.rows[k]
        if isinstance(row, RigidRow):
            start = start + frame.apply(np.array(row.tail[:3, 3]))
            frame = frame * Rotation.from_matrix(np.array(row.tail[:3, :3]))
    return points, tangents
