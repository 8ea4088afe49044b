"""Where the content of a file lies."""

import numpy as np
import pytest

from sinuous.scene.reading import Placement
from tests.helpers import NOT_NUMBERS, NOT_VECTORS, random_rotation, refused_each


@pytest.mark.parametrize("seed", range(3))
def test_it_turns_scales_and_moves(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, move, points = random_rotation(rng), rng.normal(size=3), rng.normal(size=(10, 3))
    expected = np.stack([turn @ (0.3 * p) + move for p in points])
    np.testing.assert_allclose(Placement(0.3, move, turn).apply(points), expected, atol=1e-14)
    np.testing.assert_array_equal(Placement(1).apply(points), points)


def test_bad_input_is_refused() -> None:
    refused_each("scale", [*NOT_NUMBERS, 0.0, -1.0], Placement)
    refused_each("position", [v for v in NOT_VECTORS if v is not None], lambda value: Placement(1, value))
    refused_each("rotation", ((1, 2, 3), np.ones((3, 3))), lambda value: Placement(1, rotation=value))
