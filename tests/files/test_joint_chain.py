"""A chain of joints stands for a robot of arcs."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.files.joint_chain import JointChain

ARM = sn.Robot(
    [
        sn.Segment((0, 80), max_bend=0, radius=4, name="stage"),
        sn.Segment((45, 70), max_bend=2.4, radius=4),
        sn.Segment(60, max_bend=2.0, radius=3),
    ],
)


def test_names_and_limits_are_those_of_the_segments() -> None:
    chain = JointChain(ARM, 2)
    assert chain.names == (
        *("stage_1_z", "s2_1_z", "s2_1_x", "s2_1_y", "s2_2_z", "s2_2_y", "s2_2_x", "s2_3_z"),
        *("s3_1_x", "s3_1_y", "s3_2_y", "s3_2_x"),
    )
    limits = {joint.name: joint.limits for joint in chain.joints}
    assert limits["stage_1_z"] == (0.0, 80.0)
    assert limits["s2_2_z"] == (22.5, 35.0)
    assert limits["s3_1_x"] == (-1.0, 1.0)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_values_are_linear_and_make_up_the_whole(count: int) -> None:
    chain = JointChain(ARM, count)
    q = np.random.default_rng(count).uniform(0.1, 1.0, (4, 3, 3))
    values = chain.values(q)
    np.testing.assert_allclose(values, q.reshape(4, -1) @ chain.matrix.T)
    for k, name in enumerate(ARM.segment_names):
        own = {axis: [i for i, n in enumerate(chain.names) if n.startswith(name) and n[-1] == axis] for axis in "xyz"}
        if own["x"]:
            np.testing.assert_allclose(values[:, own["x"]].sum(axis=1), -q[:, k, 1])
            np.testing.assert_allclose(values[:, own["y"]].sum(axis=1), q[:, k, 0])
        if own["z"]:
            np.testing.assert_allclose(values[:, own["z"]].sum(axis=1), q[:, k, 2])


def test_what_cannot_move_has_no_joint() -> None:
    rod = sn.Robot([sn.Segment(10, max_bend=0), sn.Segment((0, 5), max_bend=0)])
    chain = JointChain(rod)
    assert chain.names == ("s2_1_z",)
    assert (chain.joints[0].origin[2, 3], chain.end) == (10.0, 0.0)


def test_a_count_that_is_none_is_refused() -> None:
    with pytest.raises(sn.InputError, match="joints_per_segment: expected a whole number from 1 to 1000, got 0"):
        JointChain(ARM, 0)
