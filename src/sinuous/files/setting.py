"""What a problem file says but for its targets: the robot, what stands around it, and how solves are to be done."""

from pathlib import Path
from typing import Any

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.build import known_entries
from sinuous.files.documents import parse
from sinuous.files.nouns import read_place, read_robot
from sinuous.files.problem_file import KEYS, made
from sinuous.files.start import read_start
from sinuous.files.text import read_text
from sinuous.frozen import Frozen
from sinuous.problem.preferences import Preferences
from sinuous.problem.problem import check_sizes
from sinuous.problem.suspicions import suspicions
from sinuous.problem.target import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene


class Setting(Frozen):
    """A robot in a scene, for targets that stand elsewhere.

    Attributes
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    start : ndarray (n, 3) or None
    prefer : Preferences
    file : str
    notes : tuple of str
        What is suspicious.
    """

    robot: Robot
    scene: Scene
    tolerance: Tolerance
    start: Floats | None
    prefer: Preferences
    file: str
    notes: tuple[str, ...]

    def __init__(self, robot: Robot, scene: Scene, entries: dict[str, Any], file: str) -> None:
        check_sizes(robot, scene)
        start = entries.get("start")
        self._set(
            robot=robot,
            scene=scene,
            tolerance=made(entries, "tolerance", Tolerance),
            start=None if start is None else read_start("start", start, robot, Path(file).parent),
            prefer=made(entries, "prefer", Preferences),
            file=file,
            notes=tuple(suspicions(robot, scene.snapshot())),
        )


def read_setting(file: str | Path) -> Setting:
    """Read a problem file, whose targets are left alone and may be missing, or a file with a robot alone.

    Raises
    ------
    InputError
        As `read_problem`.
    """
    path = Path(file)
    try:
        return _setting_of(parse(read_text(path), path), str(file))
    except InputError as error:
        raise error.in_file(file) from None


def _setting_of(value: Any, file: str) -> Setting:
    if isinstance(value, dict) and "segments" in value and "robot" not in value:
        return Setting(read_robot(value), Scene(), {}, file)
    if not isinstance(value, dict):
        raise InputError("file", "", value, "a robot, or a mapping with " + ", ".join(KEYS))
    entries = known_entries(value, KEYS, ["robot"])
    folder = Path(file).parent
    robot, scene = read_place(entries, folder)
    return Setting(robot, scene, entries, file)
