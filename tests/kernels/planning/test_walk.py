"""The shortest way along a graph, against Dijkstra of SciPy."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

from sinuous.kernels.planning.walk import walk, walk_size

Whole = NDArray[np.int64]


def graph(seed: int, count: int = 60) -> tuple[NDArray[np.float64], Whole]:
    """Nodes in six dimensions, and some edges between those that are near, in several parts."""
    rng = np.random.default_rng(seed)
    nodes = rng.random((count, 6))
    apart = np.linalg.norm(nodes[:, None] - nodes, axis=-1)
    pairs = np.argwhere((apart < rng.uniform(0.5, 0.8)) & np.triu(np.ones_like(apart, np.bool_), 1))
    return nodes, pairs


def found(
    nodes: NDArray[np.float64],
    pairs: Whole,
    closed: NDArray[np.bool_],
    ends: dict[int, float],
    begins: dict[int, float],
) -> Whole:
    both = np.concatenate([pairs, pairs[:, ::-1]])
    order = np.lexsort((both[:, 1], both[:, 0]))
    first = np.searchsorted(both[order, 0], np.arange(len(nodes) + 1))
    costs = np.full(len(nodes), np.inf)
    costs[list(ends)] = list(ends.values())
    way = np.empty(len(nodes), np.int64)
    count = walk(
        nodes,
        first,
        np.ascontiguousarray(both[order, 1]),
        order % max(1, len(pairs)),
        closed,
        np.array(list(begins)),
        np.array(list(ends)),
        np.array(list(begins.values())),
        costs,
        np.empty(walk_size(len(nodes), len(both))),
        way,
    )
    return way[:count]


@pytest.mark.parametrize("seed", range(10))
def test_the_way_is_the_shortest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    nodes, pairs = graph(seed)
    closed = rng.random(len(pairs)) < 0.3
    chosen = rng.permutation(len(nodes))
    begins, ends = ({int(i): float(rng.random()) for i in chosen[at : at + 3]} for at in (0, 3))
    lengths = np.linalg.norm(nodes[pairs[:, 0]] - nodes[pairs[:, 1]], axis=1)
    kept = pairs[~closed]
    matrix = coo_array((lengths[~closed], kept.T), shape=(len(nodes),) * 2)
    between = dijkstra(matrix, directed=False)
    best = min(begins[i] + between[i, j] + ends[j] for i in begins for j in ends)
    way = found(nodes, pairs, closed, ends, begins)
    if np.isinf(best):
        assert not len(way)
        return
    assert int(way[0]) in begins
    assert int(way[-1]) in ends
    edges = {tuple(sorted(pair)) for pair in kept.tolist()}
    assert all(tuple(sorted(pair)) in edges for pair in pairwise(way.tolist()))
    length = np.linalg.norm(np.diff(nodes[way], axis=0), axis=1).sum()
    np.testing.assert_allclose(begins[int(way[0])] + length + ends[int(way[-1])], best, rtol=1e-12)
