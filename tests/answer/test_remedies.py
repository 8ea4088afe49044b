"""Every kind of remedy, for every status: known answers, and each is what it says, because it was tried."""

import math
import pickle
import re
from collections.abc import Iterator
from functools import cache

import numpy as np
import pytest

import sinuous as sn
from sinuous.answer.remedies import Remedy
from tests.helpers import present

ROBOT = sn.Robot.uniform(3, length=(0.8, 1.0), max_bend=0.5, radius=0.1)
BENDY = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.1)
TOLERANCE = 1e-4 * ROBOT.mean_length
ENOUGH = 600.0
"""Seconds: more than any of this takes, so that nothing depends on the speed of the machine."""

Remedies = dict[str, Remedy]


def helped(solution: sn.Solution) -> Remedies:
    explanation = solution.explain(time=ENOUGH)
    assert explanation.complete
    for remedy in explanation.remedies:
        assert (remedy.problem is None) == (remedy.change in ("method", "time", "max_starts", "within"))
    return {remedy.change: remedy for remedy in explanation.remedies}


@cache
def too_far() -> Remedies:
    return helped(sn.solve(ROBOT, sn.Target((0, 0, 3.5))))


def test_the_nearest_position_is_found() -> None:
    remedy = too_far()["target position"]
    assert 0.5 - TOLERANCE <= math.dist(remedy.after, (0, 0, 3.5)) <= 0.51
    assert set(too_far()) == {"length of all segments", "target position"}


def test_the_smallest_bend_and_the_nearest_direction_are_found() -> None:
    remedies = helped(sn.solve(ROBOT, sn.Target(direction=(0, 0, -1))))
    exact = (math.pi - 1e-3) / 3.0
    assert exact <= remedies["max_bend of all segments"].after <= 0.5 + 1.02 * (exact - 0.5)
    turned = math.acos(-remedies["target direction"].after[2])
    assert math.pi - 1.5 - 1e-3 - 1e-9 <= turned <= 1.02 * (math.pi - 1.5)


def test_nearly_met_targets_may_be_met_more_loosely() -> None:
    remedies = helped(sn.solve(ROBOT, sn.Target((0, 0, 3.001))))
    assert 0.001 <= remedies["tolerance.position"].after <= 0.0011
    remedies = helped(sn.solve(ROBOT, sn.Target(direction=(math.sin(1.505), 0, math.cos(1.505)))))
    assert 0.005 <= remedies["tolerance.angle"].after <= 0.0056


def test_tendons_are_widened_on_both_sides() -> None:
    robot = sn.Robot.uniform(1, (0.9, 1.1), 3.0, tendons=sn.Tendons(4, 0.1, displacement=(-0.1, 0.1)))
    solution = sn.solve(robot, sn.Target(direction=(math.sin(1.3), 0, math.cos(1.3))), max_starts=50)
    assert solution.status is sn.Status.LIMIT_BOUND
    remedy = helped(solution)["tendons.displacement of segment 1"]
    assert remedy.before == [-0.1, 0.1]
    assert remedy.after[1] == -remedy.after[0] == pytest.approx(0.13, rel=0.01)


def driven(most: float) -> sn.Robot:
    """Two motors that bend a fixed arm to x and y, and one that bends both segments of it."""
    matrix = np.array([[0.5, 0, 0, 0, 0, 0], [0, 0.5, 0, 0, 0, 0], [1, 0, 0, 1, 0, 0]])
    limits = [(-most, most), (-most, most), None]
    actuators = sn.Actuators(matrix, ["pan", "tilt", "both"], limits)
    return sn.Robot([sn.Segment(1.0, 2.0), sn.Segment(1.0, 0.0)], actuators=actuators)


def test_limits_of_actuators_are_named_and_widened() -> None:
    target = sn.Target(direction=(math.sin(1.0), 0, math.cos(1.0)))
    solution = sn.solve(driven(0.3), target, max_starts=50)
    assert solution.status is sn.Status.LIMIT_BOUND
    assert solution.sentence.endswith("value of pan")
    (held,) = (each for each in solution.binding if each.actuator is not None)
    assert (held.constraint, held.segment, held.actuator, held.limit) == ("actuator", 1, "pan", 0.3)
    assert held.value == pytest.approx(0.3)
    assert present(solution.actuators)["pan"] <= 0.3 + 1e-12
    assert solution.verify().excess <= 1e-9
    remedy = helped(solution)["actuators.limits of pan and tilt"]
    assert remedy.before == [-0.3, 0.3]
    low, high = remedy.after
    assert high == -low == pytest.approx(0.5, rel=0.02)
    then = sn.solve(driven(high), target)
    assert then.solved
    assert "nearly at  value of pan" in str(then.explain())


