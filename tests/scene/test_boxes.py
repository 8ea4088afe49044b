"""The boxes around obstacles hold all of them, and are no larger."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.scene.obstacles import boxes_of
from tests.scene.shapes import EACH_KIND

SOLIDS = ("sphere", "box", "capsule", "cylinder", "mesh", "plates", "cloud", "cells")


@pytest.mark.parametrize("name", SOLIDS)
def test_boxes_fit(name: str) -> None:
    obstacle = EACH_KIND[name]()
    box = obstacle._box
    assert box is not None
    low, high = box
    scene, rng = sn.Scene([obstacle]), np.random.default_rng(1)
    around = rng.uniform(low - 1.0, high + 1.0, (40_000, 3))
    within = scene.distance(around) <= 0.0
    assert within.any()
    assert ((around[within] >= low) & (around[within] <= high)).all()
    for axis in range(3):  # the obstacle comes near each side
        for side in (low, high):
            face = rng.uniform(low, high, (40_000, 3))
            face[:, axis] = side[axis]
            assert scene.distance(face).min() < 0.06 * float(np.linalg.norm(high - low))


def test_what_has_no_end_or_nothing_in_it_has_no_box() -> None:
    assert sn.HalfSpace((0, 0, 0), (0, 0, 1))._box is None
    assert sn.Grid(np.zeros((2, 2, 2), bool), (0, 0, 0), 1.0)._box is None


def test_boxes_of_many_are_those_of_each() -> None:
    many = [make() for make in EACH_KIND.values()] * 25
    found = boxes_of(many)
    assert list(found) == [i for i, own in enumerate(many) if own._box is not None]
    for i, box in found.items():
        np.testing.assert_allclose(box, np.asarray(many[i]._box), atol=1e-12)
