"""Motions in times within rates: every step takes as long as the robot needs for it.

A step is linear in q, so its speed is even. Where accelerations are limited, the speed changes at a knot by no more
than that in the mean of the durations beside it, at both ends in half of one, as for plans in time.
"""

import numpy as np

from sinuous.checks import Floats
from sinuous.motion.motion import Motion
from sinuous.motion.timing import largest
from sinuous.robot.rates import Rates
from sinuous.robot.robot import Robot
from sinuous.solution.status import Status

ROUNDING = 1e-9
"""Share of a duration that it may be too short by."""


def paced(motion: Motion, rates: Rates | None, duration: float | None = None, *, asked: bool = False) -> Motion:
    """Return a motion with times in which it keeps its rates; the same one where there is nothing to keep.

    Parameters
    ----------
    motion : Motion
    rates : Rates, optional
    duration : float, optional
        How long it has to take, with all that is saved for all steps alike.
    asked : bool
        Whether its times were asked for. Then they stay, as long as rates are kept; else all are longer by one factor,
        and the motion is `rate_bound`. Where obstacles move, which were looked at in these times, they stay in any
        case. By default a motion is as fast as rates allow, and what nothing limits takes as long as it did.
    """
    if not rates or len(motion.q) < 2:
        return motion
    least, given = least_durations(motion.robot, motion.q, rates), np.diff(motion.times)
    fixed = asked or duration is not None or motion.scene.moves
    durations = given if asked or motion.scene.moves else np.where(least > 0.0, least, given)
    if duration is not None and not motion.scene.moves:
        durations = durations * (duration / durations.sum())
    factor = max(1.0, float((least / durations).max()))
    factor = max(factor, _slower(motion.robot, motion.q, durations, rates))
    late = fixed and factor > 1.0 + ROUNDING
    times = motion.times
    if not motion.scene.moves:
        times = np.concatenate([times[:1], times[0] + np.cumsum(factor * durations)])
    solved = motion.status in (Status.SOLVED, Status.UNPROVED)
    return motion.with_times(times, Status.RATE_BOUND if late and solved else None)


def least_durations(robot: Robot, q: Floats, rates: Rates) -> Floats:
    """How long each step between knots (T, n, 3) takes at least (T - 1,); 0 where no speed is limited."""
    least: Floats = 1.0 / largest(robot, rates.spread(robot), np.diff(q, axis=0))
    return least


def _slower(robot: Robot, q: Floats, durations: Floats, rates: Rates) -> float:
    """By which factor all durations (T - 1,) have to be longer for the accelerations."""
    if rates.acceleration is None:
        return 1.0
    still = np.zeros((1, *q.shape[1:]))
    speeds = np.concatenate([still, np.diff(q, axis=0) / durations[:, None, None], still])
    beside = np.concatenate([[0.0], durations, [0.0]])
    means = 0.5 * (beside[1:] + beside[:-1])
    most = largest(robot, rates.acceleration.spread(robot), np.diff(speeds, axis=0) / means[:, None, None])
    return float(np.sqrt(max(1.0, (1.0 / most).max())))
