"""Rates are kept by every call that writes times, or the motion says that they are not: judged by differences."""

import numpy as np
import pytest

import sinuous as sn
from sinuous.model.rates import least
from tests.helpers import refused
from tests.motion import timed_judge

ROBOT = sn.Robot.uniform(3, (40.0, 60.0), 2.0, radius=4.0, tendons=sn.Tendons(3, radius=3.0))
START = np.array([[0.0, 0.0, 50.0]] * 3)
GOAL = np.array([[0.9, 0.3, 45.0], [-0.8, 0.2, 58.0], [0.5, -1.0, 50.0]])
BALL = sn.Sphere((40.0, 0.0, 60.0), 10.0)
TARGETS = [sn.Target((60.0, y, 90.0)) for y in (-20.0, 0.0, 20.0)]
SLOW = sn.Rates(bend=0.1, length=2.0)


def fastest(motion: sn.Motion) -> dict[str, float]:
    """Largest speeds of a motion, by differences."""
    pulled = np.diff(motion.robot.to_actuators(motion.q), axis=0) / np.diff(motion.times)[:, None]
    return dict(zip(("bend", "length", "actuator"), (*timed_judge.fastest(motion), np.abs(pulled).max()), strict=True))


def keeps(motion: sn.Motion, rates: sn.Rates) -> bool:
    limits = {"bend": rates.bend, "length": rates.length, "actuator": rates.actuator}
    seen = fastest(motion)
    return all(seen[key] <= least(most) * (1.0 + 1e-9) for key, most in limits.items() if most is not None)


@pytest.mark.parametrize("rates", [SLOW, sn.Rates(actuator=0.5), sn.Rates(bend=0.05, actuator=3.0)])
def test_plans_and_tracks_are_as_fast_as_rates_allow(rates: sn.Rates) -> None:
    for motion in (
        sn.plan(ROBOT, START, GOAL, [BALL], rates=rates),
        sn.track(ROBOT, TARGETS, [BALL], start=START, rates=rates),
    ):
        assert motion.solved
        assert keeps(motion, rates)
        tight = max(
            fastest(motion)[key] / getattr(rates, key) for key in ("bend", "length", "actuator") if getattr(rates, key)
        )
        assert tight == pytest.approx(1.0)
        nominal = motion.with_times(np.linspace(0.0, 1.0, len(motion.times)))
        assert not keeps(nominal, rates)


def test_a_duration_is_kept_or_refused() -> None:
    long = sn.plan(ROBOT, START, GOAL, rates=SLOW, duration=60.0)
    assert long.solved
    assert long.times[-1] == pytest.approx(60.0)
    short = sn.plan(ROBOT, START, GOAL, rates=SLOW, duration=1.0)
    assert str(short.status) == "rate_bound"
    assert not short.solved
    assert keeps(short, SLOW)
    assert "too short for the rates" in str(short)
    path = sn.track(ROBOT, TARGETS, start=START, duration=90.0, rates=SLOW)
    assert path.solved
    assert path.times[-1] == pytest.approx(90.0)
    assert keeps(path, SLOW)
    plain = sn.track(ROBOT, TARGETS, duration=7.0)
    assert plain.times[[0, -1]] == pytest.approx([0.0, 7.0])


def test_times_that_were_asked_for_stay_or_are_refused() -> None:
    when = [10.0, 40.0, 90.0]
    kept = sn.track(ROBOT, TARGETS, times=when, rates=SLOW)
    assert kept.solved
    np.testing.assert_allclose(kept.times[[knot for knot in kept.waypoint_knots if knot is not None]], when)
    late = sn.track(ROBOT, TARGETS, times=[0.0, 0.1, 0.2], rates=SLOW)
    assert str(late.status) == "rate_bound"
    assert keeps(late, SLOW)
    refused("duration", lambda: sn.track(ROBOT, TARGETS, times=when, duration=3.0), "one of duration, times")


def test_accelerations_hold_at_the_knots() -> None:
    rates = sn.Rates(bend=0.5, length=20.0, acceleration=sn.Rates(bend=0.2, length=5.0))
    motion = sn.track(ROBOT, TARGETS, [BALL], start=START, rates=rates)
    bends, lengths = timed_judge.hardest(motion)
    assert bends <= 0.2 * (1.0 + 1e-9)
    assert lengths <= 5.0 * (1.0 + 1e-9)
    assert max(bends / 0.2, lengths / 5.0) == pytest.approx(1.0)
    assert keeps(motion, rates)
