"""Cells of an octree that list which obstacles of a large scene may be the closest to a point in them, or near it.

Of a cell with the radius r about its middle, only obstacles that are no more than 2 r farther from the middle than the
closest one can be the closest to a point in it. So eight cells choose among those that the one about them lists, and a
cell with few is not divided. Who asks needs no more than some steps down the octree, and a few distances. Lists know
how far all others are at least; a question that they do not answer goes to the tree of boxes, so answers are the same.

`memory` (w,) is that of all lists, with two numbers an entry: an obstacle, and how far it is.
"""

import math

from sinuous.kernels import tables as t
from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, evaluate
from sinuous.kernels.fields.hierarchy import CELLS_ROOT, CELLS_SIZE, ENTRY_SIZE, LIST_BEYOND, LIST_COUNT, LIST_SIZE
from sinuous.kernels.fields.solids import EXACT, INTERPOLATED
from sinuous.kernels.maths.vectors import Array, Vec, get_vec, put_vec

FEW_LISTED, MOST_LISTED = 40, 80
"""Obstacles up to which a cell is not divided, and up to which it has a list where it is not."""

DIVISIONS = 7
"""How often the largest cell is halved at most."""

SLACK = 1e-9
"""What distances from middles may be wrong by, as a share of them and of the coordinates."""

PENDING = 8
"""Numbers of a cell that is still to be divided: place of its value, middle (3), half edge, how often it may be halved,
and the list to choose from, its place and how many it has."""

EIGHT = 8

ROOT_3 = math.sqrt(3.0)


def _has_fine_samples(scene: Scene, i: int) -> bool:
    """Whether an obstacle may be the closest by its samples alone: the few of a small mesh would fill all lists."""
    triangles = scene.table[i, t.KIND] == t.TREE and scene.table[i, t.ITEM_KIND] == t.TRIANGLES
    if scene.table[i, t.KIND] < t.TREE or (triangles and scene.table[i, t.ITEM_COUNT] < t.FEWEST_SAMPLED):
        return False
    return bool(scene.table[i, t.FIRST_SAMPLE] >= 0.0)


def _choose(scene: Scene, p: Vec, radius: float, margin: float, memory: Array, first: int, count: int, to: int) -> Vec:
    """Copy those of a list to place `to` that may be the closest to a point within `radius` of `p`, or within `margin`.

    Returns how many they are, how far the nearest is from `p` at least, and all that were left out.
    """
    least = most = math.inf
    for j in range(count):
        i = int(memory[first + ENTRY_SIZE * j])
        d, _ = evaluate(scene, i, p, math.inf, EXACT)
        low, slack = d, 2.0 * scene.table[i, t.ROUNDOFF] + SLACK * (abs(d) + radius)
        if _has_fine_samples(scene, i):
            low, _ = evaluate(scene, i, p, math.inf, INTERPOLATED)
            low, slack = min(d, low), slack + 2.0 * scene.table[i, t.SPACING]
        memory[to + ENTRY_SIZE * j], memory[to + ENTRY_SIZE * j + 1] = i, low - slack
        least, most = min(least, low - slack), min(most, d + slack)
    beyond, chosen = max(most + 2.0 * radius, margin + radius), 0
    beyond += SLACK * abs(beyond)
    for j in range(count):
        i, low = int(memory[to + ENTRY_SIZE * j]), memory[to + ENTRY_SIZE * j + 1]
        if low < beyond:
            memory[to + ENTRY_SIZE * chosen], memory[to + ENTRY_SIZE * chosen + 1] = i, low
            chosen += 1
    return float(chosen), least, beyond


def _sort(memory: Array, at: int, count: int) -> None:
    """Put the entries of a list in the order of their distances."""
    for a in range(at + ENTRY_SIZE, at + ENTRY_SIZE * count, ENTRY_SIZE):
        i, d, b = memory[a], memory[a + 1], a
        while b > at and memory[b - 1] > d:
            memory[b], memory[b + 1] = memory[b - ENTRY_SIZE], memory[b - 1]
            b -= ENTRY_SIZE
        memory[b], memory[b + 1] = i, d


@entry
def list_near(
    table: Array, store: Array, owners: Array, cell: Array, reaches: Array, pending: Array, memory: Array
) -> int:
    """Fill `memory` (w,), which is to follow the store, with the cells of a scene; return how much of it is used.

    Parameters
    ----------
    table, store : ndarray
        Of the scene.
    owners : ndarray (m,) of int64
        Numbers of the obstacles in the tree of boxes.
    cell : ndarray (4,)
        Middle (3) and half edge of the largest cell.
    reaches : ndarray (2,)
        Distance up to which all obstacles are listed, and from which on it is enough to know that all are farther.
    pending : ndarray (c, PENDING)
        Scratch: at most so many cells are made.
    """
    scene, base, used, last = Scene(table, store), store.shape[0], CELLS_SIZE, 1
    for j in range(4):
        memory[j] = pending[0, 1 + j] = cell[j]
    memory[CELLS_ROOT] = 0.0
    pending[0, 0], pending[0, 5], pending[0, 6], pending[0, 7] = CELLS_ROOT, 0.0, used, owners.shape[0]
    if used + ENTRY_SIZE * owners.shape[0] > memory.shape[0]:
        return used
    for j in range(owners.shape[0]):
        memory[used + ENTRY_SIZE * j] = owners[j]
    used += ENTRY_SIZE * owners.shape[0]
    at = 0
    while at < last:
        value, level, first, count = int(pending[at, 0]), pending[at, 5], int(pending[at, 6]), int(pending[at, 7])
        p, half = get_vec(pending, at, 1), pending[at, 4]
        radius, at = ROOT_3 * half, at + 1
        if used + LIST_SIZE + ENTRY_SIZE * count + EIGHT > memory.shape[0]:
            continue
        chosen, least, beyond = _choose(scene, p, radius, reaches[0], memory, first, count, used + LIST_SIZE)
        number, whole = int(chosen), level == DIVISIONS or last + EIGHT > pending.shape[0]
        if number > FEW_LISTED and least - radius >= reaches[1]:
            number, beyond = 0, least
        if number > FEW_LISTED and not whole:
            at_list, used = used + LIST_SIZE, used + LIST_SIZE + ENTRY_SIZE * number
            memory[value] = base + used
            for octant in range(EIGHT):
                x, y, z = octant & 1, octant >> 1 & 1, octant >> 2
                memory[used] = 0.0
                pending[last, 0], pending[last, 4] = used, 0.5 * half
                put_vec(pending, last, 1, (p[0] + (x - 0.5) * half, p[1] + (y - 0.5) * half, p[2] + (z - 0.5) * half))
                pending[last, 5], pending[last, 6], pending[last, 7] = level + 1.0, at_list, number
                last, used = last + 1, used + 1
        elif number <= MOST_LISTED:
            _sort(memory, used + LIST_SIZE, number)
            memory[value], memory[used + LIST_COUNT], memory[used + LIST_BEYOND] = -float(base + used), number, beyond
            used += LIST_SIZE + ENTRY_SIZE * number
    return used
