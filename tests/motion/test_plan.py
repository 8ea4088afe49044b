"""Plans: from a start to a target or a configuration, clear all the way, or an honest status."""

import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from benchmarks.judges.judge import wrong_in
from sinuous.kernels.certificate.query import CLEARANCES
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, PROVED_BOUND
from sinuous.motion.planning import planners
from sinuous.solver.certificates.steps import prove_steps
from tests.helpers import present, refused
from tests.motion.planning.places import STRETCHING as ROBOT
from tests.motion.planning.places import pair

STRAIGHT = [[0.0, 0.0, 1.0]] * 4


def test_a_plan_to_a_configuration_is_proved_and_judged_clear() -> None:
    knots = []
    for seed in range(12):
        scene, (start, goal) = pair(seed)
        motion = sn.plan(ROBOT, start, goal, scene)
        assert motion.solved, seed
        assert motion.between == "proved"
        np.testing.assert_array_equal(motion.q[[0, -1]], [start, goal])
        np.testing.assert_array_equal(motion.times[[0, -1]], [0.0, 1.0])
        again = prove_steps(ROBOT, scene.snapshot(), motion.q)
        assert again.proved.all()
        tight = prove_steps(ROBOT, scene.snapshot(), motion.q, slack=0.01).clearances.min()
        assert motion.clearance is not None
        assert max(0.0, 0.89 * tight) < motion.clearance
        assert motion.clearance == pytest.approx(again.clearances.min(), rel=0.2)
        own = again.answers[:, CLEARANCES + CLEARANCES_WIDTH + PROVED_BOUND].min()
        assert present(motion.self_clearance) == pytest.approx(own, rel=0.2)
        assert wrong_in(ROBOT, scene, motion.q) == ""
        assert max(ROBOT.excess(q) for q in motion.q) < 1e-12
        knots.append(len(motion.q))
    assert max(knots) > 2  # not all of them are straight


def test_plans_among_many_obstacles_list_who_is_near_and_stay_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, (start, goal) = pair(3)
    rods = [sn.Capsule((8.0, i, 0.0), (8.0, i, 1.0), 0.1) for i in range(48)]
    motions = []
    for easy in (planners.EASY, 0):
        monkeypatch.setattr(planners, "EASY", easy)
        crowded = sn.Scene([*scene.obstacles, *rods])
        motions.append(sn.plan(ROBOT, start, goal, crowded).q)
    assert crowded.snapshot()._listed is not None
    assert len(motions[0]) > 2
    np.testing.assert_array_equal(motions[0], motions[1])


@pytest.mark.parametrize("gap", [1e-5, 1e-3])
def test_ends_near_to_contact_are_left_by_clear_motions(gap: float) -> None:
    inside = np.array([[0.5, 0.2, 1.0], [-0.7, 0.3, 1.0], [0.4, -0.6, 1.0], [0.3, 0.5, 1.0]])
    outside = np.array([[0.4, 0.0, 1.0], [0.4, 0.0, 1.0], [0.3, 0.1, 1.0], [0.2, 0.0, 1.0]])
    place = ROBOT.forward(inside)[2]
    scene = sn.Scene([sn.Sphere(place[:3, 3] + (0.35 + gap) * place[:3, 0], 0.3)])
    assert least_clearance(ROBOT, scene, inside[None])[0] == pytest.approx(gap, abs=1e-6)
    for ends in ((inside, outside), (outside, inside)):
        motion = sn.plan(ROBOT, *ends, scene)
        assert motion.solved
        assert wrong_in(ROBOT, scene, motion.q) == ""


def length(motion: sn.Motion) -> float:
    """Length of a motion in which a bend counts by what is beyond it."""
    levers = np.arange(3, -1, -1) + 0.5
    steps = np.diff(motion.q, axis=0) * np.stack([levers, levers, np.ones(4)], axis=-1)
    return float(np.sqrt((steps**2).sum(axis=(1, 2))).sum())


def test_shortcuts_make_no_motion_longer_and_leave_it_clear() -> None:
    shorter = 0
    for seed in range(8):
        scene, (start, goal) = pair(seed)
        plain, tight = (sn.plan(ROBOT, start, goal, scene, shortcuts=count) for count in (0, 30))
        assert tight.between == "proved"
        assert prove_steps(ROBOT, scene.snapshot(), tight.q).proved.all()
        assert length(tight) <= length(plain) + 1e-9
        shorter += length(tight) < 0.99 * length(plain)
    assert shorter > 0


def test_a_plan_to_a_target_ends_there() -> None:
    for seed in range(6):
        scene, (start, goal) = pair(seed)
        tip = ROBOT.tip(goal)
        motion = sn.plan(ROBOT, start, sn.Target(tip[:3, 3], direction=tip[:3, 2]), scene)
        assert motion.solved
        (solution,) = motion.solutions
        np.testing.assert_array_equal(motion.q[-1], solution.q)
        assert motion.waypoint_knots == (len(motion.q) - 1,)
        assert solution.verify().ok
        assert wrong_in(ROBOT, scene, motion.q) == ""


def test_several_targets_are_met_at_once_and_a_solution_is_a_configuration() -> None:
    scene, (start, goal) = pair(0)
    ends = ROBOT.forward(goal)
    targets = [sn.Target(ends[1, :3, 3], segment=2), sn.Target(ends[3, :3, 3])]
    motion = sn.plan(ROBOT, start, targets, scene)
    assert motion.solved
    assert len(motion.solutions[0].problem.targets) == 2
    back = sn.plan(ROBOT, motion.solutions[0], start, scene)
    assert back.solved
    assert sn.plan(ROBOT, start, motion.solutions[0], scene).solved


