"""Lay the chain into a way: segment after segment, the body is drawn to it by Newton steps."""

import math

from sinuous.kernels.body.body import contacts
from sinuous.kernels.chain.kinematics import body_columns, body_point, forward_with_columns, frame
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields import solids
from sinuous.kernels.maths.vectors import Array, Vec, across, add_scaled, cross, dot, get_vec, put_vec, scale, sub
from sinuous.kernels.problem import Problem
from sinuous.kernels.step import actuation
from sinuous.kernels.step.newton import enter, move, rest, step
from sinuous.kernels.step.states import MERIT, State, Work, pick
from sinuous.kernels.step.sweeps import INNER, Rows
from sinuous.kernels.step.targets import X, Y, Z, add_rows, end_segment
from sinuous.kernels.tables import MAX_LENGTH, MIN_LENGTH

SAMPLES = 4
"""Places on every segment that are drawn to the way."""

ROUNDS, LAST_ROUNDS = 2, 4
"""Newton steps while the chain grows, and at the end."""

MU = 1e-5


@kernel
def point_at(way: Array, count: int, gap: float, along: float) -> Vec:
    """Point of the way, `gap` between its points, at the length `along`."""
    x = min(max(along / gap, 0.0), count - 1.0)
    i = min(int(x), count - 2)
    a = get_vec(way, i, 0)
    return add_scaled(a, x - i, sub(get_vec(way, i + 1, 0), a))


@kernel
def closest_on(way: Array, count: int, gap: float, p: Vec, along: float, window: float) -> tuple[Vec, Vec]:
    """Place on the way closest to `p`, no farther than `window` from the length `along`: point and unit tangent."""
    first = max(0, min(count - 2, int((along - window) / gap)))
    last = max(first + 1, min(count - 1, math.ceil((along + window) / gap)))
    least = math.inf
    point, tangent = get_vec(way, first, 0), (0.0, 0.0, 1.0)
    for i in range(first, last):
        a = get_vec(way, i, 0)
        line = sub(get_vec(way, i + 1, 0), a)
        square = dot(line, line)
        if square == 0.0:
            continue
        foot = add_scaled(a, min(1.0, max(0.0, dot(sub(p, a), line) / square)), line)
        off = sub(p, foot)
        if dot(off, off) < least:
            least, point, tangent = dot(off, off), foot, scale(1.0 / math.sqrt(square), line)
    return point, tangent


@kernel
def draw(
    rows: Rows,
    q: Array,
    frames: Array,
    k: int,
    s: float,
    origin: Vec,
    p: Vec,
    axis: Vec,
    pull: Vec,
    unit: float,
    at: int,
) -> int:
    """A row that draws the body at `p`, fraction `s` of segment `k`, along `axis`."""
    x, y, z = body_columns(q, frames, origin, k, s)
    end = body_columns(q, frames, origin, k, 1.0)
    force = scale(1.0 / unit, axis)
    torque = cross(sub(p, origin), force)
    put_vec(rows.twist, at, 0, torque)
    put_vec(rows.twist, at, 3, force)
    rows.inner[at, 0] = s * (dot(torque, x[0]) + dot(force, x[1])) - dot(torque, end[0][0]) - dot(force, end[0][1])
    rows.inner[at, 1] = s * (dot(torque, y[0]) + dot(force, y[1])) - dot(torque, end[1][0]) - dot(force, end[1][1])
    rows.inner[at, 2] = s * dot(force, z[1]) - dot(force, end[2][1])
    rows.kind[at] = INNER
    rows.value[at] = dot(force, pull)
    return at + 1


