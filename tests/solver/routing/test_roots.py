"""Roots: where the part that bends may begin, with joints or on a long stage, and what is solved from there alone."""

from itertools import islice

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.clearances import prepared
from benchmarks.places import make
from benchmarks.places.cells import channel
from benchmarks.places.solids import box_between
from sinuous.base.checks import Floats
from sinuous.kernels.tables import POSE_POSITION
from sinuous.measures.obstacles import measure
from sinuous.solver.routing.partial_chains import end_pose, leading_rows, segments_in
from sinuous.solver.routing.roots import Roots
from sinuous.solver.routing.searches import Searches

SEGMENTS = [sn.Segment(0.3, 2.0, radius=0.02)] * 3
RAIL = [sn.Prismatic((1, 0, 0), (0.0, 2.0), body=[((0, 0, -0.05), (0, 0, 0), 0.04)])]
CARRIED = sn.Robot(SEGMENTS, joints=[*RAIL, sn.Revolute(origin=(0, 0, 0.05))])
STAGED = sn.Robot([sn.Segment((0.0, 2.0), 0.0, radius=0.02), *SEGMENTS], base=sn.pose(direction=(1, 0, 0)))

MOUTH = sn.pose((1.6, 0.1, 0.5), direction=(0.5, 0.2, 1.0))
"""Of a channel beside the rail and the stage, which leads upwards."""


def walls(half: float) -> list[sn.Box]:
    """The walls of a channel of this half width, and of its bottom."""
    return [*channel(MOUTH, half, 0.3, 0.1), box_between(MOUTH, np.array([-1, -1, 0.31]), np.array([1, 1, 0.4]), "end")]


TARGET = sn.Target(MOUTH[:3, 3] + 0.28 * MOUTH[:3, 2])


def rows(robot: sn.Robot) -> Floats:
    return segments_in(Searches(robot, sn.Scene([sn.Sphere((9, 9, 9), 0.1)]), sn.Tolerance().for_robot(robot))._group)


def test_where_the_robot_begins_is_a_choice_with_joints_or_on_a_long_stage() -> None:
    assert leading_rows(rows(CARRIED)) == len(CARRIED) - 3
    assert leading_rows(rows(STAGED)) == 1
    assert leading_rows(rows(sn.Robot([sn.Segment((0.0, 0.4), 0.0), *SEGMENTS]))) == 0
    assert leading_rows(rows(sn.Robot([sn.Segment(2.0, 0.0), *SEGMENTS]))) == 0
    assert leading_rows(rows(sn.Robot(joints=RAIL))) == 0


@pytest.mark.parametrize("robot", [CARRIED, STAGED], ids=["joints", "stage"])
def test_roots_are_within_limits_clear_and_apart(robot: sn.Robot) -> None:
    scene = sn.Scene([*walls(0.03), sn.Sphere((0.5, 0, 0.3), 0.15)])
    problem = sn.Problem(robot, TARGET, scene)
    roots = Roots(Searches(robot, scene, problem.tolerance), problem, lambda: 60.0)
    found = [root.chain for root in islice(roots.roots(None), 8)]
    assert len(found) == 8
    ends = np.array([end_pose(roots._groups, chain) for chain in found])
    assert len(np.unique(ends.round(3), axis=0)) == 8
    assert np.linalg.norm(ends[:2, POSE_POSITION:] - MOUTH[:3, 3], axis=1).min() < 0.7
    for chain in found:
        q = np.concatenate([chain, [[0, 0, 0.3]] * 3])
        assert robot.excess(q) < 1e-9
        head = robot.changed(segments=robot.segments[: len(robot.segments) - 3]) if robot.joints else robot
        if not robot.joints:
            points = robot.base[:3, 3] + np.linspace(0, chain[0, 2], 50)[:, None] * robot.base[:3, 2]
            assert min(measure(obstacle, points).min() for obstacle in scene.obstacles) > 0.02 - 1e-9
        else:
            assert sn.check(head, chain, scene).clearance > 0.0


@pytest.mark.parametrize(("family", "seed"), [("rail", 23), ("stage", 0)])
def test_tubes_are_entered_from_where_joints_or_the_stage_face_them(family: str, seed: int) -> None:
    """Nothing else gets in within two hundred starts."""
    place = make(family, seed)
    prepared.cache_clear()
    off = ("passages",) if place.robot.joints else ("passages", "scattered")
    solver = sn.Solver(place.robot, place.scene, tolerance=place.tolerance, without=("roots", *off), max_starts=200)
    assert not solver.solve(place.targets, time=10.0).solved
    found = sn.solve(place.robot, list(place.targets), place.scene, tolerance=place.tolerance, time=20.0)
    assert found.start == "route"
    assert found.verify().ok


def test_no_root_proves_that_there_is_no_route() -> None:
    """The channel is closed to the body: nothing is found, and with joints nothing is claimed."""
    found = sn.solve(CARRIED, TARGET, walls(0.019), max_starts=200, time=20.0)
    assert not found.solved
    assert found.status is not sn.Status.NO_ROUTE
