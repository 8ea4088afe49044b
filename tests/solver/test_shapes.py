"""The shapes of a memory and the motions between them: numbers stay right when some are forgotten."""

import numpy as np

import sinuous as sn
from sinuous.base.checks import Floats
from sinuous.solver.shapes import Shapes

SHORT = sn.Robot.uniform(2, (0.8, 1.2), max_bend=2.0)


def some(count: int, seed: int = 0) -> Floats:
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.uniform(-1.0, 1.0, (count, 2, 2)), rng.uniform(0.8, 1.2, (count, 2, 1))], axis=2)


def ends(shapes: Shapes) -> set[tuple[bytes, bytes]]:
    """Return the motions by the shapes at their ends."""
    return {(shapes.q[i].tobytes(), shapes.q[j].tobytes()) for i, j in shapes.edges.tolist()}


def test_what_motions_join_is_not_forgotten() -> None:
    shapes = Shapes(SHORT, 0.05)
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