def test_limits_of_which_none_is_enough_alone_are_widened_together() -> None:
    """The place lies beyond the length, and the direction beyond the bends."""
    robot = sn.Robot.uniform(2, (0.9, 1.0), 0.6)
    target = sn.Target((0.0, 1.6, 1.6), direction=(0.0, 1.0, 0.0))
    remedies = helped(sn.solve(robot, target))
    assert set(remedies) == {"limits", "target"}
    before, after = remedies["limits"].before, remedies["limits"].after
    assert before == {"length of all segments": [0.9, 1.0], "max_bend of all segments": 0.6}
    (low, high), bend = after["length of all segments"], after["max_bend of all segments"]
    assert (low, bend >= math.pi / 4.0 - 1e-3, high >= 0.8 * math.sqrt(2.0)) == (0.9, True, True)
    assert sn.solve(sn.Robot.uniform(2, (low, high), bend), target).solved


WALL = sn.Box((0, 1, 1.5), (8, 0.2, 8), name="wall")


def test_the_obstacle_at_the_target_is_named_and_the_target_moved() -> None:
    solution = sn.solve(BENDY, sn.Target((0, 1, 2.2)), [WALL, sn.Sphere((0, -2, 1), 0.5)])
    assert solution.status is sn.Status.TARGET_BLOCKED
    remedies = helped(solution)
    assert "obstacle wall" in remedies
    assert "obstacle sphere[1]" not in remedies
    moved = np.array(remedies["target position"].after)
    assert 0.2 - 4e-4 <= np.linalg.norm(moved - (0, 1, 2.2)) <= 0.22


def test_a_base_in_the_floor_needs_a_mount_or_another_place() -> None:
    solution = sn.solve(BENDY, sn.Target((0, 0, 2.5)), [sn.Box((0.2, 0, 0), (1, 1, 1), name="floor")])
    assert solution.status is sn.Status.BASE_BLOCKED
    remedies = helped(solution)
    assert 0.6 <= remedies["mount"].after <= 0.61
    assert remedies["base position"].after == pytest.approx([-0.4, 0.0, 0.0], abs=0.01)
    assert remedies["base position"].after[0] <= -0.4
    assert "obstacle floor" in remedies


def prism(low: float, high: float, sides: int = 12) -> sn.Mesh:
    """A closed tube of radius 0.4 about the z axis."""
    angles = np.linspace(0.0, 2.0 * math.pi, sides, endpoint=False)
    ring = 0.4 * np.column_stack([np.cos(angles), np.sin(angles)])
    corners = [np.column_stack([ring, np.full(sides, z)]) for z in (low, high)]
    bottom, top, faces = 2 * sides, 2 * sides + 1, []
    for i, j in zip(range(sides), [*range(1, sides), 0], strict=True):
        faces += [[i, j, sides + j], [i, sides + j, sides + i], [bottom, j, i], [top, sides + i, sides + j]]
    return sn.Mesh(np.concatenate([*corners, [[0, 0, low], [0, 0, high]]]), faces, name="lumen")


def test_a_body_that_begins_in_a_closed_lumen_is_told_to_stay_inside() -> None:
    solution = sn.solve(BENDY, sn.Target((0.1, 0.1, 2.5)), [prism(-0.5, 4.0)])
    assert solution.status is sn.Status.BASE_BLOCKED
    assert "where the body belongs inside lumen, give that inside=True" in str(solution)
    remedy = helped(solution)["inside of lumen"]
    assert (remedy.before, remedy.after) == (False, True)
    assert present(remedy.problem).scene.obstacles[0].inside
    assert solution.reason is not None
    assert present(solution.reason.place).to_dict() == {"position": [0.0, 0.0, 0.0], "segment": 1, "share": 0.0}
    outside = sn.solve(BENDY, sn.Target((0.1, 0.1, 2.5)), [prism(0.05, 4.0)])
    assert outside.status is sn.Status.BASE_BLOCKED
    assert "inside=True" not in str(outside)


def test_an_obstacle_that_is_in_the_way_says_where_it_would_have_to_give_way() -> None:
    solution = sn.solve(BENDY, sn.Target((0, 1.6, 1.6)), [WALL], max_starts=20)
    remedy = helped(solution)["obstacle wall"]
    assert "deep in it, at (" in remedy.note
    (held,) = [each for each in solution.binding if each.obstacle == "wall"]
    assert held.place is not None
    assert held.place.segment == held.segment
    assert str(held.place) in str(solution.explain(0.0))


def test_a_thinner_body_fits() -> None:
    """Two plates 0.3 apart: the target is between them, and a body of radius 0.2 does not fit."""
    robot = sn.Robot.uniform(3, (0.8, 1.2), 2.0, radius=0.2)
    plates = [sn.Box((0.2, 0, 2.5), (0.1, 4, 1.5), name="right"), sn.Box((-0.2, 0, 2.5), (0.1, 4, 1.5), name="left")]
    solution = sn.solve(robot, sn.Target((0, 0, 2.5)), plates)
    assert solution.status is sn.Status.TARGET_BLOCKED
    remedies = helped(solution)
    assert 0.147 <= remedies["radius"].after <= 0.15 + 4e-4


HARD = sn.Robot.uniform(3, 1.0, math.pi)


