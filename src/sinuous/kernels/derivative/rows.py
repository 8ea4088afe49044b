"""The rows at an answer: its targets, then the limits, contacts and self-contacts of which nothing is left."""

import math

from sinuous.kernels import tables as t
from sinuous.kernels.body.contacts import PosedBody
from sinuous.kernels.body.pieces import backbone_of, evaluate_here, free_part, near
from sinuous.kernels.body.self_contacts import PAIR_VALUE, PAIR_WEIGHTS, pull_along, put_place_weights, self_contacts
from sinuous.kernels.body.self_pairs import Shape
from sinuous.kernels.chain.kinematics import body_point, frame
from sinuous.kernels.derivative import layout as v
from sinuous.kernels.derivative.layout import Workspace
from sinuous.kernels.fields.solids import LOWER_BOUND
from sinuous.kernels.maths.vectors import ZERO, Array, Vec, dot, get_vec, put_vec, scale, vec_mat
from sinuous.kernels.problem import Problem
from sinuous.kernels.step.actuation import is_equality
from sinuous.kernels.step.limits import (
    bend_cap,
    bends_in_plane,
    curved_bend,
    free_root,
    in_plane,
    plane_range,
    possible_bend,
)
from sinuous.kernels.step.targets import add_rows, end_segment
from sinuous.kernels.velocity.contacts import closest_place
from sinuous.kernels.velocity.layout import (
    ACTUATOR_LIMIT,
    BEND_LIMIT,
    CLEARANCE_LIMIT,
    CURVATURE_LIMIT,
    LENGTH_LIMIT,
    SELF_CLEARANCE_LIMIT,
)

NEAR_BY = 1e-6
"""What may be left of a limit that is active: rad, and mean lengths of its segment."""

BESIDE = 1.001
"""Gaps up to so many times what is kept are active."""

BESIDE_ITSELF = 2.0
"""The same of the body and itself: these gaps are known to about a quarter of what is kept."""

SEARCH_PIECES = 16
"""Pieces of a segment in each of which one place is the closest: beside an obstacle a bent body may have several."""

CLOSEST_COSINE, MOST_EVALUATIONS = 1e-11, 60
"""Cosine between gradient and tangent at which a place is the closest, and most evaluations for it: at a place beside
it, what moves it along the body would count."""

LIMITS_IN_PLANE = 6
"""Most limits of a segment that bends in one plane: of its length, its bend and its curvature, to either side."""

SAME = 1e-6
"""Difference of fractions of a segment up to which two places are one."""


def _begin(work: Workspace, at: int, kind: int, segment: int, other: int, side: int, slack: float) -> None:
    """Begin row `at` with no weights and no wrench."""
    about, rows = work.about, work.rows
    about[at, v.ROW_KIND], about[at, v.ROW_SEGMENT], about[at, v.ROW_OTHER] = kind, segment, other
    about[at, v.ROW_SIDE], about[at, v.ROW_SLACK] = side, slack
    put_vec(about, at, v.ROW_WRENCH, ZERO)
    put_vec(about, at, v.ROW_WRENCH + 3, ZERO)
    for i in range(rows.shape[1]):
        rows[at, i] = 0.0


def _put_end(work: Workspace, at: int, k: int, torque: Vec, force: Vec) -> None:
    """Put in what a wrench about the base does at the end of segment `k`."""
    put_vec(work.about, at, v.ROW_WRENCH, torque)
    put_vec(work.about, at, v.ROW_WRENCH + 3, force)
    for j in range(k + 1):
        put_vec(work.rows, at, 3 * j, pull_along(work.columns, j, torque, force))


def add_targets(problem: Problem, work: Workspace) -> tuple[int, float]:
    """Write the rows of all targets; returns their number, and the largest residual (robot lengths, rad).

    The slack of such a row is its residual.
    """
    targets, origin, asked = problem.targets, frame(work.frames, 0)[1], work.asked
    at, worst = 0, 0.0
    for i in range(targets.shape[0]):
        k, first = end_segment(targets, i, work.q.shape[0]), at
        at, miss, turn = add_rows(targets, i, work.frames, problem.tool, origin, problem.unit, asked, at)
        worst = max(worst, miss / problem.unit, turn)
        for j in range(first, at):
            _begin(work, j, v.TARGET_ROW, k, i, 0, asked.value[j])
            _put_end(work, j, k, get_vec(asked.twist, j, 0), get_vec(asked.twist, j, 3))
    return at, worst


def _is_active(slack: float, size: float) -> bool:
    """Whether nothing is left of a limit whose gradient has this size in the metric."""
    return size > 0.0 and slack <= NEAR_BY * size


