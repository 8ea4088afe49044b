"""The closest item to each of many points at once: to those of one block of a grid.

The points of a block are so near to each other that nearly the same nodes of the tree have to be opened for each. So
one walk serves all, and what it computes of a node or an item is computed for all points in a row: the processor
takes several at a time. No loop over the points branches.

`work` (6 LANES,) has the columns below for each point, `discs` (2 << levels, 8) the discs about the nodes.
"""

import math

from sinuous.kernels.compile import inline
from sinuous.kernels.fields.discs import DISC_AXIS, DISC_CENTER, DISC_HALF, DISC_RADIUS
from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.fields.triangles import read
from sinuous.kernels.maths.vectors import TINY, Array, cross, dot, get_vec, sub
from sinuous.kernels.tables import BALLS, NODE_SIZE, TRIANGLE_NORMAL, TRIANGLE_SIZE

EDGE = 4
"""Points of a block along each axis."""

LANES = EDGE * EDGE * EDGE

POINT_X, POINT_Y, POINT_Z, BEST, SQUARED_REACH, FOUND = 0, LANES, 2 * LANES, 3 * LANES, 4 * LANES, 5 * LANES
"""Where a workspace holds, of each point: its place, the distance of the closest item, the square that a node must
be closer than, and the number of the closest item."""

WORKSPACE = 6 * LANES


def _boxes(store: Array, at: int, work: Array) -> int:
    """How many points may have something closer in the box at `at`."""
    x0, y0, z0, x1, y1, z1 = store[at], store[at + 1], store[at + 2], store[at + 3], store[at + 4], store[at + 5]
    count = 0
    for i in range(LANES):
        x = max(x0 - work[POINT_X + i], work[POINT_X + i] - x1, 0.0)
        y = max(y0 - work[POINT_Y + i], work[POINT_Y + i] - y1, 0.0)
        z = max(z0 - work[POINT_Z + i], work[POINT_Z + i] - z1, 0.0)
        count += 1 if x * x + y * y + z * z < work[SQUARED_REACH + i] else 0
    return count


def _discs(discs: Array, node: int, work: Array) -> int:
    """How many points may have something closer in a disc; without any root.

    Beside the axis by b, with the radius r, that is b < r + sqrt(rest).
    """
    center, axis = get_vec(discs, node, DISC_CENTER), get_vec(discs, node, DISC_AXIS)
    half, square = discs[node, DISC_HALF], discs[node, DISC_RADIUS] * discs[node, DISC_RADIUS]
    count = 0
    for i in range(LANES):
        x, y, z = work[POINT_X + i] - center[0], work[POINT_Y + i] - center[1], work[POINT_Z + i] - center[2]
        height = x * axis[0] + y * axis[1] + z * axis[2]
        above = max(0.0, abs(height) - half)
        rest = work[SQUARED_REACH + i] - above * above
        beyond = x * x + y * y + z * z - height * height - square - rest
        count += 1 if (rest > 0.0) & ((beyond < 0.0) | (beyond * beyond < 4.0 * square * rest)) else 0
    return count


def _ball(store: Array, at: int, item: int, work: Array) -> None:
    """See `_offer_item`; the ball is at `at`."""
    x0, y0, z0, radius = store[at], store[at + 1], store[at + 2], store[at + 3]
    for i in range(LANES):
        x, y, z = work[POINT_X + i] - x0, work[POINT_Y + i] - y0, work[POINT_Z + i] - z0
        d = math.sqrt(x * x + y * y + z * z) - radius
        closer = d < work[BEST + i]
        best = d if closer else work[BEST + i]
        work[BEST + i] = best
        work[FOUND + i] = item if closer else work[FOUND + i]
        outside = max(best, 0.0)
        work[SQUARED_REACH + i] = outside * outside + TINY


