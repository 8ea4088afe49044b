"""How fast a robot may move."""

import math
import pickle
from typing import Any

import numpy as np
import pytest

import sinuous as sn
from sinuous.model.rates import Changes
from sinuous.motion.job import job_of
from tests.helpers import refused, with_each

ROBOT = sn.Robot.uniform(3, (45, 70), tendons=sn.Tendons(3, radius=3))


def test_one_number_is_for_all() -> None:
    own = sn.Rates(bend=1.5, actuator=(1, 2, 3, 4, 5, 6, 7, 8, 9)).spread(ROBOT)
    assert own.bend.tolist() == [1.5] * 3
    assert own.length.tolist() == [math.inf] * 3
    assert own.actuator.tolist() == [1, 2, 3, 4, 5, 6, 7, 8, 9]


def test_segments_and_actuators_have_rates_by_their_names() -> None:
    rates = sn.Rates(bend={"s2": 0.5}, actuator={"s3.t1": 4, "s1.t2": 2}, acceleration=sn.Rates(length={"s1": 3.0}))
    own = rates.spread(ROBOT)
    assert own.bend.tolist() == [math.inf, 0.5, math.inf]
    assert own.actuator.tolist() == [math.inf, 2, *[math.inf] * 4, 4, math.inf, math.inf]
    assert (2.0 * rates).spread(ROBOT).bend.tolist() == [math.inf, 1.0, math.inf]
    assert pickle.loads(pickle.dumps(rates)).equals(rates)
    job = sn.Job(ROBOT, sn.Target((0, 0, 170)), rates=rates)
    again = job_of(job.to_dict(), "")
    assert again.rates.equals(rates)
    with pytest.raises(sn.InputError, match=r"rates.acceleration.length: nothing is called 's_1'; did you mean 's1'"):
        sn.Job(ROBOT, sn.Target((0, 0, 170)), rates=sn.Rates(acceleration=sn.Rates(length={"s_1": 3.0})))


def test_rates_times_a_time_are_changes() -> None:
    rates = sn.Rates(bend=(1.0, 2.0, 3.0), length=20.0, acceleration=sn.Rates(bend=5.0))
    for changes in (rates * 0.01, 0.01 * rates):
        assert isinstance(changes, Changes)
        np.testing.assert_allclose(changes.spread(ROBOT).bend, [0.01, 0.02, 0.03])
        assert changes.length == pytest.approx(0.2)
        assert changes.actuator is None


@with_each(
    ("key", "given", "words"),
    [
        ("bend", {"bend": 0}, ": expected a number greater than 0, got 0"),
        ("length[1]", {"length": (1, -2)}, ": expected a number greater than 0, got -2.0"),
        ("actuator", {"actuator": math.inf}, ": expected a number greater than 0, got inf"),
        ("bend", {"bend": "fast"}, ": expected a number greater than 0, got 'fast'"),
        ("acceleration", {"acceleration": 1.0}, ": expected Rates, got 1.0"),
        ("acceleration.acceleration", {"acceleration": sn.Rates(acceleration=sn.Rates(1))}, ": expected"),
        ("bend.s1", {"bend": {"s1": 0}}, ": expected a number greater than 0, got 0"),
    ],
)
def test_bad_rates_are_refused_in_a_line(key: str, given: dict[str, Any], words: str) -> None:
    refused(key, lambda: sn.Rates(**given), words)


def test_bad_times_and_robots_of_rates_are_refused_in_a_line() -> None:
    refused("dt", lambda: sn.Rates(bend=1) * 0.0, ": expected a number greater than 0, got 0.0")
    refused("length", lambda: sn.Rates(length=(1, 2)).spread(ROBOT), ": expected one number, or 3, got [1.0, 2.0]")


def test_joints_keep_the_stricter_of_their_own_rates_and_those_given() -> None:
    roll = sn.Revolute(name="roll", rate=2.0, acceleration=3.0, body=[((0, 0, 0), (0, 0, 1), 0.1)])
    arm = sn.Robot([sn.Segment(1.0)], joints=[roll, sn.Prismatic((1, 0, 0), (0, 1), name="feed", rate=0.5)])
    rates = sn.Rates(bend=9.0, length=8.0, joint={"roll": 1.0, "feed": 0.7})
    own, further = rates.spread(arm), rates.further(arm)
    for spread, roll_most, feed_most, rest in ((own, 1.0, 0.5, (9.0, 8.0)), (further, 3.0, math.inf, (math.inf,) * 2)):
        assert spread is not None
        both = np.stack([spread.bend, spread.length], axis=1)
        at = [*zip(arm._rigid.values.tolist(), np.minimum(arm._rigid.columns, 1).tolist(), strict=True)]
        assert [both[place] for place in at] == [roll_most, feed_most]
        assert tuple(both[-1]) == rest
        assert np.isinf(both).sum() == both.size - np.isfinite([roll_most, feed_most, *rest]).sum()
    assert (rates * 0.1).spread(arm).bend[arm._rigid.values[0]] == pytest.approx(0.1)
    again = job_of(sn.Job(arm, sn.Target((0, 0, 2)), rates=rates).to_dict(), "").rates
    assert again.equals(rates)
    refused("joint", lambda: sn.Rates(joint={"s1": 1.0}).check(arm), "nothing is called 's1'")
