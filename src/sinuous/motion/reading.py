"""Motions from files: our own JSON or YAML, results, CSV, NPZ, and ROS `JointTrajectory` in JSON."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats, motor_columns
from sinuous.base.errors import InputError, suggested
from sinuous.base.text_tables import read_table
from sinuous.files.documents import parse, read_text
from sinuous.files.joint_chain import JointChain
from sinuous.model.robot import Robot
from sinuous.model.segment import coordinate_names
from sinuous.motion.job import load
from sinuous.motion.motion import Motion
from sinuous.scene.scene import SceneLike
from sinuous.scene.snapshot import Snapshot

TABLES = (".csv", ".tsv", ".txt")

CONSISTENT = 1e-6
"""By how much joints may contradict each other: rad, or mean lengths of the robot."""

TIME = ("time", "t")


def read_motion(file: str | Path, robot: Robot | None, scene: SceneLike | Snapshot | None) -> Motion:
    """Read a motion; see `Motion.load`."""
    ending = Path(file).suffix.lower()
    if ending in (*TABLES, ".npz"):
        own = _needed(file, robot)
        if ending == ".npz":
            return Motion.from_npz(file, own, scene)
        with checks.in_file(file):
            q, times = _read_table(read_text(Path(file)), own)
            return Motion(own, q, scene, times)
    values = _values(file)
    if isinstance(values, dict) and "motion" in values:
        if robot is not None:
            raise InputError("robot", "the file holds one", robot, "no robot", str(file))
        return load(file, Motion)
    own = _needed(file, robot)
    with checks.in_file(file):
        if isinstance(values, dict) and "joint_names" in values:
            q, times = _read_ros(values, own)
            return Motion(own, q, scene, times)
        if isinstance(values, dict) and "knots" in values:
            joined = (
                own.configuration("knots", values["knots"], values.get("joints")) if own.joints else values["knots"]
            )
            knots = checks.rows("knots", joined, len(own), 3)
            return Motion(own, knots, scene, checks.increasing("times", values.get("times"), len(knots)))
        expected = "a motion, a result with knots, or a JointTrajectory (joint_names, points)"
        raise InputError("file", "holds no motion", sorted(values) if isinstance(values, dict) else values, expected)


def _needed(file: str | Path, robot: Robot | None) -> Robot:
    if robot is None:
        raise InputError("robot", "missing", None, "the robot whose motion it is: this file does not say", str(file))
    checks.instance("robot", robot, Robot, "a Robot")
    return robot


def _values(file: str | Path) -> Any:
    """Plain values of a file; of several lines of results, the only one."""
    text = read_text(Path(file), expected=f"a motion in {', '.join(TABLES)}, .npz, or a text in JSON or YAML")
    if Path(file).suffix.lower() not in {".json", ".jsonl"}:
        return parse(text, Path(file))
    lines = [line for line in text.splitlines() if line.strip()]
    try:
        return json.loads(lines[0]) if len(lines) == 1 else json.loads("\n".join(lines))
    except ValueError as error:
        raise InputError("file", f"no JSON: {error}", None, "a motion, or one result", str(file)) from None


def _read_table(text: str, robot: Robot) -> tuple[Floats, Floats]:
    """Knots (T, n, 3) and times (T,) of a table with names."""
    table, rows = read_table(text)
    if table.names is None:
        raise InputError("columns", "no names", "numbers alone", "a line with names: time, s1.bend_x, ... or actuators")
    own = [name.lower() for name in table.names]
    shapes = [*robot.joint_names, *coordinate_names(robot.segment_names)]
    motors = motor_columns((actuator.name for actuator in robot.actuators), robot.joint_names)
    read = shapes if shapes[0].lower() in own or not motors else motors
    missing = [name for name in read if name.lower() not in own]
    when = next((name for name in TIME if name in own), None)
    if missing or when is None:
        wanted = missing[0] if missing else TIME[0]
        raise InputError("columns", f"no column {wanted}", list(table.names), suggested(wanted, table.names))
    numbers = table.read_finite(rows, [own.index(name.lower()) for name in (when, *read)])
    return _knots(robot, numbers[:, 1:], read is shapes), checks.increasing("time", numbers[:, 0], len(numbers))


def _knots(robot: Robot, values: Floats, shapes: bool) -> Floats:
    """Configurations (T, n, 3) of rows of coordinates, or of values of all actuators."""
    if shapes:
        moving = len(robot.joint_names)
        return robot.with_joints(values[:, moving:].reshape(len(values), -1, 3), values[:, :moving])
    q: Floats = robot.from_actuators(values)
    return q


def _read_ros(values: dict[str, Any], robot: Robot) -> tuple[Floats, Floats]:
    """Knots (T, n, 3) and times (T,) of a `JointTrajectory`."""
    names, points = values["joint_names"], values.get("points")
    if not isinstance(points, list) or not points:
        raise InputError("points", "", points, "a list of points")
    try:
        positions = np.array([point["positions"] for point in points], np.float64)
        since = [point["time_from_start"] for point in points]
        times = np.array([each["sec"] + 1e-9 * each["nanosec"] for each in since], np.float64)
    except (TypeError, KeyError, ValueError):
        raise InputError("points", "", points[0], "positions and time_from_start (sec, nanosec) in each") from None
    checks.array("points", positions, (len(points), len(names)))
    return _of_joints(robot, list(names), positions), checks.increasing("time_from_start", times, len(times))


def _of_joints(robot: Robot, names: list[str], positions: Floats) -> Floats:
    """Configurations (T, n, 3) of positions (T, j) of joints of the chain, or of actuators, by their names."""
    motors = [actuator.name for actuator in robot.actuators]
    if set(names) == set(motors):
        return _knots(robot, positions[:, [names.index(name) for name in motors]], shapes=False)
    for count in range(1, len(names) + 1):
        chain = JointChain(robot, count)
        if set(chain.names) == set(names):
            return _of_chain(robot, chain, positions[:, [names.index(name) for name in chain.names]])
    raise InputError("joint_names", "of another robot", names, _expected(robot, motors))


def _of_chain(robot: Robot, chain: JointChain, values: Floats) -> Floats:
    """Configurations (T, n, 3) of values (T, j) of a chain, which share the bend of each segment evenly."""
    home = robot.clamp(np.zeros((len(robot), 3))).ravel()

    moved = np.abs(chain.matrix).sum(axis=0) > 0.0
    q = np.where(moved, values @ np.linalg.pinv(chain.matrix).T, home)
    off = np.abs(q @ chain.matrix.T - values).max()
    if off > CONSISTENT * max(1.0, robot.mean_length):
        raise InputError("positions", f"joints of one segment differ by {off:.3g}", None, "shares of one bend")
    return q.reshape(len(values), len(robot), 3)


def _expected(robot: Robot, motors: Sequence[str]) -> str:
    own = JointChain(robot).names
    told = f"joints of its URDF ({own[0]}, ...)" if own else "joints of its URDF"
    return f"{told} or actuators ({', '.join(motors[:3])}, ...)" if motors else told
