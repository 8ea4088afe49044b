"""An arc that comes out between obstacles: it is bent off the walls on its way, and cut where no more of it fits.

Where it does not fit as the arc before it ends, both are bent: one that is a little off in a tube has the next one too
far off to be bent back by itself.

An arc is pushed off the walls by Gauss-Newton in its two bends: places along it, and on its circle for some radii
beyond its end, are asked to keep a distance. What lies beyond the end makes arcs in a tube turn into the arc that
follows the tube, whatever they were aimed at: the next segment must fit there, too. Only what comes before the axis
first gets into an obstacle is pushed: deep in a wall, the nearest way out may be that to its other side. So an arc that
is bent off a wall comes out farther at each step, and meets the next one.
"""

import math
from collections import namedtuple

from sinuous.kernels.body.pieces import MANY, few_near
from sinuous.kernels.chain.arc import point, pose_and_columns
from sinuous.kernels.fields.distances import Scene, evaluate, obstacle, search
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.growing.arcs import Start, end_of, thickness
from sinuous.kernels.maths.vectors import Vec, add, cross, dot, mat_vec, sub, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.limits import bends_in_plane, possible_bend, project_segment
from sinuous.kernels.tables import BEND_SCALE, MIN_LENGTH, ROUNDOFF

New = tuple[Start, int, float]
"""Where a segment begins, which one it is, and the length of the chain before it."""

Two = tuple[Vec, Vec]
"""Coordinates of the arc before the new one, and those of the new one."""

Nearby = namedtuple("Nearby", ["numbers", "until"])
"""Numbers (m,) int64 of obstacles near an arc, and up to where on it (m,) none of them is examined again (length)."""

RELIEF_STEPS, RELIEF_STEPS_AT_RANDOM = 16, 5
"""Most Gauss-Newton steps of an arc, and of one that was drawn at random: others are drawn instead."""

PUSHED_CLEARANCE = 0.25
"""Clearance beside the body that arcs are pushed to, in radii."""

RADII_AHEAD = 3.0
"""How far beyond its end an arc is pushed off walls as if it went on, in radii of the body."""

MOST_OVERLAP = 0.5
"""Greatest overlap of an arc that is kept, in radii: Newton steps of the whole chain take it out, or do not."""

SHALLOW = 1e-3
"""Overlap, in radii, and pressure up to which an arc counts as clear."""

LEAST_RELIEF = 0.7
"""Share of the pressure that a step must take away: else it is the last one."""

LEAST_RELIEF_OF_PART = 0.97
"""The same where not all of the arc is out."""

SHORTER_STEP = 0.3
"""Share of a step that is tried next where it does not relieve an arc."""

STEP_LENGTH, EVALUATION_REACH = 0.7, 3.0
"""Longest step along an arc near an obstacle, and how far an evaluation from there reaches, in radii of the body."""

ARC_REACH = 0.9
"""How far places of an arc are from its middle at most, however it is bent, in lengths of the arc."""

MOST_BEND_CHANGE = 0.6
"""Most change of a bend in one step, rad."""

RELIEF_DAMPING = 3e-3
"""Damping of a step, in squares of the length of the arc."""


def _slopes_by_bends(start: Start, q: Vec, s: float, p: Vec, g: Vec) -> tuple[float, float]:
    """Derivatives of the distance of a place `p`, whose gradient is `g`, by the bends of an arc that it is fixed to.

    It is fixed where a share `s` of the arc is out, which begins with a pose.
    """
    _, _, x, y, _ = pose_and_columns(s * q[0], s * q[1], s * q[2])
    force, own = vec_mat(g, start[0]), vec_mat(sub(p, start[1]), start[0])
    return s * dot(force, add(x[1], cross(x[0], own))), s * dot(force, add(y[1], cross(y[0], own)))


def _solve(a: Vec, c: Vec, b: tuple[float, float, float, float], g: Vec, h: Vec) -> tuple[float, float, float, float]:
    """Solve the symmetric system of blocks `a` (xx, xy, yy), `b` (rows) and `c`, with the right sides `g` and `h`."""
    det = a[0] * a[2] - a[1] * a[1]
    if det <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    i, j, k = a[2] / det, -a[1] / det, a[0] / det
    # columns of a^-1 b, and a^-1 g
    u0, u1 = i * b[0] + j * b[2], j * b[0] + k * b[2]
    v0, v1 = i * b[1] + j * b[3], j * b[1] + k * b[3]
    w0, w1 = i * g[0] + j * g[1], j * g[0] + k * g[1]
    xx, xy, yy = c[0] - b[0] * u0 - b[2] * u1, c[1] - b[0] * v0 - b[2] * v1, c[2] - b[1] * v0 - b[3] * v1
    x, y = h[0] - b[0] * w0 - b[2] * w1, h[1] - b[1] * w0 - b[3] * w1
    det = xx * yy - xy * xy
    if det <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    x, y = (yy * x - xy * y) / det, (xx * y - xy * x) / det
    return w0 - u0 * x - v0 * y, w1 - u1 * x - v1 * y, x, y