def _triangle(store: Array, at: int, item: int, work: Array) -> None:
    """The same for the triangle at `at`: of points beyond its edges by these, of others by its plane."""
    a, b, c = read(store, at), read(store, at + 3), read(store, at + 6)
    n = read(store, at + TRIANGLE_NORMAL)
    u, v, w = sub(b, a), sub(c, b), sub(a, c)
    nu, nv, nw = cross(u, n), cross(v, n), cross(w, n)
    pu, pv, pw = 1.0 / max(dot(u, u), TINY), 1.0 / max(dot(v, v), TINY), 1.0 / max(dot(w, w), TINY)
    for i in range(LANES):
        x, y, z = work[POINT_X + i], work[POINT_Y + i], work[POINT_Z + i]
        ax, ay, az = x - a[0], y - a[1], z - a[2]
        bx, by, bz = x - b[0], y - b[1], z - b[2]
        cx, cy, cz = x - c[0], y - c[1], z - c[2]
        t = min(max((ax * u[0] + ay * u[1] + az * u[2]) * pu, 0.0), 1.0)
        ex, ey, ez = ax - t * u[0], ay - t * u[1], az - t * u[2]
        least = ex * ex + ey * ey + ez * ez
        t = min(max((bx * v[0] + by * v[1] + bz * v[2]) * pv, 0.0), 1.0)
        ex, ey, ez = bx - t * v[0], by - t * v[1], bz - t * v[2]
        least = min(least, ex * ex + ey * ey + ez * ez)
        t = min(max((cx * w[0] + cy * w[1] + cz * w[2]) * pw, 0.0), 1.0)
        ex, ey, ez = cx - t * w[0], cy - t * w[1], cz - t * w[2]
        least = min(least, ex * ex + ey * ey + ez * ez)
        most = max(ax * nu[0] + ay * nu[1] + az * nu[2], bx * nv[0] + by * nv[1] + bz * nv[2])
        most = max(most, cx * nw[0] + cy * nw[1] + cz * nw[2])
        height = ax * n[0] + ay * n[1] + az * n[2]
        least = height * height if most < 0.0 else least
        closer = least < work[SQUARED_REACH + i]
        work[SQUARED_REACH + i] = least if closer else work[SQUARED_REACH + i]
        work[FOUND + i] = item if closer else work[FOUND + i]


_boxes_here, _discs_here = inline(_boxes), inline(_discs)
_ball_here, _triangle_here = inline(_ball), inline(_triangle)


def _open(store: Array, tree: Tree, discs: Array, node: int, work: Array) -> int:
    """How many points may have something closer in a node."""
    if tree.kind == BALLS:
        return _boxes_here(store, tree.nodes + NODE_SIZE * node, work)
    return _discs_here(discs, node, work)


def _offer_item(store: Array, tree: Tree, item: int, work: Array) -> None:
    """Let an item be the closest of those points that it is closer to."""
    if tree.kind == BALLS:
        _ball_here(store, tree.items + 4 * item, item, work)
    else:
        _triangle_here(store, tree.items + TRIANGLE_SIZE * item, item, work)


def closest(store: Array, tree: Tree, discs: Array, seed: int, work: Array) -> None:
    """Find the item that is closest to each point of a block.

    Parameters
    ----------
    store : ndarray (s,)
    tree : Tree
        Of balls or triangles.
    discs : ndarray (2 << levels, 8)
        Of triangles, see `discs`; of balls (0, 8).
    seed : int
        Any item; the closer it is, the quicker.
    work : ndarray (WORKSPACE,)
        With the points, in the length unit; the numbers of their closest items are filled in.
    """
    for i in range(LANES):
        work[BEST + i], work[SQUARED_REACH + i], work[FOUND + i] = math.inf, math.inf, seed
    _offer_item(store, tree, seed, work)
    node, due = 1, 1
    first_leaf = 1 << tree.levels
    while True:
        if node >= first_leaf:
            leaf = node - first_leaf
            for item in range((leaf * tree.count) >> tree.levels, ((leaf + 1) * tree.count) >> tree.levels):
                _offer_item(store, tree, item, work)
        else:
            left, right = _open(store, tree, discs, 2 * node, work), _open(store, tree, discs, 2 * node + 1, work)
            if left + right > 0:
                node = 2 * node + (0 if left >= right else 1)
                due = 2 * due + (1 if left > 0 and right > 0 else 0)
                continue
        while due & 1 == 0:
            due >>= 1
            node >>= 1
        if due == 1:
            return
        due ^= 1
        node ^= 1
