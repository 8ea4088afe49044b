"""The shortest way along the edges of a graph of configurations (A*, Hart, Nilsson & Raphael 1968).

`nodes` (m, 3 n) are configurations, weighted so that they are as far apart as `space` says; `goals` (g,) int64 numbers
of nodes; `ends` (m,) costs.
"""

import math
from collections import namedtuple

import numpy as np

from sinuous.kernels.compile import entry
from sinuous.kernels.maths import heap
from sinuous.kernels.maths.vectors import Array

Search = namedtuple("Search", ["cost", "left", "before", "priority", "items", "ends"])
"""Of each node the cost of the way there, infinite while none is known (m,); a lower bound of what is left from there
to a goal (m,), -1 where it is not known yet; and the node before (m,) int64, -1: none. A heap, see `maths.heap`, with a
place for every edge and start. What it costs to leave the graph from each node (m,): infinite where it is no goal."""

PER_NODE, PER_PLACE = 3, 2
"""Numbers (float64) of the workspace for each node, and for each place in the heap."""


def walk_size(nodes: int, edges: int) -> int:
    """Numbers (float64) of the workspace of a search over so many nodes and edges, each of these in both directions."""
    return PER_NODE * nodes + PER_PLACE * (edges + nodes)


def _carve(workspace: Array, nodes: int, ends: Array) -> Search:
    """Lay out the memory of a search."""
    places = (workspace.shape[0] - PER_NODE * nodes) // PER_PLACE
    at = PER_NODE * nodes
    return Search(
        workspace[:nodes],
        workspace[nodes : 2 * nodes],
        workspace[2 * nodes : at].view(np.int64),
        workspace[at : at + places],
        workspace[at + places : at + 2 * places].view(np.int64),
        ends,
    )


def _distance(one: Array, other: Array) -> float:
    """Distance of two configurations `one` (3 n,) and `other` (3 n,), weighted already."""
    total = 0.0
    for k in range(one.shape[0]):
        total += (one[k] - other[k]) * (one[k] - other[k])
    return math.sqrt(total)


def _cost_to_go(search: Search, nodes: Array, goals: Array, at: int) -> float:
    """A lower bound of what is left from a node to the nearest of the goals (g,), by numbers of nodes."""
    if search.left[at] < 0.0:
        least = math.inf
        for i in range(goals.shape[0]):
            least = min(least, _distance(nodes[at], nodes[goals[i]]) + search.ends[goals[i]])
        search.left[at] = least
    return float(search.left[at])


def _note_way(search: Search, nodes: Array, goals: Array, size: int, at: int, cost: float, before: int) -> int:
    """Note a way to a node if it is the shortest that is known; returns the size of the heap."""
    if cost >= search.cost[at]:
        return size
    search.cost[at], search.before[at] = cost, before
    return heap.push(search.priority, search.items, size, cost + _cost_to_go(search, nodes, goals, at), at)


@entry
def walk(
    nodes: Array,
    begins: Array,
    neighbours: Array,
    motions: Array,
    closed: Array,
    starts: Array,
    goals: Array,
    costs: Array,
    ends: Array,
    workspace: Array,
    way: Array,
) -> int:
    """Fill `way` with the numbers of the nodes from one of the starts to one of the goals; return how many they are.

    Parameters
    ----------
    nodes : ndarray (m, 3 n)
        Configurations, each coordinate weighted: their distance is the cost of an edge, in the length unit.
    begins : ndarray (m + 1,) of int64
        Where the neighbours of each node begin in `neighbours`.
    neighbours, motions : ndarray (2 e,) of int64
        The neighbours, and the number of the edge to each.
    closed : ndarray (e,) of bool
        Edges that lead nowhere.
    starts, goals : ndarray (s,), (g,) of int64
        Numbers of nodes, each once.
    costs : ndarray (s,)
        What it costs to come to each start.
    ends : ndarray (m,)
        What it costs to go on from each node where it is a goal; infinite where it is none.
    workspace : ndarray
        Scratch, see `walk_size`.
    way : ndarray (w,) of int64

    Returns
    -------
    int
        0 where there is no way, or it has more than w nodes.
    """
    search = _carve(workspace, nodes.shape[0], ends)
    search.cost[:] = math.inf
    search.left[:] = -1.0
    size = 0
    for i in range(starts.shape[0]):
        size = _note_way(search, nodes, goals, size, int(starts[i]), costs[i], -1)
    best, last = math.inf, -1
    while size > 0 and search.priority[0] < best:
        at, size = heap.pop(search.priority, search.items, size)
        gone = search.cost[at]
        if gone + search.ends[at] < best:
            best, last = gone + search.ends[at], at
        for i in range(begins[at], begins[at + 1]):
            if not closed[motions[i]] and size < search.items.shape[0]:
                other = int(neighbours[i])
                size = _note_way(search, nodes, goals, size, other, gone + _distance(nodes[at], nodes[other]), at)
    return _trace(search, last, way)


def _trace(search: Search, last: int, way: Array) -> int:
    """Fill `way` (w,) with the nodes that lead to one, from the first on; return how many that is, or 0."""
    count, at = 0, last
    while at >= 0:
        count, at = count + 1, int(search.before[at])
    if count > way.shape[0]:
        return 0
    at = last
    for i in range(count - 1, -1, -1):
        way[i] = at
        at = int(search.before[at])
    return count
