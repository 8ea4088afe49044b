"""Shortcuts: what an edge takes the place of, and what of the path stays as it was proved."""

import numpy as np
import pytest

from sinuous.kernels.planning.shortcuts import Path, _replace_edges


@pytest.mark.parametrize(("a", "b"), [(0, 1), (2, 3), (0, 2), (1, 4)])
def test_an_edge_takes_the_place_of_what_lies_between_two_others(a: int, b: int) -> None:
    """Configurations and answers are numbered; room is made, or given up."""
    count, path = 6, Path(np.zeros((9, 1, 3)), np.zeros((9, 14)))
    path.q[:count], path.answers[:count] = np.arange(6.0)[:, None, None], np.arange(6.0)[:, None]
    left = _replace_edges(path, count, a, b, np.array([[[10.0] * 3], [[11.0] * 3]]), np.full((1, 14), 12.0))
    assert path.q[:left, 0, 0].tolist() == [*range(a + 1), 10.0, 11.0, *range(b + 1, count)]
    assert path.answers[: left - 1, 0].tolist() == [*range(a + 1), 12.0, *range(b, count - 1)]
