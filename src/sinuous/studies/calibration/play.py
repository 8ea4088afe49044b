"""Play of actuators: how far a motor turns back before the tip follows, as friction makes it, too.

A displacement stays where it is until the motor is more than half of the play away from it (the play operator: Brokate
& Sprekels 1996, Hysteresis and Phase Transitions). So it depends on the motion before; rows are in the order of time.
"""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.model.actuators import Motors
from sinuous.model.robot import Robot
from sinuous.studies.calibration.fit import FitState, errors, fitted, left_out
from sinuous.studies.calibration.measurements import Measurements
from sinuous.studies.calibration.parameters import lines_of

TRIED = 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08
"""Plays that are tried first: of the largest range of a tendon."""

REFINED = 2.0**-0.5, 2.0**0.5
"""And of the best of these, afterwards."""

RISEN = 1.2
"""Times the least error from which on larger plays are not tried."""

FEWEST_ROWS = 20
"""Rows from which on play is looked for."""

TRIAL_STEPS = 3
"""Most steps of a fit that tries one."""


def after_play(motors: Motors, lines: Floats, actuators: Floats, play: float) -> Floats:
    """Values (N, m) that motors without play would have, of rows in the order of time; `lines` (m,) is 1 for what has.

    `play` is that of displacements, in the length unit.
    """
    half = 0.5 * play * lines
    displaced = motors.displacements(actuators)
    result = np.empty_like(displaced)
    now = displaced[0]
    for i, there in enumerate(displaced):
        now = result[i] = np.clip(now, there - half, there + half)
    return motors.values(result)


def rows_after_play(drawn: Robot, rows: Measurements, play: float) -> Measurements:
    """The same rows with the values that motors without play would have."""
    if play == 0.0:
        return rows
    return rows._replace(actuators=after_play(drawn.drive.motors, lines_with_play(drawn), rows.actuators, play))


def lines_with_play(robot: Robot) -> Floats:
    """Which actuators (m,) have play: tendons and chambers."""
    lines = np.zeros(len(robot.drive))
    lines[lines_of(robot)[0]] = 1.0
    return lines


def find_play(drawn: Robot, state: FitState, rows: Measurements, chosen: slice) -> tuple[float, float, float]:
    """The play with which held-back rows are off by the least, their mean error without it, and with it."""
    places = lines_of(drawn)[0]
    if not len(places) or len(rows.labels) < FEWEST_ROWS:
        return 0.0, 0.0, 0.0
    largest = float(np.ptp(drawn.drive.motors.displacements(rows.actuators)[:, places], axis=0).max())

    def error_of(play: float) -> float:
        part = rows_after_play(drawn, rows, play).part(chosen)
        return float(errors(left_out(fitted(drawn, state, part, TRIAL_STEPS), part, drawn)).mean())

    before, best, least = error_of(0.0), 0.0, np.inf
    for play in (largest * each for each in TRIED):
        after = error_of(play)
        best, least = (play, after) if after < least else (best, least)
        if after > RISEN * min(least, before):
            break
    for play in (best * each for each in REFINED):
        after = error_of(play)
        best, least = (play, after) if after < least else (best, least)
    return best, before, least
