"""The way between knots, looked at densely, held against the slow path at rest."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.body import least_clearance, least_self_clearance, segment_ends
from sinuous.measures.following import FEWEST, MOST, STRIDE, least_clearances, least_meeting, shares_between
from sinuous.scene.scene import as_snapshot

ARM = sn.Robot.uniform(3, (0.5, 1.5), 6.0, radius=0.05, base=sn.pose((1, 2, 3), direction=(1, 1, 0)))


def test_clearances_are_those_of_single_shapes() -> None:
    rng = np.random.default_rng(0)
    q = np.concatenate([rng.uniform(-2, 2, (5, 3, 2)), rng.uniform(0.5, 1.5, (5, 3, 1))], axis=-1)
    mounted = ARM.changed(mount=0.8)
    scene = as_snapshot([sn.Sphere((2, 2, 3), 0.4, name="ball"), sn.Box((1, 3, 3.5), (0.2, 0.3, 0.4), name="box")])
    least, _, segments, obstacles = least_clearances(mounted, scene, q)
    for i, one in enumerate(q):
        ends = segment_ends(mounted, one)
        alone = least_clearance(mounted, scene, one, ends)
        assert least[i] == pytest.approx(alone.distance, abs=2e-3)
        assert (segments[i] + 1, scene.name(int(obstacles[i]))) == (alone.segment, alone.obstacle)
        assert least_meeting(mounted, one[None]).gap == pytest.approx(
            least_self_clearance(mounted, one, ends).gap, abs=5e-3
        )


def test_between_two_looks_no_place_moves_far() -> None:
    rng = np.random.default_rng(1)
    for _ in range(50):
        one, other = (
            np.concatenate([rng.uniform(-1, 1, (3, 2)), rng.uniform(0.5, 1.5, (3, 1))], axis=-1) for _ in range(2)
        )
        shares = shares_between(ARM, one, other)
        assert FEWEST < len(shares) <= MOST + 1
        q = one + shares[:, None, None] * (other - one)
        moved = np.linalg.norm(np.diff(ARM.backbone(q, 8), axis=0), axis=-1).max()
        assert moved <= STRIDE * np.maximum(one, other)[:, 2].sum() * (1.0 + 1e-12)


@pytest.mark.parametrize("unit", [1e-9, 1.0, 1e9])
def test_where_the_body_leaves_its_mount_it_is_looked_at(unit: float) -> None:
    """A needle just there meets none of the even samples, and what is within the mount counts for nothing."""
    robot = sn.Robot([sn.Segment(unit, 0.0)], mount=unit / 3.0)
    place, q = unit / 3.0, np.array([[0.0, 0.0, unit]])
    below = as_snapshot([sn.Sphere((0, 0, place - 1e-3 * unit), 5e-4 * unit)])
    for found in (
        least_clearance(robot, below, q, segment_ends(robot, q)).distance,
        least_clearances(robot, below, q[None])[0][0],
    ):
        assert found == pytest.approx(5e-4 * unit, rel=1e-9)


def test_a_joint_at_which_the_mount_ends_counts_for_what_is_beyond_it() -> None:
    robot = sn.Robot([sn.Segment(0.1, 0.0, radius=0.2), sn.Segment(1.0, 1.0, radius=0.01)], mount=0.1)
    q, scene = np.array([[0.0, 0.0, 0.1], [0.0, 0.0, 1.0]]), as_snapshot([sn.Sphere((0.1, 0, 0.1), 0.05)])
    assert least_clearance(robot, scene, q, segment_ends(robot, q)).distance == pytest.approx(0.04)
    assert least_clearances(robot, scene, q[None])[0][0] == pytest.approx(0.04)
    solution = sn.solve(robot, sn.Target((0.0, 0.0, 1.1)), scene.obstacles)
    assert solution.solved
    assert solution.verify().ok
