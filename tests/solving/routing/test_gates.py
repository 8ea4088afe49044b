"""Gates in the narrow places of routes: where they lie, and that chains go through them."""

from itertools import pairwise

import numpy as np
import pytest

from sinuous import Box, Robot, Scene, Segment, Target, Tolerance, packing
from sinuous.kernels.tables import GOAL, TARGET_POSITION, TARGET_SEGMENT
from sinuous.problem.problem import Problem
from sinuous.solving.routing.gates import NARROW, STRETCHED, WIDE, Gate, Passage
from sinuous.solving.routing.growth import LEG_POINTS, SOME, divided, grown, settled
from sinuous.solving.routing.turned import Groups
from tests.helpers import Floats

RADIUS = 0.1
ROBOT = Robot([Segment((0.8, 1.2), 2.0, radius=RADIUS)] * 6)
LINE = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.8), LEG_POINTS)


def groups(robot: Robot, targets: list[Target], scene: Scene) -> Groups:
    problem = Problem(robot, targets, scene)
    settings = packing.settings_group(robot, Tolerance().for_robot(robot))
    return packing.robot_group(robot), problem.scene.group.copy(), settings, problem.rows.copy()


def straight(distances: Floats) -> Passage:
    return Passage(groups(ROBOT, [Target((0.0, 0.0, 4.8))], Scene()), LINE[None], distances[None])


def gates(passage: Passage) -> list[Gate]:
    return [passage.gate(i) for i in range(len(passage))]


def with_one_narrow_place(first: int, last: int) -> Floats:
    distances = np.full(LEG_POINTS, 10.0 * RADIUS)
    distances[first : last + 1] = 1.5 * RADIUS
    return distances


@pytest.mark.parametrize("at", [40, 80, 110])
def test_gates_lie_about_the_narrow_place_along_the_route(at: int) -> None:
    passage = straight(with_one_narrow_place(at, at))
    found = gates(passage)
    assert passage.room == pytest.approx(1.5)
    assert len(found) > 3
    places = np.array([gate.row[TARGET_POSITION : TARGET_POSITION + 3] for gate in found])
    assert np.allclose(places[0], LINE[at])
    assert np.abs(places[:, 2] - LINE[at, 2]).max() <= 0.6 + 0.04
    assert np.allclose([gate.row[GOAL : GOAL + 3] for gate in found], (0.0, 0.0, 1.0))


def test_a_chain_is_long_enough_on_either_side_of_each_gate() -> None:
    for gate in gates(straight(with_one_narrow_place(60, 62))):
        before, place = 1 + int(gate.row[TARGET_SEGMENT]), gate.row[TARGET_POSITION + 2]
        assert 1 <= before < len(ROBOT)
        assert before * 1.2 >= STRETCHED * place - 1e-9
        assert (len(ROBOT) - before) * 1.2 >= STRETCHED * (4.8 - place) - 1e-9


def test_no_gate_comes_twice_and_legs_meet_there() -> None:
    found = gates(straight(with_one_narrow_place(80, 80)))
    kinds = {(gate.row[TARGET_SEGMENT], *gate.row[TARGET_POSITION : TARGET_POSITION + 3]) for gate in found}
    assert len(kinds) == len(found)
    for gate in found:
        assert gate.legs.shape == (2, LEG_POINTS, 3)
        assert np.allclose(gate.legs[0, 0], LINE[0])
        assert np.allclose(gate.legs[0, -1], gate.legs[1, 0])
        assert np.allclose(gate.legs[0, -1], gate.row[TARGET_POSITION : TARGET_POSITION + 3])
        assert np.allclose(gate.legs[1, -1], LINE[-1])


def test_into_a_long_narrow_place_the_gate_is_where_it_begins() -> None:
    first, last = 50, 120  # more than two metres
    places = [gate.row[TARGET_POSITION + 2] for gate in gates(straight(with_one_narrow_place(first, last)))]
    assert places[0] == pytest.approx(LINE[first, 2] + 0.25 * 1.2, abs=0.03)
    assert min(places) >= LINE[first, 2] - 1e-9


