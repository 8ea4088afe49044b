"""Where an obstacle is over time, as it stands in a problem file: a list of times and poses, or a file of them."""

from pathlib import Path
from typing import Any

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.build import make
from sinuous.files.path_csv import parse_path
from sinuous.files.text import read_text
from sinuous.poses import pose
from sinuous.scene.courses.course import Course

MOVING = "moving"
"""The key of an obstacle that says so."""

COLUMNS = "t,x,y,z or t,x,y,z,qw,qx,qy,qz or t,x,y,z,qx,qy,qz,qw"


def read_course(value: Any, folder: Path) -> Course:
    """Read a list of `[time, pose]`, or the CSV file of this name, relative to `folder`."""
    if isinstance(value, str):
        file = folder / value
        text = read_text(file, "")
        try:
            return _of_table(text)
        except InputError as error:
            raise error.in_file(file) from None
    if not isinstance(value, list) or not value:
        raise InputError("", "", value, "a list of [time, pose] or the name of a CSV file")
    times, poses = [], []
    for i, entry in enumerate(value):
        with checks.inside(f"[{i}]"):
            if not isinstance(entry, list) or len(entry) != 2:
                raise InputError("", "", entry, "[time, pose]")
            times.append(checks.number("[0]", entry[0]))
            if len(times) > 1 and times[-1] <= times[-2]:
                raise InputError("[0]", "times must increase", times[-1], f"more than {times[-2]:g}")
            with checks.inside("[1]"):
                poses.append(_read_pose(entry[1]))
    matrices = np.stack(poses)
    turned = bool((matrices[:, :3, :3] != np.eye(3)).any())
    return _course(np.array(times), matrices[:, :3, 3].copy(), matrices[:, :3, :3].copy() if turned else None)


def _read_pose(value: Any) -> Floats:
    """Read a position, or a mapping with position and orientation."""
    if isinstance(value, dict):
        return make(pose, value)
    return pose(checks.array("", value, (3,), "[x, y, z] or a mapping with position and rotation"))


def _of_table(text: str) -> Course:
    table = parse_path(text)
    if table.times is None or table.targets[0].direction is not None:
        raise InputError("line 1", "", text.splitlines()[0], COLUMNS)
    positions = np.stack([target.position for target in table.targets if target.position is not None])
    turns = [target.rotation for target in table.targets if target.rotation is not None]
    return _course(table.times, positions, np.stack(turns) if turns else None)


def _course(times: Floats, positions: Floats, rotations: Floats | None) -> Course:
    for array in (times, positions, rotations):
        if array is not None:
            array.flags.writeable = False
    return Course(times, positions, rotations)
