"""What is written at a rate: the ways of other programs between rows, held against dense samples of them."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import sinuous as sn
from benchmarks.judges.clearances import least_clearance
from sinuous.motion.resampling import splines_between

ROBOT = sn.Robot.uniform(2, (0.8, 1.2), 2.0, radius=0.05)
ONE, TOP, OTHER = (np.array([[x, 0.0, 1.0], [0.0, y, 1.0]]) for x, y in ((-0.8, 0.0), (0.0, 0.9), (0.8, 0.0)))
CORNER = np.stack([ONE, TOP, OTHER])
TIMES = np.array([0.0, 1.0, 2.0])
CHORD = ROBOT.tip(0.5 * (ONE + OTHER))[:3, 3]
POST = sn.Sphere(CHORD - (0, 0, 0.12), 0.1, name="post")
"""On the straight line that leaves the corner out, and clear of the motion around it."""


def motion(scene: list[sn.Sphere] | None = None) -> sn.Motion:
    return sn.Motion(ROBOT, CORNER, [POST] if scene is None else scene, TIMES)


def test_what_is_written_says_whether_it_is_proved(tmp_path: Path) -> None:
    """Samples at the ends alone: from one to the other a program goes straight, through the post."""
    whole = motion()
    assert whole.between == "proved"
    assert whole.to_csv(tmp_path / "knots.csv") is whole
    assert whole.to_ros(tmp_path / "knots.json") is whole
    for write, name in ((whole.to_csv, "rows.csv"), (whole.to_ros, "rows.json")):
        with pytest.warns(sn.SuspiciousInput, match="rate: 1 of 1 lines between rows are not proved clear"):
            written = write(tmp_path / name, rate=0.5)
        assert written.between == "unproved"
        assert not written.verify()[0].ok
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert write(tmp_path / name, rate=1.0).between == "proved"
            assert write(tmp_path / name, rate=37.0).between == "proved"


@pytest.mark.parametrize("rate", [0.7, 1.0, 2.3, 11.0])
def test_lines_are_as_clear_as_is_said(rate: float) -> None:
    rng = np.random.default_rng(int(10 * rate))
    knots = np.concatenate([rng.uniform(-0.4, 0.4, (6, 2, 2)), rng.uniform(0.8, 1.2, (6, 2, 1))], axis=-1)
    balls = [sn.Sphere(center, 0.2) for center in rng.normal(size=(6, 3)) * (0.5, 0.5, 0.3) + (0.9, 0, 1)]
    moved = sn.Motion(ROBOT, knots, balls, np.cumsum(rng.uniform(0.5, 2.0, 6)))
    again = moved.resampled(rate)
    for i in np.flatnonzero(again.steps.proved):
        shares = np.linspace(0.0, 1.0, 40)[:, None, None]
        sampled = least_clearance(ROBOT, sn.Scene(balls), (1 - shares) * again.q[i] + shares * again.q[i + 1]).min()
        assert 0.0 < again.steps.clearances[i] <= sampled + 1e-9


def test_splines_are_as_clear_as_is_said(tmp_path: Path) -> None:
    """A controller makes cubic splines of positions and velocities; these leave the lines where corners are blended."""
    rates = sn.Rates(bend=1.0, length=1.0, acceleration=sn.Rates(bend=3.0, length=3.0))
    seen = []
    for gap in (0.3, 0.05):
        tip = ROBOT.tip(TOP)
        ball = sn.Sphere(tip[:3, 3] + (0.15 + gap) * tip[:3, 2], 0.1)
        around = motion([ball])
        assert around.solved
        timed = around.timed(rates, 0.3)
        for rate in (None, 6.0):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", sn.SuspiciousInput)
                written = timed.to_ros(tmp_path / "way.json", rate=rate)
            velocities = timed.velocity(written.times)
            velocities[-1] = 0.0
            spline = CubicHermiteSpline(written.times, written.q, velocities)
            for i in np.flatnonzero(written.steps.proved):
                q = spline(np.linspace(written.times[i], written.times[i + 1], 30))
                assert written.steps.clearances[i] <= least_clearance(ROBOT, sn.Scene([ball]), q).min() + 1e-9
                assert ROBOT.excess(q) <= 1e-9
            seen.append(written.between)
    assert "proved" in seen


def test_a_spline_that_swings_out_is_not_proved() -> None:
    """The lines stay as they are, and the velocities at their ends point elsewhere."""
    straight = motion([POST])
    out = np.zeros_like(CORNER)
    assert splines_between(ROBOT, TIMES, CORNER, out, straight.steps).proved.all()
    out[1, 0, 0] = 30.0
    assert not splines_between(ROBOT, TIMES, CORNER, out, straight.steps).proved.any()
    own = ROBOT.changed(self_collision="allow")  # nothing is in the way, so limits alone decide
    free, long = sn.Motion(own, CORNER, times=TIMES), np.zeros_like(CORNER)
    for speed, kept in ((0.3, True), (3.0, False)):
        long[1, 0, 2] = speed
        assert (splines_between(own, TIMES, CORNER, long, free.steps).proved == kept).all()
