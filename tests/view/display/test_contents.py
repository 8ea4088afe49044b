"""Things are sorted, and obstacles that move are where they are when the robot is where it is.

Distances of the body from obstacles, place by place.

Dots lie on what they stand for.

Drawn obstacles are where they are, and face the side where the body may be.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.obstacles import measure
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display.contents import gather
from sinuous.view.display.results import clearances_along
from sinuous.view.display.surfaces import MOST_POINTS, Dotted, obstacle_surface, points_of
from sinuous.view.page.model import PageModel
from sinuous.view.page.status import find_nearest, judge_shape
from sinuous.view.pictures.paint import normals_of
from tests.helpers import Floats, present, with_each
from tests.scene.shapes import EACH_KIND

pytest.importorskip("matplotlib")

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), radius=0.05)
BALL = sn.Moving(sn.Sphere((0, 0, 0), 0.2), [0, 2, 4], [(1, 1, 1), (1, -1, 1), (1, 1, 1)])
DUST = sn.Moving(sn.PointCloud(np.eye(3) * 0.1, 0.02), [0, 4], [(-1, 1, 1), (-1, -1, 1)])
KNOTS = [[[0.0, 0.0, 1.0]] * 2, [[-0.3, 0.0, 1.0]] * 2]


def test_waypoints_are_joined_by_lines_only_where_the_tip_goes_straight() -> None:
    arm = sn.on_stage(sn.Robot.uniform(3, 60, max_bend=1.8), 150)
    turn = np.linspace(0.0, 1.0, 20)[:, None]
    curve = np.concatenate([40 * (1 - np.cos(2 * turn)), 0.0 * turn, 120 * turn], axis=1)
    bent = gather([sn.follow_the_leader(arm, curve)])
    assert bent.paths == []
    assert len(bent.targets) == 2
    robot = sn.Robot.uniform(3, (0.8, 1.2), max_bend=2)
    straight = gather([sn.track(robot, [sn.Target((1, y, 2)) for y in (0.0, 0.2)])])
    assert len(straight.paths) == 1


def test_obstacles_are_where_they_are_at_a_share_of_the_motion() -> None:
    contents = gather([sn.Motion(ROBOT, KNOTS, [BALL, DUST], times=[1.0, 3.0])])
    for share, when in ((0.0, 1.0), (0.5, 2.0), (1.0, 3.0)):
        for shown, moving in zip(contents.obstacles_at(share), (BALL, DUST), strict=True):
            assert shown.equals(moving.at(when))
    (alone,) = gather([sn.Scene([BALL])]).obstacles_at(0.7)
    assert alone.equals(BALL.at(0.0))


@with_each(
    ("things", "message"),
    [
        ((), "things: expected something to draw"),
        ((ROBOT, ["x"]), r"things\[1\]\[0\]: expected a robot, scene"),
        ((np.zeros((2, 3)),), r"things\[0\]: has no robot; expected an array of configurations right after its robot"),
        ((ROBOT, np.zeros((3, 3))), r"things\[1\]: shape \(3, 3\); expected"),
        ((sn.Target(direction=(0, 0, 1)),), "a robot before a target without a position"),
        (([ROBOT] * 101,), r"len\(robots\): expected"),
    ],
)
def test_what_cannot_be_drawn_is_named(things: Any, message: str) -> None:
    with pytest.raises(sn.InputError, match=message):
        gather(things)


ROD = sn.Stiffness(youngs_modulus=54e9, poisson=0.3, radius=0.7e-3)
SEGMENT = sn.Segment(0.2, 2.0, tendons=sn.Tendons(3, radius=0.01), stiffness=ROD, mass=0.02, arcs=4)
HANGING = sn.Robot(
    [SEGMENT] * 2,
    radius=0.012,
    gravity=(0, 0, -9.81),
    base=sn.pose(direction=(1, 0, 0)),
    payload=sn.Payload(0.05),
    uncertainty=sn.Uncertainty((0.004, 0.01)),
)
Q = np.array([[0.3, 0.1, 0.2], [-0.2, 0.4, 0.2]])
NEAR_BALL = sn.Sphere((0.35, 0.0, -0.2), 0.05, name="ball")


def test_of_a_loaded_robot_the_body_is_solid_and_what_it_is_not_is_a_ghost() -> None:
    contents = gather([HANGING, Q])
    body, without, room = contents.arms
    assert [arm.ghost for arm in contents.arms] == [False, True, True]
    shape = HANGING.shape(Q)
    np.testing.assert_allclose(body.robot.tip(body.q)[:3, 3], shape.tip[:3, 3], atol=1e-9)
    np.testing.assert_array_equal(without.q, Q)
    assert np.linalg.norm(body.robot.tip(body.q)[:3, 3] - HANGING.tip(Q)[:3, 3]) > 0.02
    np.testing.assert_allclose(room.robot.radii, np.repeat([0.016, 0.022], 4))
    np.testing.assert_array_equal(room.q, body.q)
    ((begin, end),) = contents.forces
    np.testing.assert_allclose(end, shape.tip[:3, 3], atol=1e-9)
    np.testing.assert_allclose((begin - end)[:2], 0.0, atol=1e-12)
    assert begin[2] > end[2]


def test_arcs_have_the_colour_of_their_segment_and_a_robot_has_one_pair_of_colours() -> None:
    other = sn.Robot.uniform(2, 0.2, radius=0.01)
    arms = gather([HANGING, Q, other]).arms
    assert [arm.number for arm in arms] == [0, 0, 0, 1]
    body, without, _, last = (arm.colours for arm in arms)
    assert body == [colour for colour in without for _ in range(4)]
    assert not {*body} & {*last}


def test_a_motion_is_of_the_loaded_body_with_its_ghosts(tmp_path: Path) -> None:
    motion = sn.Motion(HANGING, [Q, Q + np.array([0.1, 0.0, 0.0])], [NEAR_BALL])
    contents = gather([motion])
    moving = contents.moving
    assert [each.ghost for each in moving] == [False, True, True]
    for share, q in zip((0.0, 1.0), motion.q, strict=True):
        arm = moving[0].at(share)
        np.testing.assert_allclose(arm.robot.tip(arm.q)[:3, 3], HANGING.shape(q).tip[:3, 3], atol=1e-9)
        ((_, end),) = contents.forces_at(share)
        np.testing.assert_allclose(end, HANGING.shape(q).tip[:3, 3], atol=1e-9)
    sn.view.animate(motion, path=tmp_path / "way.gif", seconds=0.3, fps=10)
    assert (tmp_path / "way.gif").stat().st_size > 1000


def test_the_page_tells_what_holds_of_the_loaded_body() -> None:
    shape = HANGING.shape(Q)
    (targets,) = sn.Job(HANGING, sn.Target(shape.tip[:3, 3], rotation=shape.tip[:3, :3])).waypoints
    judged = judge_shape(HANGING, targets, Q)
    assert judged.position_error == pytest.approx(0.0, abs=1e-9)
    assert judged.angle_error == pytest.approx(0.0, abs=1e-7)
    near = find_nearest(HANGING, sn.Scene([NEAR_BALL]).snapshot(), Q)
    least = (np.linalg.norm(shape.backbone(16) - [0.35, 0.0, -0.2], axis=-1)).min() - 0.05 - 0.012
    assert present(near).distance == pytest.approx(least, abs=1e-4)
    page = PageModel(sn.Job(HANGING, sn.Target(direction=(1, 0, 0)), start=Q))
    np.testing.assert_allclose(page.target_frame(0)[:3, 3], shape.tip[:3, 3], atol=1e-9)


def test_a_trajectory_is_drawn_as_it_is_passed() -> None:
    robot = sn.Robot.uniform(2, length=(40, 60), max_bend=1.6, radius=4)
    q = np.array([[[0, -0.5, 50], [0, 0, 50]], [[0, 0.5, 50], [0, 0, 50]], [[0.5, 0.5, 50], [0, 0, 50]]], float)
    motion = sn.Motion(robot, q, [sn.Sphere((200, 0, 0), radius=10)])
    timed = motion.timed(sn.Rates(bend=1.0, length=9.0, acceleration=sn.Rates(bend=2.0, length=20.0)))
    contents = gather([timed])
    (moving,) = contents.moving
    assert len(contents.obstacles) == 1
    np.testing.assert_allclose(moving.q, timed.at(moving.times))
    assert moving.times[-1] == timed.duration
    assert not np.allclose(moving.q, motion.at(np.linspace(0.0, motion.times[-1], len(moving.q))))


def test_the_place_that_says_why_is_marked() -> None:
    """Of a solution and of a motion from elsewhere, in a picture; nothing is marked of what is solved."""
    ball = sn.Sphere((0, 0, 1.5), 0.2)
    blocked = sn.solve(ROBOT, sn.Target((0, 0, 1.5)), [ball], time=0.05)
    through = sn.Motion(ROBOT, KNOTS, [ball])
    for answer in (blocked, through):
        (mark,) = gather([answer]).marks
        assert np.linalg.norm(mark - (0, 0, 1.5)) < 0.25
        crosses = [drawn for drawn in sn.plot(answer).collections if drawn.get_zorder() == 8]
        np.testing.assert_allclose(np.transpose(crosses[0]._offsets3d), [mark])
    assert gather([sn.solve(ROBOT, sn.Target((1, 0, 1.5)))]).marks == []


def test_a_loaded_body_is_where_its_load_bends_it() -> None:
    robot = sn.Robot.uniform(2, 0.1, stiffness=0.004, mass=0.1, arcs=3, gravity=(0, 0, -9.81), radius=0.005)
    q = np.array([[0.8, 0.2, 0.1], [0.5, -0.3, 0.1]])
    ball = sn.Sphere(robot.shape(q).tip[:3, 3], 0.01)
    scene = sn.Scene([ball]).snapshot()
    own = clearances_along(robot, scene, np.stack([q, q]), 4)
    assert own.shape == (2, 9)
    assert own[0, -1] == pytest.approx(-0.015, abs=1e-9)
    assert clearances_along(robot.changed(gravity=None), scene, q, 4)[-1] > 0.0


SHAPE = (15, 16, 17)
INDEX = np.moveaxis(np.indices(SHAPE), 0, -1).astype(np.float64)
ORIGIN = np.array([-0.8, -0.7, -0.6])


def ball(points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(points - 0.03, axis=-1) - 0.5)


VALUES = ball(ORIGIN + 0.1 * INDEX)


@pytest.mark.parametrize("obstacle", [sn.Grid(VALUES, ORIGIN, 0.1), sn.Field(ball, ORIGIN, -ORIGIN, 0.1)])
def test_dots_of_distances_lie_where_these_are_zero(obstacle: Dotted) -> None:
    found = points_of(obstacle)
    assert len(found) > 300
    assert np.abs(ball(found)).max() < 0.005
    for axis in range(3):
        assert np.ptp(found[:, axis]) > 0.95


def test_dots_of_cells_are_those_that_can_be_seen() -> None:
    grid = sn.Grid(VALUES < 0.0, ORIGIN, 0.1)
    found = points_of(grid)
    depth = -measure(grid, found)
    assert (depth > 0.0).all()
    inner = np.zeros((5, 5, 5), bool)
    inner[1:4, 1:4, 1:4] = True
    assert len(points_of(sn.Grid(inner, (0, 0, 0), 1))) == 26
    assert len(points_of(sn.Grid(np.ones((3, 3, 3), bool), (0, 0, 0), 1))) == 26


@pytest.mark.parametrize("count", [5, MOST_POINTS, MOST_POINTS + 1, 3 * MOST_POINTS])
def test_clouds_are_thinned(count: int) -> None:
    points = np.random.default_rng(0).normal(size=(count, 3))
    found = points_of(sn.PointCloud(points, 0.1))
    assert min(count, MOST_POINTS // 2) <= len(found) <= MOST_POINTS
    assert (found[0] == points[0]).all()


SOLIDS = [make() for name, make in EACH_KIND.items() if name not in ("plates", "cloud", "cells", "samples", "function")]


@with_each("pieces", [1, 12])
@with_each("obstacle", SOLIDS)
def test_vertices_lie_on_the_surface_and_faces_towards_free_space(obstacle: Obstacle, pieces: int) -> None:
    surface = obstacle_surface(obstacle, np.zeros(3), 5.0, pieces=pieces)
    scene = sn.Scene([obstacle])
    assert np.abs(scene.distance(surface.vertices[np.unique(surface.faces)])).max() < 1e-12
    outward, middles = normals_of(surface.facets), surface.facets.mean(axis=1)
    alike = (scene.gradient(middles + 1e-6 * outward) * outward).sum(axis=-1)
    assert alike[np.linalg.norm(outward, axis=-1) > 0.5].min() > 0.99


@with_each("obstacle", SOLIDS)
def test_triangles_and_faces_have_the_same_area_and_turned_ones_the_other_side(obstacle: Obstacle) -> None:
    surface = obstacle_surface(obstacle, np.zeros(3), 5.0)
    corners = surface.vertices[surface.triangles]
    of_triangles = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0)
    facets = surface.facets
    of_faces = 0.5 * np.cross(facets[:, 2] - facets[:, 0], facets[:, 3] - facets[:, 1]).sum(axis=0)
    np.testing.assert_allclose(of_triangles, of_faces, atol=1e-9)
    np.testing.assert_allclose(normals_of(surface.flipped().facets), -normals_of(facets), atol=1e-12)
