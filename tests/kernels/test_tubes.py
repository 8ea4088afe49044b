"""Axes of tubes: beside the curve that a tube was made around, from mouth to mouth; and none where there is no tube."""

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks.places.solids import hollow, open_tube
from sinuous import Box, Cylinder, Robot, Scene, Segment, Sphere
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.tubes import BRANCH, NO_TUBE, WALL, find_tubes, follow_tube
from sinuous.scene.obstacles import Obstacle
from sinuous.solver.routing.tubes import rims_of
from tests.helpers import Floats, random_pose

RADIUS = 0.1
BENT = np.array([[0.9, 0.3, 1.0], [-0.5, 0.8, 1.2], [0.2, -1.1, 0.9]])


def followed(scene: Scene, start: Floats, free: float = 0.0, most: int = 400) -> tuple[Floats, int]:
    """The axis from a pose on, and how it ends."""
    points, clock = np.empty((most, 3)), np.zeros(CLOCK_SIZE, np.int64)
    group = scene.snapshot().group.copy()
    sizes = (RADIUS, RADIUS, free)
    count, ended = follow_tube(group, np.stack([start[:3, 3], start[:3, 2]]), sizes, 60.0, clock, points)
    return points[:count], ended


def walls(away: float, wide: float) -> list[Box]:
    """Four walls about the z axis, their middles so far from it."""
    sides = ((away, 0.0), (-away, 0.0), (0.0, away), (0.0, -away))
    return [Box((x, y, 1.0), (0.1 if x else wide, 0.1 if y else wide, 3.0)) for x, y in sides]


@cache
def curve(seed: int, samples: int) -> Floats:
    """Poses (m, 4, 4) along three bent arcs, anywhere."""
    robot = Robot([Segment((0.5, 1.5), 2.0)] * 3, base=random_pose(np.random.default_rng(seed)))
    frames = [robot.base]
    for k, coordinates in enumerate(BENT):
        shorter = Robot([Segment((0.0, 1.5), 2.0)] * (k + 1), base=robot.base)
        shares = np.linspace(0.0, 1.0, samples + 1)[1:]
        frames.extend(shorter.tip(np.vstack([BENT[:k], share * coordinates])) for share in shares)
    return np.array(frames)


def test_a_pipe_that_is_closed_ends_at_a_wall() -> None:
    poses = curve(1, 12)
    points, ended = followed(Scene([hollow(poses, 1.4 * RADIUS, 2.2 * RADIUS).mesh("pipe")]), poses[0])
    assert ended == WALL
    assert np.linalg.norm(points[-1] - poses[-1, :3, 3]) <= 2.5 * RADIUS


def test_a_tube_that_branches_has_no_mouth_there() -> None:
    # A channel along z, and from z = 1.2 to 1.6 on another one along x.
    sides = [Box((0.0, y, 1.0), (4.0, 0.1, 3.0)) for y in (-0.2, 0.2)]
    below = [Box((x, 0.0, 0.35), (3.7, 0.3, 1.7)) for x in (-2.0, 2.0)]
    above = [Box((x, 0.0, 2.05), (3.7, 0.3, 0.9)) for x in (-2.0, 2.0)]
    points, ended = followed(Scene([*sides, *below, *above]), np.eye(4))
    assert ended == BRANCH
    assert points[-1, 2] == pytest.approx(1.2, abs=2.0 * RADIUS)


NOWHERE: Mapping[str, Sequence[Obstacle]] = {
    "nothing": [],
    "one wall": [Box((0.3, 0.0, 1.0), (0.2, 5.0, 5.0))],
    "two walls": [Box((x, 0.0, 1.0), (0.2, 5.0, 5.0)) for x in (-0.3, 0.3)],
    "a pillar ahead": [Cylinder((0.0, 0.0, 0.5), (0.0, 0.0, 1.5), 0.3)],
    "a wide hall": walls(2.0, 5.0),
}


@pytest.mark.parametrize("name", NOWHERE)
def test_there_is_no_tube_where_the_way_is_open_to_a_side(name: str) -> None:
    points, ended = followed(Scene(NOWHERE[name]), np.eye(4))
    assert ended == NO_TUBE
    assert len(points) == 1


def found(obstacles: list[Obstacle], most: int = 8, points: int = 1000) -> list[tuple[Floats, bool]]:
    """The axes of all tubes, and whether they are open at both ends."""
    scene = Scene(obstacles).snapshot()
    axes, ends, clock = np.empty((points, 3)), np.zeros((most, 3), np.int64), np.zeros(CLOCK_SIZE, np.int64)
    count = find_tubes(scene.group.copy(), rims_of(scene), RADIUS, 60.0, clock, axes, ends)
    return [(axes[first:last], bool(through)) for first, last, through in ends[:count]]


def gap(place: Floats, other: Floats) -> float:
    return float(np.linalg.norm(place - other))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("width", [1.15, 1.6, 2.2])
def test_a_bent_pipe_is_found_from_mouth_to_mouth(width: float, seed: int) -> None:
    poses = curve(seed, 12)
    ((axis, through),) = found([open_tube(poses, width * RADIUS, (width + 0.8) * RADIUS).mesh("pipe")])
    assert through
    gaps, _ = cKDTree(curve(seed, 120)[:, :3, 3]).query(axis[2:-2])
    assert np.max(gaps) <= 0.5 * RADIUS
    ends = poses[[0, -1], :3, 3]
    straight, turned = (max(gap(axis[0], a), gap(axis[-1], b)) for a, b in (ends, ends[::-1]))
    assert min(straight, turned) <= 1.6 * RADIUS
    steps = np.linalg.norm(np.diff(axis, axis=0), axis=1)
    assert steps.min() >= 0.5 * RADIUS
    assert steps.max() <= 1.5 * RADIUS


def test_there_is_none_in_a_closed_pipe_a_wide_hall_a_thin_door_and_beside_one_box() -> None:
    assert not found([hollow(curve(0, 12), 1.3 * RADIUS, 2.1 * RADIUS).mesh("pipe")])
    assert not found(list(walls(2.0, 5.0)))
    assert not found([Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), Sphere((3.0, 0.0, 0.0), 1.0)])
    half, thick = 1.5 * RADIUS, 0.05
    door = [Box((side * (1.0 + half), 0.0, 0.0), (2.0, 4.0, thick)) for side in (-1.0, 1.0)]
    door += [Box((0.0, side * (1.0 + half), 0.0), (2.0 * half, 2.0, thick)) for side in (-1.0, 1.0)]
    assert not found(list(door))


def test_tables_that_are_full_are_not_written_beyond() -> None:
    pipe = open_tube(curve(0, 12), 1.5 * RADIUS, 2.3 * RADIUS).mesh("pipe")
    for points in range(1, 12):
        for axis, _ in found([pipe], points=points):
            assert len(axis) <= points
    assert len(found([*walls(0.2, 0.5), pipe], most=1)) == 1
