"""How far a body is off a curve, held against the other kinematics."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.body import body_places, segment_ends
from sinuous.measures.following import PLACES, deviation
from sinuous.measures.following import body_places as places_of

ARM = sn.Robot.uniform(3, (0.5, 1.5), base=sn.pose((1, 2, 3), direction=(1, 1, 0)))


def test_places_are_those_of_matrix_exponentials() -> None:
    rng = np.random.default_rng(0)
    q = np.concatenate([rng.uniform(-2, 2, (4, 3, 2)), rng.uniform(0.5, 1.5, (4, 3, 1))], axis=-1)
    q[0, 1, :2] = 0.0, 1e-9
    found = places_of(ARM, q)
    for i, one in enumerate(q):
        every = body_places(ARM, one, segment_ends(ARM, one))[0].reshape(3, -1, 3)
        np.testing.assert_allclose(found[i], every[:, :: 200 // PLACES], atol=1e-9)


def test_a_parallel_line_is_as_far_everywhere() -> None:
    stage = sn.Robot([sn.Segment(5.0, max_bend=0.0), *sn.Robot.uniform(2, 1.0).segments])
    q = np.array([[[0, 0, 5.0], [0, 0, 1], [0, 0, 1]]])
    found = deviation(stage, q, sn.Curve([(0.1, 0, -1), (0.1, 0, 9)]))
    assert found.length == 2.0
    assert found.shape == pytest.approx(0.1)
    assert found.shares == pytest.approx(dict.fromkeys(("tip", "tip_mean", "shape", "shape_mean"), 0.05))
    assert repr(found) == "Deviation(tip 5 %, mean 5 %, shape 5 %, mean 5 %)"
