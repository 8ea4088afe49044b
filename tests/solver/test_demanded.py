"""Clearance that is demanded: every way of solving keeps and proves it; judged by sampling."""

from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.measures.body import least_clearance, least_self_clearance, segment_ends
from sinuous.solver.certificates.steps import prove_steps
from tests.helpers import present, refused

ROBOT = sn.Robot.uniform(3, (40.0, 60.0), 2.0, radius=4.0)
BALL = sn.Sphere((40.0, 0.0, 60.0), 10.0, name="ball")
ROOM = sn.Box((0.0, 0.0, 80.0), (80.0, 80.0, 200.0), inside=True, name="room")
TARGET = sn.Target((60.0, 0.0, 90.0))
SLIT = [sn.HalfSpace((-7.0, 0.0, 0.0), (1.0, 0.0, 0.0), name="left"), sn.HalfSpace((7.0, 0.0, 0.0), (-1.0, 0.0, 0.0))]


def sampled(robot: sn.Robot, scene: Any, q: Any) -> float:
    """Clearance of the body of a plain robot, by matrix exponentials and sampling."""
    return least_clearance(robot, sn.Scene(scene).snapshot(), q, segment_ends(robot, q)).distance


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("clearance", [0.5, 5.0])
def test_a_solution_keeps_it_and_says_the_distance_of_the_body(scale: float, clearance: float) -> None:
    robot = sn.Robot.uniform(3, (40.0 * scale, 60.0 * scale), 2.0, radius=4.0 * scale)
    ball = sn.Sphere((40.0 * scale, 0.0, 60.0 * scale), 10.0 * scale)
    seen = 0
    for y in np.linspace(-30.0, 30.0, 7):
        target = sn.Target((60.0 * scale, y * scale, 90.0 * scale))
        found = sn.solve(robot, target, [ball], clearance=clearance * scale)
        assert found.solved
        assert found.clearance is not None
        true = sampled(robot, [ball], found.q)
        assert clearance * scale <= found.clearance <= true <= 1.2 * found.clearance
        assert found.verify().ok
        assert found.verify().clearance == pytest.approx(true)
        seen += true < 1.5 * clearance * scale
    assert found.demanded_clearance == clearance * scale
    assert seen or clearance < 1.0


def test_the_body_itself_is_as_thick_as_before() -> None:
    """A body that could not coil with that much more radius keeps clear of itself by its own."""
    coil = sn.Robot.uniform(4, 40.0, 2.4, radius=8.0)
    q = np.array([[1.2, 0.0, 40.0]] * 2 + [[1.2, 0.3, 40.0]] * 2)
    target = sn.Target(coil.tip(q)[:3, 3], rotation=coil.tip(q)[:3, :3])
    far = [sn.Sphere((500.0, 0.0, 0.0), 10.0)]
    assert sn.solve(coil, target, far, initial=q).solved
    found = sn.solve(coil, target, far, initial=q, clearance=30.0)
    assert found.solved
    assert found.self_clearance == pytest.approx(sn.solve(coil, target, far, initial=q).self_clearance)
    assert coil.changed(radius=38.0).violations(q)


@pytest.mark.parametrize("apart", [4.0, 12.0])
def test_a_distance_from_itself_is_kept(apart: float) -> None:
    robot = sn.Robot.uniform(5, 40.0, 3.0, radius=4.0)
    for k, seed in enumerate(range(4)):
        target = sn.Target((10.0 * k, -20.0, 20.0))
        found = sn.solve(robot, target, self_clearance=apart, seed=seed)
        assert found.solved
        assert present(found.self_clearance) >= apart
        own = robot.changed(self_clearance=apart)
        itself = least_self_clearance(own, found.q, segment_ends(own, found.q))
        assert itself.gap >= -1e-9
        assert found.verify().ok
        # Places that are pi times the radius and half of the distance apart along the body are so far from each other.
        plain = least_self_clearance(robot.changed(radius=4.0 + 0.5 * apart), found.q, segment_ends(robot, found.q))
        assert plain.gap == pytest.approx(itself.gap)
    assert found.demanded_self_clearance == apart
    assert found.demanded_clearance is None


def test_what_cannot_be_kept_is_proved_impossible_and_told() -> None:
    found = sn.solve(ROBOT, sn.Target((2.0, 20.0, 140.0)), SLIT, clearance=2.0)
    assert str(found.status) == "target_blocked"
    assert "of radius 4 and with 2 of clearance, would be 0.985 too near" in str(found.reason)
    assert "or is nearer to one than is demanded" in found.sentence
    told = found.explain()
    (less,) = [each for each in told.remedies if each.change == "clearance"]
    assert less.before == 2.0
    assert 0.9 < less.after <= 1.02
    assert sn.solve(ROBOT, sn.Target((2.0, 20.0, 140.0)), SLIT, clearance=less.after).solved
    base = sn.solve(ROBOT, TARGET, SLIT, clearance=4.0)
    assert str(base.status) == "base_blocked"
    assert "leaves its mount it is 1 too near to left" in str(base.reason)


