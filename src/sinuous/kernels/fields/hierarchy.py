"""A tree of boxes about many obstacles: which of them may be near to a point or to a line.

It lies at the beginning of the store, see `tables.HIERARCHY_HEADER`; `sinuous.scene.hierarchy` makes it. An obstacle
that is long and oblique to the axes has several boxes. No point of an obstacle, less what arithmetic may make of its
distance, is out of its boxes: so who is farther from all of them than from another obstacle is not the closest.
"""

from sinuous.kernels import tables as t
from sinuous.kernels.compile import inline
from sinuous.kernels.fields.eight_boxes import BLOCK, EIGHT, nearest_of_eight
from sinuous.kernels.fields.trees import Tree
from sinuous.kernels.maths.vectors import Array, Vec, norm

LEAST_SQUARE = 1e-300
"""Square of a distance that counts as none: who is in a box may be in the obstacle."""

CELLS_HALF, CELLS_ROOT, CELLS_SIZE = 3, 4, 5
"""Numbers that the cells of a scene begin with: middle (3) and half edge of the largest, and its value. A value is the
place in the store of the values of eight smaller cells, less the place of a list, or 0 where there is none."""

LIST_COUNT, LIST_BEYOND, LIST_SIZE, ENTRY_SIZE = 0, 1, 2, 2
"""Numbers that a list begins with, how many obstacles are in it and how far from the middle of its cell all others are
at least; and numbers of an entry: the obstacle, and how far it is from there at least. The nearest come first."""


def tree_over(store: Array) -> Tree:
    """The tree of a hierarchy; its items are numbers of obstacles."""
    items = t.HIERARCHY_HEADER + int(store[t.HIERARCHY_BESIDE])
    count = int(store[t.HIERARCHY_BOXES])
    return Tree(items + count, int(store[t.HIERARCHY_LEVELS]), items, count, 0, 0.0)


def cell_of(store: Array, p: Vec) -> tuple[int, float]:
    """Where in the store the list of the cell of a point is (0: there is none), and how far `p` is from its middle."""
    at = int(store[t.HIERARCHY_CELLS])
    if at == 0:
        return 0, 0.0
    half, value = store[at + CELLS_HALF], store[at + CELLS_ROOT]
    x, y, z = p[0] - store[at], p[1] - store[at + 1], p[2] - store[at + 2]
    if not (abs(x) <= half and abs(y) <= half and abs(z) <= half):
        return 0, 0.0
    while value > 0.0:
        half *= 0.5
        octant = int(x > 0.0) + 2 * int(y > 0.0) + 4 * int(z > 0.0)
        x, y, z = (
            (x - half if x > 0.0 else x + half),
            (y - half if y > 0.0 else y + half),
            (z - half if z > 0.0 else z + half),
        )
        value = store[int(value) + octant]
    return int(-value), norm((x, y, z))


def item_of(tree: Tree, node: int) -> int:
    """Place in the store of the number of the obstacle in a leaf; a walk comes to no empty one, for it has no box."""
    return tree.items + (((node - (1 << tree.levels)) * tree.count) >> tree.levels)


def nearer_leaf(store: Array, tree: Tree, node: int, due: int, p: Vec, best: float) -> tuple[int, int]:
    """Go on from a leaf (0: from the root) to the next whose box has a distance to `p` with a square less than `best`.

    One step goes three levels down, to the nearest of the nodes 8i to 8i + 7 below node i; the first takes what is left
    of the levels. Returns the leaf, or 0 where there is none; and eight bits for each step to it, after a 1: which of
    the eight are still to be visited.
    """
    if node == 0:
        first = 1 << tree.levels % 3
        node, due = (1, 511) if first == 1 else (0, 256 + (1 << 2 * first) - (1 << first))
    else:
        node >>= 3
    while True:
        while due & 255 == 0:
            node, due = node >> 3, due >> 8
            if due == 1:
                return 0, due
        found, near = nearest_of_eight(store, tree.nodes + BLOCK * node, p, best, due & 255)
        due = (due | 255) - 255
        if found != 0:
            due += found - (1 << near)
            node = EIGHT * node + near
            if node >= 1 << tree.levels:
                return node, due
            due = 256 * due + 255


def _meets(store: Array, at: int, p: Vec, line: Vec, margin: float) -> bool:
    """Whether the straight line from `p` on comes within some room of the box at `at`, or nearly (Ericson 2005)."""
    low = store[at], store[at + EIGHT], store[at + 2 * EIGHT]
    high = store[at + 3 * EIGHT], store[at + 4 * EIGHT], store[at + 5 * EIGHT]
    if low[0] > high[0]:  # the box of an empty leaf
        return False
    x, y, z = abs(0.5 * line[0]), abs(0.5 * line[1]), abs(0.5 * line[2])
    a, b, c = 0.5 * (high[0] - low[0]), 0.5 * (high[1] - low[1]), 0.5 * (high[2] - low[2])
    a, b, c = a + margin, b + margin, c + margin
    u = p[0] + 0.5 * line[0] - 0.5 * (low[0] + high[0])
    v = p[1] + 0.5 * line[1] - 0.5 * (low[1] + high[1])
    w = p[2] + 0.5 * line[2] - 0.5 * (low[2] + high[2])
    if abs(u) > a + x or abs(v) > b + y or abs(w) > c + z:
        return False
    slack = 1e-12 * (a + b + c + abs(u) + abs(v) + abs(w)) * (x + y + z)
    return not (
        2.0 * abs(v * line[2] - w * line[1]) > 4.0 * (b * z + c * y + slack)
        or 2.0 * abs(w * line[0] - u * line[2]) > 4.0 * (c * x + a * z + slack)
        or 2.0 * abs(u * line[1] - v * line[0]) > 4.0 * (a * y + b * x + slack)
    )


_meets_here = inline(_meets)


def crossed_leaf(store: Array, tree: Tree, node: int, p: Vec, line: Vec, margin: float) -> int:
    """The first leaf after a leaf (0: of all) whose box comes within some room of the line from `p` on; 0: none is."""
    descend = node == 0 and tree.count > 0
    while True:
        if descend:
            node = 1 if node == 0 else 2 * node
        else:
            while node & 1 == 1:
                node >>= 1
            if node == 0:
                return 0
            node += 1
        descend = _meets_here(store, tree.nodes + BLOCK * (node >> 3) + (node & 7), p, line, margin)
        if descend and node >= 1 << tree.levels:
            return node
