"""Chains of some of the segments, solved or grown along routes: first ones, those beyond, and those from the target.

Two problems of half the segments are far easier than one of all: where one start of a hundred leads through a gate, and
one of a hundred from there to the target, it is one of ten thousand that does both. Chains are grown for bodies that
cannot turn as tightly as a route does, or are much longer than it: then the route is lengthened first, led aside by
places that it sees, in many ways, until it is as long as the robot.

A chain that is grown out of a narrow place begins along it; one that is grown into it has to arrive along it. So chains
are also grown in the reversed problem, from the target through the route to the base.
"""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.chain.batch import frames_of, points_of
from sinuous.kernels.fitting.fit import fit_route, fit_workspace_size
from sinuous.kernels.fitting.query import ball_radius, route_query
from sinuous.kernels.growing.beam import (
    CHAIN_WIDTH,
    COST,
    END_DISTANCE,
    FRAME,
    LAST_SEGMENT_Q,
    PARENT,
    SCORE,
    SEGMENT_BEFORE_Q,
    beam_size,
)
from sinuous.kernels.growing.detours import LONG_ENOUGH, MOST_DETOURS, NUMBERS, add_detours, detours_size
from sinuous.kernels.growing.grow import grow_chains
from sinuous.kernels.growing.turning import turn_round
from sinuous.kernels.packing import robot_parts
from sinuous.kernels.solve.search import search
from sinuous.kernels.step.states import workspace_size
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
    QUERY_NORMAL,
    QUERY_ORIGIN,
    QUERY_SHORTEST,
    QUERY_WIDTH,
    TARGET_POSITION,
    TARGET_SEGMENT,
    Outcome,
)
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along, respaced

Groups = tuple[Floats, Floats, Floats, Floats]
"""What entries are given of a problem: robot, scene, settings, targets."""

FLIP = np.diag([1.0, -1.0, -1.0])
"""Half a turn about x."""

PARALLEL = 1e-9
"""Bend across a plane up to which segments count as bending in it, rad."""


def common_plane(segments: Floats) -> Floats | None:
    """Return the direction (2,) in which all segments (n, 35) bend, or against it; `None` where they differ.

    Then the body lies in one plane, and how its end is turned about the tangent is known.
    """
    bends, planar = segments[:, t.BEND_SCALE] > 0.0, segments[:, t.IN_PLANE] > 0.0
    if not bends.any() or not planar[bends].all() or segments[:, t.RIGID].any():
        return None
    plane = segments[bends.argmax(), t.PLANE : t.PLANE + 2]
    rests, planes = segments[:, t.REST : t.REST + 2], segments[:, t.PLANE : t.PLANE + 2]
    ends = np.vstack([rests + segments[:, [which]] * planes for which in (t.LOW_BEND, t.HIGH_BEND)])
    return plane if np.abs(ends @ np.array([-plane[1], plane[0]])).max() < PARALLEL else None


def _turned_round(rows: Floats) -> Floats:
    """Rows (n, 35) of segments as they bend the other way round.

    Segments that bend in several planes bend to all sides: how these planes lie depends on how the tip is turned. A
    chain that is turned back is brought into its planes where the solve of the whole robot begins.
    """
    result = rows[::-1].copy()
    if common_plane(rows) is not None:
        result[:, [t.PLANE + 1, t.REST + 1]] *= -1.0
        return result
    planar = result[:, t.IN_PLANE] > 0.0
    result[planar, t.BEND_SCALE] = np.where(result[planar, t.MAX_BEND] > 0.0, 1.0, 0.0)
    result[:, t.IN_PLANE] = 0.0
    return result


