"""Trajectories of joints as ROS 2 has them: `trajectory_msgs/JointTrajectory` as JSON."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from sinuous.base import checks
from sinuous.base.arguments import Whole
from sinuous.base.checks import Floats
from sinuous.base.documents import written
from sinuous.base.errors import InputError
from sinuous.files.joint_chain import JointChain

if TYPE_CHECKING:
    from sinuous.model.robot import Robot

NANO = 1_000_000_000
"""Nanoseconds of a second."""

Of = Literal["joints", "actuators"]
"""Whose values a trajectory has: joints of the chain, as in the URDF, or actuators of the robot."""


class JointMap(NamedTuple):
    """How values of joints or actuators come of flat configurations: `matrix q + offset`.

    Their names (j,), the matrix (j, 3 n) and the offset (j,).
    """

    names: tuple[str, ...]
    matrix: Floats
    offset: Floats


def joint_map(robot: "Robot", of: Of, joints_per_segment: Whole) -> JointMap:
    """Return the map to the joints of the chain, or to the motors of the robot."""
    if checks.choice("of", of, ("joints", "actuators")) == "joints":
        chain = JointChain(robot, joints_per_segment)
        return JointMap(chain.names, chain.matrix, chain.offsets)
    if not robot.actuators:
        raise InputError("of", "the robot has none", of, "joints")
    names = tuple(actuator.name for actuator in robot.actuators)
    return JointMap(names, robot.drive.value_jacobian, robot.drive.motors.offset)


def joint_trajectory(
    names: Sequence[str], times: Floats, positions: Floats, velocities: Floats | None = None
) -> dict[str, Any]:
    """Return the message as plain values; times count from the first.

    Parameters
    ----------
    names : sequence of str
        Names of the joints (j,).
    times : ndarray (T,)
        Seconds.
    positions, velocities : ndarray (T, j)
        A controller of ROS 2 moves along straight lines between positions alone, and along cubic splines where there
        are velocities.
    """
    begin = float(times[0])
    points = []
    for i, time in enumerate(times.tolist()):
        seconds, nanoseconds = divmod(round((time - begin) * NANO), NANO)
        point: dict[str, Any] = {"positions": positions[i].tolist()}
        if velocities is not None:
            point["velocities"] = velocities[i].tolist()
        points.append(point | {"time_from_start": {"sec": seconds, "nanosec": nanoseconds}})
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base"}
    return {"header": header, "joint_names": list(names), "points": points}


def write_json(file: str | Path, values: dict[str, Any]) -> None:
    """Write plain values as JSON.

    Raises
    ------
    InputError
        When the file cannot be written.
    """
    with written(file):
        Path(file).write_text(json.dumps(values, allow_nan=False) + "\n", encoding="utf-8")
