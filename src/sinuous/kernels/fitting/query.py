"""What a route for a robot and its most distal target has to keep: the query that `freespace` answers.

`query` (QUERY_WIDTH,) is flat, see `tables`.
"""

import math

from sinuous.kernels import tables as t
from sinuous.kernels.chain.kinematics import frame
from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import ZERO, Array, Vec
from sinuous.kernels.problem import read_problem
from sinuous.kernels.step.targets import backbone_end, distal_target, end_segment, tangent_back

THINNEST = 1e-4
"""Least radius of the ball that routes are found for, in lengths of the robot: a smaller one would go along walls in
steps without number. It is as thick as the thinnest segment that has this radius at least: a thinner segment mostly has
none because nobody said it, and the others have to go there, too. Where there is such a segment it is never proved that
there is no route."""

ASSUMED = 5e-3
"""Radius of the ball where no segment is that thick, in lengths of the robot, like that of a slender one: to a thinner
ball no pipe is narrow, and what helps in narrow places is not tried."""


def ball_radius(limits: Array) -> float:
    """Radius of the ball that routes of segments (n, SEGMENT_WIDTH) are found for, see `THINNEST`; length unit."""
    radius, least = math.inf, THINNEST * limits[:, t.MAX_LENGTH].sum()
    for k in range(limits.shape[0]):
        if limits[k, t.RADIUS] >= least:
            radius = min(radius, limits[k, t.RADIUS])
    return radius if radius < math.inf else ASSUMED * limits[:, t.MAX_LENGTH].sum()


def _put(query: Array, at: int, vector: Vec) -> None:
    query[at], query[at + 1], query[at + 2] = vector


@entry
def route_query(robot: Array, scene: Array, settings: Array, targets: Array, query: Array) -> bool:
    """Fill what robot and targets ask of a route into `query` (QUERY_WIDTH,); the plan's numbers are left as they are.

    `robot`, `scene` and `settings` are groups and `targets` (t, 15) a table, laid out as `sinuous.kernels.tables` says.
    Returns False, and fills nothing, when no target has a position.
    """
    problem = read_problem(robot, scene, settings, targets)
    which = distal_target(targets, problem.limits.shape[0])
    if which < 0:
        return False
    last = end_segment(targets, which, problem.limits.shape[0])
    rotation, base = frame(problem.base, 0)
    goal, around = backbone_end(problem, which, last)
    _put(query, t.QUERY_ORIGIN, base)
    _put(query, t.QUERY_AXIS, (rotation[0][2], rotation[1][2], rotation[2][2]))
    _put(query, t.QUERY_GOAL, goal)
    _put(query, t.QUERY_BACK, tangent_back(targets, which) if around == 0.0 else ZERO)
    query[t.QUERY_GOAL_RADIUS] = around
    query[t.QUERY_GOAL_SLACK] = problem.position_tolerance + 1e-9 * problem.unit
    body = problem.limits[: last + 1]
    query[t.QUERY_RADIUS], query[t.QUERY_FREE_LENGTH] = ball_radius(body), problem.mount
    query[t.QUERY_SHORTEST], query[t.QUERY_LONGEST] = body[:, t.MIN_LENGTH].sum(), body[:, t.MAX_LENGTH].sum()
    return True
