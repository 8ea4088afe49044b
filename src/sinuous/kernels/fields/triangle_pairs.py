"""Pairs of triangles of one surface that may cross or touch: all but those that their boxes or planes keep apart.

`faces` (f, 3) int64 holds numbers of corners, `corners` (f, 3, 3) where these are, `normals` (f, 3) unit vectors,
`tiny` (f,) what rounding does (length unit), and `nodes` (2 << levels, 6) a tree of boxes.
"""

from sinuous.kernels.compile import entry
from sinuous.kernels.maths.vectors import Array, dot, get_vec, sub
from sinuous.kernels.tables import NODE_SIZE


def _boxes_meet(corners: Array, i: int, j: int) -> bool:
    for axis in range(3):
        a, b, c = corners[i, 0, axis], corners[i, 1, axis], corners[i, 2, axis]
        u, v, w = corners[j, 0, axis], corners[j, 1, axis], corners[j, 2, axis]
        if min(a, b, c) > max(u, v, w) or max(a, b, c) < min(u, v, w):
            return False
    return True


def _meets_node(corners: Array, i: int, nodes: Array, node: int) -> bool:
    for axis in range(3):
        a, b, c = corners[i, 0, axis], corners[i, 1, axis], corners[i, 2, axis]
        if min(a, b, c) > nodes[node, axis + NODE_SIZE // 2] or max(a, b, c) < nodes[node, axis]:
            return False
    return True


def _reaches_across(corners: Array, normals: Array, i: int, j: int, slack: float) -> bool:
    """Whether triangle `j` reaches to both sides of the plane of triangle `i`."""
    n, at = get_vec(normals, i, 0), get_vec(corners[i], 0, 0)
    a = dot(sub(get_vec(corners[j], 0, 0), at), n)
    b = dot(sub(get_vec(corners[j], 1, 0), at), n)
    c = dot(sub(get_vec(corners[j], 2, 0), at), n)
    return min(a, b, c) <= slack and max(a, b, c) >= -slack


def _may_meet(faces: Array, corners: Array, normals: Array, tiny: Array, i: int, j: int) -> int:
    """How many corners two triangles have in common, where they may meet elsewhere; else -1."""
    if not _boxes_meet(corners, i, j):
        return -1
    common = 0
    for a in range(3):
        for b in range(3):
            common += 1 if faces[i, a] == faces[j, b] else 0
    if common > 1:
        return -1
    slack = max(tiny[i], tiny[j])
    slack = -slack if common > 0 else slack
    across = _reaches_across(corners, normals, i, j, slack) and _reaches_across(corners, normals, j, i, slack)
    return common if across else -1


@entry
def gather_pairs(
    nodes: Array,
    levels: int,
    faces: Array,
    corners: Array,
    normals: Array,
    tiny: Array,
    body: Array,
    same: int,
    first: int,
    last: int,
    pairs: Array,
) -> int:
    """Fill `pairs` (k, 3) of triangles `first` up to, without it, `last`, and return how many they are.

    A pair is two numbers, the second larger, and how many corners both have in common, 0 or 1. Where there is no room
    for those of a triangle, it returns -1 - its number, and those before it are in `pairs`, followed by a -1.

    Parameters
    ----------
    nodes : ndarray (2 << levels, 6)
        Boxes of a tree; the triangles are in its order.
    faces : ndarray of int64 (f, 3)
        Vertices.
    corners, normals : ndarray (f, 3, 3), (f, 3)
        In the length unit; unit vectors.
    tiny : ndarray (f,)
        How far beyond a plane is none, in the length unit.
    body : ndarray of int64 (f,)
        Pairs are of one body where `same` is 1, else of two.
    """
    count, number, first_leaf = faces.shape[0], 0, 1 << levels
    for i in range(first, last):
        began, node, due = number, 1, 1
        while due > 0:
            # Leaf k of 2^levels ends at ((k + 1) * count) >> levels; what lies before `i` was paired already.
            shift = 0
            while (node << shift) < first_leaf:
                shift += 1
            end = ((((node + 1) << shift) - first_leaf) * count) >> levels
            if end > i + 1 and _meets_node(corners, i, nodes, node):
                if node < first_leaf:
                    node, due = 2 * node, 2 * due + 1
                    continue
                for j in range(max(i + 1, ((node - first_leaf) * count) >> levels), end):
                    if (1 if body[i] == body[j] else 0) != same:
                        continue
                    common = _may_meet(faces, corners, normals, tiny, i, j)
                    if common >= 0:
                        if number + 1 >= pairs.shape[0]:
                            pairs[began, 0] = -1
                            return -1 - i
                        pairs[number, 0], pairs[number, 1], pairs[number, 2] = i, j, common
                        number += 1
            while due & 1 == 0:
                due >>= 1
                node >>= 1
            node, due = node ^ 1, due ^ 1
    return number
