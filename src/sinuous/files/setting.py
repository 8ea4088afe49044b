"""What a problem file says apart from its targets: the robot, the scene, and how solves are to be done."""

from pathlib import Path
from typing import Any, NamedTuple

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.build import known_entries
from sinuous.files.documents import read_values
from sinuous.files.nouns import read_configuration, read_place, read_robot
from sinuous.files.problem_file import DEMANDS, KEYS, made
from sinuous.problem.problem import Preferences, check_sizes
from sinuous.problem.suspicions import suspicions
from sinuous.problem.target import Tolerance
from sinuous.robot.robot import Robot, demanding
from sinuous.scene.scene import Scene


class Setting(NamedTuple):
    """A robot in a scene, for targets that stand elsewhere.

    Attributes
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    start : ndarray (n, 3) or None
    prefer : Preferences
    notes : tuple of str
        What is suspicious.
    """

    robot: Robot
    scene: Scene
    tolerance: Tolerance
    start: Floats | None
    prefer: Preferences
    notes: tuple[str, ...]


def read_setting(file: str | Path) -> Setting:
    """Read a file with a robot alone, or a problem file; targets in it are not read and may be missing.

    Raises
    ------
    InputError
        As `read_problem`.
    """
    with checks.in_file(file):
        return setting_of_values(read_values(file), Path(file).parent)


def setting_of_values(value: Any, folder: Path) -> Setting:
    """Make a setting of what its file says; names of files in it are relative to `folder`."""
    if not isinstance(value, dict):
        raise InputError("file", "", value, "a robot, or a mapping with " + ", ".join(KEYS))
    entries: dict[str, Any] = {}
    if "segments" in value and "robot" not in value:
        robot, scene = read_robot(value), Scene()
    else:
        entries = known_entries(value, KEYS, ["robot"])
        robot, scene = read_place(entries, folder)
    robot = demanding(robot, *(entries.get(key) for key in DEMANDS))
    check_sizes(robot, scene)
    start = entries.get("start")
    return Setting(
        robot=robot,
        scene=scene,
        tolerance=made(entries, "tolerance", Tolerance),
        start=None if start is None else read_configuration("start", start, robot, folder),
        prefer=made(entries, "prefer", Preferences),
        notes=tuple(suspicions(robot, scene.snapshot())),
    )