def reverse_problem(groups: Groups, terminal_pose: Floats) -> Groups:
    """Return the groups of the problem the other way round, of chains that begin with the pose `terminal_pose` (12,).

    Where the target asks for a rotation, the base is a rotation to end with. Of an intermediate target whose rotation
    is asked for only the direction is kept. The mount is left out, and so are limits of actuators: only the whole robot
    has to keep them.
    """
    robot, scene, settings, targets = groups
    n, parts = int(robot[0]), robot_parts(robot)
    at_tip = np.isin(targets[:, t.TARGET_SEGMENT], (-1.0, n - 1.0))
    tip, intermediate = targets[at_tip][0], targets[~at_tip]
    base, segments = parts.base, _turned_round(parts.segments)
    against = base[: t.POSE_POSITION].reshape(3, 3) @ FLIP
    other = parts._replace(segments=segments, actuators=NO_ACTUATORS, base=terminal_pose, tool=NO_TOOL).group()
    row = np.zeros((1, t.TARGET_WIDTH))
    row[0, t.TARGET_SEGMENT], row[0, t.HAS_POSITION] = -1.0, 1.0
    row[0, t.TARGET_POSITION : t.TARGET_POSITION + 3] = base[t.POSE_POSITION :]
    if tip[t.ORIENTATION] == t.ROTATION:
        row[0, t.ORIENTATION], row[0, t.GOAL : t.GOAL + 9] = t.ROTATION, against.ravel()
    else:
        row[0, t.ORIENTATION], row[0, t.GOAL : t.GOAL + 3] = t.DIRECTION, against[:, 2]
    for target in intermediate:
        target[t.TARGET_SEGMENT] = n - 2.0 - target[t.TARGET_SEGMENT]
        if target[t.ORIENTATION] != t.FREE:
            first, last, step = (0, 3, 1) if target[t.ORIENTATION] == t.DIRECTION else (2, 9, 3)
            ahead = slice(t.GOAL + first, t.GOAL + last, step)
            target[t.ORIENTATION], target[t.GOAL : t.GOAL + 3] = t.DIRECTION, -target[ahead]
    told = settings.copy()
    told[t.MOUNT] = 0.0
    return other, scene, told, np.vstack([intermediate, row])


def problem_from_pose(groups: Groups, terminal_pose: Floats) -> Groups:
    """Return the same problem for a robot that begins with the pose `terminal_pose` (12,)."""
    robot = groups[0].copy()
    robot_parts(robot).base[:] = terminal_pose
    return (robot, *groups[1:])


def reverse_chain(groups: Groups, other: Groups, chain: Floats) -> Floats:
    """Return the configuration (n, 3) of a chain (n, 3) of the problem the other way round."""
    q = np.empty_like(chain)
    turn_round(groups[0], other[0], chain, q)
    return q


def join_chains(groups: Groups, head: Floats, other: Groups, tail: Floats) -> Floats:
    """Return the chain (n, 3) of one part (k, 3), and a part (n - k, 3) of the other problem, which it meets."""
    frames = np.empty((1, len(head) + 1, t.POSE_WIDTH))
    frames_of(
        _rows(groups, head), head[None].copy(), robot_parts(groups[0]).base.reshape(1, t.POSE_WIDTH).copy(), frames
    )
    return np.concatenate([head, reverse_chain(problem_from_pose(groups, frames[0, -1]), other, tail)])


NO_TOOL, NO_ACTUATORS = np.append(np.eye(3).ravel(), np.zeros(3)), np.empty((0, t.ACTUATOR_WIDTH))
"""Pose (12,) of the tip without a tool."""

FEWEST = 8
"""Points of a line that segments are fitted to, at least."""

SAMPLES = 8
"""Points of a backbone for each segment."""

SEED = 0
"""Seed of scattered starts."""

LOOSE, SLANT = 0.25, 0.08
"""How far from a gate the part before it may end: in radii of the body, and in rad."""


def problem_up_to(groups: Groups, count: int) -> Groups:
    """Return the problem of the first `count` segments, without a tool, and of the targets that concern them."""
    robot, scene, settings, targets = groups
    told = _scaled(settings, segments_in(robot)[:count])
    return first_segments(robot, count), scene, told, targets[_segments(groups) < count]


def with_end_tangent(groups: Groups, tangent: Floats) -> Groups:
    """Return the problem to end with a unit tangent (3,), where no target says how."""
    targets = groups[3].copy()
    open_rows = (_segments(groups) == groups[0][0] - 1.0) & (targets[:, t.ORIENTATION] == t.FREE)
    targets[open_rows, t.ORIENTATION], targets[open_rows, t.GOAL : t.GOAL + 3] = t.DIRECTION, tangent
    return (*groups[:3], targets)


