"""An arc that comes out between obstacles: first a part of it, then more, bent off the walls on its way.

An arc is pushed off the walls by Gauss-Newton in its two bends: places along it, and on its circle for some radii
beyond its end, are asked to keep a distance. What lies beyond the end makes arcs in a tube turn into the arc that
follows the tube, whatever they were aimed at: the next segment must fit there, too.
"""

import math

from sinuous.kernels.body.pieces import closest, near
from sinuous.kernels.chain.arc import point, pose_and_columns
from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene, obstacle
from sinuous.kernels.fields.solids import STEP
from sinuous.kernels.growing.arcs import Start, thickness
from sinuous.kernels.maths.vectors import Array, Vec, add, cross, dot, mat_vec, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import project_segment
from sinuous.kernels.tables import MAX_BEND, MIN_LENGTH

New = tuple[Start, int, float]
"""Where a new segment begins, which one it is, and the length of the chain before it."""

STAGES = 3
"""Parts in which an arc comes out that does not fit as it is."""

ROUNDS = 6
"""Most Gauss-Newton steps of each part."""

CLEARANCE = 0.25
"""Clearance beside the body that arcs are pushed to, in radii."""

AHEAD = 3.0
"""How far beyond its end an arc is pushed off walls as if it went on, in radii of the body."""

LOST = 2.0
"""Overlap from which on an arc is given up, in radii: its axis lies a radius deep in an obstacle."""

KEPT = 0.5
"""Greatest overlap of an arc that is kept, in radii: Newton steps of the whole chain take it out, or do not."""

SHALLOW = 1e-3
"""Overlap, in radii, and pressure up to which an arc counts as clear."""

ENOUGH = 0.7
"""Share of the pressure that a step must take away: else it is the last one."""

SHORTER = 0.3
"""Share of a step that is tried next where it does not relieve an arc."""

FINEST, REACH = 0.7, 3.0
"""Longest step along an arc near an obstacle, and how far a look from there reaches, in radii of the body."""

ASIDE = 0.9
"""How far places of an arc are from its middle at most, however it is bent, in lengths of the arc."""

MOST = 0.6
"""Most change of a bend in one step, rad."""

DAMPING = 1e-3
"""Damping of a step, in squares of the length of the arc."""


@kernel
def _row(scene: Scene, start: Start, q: Vec, place: tuple[float, Vec], which: int, d: float) -> tuple[float, float]:
    """Derivatives by the bends of the distance `d` of a place, at a share `s` of an arc, from obstacle `which`."""
    s, p = place
    _, end, x, y, _ = pose_and_columns(s * q[0], s * q[1], s * q[2])
    _, g = obstacle(scene, which, p, d)
    force = vec_mat(g, start[0])
    return s * dot(force, add(x[1], cross(x[0], end))), s * dot(force, add(y[1], cross(y[0], end)))


@kernel
def _press(problem: Problem, new: New, q: Vec, among: Array, count: int) -> tuple[float, float, float, float]:
    """Deepest overlap of an arc, in radii; its pressure; and the change of its bends that relieves it.

    The pressure is the integral along the arc of the square of what is missing of the clearance, in radii. `among`
    lists the `count` obstacles that concern the arc. Both results are inf for an arc that is given up.
    """
    start, k, along = new
    scene, radius = problem.scene, thickness(problem, k)
    xx = yy = DAMPING * q[2] * q[2]
    xy = bx = by = deepest = pressure = 0.0
    at, step, last = max(0.0, problem.mount - along), FINEST * radius, q[2] + AHEAD * radius
    while at < last:
        most = 1.0 + CLEARANCE
        if at < q[2]:
            at, most = min(q[2], at + step), LOST
        else:
            at = min(last, at + step)
        s = at / q[2]
        p = add(start[1], mat_vec(start[0], point(s * q[0], s * q[1], at)))
        d, _, which = closest(scene, among, count, p, REACH * radius, STEP)
        step = max(FINEST * radius, min(d, REACH * radius) - radius)
        if at <= q[2]:
            deepest = max(deepest, 1.0 - d / radius)
        if deepest > LOST:
            return math.inf, math.inf, 0.0, 0.0
        missing = min(most, 1.0 + CLEARANCE - d / radius)
        if missing > 0.0:
            pressure += missing * missing * step
            x, y = _row(scene, start, q, (s, p), which, d)
            xx, xy, yy = xx + x * x, xy + x * y, yy + y * y
            bx, by = bx + x * missing * radius, by + y * missing * radius
    det = xx * yy - xy * xy
    if pressure == 0.0 or det <= 0.0:
        return deepest, pressure, 0.0, 0.0
    return deepest, pressure, (yy * bx - xy * by) / det, (xx * by - xy * bx) / det


