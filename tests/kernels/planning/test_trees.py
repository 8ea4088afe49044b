"""Trees of configurations: what is cut off hangs on one edge of a path, and what is left is clear."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.kernels.planning.trees import GONE, Trees, cut_off, path_through
from sinuous.motion.planning.query import Deadline
from sinuous.motion.planning.rrt_connect import RRTConnect
from tests.kernels.certificate.motions import shape

SEGMENTS, NODES = 2, 40


def random_trees(seed: int) -> Trees:
    """Two trees of random nodes, each hanging on one before it; of the goals' tree the first three are roots."""
    rng = np.random.default_rng(seed)
    parents = np.full((2, NODES), -1)
    for side, roots in ((0, 1), (1, 3)):
        parents[side, roots:] = [rng.integers(i) for i in range(roots, NODES)]
    q = rng.random((2, NODES, SEGMENTS, 3))
    return Trees(q, parents, np.array([NODES, NODES]), np.zeros((SEGMENTS, 3)))


def below(parents: list[int], node: int) -> set[int]:
    """All nodes that a node is among the ancestors of, and itself."""
    found = {node}
    for i, parent in enumerate(parents):
        if parent in found:
            found.add(i)
    return found


@pytest.mark.parametrize("seed", range(6))
def test_what_hangs_on_an_edge_is_cut_off_and_nothing_else(seed: int) -> None:
    first, second = NODES - 1, NODES - 2
    path = np.zeros((2 * NODES, SEGMENTS, 3))
    whole = random_trees(seed)
    count = path_through(whole, first, second, path)
    nodes = [[tuple(q.ravel()) for q in side] for side in whole.q]
    before = sum(tuple(q.ravel()) in nodes[0] for q in path[:count]) - 1
    for edge in range(count - 1):
        trees = random_trees(seed)
        cut_off(trees, first, second, edge)
        side = 0 if edge < before else 1
        child = second  # it is where the first tree's node is, and stands for it
        if edge != before:
            child = nodes[side].index(tuple(path[edge + 1 if side == 0 else edge].ravel()))
        gone = below(whole.parents[side].tolist(), child)
        assert set(np.flatnonzero(trees.parents[side] == GONE).tolist()) == gone
        assert np.isinf(trees.q[side, sorted(gone)]).all()
        kept = sorted(set(range(NODES)) - gone)
        np.testing.assert_array_equal(trees.q[side, kept], whole.q[side, kept])
        np.testing.assert_array_equal(trees.q[1 - side], whole.q[1 - side])


def test_a_tree_that_is_behind_keeps_limits_that_segments_share() -> None:
    line = sn.Actuators([[0.05, 0.0, 0.0] * 4, [0.0, 0.05, 0.0] * 4], limits=[(-0.08, 0.08)] * 2)
    robot = sn.Robot([sn.Segment(1.0, 2.8, radius=0.05)] * 4, actuators=line)
    rng = np.random.default_rng(5)
    goals = [q for q in (shape(robot, rng) for _ in range(2000)) if robot.excess(q) <= 0.0]
    goals = [q for q in goals if np.hypot(*robot.tip(q)[:2, 3]) > 1.0][:150]
    scene = sn.Scene([sn.Sphere(robot.tip(q)[:3, 3], 0.02) for q in goals])  # so none of them is reached
    trees = RRTConnect(robot, scene.snapshot())
    assert trees.grow(np.stack([np.tile([0.0, 0.0, 1.0], (4, 1)), *goals]), 0, (0, 200), Deadline(1e4)) is None
    assert len(goals) == 150
    assert len(trees.reached) > 2
    assert max(robot.excess(q) for q in trees.reached) < 1e-12
