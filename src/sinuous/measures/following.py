"""How far a body is off a curve that it should follow, by sampling; and the way between knots, looked at densely.

Ways are linear in q; it is looked how near the body comes to obstacles and to itself. Kinematics are those of `body`,
distances those of `obstacles`.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sinuous.base.arguments import Rows
from sinuous.base.checks import Floats
from sinuous.base.frozen import call
from sinuous.measures.body import Meeting, arc_poses, free_shares, nearest_pair, places_of, segment_ends
from sinuous.measures.obstacles import measure, seen_from, that_matter
from sinuous.model.robot import Robot
from sinuous.problem.path import Curve
from sinuous.scene.snapshot import Snapshot

PLACES = 50
"""Places of every segment."""

TOGETHER = 200_000
"""Places that are looked at together."""

HERE = 1e-6
"""What is nearer to the base begins there, in lengths of the robot."""


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
    steps = arc_poses(q.reshape(-1, 3), PLACES, begin.ravel()).reshape(*q.shape[:2], PLACES + 1, 4, 4)
    poses = segment_ends(robot, q)[:, :-1, None] @ steps
    return poses[..., :3, 3], poses[..., :3, 2]


STRIDE = 0.01
"""How far a place of the body may move from one configuration that is looked at to the next, in lengths of the body."""

ENOUGH, THINNED = 400, (1, 2, 5, 10)
"""Places of the body that are held against each other, about, and every how many of `PLACES` are taken for that."""

FEWEST, MOST = 4, 400
"""Parts that a step is divided into."""


def shares_between(robot: Robot, one: Floats, other: Floats) -> Floats:
    """Shares (k,) of the step from one configuration (n, 3) to another at which it is looked at, both ends included.

    A bend moves what lies beyond it by at most its change times the length of that.
    """
    lengths = np.maximum(one[:, 2], other[:, 2])
    levers = np.cumsum(lengths[::-1])[::-1]
    change = other - one
    far = float(np.hypot(change[:, 0], change[:, 1]) @ levers + np.abs(change[:, 2]).sum())
    parts = far / (STRIDE * levers[0]) if levers[0] > 0.0 else 0.0
    return np.linspace(0.0, 1.0, int(np.clip(math.ceil(parts), FEWEST, MOST)) + 1)


def least_clearances(
    robot: Robot, scene: Snapshot, q: Floats, when: Floats | None = None
) -> tuple[Floats, Floats, NDArray[np.intp], NDArray[np.intp]]:
    """Least clearance (T,) over sampled places of the body beyond the mount, in configurations (T, n, 3).

    And the least beyond what is demanded (T,), and the segment and the obstacle (T,) where the first is, 0 = first; -1
    where there is nothing to be clear of. Times (T,), 0 by default, say where obstacles are that move.
    """
    when = np.zeros(len(q)) if when is None else when
    least, spare = np.full((2, len(q)), math.inf)
    demanded = np.subtract(robot.needed_radii, robot.radii)
    segments, obstacles = np.full((2, len(q)), -1, np.intp)
    for part in together(len(q), q.shape[1]) if len(scene) else ():
        begin, beyond = free_shares(robot, q[part, :, 2])
        places, _ = backbones(robot, q[part], begin)
        sizes = np.where(beyond, np.stack([robot.radii, robot.needed_radii])[:, None], -math.inf)
        for i, near in that_matter(scene.obstacles, places, sizes, when[part]):
            gaps = np.full(near.shape, math.inf)
            obstacle, seen = seen_from(scene.obstacles[i], places[near], when[part][np.nonzero(near)[0]])
            found = measure(obstacle, seen.reshape(-1, 3)).reshape(-1, places.shape[2])
            gaps[near] = found.min(axis=1)
            gaps -= robot.radii
            gaps[~beyond] = math.inf
            spare[part] = np.minimum(spare[part], (gaps - demanded).min(axis=1))
            nearest = gaps.argmin(axis=1)
            own = gaps[np.arange(len(gaps)), nearest]
            nearer = own < least[part]
            least[part] = np.where(nearer, own, least[part])
            segments[part] = np.where(nearer, nearest, segments[part])
            obstacles[part] = np.where(nearer, i, obstacles[part])
    return least, spare, segments, obstacles


def least_meeting(robot: Robot, q: Floats) -> Meeting:
    """Where the body is nearest to itself in any of the configurations (T, n, 3), where that matters."""
    least = Meeting(math.inf, None)
    every = next((step for step in THINNED if q.shape[1] * PLACES <= step * ENOUGH), THINNED[-1])
    for part in together(len(q), q.shape[1]) if robot.avoids_itself else ():
        points, tangents = backbones(robot, q[part], np.zeros(q[part].shape[:2]))
        places = places_of(robot, q[part], points[:, :, ::every], tangents[:, :, ::every])
        least = min(least, nearest_pair(places), key=lambda each: each.gap)
    return least