def problem_before(groups: Groups, row: Floats) -> Groups:
    """Return the problem of the segments up to a gate, which is a target row (15,): to end there, nearly."""
    robot, scene, told, own = problem_up_to(groups, int(row[t.TARGET_SEGMENT]) + 1)
    last = row.copy()
    last[t.TARGET_SEGMENT] = -1.0
    told[t.POSITION_TOLERANCE] = max(told[t.POSITION_TOLERANCE], LOOSE * ball_radius(segments_in(groups[0])))
    told[t.ANGLE_TOLERANCE] = max(told[t.ANGLE_TOLERANCE], SLANT)
    return robot, scene, told, np.vstack([own, last])


def problem_ending_at(groups: Groups, count: int, end: Floats) -> Groups:
    """Return the problem of the first `count` segments, to end against a pose (12,), as exactly as the target asks for.

    It is turned about its tangent as the pose is only where the target of the tip is a rotation.
    """
    row = np.zeros(t.TARGET_WIDTH)
    row[t.TARGET_SEGMENT], row[t.HAS_POSITION] = count - 1.0, 1.0
    row[t.TARGET_POSITION : t.TARGET_POSITION + 3] = end[t.POSE_POSITION :]
    against = end[: t.POSE_POSITION].reshape(3, 3) @ FLIP
    if groups[3][-1, t.ORIENTATION] == t.ROTATION:
        row[t.ORIENTATION], row[t.GOAL : t.GOAL + 9] = t.ROTATION, against.ravel()
    else:
        row[t.ORIENTATION], row[t.GOAL : t.GOAL + 3] = t.DIRECTION, against[:, 2]
    part = problem_before(groups, row)
    tolerances = [t.POSITION_TOLERANCE, t.ANGLE_TOLERANCE]
    part[2][tolerances] = groups[2][tolerances]
    return part


def problem_beyond(groups: Groups, chain: Floats) -> Groups:
    """Return the problem of what is left of a robot, from where the chain (m, 3) of its first segments ends."""
    robot, scene, settings, targets = groups
    count = len(chain)
    segments, tool = segments_in(robot), robot_parts(robot).tool
    own = targets[_segments(groups) >= count]
    own[:, t.TARGET_SEGMENT] = np.where(own[:, t.TARGET_SEGMENT] < 0.0, -1.0, own[:, t.TARGET_SEGMENT] - count)
    told = _scaled(settings, segments[count:])
    told[t.MOUNT] = max(0.0, told[t.MOUNT] - chain[:, 2].sum())
    return _robot(robot, count, len(segments), end_pose(groups, chain), tool), scene, told, own


def _rows(groups: Groups, chain: Floats) -> Floats:
    """Rows of the segments that a chain (k, 3) is of."""
    return robot_parts(groups[0]).segments[: len(chain)].copy()


def end_pose(groups: Groups, chain: Floats) -> Floats:
    """Return the pose (12,) in which a chain (m, 3) of the first segments ends."""
    base, frames = robot_parts(groups[0]).base, np.empty((1, len(chain) + 1, t.POSE_WIDTH))
    frames_of(_rows(groups, chain), chain[None].copy(), base.reshape(1, t.POSE_WIDTH).copy(), frames)
    return frames[0, -1]


def search_part(groups: Groups, chains: Floats, own: tuple[int, int], deadline: Deadline) -> Outcome:
    """Follow chains (g, n, 3), then own starts, from the first up to, without it, the last: see `search`."""
    (n, actuators), obstacles, targets = (int(x) for x in groups[0][:2]), int(groups[1][0]), len(groups[3])
    best, workspace = np.empty((n, 3)), np.empty(workspace_size(n, actuators, obstacles, targets))
    return Outcome(best, *search(*groups, chains, (*own, SEED, deadline()), workspace, best))


def solve_part(groups: Groups, chains: Floats, starts: int, deadline: Deadline) -> Floats | None:
    """Return a configuration (n, 3) that is proved, from chains (g, n, 3) and scattered starts, or `None`."""
    found = search_part(groups, chains, (0, starts), deadline)
    return found.q if found.code == t.SOLVED else None