def _find_closest(scene: Scene, nearby: Nearby, count: int, p: Vec, at: float, reach: float) -> tuple[float, int]:
    """Least distance, less than `reach`, of a place to what is `nearby`, and the obstacle; infinite, -1: there is none.

    The place is so far along an arc. An obstacle does not come nearer than by what the arc goes on.
    """
    if count == MANY:
        d, _, found = search(scene, p, reach, INTERPOLATED, -1.0, -1)
        return (d if found >= 0 else math.inf), found
    least, which = math.inf, -1
    for j in range(count):
        if at >= nearby.until[j]:
            i = nearby.numbers[j]
            roundoff = scene.table[i, ROUNDOFF]
            d = evaluate(scene, i, p, min(reach, least) + roundoff, INTERPOLATED)[0] - roundoff
            nearby.until[j] = at + d - reach
            if d < min(reach, least):
                least, which = d, i
    return least, which


def _pressure(
    problem: Problem, before: New, new: New, two: Two, both: bool, nearby: Nearby, count: int, limit: float
) -> tuple[float, float, float, tuple[float, float, float, float]]:
    """Share of an arc that comes out; its deepest overlap, in radii; its pressure; and the change that relieves it.

    The change is that of the bends of the arc before it, where `both` are to change, and of its own. The pressure is
    the integral along what changes of the square of what is missing of the clearance, in radii; where the axis gets
    into an obstacle, all that is beyond counts as missing as much as there: deeper in it, the way out that is nearest
    may lead to the other side. `nearby` lists the `count` obstacles that concern it. What is pressed by
    `limit` or more is examined no further.
    """
    scene, radius, most = problem.scene, thickness(problem, new[1]), 1.0 + PUSHED_CLEARANCE
    axx = ayy = RELIEF_DAMPING * two[0][2] * two[0][2] + (0.0 if both else 1.0)
    cxx = cyy = RELIEF_DAMPING * two[1][2] * two[1][2]
    axy = cxy = bxx = bxy = byx = byy = gx = gy = hx = hy = deepest = pressure = 0.0
    fits = 1.0
    for part in range(0 if both else 1, 2):
        (start, _, along), q = (before, two[0]) if part == 0 else (new, two[1])
        at, step = max(0.0, problem.mount - along), STEP_LENGTH * radius
        last = q[2] + (RADII_AHEAD * radius if part == 1 else 0.0)
        for j in range(count):
            nearby.until[j] = 0.0
        while at < last:
            out, at = at, min(q[2] if at < q[2] else last, at + step)
            s = at / q[2]
            p = add(start[1], mat_vec(start[0], point(s * q[0], s * q[1], at)))
            d, which = _find_closest(scene, nearby, count, p, at, EVALUATION_REACH * radius)
            step = max(STEP_LENGTH * radius, min(d, EVALUATION_REACH * radius) - radius)
            if at <= q[2] and fits == 1.0:
                if 1.0 - d / radius > MOST_OVERLAP:
                    fits = out / q[2] if part == 1 else 0.0
                else:
                    deepest = max(deepest, 1.0 - d / radius)
            if d <= 0.0:
                pressure += most * most * (last - at)
                break
            missing = most - d / radius
            if missing > 0.0:
                pressure += missing * missing * step
                if pressure >= limit:
                    return fits, deepest, pressure, (0.0, 0.0, 0.0, 0.0)
                _, g = obstacle(scene, which, p, d)
                x, y = _slopes_by_bends(start, q, s, p, g)
                x, y = possible_bend(problem.limits, new[1] - 1 + part, x, y)
                m = missing * radius
                u, v = (x, y) if part == 0 else (0.0, 0.0)
                if part == 1:
                    cxx, cxy, cyy, hx, hy = cxx + x * x, cxy + x * y, cyy + y * y, hx + x * m, hy + y * m
                    if both:
                        u, v = _slopes_by_bends(before[0], two[0], 1.0, p, g)
                        u, v = possible_bend(problem.limits, new[1] - 1, u, v)
                        bxx, bxy, byx, byy = bxx + u * x, bxy + u * y, byx + v * x, byy + v * y
                axx, axy, ayy, gx, gy = axx + u * u, axy + u * v, ayy + v * v, gx + u * m, gy + v * m
    if pressure == 0.0:
        return fits, deepest, pressure, (0.0, 0.0, 0.0, 0.0)
    change = _solve((axx, axy, ayy), (cxx, cxy, cyy), (bxx, bxy, byx, byy), (gx, gy, 0.0), (hx, hy, 0.0))
    return fits, deepest, pressure, change


