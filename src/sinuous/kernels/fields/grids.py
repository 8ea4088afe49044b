"""Distances sampled on a regular grid of points: interpolation, and what the samples prove of the points between.

Two bounds. A distance changes by at most the distance moved, so every sample v at c proves `v - |p - c|`. The distance
to a *set* is better than that: `|p|^2 - d(p)^2` is the largest of the affine functions `2 p.s - |s|^2` over the points
s of the set, hence convex, so that interpolation cannot lie below it. With the weights w of the trilinear interpolation
and t, the place in the cell in units of the spacing h,

    d(p)^2 >= sum w d_i^2 - h^2 sum over axes t (1 - t),

which is off by no more than some h^2 / d away from kinks, where the first bound is off by some h.
"""

import math
from collections import namedtuple

from sinuous.kernels.maths.vectors import Array, Vec
from sinuous.kernels.tables import ORIGIN, SHAPE, SPACING

SampleGrid = namedtuple("SampleGrid", ["at", "shape", "low", "spacing"])
"""Where the samples begin in the store (last axis fastest), points along every axis, the first point, spacing."""

CellCorners = tuple[float, float, float, float, float, float, float, float]
"""Samples at the corners of a cell, last axis fastest."""

SQUARE_ROUNDOFF = 1e-13
"""Of a squared spacing: more than rounding adds to a difference of squares; its root is a millionth of a spacing."""


def grid_of(table: Array, i: int, first: int) -> SampleGrid:
    """Grid of obstacle `i`, whose first place in the store column `first` says."""
    return SampleGrid(
        int(table[i, first]),
        (int(table[i, SHAPE]), int(table[i, SHAPE + 1]), int(table[i, SHAPE + 2])),
        (table[i, ORIGIN], table[i, ORIGIN + 1], table[i, ORIGIN + 2]),
        table[i, SPACING],
    )


def _cell(x: float, count: int) -> tuple[int, float]:
    """Cell of a coordinate (in spacings from the first point), clamped to the grid, and the place in it, 0 to 1."""
    x = x if x > 0.0 else 0.0  # also where it is NaN
    i = min(int(min(x, count - 1.0)), max(count - 2, 0))
    return i, min(x - i, 1.0)


def look_up(store: Array, grid: SampleGrid, p: Vec) -> tuple[CellCorners, Vec, Vec]:
    """Corners of the cell of `p`, the place in that cell, and how far `p` is out of the grid along every axis."""
    nx, ny, nz = grid.shape
    per = 1.0 / grid.spacing
    x, y, z = (p[0] - grid.low[0]) * per, (p[1] - grid.low[1]) * per, (p[2] - grid.low[2]) * per
    i, tx = _cell(x, nx)
    j, ty = _cell(y, ny)
    k, tz = _cell(z, nz)
    at = grid.at + (i * ny + j) * nz + k
    # Along an axis with one point only there is no next one, and `t` is 0.
    a, b, c = (ny * nz if nx > 1 else 0), (nz if ny > 1 else 0), (1 if nz > 1 else 0)
    corners = (
        store[at],
        store[at + c],
        store[at + b],
        store[at + b + c],
        store[at + a],
        store[at + a + c],
        store[at + a + b],
        store[at + a + b + c],
    )
    h = grid.spacing
    beyond = (_beyond(x, nx) * h, _beyond(y, ny) * h, _beyond(z, nz) * h)
    return corners, (tx, ty, tz), beyond


def _beyond(x: float, count: int) -> float:
    """How far a coordinate is out of the grid, with its sign."""
    if x < 0.0:
        return x
    return max(x - (count - 1), 0.0)


def _mix(a: float, b: float, t: float) -> float:
    return a + t * (b - a)


def value(v: CellCorners, t: Vec) -> float:
    """Trilinear interpolation."""
    near = _mix(_mix(v[0], v[1], t[2]), _mix(v[2], v[3], t[2]), t[1])
    far = _mix(_mix(v[4], v[5], t[2]), _mix(v[6], v[7], t[2]), t[1])
    return _mix(near, far, t[0])


