"""A problem file: one question about one robot; or what it says apart from its targets."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, NamedTuple, Self, TypeVar

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import OneEach, Rows, Vector
from sinuous.base.checks import Floats
from sinuous.base.documents import write_document
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen
from sinuous.base.gc_pause import gc_paused
from sinuous.base.plain import described, plain
from sinuous.base.reprs import text
from sinuous.files.documents import read_text, read_values
from sinuous.files.nouns import (
    each,
    known_entries,
    make,
    read_configuration,
    read_place,
    read_robot,
    read_target,
    read_targets,
    targets_together,
)
from sinuous.files.path_csv import parse_path
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot, demanding
from sinuous.problem.problem import Preferences, Problem, check_sizes
from sinuous.problem.suspicions import all_suspicions, suspicions
from sinuous.problem.target import Target, Targets, Tolerance, as_tolerance, target_list
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.scene import Scene, SceneLike, as_scene

QUESTIONS = ("target", "targets", "path", "goal")
DEMANDS = ("clearance", "self_clearance")
KEYS = ("robot", "scene", *QUESTIONS, "tolerance", "start", "prefer", "rates", "times", *DEMANDS)


class ProblemFile(Frozen):
    """What a problem file says.

    Parameters
    ----------
    robot : Robot
    target : Target or list of Target, optional
        To be met at once.
    scene : Scene or list of obstacles, optional
    path : iterable of Target or list of Target, optional
        Waypoints to be met one after the other, instead of `target`.
    goal : array_like (n, 3), optional
        The configuration where a plan ends, instead of `target`.
    times : array_like (m,), optional
        Of all waypoints of a path, increasing.
    tolerance : Tolerance, optional
    start : array_like (n, 3), optional
        Where the first solve, or a motion, begins.
    prefer : Preferences, optional
    rates : Rates, optional
        How fast the robot may move.
    clearance, self_clearance : float or array_like (n,), optional
        Distance from obstacles, and from itself, that the body has to keep, instead of what the robot demands.
    file : str
        Its name, as it was given; empty when it is not from a file.

    Attributes
    ----------
    waypoints : tuple of tuple of Target
        One after the other; the targets of one waypoint are met at once. None where a configuration is the goal.
    times : ndarray (m,) or None
    is_path : bool
        Whether it speaks of a path; otherwise there is one waypoint, or a goal.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    robot: Robot
    scene: Scene
    waypoints: tuple[tuple[Target, ...], ...]
    times: Floats | None
    is_path: bool
    goal: Floats | None
    tolerance: Tolerance
    start: Floats | None
    prefer: Preferences
    rates: Rates
    file: str

    def __init__(
        self,
        robot: Robot,
        target: Targets | None = None,
        scene: SceneLike | None = None,
        *,
        path: Iterable[Targets] | None = None,
        goal: Rows | None = None,
        times: Vector | None = None,
        tolerance: Tolerance | None = None,
        start: Rows | None = None,
        prefer: Preferences | None = None,
        rates: Rates | None = None,
        clearance: OneEach | None = None,
        self_clearance: OneEach | None = None,
        file: str = "",
    ) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        asked = [key for key, value in (("target", target), ("path", path), ("goal", goal)) if value is not None]
        if len(asked) != 1:
            what = f"cannot be combined with {asked[1]}" if asked else "missing"
            raise InputError("target", what, target, "one of target, path, goal")
        checks.instance("prefer", prefer, Preferences | None, "Preferences")
        checks.instance("rates", rates, Rates | None, "Rates")
        if rates is not None:
            with checks.inside("rates"):
                rates.check(robot)
        place = as_scene(scene)
        check_sizes(robot, place)
        waypoints = () if goal is not None else read_waypoints(asked[0], [target] if path is None else path, robot)
        if times is not None and path is None:
            raise InputError("times", f"cannot be combined with {asked[0]}", times, "those of a path")
        self._set(
            robot=demanding(robot, clearance, self_clearance),
            scene=place,
            waypoints=waypoints,
            times=None if times is None else checks.increasing("times", times, len(waypoints)),
            is_path=path is not None,
            goal=None if goal is None else checks.array("goal", goal, (len(robot), 3)),
            tolerance=as_tolerance(tolerance),
            start=None if start is None else checks.array("start", start, (len(robot), 3)),
            prefer=prefer or Preferences(),
            rates=Rates() if rates is None else rates,
            file=file,
        )

    def _content(self) -> dict[str, Any]:
        """All but the name of the file; the scene as it is now."""
        return {**super()._content(), "scene": self.scene.snapshot(), "file": None}

    @property
    def notes(self) -> tuple[str, ...]:
        """What is not as it should be: the defects of all meshes and what became of them, and what is suspicious."""
        defects = [
            f"{self.scene.name(i)}: {defect}"
            for i, obstacle in enumerate(self.scene.obstacles)
            if isinstance(obstacle, Mesh)
            for defect in obstacle.defects
        ]
        suspicious = all_suspicions(self.robot, self.scene.snapshot(), self.waypoints)
        return (*defects, *suspicious, *self.robot.coordinate_notes)

    def _shown(self) -> Iterator[str]:
        yield from (text(self.file),) if self.file else ()
        yield f"{len(self.robot)} segments"
        targets = f"{len(self.waypoints)} waypoints" if self.is_path else f"{len(self.waypoints[0])} targets"
        yield "a goal" if self.goal is not None else targets
        yield f"{len(self.scene)} obstacles"

    def demanding(self, clearance: OneEach | None, self_clearance: OneEach | None) -> Self:
        """Return the same with other clearances that the body has to keep, where they are given."""
        other = object.__new__(type(self))
        other._set(**{**vars(self), "robot": demanding(self.robot, clearance, self_clearance)})
        return other

    @property
    def ends(self) -> tuple[Target, ...] | Floats:
        """Where a plan ends: at the targets, or at the goal (n, 3)."""
        return self.waypoints[0] if self.goal is None else self.goal

    def problem(self, waypoint: int = 0) -> Problem:
        """Return the question that one waypoint asks."""
        return Problem(self.robot, self.waypoints[waypoint], self.scene, self.tolerance)

    def _refuse(self, *kinds: str) -> None:
        """Refuse what this asks, where it is one of these kinds of questions: those of `track` or `plan`."""
        file = self.file or None
        if "path" in kinds and self.is_path:
            raise InputError("path", "is for track", len(self.waypoints), "target or targets", file)
        if "goal" in kinds and self.goal is not None:
            raise InputError("goal", "is for plan", self.goal.tolist(), "target or targets", file)
        if "no start" in kinds and self.start is None:
            raise InputError("start", "missing", None, "where the motion begins", file)

    def to_dict(self, folder: str | Path = ".") -> dict[str, Any]:
        """Return what a problem file in `folder` says; what has its default is left out.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file.
        """
        parts = {
            "robot": self.robot.to_dict(),
            "scene": self.scene.entries(folder),
            **self._question(),
            "tolerance": described(self.tolerance),
            "start": None if self.start is None else self.start.tolist(),
            "prefer": described(self.prefer),
            "rates": described(self.rates),
        }
        return {key: value for key, value in parts.items() if value}

    def _question(self) -> dict[str, Any]:
        if self.goal is not None:
            return {"goal": self.goal.tolist()}
        listed = [[described(target) for target in targets] for targets in self.waypoints]
        if self.is_path:
            path = [targets[0] if len(targets) == 1 else targets for targets in listed]
            return {"path": path} | ({} if self.times is None else {"times": plain(self.times)})
        return {"target": listed[0][0]} if len(listed[0]) == 1 else {"targets": listed[0]}

    def save(self, file: str | Path) -> None:
        """Write a problem file, JSON when it is called so, YAML otherwise; read again, it is equal.

        Obstacles that were read from files stay there; the new file names them. All else stands in the new file.

        Raises
        ------
        InputError
            When an obstacle is neither exact nor from a file, or the file cannot be written.
        """
        write_document(file, self.to_dict(Path(file).parent))


