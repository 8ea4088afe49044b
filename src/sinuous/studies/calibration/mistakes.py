"""Mistakes that tables of measurements have: exchanged columns, signs, units, rows that are late.

Each is tried on the robot as drawn, aligned with the rows. One that leaves less error than the fit did is told, not
mended.
"""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sinuous.base import words
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.model.robot import Robot
from sinuous.studies.calibration.fit import begun, errors, predict
from sinuous.studies.calibration.measurements import UNIT_FACTORS, Measurements

LEAST_ERROR = 0.03
"""Median error of a fit, in lengths of the robot, from which on mistakes are looked for."""

EXPLAINED = 0.5
"""Share of that error that the drawn robot has at most without the mistake, where it is told."""

MOST_ROWS, MOST_LOADED_ROWS = 120, 20
"""Rows with which mistakes are tried; of a robot under load, each of which is an equilibrium."""

MOST_DELAY = 3
"""Most rows that a stream of measurements may be late or early."""


def find_mistake(drawn: Robot, rows: Measurements, levelled: bool, left: float) -> str | None:
    """Say which mistake explains most of the median error that a fit has left, if one does."""
    if left <= LEAST_ERROR * drawn.mean_length:
        return None
    most = MOST_LOADED_ROWS if drawn.has_external_load else MOST_ROWS
    chosen = np.zeros(len(rows.actuators), np.bool_)
    chosen[:: max(1, len(chosen) // most)] = True

    def error_of(actuators: Floats) -> float:
        part = rows._replace(actuators=actuators).part(chosen)
        try:
            residuals = predict(drawn, begun(drawn, part, levelled), part) - part.points
        except (InputError, np.linalg.LinAlgError, OverflowError):
            return np.inf
        return float(np.median(errors(np.where(np.isfinite(residuals), residuals, 0.0))))

    after, said = min((error_of(actuators), text) for text, actuators in _candidates(drawn, rows))
    if after > EXPLAINED * left:
        return None
    return f"{said} would explain these rows: the median error is {after:.3g} then, and {left:.3g} as it is fitted"


def _candidates(drawn: Robot, rows: Measurements) -> Iterator[tuple[str, Floats]]:
    """Yield what may be wrong, and the actuator values (N, m) if it is."""
    own, names = rows.actuators, [actuator.name for actuator in drawn.actuators]
    for i, j in combinations(range(len(names)), 2):
        order = list(range(len(names)))
        order[i], order[j] = j, i
        yield f"exchanging the columns {names[i]} and {names[j]}", own[:, order]
    for i, name in enumerate(names):
        turned = own.copy()
        turned[:, i] *= -1.0
        yield f"turning the sign of {name}", turned
    yield "turning the signs of all actuators", -own
    for factor in UNIT_FACTORS:
        yield f"actuator values times {factor:g}", own * factor
    for rows_late in (*range(1, MOST_DELAY + 1), *range(-MOST_DELAY, 0)):
        word = "late" if rows_late > 0 else "early"
        yield f"measurements that come {words.counted(abs(rows_late), 'row')} {word}", np.roll(own, rows_late, axis=0)
