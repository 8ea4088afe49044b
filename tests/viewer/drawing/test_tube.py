"""The tube that is drawn is the body: its points lie at the radius about the backbone, and it is closed."""

import numpy as np

import sinuous as sn
from sinuous.viewer.drawing import solids
from sinuous.viewer.drawing.tube import AROUND, Tube
from tests.helpers import random_pose

RNG = np.random.default_rng(1)


def test_rings_lie_about_the_backbone() -> None:
    robot = sn.Robot(
        [sn.Segment((0.5, 1.5), radius=0.1), sn.Segment(1.0, radius=0.05), sn.Segment((0, 1), radius=0.0)],
        base=random_pose(RNG),
    )
    tube = Tube(robot, least_radius=0.01)
    q = RNG.uniform((-2, -2, 0.5), (2, 2, 1), (4, 3, 3))
    frames = tube.frames(q)
    backbone = robot.backbone(q, tube.per_segment)
    np.testing.assert_allclose(frames[..., 9:], backbone, atol=1e-12)
    points = tube.points(frames)
    for piece, radius in zip(tube.pieces, (0.1, 0.05, 0.01), strict=True):
        own = points[:, piece.rings]
        gaps = np.linalg.norm(own[:, :, :, None] - backbone[:, None, None, piece.middle], axis=-1).min(axis=-1)
        np.testing.assert_allclose(gaps, radius, atol=0.005)


def test_one_solid_of_all_pieces_has_the_volume_of_the_body() -> None:
    robot = sn.Robot.uniform(2, length=1.0, radius=0.1)
    tube = Tube(robot, 0.0)
    q = np.array([[[0.0, 0.0, 1.0], [1.0, 0.5, 1.0]]])
    points = tube.points(tube.frames(q))[0]
    volume = 0.0
    for piece in tube.pieces:
        corners = points[piece.rings].reshape(-1, 3).astype(np.float64)[tube.faces(piece)]
        volume += float(np.linalg.det(corners).sum()) / 6.0
    circle = 0.5 * AROUND * np.sin(2 * np.pi / AROUND) * 0.1**2
    assert np.isclose(volume, 2.0 * circle + circle * 0.1 * 4 / 3, rtol=0.02)  # positive: it faces outwards


def test_solids_face_outwards_and_are_closed() -> None:
    for solid, volume in (
        (solids.sphere(), 4 * np.pi / 3),
        (solids.box(), 8.0),
        (solids.cylinder(), 2 * np.pi),
        (solids.cone(), np.pi / 3),
        (solids.capsule(1.0, 2.0), 4 * np.pi / 3 + 4 * np.pi),
    ):
        found = float(np.linalg.det(solid.vertices[solid.faces]).sum()) / 6.0
        assert np.isclose(found, volume, rtol=0.04)
