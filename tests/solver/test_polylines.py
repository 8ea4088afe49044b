"""Lines through points, against a finely cut line, and laws."""

from itertools import pairwise

import numpy as np

from sinuous.solver.polylines import lengths_along, points_at, respaced

LINE = np.random.default_rng(0).normal(size=(9, 3))


def test_lengths_add_up() -> None:
    along = lengths_along(LINE)
    assert along[0] == 0.0
    np.testing.assert_allclose(np.diff(along), [np.linalg.norm(b - a) for a, b in pairwise(LINE)])
    np.testing.assert_allclose(lengths_along(LINE[::-1]), along[-1] - along[::-1], atol=1e-12)


def test_points_at_lengths_lie_on_the_line() -> None:
    along = lengths_along(LINE)
    np.testing.assert_allclose(points_at(LINE, along, along), LINE)
    middles = 0.5 * (along[1:] + along[:-1])
    np.testing.assert_allclose(points_at(LINE, along, middles), 0.5 * (LINE[1:] + LINE[:-1]))


def test_respaced_points_are_evenly_spaced_along_the_line() -> None:
    fine = respaced(LINE, 20001)
    np.testing.assert_allclose(fine[[0, -1]], LINE[[0, -1]])
    assert lengths_along(fine)[-1] <= lengths_along(LINE)[-1] * (1.0 + 1e-12)
    np.testing.assert_allclose(lengths_along(fine)[-1], lengths_along(LINE)[-1], rtol=1e-4)
    np.testing.assert_allclose(respaced(LINE, 33), fine[:: 20000 // 32], atol=1e-12)
    straight = np.array([[0.0, 0, 0], [0, 0, 0.1], [0, 0, 3]])
    np.testing.assert_allclose(respaced(straight, 4)[:, 2], [0, 1, 2, 3], atol=1e-12)
