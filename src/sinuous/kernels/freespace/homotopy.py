"""Whether one curve can be deformed into another through free space.

Two curves deform into each other where a leash, a straight line from a place on one to a place on the other, can be led
along both from end to end and stays clear: it sweeps a homotopy (homotopic Frechet distance: Chambers et al. 2010, here
with straight leashes; with places at equal fractions of the length it is the uniform visibility deformation of Zhou et
al. 2020, after the visibility deformation of Jaillet & Simeon 2008). How far one place is ahead of the other is free,
up to `LEASH_WINDOW`. So that shape and slack of the curves do not matter they are drawn tight before.

Every step is one that is known to be possible. A leash is examined where the distance known last runs out; between two
evaluations it keeps `LEASH_SLACK` times what it has to keep, by the Lipschitz bound of distances. Leashes that follow
each other are no farther apart than neighbouring points of a curve, h: what is swept between them is clear when `SLACK
* keep` is at least h / 2. Where nothing is found nothing is proved.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.clock import CLOCK_SIZE, begin_for, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, closest, obstacle, read_scene, work_of_all
from sinuous.kernels.fields.solids import EXACT, LOWER_BOUND
from sinuous.kernels.freespace.band import respace, reverse
from sinuous.kernels.maths.buffers import cut
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, get_vec, norm, put_vec, scale, sub

LEASH_SLACK = 0.9
"""What a leash keeps between two evaluations, in units of what it keeps at them."""

EXACT_WITHIN = 2.0
"""Distances below this are asked for exactly, in units of what is to be kept; beyond, a lower bound will do."""

PASSES, EASED = 6, 0.94
"""How often a curve is drawn tight, from either end in turn, and what is left each time of the distance that it has to
keep: ends of leashes may keep less than their evaluations, and have to be let pass the next time."""

LEASH_WINDOW = 0.125
"""How far one end of a leash may be ahead of the other, in units of the length of the curves."""

MOST_PUSHES = 12
"""Most pushes that bring a point off an obstacle."""

LEASH_UNKNOWN, LEASH_FREE, LEASH_BLOCKED = 0, 1, 2
"""What is known of a leash."""

NO_OBSTACLE, OUT_OF_TIME = -1, -2
"""What is in the way of a leash that is no obstacle."""

Leashes = namedtuple("Leashes", ["state", "open"])
"""What is known of the leashes between two curves of N points: `state` (N, 2 w + 1) uint8, from point i of one to point
i + j - w of the other; and a stack of those that can be led on, `open` (s,) int32."""


def homotopy_workspace_size(points: int) -> int:
    """Numbers (float64) that curves of so many points are compared, and drawn tight, in."""
    leashes = points * (2 * int(LEASH_WINDOW * points) + 1)
    return CLOCK_SIZE + 3 * points + leashes // 8 + 1 + leashes + 2


def _follow_line(scene: Scene, a: Vec, b: Vec, keep: float, units: int, clock: Array) -> tuple[float, int]:
    """How far the line from `a` to `b` keeps this distance, and the obstacle that ends it (NO_OBSTACLE; OUT_OF_TIME).

    The distance of a place takes so many evaluations.
    """
    line = sub(b, a)
    length = norm(line)
    gone = 0.0
    while True:
        if spend(clock, units):
            return gone, OUT_OF_TIME
        p = add_scaled(a, gone / length, line) if length > 0.0 else a
        d, which = closest(scene, p, length - gone + keep, LOWER_BOUND)
        if d < EXACT_WITHIN * keep:
            d, which = closest(scene, p, EXACT_WITHIN * keep, EXACT)
        if d < keep:
            return gone, which
        gone += d - LEASH_SLACK * keep
        if gone >= length:
            return length, NO_OBSTACLE


def _is_leash_free(scene: Scene, a: Vec, b: Vec, keep: float, clock: Array) -> bool:
    """Whether the leash from `a` to `b` keeps this distance."""
    _, which = _follow_line(scene, a, b, keep, work_of_all(scene), clock)
    return which == NO_OBSTACLE


def _tighten_once(scene: Scene, curve: Array, keep: float, spare: Array, clock: Array) -> None:
    """Draw `curve` (N, 3) tight once: from point to point, as far as leashes to all that is left out stay clear.

    `spare` (N, 3) is scratch.
    """
    last = curve.shape[0] - 1
    corners = at = 0
    put_vec(spare, 0, 0, get_vec(curve, 0, 0))
    while at < last:
        here, end = get_vec(curve, at, 0), at + 1
        while end < last and _is_leash_free(scene, here, get_vec(curve, end + 1, 0), keep, clock):
            end += 1
        at, corners = end, corners + 1
        put_vec(spare, corners, 0, get_vec(curve, at, 0))
    respace(spare, corners + 1, curve, last + 1)


@entry
def draw_tight(scene: Array, curve: Array, keep: float, seconds: float, workspace: Array) -> None:
    """Draw a curve tight by a deformation that stays clear; its ends stay.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    curve : ndarray (N, 3)
        Points in the length unit, evenly spaced before and after.
    keep : float
        Distance from the obstacles that leashes keep in the first pass; `EASED ** (PASSES - 1)` times that in the last.
    seconds : float
        Budget; where it ends too soon, the curve is less tight.
    workspace : ndarray (w,)
        Scratch, see `homotopy_workspace_size`.
    """
    obstacles, clock = read_scene(scene), workspace[:CLOCK_SIZE].view(np.int64)
    begin_for(clock, seconds)
    count = curve.shape[0]
    spare, _ = cut(workspace[CLOCK_SIZE:], count, 3)
    for _ in range(PASSES):
        _tighten_once(obstacles, curve, keep, spare, clock)
        reverse(curve, count)
        keep *= EASED


def _carve(workspace: Array, count: int) -> Leashes:
    """Lay out what is known of leashes behind clock and spare curve, all of it forgotten."""
    wide = 2 * int(LEASH_WINDOW * count) + 1
    rest = workspace[CLOCK_SIZE + 3 * count :]
    bytes_ = count * wide // 8 + 1
    state = rest[:bytes_].view(np.uint8)[: count * wide].reshape((count, wide))
    for i in range(count):
        for j in range(wide):
            state[i, j] = LEASH_UNKNOWN
    return Leashes(state, rest[bytes_:].view(np.int32))


def _lead_leash(scene: Scene, a: Array, b: Array, keep: float, leashes: Leashes, clock: Array) -> bool:
    """Lead the leash on, both ends together where that goes; says whether it gets to the ends of both curves.

    These are `a` (N, 3) and `b` (N, 3).
    """
    count, wide = leashes.state.shape
    half = wide // 2
    if not _is_leash_free(scene, get_vec(a, 0, 0), get_vec(b, 0, 0), keep, clock):
        return False
    leashes.state[0, half], leashes.open[0], size = LEASH_FREE, half, 1
    while size > 0:
        size -= 1
        at = int(leashes.open[size])
        i, j = at // wide, at // wide + at % wide - half
        if i == count - 1 and j == count - 1:
            return True
        for step in range(3):  # what is put last is led on first: both ends together
            k, m = i + (step != 1), j + (step != 0)
            column = m - k + half
            if k >= count or m >= count or column < 0 or column >= wide or leashes.state[k, column] != LEASH_UNKNOWN:
                continue
            if _is_leash_free(scene, get_vec(a, k, 0), get_vec(b, m, 0), keep, clock):
                leashes.state[k, column], leashes.open[size] = LEASH_FREE, k * wide + column
                size += 1
            else:
                leashes.state[k, column] = LEASH_BLOCKED
    return False


@entry
def deforms(scene: Array, a: Array, b: Array, keep: float, seconds: float, workspace: Array) -> bool:
    """Whether a leash can be led along two curves, from end to end, and keeps this distance at all evaluations.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    a, b : ndarray (N, 3)
        Points in the length unit, evenly spaced.
    keep : float
    seconds : float
        Budget; where it does not suffice the answer is no.
    workspace : ndarray (w,)
        Scratch, see `homotopy_workspace_size`.
    """
    clock = workspace[:CLOCK_SIZE].view(np.int64)
    begin_for(clock, seconds)
    return _lead_leash(read_scene(scene), a, b, keep, _carve(workspace, a.shape[0]), clock)


def _push_off(scene: Scene, p: Vec, keep: float) -> Vec:
    """Push a point off the obstacles, to this distance where that goes."""
    for _ in range(MOST_PUSHES):
        d, which = closest(scene, p, keep, EXACT)
        if d >= keep:
            break
        _, g = obstacle(scene, which, p, math.inf)
        p = add_scaled(p, 1.01 * (keep - d), g)
    return p


@entry
def halfway(scene: Array, a: Array, b: Array, keep: float, seconds: float, workspace: Array, middle: Array) -> bool:
    """Make a curve between two others: halfway between their points, pushed off the obstacles.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    a, b : ndarray (N, 3)
    keep : float
        Distance from the obstacles to which points are pushed.
    seconds : float
        Budget; where it ends too soon, the curve counts as too near to the obstacles.
    workspace : ndarray (w,)
        Scratch, see `homotopy_workspace_size`.
    middle : ndarray (N, 3)
        Filled, evenly spaced.

    Returns
    -------
    bool
        Whether all of the curve keeps nearly that distance, and it is no longer than both together.
    """
    obstacles, clock = read_scene(scene), workspace[:CLOCK_SIZE].view(np.int64)
    begin_for(clock, seconds)
    count = a.shape[0]
    spare, _ = cut(workspace[CLOCK_SIZE:], count, 3)
    most = 0.0
    for i in range(count):
        put_vec(spare, i, 0, _push_off(obstacles, scale(0.5, add(get_vec(a, i, 0), get_vec(b, i, 0))), keep))
        if i > 0:
            most += norm(sub(get_vec(a, i, 0), get_vec(a, i - 1, 0)))
            most += norm(sub(get_vec(b, i, 0), get_vec(b, i - 1, 0)))
    spacing = respace(spare, count, middle, count)
    if spacing * (count - 1) > most:
        return False
    for i in range(count - 1):
        if not _is_leash_free(obstacles, get_vec(middle, i, 0), get_vec(middle, i + 1, 0), LEASH_SLACK * keep, clock):
            return False
    return True


@entry
def trace_lines(
    scene: Array,
    starts: Array,
    ends: Array,
    keep: float,
    seconds: float,
    workspace: Array,
    lengths: Array,
    which: Array,
) -> None:
    """Say how far lines keep their distance.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    starts, ends : ndarray (m, 3)
    keep : float
    seconds : float
        Budget; lines that it does not suffice for end early.
    workspace : ndarray (w,)
        Scratch, see `homotopy_workspace_size`.
    lengths : ndarray (m,)
        Filled with the length, from the start, that keeps the distance.
    which : ndarray (m,) int64
        Filled with the obstacle that comes nearer then; -1 where the whole line keeps the distance, -2
        where there was no time to know.
    """
    obstacles, clock = read_scene(scene), workspace[:CLOCK_SIZE].view(np.int64)
    begin_for(clock, seconds)
    units = work_of_all(obstacles)
    for i in range(starts.shape[0]):
        lengths[i], which[i] = _follow_line(obstacles, get_vec(starts, i, 0), get_vec(ends, i, 0), keep, units, clock)