def add_limits(problem: Problem, work: Workspace, first: int) -> tuple[int, int]:
    """Write a row for every limit of a segment or an actuator of which nothing is left, from row `first` on.

    The row is the gradient of the slack. Returns the next free row, and bits of a status: TOO_MANY where they do not
    fit, KINK where a segment that is straight must not bend, as one that is drawn in.
    """
    limits, q, at, capacity, told = problem.limits, work.q, first, work.rows.shape[0], 0
    for k in range(q.shape[0]):
        if at + (LIMITS_IN_PLANE if bends_in_plane(limits, k) else 4) > capacity:
            return at, v.TOO_MANY
        turning, stretching = limits[k, t.BEND_SCALE], limits[k, t.LENGTH_SCALE]
        low, high = q[k, 2] - limits[k, t.MIN_LENGTH], limits[k, t.MAX_LENGTH] - q[k, 2]
        if _is_active(low, stretching):
            _begin(work, at, LENGTH_LIMIT, k, -1, 0, low)
            work.rows[at, 3 * k + 2] = 1.0
            at += 1
        if _is_active(high, stretching):
            _begin(work, at, LENGTH_LIMIT, k, -1, 1, high)
            work.rows[at, 3 * k + 2] = -1.0
            at += 1
        bend = math.hypot(q[k, 0], q[k, 1])
        cap = bend_cap(limits, k, q[k, 2])
        if turning == 0.0:
            continue
        if bends_in_plane(limits, k):
            at, kink = _add_in_plane(limits, work, at, k)
            told |= kink
            continue
        if cap <= NEAR_BY:
            told |= v.KINK
            continue
        inverse, most = -1.0 / max(bend, 1e-300), limits[k, t.MAX_CURVATURE]
        nx, ny = inverse * q[k, 0], inverse * q[k, 1]
        if _is_active(limits[k, t.MAX_BEND] - bend, turning):
            _begin(work, at, BEND_LIMIT, k, -1, 1, limits[k, t.MAX_BEND] - bend)
            work.rows[at, 3 * k], work.rows[at, 3 * k + 1] = nx, ny
            at += 1
        if math.isfinite(most) and _is_active(most * q[k, 2] - bend, turning + most * stretching):
            _begin(work, at, CURVATURE_LIMIT, k, -1, 1, most * q[k, 2] - bend)
            put_vec(work.rows, at, 3 * k, (nx, ny, most))
            at += 1
    at, full = _add_actuators(problem, work, at)
    return at, told | full


def _add_in_plane(limits: Array, work: Workspace, first: int, k: int) -> tuple[int, int]:
    """The same for the bend of segment `k` in its plane."""
    at, z = first, in_plane(limits, k, work.q[k, 0], work.q[k, 1])
    low, high = plane_range(limits, k, work.q[k, 2])
    if high - low <= NEAR_BY:
        return at, v.KINK
    most, growth = curved_bend(limits, k, work.q[k, 2])
    size = 1.0 + growth * limits[k, t.LENGTH_SCALE]
    for i in range(2):
        side = 1.0 - 2.0 * i
        slack = limits[k, t.HIGH_BEND] - z if i == 0 else z - limits[k, t.LOW_BEND]
        if _is_active(slack, 1.0):
            _begin(work, at, BEND_LIMIT, k, -1, 1, slack)
            put_vec(work.rows, at, 3 * k, (-side * limits[k, t.PLANE], -side * limits[k, t.PLANE + 1], 0.0))
            at += 1
        if math.isfinite(most) and _is_active(most - side * z, size):
            _begin(work, at, CURVATURE_LIMIT, k, -1, 1, most - side * z)
            put_vec(work.rows, at, 3 * k, (-side * limits[k, t.PLANE], -side * limits[k, t.PLANE + 1], growth))
            at += 1
    return at, 0


def add_equalities(problem: Problem, work: Workspace, first: int) -> tuple[int, int]:
    """Write a row for every limit of an actuator that leaves one value, from row `first` on: met as targets are."""
    at, table = first, problem.actuation
    for j in range(table.shape[0]):
        if is_equality(table, j):
            if at == work.rows.shape[0]:
                return at, v.TOO_MANY
            last = int(table[j, t.LAST_SEGMENT])
            _begin(work, at, ACTUATOR_LIMIT, last, j, 1, 0.0)
            for k in range(int(table[j, t.FIRST_SEGMENT]), last + 1):
                put_vec(work.rows, at, 3 * k, scale(-1.0, get_vec(table, j, t.WEIGHTS)))
            at += 1
    return at, 0


def _add_actuators(problem: Problem, work: Workspace, first: int) -> tuple[int, int]:
    limits, table, at = problem.limits, problem.actuation, first
    for j in range(table.shape[0]):
        if is_equality(table, j):
            continue
        last = int(table[j, t.LAST_SEGMENT])
        begin = int(table[j, t.FIRST_SEGMENT])
        weights = get_vec(table, j, t.WEIGHTS)
        value = square = 0.0
        for k in range(begin, last + 1):
            value += dot(weights, get_vec(work.q, k, 0))
            seen = vec_mat(weights, free_root(limits, k))
            for i in range(3):
                square += seen[i] ** 2
        for side in range(2):
            slack = table[j, t.MAX_VALUE] - value if side == 1 else value - table[j, t.MIN_VALUE]
            if _is_active(slack, math.sqrt(square)):
                if at == work.rows.shape[0]:
                    return at, v.TOO_MANY
                _begin(work, at, ACTUATOR_LIMIT, last, j, side, slack)
                for k in range(begin, last + 1):
                    put_vec(work.rows, at, 3 * k, scale(1.0 - 2.0 * side, weights))
                at += 1
    return at, 0


