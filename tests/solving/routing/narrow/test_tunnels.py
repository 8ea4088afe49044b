"""Tubes in the middle of routes: where they begin and end, what is laid in them, and what that solves."""

import numpy as np
import pytest

import sinuous as sn
from benchmarks.places.parts.surfaces import open_tube, solid
from sinuous import Box, Robot, Scene, Segment, Target
from sinuous.checks import Floats
from sinuous.kernels.tables import GOAL, TARGET_POSITION, TARGET_SEGMENT
from sinuous.problem.problem import Problem
from sinuous.solving.polylines import lengths_along, respaced
from sinuous.solving.routing.crossing import Crossing
from sinuous.solving.routing.growth import FEW, LEG_POINTS, ONE
from sinuous.solving.routing.narrow.narrows import Narrows
from sinuous.solving.routing.narrow.tunnels import PLACES, Tunnel, tunnel_on
from sinuous.solving.routing.turned import Groups
from tests.helpers import kernel_groups
from tests.kernels.tubes.test_axis import curve

RADIUS = 0.1
ROBOT = Robot([Segment((0.5, 0.7), 1.8, radius=RADIUS)] * 12)
POSES = curve(1, 12)
BEFORE, AFTER = 1.6, 1.4
"""How far the base is from one mouth, and the target from the other."""


def place() -> tuple[Robot, Scene, Target, Floats]:
    """A bent pipe through a wall; the base straight before it, the target straight beyond."""
    points, tangents = POSES[:, :3, 3], POSES[:, :3, 2]
    base = POSES[0].copy()
    base[:3, 3] -= BEFORE * tangents[0]
    scene = Scene([solid(open_tube(POSES, 1.4 * RADIUS, 2.2 * RADIUS), "pipe")])
    goal = points[-1] + AFTER * tangents[-1]
    route = np.vstack([base[:3, 3], points, goal])
    return Robot(ROBOT.segments, base=base), scene, Target(goal), route


def groups_of(robot: Robot, scene: Scene, *targets: Target) -> Groups:
    return kernel_groups(Problem(robot, list(targets), scene))


def tunnel_of(groups: Groups, legs: Floats, scene: Scene) -> Tunnel | None:
    distances = scene.distance(legs.reshape(-1, 3)).reshape(legs.shape[:2])
    return tunnel_on(groups, legs, distances, scene.distance, 60.0)


def tunnel() -> tuple[Tunnel, Groups, Floats, Scene, Robot]:
    robot, scene, target, route = place()
    groups, legs = groups_of(robot, scene, target), respaced(route, LEG_POINTS)[None]
    found = tunnel_of(groups, legs, scene)
    assert found is not None
    return found, groups, legs, scene, robot


def test_ways_lead_into_the_tube_along_its_axis_and_out_of_it() -> None:
    found, _, legs, scene, robot = tunnel()
    within = lengths_along(POSES[:, :3, 3])[-1]
    assert 1 <= len(found.places) <= len(PLACES)
    for number, spot in enumerate(found.places):
        for count in spot.counts:
            way = found.way(number, count)
            (row,), laid = way.rows, way.laid
            assert laid is not None
            gate, ahead = row[TARGET_POSITION : TARGET_POSITION + 3], row[GOAL : GOAL + 3]
            assert row[TARGET_SEGMENT] == count - 1
            assert np.linalg.norm(ahead) == pytest.approx(1.0)
            assert np.allclose(laid.line[0], gate)
            assert ahead @ (laid.line[1] - gate) > 0.0
            least, most = (laid.segments * robot.segments[0].length[end] for end in (0, 1))
            assert least - 0.2 <= lengths_along(laid.line)[-1] <= min(most, within) + 0.2
            assert scene.distance(laid.line).min() >= 0.8 * RADIUS
            assert [len(part) for part in way.legs] == [1, 1]
            assert np.allclose(way.legs[0][0, 0], legs[0, 0])
            assert np.allclose(way.legs[0][0, -1], gate)
            assert np.allclose(way.legs[1][0, [0, -1]], [laid.line[-1], legs[0, -1]])
            assert 0 < count < count + laid.segments < len(robot)


def test_chains_lie_free_in_the_tube() -> None:
    found, groups, legs, scene, robot = tunnel()
    crossing, best = Crossing(groups, found), -np.inf
    for number in range(len(crossing)):
        for q in crossing.chains(number, FEW, lambda: 60.0):
            assert robot.excess(q) <= 1e-9
            best = max(best, float(scene.distance(robot.backbone(q, 20)).min()))
    assert best > 0.8 * RADIUS
    narrows = Narrows(groups, scene.distance, scene.distance, lambda: 60.0)
    assert narrows.room(1, legs) == pytest.approx(1.4, abs=0.3)
    assert narrows.crossing(1, legs) is narrows.crossing(1, legs)
    assert len(narrows.crossing(1, legs)) == len(found.places)


def test_from_room_to_room_through_a_bent_pipe_is_solved() -> None:
    robot, scene, target, _ = place()
    mouths = []
    for pose, side in ((POSES[0], 1.0), (POSES[-1], -1.0)):
        rotation, half = pose[:3, :3], 1.4 * RADIUS
        for x, y in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            middle = pose[:3, 3] + rotation @ ((half + 0.5) * np.array([x, y, 0.0])) - side * 0.05 * rotation[:, 2]
            size = (1.0 if x else 2.0 * half, 1.0 if y else 2.0 * (half + 1.0), 0.1)
            mouths.append(Box(middle, size, rotation))
    scene = Scene([*scene.obstacles, *mouths])
    assert target.position is not None
    aside = Target(target.position + 0.4 * POSES[-1, :3, 0])
    solution = sn.solve(robot, aside, scene, time=20.0)
    assert solution.solved
    assert sn.check(robot, solution.q, scene, aside).ok


def test_elbows_have_to_be_of_segments_that_are_there() -> None:
    robot, scene, target, route = place()
    first = respaced(route[: 1 + 6], LEG_POINTS)
    legs = np.stack([first, respaced(np.vstack([first[-1], route[7:]]), LEG_POINTS)])
    for segment in range(1, len(robot) - 1):
        groups = groups_of(robot, scene, Target(first[-1], segment=segment), target)
        found = tunnel_of(groups, legs, scene)
        for number, spot in enumerate(found.places if found is not None else ()):
            for count in spot.counts:
                laid = found.way(number, count).laid if found is not None else None
                assert laid is not None
                assert count <= segment - 1 < count + laid.segments
                chains = Crossing(groups, found).chains(number, ONE, lambda: 60.0) if found is not None else ()
                assert all(robot.excess(q) <= 1e-9 for q in chains)


def test_there_is_none_in_the_open_beside_a_wall_and_in_a_door() -> None:
    robot, scene, target, route = place()
    legs = respaced(route, LEG_POINTS)[None]
    for obstacles in ([], [Box((0.0, 0.0, 50.0), (1.0, 1.0, 1.0))]):
        open_scene = Scene(obstacles)
        assert tunnel_of(groups_of(robot, open_scene, target), legs, open_scene) is None
    thin = Robot([Segment((0.5, 0.7), 1.8)] * 12, base=robot.base)
    assert tunnel_of(groups_of(thin, scene, target), legs, scene) is None
