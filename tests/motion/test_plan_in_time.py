"""Plans past obstacles that move: judged by sampling, in time, within rates; and honest where there is none."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.motion.plan import PlanArguments
from tests.helpers import present, refused
from tests.motion.timed_judge import fastest, hardest, least_clearance

ROBOT = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, max_bend=2.5)
LEFT, RIGHT = (np.tile([bend, 0.0, 1.0], (3, 1)) for bend in (0.6, -0.6))
RATES = sn.Rates(bend=0.8, length=0.3)
LEAVING = sn.Moving(sn.Sphere((0, 0, 0), 0.4), [0, 2, 4], [(0, 0, 2.2), (0, 0, 2.2), (0, 3, 2.2)])
CROSSING = sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 1, 2, 3], [(0, y, 2.4) for y in (2.0, 0.0, 0.0, -2.0)])
TURNING = sn.Moving(
    sn.Box((0, 1.5, 0), (0.2, 3.0, 0.2)), [0, 2, 4, 6], [(0, 0, 2.5)] * 4, np.stack([(1, 0, 0, 0), (1, 0, 0, 1)] * 2)
)
PLACES = {"leaving": [LEAVING], "crossing": [CROSSING], "turning": [TURNING], "two": [LEAVING, CROSSING]}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(
    "timing", [{"duration": 5.0}, {"rates": RATES}, {"rates": RATES, "duration": 8.0, "begin": 1.0}]
)
def test_a_plan_is_clear_at_all_times_and_keeps_the_rates(place: str, timing: PlanArguments) -> None:
    motion = sn.plan(ROBOT, LEFT, RIGHT, PLACES[place], **timing)
    assert motion.solved
    np.testing.assert_array_equal(motion.q[[0, -1]], [LEFT, RIGHT])
    assert motion.times[0] == timing.get("begin", 0.0)
    if "duration" in timing:
        assert motion.times[-1] == pytest.approx(motion.times[0] + timing["duration"])
    least = least_clearance(motion)
    assert 0.0 < present(motion.clearance) <= least + 1e-9
    if "rates" in timing:
        bend, length = fastest(motion)
        assert bend <= 0.8 * (1 + 1e-6)
        assert length <= 0.3 * (1 + 1e-6)
    again = sn.Motion(ROBOT, motion.q, PLACES[place], motion.times)
    assert again.solved


@pytest.mark.parametrize(
    ("place", "timing", "gains"),
    [
        ("crossing", {}, (8.0, 2.0)),
        ("turning", {}, (0.9, 0.3)),
        ("crossing", {"duration": 9.0, "begin": 0.5}, (0.9, 0.3)),
    ],
)
def test_a_plan_keeps_accelerations(place: str, timing: PlanArguments, gains: tuple[float, float]) -> None:
    rates = sn.Rates(bend=0.8, length=0.3, acceleration=sn.Rates(bend=gains[0], length=gains[1]))
    asked: PlanArguments = {**timing, "rates": rates, "time": 20.0}
    motion = sn.plan(ROBOT, LEFT, RIGHT, PLACES[place], **asked)
    assert motion.solved
    np.testing.assert_array_equal(motion.q[[0, -1]], [LEFT, RIGHT])
    for most, limits in ((fastest(motion), (0.8, 0.3)), (hardest(motion), gains)):
        assert most[0] <= limits[0] * (1 + 1e-6)
        assert most[1] <= limits[1] * (1 + 1e-6)
    assert hardest(motion)[0] > 0.1 * gains[0]  # it is near what is allowed: the judge sees something
    assert 0.0 < present(motion.clearance) <= least_clearance(motion) + 1e-9
    if timing:
        assert motion.times[[0, -1]].tolist() == [0.5, 9.5]


@pytest.mark.parametrize("gain", [None, 0.4])
def test_a_plan_keeps_rates_of_motors_that_stretch(gain: float | None) -> None:
    tendons = sn.Tendons(3, 0.04, stiffness=40.0)
    soft = sn.Robot([sn.Segment(1.0, max_bend=2.5, radius=0.05, stiffness=1.0, tendons=tendons)] * 3)
    rates = sn.Rates(bend=0.8, actuator=0.06, acceleration=None if gain is None else sn.Rates(actuator=gain))
    motion = sn.plan(soft, LEFT, RIGHT, PLACES["crossing"], rates=rates, time=20.0)
    assert motion.solved
    most = 0.0
    for one, other, time in zip(motion.q[:-1], motion.q[1:], np.diff(motion.times).tolist(), strict=True):
        values = soft.to_actuators(one + np.linspace(0.0, 1.0, 201)[:, None, None] * (other - one))
        most = max(most, float(np.abs(np.diff(values, axis=0)).max()) * 200.0 / time)
    assert 0.04 < most <= 0.06 * (1.0 + 1e-6)
    if gain is not None:
        times = np.diff(motion.times)
        still = np.zeros((1, 9))
        speeds = np.concatenate([still, np.diff(motion.actuators, axis=0) / times[:, None], still])
        beside = 0.5 * (np.append(0.0, times) + np.append(times, 0.0))
        assert np.abs(np.diff(speeds, axis=0) / beside[:, None]).max() <= gain * (1.0 + 1e-6)


def test_waiting_is_what_leads_past_an_obstacle_that_leaves() -> None:
    """The straight way at full speed is not clear; the plan takes longer than it, and less than a second too long."""
    fast = sn.Motion(ROBOT, [LEFT, RIGHT], [LEAVING], times=[0.0, 1.5])
    assert not fast.solved
    motion = sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], rates=RATES)
    assert 1.5 < motion.times[-1] < 4.0


def test_a_target_is_solved_where_obstacles_are_when_the_motion_ends() -> None:
    target = sn.Target((-1.2, 0.0, 1.8))
    for timing in ({"duration": 4.0}, {"rates": RATES}):
        motion = sn.plan(ROBOT, LEFT, target, [CROSSING], **timing)
        assert motion.solved
        (solution,) = motion.solutions
        assert len(solution.problem.scene) == 1
        assert solution.problem.scene.equals(motion.scene.at(float(motion.times[-1])))
        assert solution.verify().ok
        assert least_clearance(motion) > 0.0


def test_where_no_motion_is_found_the_status_says_why() -> None:
    hit = sn.Moving(sn.Sphere((0, 0, 0), 0.5), [0, 1], [(9, 0, 0), tuple(ROBOT.tip(RIGHT)[:3, 3])])
    assert sn.plan(ROBOT, LEFT, RIGHT, [hit], duration=3.0).status is sn.Status.TARGET_BLOCKED
    assert sn.plan(ROBOT, RIGHT, LEFT, [hit], duration=3.0, begin=1.0).status is sn.Status.START_BLOCKED
    assert sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], duration=1.0, rates=RATES).status is sn.Status.RATE_BOUND
    wall = sn.Box(ROBOT.tip(RIGHT)[:3, 3], (0.1, 0.1, 0.1))
    assert sn.plan(ROBOT, LEFT, RIGHT, [wall, LEAVING], rates=RATES).status is sn.Status.TARGET_BLOCKED
    hunted = sn.Moving(sn.Sphere((0, 0, 0), 0.3), [0, 0.4, 9], [(2, 0, 0.5), (0, 0, 0.5), (0, 0, 0.5)])
    motion = sn.plan(ROBOT, LEFT, RIGHT, [hunted], time=0.3, rates=RATES)
    assert motion.status is sn.Status.TIME_LIMIT
    assert len(motion.q) == 1
    assert motion.times.tolist() == [0.0]


def test_among_obstacles_that_stand_still_a_plan_may_have_times() -> None:
    ball = sn.Sphere((0, 3, 2.0), 0.3)
    motion = sn.plan(ROBOT, LEFT, RIGHT, [ball], begin=2.0, duration=3.0)
    assert motion.times[[0, -1]].tolist() == [2.0, 5.0]
    paced = sn.plan(ROBOT, LEFT, RIGHT, [ball], begin=2.0, rates=RATES)
    assert paced.solved
    assert paced.times[0] == 2.0
    assert fastest(paced)[0] == pytest.approx(RATES.bend)


def test_what_is_wrong_is_refused() -> None:
    refused("rates", lambda: sn.plan(ROBOT, LEFT, RIGHT, [LEAVING]))
    refused("rates", lambda: sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], rates=3.0))  # type: ignore[arg-type]
    refused("rates.bend", lambda: sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], rates=sn.Rates(bend=(1, 2))))
    refused("duration", lambda: sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], duration=0.0))
    refused("begin", lambda: sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], duration=1.0, begin=float("inf")))
    both = sn.Rates(bend=1.0, acceleration=sn.Rates(bend=(1, 2)))
    refused("rates.acceleration.bend", lambda: sn.plan(ROBOT, LEFT, RIGHT, [LEAVING], rates=both))
