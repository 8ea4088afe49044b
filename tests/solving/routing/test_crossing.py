"""Chains through doors and channels, part after part: that they are where they have to be, and clear."""

from typing import Any

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target
from sinuous.checks import Floats
from sinuous.kernels.tables import BOUND, CODE, FAILED, MERIT, RECORD_WIDTH
from sinuous.problem.problem import Problem
from sinuous.solving.polylines import respaced
from sinuous.solving.routing.crossing import STARTS, Crossing, Part
from sinuous.solving.routing.gates import Passage
from sinuous.solving.routing.growth import FEW, GLANCE, LEG_POINTS, ONE
from sinuous.solving.routing.turned import Groups
from tests.helpers import kernel_groups

RADIUS = 0.1
ROBOT = Robot([Segment((0.8, 1.2), 2.0, radius=RADIUS)] * 8)
WALL = 2.0


def around(half: float, begin: float, end: float) -> list[Box]:
    """A slab from one height to another, with a square hole about the z axis."""
    at, thick = 0.5 * (begin + end), end - begin
    boxes = [Box((side * (2.0 + half), 0.0, at), (4.0, 8.0, thick)) for side in (-1.0, 1.0)]
    return boxes + [Box((0.0, side * (2.0 + half), at), (2.0 * half, 4.0, thick)) for side in (-1.0, 1.0)]


def asked(length: float) -> tuple[Groups, Floats, Scene]:
    """A slab of some thickness; base and target aside of the hole, so that what leads straight there meets it."""
    scene = Scene(around(1.5 * RADIUS, WALL, WALL + length))
    target = Target((1.0, 0.8, WALL + length + 1.2))
    line = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, WALL + length + 0.3), target.position])
    return kernel_groups(Problem(ROBOT, [target], scene)), respaced(line, LEG_POINTS)[None], scene


def crossing_of(length: float) -> tuple[Crossing, Scene]:
    packed, legs, scene = asked(length)
    return Crossing(packed, Passage(packed, legs, scene.distance(legs[0])[None])), scene


@pytest.mark.parametrize("length", [0.1, 1.7, 2.6])
def test_chains_go_through_door_and_channel(length: float) -> None:
    crossing, scene = crossing_of(length)
    found = 0
    for place in range(len(crossing)):
        for beam in (GLANCE, ONE):
            for q in crossing.chains(place, beam, lambda: 60.0):
                body = ROBOT.backbone(q, 60)
                inside = (body[:, 2] > WALL) & (body[:, 2] < WALL + length)
                assert ROBOT.excess(q) <= 1e-9
                found += bool(inside.any() and scene.distance(body).min() > 0.9 * RADIUS)
                assert np.abs(body[inside, :2]).max() < 1.5 * RADIUS
    assert found >= 2


def test_parts_are_proved_clear() -> None:
    packed, legs, scene = asked(0.1)
    q = Part(packed, legs).solved(FEW, lambda: 60.0)
    assert q is not None
    assert scene.distance(ROBOT.backbone(q, 100)).min() >= RADIUS
    assert np.allclose(ROBOT.tip(q)[:3, 3], packed[3][0, 2:5], atol=1e-3)


def test_efforts_grow_and_nothing_is_tried_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    packed, legs, _ = asked(0.1)
    packed[0][-15:-12] = 0.0, 0.0, WALL + 0.05  # the base in the wall: nothing is solved
    packed[0][-15] = 1.0
    tried: list[tuple[int, int]] = []
    part = Part(packed, legs)
    follow = part._follow

    def spy(chains: Floats, own: tuple[int, int], left: Any) -> Floats | None:
        if own[1] > own[0]:
            tried.append(own)
        return follow(chains, own, left)

    monkeypatch.setattr(part, "_follow", spy)
    for beam in (ONE, ONE, FEW):
        assert part.solved(beam, lambda: 60.0) is None
    counts = list(STARTS.values())
    assert [last - first for first, last in tried] == counts[: counts.index(STARTS[FEW]) + 1]
    assert [last for _, last in tried[:-1]] == [first for first, _ in tried[1:]]


def test_what_is_impossible_is_given_up() -> None:
    packed, legs, _ = asked(0.1)
    packed[3][0, 2:5] = 0.0, 0.0, 100.0
    part = Part(packed, legs)
    assert part.solved(ONE, lambda: 60.0) is None
    assert not part.possible


def test_no_time_nothing_is_done() -> None:
    crossing, _ = crossing_of(1.7)
    assert not list(crossing.chains(0, FEW, lambda: 0.0))


def test_where_segments_before_a_gate_are_too_few_more_are_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    crossing, _ = crossing_of(1.7)
    spot = crossing._passage.places[0]
    enough = max(spot.counts)
    tried: list[int] = []

    class Few:
        def __init__(self, count: int) -> None:
            self.count, self.too_short = count, count < enough

        def solved(self, _most: object, _left: object) -> tuple[None, bool]:
            tried.append(self.count)
            return None, False

    monkeypatch.setattr(crossing, "_at", lambda _place, count: Few(count))
    assert not list(crossing.chains(0, ONE, lambda: 60.0))
    assert tried[-1] == enough


def test_a_part_keeps_what_came_nearest(monkeypatch: pytest.MonkeyPatch) -> None:
    packed, legs, _ = asked(0.1)
    part = Part(packed, legs)
    merits = iter([0.5, 0.2, 0.4])

    def search(*given: Any) -> tuple[Any, ...]:
        merit = next(merits)
        given[-1][:] = merit
        record = [0.0] * RECORD_WIDTH
        record[CODE], record[MERIT], record[BOUND] = FAILED, merit, merit > 0.3
        return tuple(record)

    monkeypatch.setattr("sinuous.solving.routing.crossing.search", search)
    for expected in (0.5, 0.2, 0.2):
        assert part._follow(np.empty((0, len(ROBOT), 3)), (0, 3), lambda: 60.0) is None
        assert part.nearest is not None
        assert (part.nearest == expected).all()
