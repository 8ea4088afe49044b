"""Motions as arrays: configurations between knots, samples, and NPZ files."""

from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.robot.robot import Robot

if TYPE_CHECKING:
    from sinuous.motion.motion import Motion


def interpolate(times: Floats, q: Floats, when: Floats) -> Floats:
    """Return configurations (..., n, 3) at times (...) within those of the knots `q` (T, n, 3), linear between them."""
    if len(q) == 1:
        return np.broadcast_to(q[0], (*when.shape, *q.shape[1:])).copy()
    i = np.clip(np.searchsorted(times, when, side="right") - 1, 0, len(q) - 2)
    share = ((when - times[i]) / (times[i + 1] - times[i]))[..., None, None]
    result: Floats = (1.0 - share) * q[i] + share * q[i + 1]
    return result


def samples(times: Floats, rate: float) -> Floats:
    """Return times at a rate (1 / time), from the first knot on; the last one is the last knot."""
    count = int(np.ceil((times[-1] - times[0]) * rate - 1e-9)) if len(times) else 0
    return np.append(times[0] + np.arange(count) / rate, times[-1]) if len(times) else times


def save(motion: "Motion", file: str | Path) -> None:
    """Write a motion as NPZ; see `Motion.to_npz`."""
    values = {
        "q": motion.q,
        "times": motion.times,
        "actuators": motion.actuators,
        "actuator_names": np.array([actuator.name for actuator in motion.robot.actuators], np.str_),
        "proved": motion.steps.proved,
    }
    try:
        with Path(file).open("wb") as out:
            np.savez_compressed(out, allow_pickle=False, **values)
    except OSError as error:
        raise InputError(
            "file", f"cannot be written: {error.strerror}", str(file), "a file that can be written"
        ) from None


def load(file: str | Path, robot: Robot) -> tuple[Floats, Floats]:
    """Read knots (T, n, 3) and times (T,) of an NPZ file; see `Motion.from_npz`."""
    try:
        with np.load(file, allow_pickle=False) as values:
            q, times = (values[key] for key in ("q", "times"))
    except OSError as error:
        raise InputError(
            "file", f"cannot be read: {error.strerror or error}", str(file), "a file of a motion"
        ) from None
    except (ValueError, KeyError, BadZipFile):
        raise InputError("file", "holds no motion", str(file), "arrays q and times in NPZ") from None
    try:
        return checks.rows("q", q, len(robot), 3), times
    except InputError as error:
        raise error.in_file(file) from None
