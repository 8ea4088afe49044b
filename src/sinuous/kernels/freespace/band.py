"""A route as an elastic band: points drawn tight, and away from obstacles (Quinlan & Khatib 1993).

`points` (N, 3) are those of a line.
"""

import math

from sinuous.kernels.clock import spend
from sinuous.kernels.fields.distances import Scene, closest, obstacle, work_of_all
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.freespace.grid import SearchGrid, onto_plane
from sinuous.kernels.maths.vectors import Array, add, add_scaled, get_vec, norm, put_vec, scale, sub

SWEEPS = 24
"""How often all points are moved."""

RESPACED = 8
"""After so many sweeps they are spaced evenly again."""

FEWEST = 6
"""Points that a band has at least."""


def line_length(points: Array, count: int) -> float:
    """Length of a line through the first `count` of `points` (m, 3)."""
    total = 0.0
    for i in range(1, count):
        total += norm(sub(get_vec(points, i, 0), get_vec(points, i - 1, 0)))
    return total


def respace(points: Array, count: int, out: Array, wanted: int) -> float:
    """Fill `out` (N, 3) with `wanted` points, evenly on the line through the first `count`; returns their distance."""
    spacing = line_length(points, count) / (wanted - 1)
    put_vec(out, 0, 0, get_vec(points, 0, 0))
    i, gone = 1, 0.0
    for j in range(1, wanted - 1):
        while i < count - 1:
            length = norm(sub(get_vec(points, i, 0), get_vec(points, i - 1, 0)))
            if gone + length >= j * spacing:
                break
            gone += length
            i += 1
        a, b = get_vec(points, i - 1, 0), get_vec(points, i, 0)
        length = norm(sub(b, a))
        fraction = min(1.0, (j * spacing - gone) / length) if length > 0.0 else 0.0
        put_vec(out, j, 0, add_scaled(a, fraction, sub(b, a)))
    put_vec(out, wanted - 1, 0, get_vec(points, count - 1, 0))
    return spacing


def reverse(points: Array, count: int) -> None:
    """Let the first `count` of `points` (m, 3) run the other way."""
    for i in range(count // 2):
        p = get_vec(points, i, 0)
        put_vec(points, i, 0, get_vec(points, count - 1 - i, 0))
        put_vec(points, count - 1 - i, 0, p)


def tighten(scene: Scene, grid: SearchGrid, route: Array, scratch: Array, clock: Array, count: int) -> None:
    """Draw the first `count` points of `route` (m, 3) tight and away from obstacles, as far as the time allows.

    The first two points stay, and the last. Where a point is far from all obstacles nobody asks again before it has
    moved as far. `scratch` (2 count, 3) is written over.
    """
    wanted = grid.radius + grid.free_margin
    spare, free, units = scratch[:count], scratch[count:], work_of_all(scene)
    for sweep in range(SWEEPS):
        most = grid.cell * (0.5 - 0.4 * sweep / SWEEPS)
        if sweep % RESPACED == 0:
            for i in range(count):
                free[i, 0] = 0.0
        for i in range(2, count - 1):
            p = get_vec(route, i, 0)
            between = scale(0.5, add(get_vec(route, i - 1, 0), get_vec(route, i + 1, 0)))
            pull = sub(between, p)
            size = norm(pull)
            p = add_scaled(p, min(0.7, most / size) if size > 0.0 else 0.0, pull)
            free[i, 0] -= min(0.7 * size, most)
            if free[i, 0] < 0.0:
                if spend(clock, units):
                    return
                d, which = closest(scene, p, wanted + RESPACED * most, INTERPOLATED)
                free[i, 0] = d - wanted
                if d < wanted:
                    _, g = obstacle(scene, which, p, d)
                    p = add_scaled(p, min(most, wanted - d), g)
            put_vec(route, i, 0, onto_plane(grid, p))
        if sweep % RESPACED == RESPACED - 1:
            respace(route, count, spare, count)
            for i in range(count):
                put_vec(route, i, 0, get_vec(spare, i, 0))


def count_points(length: float, cell: float, most: int) -> int:
    """How many points a band of this length has."""
    return max(FEWEST, min(most, math.ceil(length / cell) + 1))
