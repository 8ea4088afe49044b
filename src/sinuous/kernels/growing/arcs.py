"""One segment beyond a chain: the arcs that are tried, and each of them bent off the obstacles."""

import math

from sinuous.kernels.body.pieces import closest, near
from sinuous.kernels.chain.arc import point, pose_and_columns
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene, obstacle
from sinuous.kernels.fields.solids import STEP
from sinuous.kernels.growing.guide import Guide
from sinuous.kernels.maths.vectors import Array, Mat, Vec, add, cross, dot, get_vec, mat_vec, norm, sub, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bend_cap, project_segment
from sinuous.kernels.tables import MAX_BEND, MAX_LENGTH, MIN_LENGTH, RADIUS

Start = tuple[Mat, Vec]
"""Rotation and position of the end of a chain."""

New = tuple[Start, int, float]
"""Where a new segment begins, which one it is, and the length of the chain before it."""

ASIDE = 0.9
"""How far places of an arc are from its middle at most, however it is bent off, in lengths of the arc."""

RINGS, RAYS = 3, 8
"""How many bends are tried, and to how many sides each."""

SPARED = 0.85
"""The largest bend that is tried, of the limit: a chain that is bent as far as it can be cannot be moved any more."""

AIMS = 3
"""Places of the guide that arcs are aimed at."""

LENGTHS = 8
"""Lengths of a segment that cannot bend."""

ARCS = 1 + RINGS * RAYS + AIMS
"""Arcs that are tried beyond one chain."""

FINEST = 0.7
"""Longest step along an arc where it is near an obstacle, in radii of the body."""

DEEP, KEPT, SHALLOW = 1.3, 0.5, 1e-3
"""Overlaps, in radii of the body: from which on an arc is not bent, up to which a bent one is kept, and up to which
none is bent."""

THIN = 1e-3
"""Radius of a body that has none, in lengths of the robot."""

REACH = 3.0
"""How far a look along an arc reaches, in radii of the body."""

ROUNDS = 3
"""How often an arc is bent."""

MOST = 0.6
"""Most change of a bend in one round, rad."""

DAMPING = 1e-3
"""Of a round, in units of the square of the length."""


@kernel
def thickness(problem: Problem, k: int) -> float:
    """Radius of segment `k`, or what counts as one where the body has none."""
    return max(problem.limits[k, RADIUS], THIN * problem.unit)


@kernel
def aimed(start: Start, target: Vec, length: float) -> tuple[float, float]:
    """Bend of the arc of this length on the circle that leads to a target."""
    p = vec_mat(sub(target, start[1]), start[0])
    aside = math.hypot(p[0], p[1])
    square = aside * aside + p[2] * p[2]
    if square == 0.0 or aside == 0.0:
        return 0.0, 0.0
    bend = 2.0 * aside / square * length
    return bend * p[0] / aside, bend * p[1] / aside


@kernel
def _aim(guide: Guide, start: Start, number: int, seen: int, length: float) -> Vec:
    """Place of the guide that arc `number` is aimed at.

    What is seen; or what is one segment, or one and a half, ahead of the place beside.
    """
    last = guide.points.shape[0] - 1
    if number == 0:
        return get_vec(guide.points, seen, 0)
    beside = seen - max(1, int(norm(sub(get_vec(guide.points, seen, 0), start[1])) / guide.spacing))
    ahead = max(0, beside) + int(0.5 * (1.0 + number) * length / guide.spacing)
    return get_vec(guide.points, min(ahead, last), 0)


@kernel
def tried(problem: Problem, guide: Guide, start: Start, which: tuple[int, int], seen: int, share: float) -> Vec:
    """Arc number `which[1]` of segment `which[0]` beyond `start`: its bends and its length.

    `seen` is the point of the guide that is seen from there; `share` says how long the segment is, between its least
    and its greatest length.
    """
    limits, (k, number) = problem.limits, which
    low, high = limits[k, MIN_LENGTH], limits[k, MAX_LENGTH]
    length = low + share * (high - low)
    if limits[k, MAX_BEND] == 0.0:
        return 0.0, 0.0, low + (high - low) * number / (LENGTHS - 1.0)
    if number < AIMS:
        x, y = aimed(start, _aim(guide, start, number, seen, length), length)
        return project_segment(limits, k, x, y, length)
    if number == AIMS:
        return 0.0, 0.0, length
    ring, ray = (number - AIMS - 1) // RAYS, (number - AIMS - 1) % RAYS
    bend = SPARED * bend_cap(limits, k, length) * (ring + 1.0) / RINGS
    angle = 2.0 * math.pi * (ray + 0.5 * (ring % 2) + 0.25 * (k % 2)) / RAYS
    return bend * math.cos(angle), bend * math.sin(angle), length


