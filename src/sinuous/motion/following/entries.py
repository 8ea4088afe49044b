"""What a waypoint added to a motion, as plain values, and back: with these an interrupted motion goes on."""

from typing import Any, NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.query import ANSWER_WIDTH
from sinuous.kernels.tables import Outcome
from sinuous.motion.following.knots import Knot


class Entry(NamedTuple):
    """What a waypoint added.

    Attributes
    ----------
    outcome : Outcome
        Of its solve.
    solve_seconds : float
        Of that alone.
    knots : list of Knot
        Those that lead there. They stay where they are.
    reconfigured : bool
    approaches : bool
        Whether the way from the start to the first waypoint is a step of its own.
    seconds : float
        Of all the work up to here.
    """

    outcome: Outcome
    solve_seconds: float
    knots: list[Knot]
    reconfigured: bool
    approaches: bool
    seconds: float


def write_entry(entry: Entry) -> dict[str, Any]:
    """Return plain values, numbers to the last digit; some may be infinite or NaN."""
    knots = [[knot.q.tolist(), None if knot.came is None else knot.came[0].tolist(), knot.time] for knot in entry.knots]
    return {**entry._asdict(), "outcome": write_outcome(entry.outcome), "knots": knots}


def read_entry(values: dict[str, Any], segments: int) -> Entry:
    """Return what `write_entry` wrote.

    Raises
    ------
    KeyError, TypeError, ValueError
        When it is something else.
    """
    knots = [
        Knot(
            _configuration(q, segments),
            None if came is None else np.array(came, np.float64).reshape(1, ANSWER_WIDTH),
            fixed=True,
            time=float(time),
        )
        for q, came, time in values["knots"]
    ]
    rest = {key: values[key] for key in ("solve_seconds", "reconfigured", "approaches", "seconds")}
    return Entry(read_outcome(values["outcome"], segments), knots=knots, **rest)


def write_outcome(outcome: Outcome) -> dict[str, Any]:
    """Return what was found by a solve as plain values; see `write_entry`."""
    entries = outcome._asdict().items()
    return {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in entries}


def read_outcome(values: dict[str, Any], segments: int) -> Outcome:
    """Return what `write_outcome` wrote; see `read_entry`."""
    route = None if values["route"] is None else np.array(values["route"], np.float64).reshape(-1, 3)
    return Outcome(**{**values, "q": _configuration(values["q"], segments), "route": route})


def _configuration(values: list[list[float]], segments: int) -> Floats:
    return np.array(values, np.float64).reshape(segments, 3)
