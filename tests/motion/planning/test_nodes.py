"""Nodes of a tree: what is nearest, and how one leads back to an end."""

import numpy as np

from sinuous.motion.configurations import distances
from sinuous.motion.planning.nodes import FIRST, Nodes
from tests.motion.planning.places import INSIDE, ROBOT


def test_the_nearest_is_that_of_all_distances() -> None:
    rng = np.random.default_rng(0)
    q = INSIDE + 0.5 * rng.normal(size=(3 * FIRST, 5, 3))
    nodes = Nodes(ROBOT)
    for i, each in enumerate(q):
        assert nodes.add(each, i - 1) == i
    assert len(nodes) == len(q)
    np.testing.assert_array_equal(np.stack([nodes[i] for i in range(len(q))]), q)
    for _ in range(20):
        asked = INSIDE + 0.5 * rng.normal(size=(5, 3))
        apart = [float(distances(ROBOT, np.stack([asked, each]))[0]) for each in q]
        assert nodes.nearest(asked) == np.argmin(apart)
        np.testing.assert_allclose(nodes.apart(asked, q[0]), apart[0])


def test_ways_begin_where_chains_do() -> None:
    q = [INSIDE + i for i in range(5)]
    nodes = Nodes(ROBOT)
    nodes.plant(q[:2])
    nodes.plant(q[2:4])
    last = nodes.add(q[4], 3)
    np.testing.assert_array_equal(nodes.way(last), q[2:])
    np.testing.assert_array_equal(nodes.way(1), q[:2])
    nodes.way(0)[0][:] = 0.0
    np.testing.assert_array_equal(nodes[0], q[0])
