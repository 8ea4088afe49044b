"""Configurations and the values of actuators as a table: CSV, one row a waypoint."""

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sinuous.errors import InputError
from sinuous.robot.robot import Robot
from sinuous.solution.solution import Solution


def columns(robot: Robot) -> list[str]:
    """Names of the numbers: `s1.bend_x`, `s1.bend_y`, `s1.length` of every segment, then the names of all actuators."""
    of_segments = [f"{name}.{key}" for name in robot.segment_names for key in ("bend_x", "bend_y", "length")]
    return [*of_segments, *(actuator.name for actuator in robot.actuators)]


def write_csv(file: str | Path, solutions: Sequence[Solution], what: str = "waypoint") -> None:
    """Write solutions of one robot, at least one, as CSV.

    Parameters
    ----------
    file : path
    solutions : sequence of Solution
    what : str
        What the rows are; the first column, their number from 1 on, is called so. The second is the status.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    robot = solutions[0].problem.robot
    q = np.stack([solution.q for solution in solutions])
    numbers = np.concatenate([q.reshape(len(q), -1), robot.to_actuators(q)], axis=-1).tolist()
    try:
        with Path(file).open("w", encoding="utf-8", newline="") as out:
            table = csv.writer(out, lineterminator="\n")
            table.writerow([what, "status", *columns(robot)])
            for i, (solution, row) in enumerate(zip(solutions, numbers, strict=True), 1):
                table.writerow([i, str(solution.status), *row])
    except OSError as error:
        raise InputError(
            "file", f"cannot be written: {error.strerror}", str(file), "a file that can be written"
        ) from None