@kernel
def attract(
    problem: Problem,
    state: State,
    work: Work,
    way: Array,
    count: int,
    gap: float,
    grown: int,
    sliding: bool,
    depth: int,
) -> None:
    """Linearise: rows that draw the first `grown` segments to the way; with `sliding`, only across it, and the targets.

    Contacts are looked for where `depth` is not negative.
    """
    q, frames, rows = state.q, state.frames, state.rows
    forward_with_columns(q, frames, state.columns)
    origin = frame(frames, 0)[1]
    at = actuator = 0
    length = gap * (count - 1)
    total = before = 0.0
    for k in range(q.shape[0]):
        total += q[k, 2] if sliding else problem.limits[k, MIN_LENGTH] + problem.limits[k, MAX_LENGTH]
    mount = problem.mount
    for k in range(q.shape[0]):
        rows.start[k] = at
        actuator, at = actuation.add_rows(problem.actuation, k, actuator, rows, at)
        own = q[k, 2] if sliding else problem.limits[k, MIN_LENGTH] + problem.limits[k, MAX_LENGTH]
        for j in range(SAMPLES if k < grown else 0):
            s = (j + 1.0) / SAMPLES
            p = body_point(q, frames, k, s)
            along = length * (before + s * own) / total
            if sliding:
                foot, tangent = closest_on(way, count, gap, p, along, 0.1 * length)
                a, b = across(tangent)
                at = draw(rows, q, frames, k, s, origin, p, a, sub(foot, p), problem.unit, at)
                at = draw(rows, q, frames, k, s, origin, p, b, sub(foot, p), problem.unit, at)
            else:
                pull = sub(point_at(way, count, gap, along), p)
                at = draw(rows, q, frames, k, s, origin, p, X, pull, problem.unit, at)
                at = draw(rows, q, frames, k, s, origin, p, Y, pull, problem.unit, at)
                at = draw(rows, q, frames, k, s, origin, p, Z, pull, problem.unit, at)
        before += own
        if depth >= 0:
            at, _ = contacts(
                problem.limits,
                q,
                frames,
                problem.scene,
                k,
                mount,
                problem.margin,
                0.0,
                depth,
                solids.STEP,
                origin,
                problem.unit,
                work.among,
                rows,
                at,
            )
        mount -= q[k, 2]
        for i in range(problem.targets.shape[0] if sliding else 0):
            if end_segment(problem.targets, i, q.shape[0]) == k:
                at, _, _ = add_rows(problem.targets, i, frames, problem.tool, origin, problem.unit, rows, at)
    rows.start[q.shape[0]] = at
    merit = 0.0
    for i in range(at):
        merit += rows.value[i] * rows.value[i]
    state.norms[MERIT] = merit


@kernel
def lay(problem: Problem, states: State, work: Work, way: Array, count: int, gap: float) -> int:
    """Fit the chain to the way, growing from the base; returns the state that holds the fit."""
    length = gap * (count - 1)
    low = high = 0.0
    n = problem.limits.shape[0]
    for k in range(n):
        low += problem.limits[k, MIN_LENGTH]
        high += problem.limits[k, MAX_LENGTH]
    share = min(1.0, max(0.0, (length - low) / (high - low))) if high > low else 0.0
    at = 0
    q = pick(states, at).q
    for k in range(n):
        own = problem.limits[k, MIN_LENGTH] + share * (problem.limits[k, MAX_LENGTH] - problem.limits[k, MIN_LENGTH])
        put_vec(q, k, 0, (0.0, 0.0, own))
    enter(problem, pick(states, at), work)
    for grown in range(1, n + 1):
        for _ in range(ROUNDS):
            at = _pull(problem, states, at, work, way, count, gap, grown, False)
    for _ in range(LAST_ROUNDS):
        at = _pull(problem, states, at, work, way, count, gap, n, True)
    return at


@kernel
def _pull(
    problem: Problem, states: State, at: int, work: Work, way: Array, count: int, gap: float, grown: int, sliding: bool
) -> int:
    state, other = pick(states, at), pick(states, 1 - at)
    attract(problem, state, work, way, count, gap, grown, sliding, -1)
    rest(work)
    step(problem, state, work, MU)
    move(problem, state, work, other)
    return 1 - at