Kind = TypeVar("Kind", bound=ProblemFile)


def read_problem(file: str | Path) -> ProblemFile:
    """Read a problem file, JSON when it is called so, YAML otherwise; `docs/format.md` has its keys.

    Raises
    ------
    InputError
        When it cannot be read or cannot be meant: one line with the name of the file, the key, the value and what was
        expected.
    """
    with checks.in_file(file), gc_paused():  # a long path is some hundred thousand values
        return problem_of(read_values(file), str(file), ProblemFile)


def problem_of(value: Any, file: str, kind: type[Kind]) -> Kind:
    """Make a problem of what its file says."""
    if not isinstance(value, dict):
        raise InputError("file", "", value, "a mapping with " + ", ".join(KEYS))
    entries = known_entries(value, KEYS, ["robot"])
    folder = Path(file).parent
    place = read_place(entries, folder)
    return kind(
        **_in_place(place, entries, folder),
        rates=_rates(entries),
        clearance=entries.get("clearance"),
        self_clearance=entries.get("self_clearance"),
        file=file,
        **read_question(entries, place[0], folder),
    )


def _in_place(place: tuple[Robot, Scene], entries: dict[str, Any], folder: Path) -> dict[str, Any]:
    """What a file says of a robot and a scene, whatever it asks: arguments of `ProblemFile`, and of `Setting`."""
    robot, scene = place
    start = entries.get("start")
    return {
        "robot": robot,
        "scene": scene,
        "tolerance": made(entries, "tolerance", Tolerance),
        "start": None if start is None else read_configuration("start", start, robot, folder),
        "prefer": made(entries, "prefer", Preferences),
    }


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
    return Setting(
        **_in_place((robot, scene), entries, folder),
        notes=(*suspicions(robot, scene.snapshot()), *robot.coordinate_notes),
    )