def first_segments(robot: Floats, count: int) -> Floats:
    """Return the group of a robot of the first `count` segments, without a tool."""
    return _robot(robot, 0, count, robot_parts(robot).base, NO_TOOL)


def fit_first_segments(groups: Groups, count: int, line: Floats, seconds: float) -> Floats:
    """Return the chain (m, 3) of the first `count` segments along a line (K, 3), that begins where the robot does."""
    robot, scene, settings, targets = groups
    if count == 0:
        return np.empty((0, 3))
    route = respaced(np.vstack([base_position(groups), line[1:]]), max(FEWEST, len(line)))
    return fit_chain(
        (first_segments(robot, count), scene, settings, targets[_segments(groups) < count]), route, seconds
    )


def fit_chain(groups: Groups, route: Floats, seconds: float) -> Floats:
    """Return the chain (n, 3) of a robot along a route (K, 3)."""
    robot, scene, _, targets = groups
    n, actuators = (int(number) for number in robot[:2])
    workspace = np.empty(fit_workspace_size(n, actuators, int(scene[0]), len(targets)))
    q = np.empty((n, 3))
    fit_route(*groups, np.array(route), seconds, workspace, q)
    return q


def backbone_of(groups: Groups, chain: Floats) -> Floats:
    """Return points (K, 3) along the backbone of a chain (n, 3), `SAMPLES` for each segment."""
    n, base = len(chain), robot_parts(groups[0]).base
    frames, points = np.empty((1, n + 1, t.POSE_WIDTH)), np.empty((1, SAMPLES * n + 1, 3))
    frames_of(_rows(groups, chain), chain[None].copy(), base.reshape(1, t.POSE_WIDTH).copy(), frames)
    points_of(chain[None].copy(), frames, SAMPLES, points)
    return points[0]


def segments_in(robot: Floats) -> Floats:
    """Return the rows (n, 35) of the segments of a robot, of which the group is given, see `sinuous.kernels.tables`."""
    return robot_parts(robot).segments


LONG = 2.0
"""From how many lengths of a segment on a stage makes it a choice where the robot begins to bend."""


def leading_rows(segments: Floats) -> int:
    """Return how many rows (n, 35) lead to the first segment that bends; 0 where it is no choice where that begins.

    It is one where there are joints, or a stage that is long beside the segments.
    """
    straight = (segments[:, t.RIGID] != 0.0) | (segments[:, t.MAX_BEND] == 0.0)
    count = int(straight.argmin())
    lead, rest = segments[:count], segments[count:]
    rigid = lead[:, t.RIGID] != 0.0
    joints = bool(lead[rigid][:, [t.BEND_SCALE, t.LENGTH_SCALE]].any())
    stroke = (lead[~rigid, t.MAX_LENGTH] - lead[~rigid, t.MIN_LENGTH]).sum()
    return count if joints or stroke > LONG * rest[:, t.MAX_LENGTH].mean() else 0


def base_position(groups: Groups) -> Floats:
    """Where the backbone begins (3,)."""
    return robot_parts(groups[0]).base[t.POSE_POSITION :]


def _robot(robot: Floats, first: int, last: int, base: Floats, tool: Floats) -> Floats:
    """Group of a robot of the segments from `first` up to, without it, `last`.

    Limits of actuators that see others, too, are left out: the whole robot has to keep them.
    """
    parts = robot_parts(robot)
    rows = parts.actuators
    inside = (rows[:, t.FIRST_SEGMENT] >= first) & (rows[:, t.LAST_SEGMENT] < last)
    own = rows[inside & (rows[:, t.FIRST_SEGMENT] == rows[:, t.LAST_SEGMENT])]
    own[:, [t.FIRST_SEGMENT, t.LAST_SEGMENT]] -= first
    return parts._replace(segments=parts.segments[first:last], actuators=own, base=base, tool=tool).group()


def _scaled(settings: Floats, segments: Floats) -> Floats:
    """Settings for a robot of these rows of segments (m, SEGMENT_WIDTH)."""
    told = settings.copy()
    told[t.UNIT] = segments[:, [t.MIN_LENGTH, t.MAX_LENGTH]].mean(axis=1).sum()
    return told