def test_every_way_of_solving_keeps_it() -> None:
    scene = [BALL, ROOM]
    solver = sn.Solver(ROBOT, scene, clearance=4.0)
    targets = np.array([[25.0, y, 100.0] for y in (-10.0, 0.0, 10.0)])
    many = solver.solve_many(positions=targets, workers=1)
    assert many.solved.all()
    assert (many.clearance >= 4.0).all()
    np.testing.assert_array_equal(many.clearance, [one.clearance for one in many])
    assert all(one.clearance is not None and one.clearance >= 4.0 for one in solver.solve_all(sn.Target(targets[0])))
    moved = sn.track(ROBOT, positions=targets, scene=scene, clearance=4.0)
    planned = sn.plan(ROBOT, many[0], sn.Target(targets[2]), scene, clearance=4.0)
    for motion in (moved, planned):
        assert motion.solved
        assert motion.clearance is not None
        assert motion.clearance >= 4.0
        between = np.concatenate([(1.0 - s) * motion.q[:-1] + s * motion.q[1:] for s in (0.0, 0.3, 0.7)])
        assert min(sampled(ROBOT, scene, q) for q in between) >= motion.clearance - 1e-9
        assert motion.to_dict()["demanded_clearance"] == 4.0
    reached = sn.studies.reach(ROBOT, scene, 60.0, 1, clearance=4.0, workers=1)
    assert reached.share.max() > 0.0
    done = sn.studies.assess(ROBOT, [TARGET], scene, clearance=4.0, time=0.1)
    assert done.rows[0].done.status != "solved"  # 60 is nearer to the wall than that


def test_a_loop_never_comes_nearer() -> None:
    solver = sn.Solver(ROBOT, [BALL], clearance=3.0)
    found = solver.solve(sn.Target((60.0, 20.0, 90.0)))
    for time in (1.0, 1e-6):  # so little that nothing is proved of where it ends but what the way says
        q, nearest = found.q, np.inf
        loop = sn.Solver(ROBOT, [BALL], clearance=3.0, time=time)
        for _ in range(40):
            step = loop.step(q, (-30.0, -15.0, -10.0), 0.02)
            if step.proved:
                assert step.clearance is not None
                assert step.self_clearance is not None
                assert 3.0 <= step.clearance <= sampled(ROBOT, [BALL], step.q) + 1e-9
            q, nearest = step.q, min(nearest, sampled(ROBOT, [BALL], step.q))
        assert nearest >= 3.0
    assert step.clearance is None or step.proved


def test_a_motion_that_comes_nearer_is_not_proved() -> None:
    straight = np.array([[0.0, 0.0, 50.0]] * 3)
    near = np.array([[0.2, 0.0, 50.0], [0.0, 0.0, 50.0], [0.0, 0.0, 50.0]])
    ball = sn.Scene([sn.Sphere((45.0, 0.0, 110.0), 6.0)]).snapshot()
    steps = prove_steps(ROBOT, ball, np.stack([straight, near]))
    assert steps.proved.all()
    least = present(steps.clearance)
    again = prove_steps(ROBOT.changed(clearance=0.9 * least), ball, np.stack([straight, near]))
    assert again.proved.all()
    assert again.clearance == pytest.approx(least, rel=0.11)
    assert not prove_steps(ROBOT.changed(clearance=1.3 * least), ball, np.stack([straight, near])).proved.any()


def test_what_cannot_be_meant_is_refused() -> None:
    for wrong in (-1.0, "1", True, np.nan, [1.0, 2.0]):
        refused("clearance", lambda wrong=wrong: sn.solve(ROBOT, TARGET, [BALL], clearance=wrong), "number")  # type: ignore[misc]
    refused("clearance[2]", lambda: sn.solve(ROBOT, TARGET, [BALL], clearance=[1.0, 2.0, -3.0]), "at least 0")
    through = ROBOT.changed(self_collision="allow")
    refused("self_clearance", lambda: sn.solve(through, TARGET, self_clearance=1.0), "self_collision: allow")
    assert sn.solve(ROBOT, TARGET, [BALL], clearance=np.array([1.0, 1.0, 2.0])).demanded_clearance == (1.0, 1.0, 2.0)
