"""Chains grown along routes: for bodies that cannot turn as tightly as a route does, or are much longer than it.

Where a body is longer than its route, the route is lengthened first: it is led aside by places that it sees, in many
ways, until it is as long as the robot.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.fitting.fit import fit_workspace_size
from sinuous.kernels.fitting.query import ball_radius, route_query
from sinuous.kernels.fitting.settle import settle_chain
from sinuous.kernels.growing.beam import (
    CHAIN_WIDTH,
    COST,
    END_DISTANCE,
    FRAME,
    LAST_SEGMENT_Q,
    PARENT,
    SCORE,
    SEGMENT_BEFORE_Q,
)
from sinuous.kernels.growing.detours import LONG_ENOUGH, MOST_DETOURS, NUMBERS, add_detours, detours_size
from sinuous.kernels.growing.grow import grow_chains, growing_size
from sinuous.kernels.tables import (
    HAS_POSITION,
    MAX_LENGTH,
    MIN_LENGTH,
    POSE_WIDTH,
    QUERY_AXIS,
    QUERY_BACK,
    QUERY_FREE_LENGTH,
    QUERY_GOAL,
    QUERY_LONGEST,
    QUERY_ORIGIN,
    QUERY_SHORTEST,
    QUERY_STRAIGHT_MAX,
    QUERY_STRAIGHT_MIN,
    QUERY_WIDTH,
    ROBOT_HEADER,
    SEGMENT_WIDTH,
    TARGET_POSITION,
    TARGET_SEGMENT,
)
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along, respaced
from sinuous.solver.routing.partial_problems import Groups, segments_in

FIRST_WIDTH, LAST_WIDTH = 4, 1024
"""Chains of every number of segments that are kept, at first and at most: powers of two. The widest beam takes 4 MB for
a robot of 20 segments."""

LEG_POINTS = 160
"""Points of each leg of a route."""


def _in_order(groups: Groups) -> dict[int, int]:
    """By each segment whose end is asked to be somewhere, from the base on, the number of the target that says so."""
    robot, _, _, targets = groups
    last, order = int(robot[0]) - 1, dict[int, int]()
    for number, row in enumerate(targets[:, : HAS_POSITION + 1].tolist()):
        if row[HAS_POSITION] != 0.0:
            order.setdefault(last if row[TARGET_SEGMENT] < 0.0 else int(row[TARGET_SEGMENT]), number)
    return dict(sorted(order.items()))


def segments_of(groups: Groups) -> list[int]:
    """Return the segments whose ends are asked to be somewhere, from the base on."""
    return list(_in_order(groups))


def query_of(groups: Groups) -> Floats | None:
    """Return what a route to the most distal target has to keep (27,); `None`: no target has a position.

    See `sinuous.kernels.tables`.
    """
    query = np.zeros(QUERY_WIDTH)
    return query if route_query(*groups, query) else None


def leg_queries(groups: Groups) -> list[Floats]:
    """What routes have to keep from target to target (l, 28): none where one target has a position, or none has.

    Each leg begins where the one before it ends. See `sinuous.kernels.tables`.
    """
    robot, scene, settings, targets = groups
    order = list(_in_order(groups).values())
    queries = []
    for target in order if len(order) > 1 else ():
        query = np.zeros(QUERY_WIDTH)
        route_query(robot, scene, settings, targets[target : target + 1].copy(), query)
        queries.append(query)
    for last, query in zip(queries[-2::-1], queries[:0:-1], strict=True):
        set_route_start(query, last[QUERY_GOAL : QUERY_GOAL + 3], -last[QUERY_BACK : QUERY_BACK + 3])
        query[[QUERY_SHORTEST, QUERY_LONGEST]] -= last[[QUERY_SHORTEST, QUERY_LONGEST]]
    return queries


def set_route_start(query: Floats, place: Floats, along: Floats) -> None:
    """Let the route of a query begin at a place (3,) with a unit tangent (3,), without what the base asks for."""
    query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_AXIS : QUERY_AXIS + 3] = place, along
    query[[QUERY_FREE_LENGTH, QUERY_STRAIGHT_MIN, QUERY_STRAIGHT_MAX]] = 0.0


def set_route_end(query: Floats, place: Floats, along: Floats) -> None:
    """Let the route of a query end at a place (3,) with a unit tangent (3,)."""
    query[QUERY_GOAL : QUERY_GOAL + 3], query[QUERY_BACK : QUERY_BACK + 3] = place, -along


def divide_route(groups: Groups, route: Floats, near: float) -> Floats | None:
    """Return the legs (l, K, 3) of a route (K, 3), from target to target, where it leads past all of them this near.

    Then no route has to be searched for from one to the next.
    """
    targets, legs = groups[3], []
    points, intermediate = route, list(_in_order(groups).values())[:-1]
    for target in intermediate:
        place = targets[target, TARGET_POSITION : TARGET_POSITION + 3]
        gaps = np.linalg.norm(points - place, axis=1)
        at = int(gaps.argmin())
        if gaps[at] > near or not 1 < at < len(points) - 2:
            return None
        legs.append(respaced(np.vstack([points[:at], place]), LEG_POINTS))
        points = np.vstack([place, points[at + 1 :]])
    return np.stack([*legs, respaced(points, LEG_POINTS)])


class GrownChains:
    """Chains of every number of segments, from one end on.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        The legs of a route, from target to target, evenly spaced, in the length unit.
    terminal_poses : ndarray (r, 12)
        Poses in which chains may begin.
    width : int
        Chains of every number of segments that are kept: a power of two.
    seconds : float
    open_from : float
        Distance from the obstacles, in radii of the body, from which on an end is in the open: there they stop. By
        default they go on to the last target.

    Attributes
    ----------
    segments : int
        Of a chain that gets to the last target.
    open : bool
        Whether some end in the open: those with the most segments.
    counts : ndarray (n + 1,) int
        How many chains there are, by their number of segments.
    frames : ndarray (n + 1, w, 12)
        Poses of their ends.
    costs, scores : ndarray (n + 1, w)
        What is amiss with them by now, and in what is expected of them.
    """

    def __init__(
        self,
        groups: Groups,
        legs: Floats,
        terminal_poses: Floats,
        width: int,
        seconds: float,
        open_from: float = math.inf,
    ) -> None:
        n, obstacles = int(groups[0][0]), int(groups[1][0])
        self.segments = segments_of(groups)[len(legs) - 1] + 1
        self.counts = np.zeros(n + 1, np.int64)
        self._levels = levels = np.zeros((n + 1, width, CHAIN_WIDTH))
        workspace = np.empty(growing_size(obstacles, width))
        self.open: bool = grow_chains(
            *groups, legs, terminal_poses, open_from, max(0.0, seconds), workspace, levels, self.counts
        )
        self._open_from = open_from
        self.frames = levels[..., FRAME : FRAME + POSE_WIDTH]
        self.costs, self.scores = levels[..., COST], levels[..., SCORE]
        self._rest = np.zeros((n, 3))
        self._rest[:, 2] = groups[0][ROBOT_HEADER:][: SEGMENT_WIDTH * n].reshape(n, SEGMENT_WIDTH)[:, MIN_LENGTH]

    @property
    def complete_count(self) -> int:
        """How many chains get to the last target."""
        return int(self.counts[self.segments])

    def outside(self) -> tuple[int, list[int]]:
        """Number of segments of the chains that end in the open, and their numbers, the best first."""
        last = int(np.flatnonzero(self.counts)[-1])
        return last, np.flatnonzero(self._levels[last, : self.counts[last], END_DISTANCE] >= self._open_from).tolist()

    def parent(self, k: int, i: int) -> int:
        """Number of the chain of one segment less that chain number `i` of `k` segments continues."""
        return int(self._levels[k, i, PARENT])

    def chain(self, k: int, i: int) -> tuple[Floats, Floats]:
        """Return chain (k, 3) number `i` of `k` segments, and the pose (12,) in which it begins."""
        q = np.empty((k, 3))
        for at in range(k, 0, -1):
            if at == k:
                q[at - 1] = self._levels[at, i, LAST_SEGMENT_Q : LAST_SEGMENT_Q + 3]
            if at > 1:
                q[at - 2] = self._levels[at, i, SEGMENT_BEFORE_Q : SEGMENT_BEFORE_Q + 3]
            i = self.parent(at, i)
        return q, self.frames[0, i]

    def complete_chain(self, i: int) -> tuple[Floats, Floats]:
        """Return chain (n, 3) number `i` of those that get to the last target, and the pose in which it begins.

        Segments beyond that target are as short as they can be.
        """
        q, terminal_pose = self.chain(self.segments, i)
        return np.concatenate([q, self._rest[self.segments :]]), terminal_pose


def settle_chains(groups: Groups, chains: Iterable[Floats], deadline: Deadline) -> Iterator[Floats]:
    """Yield every chain (n, 3), drawn to the targets in short steps, while there is time."""
    robot, scene, _, targets = groups
    workspace = np.empty(fit_workspace_size(int(robot[0]), int(robot[1]), int(scene[0]), len(targets)))
    for chain in chains:
        seconds = deadline()
        if seconds <= 0.0:
            return
        q = chain.copy()
        settle_chain(*groups, seconds, workspace, q)
        yield q


POINTS = 64
"""Points of a leg that are looked at."""

GOLDEN = 0.618034
"""Share of what a leg may be longer by which one detour differs from the next."""


def lengthen_route(groups: Groups, legs: Floats, number: int, deadline: Deadline) -> Floats | None:
    """Return the legs (l, K, 3) of a route, each as long as some of its segments may be; `None`: none becomes longer.

    Parameters
    ----------
    groups : tuple of ndarray
        The problem, see `Groups`.
    legs : ndarray (l, K, 3)
        Evenly spaced, in the length unit.
    number : int
        Of the detour: each leads somewhere else.
    deadline : callable
        See `Deadline`.
    """
    segments, rng = segments_in(groups[0]), np.random.default_rng(number)
    ends = [0, *(1 + last for last in segments_of(groups)[: len(legs)])]
    workspace, longer, some = np.empty(detours_size(POINTS)), legs.copy(), False
    for i, leg in enumerate(legs):
        own = segments[ends[i] : ends[i + 1]]
        least, most = own[:, MIN_LENGTH].sum(), own[:, MAX_LENGTH].sum()
        length = lengths_along(leg)[-1]
        least = max(least, length)
        wanted = least + ((1 + number) * GOLDEN % 1.0) * (most - least)
        if length < LONG_ENOUGH * wanted:
            points, numbers = respaced(leg, POINTS), rng.random((MOST_DETOURS, NUMBERS))
            left = max(0.0, deadline())
            if (
                add_detours(groups[1], wanted, ball_radius(segments), numbers, left, workspace, points)
                > length / LONG_ENOUGH
            ):
                longer[i], some = respaced(points, LEG_POINTS), True
    return longer if some else None
