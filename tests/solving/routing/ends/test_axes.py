"""The tube that a goal lies in: its axis leads from there to where it opens."""

import numpy as np
import pytest

from benchmarks.places.parts.surfaces import blind_bore, open_tube, solid
from sinuous import Scene, pose
from sinuous.kernels.tables import (
    QUERY_BACK,
    QUERY_GOAL,
    QUERY_LONGEST,
    QUERY_ORIGIN,
    QUERY_RADIUS,
    QUERY_WIDTH,
)
from sinuous.solving.polylines import lengths_along
from sinuous.solving.routing.ends.axes import NEAR, axes_from_goal, joined
from tests.helpers import Floats

RADIUS, TURN = 0.1, 2.0
"""Of the body; and of the axis of a bent pipe."""

LENGTH = 0.5 * np.pi * TURN
FRAMES = np.array(
    [
        pose((TURN * (1.0 - np.cos(a)), 0.0, TURN * np.sin(a)), direction=(np.sin(a), 0.0, np.cos(a)))
        for a in np.linspace(0.0, 0.5 * np.pi, 31)
    ]
)
PIPE = Scene([solid(open_tube(FRAMES, 1.5 * RADIUS, 2.3 * RADIUS), "pipe")])
GOAL = FRAMES[12]
FAR = np.array([-9.0, 0.0, 0.0])


def found(scene: Scene, goal: Floats, back: Floats | None = None, origin: Floats = FAR) -> list[Floats]:
    query = np.zeros(QUERY_WIDTH)
    query[QUERY_RADIUS], query[QUERY_LONGEST] = RADIUS, 10.0
    query[QUERY_GOAL : QUERY_GOAL + 3], query[QUERY_ORIGIN : QUERY_ORIGIN + 3] = goal, origin
    if back is not None:
        query[QUERY_BACK : QUERY_BACK + 3] = back
    return axes_from_goal(scene.snapshot()._kernel_group, query, scene.distance, 60.0)


def test_where_no_direction_is_asked_there_is_an_axis_to_each_mouth() -> None:
    axes = found(PIPE, GOAL[:3, 3])
    lengths = sorted(lengths_along(axis)[-1] for axis in axes)
    assert lengths == pytest.approx([0.4 * LENGTH, 0.6 * LENGTH], abs=3.0 * RADIUS)
    for axis in axes:
        assert np.allclose(axis[0], GOAL[:3, 3])
        assert np.linalg.norm(FRAMES[[0, -1], :3, 3] - axis[-1], axis=1).min() < 3.0 * RADIUS


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_direction_leaves_one(way: float) -> None:
    (axis,) = found(PIPE, GOAL[:3, 3], back=way * GOAL[:3, 2])
    assert (axis[2] - axis[0]) @ GOAL[:3, 2] * way > 0.0


def test_it_ends_where_it_leads_past_the_beginning_of_the_route() -> None:
    (axis,) = found(PIPE, GOAL[:3, 3], back=-GOAL[:3, 2], origin=FRAMES[3, :3, 3])
    assert np.linalg.norm(axis[-1] - FRAMES[3, :3, 3]) < 2.0 * RADIUS


def test_there_is_none_in_the_open_or_towards_a_bottom() -> None:
    assert found(Scene(), np.zeros(3)) == []
    assert found(PIPE, GOAL[:3, 3] + [0.0, 5.0, 0.0]) == []
    bore = Scene([solid(blind_bore(np.eye(4), 1.5 * RADIUS, 2.0, 0.6, RADIUS), "block")])
    into = np.array([0.0, 0.0, 1.0])
    assert found(bore, into, back=into) == []
    (out,) = found(bore, into, back=-into)
    assert lengths_along(out)[-1] == pytest.approx(1.0, abs=3.0 * RADIUS)


def test_axes_that_meet_are_one_line_from_end_to_end() -> None:
    first = np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 11)
    other = np.linspace([1.0, 0.0, 1.05], [-1.0, 0.0, 1.05], 21)
    line = joined(first, other, NEAR * RADIUS)
    assert line is not None
    assert np.allclose(line[[0, -1]], [first[0], other[0]])
    assert lengths_along(line)[-1] == pytest.approx(2.0, abs=0.3)
    assert joined(first, other + np.array([0.0, 1.0, 0.0]), NEAR * RADIUS) is None
