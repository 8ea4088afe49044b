"""A problem file: one question about one robot."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.build import known_entries, make
from sinuous.files.json_syntax import parse_json
from sinuous.files.nouns import read_robot, read_scene, read_target, read_targets, targets_together
from sinuous.files.path_csv import parse_path
from sinuous.files.start import read_start
from sinuous.files.text import read_text
from sinuous.files.yaml_syntax import parse_yaml
from sinuous.garbage import uncollected
from sinuous.problem.preferences import Preferences
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.scene import Scene

QUESTIONS = ("target", "targets", "path")
KEYS = ("robot", "scene", *QUESTIONS, "tolerance", "start", "prefer")


@dataclass(frozen=True)
class ProblemFile:
    """What a problem file says.

    Attributes
    ----------
    file : str
        Its name, as it was given.
    robot : Robot
    scene : Scene
    waypoints : tuple of tuple of Target
        One after the other; the targets of one waypoint are met at once.
    is_path : bool
        Whether the file speaks of a path; otherwise there is one waypoint.
    tolerance : Tolerance
    start : ndarray (n, 3) or None
    prefer : Preferences
    """

    file: str
    robot: Robot
    scene: Scene
    waypoints: tuple[tuple[Target, ...], ...]
    is_path: bool
    tolerance: Tolerance
    start: Floats | None
    prefer: Preferences

    @property
    def notes(self) -> tuple[str, ...]:
        """What is not as it should be, and what became of it: the defects of all meshes."""
        return tuple(
            f"{self.scene.name(i)}: {defect}"
            for i, obstacle in enumerate(self.scene.obstacles)
            if isinstance(obstacle, Mesh)
            for defect in obstacle.defects
        )

    def problem(self, waypoint: int = 0) -> Problem:
        """Return the question that one waypoint asks."""
        return Problem(self.robot, self.waypoints[waypoint], self.scene, self.tolerance)


def read_problem(file: str | Path) -> ProblemFile:
    """Read a problem file, JSON when it is called so, YAML otherwise; `docs/format.md` has its keys.

    Raises
    ------
    InputError
        When it cannot be read or cannot be meant: one line with the name of the file, the key, the value and what was
        expected.
    """
    path = Path(file)
    try:
        text = read_text(path)
        with uncollected():  # a long path is some hundred thousand values
            return _problem(str(file), parse_json(text) if path.suffix.lower() == ".json" else parse_yaml(text))
    except InputError as error:
        raise error.in_file(file) from None


def _problem(file: str, value: Any) -> ProblemFile:
    if not isinstance(value, dict):
        raise InputError("file", "", value, "a mapping with " + ", ".join(KEYS))
    entries = known_entries(value, KEYS, ["robot"])
    folder = Path(file).parent
    robot: Robot = _part(entries, "robot", read_robot)
    return ProblemFile(
        file=file,
        robot=robot,
        scene=_part(entries, "scene", lambda v: read_scene(v, robot, folder)),
        waypoints=_waypoints(entries, robot, folder),
        is_path="path" in entries,
        tolerance=_part(entries, "tolerance", lambda v: make(Tolerance, {} if v is None else v)),
        start=None if entries.get("start") is None else read_start(entries["start"], robot, folder),
        prefer=_part(entries, "prefer", lambda v: make(Preferences, {} if v is None else v)),
    )


def _part(entries: dict[str, Any], key: str, read: Callable[[Any], Any]) -> Any:
    with checks.inside(key):
        return read(entries.get(key))


def _waypoints(entries: dict[str, Any], robot: Robot, folder: Path) -> tuple[tuple[Target, ...], ...]:
    expected = "one of " + ", ".join(QUESTIONS)
    asked = [key for key in QUESTIONS if key in entries]
    if not asked:
        raise InputError("target", "missing", list(entries), expected)
    key, value = asked[0], entries[asked[0]]
    if len(asked) > 1:
        raise InputError(key, f"stands beside {asked[1]}", value, expected)
    if key == "path":
        return _read_path(value, robot, folder)
    with checks.inside(key):
        return ((read_target(value, robot),),) if key == "target" else (read_targets(value, robot),)


def _read_path(value: Any, robot: Robot, folder: Path) -> tuple[tuple[Target, ...], ...]:
    if isinstance(value, str):
        file = folder / value
        text = read_text(file, "path")
        try:
            return tuple((target,) for target in parse_path(text))
        except InputError as error:
            raise error.in_file(file) from None
    if not isinstance(value, list) or not value:
        raise InputError("path", "", value, "a list of targets or the name of a CSV file")
    together = targets_together(value)
    if together:
        return tuple((target,) for target in together)
    waypoints = []
    for i, entry in enumerate(value):
        with checks.inside(f"path[{i}]"):
            waypoints.append(read_targets(entry, robot) if isinstance(entry, list) else (read_target(entry, robot),))
    return tuple(waypoints)