def test_the_same_seed_gives_the_same_motion() -> None:
    scene, (start, goal) = next((s, e) for s, e in map(pair, range(20)) if len(sn.plan(ROBOT, e[0], e[1], s).q) > 2)
    one, other = (sn.plan(ROBOT, start, goal, scene, seed=3) for _ in range(2))
    np.testing.assert_array_equal(one.q, other.q)
    planner = sn.Planner(ROBOT, scene, seed=3)
    for _ in range(2):
        np.testing.assert_array_equal(planner.plan(start, goal).q, one.q)


def test_threads_share_a_planner() -> None:
    scene, ends = pair(0)
    goals = [ends[1], *(other for seed in range(1, 6) for other in pair(seed)[1])]
    planner = sn.Planner(ROBOT, scene)
    alone = [planner.plan(ends[0], goal) for goal in goals]
    assert sum(motion.solved for motion in alone) > 1
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(partial(planner.plan, ends[0]), goals * 4))
    for one, other in zip(alone * 4, together, strict=True):
        assert one.status is other.status
        np.testing.assert_array_equal(one.q, other.q)


def test_a_start_that_is_blocked_is_said_to_be() -> None:
    ball = [sn.Sphere((0.0, 0.0, 2.0), 0.3, name="ball")]
    bent, beyond, curled = ([[2.0, 0.0, 1.0]] * 4, [[0.0, 0.0, 1.5]] * 4, [[2.8, 0.0, 1.0]] * 4)
    for start, goal, scene, constraint in (
        (STRAIGHT, bent, ball, "clearance"),
        (beyond, STRAIGHT, [], "length"),
        (curled, STRAIGHT, [], "self_clearance"),
    ):
        motion = sn.plan(ROBOT, start, goal, scene)
        assert (motion.status, motion.solved) == (sn.Status.START_BLOCKED, False)
        worst = present(motion.worst)
        assert (worst.constraint, worst.obstacle) == (constraint, "ball" if scene else None)


def test_a_goal_that_overlaps_is_blocked_and_one_beyond_its_limits_is_refused() -> None:
    ball = [sn.Sphere((0.0, 0.0, 2.0), 0.3, name="ball")]
    bent = [[1.0, 0.0, 1.0]] * 4
    motion = sn.plan(ROBOT, bent, STRAIGHT, ball)
    assert motion.status is sn.Status.TARGET_BLOCKED
    assert present(motion.worst).obstacle == "ball"
    words = "length of segment 1 is 0.3 beyond its limit; expected a configuration within all limits"
    refused("goal", lambda: sn.plan(ROBOT, bent, [[0.0, 0.0, 1.5]] * 4), words)


def test_what_was_not_found_is_not_called_impossible() -> None:
    """A plate between start and goal, too large to get round it."""
    robot = sn.Robot.uniform(2, 1.0, 2.0, radius=0.05)
    plate = [sn.Box((0.0, 0.0, 1.45), (0.02, 8.0, 2.0))]
    right, left = [[1.0, 0.0, 1.0], [0.0, 0.0, 1.0]], [[-1.0, 0.0, 1.0], [0.0, 0.0, 1.0]]
    began = time.process_time()  # other work on the machine does not count
    motion = sn.plan(robot, right, left, plate, time=0.1)
    assert time.process_time() - began < 1.0
    assert motion.status is sn.Status.TIME_LIMIT
    assert "not solved within the time budget" in str(motion)
    assert motion.seconds > 0.05
    assert sn.plan(robot, right, left, plate, time=0.0).status is sn.Status.TIME_LIMIT


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("shortcuts", -1, ": expected"),
        ("time", -1.0, ": expected"),
        ("pace", 1, ": unknown option; expected one of robot, start, goal, scene, tolerance"),
    ],
)
def test_wrong_options_are_refused(key: str, value: Any, words: str) -> None:
    refused(key, lambda: sn.plan(ROBOT, STRAIGHT, STRAIGHT, **{key: value}), words)


def test_wrong_ends_are_refused() -> None:
    refused("start", lambda: sn.plan(ROBOT, [[0, 0, 1]], STRAIGHT), "shape (1, 3); expected ", "3")
    refused("goal", lambda: sn.plan(ROBOT, STRAIGHT, [[0, 0, 1]]), "shape (1, 3); expected ", "3")
    two: Any = [sn.Target((0, 0, 3)), 4]
    refused("goal[1]", lambda: sn.plan(ROBOT, STRAIGHT, two), "expected a Target")
    refused("robot", lambda: sn.plan(None, STRAIGHT, STRAIGHT), "missing; expected a Robot")  # type: ignore[arg-type]


def test_another_unit_of_length_changes_nothing() -> None:
    """A unit that is a power of two: no product or sum is rounded otherwise."""
    unit = 1024.0
    robot = sn.Robot([sn.Segment((0.8, 1.2), 2.8, radius=0.1)] * 4)
    other = sn.Robot([sn.Segment((0.8 * unit, 1.2 * unit), 2.8, radius=0.1 * unit)] * 4)
    for seed in range(4):
        scene, (start, goal) = pair(seed, robot)
        balls = [ball for ball in scene.obstacles if isinstance(ball, sn.Sphere)]
        far = sn.Scene([sn.Sphere(unit * np.asarray(ball.center), unit * ball.radius) for ball in balls])
        to = np.array([1.0, 1.0, unit])
        motion, scaled = sn.plan(robot, start, goal, scene), sn.plan(other, start * to, goal * to, far)
        np.testing.assert_array_equal(scaled.q, motion.q * to)
        assert scaled.clearance == unit * present(motion.clearance)
        assert scaled.self_clearance == unit * present(motion.self_clearance)
