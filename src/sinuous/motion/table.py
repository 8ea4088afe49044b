"""Configurations and the values of actuators as a table: CSV, one row a solution or a knot."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.robot.robot import Robot
from sinuous.solution.solution import Solution


def columns(robot: Robot) -> list[str]:
    """Names of the numbers: `s1.bend_x`, `s1.bend_y`, `s1.length` of every segment, then the names of all actuators."""
    of_segments = [f"{name}.{key}" for name in robot.segment_names for key in ("bend_x", "bend_y", "length")]
    return [*of_segments, *(actuator.name for actuator in robot.actuators)]


def write_csv(file: str | Path, solutions: Sequence[Solution]) -> None:
    """Write solutions of one robot, at least one, as CSV: their number from 1 on, status, configuration, actuators.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    robot = solutions[0].problem.robot
    numbers = _numbers(robot, np.stack([solution.q for solution in solutions]))
    rows = ([i, str(each.status), *row] for i, (each, row) in enumerate(zip(solutions, numbers, strict=True), 1))
    _write(file, ["solution", "status", *columns(robot)], rows)


def write_motion(file: str | Path, robot: Robot, times: Floats, q: Floats) -> None:
    """Write configurations (T, n, 3) at times (T,) as CSV: time, configuration, actuators.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    rows = ([time, *row] for time, row in zip(times.tolist(), _numbers(robot, q), strict=True))
    _write(file, ["time", *columns(robot)], rows)


def _numbers(robot: Robot, q: Floats) -> list[list[float]]:
    """Configurations and actuators (T, 3 n + m)."""
    found: list[list[float]] = np.concatenate([q.reshape(len(q), -1), robot.to_actuators(q)], axis=-1).tolist()
    return found


def _write(file: str | Path, header: list[str], rows: Iterable[Sequence[object]]) -> None:
    try:
        with Path(file).open("w", encoding="utf-8", newline="") as out:
            table = csv.writer(out, lineterminator="\n")
            table.writerow(header)
            table.writerows(rows)
    except OSError as error:
        raise InputError(
            "file", f"cannot be written: {error.strerror}", str(file), "a file that can be written"
        ) from None
