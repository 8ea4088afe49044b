"""The chain laid along a route: segment after segment, the body is drawn to it by Newton steps, then off the walls.

A descent keeps no more clearance than it has to, and to prove a hair's breadth takes hundreds of times as long as to
prove a tenth of the radius. The route has more: it lies in the middle of where it leads through.
"""

import math

from sinuous.kernels.body.rows import INNER, put_body_row
from sinuous.kernels.chain.kinematics import body_point, forward_with_columns
from sinuous.kernels.clock import SEGMENT_WORK, begin_for, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import closest, obstacle, work_of_all
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.fitting.curve import Curve, closest_on, curve_through, length_of, point_at
from sinuous.kernels.fitting.short_steps import draw_to_targets
from sinuous.kernels.maths.vectors import Array, Vec, across, copy, dot, put_vec, scale, sub
from sinuous.kernels.problem import Problem, read_problem
from sinuous.kernels.step import actuation
from sinuous.kernels.step.limits import length_range
from sinuous.kernels.step.newton import add_targets, finish_rows, move, project_to_limits, step, wish_nothing
from sinuous.kernels.step.states import State, Work, carve_for, pick, workspace_size
from sinuous.kernels.step.targets import X, Y, Z
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH, RADIUS

ROUTE_SAMPLES = 4
"""Places on every segment that are drawn to the route."""

GROWTH_STEPS, LAST_STEPS = 2, 4
"""Newton steps while the chain grows, and at the end."""

MOST_GROWTHS = 8
"""How often a chain of many segments grows, at most: by several of them at once."""

ROUTE_WINDOW = 0.1
"""How far from where it belongs a place may slide along the route, and the place beside it be, of its length."""

FIT_DAMPING = 1e-5
"""Damping of the steps."""

WALL_PLACES = 12
"""Places of every segment that are kept off the walls, in the end."""

OFF_WALLS = 10
"""Most Newton steps that move the chain off the walls."""

CLEARANCE_SHARE, MOST_CLEARANCE = 0.5, 0.5
"""Of the clearance that the route has beside a place, how much the place should have; no more than so many radii."""

BEST_STATE = 2
"""The state that keeps the best configuration."""


Stretch = tuple[float, float, float]
"""The part of the route that belongs to a segment: where it begins, its length, and the length of all parts, in any
unit."""


def fit_workspace_size(segments: int, actuators: int, obstacles: int, targets: int) -> int:
    """Numbers (float64) that laying a chain needs as workspace."""
    return workspace_size(segments, actuators, max(1, obstacles), targets)  # rows along the body in any scene


def _part(problem: Problem, q: Array, k: int, sliding: bool) -> float:
    """Length of the part of segment `k`: that of the segment, or while the chain grows twice its mean."""
    return q[k, 2] if sliding else problem.limits[k, MIN_LENGTH] + problem.limits[k, MAX_LENGTH]


def _add_pull_row(problem: Problem, state: State, at: int, k: int, s: float, p: Vec, axis: Vec, pull: Vec) -> int:
    """Write row `at`, that draws the place `p`, fraction `s` of segment `k`, by the part of `pull` along `axis`."""
    force = scale(1.0 / problem.unit, axis)
    return put_body_row(state.rows, at, state.q, state.frames, (k, s, p), force, INNER, dot(force, pull))


def _add_pull_rows(
    problem: Problem, state: State, curve: Curve, k: int, at: int, stretch: Stretch, sliding: bool
) -> int:
    """Write the rows that draw segment `k` to its part of the route; returns the next free row."""
    begin, own, total = stretch
    length = length_of(curve)
    for j in range(ROUTE_SAMPLES):
        s = (j + 1.0) / ROUTE_SAMPLES
        p = body_point(state.q, state.frames, k, s)
        along = (begin + s * own) / total * length
        if sliding:
            foot, tangent = closest_on(curve, p, along, ROUTE_WINDOW * length)
            a, b = across(tangent)
            pull = sub(foot, p)
            at = _add_pull_row(problem, state, at, k, s, p, a, pull)
            at = _add_pull_row(problem, state, at, k, s, p, b, pull)
        else:
            pull = sub(point_at(curve, along), p)
            at = _add_pull_row(problem, state, at, k, s, p, X, pull)
            at = _add_pull_row(problem, state, at, k, s, p, Y, pull)
            at = _add_pull_row(problem, state, at, k, s, p, Z, pull)
    return at


def attract(problem: Problem, state: State, curve: Curve, grown: int, sliding: bool) -> None:
    """Linearise: rows that draw the first `grown` segments to the route; `sliding`: only across it, and the targets."""
    q, rows = state.q, state.rows
    forward_with_columns(problem.limits, q, state.frames, state.columns)
    at = actuator = 0
    total = before = 0.0
    for k in range(q.shape[0]):
        total += _part(problem, q, k, sliding)
    for k in range(q.shape[0]):
        rows.start[k] = at
        actuator, at = actuation.add_rows(problem.actuation, k, actuator, rows, at)
        own = _part(problem, q, k, sliding)
        if k < grown:
            at = _add_pull_rows(problem, state, curve, k, at, (before, own, total), sliding)
        before += own
        if sliding:
            at, _, _ = add_targets(problem, state, k, at)
    finish_rows(state, at)


def _take_step(problem: Problem, states: State, at: int, work: Work) -> int:
    """Take one step from state `at`, which is linearised; returns the state that holds the result."""
    wish_nothing(work)
    step(problem, pick(states, at), work, FIT_DAMPING)
    move(problem, pick(states, at), work, pick(states, 1 - at))
    return 1 - at


