"""A route made as long as the body that has to lie along it: a rod of that length, bent aside where there is room.

The shortest route out of a pipe is often shorter than a body can be, and laid along it the body leaves it in the pipe.
So the excess is put where the obstacles leave room: there the route is begun with a bow to one side, as far as the
walls let it. The rod is then relaxed by projections (position-based dynamics, Mueller et al. 2007): its points are
smoothed, pushed off the obstacles, moved apart where it turns more tightly than the body can, and put at their
distances again.
"""

import math

import numpy as np

from sinuous.kernels.clock import CLOCK_SIZE, allow, begin, late, spend
from sinuous.kernels.compile import entry, kernel
from sinuous.kernels.fields.distances import Scene, closest, price, read_scene
from sinuous.kernels.fields.solids import STEP
from sinuous.kernels.freespace.band import push_off, respace, span
from sinuous.kernels.freespace.query import Query, read_query
from sinuous.kernels.maths.vectors import Array, Vec, across, add, add_scaled, copy, get_vec, norm, put_vec, scale, sub

OPEN, CLEAR, LEAST, HOPELESS = 2.5, 1.15, 0.85, 0.6
"""Distances from the obstacles, in radii of the body: from which on there is room for a bow; to which points are
pushed; which the rod must keep; and which the route must have had."""

ARC = 1.5
"""Length of the stretches that are kept from turning more tightly than the body can, in radii of its tightest turn."""

HELD = 3
"""Points at an end that stay on its tangent, at least."""

ROUNDS, SWEEPS = 120, 4
"""How often the rod is smoothed, and how often its spacing is mended each time, from either end in turn."""

STRETCH = 1.04
"""Spacing that is aimed at, in units of that of the wanted length: smoothing draws the rod together."""

LOOKS_ASIDE, HALVINGS = 16, 24
"""Steps in which it is looked how far a point can move aside, and halvings in the search for the height of the bow."""


def lengthen_workspace_size(points: int) -> int:
    """Numbers (float64) that lengthening works in, for routes of so many points."""
    return CLOCK_SIZE + 4 * points


@kernel
def _distance_kept(scene: Scene, query: Query, line: Array, clock: Array) -> float:
    """Least distance of a line (K, 3) from the obstacles that concern it; infinite without any."""
    least, gone, looks = math.inf, 0.0, price(scene)
    for i in range(line.shape[0]):
        p = get_vec(line, i, 0)
        gone += norm(sub(p, get_vec(line, max(0, i - 1), 0)))
        if gone >= query.free_length and not spend(clock, looks):
            d, _ = closest(scene, p, least, STEP)
            least = min(least, d)
    return least


@kernel
def _open_stretch(scene: Scene, radius: float, line: Array, clock: Array) -> tuple[int, int]:
    """First and last point of the longest stretch of `line` (K, 3) with room on all sides."""
    best_first = best_last = first = 0
    looks = price(scene)
    for i in range(line.shape[0]):
        d, _ = closest(scene, get_vec(line, i, 0), OPEN * radius, STEP)
        if d < OPEN * radius or spend(clock, looks):
            first = i + 1
        elif i - first > best_last - best_first:
            best_first, best_last = first, i
    return best_first, best_last


@kernel
def _free_way(scene: Scene, p: Vec, axis: Vec, clear: float, most: float) -> float:
    """How far, at most `most`, the point `p` can move along `axis` and stay so far from the obstacles."""
    gone = 0.0
    for _ in range(LOOKS_ASIDE):
        d, _ = closest(scene, add_scaled(p, gone, axis), most + clear, STEP)
        if d < clear or gone >= most:
            break
        gone += max(d - clear, 0.05 * clear)
    return min(gone, most)


@kernel
def _bend(line: Array, ways: Array, first: int, last: int, axis: Vec, height: float, out: Array) -> None:
    """Fill `out` (K, 3) with `line`, bent aside between two points, no point farther than its way (K,)."""
    copy(line, out)
    for i in range(first, last + 1):
        s = math.sin(math.pi * (i - first) / (last - first))
        put_vec(out, i, 0, add_scaled(get_vec(line, i, 0), min(height * s * s, ways[i]), axis))


@kernel
def _bow(
    scene: Scene, radius: float, line: Array, length: float, angle: float, ways: Array, out: Array, clock: Array
) -> bool:
    """Fill `out` (K, 3) with `line`, bent aside until it is of a length; False without room."""
    count, looks = line.shape[0], LOOKS_ASIDE * price(scene)
    first, last = _open_stretch(scene, radius, line, clock)
    if last - first < 2:
        return False
    chord = sub(get_vec(line, last, 0), get_vec(line, first, 0))
    size = norm(chord)
    a, b = across(scale(1.0 / size, chord) if size > 0.0 else (0.0, 0.0, 1.0))
    axis = add(scale(math.cos(angle), a), scale(math.sin(angle), b))
    for i in range(first, last + 1):
        if spend(clock, looks):
            return False
        ways[i] = _free_way(scene, get_vec(line, i, 0), axis, CLEAR * radius, 0.5 * length)
    low, high = 0.0, 0.5 * length
    for _ in range(HALVINGS):
        if spend(clock, count):
            return False
        height = 0.5 * (low + high)
        _bend(line, ways, first, last, axis, height, out)
        if span(out, count) < length:
            low = height
        else:
            high = height
    return True


@kernel
def _hold(query: Query, rod: Array, spacing: float, first: int, last: int) -> None:
    """Put the points of `rod` (K, 3) before `first`, and from `last` on, on the tangents of the ends."""
    end = rod.shape[0] - 1
    for i in range(first):
        put_vec(rod, i, 0, add_scaled(query.origin, i * spacing, query.axis))
    for i in range(last, end + 1):
        put_vec(rod, i, 0, add_scaled(query.goal, (end - i) * spacing, query.back))


