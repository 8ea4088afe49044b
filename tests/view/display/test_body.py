"""The drawn body is the body: its vertices lie at the radius about the backbone, and it is closed."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import sinuous as sn
from sinuous.view.display.surfaces import BodySurface, ColouredPart, as_triangles
from sinuous.view.pictures.paint import normals_of
from tests.helpers import random_pose

RNG = np.random.default_rng(1)
AROUND = 16


def body_parts(surface: BodySurface) -> list[ColouredPart]:
    return [part for part in surface.parts if part.segment is not None]


@pytest.mark.parametrize("pieces", [1, 4])
def test_rings_lie_about_the_backbone(pieces: int) -> None:
    robot = sn.Robot(
        [sn.Segment((0.5, 1.5), radius=0.1), sn.Segment(1.0, radius=0.05), sn.Segment((0, 1), radius=0.0)],
        base=random_pose(RNG),
    )
    surface = BodySurface(robot, 0.01, AROUND, pieces=pieces)
    q = RNG.uniform((-2, -2, 0.5), (2, 2, 1), (4, 3, 3))
    backbone = robot.backbone(q, surface.per_segment)
    vertices = surface.vertices(q)
    assert [part.segment for part in body_parts(surface)] == np.repeat([0, 1, 2], pieces).tolist()
    steps = surface.per_segment // pieces
    for i, (part, own) in enumerate(zip(body_parts(surface), vertices, strict=False)):
        middle = backbone[:, None, i * steps : (i + 1) * steps + 1]
        gaps = np.linalg.norm(own[:, :, None] - middle, axis=-1).min(axis=-1)
        np.testing.assert_allclose(gaps, (0.1, 0.05, 0.01)[part.segment or 0], atol=0.005)


def test_one_solid_of_all_parts_has_the_volume_of_the_body() -> None:
    robot = sn.Robot.uniform(2, length=1.0, radius=0.1)
    surface = BodySurface(robot, 0.0, AROUND)
    vertices = surface.vertices(np.array([[[0.0, 0.0, 1.0], [1.0, 0.5, 1.0]]]))
    volume = 0.0
    for part, own in zip(body_parts(surface), vertices, strict=False):
        volume += float(np.linalg.det(own[0][as_triangles(part.faces)]).sum()) / 6.0
    circle = 0.5 * AROUND * np.sin(2 * np.pi / AROUND) * 0.1**2
    assert np.isclose(volume, 2.0 * circle + circle * 0.1 * 4 / 3, rtol=0.02)  # positive: it faces outwards


def test_fittings_are_behind_the_base_around_the_mount_and_at_the_tool() -> None:
    robot = sn.Robot.uniform(2, 10, radius=1, mount=4, tool=sn.pose((0, 0, 3)))
    surface = BodySurface(robot, 0.1, AROUND)
    facets = surface.facets(np.array([[0.0, 0.0, 10.0]] * 2))
    flange, sleeve, tool = (own for own, part in zip(facets, surface.parts, strict=True) if part.segment is None)
    assert (flange[..., 2].min(), flange[..., 2].max()) == pytest.approx((-1.5, -1.0))
    assert (sleeve[..., 2].min(), sleeve[..., 2].max()) == pytest.approx((0.0, 4.0))
    assert (tool[..., 2].min(), tool[..., 2].max()) == pytest.approx((20.0, 23.0))
    assert np.hypot(sleeve[..., 0], sleeve[..., 1])[sleeve[..., 2] < 3.9] == pytest.approx(1.25)
    for own in (flange, sleeve, tool):  # seen from outside
        middles = own.mean(axis=1)
        assert (np.einsum("mx,mx->m", (middles - middles.mean(axis=0))[:, :2], normals_of(own)[:, :2]) > -1e-9).all()
    assert len(BodySurface(robot, 0.1, AROUND, fittings=False).parts) == 2


@pytest.mark.parametrize("mount", [1.0, 12.0, 30.0])
def test_the_sleeve_follows_the_backbone_as_far_as_the_mount_goes(mount: float) -> None:
    robot = sn.Robot.uniform(3, (5, 10), max_bend=3, radius=1, mount=mount, base=random_pose(RNG))
    q = RNG.uniform((-1, -1, 5), (1, 1, 10), (4, 3, 3))
    surface = BodySurface(robot, 0.1, AROUND)
    sleeve = surface.vertices(q)[-1].reshape(4, -1, AROUND, 3)
    centers = sleeve.mean(axis=2)
    backbone = robot.backbone(q, 400)
    assert np.linalg.norm(centers[:, :, None] - backbone[:, None], axis=-1).min(axis=-1).max() < 0.02
    lengths = np.linalg.norm(np.diff(centers, axis=1), axis=-1).sum(axis=1)
    np.testing.assert_allclose(lengths, np.minimum(mount, q[..., 2].sum(axis=1)), rtol=0.01)


@pytest.mark.parametrize("pieces", [1, 3])
def test_links_are_drawn_as_their_capsules(pieces: int) -> None:
    body = [((0.1, 0.2, 0.0), (0.4, -0.1, 0.3), 0.1), ((0, 0, 0), (0, 0, 0), 0.2)]
    joints = [
        sn.Revolute(RNG.normal(size=3), (-2, 2), random_pose(RNG), body=body),
        sn.Prismatic(RNG.normal(size=3), (-1, 1), random_pose(RNG)),
        sn.Revolute(origin=random_pose(RNG)),
    ]
    robot = sn.Robot([sn.Segment(1.0, radius=0.05)], joints=joints, mount=0.3, base=random_pose(RNG))
    surface = BodySurface(robot, 0.01, AROUND, pieces=pieces)
    values = RNG.uniform(-1, 1, (3, 3))
    q = robot.with_joints(np.array([[0.5, 0.4, 1.0]]), values)
    vertices = surface.vertices(q)
    parts = body_parts(surface)
    assert [part.segment for part in parts] == np.repeat(np.arange(len(robot)), pieces).tolist()
    assert all(np.isfinite(own).all() for own in vertices)
    first = robot.changed(joints=joints[:1], segments=[])
    for name, (begin, end, radius) in zip(("j1.body1", "j1.body2"), body, strict=True):
        own = vertices[robot.row_names.index(name) * pieces]
        frames = first.base @ first.joints[0].origin
        for i, value in enumerate(values[:, 0].tolist()):
            axis = first.joints[0].axis
            turned = frames[:3, :3] @ Rotation.from_rotvec(value * axis).as_matrix()
            a, b = (turned @ np.array(place) + frames[:3, 3] for place in (begin, end))
            share = np.clip((own[i] - a) @ (b - a) / max((b - a) @ (b - a), 1e-300), 0.0, 1.0)
            away = np.linalg.norm(own[i] - a - share[:, None] * (b - a), axis=1)
            np.testing.assert_allclose(away, radius, atol=1e-9)
