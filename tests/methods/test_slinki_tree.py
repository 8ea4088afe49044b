"""The tree of shapes: its primitives, and the biarc that says what is ahead."""

import math
from typing import Any

import numpy as np
import pytest

from sinuous.methods import slinki as lattice
from sinuous.model.robot import Robot
from tests.cases import with_each
from tests.helpers import expm_chain, random_rotation, vec
from tests.methods.fabrik.test_links import MIXED


def arc(bend: float, angle: float, length: float) -> Any:
    return np.array([[bend * math.cos(angle), bend * math.sin(angle), length]])


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


def test_a_single_arc_and_its_biarc_agree() -> None:
    for bend in (0.0, 1e-7, 0.3, 1.5, 2.8):
        tip = expm_chain(arc(bend, 0.7, 2.0))[-1]
        end, tangent = vec(tip[:3, 3]), vec(tip[:3, 2])
        found, length = lattice.single((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), end)
        assert (found, length) == pytest.approx((bend, 2.0), abs=1e-9)
        halves = lattice.biarc((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), end, tangent)
        assert halves == pytest.approx((0.5 * bend, 0.5 * bend, 1.0, 1.0), abs=1e-7)


def test_there_is_no_biarc_to_straight_behind() -> None:
    ahead = (0.0, 0.0, 1.0)
    assert lattice.biarc((0.0, 0.0, 0.0), ahead, (0.0, 0.0, -1.0), ahead)[2] == math.inf
    assert lattice.single((0.0, 0.0, 0.0), ahead, (0.0, 0.0, -1.0))[1] == math.inf


def sums_of(robot: Robot) -> Any:
    caps = np.fmin(robot.limits[:, 2], robot.limits[:, 3] * robot.limits[:, 1])
    own = np.stack([robot.limits[:, 0], robot.limits[:, 1], caps], axis=-1)
    return np.concatenate([np.cumsum(own[::-1], axis=0)[::-1], np.zeros((1, 3))])


def test_the_outlook_is_best_where_the_segments_fit() -> None:
    robot = Robot.uniform(4, (0.8, 1.2), 1.0)
    sums, ahead = sums_of(robot), (0.0, 0.0, 1.0)
    for aimed in (False, True):

        def of(k: int, distance: float, side: float = 0.0, aimed: bool = aimed) -> float:
            return float(lattice.outlook(robot.limits, sums, k, (0, 0, 0), ahead, (side, 0.0, distance), ahead, aimed))

        assert of(0, 4.0) == of(2, 2.0) == 0.0
        assert of(2, 3.0) > 0.1
        assert of(0, 2.0) > 0.1
        assert of(0, 3.9, 0.5) > 0.0
        assert of(0, -3.0) > 1e3


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