def hard_poses() -> Iterator[sn.Target]:
    """Full poses of three segments that cannot stretch; each can be reached."""
    rng = np.random.default_rng(3)
    while True:
        q = np.column_stack([rng.normal(0.0, 1.2, (3, 2)), np.ones(3)])
        if HARD.excess(q) <= 0.0:
            tip = HARD.tip(q)
            yield sn.Target(tip[:3, 3], rotation=tip[:3, :3])


def test_starts_that_were_few_are_made_more() -> None:
    tried = (sn.solve(HARD, target, max_starts=1) for target in hard_poses())
    solution = next(each for each in tried if not each.solved)
    assert helped(solution)["max_starts"].after == 10


def test_another_method_may_do() -> None:
    solution = sn.solve(
        BENDY, sn.Target((0, 1, 2)), method=sn.methods.OptiPath(iterations=0, restarts=False, other_guess=False)
    )
    assert not solution.solved
    assert helped(solution)["method"].after == "newton"


def test_one_of_two_targets_is_dropped() -> None:
    solution = sn.solve(BENDY, [sn.Target((1, 0, 2)), sn.Target((-1, 0, 2))], max_starts=20)
    assert {"target 1", "target 2"} <= set(helped(solution))


def test_remedies_solve_what_they_say() -> None:
    """What is told is what a user then types, so it must work with nothing but that."""
    for seed in range(4):
        rng = np.random.default_rng(seed)
        target = sn.Target(rng.normal((0, 0, 1.5)), direction=rng.normal(size=3))
        solution = sn.solve(ROBOT, target, max_starts=20)
        assert not solution.solved
        for remedy in solution.explain(time=ENOUGH).remedies:
            after, own = remedy.after, remedy.problem
            assert own is not None
            scene, start = sn.Scene.of(own.scene), remedy.start
            again = sn.solve(own.robot, own.targets, scene, tolerance=own.tolerance, initial=start, max_starts=20)
            assert again.solved
            if remedy.change in ("target position", "target direction"):
                changed = target.changed(**{remedy.change.removeprefix("target "): after})
                assert sn.solve(ROBOT, changed, max_starts=20).solved
            elif remedy.change.endswith("of all segments"):
                key = remedy.change.partition(" ")[0]
                robot = sn.Robot([ROBOT.segments[0].changed(**{key: after})] * 3, radius=0.1)
                assert sn.solve(robot, target, max_starts=20).solved


def test_it_is_the_same_each_time_and_elsewhere() -> None:
    solution = sn.solve(ROBOT, sn.Target((2.5, 0, 0.5)))
    first = solution.explain(time=ENOUGH)
    assert solution.explain(time=ENOUGH) == first
    assert pickle.loads(pickle.dumps(solution)).explain(time=ENOUGH) == first
    assert pickle.loads(pickle.dumps(first)) == first


def test_without_time_nothing_is_told_that_was_not_tried() -> None:
    explanation = sn.solve(ROBOT, sn.Target((0, 0, 3.5))).explain(time=0.0)
    assert explanation.remedies == ()
    assert not explanation.complete
    assert "The time was too short to try everything" in str(explanation)


def scanned() -> sn.PointCloud:
    """A wall of points."""
    x, z = np.meshgrid(np.linspace(-4.0, 4.0, 81), np.linspace(-2.0, 5.0, 71))
    return sn.PointCloud(np.stack([x.ravel(), np.full(x.size, 0.8), z.ravel()], axis=-1), 0.08, name="scan")


def test_a_cloud_gives_way_at_a_place_and_not_as_a_whole() -> None:
    obstacle = scanned()
    solution = sn.solve(BENDY, sn.Target((0, 1.6, 1.6)), [obstacle], max_starts=20, routes=False)
    assert not solution.solved
    remedies = {remedy.change: remedy for remedy in solution.explain(60.0).remedies}
    remedy = remedies["obstacle scan gives way"]
    assert "obstacle scan" not in remedies
    where = np.array(remedy.after["position"])
    assert abs(where[1] - 0.8) < 0.3
    assert remedy.after["radius"] < 1.5
    assert remedy.problem is not None
    again = sn.solve(BENDY, remedy.problem.targets, remedy.problem.scene.obstacles, max_starts=200)
    assert again.solved
    assert again.verify().ok


def test_places_of_remedies_count_segments_of_the_arm() -> None:
    """Before, they counted joints as well: `at the end of segment 4` of an arm of two segments."""
    arm = sn.Robot([sn.Segment(1.0, 2.0, radius=0.05)] * 2, joints=[sn.Revolute(), sn.Revolute((0, 1, 0))])
    post = sn.Box((0.0, 0.0, 1.5), (0.4, 0.4, 0.4), name="post")
    explanation = sn.solve(arm, sn.Target((0.0, 0.0, 1.5)), [post]).explain(time=ENOUGH)
    (without,) = (each for each in explanation.remedies if each.change == "obstacle post")
    assert re.search(r"deep in it, .* segment 2$", without.note)