def test_what_is_wide_or_narrow_up_to_an_end_has_no_gate() -> None:
    assert len(straight(np.full(LEG_POINTS, 1.01 * WIDE * RADIUS))) == 0
    assert len(straight(with_one_narrow_place(0, 80))) == 0
    assert len(straight(with_one_narrow_place(80, LEG_POINTS - 1))) == 0
    assert len(straight(np.full(LEG_POINTS, 1.5 * RADIUS))) == 0
    assert NARROW > 1.0


def test_with_an_elbow_the_gate_is_on_the_leg_that_is_narrow_and_of_its_segments() -> None:
    targets = [Target((0.0, 0.0, 2.4), segment=3), Target((0.0, 0.0, 4.8))]
    legs = np.stack([np.linspace(one, other, LEG_POINTS) for one, other in pairwise(LINE[[0, 80, -1]])])
    wide, narrow = np.full(LEG_POINTS, 1.0), with_one_narrow_place(80, 80)
    asked = groups(ROBOT, targets, Scene())
    for which, distances in enumerate(([narrow, wide], [wide, narrow])):
        found = gates(Passage(asked, legs, np.stack(distances)))
        assert found
        for gate in found:
            assert gate.legs.shape == (3, LEG_POINTS, 3)
            assert 3 * which <= gate.row[TARGET_SEGMENT] < 3 * which + 2
            assert gate.asked(asked)[3].shape[0] == 3


def test_a_chain_grown_through_a_gate_goes_through_the_door() -> None:
    """A wall with a hole; the target is behind it and aside, so that what leads straight there meets the wall."""
    half, wall = 1.6 * RADIUS, 2.5
    boxes = [Box((side * (0.5 * 4.0 + half), 0.0, wall), (4.0, 8.0, 0.1)) for side in (-1.0, 1.0)]
    boxes += [Box((0.0, side * (0.5 * 4.0 + half), wall), (2.0 * half, 4.0, 0.1)) for side in (-1.0, 1.0)]
    scene = Scene(boxes)
    target = Target((1.0, 0.6, 4.2))
    line = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, wall + 0.3), target.position])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    leg = np.stack([np.interp(np.linspace(0.0, along[-1], LEG_POINTS), along, axis) for axis in line.T], axis=-1)
    asked = groups(ROBOT, [target], scene)
    passage = Passage(asked, leg[None], scene.distance(leg)[None])
    assert passage.room == pytest.approx(1.6, rel=0.01)
    through = 0
    for i in range(3):
        gate = passage.gate(i)
        chains = grown(gate.asked(asked), gate.legs, SOME, 60.0)
        for q in settled(gate.asked(asked), chains, lambda: 60.0):
            body = ROBOT.backbone(q, 40)
            crossing = body[np.abs(body[:, 2] - wall).argmin()]
            through += bool(np.abs(crossing[:2]).max() < half and scene.distance(body).min() > 0.9 * RADIUS)
            assert ROBOT.excess(q) <= 1e-12
    assert through >= 2


def test_a_route_is_divided_at_the_elbows_that_it_leads_past() -> None:
    elbow = Target((0.05, 0.0, 2.0), segment=3)
    route = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, 4.8), 300)
    tip = Target((0.0, 0.0, 4.8))
    legs = divided(groups(ROBOT, [elbow, tip], Scene()), route, RADIUS)
    assert legs is not None
    assert legs.shape == (2, LEG_POINTS, 3)
    assert np.allclose(legs[:, [0, -1]], [[route[0], elbow.position], [elbow.position, route[-1]]])
    assert divided(groups(ROBOT, [elbow, tip], Scene()), route, 0.04) is None
    whole = divided(groups(ROBOT, [tip], Scene()), route, RADIUS)
    assert whole is not None
    assert np.allclose(whole, LINE)