def slope(v: CellCorners, t: Vec, spacing: float) -> Vec:
    """Gradient of the interpolation."""
    x0, x1 = _mix(v[0], v[1], t[2]), _mix(v[2], v[3], t[2])
    x2, x3 = _mix(v[4], v[5], t[2]), _mix(v[6], v[7], t[2])
    y0, y1 = _mix(v[0], v[2], t[1]), _mix(v[1], v[3], t[1])
    y2, y3 = _mix(v[4], v[6], t[1]), _mix(v[5], v[7], t[1])
    per = 1.0 / spacing
    return (
        per * (_mix(x2, x3, t[1]) - _mix(x0, x1, t[1])),
        per * (_mix(x1, x3, t[0]) - _mix(x0, x2, t[0])),
        per * (_mix(y1, y3, t[0]) - _mix(y0, y2, t[0])),
    )


def _ways(t: Vec, spacing: float) -> CellCorners:
    """Distances to the corners."""
    x0, x1 = t[0] * t[0], (1.0 - t[0]) * (1.0 - t[0])
    y0, y1 = t[1] * t[1], (1.0 - t[1]) * (1.0 - t[1])
    z0, z1 = t[2] * t[2], (1.0 - t[2]) * (1.0 - t[2])
    h = spacing
    return (
        h * math.sqrt(x0 + y0 + z0),
        h * math.sqrt(x0 + y0 + z1),
        h * math.sqrt(x0 + y1 + z0),
        h * math.sqrt(x0 + y1 + z1),
        h * math.sqrt(x1 + y0 + z0),
        h * math.sqrt(x1 + y0 + z1),
        h * math.sqrt(x1 + y1 + z0),
        h * math.sqrt(x1 + y1 + z1),
    )


def at_least(v: CellCorners, t: Vec, spacing: float) -> float:
    """Lower bound of any distance with these samples."""
    w = _ways(t, spacing)
    return max(v[0] - w[0], v[1] - w[1], v[2] - w[2], v[3] - w[3], v[4] - w[4], v[5] - w[5], v[6] - w[6], v[7] - w[7])


def at_most(v: CellCorners, t: Vec, spacing: float) -> float:
    """Upper bound of any distance with these samples."""
    w = _ways(t, spacing)
    return min(v[0] + w[0], v[1] + w[1], v[2] + w[2], v[3] + w[3], v[4] + w[4], v[5] + w[5], v[6] + w[6], v[7] + w[7])


def at_most_below(v: CellCorners, t: Vec, spacing: float, exact_below: float) -> float:
    """The same where samples from a value on are lower bounds alone; infinite where none of them bounds it.

    A distance of 0 or less is known wherever a lower bound of it is no more: inside, no bound says more than it.
    """
    w = _ways(t, spacing)
    least = math.inf
    for i in range(8):
        if v[i] < exact_below or v[i] <= 0.0:
            least = min(least, v[i] + w[i])
    return least


def _outer(v: float) -> float:
    """Square of the distance to a set, which is 0 within it."""
    return v * v if v > 0.0 else 0.0


def set_distance(v: CellCorners, t: Vec, spacing: float) -> float:
    """Lower bound of the distance to a set with these samples."""
    squares = (
        _outer(v[0]),
        _outer(v[1]),
        _outer(v[2]),
        _outer(v[3]),
        _outer(v[4]),
        _outer(v[5]),
        _outer(v[6]),
        _outer(v[7]),
    )
    spread = t[0] * (1.0 - t[0]) + t[1] * (1.0 - t[1]) + t[2] * (1.0 - t[2])
    square = value(squares, t) - spacing * spacing * (spread + SQUARE_ROUNDOFF)
    if square > 4.0 * spacing * spacing:
        return math.sqrt(square)
    least = at_least(v, t, spacing)
    return max(least, math.sqrt(square)) if square > 0.0 else least
