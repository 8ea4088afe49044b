"""How far a surface leaves another one at most: an upper bound that is as near to that as is asked.

The distance to one triangle is convex, so within a triangle it is largest at a corner. Of some triangles that are near
the corners, the one whose largest distance is least bounds the distance to the surface; where that is much more than
what the corners have, the triangle is halved across its longest side.

`stack` (s, 10) holds parts of triangles: their corners (9) and how often they were halved.
"""

import math

from sinuous.kernels.compile import entry
from sinuous.kernels.fields.trees import Tree, closest, item_distance, tree_of
from sinuous.kernels.maths.vectors import Array, Vec, add, dot, get_mat, get_vec, put_mat, scale, sub

DEEPEST = 30
"""Times that a triangle is halved, at most; what is left then counts with its bound."""

DEPTH, STACK_SIZE = 9, 10
"""Column of a triangle that is still to be examined, after its corners: how often it was halved."""

NEARLY = 1.02
"""By how many times the bound may be more than what is known to be there."""


def _nearest(store: Array, tree: Tree, p: Vec, seed: int) -> tuple[int, float]:
    """Triangle that is closest to `p`, and the square of its distance; `seed` is one that may be."""
    known = item_distance(store, tree, seed, p, math.inf)
    found, square = closest(store, tree, p, known)
    return (found, square) if found >= 0 else (seed, known)


def _largest(store: Array, tree: Tree, item: int, a: Vec, b: Vec, c: Vec) -> float:
    """Square of the largest distance of a triangle to one triangle of the tree."""
    own = max(item_distance(store, tree, item, a, math.inf), item_distance(store, tree, item, b, math.inf))
    return max(own, item_distance(store, tree, item, c, math.inf))


def _put(stack: Array, at: int, a: Vec, b: Vec, c: Vec, depth: float) -> None:
    put_mat(stack, at, 0, (a, b, c))
    stack[at, DEPTH] = depth


def _square(a: Vec, b: Vec) -> float:
    side = sub(b, a)
    return dot(side, side)


@entry
def nearest(table: Array, store: Array, points: Array, items: Array, squares: Array) -> None:
    """Fill `items` (v,), the closest triangle of each of `points` (v, 3), and squared distances `squares` (v,)."""
    tree, near = tree_of(table, 0), 0
    for v in range(points.shape[0]):
        near, squares[v] = _nearest(store, tree, get_vec(points, v, 0), near)
        items[v] = near


@entry
def largest_distance(
    table: Array,
    store: Array,
    points: Array,
    faces: Array,
    items: Array,
    squares: Array,
    first: int,
    last: int,
    enough: float,
    most: float,
    stack: Array,
) -> float:
    """Upper bound of the distance of `faces` `first` up to, without it, `last` to the surface of the one obstacle.

    It is no more than `NEARLY` times the largest distance, or than `enough`, but for what was halved `DEEPEST` times.
    Infinite as soon as some place is farther away than `most`.

    Parameters
    ----------
    points : ndarray (v, 3)
    faces : ndarray of int64 (f, 3)
    items, squares : ndarray (v,)
        See `nearest`.
    stack : ndarray (DEEPEST + 2, STACK_SIZE)
        Overwritten.
    """
    tree = tree_of(table, 0)
    bound, known, accepted = 0.0, 0.0, enough * enough
    for f in range(first, last):
        u, v, w = faces[f, 0], faces[f, 1], faces[f, 2]
        i, j, k = items[u], items[v], items[w]
        a, b, c, depth, due = get_vec(points, u, 0), get_vec(points, v, 0), get_vec(points, w, 0), 0.0, 0
        farthest = max(squares[u], squares[v], squares[w])
        while True:
            known = max(known, farthest)
            if known > most * most:
                return math.inf
            accepted = max(accepted, NEARLY * NEARLY * known)
            own = _largest(store, tree, i, a, b, c)
            if own > accepted and j != i:
                own = min(own, _largest(store, tree, j, a, b, c))
            if own > accepted and k != i:
                own = min(own, _largest(store, tree, k, a, b, c))
            if own > accepted:
                near, _ = _nearest(store, tree, scale(1.0 / 3.0, add(a, add(b, c))), i)
                own = min(own, _largest(store, tree, near, a, b, c))
            if own <= accepted or depth >= DEEPEST:
                bound = max(bound, own)
            else:
                ab, bc, ca = _square(a, b), _square(b, c), _square(c, a)
                if bc >= max(ab, ca):
                    a, b, c = b, c, a
                elif ca >= ab:
                    a, b, c = c, a, b
                middle = scale(0.5, add(a, b))
                _put(stack, due, a, middle, c, depth + 1.0)
                _put(stack, due + 1, middle, b, c, depth + 1.0)
                due += 2
            if due == 0:
                break
            due -= 1
            (a, b, c), depth = get_mat(stack, due, 0), stack[due, DEPTH]
            i, at_a = _nearest(store, tree, a, i)
            j, at_b = _nearest(store, tree, b, i)
            k, at_c = _nearest(store, tree, c, j)
            farthest = max(at_a, at_b, at_c)
    return math.sqrt(bound)
