"""Motions as tables: times at a rate, and the files CSV, NPZ and ROS JSON."""

from collections.abc import Sequence
from pathlib import Path
from typing import get_args
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.solution import Solution
from sinuous.answer.solutions import chosen_columns
from sinuous.base import checks
from sinuous.base.arguments import Whole
from sinuous.base.checks import Floats, readable
from sinuous.base.documents import write_archive, write_table
from sinuous.base.errors import InputError
from sinuous.files.joint_chain import JointChain, Of, joint_trajectory, write_json
from sinuous.model.robot import Robot


def sample_times(times: Floats, rate: float) -> Floats:
    """Return times at a rate (1 / time), from the first knot on; the last one is the last knot."""
    count = int(np.ceil((times[-1] - times[0]) * rate - 1e-9)) if len(times) else 0
    return np.append(times[0] + np.arange(count) / rate, times[-1]) if len(times) else times


def write_csv(file: str | Path, solutions: Sequence[Solution], chosen: Sequence[str] | None = None) -> None:
    """Write solutions of one robot, at least one, as CSV: number from 1 on, status, configuration, actuators or chosen.

    Raises
    ------
    InputError
        When a name is not known or given twice, or the file cannot be written.
    """
    q = np.stack([solution.configuration for solution in solutions])
    names, numbers = chosen_columns(solutions[0].problem.robot, q, chosen)
    rows = ([i, str(each.status), *row] for i, (each, row) in enumerate(zip(solutions, numbers, strict=True), 1))
    write_table(file, ["solution", "status", *names], rows)


def write_motion(file: str | Path, robot: Robot, times: Floats, q: Floats, chosen: Sequence[str] | None = None) -> None:
    """Write configurations (T, n, 3) at times (T,) as CSV: time, then configuration and actuators, or what is chosen.

    Raises
    ------
    InputError
        When a name is not known or given twice, or the file cannot be written.
    """
    names, numbers = chosen_columns(robot, q, chosen)
    rows = ([time, *row] for time, row in zip(times.tolist(), numbers, strict=True))
    write_table(file, ["time", *names], rows)


def write_ros(
    file: str | Path, robot: Robot, times: Floats, q: Floats, velocities: Floats | None, of: Of, joints: Whole
) -> None:
    """Write configurations (T, n, 3), and their rates where they are known, as a ROS 2 `JointTrajectory` in JSON.

    Parameters
    ----------
    of : str
        `joints` or `actuators`: whose values are written.
    joints : int
        Joints that stand for the bend of a segment, see `Robot.to_urdf`.

    Raises
    ------
    InputError
        When an argument is not what it should be, or the file cannot be written.
    """
    if checks.choice("of", of, get_args(Of)) == "joints":
        chain = JointChain(robot, joints)
        names, positions = chain.names, chain.values(q)
        speeds = None if velocities is None else velocities.reshape(len(times), -1) @ chain.matrix.T
    elif not robot.actuators:
        raise InputError("of", "the robot has none", of, "joints")
    else:
        names, positions = tuple(actuator.name for actuator in robot.actuators), robot.to_actuators(q)
        speeds = None if velocities is None else robot.drive.speeds(velocities, q)
    write_json(file, joint_trajectory(names, times, positions, speeds))


def write_npz(file: str | Path, robot: Robot, times: Floats, q: Floats, proved: NDArray[np.bool_]) -> None:
    """Write knots (T, n, 3) at times (T,), and which steps (T - 1,) are proved, as NPZ; see `Motion.to_npz`.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    values = {
        "q": robot.segments_of(q),
        **({"joints": robot.joints_of(q)} if robot.joints else {}),
        "times": times,
        "actuators": robot.to_actuators(q),
        "actuator_names": np.array([actuator.name for actuator in robot.actuators], np.str_),
        "actuator_units": np.array([actuator.unit or "" for actuator in robot.actuators], np.str_),
        "proved": proved,
    }
    write_archive(file, compressed=True, **values)


def read_npz(file: str | Path, robot: Robot) -> tuple[Floats, Floats]:
    """Read knots (T, n, 3) and times (T,) from an NPZ file; see `Motion.from_npz`."""
    with readable(file):
        try:
            with np.load(file, allow_pickle=False) as values:
                q, times = (values[key] for key in ("q", "times"))
                joints = values.get("joints")
        except (ValueError, KeyError, BadZipFile):
            raise InputError("file", "holds no motion", str(file), "arrays q and times in NPZ") from None
    with checks.in_file(file):
        whole = q if joints is None else robot.configuration("q", q, joints)
        return checks.rows("q", whole, len(robot), 3), times
