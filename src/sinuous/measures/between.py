"""The way between knots, linear in q, looked at densely: how near the body comes to obstacles and to itself.

Kinematics are those of SciPy's rotations, see `following`; distances are those of `obstacles`.
"""

import math

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.measures.body import Meeting, free_shares, nearest_pair, places_of
from sinuous.measures.following import PLACES, backbones, together
from sinuous.measures.obstacles import measure
from sinuous.model.robot import Robot
from sinuous.scene.snapshot import Snapshot

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
    robot: Robot, scene: Snapshot, q: Floats
) -> tuple[Floats, Floats, NDArray[np.intp], NDArray[np.intp]]:
    """Least clearance (T,) over sampled places of the body beyond the mount, in configurations (T, n, 3).

    And the least beyond what is demanded (T,), and the segment and the obstacle (T,) where the first is, 0 = first; -1
    where there is nothing to be clear of.
    """
    least, spare = np.full((2, len(q)), math.inf)
    segments, obstacles = np.full((2, len(q)), -1, np.intp)
    for part in together(len(q), q.shape[1]) if len(scene) else ():
        begin, beyond = free_shares(robot, q[part, :, 2])
        places, _ = backbones(robot, q[part], begin)
        for i, obstacle in enumerate(scene.obstacles):
            gaps = measure(obstacle, places.reshape(-1, 3)).reshape(places.shape[:3]).min(axis=2) - robot.radii
            gaps[~beyond] = math.inf
            spare[part] = np.minimum(spare[part], (gaps - robot.clearance).min(axis=1))
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
        for one, points, tangents in zip(q[part], *backbones(robot, q[part], np.zeros(q[part].shape[:2])), strict=True):
            places = places_of(robot, one, points[:, ::every], tangents[:, ::every])
            least = min(least, nearest_pair(places), key=lambda each: each.gap)
    return least