def _rates(entries: dict[str, Any]) -> Rates:
    with checks.inside("rates"):
        own = {} if entries.get("rates") is None else entries["rates"]
        return make(Rates, own, {"acceleration": lambda value: make(Rates, value)})


def made(entries: dict[str, Any], key: str, noun: type[Any]) -> Any:
    """Make what stands under `key`; without it, what it is by default."""
    with checks.inside(key):
        return make(noun, {} if entries.get(key) is None else entries[key])


def read_waypoints(key: str, path: Any, robot: Robot | None = None) -> tuple[tuple[Target, ...], ...]:
    """Check waypoints, of a robot where it is known; `key` is what holds them, or `target`, the only one."""
    if isinstance(path, (Target, str, bytes, dict)) or not np.iterable(path):
        raise InputError(key, "", path, "a list of targets")
    result = [target_list(key if key == "target" else f"{key}[{i}]", each, robot) for i, each in enumerate(path)]
    if not result:
        raise InputError(key, "", path, "at least one target")
    return tuple(result)


def read_question(entries: dict[str, Any], robot: Robot, folder: Path) -> dict[str, Any]:
    """What is asked, as an argument of a problem."""
    expected = "one of " + ", ".join(QUESTIONS)
    asked = [key for key in QUESTIONS if key in entries]
    if not asked:
        raise InputError("target", "missing", list(entries), expected)
    key, value = asked[0], entries[asked[0]]
    if len(asked) > 1:
        raise InputError(key, f"cannot be combined with {asked[1]}", value, expected)
    if key == "path":
        targets, times = _read_path(value, robot, folder)
        if times is not None and "times" in entries:
            raise InputError("times", "stand in the file of the path, too", entries["times"], "one of both")
        return {"path": targets, "times": entries.get("times") if times is None else times}
    if entries.get("times") is not None:
        raise InputError("times", f"cannot be combined with {key}", entries["times"], "those of a path")
    if key == "goal":
        return {"goal": read_configuration("goal", value, robot, folder)}
    with checks.inside(key):
        return {"target": (read_target(value, robot),) if key == "target" else read_targets(value, robot)}


def _read_path(value: Any, robot: Robot, folder: Path) -> tuple[list[tuple[Target, ...]], Floats | None]:
    """Read targets to be met one after the other, and the times of a file of them."""
    if isinstance(value, str):
        file = folder / value
        text = read_text(file, "path")
        with checks.in_file(file):
            table = parse_path(text)
        return [(target,) for target in table.targets], table.times
    if not isinstance(value, list) or not value:
        raise InputError("path", "", value, "a list of targets or the name of a CSV file")
    together = targets_together(value)
    if together:
        return [(target,) for target in together], None

    def read(entry: Any) -> tuple[Target, ...]:
        return read_targets(entry, robot) if isinstance(entry, list) else (read_target(entry, robot),)

    with checks.inside("path"):
        return each(read, value), None
