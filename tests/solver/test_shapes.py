"""The shapes of a memory and the motions between them: numbers stay right when some are forgotten."""

from itertools import pairwise

import numpy as np
import pytest

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.solver.shapes import SPACING, Shapes

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), max_bend=2.0)


def some(count: int, seed: int = 0) -> Floats:
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(-1.0, 1.0, (count, 2, 2)), rng.uniform(0.8, 1.2, (count, 2, 1))], axis=2)


def ends(shapes: Shapes) -> set[tuple[bytes, bytes]]:
    """Return the motions by the shapes at their ends."""
    return {(shapes.q[i].tobytes(), shapes.q[j].tobytes()) for i, j in shapes.edges.tolist()}


def test_motions_are_kept_once_and_lead_to_the_same_shapes() -> None:
    shapes, q = Shapes(ROBOT, 1.0), some(4)
    version = shapes.version
    assert shapes.add(q, np.array([[1, 0], [0, 1], [2, 2], [3, 1]])) == 4
    assert shapes.edges.tolist() == [[0, 1], [1, 3]]
    assert shapes.version != version
    shapes.keep(np.array([False, True, True, True]), np.array([True, True]))
    assert shapes.edges.tolist() == [[0, 2]]
    np.testing.assert_array_equal(shapes.q, q[1:])


def test_what_motions_join_is_not_forgotten() -> None:
    shapes = Shapes(ROBOT, 0.05)
    joined = some(10)
    shapes.add(joined, np.stack([np.arange(9), np.arange(1, 10)], axis=1))
    before = ends(shapes)
    for seed in range(1, 9):
        shapes.add(some(20, seed))
        assert len(shapes) <= shapes.most
        assert ends(shapes) == before
    np.testing.assert_array_equal(shapes.q[-1], some(20, 8)[-1])
    left = shapes.most - len(shapes)
    assert shapes.add(some(left + 1), np.empty((0, 2), np.int64)) == 0  # with motions nothing is forgotten
    assert shapes.add(some(left), np.empty((0, 2), np.int64)) == left


def test_parts_are_numbered_by_size_and_near_shapes_are_found_among_those_with_motions() -> None:
    shapes, q = Shapes(ROBOT, 1.0), some(8)
    shapes.add(q, np.array([[0, 1], [3, 4], [4, 5], [5, 3]]))
    assert shapes.everything.parts.tolist()[:6] == [1, 1, shapes.everything.parts[2], 0, 0, 0]
    graph = shapes.graph
    np.testing.assert_array_equal(graph.q, q[[0, 1, 3, 4, 5]])
    assert graph.edges.tolist() == [[0, 1], [2, 3], [2, 4], [3, 4]]
    assert graph.near_shapes(q[[4, 1]], 1)[:, 0].tolist() == [3, 1]
    begins, neighbours, motions = graph.neighbours
    assert [neighbours[a:b].tolist() for a, b in pairwise(begins)] == [
        [1],
        [0],
        [3, 4],
        [2, 4],
        [2, 3],
    ]
    for node in range(5):
        for at in range(begins[node], begins[node + 1]):
            assert sorted([node, neighbours[at]]) == graph.edges[motions[at]].tolist()
    assert shapes.graph is graph
    shapes.add(some(1, 9))
    assert shapes.graph is graph  # a shape without motions changes nothing
    shapes.add(q[:0], np.array([[0, 8]]))
    assert len(shapes.graph) == 6


@pytest.mark.parametrize("far", [0.5, 2.0])
def test_only_what_differs_is_new(far: float) -> None:
    shapes, q = Shapes(ROBOT, 1.0), some(5)
    assert shapes.is_new(q).all()
    shapes.add(q)
    other = q.copy()
    other[:, 1, 0] += far * SPACING
    assert shapes.is_new(other).all() == (far > 1.0)