def _relieve_arc(
    problem: Problem, before: New, new: New, two: Two, both: bool, nearby: Nearby, count: int, steps: int
) -> tuple[Two, float, float, float]:
    """Bend an arc until it is pressed as little as can be; the share that comes out, its overlap and its pressure."""
    k, begin = new[1], new
    fits, deepest, pressure, (u, v, x, y) = _pressure(problem, before, begin, two, both, nearby, count, math.inf)
    step_length = 1.0
    for _ in range(steps if problem.limits[k, BEND_SCALE] > 0.0 else 0):
        size = max(math.hypot(x, y), math.hypot(u, v))
        if pressure == 0.0 or size == 0.0:
            break
        step = step_length * min(1.0, MOST_BEND_CHANGE / size)
        first = two[0]
        if both:
            first = project_segment(problem.limits, k - 1, first[0] + step * u, first[1] + step * v, first[2])
            begin = end_of(before[0], first), k, new[2]
        other = project_segment(problem.limits, k, two[1][0] + step * x, two[1][1] + step * y, two[1][2])
        out, deeper, left, change = _pressure(problem, before, begin, (first, other), both, nearby, count, pressure)
        if left >= pressure:
            step_length *= SHORTER_STEP
            continue
        enough, step_length = left > (LEAST_RELIEF if out == 1.0 else LEAST_RELIEF_OF_PART) * pressure, 1.0
        two, fits, deepest, pressure, (u, v, x, y) = (first, other), out, deeper, left, change
        if enough:
            break
    return two, fits, deepest, pressure


def bend_off_walls(
    problem: Problem, before: New, new: New, two: Two, joint: bool, nearby: Nearby, steps: int
) -> tuple[Two, float, float]:
    """Bend an arc off the obstacles, if need be with the one before it, and cut it to the part that fits.

    Parameters
    ----------
    problem : Problem
    before, new : New
        The arc before it, and itself.
    two : Two
        Their coordinates.
    joint : bool
        Whether the arc before it may change: there is one, and its end is not asked to be anywhere.
    nearby : Nearby
        Scratch.
    steps : int
        Most steps that bend it.

    Returns
    -------
    two : Two
    overlap : float
        Deepest one, in radii; inf where it does not fit.
    pressure : float
        Mean one.
    """
    (rotation, position), k, _ = new
    q, radius = two[1], thickness(problem, k)
    middle = add(position, mat_vec(rotation, point(0.5 * q[0], 0.5 * q[1], 0.5 * q[2])))
    count, _ = few_near(
        problem.scene, middle, ARC_REACH * q[2] + (EVALUATION_REACH + RADII_AHEAD) * radius, nearby.numbers
    )
    if count == 0 or q[2] == 0.0:
        return two, 0.0, 0.0
    bent, fits, overlap, pressure = _relieve_arc(problem, before, new, two, False, nearby, count, steps)
    if pressure == 0.0:
        return bent, 0.0, 0.0
    if joint and problem.limits[k, BEND_SCALE] > 0.0 and (fits < 1.0 or overlap > SHALLOW):
        reach = ARC_REACH * (two[0][2] + q[2]) + (EVALUATION_REACH + RADII_AHEAD) * radius
        count, _ = few_near(problem.scene, position, reach, nearby.numbers)
        both, more, deepest, left = _relieve_arc(problem, before, new, two, True, nearby, count, steps)
        if more > fits or (more == fits and deepest < overlap):
            bent, fits, overlap, pressure = both, more, deepest, left
    length = fits * q[2]
    if length < problem.limits[k, MIN_LENGTH] or length == 0.0:
        return two, math.inf, 0.0
    last = bent[1]
    part = (fits * last[0], fits * last[1], length)
    if bends_in_plane(problem.limits, k):
        part = project_segment(problem.limits, k, part[0], part[1], length)
    return (bent[0], part), overlap, pressure / length