@kernel
def count_of(problem: Problem, k: int) -> int:
    """How many arcs of segment `k` are tried."""
    if problem.limits[k, MAX_BEND] > 0.0:
        return ARCS
    return LENGTHS if problem.limits[k, MAX_LENGTH] > problem.limits[k, MIN_LENGTH] else 1


@kernel
def _row(scene: Scene, start: Start, q: Vec, place: tuple[float, Vec], which: int, d: float) -> tuple[float, float]:
    """What the bends of an arc do to the distance `d` of a place, at a share `s` of it, from obstacle `which`."""
    s, p = place
    _, end, x, y, _ = pose_and_columns(s * q[0], s * q[1], s * q[2])
    _, g = obstacle(scene, which, p, d)
    force = vec_mat(g, start[0])
    return s * dot(force, add(x[1], cross(x[0], end))), s * dot(force, add(y[1], cross(y[0], end)))


@kernel
def _look(problem: Problem, new: New, q: Vec, among: Array, count: int) -> tuple[float, float, float]:
    """Deepest overlap of an arc, in radii (inf: too deep), and the change of its bends that takes all overlaps out.

    `among` lists the obstacles that concern it.
    """
    start, k, along = new
    scene, radius = problem.scene, thickness(problem, k)
    xx = yy = DAMPING * q[2] * q[2]
    xy = bx = by = deepest = s = 0.0
    if along < problem.mount:
        s = (problem.mount - along) / max(q[2], problem.mount - along)
    step = FINEST * radius
    while s < 1.0:
        s = min(1.0, s + step / max(q[2], step))
        p = add(start[1], mat_vec(start[0], point(s * q[0], s * q[1], s * q[2])))
        d, _, which = closest(scene, among, count, p, REACH * radius, STEP)
        step = max(FINEST * radius, min(d, REACH * radius) - radius)
        depth = 1.0 - d / radius
        if depth > DEEP:
            return math.inf, 0.0, 0.0
        if depth > 0.0:
            deepest = max(deepest, depth)
            x, y = _row(scene, start, q, (s, p), which, d)
            xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
            bx, by = bx + x * depth * radius, by + y * depth * radius
    det = xx * yy - xy * xy
    if deepest == 0.0 or det <= 0.0:
        return deepest, 0.0, 0.0
    return deepest, (yy * bx - xy * by) / det, (xx * by - xy * bx) / det


@kernel
def bent_off(problem: Problem, new: New, q: Vec, among: Array) -> tuple[Vec, float]:
    """Bend an arc off the obstacles; returns it, and its deepest overlap in radii, inf if too deep.

    `among` (m,) int64 is scratch.
    """
    (rotation, position), k, _ = new
    middle = add(position, mat_vec(rotation, point(0.5 * q[0], 0.5 * q[1], 0.5 * q[2])))
    count, _ = near(problem.scene, middle, ASIDE * q[2] + REACH * thickness(problem, k), among)
    if count == 0:
        return q, 0.0
    depth, x, y = _look(problem, new, q, among, count)
    for _ in range(ROUNDS):
        if depth < SHALLOW or depth > DEEP or problem.limits[k, MAX_BEND] == 0.0:
            break
        size = math.hypot(x, y)
        shrink = min(1.0, MOST / size) if size > 0.0 else 0.0
        other = project_segment(problem.limits, k, q[0] + shrink * x, q[1] + shrink * y, q[2])
        deeper, x, y = _look(problem, new, other, among, count)
        if deeper >= depth:
            break
        q, depth = other, deeper
    return q, depth if depth <= KEPT else math.inf
