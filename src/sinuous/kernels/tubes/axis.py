"""The axis of a tube, followed from inside: rays across it say where its wall is, and where it ends.

Whoever begins in a tube has one way to go, and need not search for it. What a search finds instead may leave by the
wrong mouth, and where it leaves by the right one it bends around the rim: nothing says where the tube ends.
"""

import math

from sinuous.kernels.clock import allow, begin, spend
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, closest, coarseness, price, read_scene
from sinuous.kernels.fields.solids import EXACT, STEP
from sinuous.kernels.maths.vectors import Array, Vec, across, add, add_scaled, get_vec, norm, put_vec, scale, sub

RAYS = 8
"""Rays across the axis, evenly spread."""

ENCLOSED = 7
"""How many of them have to meet a wall in a tube: not all do where it branches."""

FAR = 5.0
"""How far a ray leads."""

REACH = 3.0
"""How far a look reaches."""

BLOCKED, ALMOST = 0.9, 0.05
"""Distance from the obstacles at which a ray ends, because a ball of the radius cannot get through; and how exactly."""

FIRST = 0.15
"""Where the first look at a ray is: at its beginning the distance is the same, whatever way it leads."""

LOOKS = 12
"""Most looks along a ray."""

ASIDE = 0.5
"""How far the axis is moved to the middle of the rays at most, in one step, of the step."""

ROOM = 0.85
"""Distance from the obstacles that the axis has at least."""

COARSE = 1.0
"""Largest spacing of samples that the axis is found by. All lengths in radii of the body but for `ASIDE`."""

BACK = 5
"""Points that are found again with exact distances where a tube ends by samples."""

BEFORE = 2
"""Steps that the direction of the axis is taken over."""

BEYOND, OPEN = 2.0, 4
"""How far beyond a mouth it is looked whether it is one, and how many rays may meet a wall there: where a tube branches
more of them do."""

NO_TUBE, MOUTH, END, BRANCH, UNENDED = range(5)
"""How a tube ends: there is none; where it opens; at a wall; where it branches; or not where it was followed."""


def reach(scene: Scene, p: Vec, direction: Vec, radius: float, mode: int) -> float:
    """How far a ball comes from `p` along a unit vector; inf: farther than a ray leads."""
    gone = FIRST * radius
    for _ in range(LOOKS):
        d, _ = closest(scene, add_scaled(p, gone, direction), REACH * radius, mode)
        gone += min(d, REACH * radius) - BLOCKED * radius
        if d < (BLOCKED + ALMOST) * radius:
            return gone
        if gone > FAR * radius:
            return math.inf
    return gone


def _look_around(scene: Scene, p: Vec, ahead: Vec, radius: float, mode: int) -> tuple[int, Vec]:
    """How many rays across the unit vector `ahead` meet a wall, and how far it is to the middle between walls."""
    a, b = across(ahead)
    count, middle = 0, (0.0, 0.0, 0.0)
    for i in range(RAYS // 2):
        angle = 2.0 * math.pi * i / RAYS
        direction = add(scale(math.cos(angle), a), scale(math.sin(angle), b))
        there = reach(scene, p, direction, radius, mode)
        back = reach(scene, p, scale(-1.0, direction), radius, mode)
        count += int(there < math.inf) + int(back < math.inf)
        if there < math.inf and back < math.inf:
            middle = add_scaled(middle, 2.0 / RAYS * (there - back), direction)
    return count, middle


def _limited(a: Vec, most: float) -> Vec:
    """The vector, no longer than `most`."""
    size = norm(a)
    return scale(most / size, a) if size > most else a


def next_beside(scene: Scene, p: Vec, ahead: Vec, sizes: tuple[float, float], mode: int) -> tuple[int, Vec]:
    """Point of the axis beside `p`; and MOUTH or END where the tube does not go on there, else UNENDED.

    `sizes` are the radius, and how far the axis may be from `p`.
    """
    radius, most = sizes
    hits, middle = _look_around(scene, p, ahead, radius, mode)
    if hits < ENCLOSED:
        return MOUTH, p
    p = add(p, _limited(middle, most))
    d, _ = closest(scene, p, radius, mode)
    return END if d < ROOM * radius else UNENDED, p


def _ahead(points: Array, count: int, ahead: Vec) -> Vec:
    """Where the axis leads from the last of so many points; from the first one as it did before."""
    if count == 1:
        return ahead
    line = sub(get_vec(points, count - 1, 0), get_vec(points, max(0, count - 1 - BEFORE), 0))
    return scale(1.0 / norm(line), line)


def follow_from(
    scene: Scene, ahead: Vec, sizes: tuple[float, float, float], clock: Array, points: Array
) -> tuple[int, int]:
    """Fill `points` from the second on; see `follow_tube`.

    Samples are asked where they are fine enough, until a tube ends by them: then from some points before.
    """
    radius, spacing, free = sizes
    looks = RAYS * 3 * price(scene)
    sampled = coarseness(scene) <= COARSE * radius
    count = 1
    while count < points.shape[0]:
        if spend(clock, looks):
            return count, UNENDED
        last = get_vec(points, count - 1, 0)
        beside = add_scaled(last, max(spacing, free) if count == 1 else spacing, ahead)
        own = (radius, ASIDE * spacing)
        ended, p = next_beside(scene, beside, ahead, own, STEP if sampled else EXACT)
        if ended != UNENDED and sampled:
            sampled, count = False, max(1, count - BACK)
            ahead = _ahead(points, count, ahead)
            continue
        if ended == MOUTH and count > 1:
            hits, _ = _look_around(scene, add_scaled(beside, BEYOND * radius, ahead), ahead, radius, EXACT)
            return count, MOUTH if hits <= OPEN else BRANCH
        if ended != UNENDED:
            return count, NO_TUBE if count == 1 else ended
        put_vec(points, count, 0, p)
        count += 1
        ahead = _ahead(points, count, ahead)
    return count, UNENDED


def reversed_from(points: Array, count: int) -> None:
    """Turn the order of the first `count` points."""
    for i in range(count // 2):
        p = get_vec(points, i, 0)
        put_vec(points, i, 0, get_vec(points, count - 1 - i, 0))
        put_vec(points, count - 1 - i, 0, p)


@entry
def follow_tube(
    scene: Array,
    start: Array,
    sizes: tuple[float, float, float],
    seconds: float,
    clock: Array,
    points: Array,
) -> tuple[int, int]:
    """Follow the axis of the tube that a place lies in.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    start : ndarray (2, 3)
        The place, and the unit vector along which the tube is followed from there.
    sizes : (float, float, float)
        Radius of the body; distance between points of the axis; and how far from the start obstacles do not concern
        the body. In the length unit.
    seconds : float
        Budget.
    clock : ndarray (c,) int64
        Scratch, see `sinuous.kernels.clock`.
    points : ndarray (K, 3)
        Filled with points of the axis, the start first.

    Returns
    -------
    (int, int)
        How many points there are, and how the tube ends: NO_TUBE, MOUTH, END, BRANCH or UNENDED.
    """
    obstacles = read_scene(scene)
    begin(clock)
    allow(clock, seconds)
    put_vec(points, 0, 0, get_vec(start, 0, 0))
    return follow_from(obstacles, get_vec(start, 1, 0), sizes, clock, points)