def _wished(problem: Problem, curve: Curve, k: int, fraction: float, p: Vec) -> float:
    """Distance from the obstacles that the place `p` of segment `k` should have."""
    radius = problem.limits[k, RADIUS]
    foot, _ = closest_on(curve, p, fraction * length_of(curve), ROUTE_WINDOW * length_of(curve))
    d, _ = closest(problem.scene, foot, (1.0 + MOST_CLEARANCE / CLEARANCE_SHARE) * radius, INTERPOLATED)
    return radius + min(MOST_CLEARANCE * radius, max(problem.margin, CLEARANCE_SHARE * (d - radius)))


def push_off(problem: Problem, state: State, curve: Curve) -> tuple[float, int]:
    """Linearise: rows that push places off the walls, and the targets.

    Returns the least clearance of all places, and how many are pushed.
    """
    q, rows = state.q, state.rows
    forward_with_columns(problem.limits, q, state.frames, state.columns)
    least = math.inf
    at = actuator = pushed = 0
    total = begin = 0.0
    for k in range(q.shape[0]):
        total += q[k, 2]
    for k in range(q.shape[0]):
        rows.start[k] = at
        actuator, at = actuation.add_rows(problem.actuation, k, actuator, rows, at)
        radius = problem.limits[k, RADIUS]
        for j in range(WALL_PLACES):
            s = (j + 1.0) / WALL_PLACES
            along = begin + s * q[k, 2]
            if along < problem.mount:
                continue
            p = body_point(q, state.frames, k, s)
            d, which = closest(problem.scene, p, (1.0 + MOST_CLEARANCE) * radius + problem.margin, INTERPOLATED)
            least = min(least, d - radius)
            if d >= radius + MOST_CLEARANCE * radius:
                continue
            wished = _wished(problem, curve, k, along / total, p)
            if d < wished:
                d, gradient = obstacle(problem.scene, which, p, d)
                force = scale(1.0 / problem.unit, gradient)
                at = put_body_row(rows, at, q, state.frames, (k, s, p), force, INNER, (wished - d) / problem.unit)
                pushed += 1
        begin += q[k, 2]
        at, _, _ = add_targets(problem, state, k, at)
    finish_rows(state, at)
    return least, pushed


def clear(problem: Problem, states: State, at: int, work: Work, curve: Curve) -> int:
    """Move the chain of state `at` off the walls, as far as the time allows; returns the state that holds the result.

    States 0 and 1 take turns; state 2 keeps the clearest configuration.
    """
    if problem.scene.table.shape[0] == 0:
        return at
    best, most = pick(states, BEST_STATE), -math.inf
    units = best.q.shape[0] * (SEGMENT_WORK + WALL_PLACES * work_of_all(problem.scene))
    for _ in range(OFF_WALLS):
        state = pick(states, at)
        least, rows = push_off(problem, state, curve)
        if least > most:
            most = least
            copy(state.q, best.q)
        if rows == 0 or spend(work.clock, units):
            break
        at = _take_step(problem, states, at, work)
    return BEST_STATE


def fit_chain(problem: Problem, states: State, work: Work, curve: Curve) -> int:
    """Fit the chain to the route, growing from the base, as far as the time allows; returns the state with the fit."""
    length = length_of(curve)
    n = problem.limits.shape[0]
    low, high = length_range(problem.limits)
    fraction = min(1.0, max(0.0, (length - low) / (high - low))) if high > low else 0.0
    at = 0
    q = pick(states, at).q
    for k in range(n):
        own = problem.limits[k, MIN_LENGTH] + fraction * (problem.limits[k, MAX_LENGTH] - problem.limits[k, MIN_LENGTH])
        put_vec(q, k, 0, (0.0, 0.0, own))
    project_to_limits(problem, pick(states, at), work)
    at_once = 1 + n // MOST_GROWTHS
    for begun in range(0, n, at_once):
        grown = min(n, begun + at_once)
        for _ in range(GROWTH_STEPS):
            if spend(work.clock, SEGMENT_WORK * n):
                return at
            attract(problem, pick(states, at), curve, grown, False)
            at = _take_step(problem, states, at, work)
    for _ in range(LAST_STEPS):
        if spend(work.clock, SEGMENT_WORK * n):
            return at
        attract(problem, pick(states, at), curve, n, True)
        at = _take_step(problem, states, at, work)
    return clear(problem, states, at, work, curve)


@entry
def fit_route(
    robot: Array,
    scene: Array,
    settings: Array,
    targets: Array,
    route: Array,
    seconds: float,
    workspace: Array,
    q: Array,
) -> None:
    """Lay the chain along a route; without one, draw it to its targets and off the obstacles in short steps.

    Parameters
    ----------
    robot, scene, settings : ndarray
        Groups, laid out as `sinuous.kernels.tables` says.
    targets : ndarray (t, 15)
        Met by the last steps, as far as route and obstacles let them.
    route : ndarray (K, 3)
        At least two points from the base on, evenly spaced, in the length unit; or none.
    seconds : float
        Budget.
    workspace : ndarray (w,)
        Scratch, see `fit_workspace_size`.
    q : ndarray (n, 3)
        Filled with the configuration; without a route it is moved.
    """
    problem = read_problem(robot, scene, settings, targets)
    states, work = carve_for(workspace, problem, max(1, problem.scene.table.shape[0]))
    begin_for(work.clock, seconds)
    if route.shape[0] > 0:
        at = fit_chain(problem, states, work, curve_through(route))
    else:
        copy(q, pick(states, 0).q)
        at = draw_to_targets(problem, states, work)
    copy(pick(states, at).q, q)
