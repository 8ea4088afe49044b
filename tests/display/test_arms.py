"""What is drawn of a robot: where its body is under load, and as ghosts where it would be without, or may be."""

from pathlib import Path

import numpy as np
import pytest

import sinuous as sn
from sinuous.display.contents import gather
from sinuous.viewer.model import Model
from sinuous.viewer.status import judge, nearest

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
BALL = sn.Sphere((0.35, 0.0, -0.2), 0.05, name="ball")


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


def test_segments_end_on_the_body() -> None:
    poses = HANGING.shape(Q).poses
    contents = gather([HANGING, Q, sn.Target(direction=(1, 0, 0), segment=1), sn.Target(direction=(1, 0, 0))])
    for placed, pose in zip(contents.targets, poses, strict=True):
        np.testing.assert_allclose(placed.place, pose[:3, 3], atol=1e-9)


def test_a_motion_is_of_the_loaded_body_with_its_ghosts(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib").use("agg")
    motion = sn.Motion(HANGING, [Q, Q + np.array([0.1, 0.0, 0.0])], [BALL])
    contents = gather([motion])
    moving = contents.moving
    assert [each.ghost for each in moving] == [False, True, True]
    for share, q in zip((0.0, 1.0), motion.q, strict=True):
        arm = moving[0].at(share)
        np.testing.assert_allclose(arm.robot.tip(arm.q)[:3, 3], HANGING.shape(q).tip[:3, 3], atol=1e-9)
        ((_, end),) = contents.forces_at(share)
        np.testing.assert_allclose(end, HANGING.shape(q).tip[:3, 3], atol=1e-9)
    sn.animate(motion, path=tmp_path / "way.gif", seconds=0.3, fps=10)
    assert (tmp_path / "way.gif").stat().st_size > 1000


def test_the_page_tells_what_holds_of_the_loaded_body() -> None:
    shape = HANGING.shape(Q)
    (targets,) = sn.Job(HANGING, sn.Target(shape.tip[:3, 3], rotation=shape.tip[:3, :3])).waypoints
    judged = judge(HANGING, targets, Q)
    assert judged.position_error == pytest.approx(0.0, abs=1e-9)
    assert judged.angle_error == pytest.approx(0.0, abs=1e-7)
    near = nearest(HANGING, sn.Scene([BALL]).snapshot(), Q)
    assert near is not None
    least = (np.linalg.norm(shape.backbone(16) - [0.35, 0.0, -0.2], axis=-1)).min() - 0.05 - 0.012
    assert near.distance == pytest.approx(least, abs=1e-4)
    page = Model(sn.Job(HANGING, sn.Target(direction=(1, 0, 0)), start=Q))
    np.testing.assert_allclose(page.target_frame(0)[:3, 3], shape.tip[:3, 3], atol=1e-9)
