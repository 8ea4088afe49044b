"""A way as an elastic band: points from base to goal, drawn tight, and away from obstacles (Quinlan & Khatib 1993)."""

import math

from sinuous.kernels.compile import kernel
from sinuous.kernels.fields.distances import Scene, closest, obstacle
from sinuous.kernels.fields.solids import STEP
from sinuous.kernels.freespace.grid_astar import Corridor, Lattice, middle
from sinuous.kernels.maths.vectors import Array, Vec, add, add_scaled, get_vec, norm, put_vec, scale, sub

SWEEPS = 24
"""How often all points are moved."""


@kernel
def trace(lattice: Lattice, corridor: Corridor, slot: int, goal: Vec, raw: Array) -> int:
    """Write the way as points: the base, the start ahead of it, middles of cubes, the end before the goal, the goal.

    Returns how many; 0 when `raw` cannot hold them.
    """
    put_vec(raw, 0, 0, corridor.origin)
    put_vec(raw, 1, 0, corridor.start)
    count = 2
    slot = lattice.before[slot]
    while slot >= 0:
        if count + 2 >= raw.shape[0]:
            return 0
        put_vec(raw, count, 0, middle(corridor, lattice.keys[slot]))
        count += 1
        slot = lattice.before[slot]
    if count > 2:
        count -= 1  # the cube of the end itself
    put_vec(raw, count, 0, corridor.goal)
    put_vec(raw, count + 1, 0, goal)
    return count + 2


@kernel
def span(points: Array, count: int) -> float:
    """Length of a line through points."""
    total = 0.0
    for i in range(1, count):
        total += norm(sub(get_vec(points, i, 0), get_vec(points, i - 1, 0)))
    return total


@kernel
def respace(points: Array, count: int, out: Array, wanted: int) -> float:
    """Put `wanted` points evenly on a line through `count` ones; returns the distance between them."""
    gap = span(points, count) / (wanted - 1)
    put_vec(out, 0, 0, get_vec(points, 0, 0))
    i, gone = 1, 0.0
    for j in range(1, wanted - 1):
        while i < count - 1:
            length = norm(sub(get_vec(points, i, 0), get_vec(points, i - 1, 0)))
            if gone + length >= j * gap:
                break
            gone += length
            i += 1
        a, b = get_vec(points, i - 1, 0), get_vec(points, i, 0)
        length = norm(sub(b, a))
        share = min(1.0, (j * gap - gone) / length) if length > 0.0 else 0.0
        put_vec(out, j, 0, add_scaled(a, share, sub(b, a)))
    put_vec(out, wanted - 1, 0, get_vec(points, count - 1, 0))
    return gap


@kernel
def _push_off(scene: Scene, p: Vec, wanted: float, most: float) -> Vec:
    """Move a point away from the nearest obstacle, if that is nearer than `wanted`."""
    d, which = closest(scene, p, wanted, STEP)
    if which < 0 or d >= wanted:
        return p
    _, g = obstacle(scene, which, p)
    return add_scaled(p, min(most, wanted - d), g)


@kernel
def tighten(scene: Scene, corridor: Corridor, way: Array, spare: Array, count: int, goal_free: bool) -> float:
    """Draw the band tight and away from obstacles; returns the distance between its points.

    The first two points stay, and the last; so does the last but one when the goal has a tangent.
    """
    wanted = corridor.radius + corridor.room
    last = count - 1 if goal_free else count - 2
    gap = span(way, count) / (count - 1)
    for sweep in range(SWEEPS):
        most = corridor.cell * (0.5 - 0.4 * sweep / SWEEPS)
        for i in range(2, last):
            p = get_vec(way, i, 0)
            between = scale(0.5, add(get_vec(way, i - 1, 0), get_vec(way, i + 1, 0)))
            pull = sub(between, p)
            size = norm(pull)
            p = add_scaled(p, min(0.7, most / size) if size > 0.0 else 0.0, pull)
            put_vec(way, i, 0, _push_off(scene, p, wanted, most))
        if sweep % 8 == 7:
            gap = respace(way, count, spare, count)
            for i in range(count):
                put_vec(way, i, 0, get_vec(spare, i, 0))
    return gap


@kernel
def points_wanted(length: float, cell: float, most: int) -> int:
    """How many points a band of this length has."""
    return max(6, min(most, math.ceil(length / cell) + 1))
