"""Derivatives of shapes on a curve: against differences of shapes fitted by other code, and of motions led anew."""

from functools import cache, partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.following import line_in_front
from sinuous.motion.leader_derivative import GROUPS, LeaderQuestion
from tests.helpers import Floats, refused

CURVE = sn.Curve.bezier([(0, 0, 0), (0, 0.1, 1.6), (2, 0, 1.3)], 7)
STAGED = sn.on_stage(sn.Robot.uniform(2, 1.0, radius=0.05), 1.1 * CURVE.length)
DEPTHS = [2.37, 3.71]


@cache
def entered() -> sn.Motion:
    """The motion along the curve; not led when tests are collected, since that compiles."""
    return sn.follow_the_leader(STAGED, CURVE)


def differences(question: LeaderQuestion, column: Any, near: Floats) -> Floats:
    """Of shapes near others, with two steps that the derivative does not take."""
    h = 4e-4 * column.scale
    ends = [column.changed(share * h).shapes(near) for share in (1.0, -1.0, 0.5, -0.5)]
    change: Floats = (8.0 * (ends[2] - ends[3]) - (ends[0] - ends[1])) / (6.0 * h)
    return change


def test_they_agree_with_differences() -> None:
    """All are named; every fourth one of a group is looked at."""
    derivative = entered().derivative(CURVE, DEPTHS[1:], tuple(GROUPS))
    assert derivative.regular
    question = LeaderQuestion(STAGED, line_in_front(STAGED, CURVE), np.array(DEPTHS[1:]))
    for group in GROUPS:
        columns, own = list(GROUPS[group](question)), derivative.q[group]
        assert list(derivative.labels(group)) == [column.name for column in columns]
        for i, column in list(enumerate(columns))[::4]:
            wanted = differences(question, column, derivative.configurations)
            np.testing.assert_allclose(own[..., i], wanted, atol=3e-6 * np.abs(own).max(), err_msg=column.name)


def test_tips_stay_on_the_curve() -> None:
    """Kinematics say how tips move, the curve says where they have to be; a base that advances takes them along."""
    derivative, path = entered().derivative(CURVE, DEPTHS, ("advance", "base")), line_in_front(STAGED, CURVE)
    for i, depth in enumerate(DEPTHS):
        jacobian = STAGED.jacobian(derivative.configurations[i])[3:]
        moved = (jacobian @ derivative.q[name][i].reshape(9, -1) for name in derivative.wrt)
        advance, base = moved
        np.testing.assert_allclose(advance[:, 0], path.tangent(depth), atol=1e-6)
        np.testing.assert_allclose(base[:, 5] + [0.0, 0.0, 1.0], path.tangent(depth), atol=1e-6)


def test_a_motion_that_is_led_anew_differs_by_them() -> None:
    """As far as fits of motions go: those end where a round brings little."""
    h = 0.02
    derivative = entered().derivative(CURVE, DEPTHS, "curve")
    i = derivative.labels("curve").index("curve[4].y")
    ends = []
    for sign in (1.0, -1.0):
        points = CURVE.points.copy()
        points[4, 1] += sign * h
        ends.append(sn.follow_the_leader(STAGED, points).derivative(points, DEPTHS, "advance").configurations)
    change = (ends[0] - ends[1]) / (2.0 * h)
    own = derivative.q["curve"][..., i]
    np.testing.assert_allclose(own, change, atol=0.02 * np.abs(own).max())


def test_products_agree_with_each_other() -> None:
    derivative, rng = entered().derivative(CURVE, DEPTHS, ("curve", "lengths")), np.random.default_rng(0)
    tangent = {name: rng.normal(size=len(derivative.labels(name))) for name in derivative.wrt}
    cotangent = rng.normal(size=derivative.configurations.shape)
    back = derivative.vjp(cotangent)
    wanted = (cotangent * derivative.jvp(tangent)).sum()
    assert sum(back[name] @ tangent[name] for name in tangent) == pytest.approx(wanted)
    one = entered().derivative(CURVE, [2.4])
    assert one.depths.tolist() == [2.4]
    assert one.jvp([1.0]).shape == (1, 3, 3)


def test_a_place_of_the_body_where_the_line_in_front_ends_is_a_kink() -> None:
    """The curvature of the path jumps there; a quarter of the last segment lies on the curve."""
    lead = line_in_front(STAGED, CURVE).lead
    assert not entered().derivative(CURVE, [lead + 0.25], "advance").regular


def test_bad_input_is_refused() -> None:
    derive: Any = partial(entered().derivative, CURVE, [2.4])
    refused("wrt", lambda: derive("colour"), "advance, curve, base, lengths")
    refused("depths", lambda: entered().derivative(CURVE, [0.1]), "from 2 to")
    refused("depths", lambda: entered().derivative(CURVE, []), "from 2 to")
    refused("depths[1]", lambda: entered().derivative(CURVE, [2.5, 2.4]), "increase")
    refused(
        "curve", lambda: entered().derivative(CURVE.points + np.array([0.0, 0.01, 0.0]), [2.4]), "this motion follows"
    )
    refused("cotangent", lambda: derive().vjp([[1.0]]))
