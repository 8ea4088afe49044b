"""The tree of shapes: its primitives, and the biarc that says what is ahead."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.methods import slinki as lattice
from tests.cases import with_each
from tests.helpers import random_rotation, vec
from tests.methods.fabrik.test_links import MIXED


@with_each("seed", range(20))
def test_a_biarc_gets_there(seed: int) -> None:
    """Two arcs of these bends and lengths, meeting smoothly, lead to the end with its tangent."""
    rng = np.random.default_rng(seed)
    begin, end = rng.normal(size=(2, 3))
    first, last = random_rotation(rng)[:, 2], random_rotation(rng)[:, 2]
    bend_1, bend_2, length_1, length_2 = lattice.biarc(vec(begin), vec(first), vec(end), vec(last))
    links = [length * (math.tan(0.5 * bend) / bend) for bend, length in ((bend_1, length_1), (bend_2, length_2))]
    assert links[0] == pytest.approx(links[1])
    joints = begin + links[0] * first, end - links[1] * last
    middle = (joints[1] - joints[0]) / np.linalg.norm(joints[1] - joints[0])
    assert np.linalg.norm(joints[1] - joints[0]) == pytest.approx(links[0] + links[1])
    assert math.acos(first @ middle) == pytest.approx(bend_1, abs=1e-9)
    assert math.acos(middle @ last) == pytest.approx(bend_2, abs=1e-9)


@pytest.mark.parametrize("rings", [1, 2, 3])
def test_primitives_keep_the_limits_and_none_is_double(rings: int) -> None:
    for k in range(len(MIXED)):
        found: list[Any] = []
        while True:
            q, there = lattice.primitive(MIXED.limits, k, len(found), rings, 8, 3)
            if not there:
                break
            found.append(q)
        sizes = 3 if MIXED.limits[k, 0] < MIXED.limits[k, 1] else 1
        assert len(found) == sizes * (1 + (8 * rings if MIXED.limits[k, 2] > 0.0 else 0))
        assert len(np.unique(np.round(found, 9), axis=0)) == len(found)
        whole = np.array([[0.0, 0.0, 0.5 * sum(segment.length)] for segment in MIXED.segments])
        for q in found:
            whole[k] = q
            assert MIXED.excess(whole) <= 1e-12
            assert math.hypot(q[0], q[1]) <= lattice.WIDEST + 1e-12