@kernel
def _mend(rod: Array, i: int, spacing: float, first: int, last: int) -> None:
    """Put the points i and i + 1 of `rod` (K, 3) at their distance; those before `first` and from `last` on stay."""
    p, q = get_vec(rod, i, 0), get_vec(rod, i + 1, 0)
    here, there = 1.0 if i >= first else 0.0, 1.0 if i + 1 < last else 0.0
    between = sub(q, p)
    size = norm(between)
    if here + there == 0.0 or size == 0.0:
        return
    off = (size - spacing) / (size * (here + there))
    put_vec(rod, i, 0, add_scaled(p, here * off, between))
    put_vec(rod, i + 1, 0, add_scaled(q, -there * off, between))


@kernel
def _unbend(rod: Array, reach: int, chord: float, first: int, last: int) -> None:
    """Move points of `rod` (K, 3) that are `reach` points apart away from each other, to a distance of `chord`.

    Closer than that they lie on a curve that turns more tightly than the body can; those before `first` and from `last`
    on stay.
    """
    for i in range(rod.shape[0] - reach):
        p, q = get_vec(rod, i, 0), get_vec(rod, i + reach, 0)
        between = sub(q, p)
        size = norm(between)
        if 0.0 < size < chord:
            here, there = 1.0 if i >= first else 0.0, 1.0 if i + reach < last else 0.0
            off = 0.5 * (size - chord) / size
            put_vec(rod, i, 0, add_scaled(p, here * off, between))
            put_vec(rod, i + reach, 0, add_scaled(q, -there * off, between))


@kernel
def _relax(scene: Scene, query: Query, rod: Array, spacing: float, first: int, last: int, clock: Array) -> None:
    """Relax the points of `rod` (K, 3) from `first` up to, without it, `last`, as far as the time allows."""
    count, looks = rod.shape[0], price(scene)
    reach = min(count - 1, max(2, math.ceil(ARC * query.turn / spacing)))
    chord = 2.0 * query.turn * math.sin(min(0.5 * math.pi, 0.5 * reach * spacing / query.turn))
    for turn in range(ROUNDS):
        _hold(query, rod, spacing, first, last)
        for i in range(first, last):
            p = get_vec(rod, i, 0)
            between = scale(0.5, add(get_vec(rod, i - 1, 0), get_vec(rod, i + 1, 0)))
            p = add_scaled(p, 0.5, sub(between, p))
            if turn % 2 == 0:
                if spend(clock, looks):
                    return
                p = push_off(scene, p, CLEAR * query.radius, query.radius)
            put_vec(rod, i, 0, p)
        if spend(clock, (SWEEPS + 1) * count):
            return
        _unbend(rod, reach, chord, first, last)
        for sweep in range(SWEEPS):
            for i in range(count - 1):
                _mend(rod, i if sweep % 2 == 0 else count - 2 - i, spacing, first, last)


@kernel
def _lengthen(scene: Scene, query: Query, route: Array, angle: float, workspace: Array, rod: Array) -> bool:
    """See `lengthen_route`."""
    clock, count = workspace[:CLOCK_SIZE].view(np.int64), rod.shape[0]
    line, ways = workspace[CLOCK_SIZE + count :][: 3 * count].reshape((count, 3)), workspace[CLOCK_SIZE:][:count]
    length = query.shortest + query.goal_radius
    if span(route, route.shape[0]) >= length or _distance_kept(scene, query, route, clock) < HOPELESS * query.radius:
        return False
    respace(route, route.shape[0], line, count)
    if not _bow(scene, query.radius, line, length, angle, ways, rod, clock):
        return False
    copy(rod, line)
    respace(line, count, rod, count)
    spacing = STRETCH * length / (count - 1)
    first = max(HELD, math.ceil(max(query.straight_min, query.free_length) / spacing) + 1)
    last = count - (HELD if norm(query.back) > 0.0 else 1)
    _relax(scene, query, rod, spacing, min(first, last), last, clock)
    _hold(query, rod, spacing, min(first, last), last)
    if late(clock) or _distance_kept(scene, query, rod, clock) < LEAST * query.radius:
        return False
    if query.goal_radius > 0.0:
        copy(rod, line)
        respace(line, max(2, math.ceil(count * query.shortest / length)), rod, count)
    return True


@entry
def lengthen_route(
    scene: Array, query: Array, route: Array, angle: float, seconds: float, workspace: Array, rod: Array
) -> bool:
    """Make a route as long as the body at its shortest.

    Parameters
    ----------
    scene : ndarray
        Group, laid out as `sinuous.kernels.tables` says.
    query : ndarray (28,)
        What the route has to keep, laid out as there.
    route : ndarray (m, 3)
        From the origin to the goal, in the length unit.
    angle : float
        To which side it is bent, in rad.
    seconds : float
        Budget.
    workspace : ndarray (w,)
        Scratch, see `lengthen_workspace_size`.
    rod : ndarray (K, 3)
        Filled with points that are evenly spaced, or nearly so: from the origin to where the body ends, before a tool.

    Returns
    -------
    bool
        Whether there is such a route. There is none where the route is long enough, where it or what is made of it
        cuts through an obstacle, where there is no room, or where the time does not suffice.
    """
    clock = workspace[:CLOCK_SIZE].view(np.int64)
    begin(clock)
    allow(clock, seconds)
    return _lengthen(read_scene(scene), read_query(query), route, angle, workspace, rod)
