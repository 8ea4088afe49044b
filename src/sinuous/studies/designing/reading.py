"""The file of a design: a robot, obstacles, tasks, what is varied and what is minimised."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from sinuous.base import checks
from sinuous.base.errors import InputError
from sinuous.files.documents import read_values
from sinuous.files.nouns import known_entries
from sinuous.files.problem_file import read_question
from sinuous.model.robot import Robot
from sinuous.motion.job import Job, job_of
from sinuous.studies.tasks.tasks import Cover, Follow, Meet, Move

KEYS = ("tasks", "vary", "minimise")

KINDS = ("target", "targets", "path", "move", "set")
"""Keys of a task: what is asked."""


class DesignFile(NamedTuple):
    """What the file of a design says.

    Attributes
    ----------
    setting : Job
        The template, and the obstacles.
    tasks : dict of str to Task
    vary : dict
    minimise : list of str or str
    """

    setting: Job
    tasks: dict[str, Any]
    vary: dict[str, Any]
    minimise: Any


def read_design(file: str | Path) -> DesignFile:
    """Read the file of a design: a problem file with `tasks`, `vary` and `minimise` instead of a target.

    Raises
    ------
    InputError
        As `read_problem`.
    """
    with checks.in_file(file):
        values = read_values(file)
        if not isinstance(values, dict) or "tasks" not in values:
            raise InputError("tasks", "missing", values if not isinstance(values, dict) else list(values), "tasks")
        folder = Path(file).parent
        place = {key: value for key, value in values.items() if key not in KEYS}
        setting = job_of(place, str(file), question=False)
        with checks.inside("tasks"):
            tasks = _read_tasks(values["tasks"], setting.robot, folder)
        vary = values.get("vary") or {}
        if not isinstance(vary, dict):
            raise InputError("vary", "", vary, "a mapping of fields to {range: [low, high]} or lists of values")
        return DesignFile(setting, tasks, vary, values.get("minimise"))


def _read_tasks(value: Any, robot: Robot, folder: Path) -> dict[str, Any]:
    if isinstance(value, list):
        value = {f"task {i}": each for i, each in enumerate(value, 1)}
    if not isinstance(value, Mapping) or not value:
        raise InputError("", "", value, "a mapping or a list of tasks")
    tasks = {}
    for name, entry in value.items():
        with checks.inside(f"[{str(name)!r}]"):
            tasks[str(name)] = _read_task(entry, robot, folder)
    return tasks


def _read_task(value: Any, robot: Robot, folder: Path) -> Any:
    """Read one task; segments of targets are those of the template."""
    entries = known_entries(value, (*KINDS, "share"))
    kinds = [key for key in KINDS if key in entries]
    if len(kinds) != 1:
        raise InputError("", "", list(entries), f"one of {', '.join(KINDS)}")
    kind = kinds[0]
    if "share" in entries and kind != "set":
        raise InputError("share", f"cannot be combined with {kind}", entries["share"], "share of a set")
    if kind in ("target", "targets"):
        return Meet(read_question({kind: entries[kind]}, robot, folder)["target"])
    if kind == "move":
        key = "targets" if isinstance(entries[kind], list) else "target"
        return Move(read_question({key: entries[kind]}, robot, folder)["target"])
    waypoints = read_question({"path": entries[kind]}, robot, folder)["path"]
    if kind == "path":
        return Follow([list(targets) for targets in waypoints])
    return Cover([list(targets) for targets in waypoints], entries.get("share", 1.0))