@kernel
def _relieve(problem: Problem, new: New, q: Vec, s: float, among: Array, count: int) -> tuple[Vec, float, float]:
    """Bend an arc until its first part, a share `s`, is pressed as little as can be; its overlap and its pressure."""
    k = new[1]
    deepest, pressure, x, y = _press(problem, new, (s * q[0], s * q[1], s * q[2]), among, count)
    share = 1.0
    for _ in range(ROUNDS):
        if not 0.0 < pressure < math.inf:
            break
        size = math.hypot(x, y) / s
        step = share * min(1.0, MOST / size) / s if size > 0.0 else 0.0
        other = project_segment(problem.limits, k, q[0] + step * x, q[1] + step * y, q[2])
        part = s * other[0], s * other[1], s * other[2]
        deeper, left, dx, dy = _press(problem, new, part, among, count)
        if left >= pressure:
            share *= SHORTER
            continue
        enough, share = left > ENOUGH * pressure, 1.0
        q, deepest, pressure, x, y = other, deeper, left, dx, dy
        if enough:
            break
    return q, deepest, pressure


@kernel
def _in_stages(problem: Problem, new: New, q: Vec, among: Array, count: int) -> tuple[Vec, float, float, float]:
    """Let an arc come out part by part; returns it, the share of it that fits, and the overlap and pressure of that."""
    best, fits, overlap, pressure = q, 0.0, math.inf, 0.0
    for stage in range(1, STAGES + 1):
        s = stage / STAGES
        q, deepest, left = _relieve(problem, new, q, s, among, count)
        if deepest > KEPT:
            break
        best, fits, overlap, pressure = q, s, deepest, left
    return best, fits, overlap, pressure


@kernel
def come_out(problem: Problem, new: New, q: Vec, among: Array) -> tuple[Vec, float, float]:
    """Bend an arc off the obstacles, and cut it to the part that fits.

    Returns the arc, its deepest overlap in radii (inf where it does not fit), and its mean pressure. `among` (m,) int64
    is scratch.
    """
    (rotation, position), k, _ = new
    radius = thickness(problem, k)
    middle = add(position, mat_vec(rotation, point(0.5 * q[0], 0.5 * q[1], 0.5 * q[2])))
    count, _ = near(problem.scene, middle, ASIDE * q[2] + (REACH + AHEAD) * radius, among)
    if count == 0 or q[2] == 0.0:
        return q, 0.0, 0.0
    overlap, pressure, _, _ = _press(problem, new, q, among, count)
    if pressure == 0.0:
        return q, 0.0, 0.0
    if problem.limits[k, MAX_BEND] == 0.0:
        return q, overlap if overlap <= KEPT else math.inf, pressure / max(q[2], radius)
    bent, fits = q, 1.0
    if overlap <= KEPT:
        bent, overlap, pressure = _relieve(problem, new, q, 1.0, among, count)
    if overlap > SHALLOW:
        staged, share, deepest, left = _in_stages(problem, new, q, among, count)
        if overlap > KEPT or (share == 1.0 and deepest < overlap):
            bent, fits, overlap, pressure = staged, share, deepest, left
    length = fits * q[2]
    if overlap > KEPT or length < problem.limits[k, MIN_LENGTH] or length == 0.0:
        return q, math.inf, 0.0
    return (fits * bent[0], fits * bent[1], length), overlap, pressure / length