def add_contacts(problem: Problem, work: Workspace, first: int, keep: float) -> tuple[int, int]:
    """Write a row for every place of the body whose gap to an obstacle is about `keep` or less, from row `first` on.

    The row is the gradient of the gap. Returns the next free row, and TOO_MANY where they do not fit.
    """
    scene = problem.scene
    q, ahead, mount, at = work.q, BESIDE * keep, problem.mount, first
    body = PosedBody(problem.limits, q, work.frames, problem.unit)
    shape = Shape(problem.limits, q, work.frames, work.spans)
    for k in range(q.shape[0]):
        start, length, radius = free_part(problem.limits, q, k, mount), q[k, 2], problem.limits[k, t.RADIUS]
        mount -= backbone_of(problem.limits, q, k)
        part = 1.0 - start
        if part <= 0.0:
            continue
        middle = body_point(q, work.frames, k, start + 0.5 * part)
        those, _ = near(scene, middle, 0.5 * length * part + radius + ahead, work.near)
        for e in range(those):
            i, before, ended, least = work.near[e], -1, False, 0.0
            for piece in range(SEARCH_PIECES):
                a, b = start + part * piece / SEARCH_PIECES, start + part * (piece + 1) / SEARCH_PIECES
                reach = 0.5 * length * (b - a) + radius + ahead
                if (
                    evaluate_here(scene, i, body_point(q, work.frames, k, 0.5 * (a + b)), reach, LOWER_BOUND)[0]
                    >= reach
                ):
                    continue
                s, d, g, p = closest_place(problem, body, i, (k, a, b), CLOSEST_COSINE, MOST_EVALUATIONS)
                if d - radius > ahead:
                    continue
                if before >= 0 and before == piece - 1:  # of the border between two pieces the closer one tells more
                    if s - a < SAME and least <= d:
                        continue
                    if ended and d <= least:
                        at -= 1
                if at == work.rows.shape[0]:
                    return at, v.TOO_MANY
                before, ended, least = piece, b - s < SAME, d
                _begin(work, at, CLEARANCE_LIMIT, k, i, 0, d - radius - keep)
                put_vec(
                    work.about, at, v.ROW_WRENCH, put_place_weights(shape, work.columns, (k, s, p), g, work.rows, at)
                )
                put_vec(work.about, at, v.ROW_WRENCH + 3, g)
                at += 1
    return at, 0


def add_self_contacts(problem: Problem, work: Workspace, first: int, keep: float) -> tuple[int, int]:
    """The same for the body and itself."""
    if not problem.avoids_itself:
        return first, 0
    shape = Shape(problem.limits, work.q, work.frames, work.spans)
    ahead = BESIDE_ITSELF * keep
    found, _ = self_contacts(shape, work.columns, ahead, problem.unit, work.pairs)
    at = first
    for a in range(found):
        if at == work.rows.shape[0]:
            return at, v.TOO_MANY
        gap, begin, end = ahead - work.pairs[a, PAIR_VALUE] * problem.unit, -1, -1
        for k in range(work.q.shape[0]):
            weights = get_vec(work.pairs, a, PAIR_WEIGHTS + 3 * k)
            if dot(weights, weights) > 0.0:
                begin, end = k if begin < 0 else begin, k
        _begin(work, at, SELF_CLEARANCE_LIMIT, begin, end, 0, gap - keep)
        for k in range(work.q.shape[0]):
            put_vec(work.rows, at, 3 * k, scale(problem.unit, get_vec(work.pairs, a, PAIR_WEIGHTS + 3 * k)))
        at += 1
    return at, 0


def normalise(limits: Array, work: Workspace, count: int) -> None:
    """Bring the first `count` rows to length 1 in the metric: rad, and mean lengths of the segment.

    A row that nothing moves stays as it is. Across the planes of bends rows see nothing.
    """
    for at in range(count):
        square = 0.0
        for k in range(work.q.shape[0]):
            if bends_in_plane(limits, k):
                bends = possible_bend(limits, k, work.rows[at, 3 * k], work.rows[at, 3 * k + 1])
                work.rows[at, 3 * k], work.rows[at, 3 * k + 1] = bends
            turning, stretching = limits[k, t.BEND_SCALE], limits[k, t.LENGTH_SCALE]
            x, y, z = turning * work.rows[at, 3 * k], turning * work.rows[at, 3 * k + 1], work.rows[at, 3 * k + 2]
            square += x * x + y * y + (stretching * z) ** 2
        factor = 1.0 / math.sqrt(square) if square > 0.0 else 1.0
        work.about[at, v.ROW_FACTOR] = factor
        for i in range(work.rows.shape[1]):
            work.rows[at, i] *= factor