def _segments(groups: Groups) -> Floats:
    """Segment (t,) whose end each target concerns."""
    robot, _, _, targets = groups
    return np.where(targets[:, t.TARGET_SEGMENT] < 0.0, robot[0] - 1.0, targets[:, t.TARGET_SEGMENT])


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
    """Return what a route to the most distal target has to keep (QUERY_WIDTH,); `None`: no target has a position.

    See `sinuous.kernels.tables`.
    """
    query = _empty_query(groups[0])
    return query if route_query(*groups, query) else None


def _empty_query(robot: Floats) -> Floats:
    """A query (QUERY_WIDTH,) that keeps nothing but the plane that a robot, of which the group is given, lies in."""
    query, parts = np.zeros(QUERY_WIDTH), robot_parts(robot)
    plane = common_plane(parts.segments)
    if plane is not None:
        axes = parts.base[: t.POSE_POSITION].reshape(3, 3)
        query[QUERY_NORMAL : QUERY_NORMAL + 3] = axes[:, 1] * plane[0] - axes[:, 0] * plane[1]
    return query


def leg_queries(groups: Groups) -> list[Floats]:
    """What routes keep from target to target (l, QUERY_WIDTH): none where one target has a position, or none has.

    Each leg begins where the one before it ends. See `sinuous.kernels.tables`.
    """
    robot, scene, settings, targets = groups
    order = list(_in_order(groups).values())
    queries = []
    for target in order if len(order) > 1 else ():
        query = _empty_query(robot)
        route_query(robot, scene, settings, targets[target : target + 1].copy(), query)
        queries.append(query)
    for last, query in zip(queries[-2::-1], queries[:0:-1], strict=True):
        set_route_start(query, last[QUERY_GOAL : QUERY_GOAL + 3], -last[QUERY_BACK : QUERY_BACK + 3])
        query[[QUERY_SHORTEST, QUERY_LONGEST]] -= last[[QUERY_SHORTEST, QUERY_LONGEST]]
    return queries


def straight_legs(groups: Groups) -> Floats:
    """Return the ends of all legs (l, 2, 3), for chains that are grown without a route."""
    places = groups[3][list(_in_order(groups).values()), TARGET_POSITION : TARGET_POSITION + 3]
    ends = np.vstack([base_position(groups), places])
    return np.stack([ends[:-1], ends[1:]], axis=1)


def set_route_start(query: Floats, place: Floats, along: Floats) -> None:
    """Let the route of a query begin at a place (3,) with a unit tangent (3,), without what the base asks for."""
    query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_AXIS : QUERY_AXIS + 3] = place, along
    query[QUERY_FREE_LENGTH] = 0.0


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
    most : int, optional
        Segments of the longest chains that are wanted.

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
        most: int | None = None,
    ) -> None:
        n, obstacles = int(groups[0][0]), int(groups[1][0])
        self.segments = segments_of(groups)[len(legs) - 1] + 1
        self.counts = np.zeros((n if most is None else most) + 1, np.int64)
        self._levels = levels = np.zeros((len(self.counts), width, CHAIN_WIDTH))
        workspace = np.empty(beam_size(obstacles, width))
        self.open: bool = grow_chains(
            *groups, legs, terminal_poses, open_from, max(0.0, seconds), workspace, levels, self.counts
        )
        self._open_from = open_from
        self.frames = levels[..., FRAME : FRAME + POSE_WIDTH]
        self.costs, self.scores = levels[..., COST], levels[..., SCORE]
        self._rest = np.zeros((n, 3))
        self._rest[:, 2] = segments_in(groups[0])[:, MIN_LENGTH]

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
    """Yield every chain (n, 3), drawn to the targets in short steps."""
    robot, scene, _, targets = groups
    workspace = np.empty(fit_workspace_size(int(robot[0]), int(robot[1]), int(scene[0]), len(targets)))
    for chain in chains:
        q = chain.copy()
        fit_route(*groups, np.empty((0, 3)), deadline(), workspace, q)
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
            left = deadline()
            if (
                add_detours(groups[1], wanted, ball_radius(segments), numbers, left, workspace, points)
                > length / LONG_ENOUGH
            ):
                longer[i], some = respaced(points, LEG_POINTS), True
    return longer if some else None
