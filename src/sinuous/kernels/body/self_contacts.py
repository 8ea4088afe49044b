"""Self-contacts: rows of a step that push apart places of the body that are too near to each other.

Such a row `c . dq = value` sees two places, with `c` nonzero from the segment of one to that of the other. The sweeps
know rows of one place alone; `step.coupling` adds these afterwards.

`columns` (n, 18) are those of `chain.kinematics`; `pairs` (m, 1 + 3 n) and `rows` (m, 3 n or more) have a row for each
self-contact.
"""

import math

from sinuous.kernels.body.self_pairs import Meeting, Shape, next_pair, survey
from sinuous.kernels.body.self_pieces import GAP_SLACK, GapAccuracy, gap_at_rest
from sinuous.kernels.chain.kinematics import body_columns, body_point, frame
from sinuous.kernels.compile import shared
from sinuous.kernels.maths.vectors import (
    ZERO,
    Array,
    Vec,
    add,
    add_scaled,
    cross,
    dot,
    get_vec,
    norm,
    put_vec,
    scale,
    sub,
)

MOST_PAIRS = 6
"""Most self-contacts that enter a step: those that overlap the most."""

PAIR_VALUE, PAIR_WEIGHTS = 0, 1
"""Columns of a self-contact: what it asks for, and `c` (3 n)."""

GAP_FLOOR, FINEST_PIECE = 0.25, 0.1
"""How closely gaps are known, and the shortest pieces that are examined, as shares of the margin."""


def pair_width(segments: int) -> int:
    """Numbers of one self-contact."""
    return PAIR_WEIGHTS + 3 * segments


@shared
def self_contacts(shape: Shape, columns: Array, margin: float, unit: float, pairs: Array) -> tuple[int, float]:
    """Write a row for every two segments with a gap below `margin` (length) that concern each other.

    `columns` (n, 18) as `kinematics` fills them; `unit`: the length that rows are measured in. Fills `pairs`
    (m, 1 + 3 n), of too many with those that overlap the most. Returns how many there are, and a lower bound of all
    gaps (infinite: none is below the margin).
    """
    n = shape.q.shape[0]
    _, thickest = survey(shape)
    count, low = 0, math.inf
    if thickest == 0.0:
        return count, low
    accuracy = GapAccuracy(margin, margin, -math.inf, GAP_SLACK, GAP_FLOOR * margin, FINEST_PIECE * margin, 0.0, False)
    i, j = -1, n
    while True:
        i, j, _ = next_pair(shape, i, j, margin, thickest)
        if i == n:
            return count, low
        sure, gap, places, _ = gap_at_rest(shape, i, j, accuracy, math.inf)
        if gap >= margin:
            continue
        low = min(low, sure)
        at = _place_for(pairs, count, (margin - gap) / unit)
        if at >= 0:
            pairs[at, PAIR_VALUE] = (margin - gap) / unit
            _put_weights(shape, columns, places, unit, pairs, at)
            count = max(count, at + 1)


def _place_for(pairs: Array, count: int, value: float) -> int:
    """The next free row, else that of the self-contact that asks for least; -1 where all ask for more than `value`."""
    if count < pairs.shape[0]:
        return count
    least = 0
    for a in range(1, count):
        if pairs[a, PAIR_VALUE] < pairs[least, PAIR_VALUE]:
            least = a
    return least if pairs[least, PAIR_VALUE] < value else -1


def pull_along(columns: Array, k: int, torque: Vec, force: Vec) -> Vec:
    """What a force does along the three coordinates of segment `k`, as if it held on to what lies beyond it."""
    return (
        dot(get_vec(columns, k, 0), torque) + dot(get_vec(columns, k, 3), force),
        dot(get_vec(columns, k, 6), torque) + dot(get_vec(columns, k, 9), force),
        dot(get_vec(columns, k, 12), torque) + dot(get_vec(columns, k, 15), force),
    )


def pull_at(shape: Shape, origin: Vec, k: int, s: float, torque: Vec, force: Vec) -> Vec:
    """What a force at the fraction `s` of segment `k` does along the three coordinates of that segment."""
    x, y, z = body_columns(shape.q, shape.frames, origin, k, s)
    return (
        s * (dot(torque, x[0]) + dot(force, x[1])),
        s * (dot(torque, y[0]) + dot(force, y[1])),
        s * dot(force, z[1]),
    )


def put_place_weights(
    shape: Shape, columns: Array, place: tuple[int, float, Vec], force: Vec, rows: Array, at: int
) -> Vec:
    """Write into row `at` how a place, as `rows.Place`, moves along `force` with every coordinate; returns its torque.

    The torque is about the base, where `force` acts at the place.
    """
    k, s, p = place
    origin = frame(shape.frames, 0)[1]
    torque = cross(sub(p, origin), force)
    for j in range(shape.q.shape[0]):
        weights = pull_along(columns, j, torque, force) if j < k else ZERO
        if j == k:
            weights = pull_at(shape, origin, k, s, torque, force)
        put_vec(rows, at, 3 * j, weights)
    return torque


def _put_weights(shape: Shape, columns: Array, places: Meeting, unit: float, pairs: Array, at: int) -> None:
    """Write `c`: how the distance of two places, in units of `unit`, changes with every coordinate.

    The force that pushes the second place away from the first has the same torque at both, for it acts along the line
    between them.
    """
    i, s, j, t = places
    origin = frame(shape.frames, 0)[1]
    first, second = body_point(shape.q, shape.frames, i, s), body_point(shape.q, shape.frames, j, t)
    force, apart = sub(second, first), norm(sub(second, first))
    force = scale(1.0 / (apart * unit), force) if apart > 1e-12 * unit else (0.0, 0.0, 1.0 / unit)
    torque = cross(sub(second, origin), force)
    for k in range(shape.q.shape[0]):
        weights = pull_along(columns, k, torque, force) if i <= k < j else ZERO
        if k == i:
            weights = add_scaled(weights, -1.0, pull_at(shape, origin, i, s, torque, force))
        if k == j:
            weights = add(weights, pull_at(shape, origin, j, t, torque, force))
        put_vec(pairs, at, PAIR_WEIGHTS + 3 * k, weights)
