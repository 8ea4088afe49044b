"""Nodes of a tree: what is nearest, and how one leads back to an end."""

import numpy as np

from sinuous.motion.configurations import distances
from sinuous.motion.planning.tree import FIRST_NODES, Tree
from tests.motion.planning.places import INSIDE, ROBOT


def test_the_nearest_is_that_of_all_distances() -> None:
    rng = np.random.default_rng(0)
    q = INSIDE + 0.5 * rng.normal(size=(3 * FIRST_NODES, 5, 3))
    tree = Tree(ROBOT)
    for i, each in enumerate(q):
        assert tree.add(each, i - 1) == i
    assert len(tree) == len(q)
    np.testing.assert_array_equal(np.stack([tree.q[i] for i in range(len(q))]), q)
    for _ in range(20):
        asked = INSIDE + 0.5 * rng.normal(size=(5, 3))
        apart = [float(distances(ROBOT, np.stack([asked, each]))[0]) for each in q]
        assert tree.nearest(asked) == np.argmin(apart)
        np.testing.assert_allclose(tree.distances(asked), apart)
        np.testing.assert_allclose(tree.apart(asked, q[0]), apart[0])


def test_ways_begin_where_chains_do() -> None:
    q = [INSIDE + i for i in range(5)]
    tree = Tree(ROBOT)
    tree.plant(q[:2])
    tree.plant(q[2:4])
    last = tree.add(q[4], 3)
    np.testing.assert_array_equal(tree.chain(last), q[2:])
    np.testing.assert_array_equal(tree.chain(1), q[:2])
    tree.chain(0)[0][:] = 0.0
    np.testing.assert_array_equal(tree.q[0], q[0])
