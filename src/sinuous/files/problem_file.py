"""What a problem file says: a robot, what stands around it, and perhaps one question about it."""

from pathlib import Path
from typing import Any

import numpy as np

from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.files.documents import read_text
from sinuous.files.nouns import (
    known_entries,
    make,
    parse_path,
    read_configuration,
    read_each,
    read_place,
    read_robot,
    read_target,
    read_targets,
    targets_together,
)
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.problem.problem import Preferences
from sinuous.problem.target import Target, Tolerance, Workspace, target_list
from sinuous.scene.scene import Scene

QUESTIONS = ("target", "targets", "path", "goal")
DEMANDS = ("clearance", "self_clearance")
KEYS = (
    "robot",
    "scene",
    *QUESTIONS,
    "tolerance",
    "start",
    "prefer",
    "rates",
    "times",
    "reconfigure",
    "workspace",
    *DEMANDS,
)


def problem_arguments(value: Any, file: str, question: bool = True) -> dict[str, Any]:
    """Return what a problem file says, as arguments of `Job`; without its `question`, it may be a robot alone."""
    if not isinstance(value, dict):
        raise InputError("file", "", value, "a mapping with " + ", ".join(KEYS))
    alone = not question and ("segments" in value or "joints" in value) and "robot" not in value
    entries = {} if alone else known_entries(value, KEYS, ["robot"])
    folder = Path(file).parent
    robot, scene = (read_robot(value, folder), Scene()) if alone else read_place(entries, folder)
    start = entries.get("start")
    return {
        "robot": robot,
        "scene": scene,
        "tolerance": made(entries, "tolerance", Tolerance),
        "start": None if start is None else read_configuration("start", start, robot, folder),
        "prefer": made(entries, "prefer", Preferences),
        "rates": _rates(entries),
        "reconfigure": "refuse" if entries.get("reconfigure") is None else entries["reconfigure"],
        "workspace": made(entries, "workspace", Workspace),
        "clearance": entries.get("clearance"),
        "self_clearance": entries.get("self_clearance"),
        "file": file,
        **(read_question(entries, robot, folder) if question else {}),
    }


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
            raise InputError("times", "are in the file of the path, too", entries["times"], "one of both")
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
        return read_each(read, value), None
