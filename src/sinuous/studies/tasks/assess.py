"""`assess`: which of a set of tasks robots can do, in a row for each robot and task; `sweep`: robots that differ."""

import copy
import math
import re
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple, Unpack

from sinuous.base import checks
from sinuous.base.documents import write_table
from sinuous.base.errors import InputError, SuspiciousInput, duration, shown
from sinuous.base.frozen import ShortRepr
from sinuous.base.progress import ProgressBar
from sinuous.files.nouns import read_robot
from sinuous.model.robot import Robot
from sinuous.scene.scene import SceneLike, as_scene
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver
from sinuous.studies.tasks.tasks import SOLVED, Done, read_tasks


class Total(NamedTuple):
    """What one robot can do of all tasks.

    Attributes
    ----------
    robot : str
    done, tasks : int
        Tasks that are done, and all.
    share : float
        Mean share of the targets that are met.
    clearance, self_clearance : float or None
        Least proved, over the tasks that are done.
    seconds : float
        The longest time of computing.
    duration : float or None
        The longest motion.
    binds : str or None
        What binds most often: of the tasks that are not done, or of all where all are.
    """

    robot: str
    done: int
    tasks: int
    share: float
    clearance: float | None
    self_clearance: float | None
    seconds: float
    duration: float | None
    binds: str | None


class TaskRow(NamedTuple):
    """One task of one robot; see `Done`."""

    robot: str
    task: str
    kind: str
    done: Done


class Assessment(ShortRepr):
    """What robots can do of a set of tasks.

    Attributes
    ----------
    rows : tuple of TaskRow
        Robots in their order, and the tasks of each in theirs.
    totals : tuple of Total
        One a robot.
    """

    def __init__(self, rows: tuple[TaskRow, ...]) -> None:
        self.rows = rows
        robots = list(dict.fromkeys(row.robot for row in rows))
        self.totals = tuple(_total(name, [row.done for row in rows if row.robot == name]) for name in robots)

    @property
    def solved(self) -> bool:
        """Whether every robot can do every task."""
        return all(total.done == total.tasks for total in self.totals)

    def best(self) -> Total:
        """Return the robot that can do most; of several the one with the largest share, then the largest clearance."""
        return max(self.totals, key=lambda total: (total.done, total.share, total.clearance or 0.0))

    def failed(self, robot: str | None = None) -> list[TaskRow]:
        """List the tasks that a robot cannot do; by default of all robots."""
        return [row for row in self.rows if row.done.status != SOLVED and robot in (None, row.robot)]

    def to_csv(self, file: str | Path, tasks: bool = False) -> None:
        """Write a row for each robot, or with `tasks` for each task of each robot; what is not known is empty.

        Raises
        ------
        InputError
            When the file cannot be written.
        """
        table: list[dict[str, Any]] = self.to_dict()["rows" if tasks else "totals"]
        write_table(file, table[0], (row.values() for row in table))

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain values."""
        rows = [{"robot": row.robot, "task": row.task, "kind": row.kind, **row.done.told()} for row in self.rows]
        return {"totals": [total._asdict() for total in self.totals], "rows": rows}

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.totals)} robots"
        yield f"{self.totals[0].tasks} tasks"

    def __str__(self) -> str:
        width = max(len(total.robot) for total in self.totals)
        parts = [f"Assessment: {len(self.totals)} robots, {self.totals[0].tasks} tasks"]
        for total in self.totals:
            told = [f"{total.done} of {total.tasks} done", f"{100.0 * total.share:.3g} % of the targets"]
            told += [] if total.clearance is None else [f"clearance {total.clearance:.3g}"]
            told += [] if total.duration is None else [f"longest motion {total.duration:.3g}"]
            told += [f"longest time {duration(total.seconds)}"]
            told += [] if total.binds is None else [f"limited by {total.binds}"]
            parts.append(f"  {total.robot:<{width}}  {', '.join(told)}")
        return "\n".join(parts)


def _total(name: str, done: list[Done]) -> Total:
    solved = [each for each in done if each.status == SOLVED]
    failed = [each for each in done if each.status != SOLVED]
    names = Counter(each.binds for each in failed or done if each.binds is not None)
    return Total(
        robot=name,
        done=len(solved),
        tasks=len(done),
        share=sum(each.share for each in done) / len(done),
        clearance=_least(each.clearance for each in solved),
        self_clearance=_least(each.self_clearance for each in solved),
        seconds=max(each.seconds for each in done),
        duration=max((each.duration for each in solved if each.duration is not None), default=None),
        binds=names.most_common(1)[0][0] if names else None,
    )


def _least(values: Iterable[float | None]) -> float | None:
    return min((value for value in values if value is not None), default=None)


def assess(
    robot: Robot | Mapping[str, Robot] | Iterable[Robot],
    tasks: Mapping[str, Any] | Iterable[Any],
    scene: SceneLike | None = None,
    *,
    progress: bool = False,
    **options: Unpack[SolveArguments],
) -> Assessment:
    """Try which tasks a robot can do, or each of several: how far, how clear, how long, and what holds it back.

    Parameters
    ----------
    robot : Robot, mapping of str to Robot, or iterable of Robot
        `sweep` makes robots that differ in fields of the robot file.
    tasks : mapping or iterable of (Target, list of Target, Follow, or Move)
        A target, several to be met at once, or a path; by name, or listed.
    scene : Scene or list of obstacles, optional
    progress : bool
        Whether to show on a terminal how many are done.
    **options
        As for `Solver`; `time` is the budget of one target.

    Returns
    -------
    Assessment

    Raises
    ------
    InputError
        When an argument is not what it should be, or a task asks for what a robot does not have.
    """
    robots, asked, place = _robots(robot), read_tasks(tasks), as_scene(scene)
    for name, each in robots.items():
        for task in asked:
            with checks.inside(f"tasks[{task!r}]" + (f" of {name}" if len(robots) > 1 else "")):
                asked[task].check(each)
    rows: list[TaskRow] = []
    with ProgressBar(len(robots) * len(asked) if checks.truth("progress", progress) else 0) as bar:
        for i, (name, each) in enumerate(robots.items()):
            with warnings.catch_warnings():
                if i:  # what is suspicious of the scene is said once
                    warnings.simplefilter("ignore", SuspiciousInput)
                solver = Solver(each, place, **options)
            for task in asked:
                rows.append(TaskRow(name, task, asked[task].kind, asked[task].do(solver)))
                bar.advance()
    return Assessment(tuple(rows))


def _robots(robot: Any) -> dict[str, Robot]:
    if isinstance(robot, Robot):
        return {robot.name or "robot": robot}
    if isinstance(robot, Mapping):
        named = {str(name): each for name, each in robot.items()}
    elif isinstance(robot, Iterable) and not isinstance(robot, str | bytes):
        listed = list(robot)
        names = [getattr(each, "name", None) or f"robot {i}" for i, each in enumerate(listed, 1)]
        again = next((name for name in names if names.count(name) > 1), None)
        if again is not None:
            raise InputError("robot", "two have the same name", again, "robots with names of their own")
        named = dict(zip(names, listed, strict=True))
    else:
        raise InputError("robot", "", robot, "a Robot, or robots by name")
    if not named:
        raise InputError("robot", "", robot, "at least one Robot")
    for name, each in named.items():
        checks.instance(f"robot[{name!r}]", each, Robot, "a Robot")
    return named


MOST_ROBOTS = 100_000

PLACES = ("base", "tool")
"""Poses, which a robot file need not say."""


def sweep(robot: Robot, fields: Mapping[str, Iterable[Any]]) -> dict[str, Robot]:
    """Make robots that differ in fields of the robot file.

    Parameters
    ----------
    robot : Robot
    fields : mapping of str to iterable
        Values of each field, as a robot file has them: `radius`, `base.position`, `segments.length` (of all segments),
        `segments[2].max_bend` (of one, 0 = first, or by its name: `segments[wrist].max_bend`),
        `segments.tendons.displacement`, `segments.count` (where all segments are equal).

    Returns
    -------
    dict of str to Robot
        Every combination, by what differs: `segments.count=4, radius=3`.

    Raises
    ------
    InputError
        When there is no such field, or a value is not what it should be.
    """
    checks.instance("robot", robot, Robot, "a Robot")
    if not isinstance(fields, Mapping) or not fields:
        raise InputError("fields", "", fields, "a mapping of fields to lists of values")
    listed = {}
    for field, values in fields.items():
        if isinstance(values, str) or not isinstance(values, Iterable):
            raise InputError(f"[{field!r}]", "", values, "a list of values")
        listed[field] = list(values)
    count = math.prod(map(len, listed.values()))
    if not 0 < count <= MOST_ROBOTS:
        raise InputError("fields", f"make {count} robots", list(listed), f"1 to {MOST_ROBOTS}")
    found = {}
    for values in product(*listed.values()):
        chosen = dict(zip(listed, values, strict=True))
        name = ", ".join(f"{field}={shown(value)}" for field, value in chosen.items())
        found[name] = with_fields(robot, chosen, "fields")
    return found


def with_fields(robot: Robot, chosen: Mapping[str, Any], where: str) -> Robot:
    """Return a robot with other values of some fields; `where` is what a refusal calls the mapping of them.

    A field may be an element of a list: `base.position[2]`.

    Raises
    ------
    InputError
        When there is no such field, or a value is not what it should be.
    """
    values = robot.to_dict()
    with checks.inside(where):
        for field, value in chosen.items():
            _put(values, field, value)
        return read_robot(values)


def value_of(robot: Robot, field: str) -> Any:
    """The value of a field in the file of a robot; `None` where it is not said, or segments differ in it."""
    try:
        places = _places(robot.to_dict(), field, None)
    except InputError:
        return None
    found = [entry.get(key) if isinstance(entry, dict) else entry[key] for entry, key in places]
    return found[0] if all(each == found[0] for each in found) else None


def _put(values: dict[str, Any], field: str, value: Any) -> None:
    """Set a field; a radius of the robot is that of all segments."""
    if field == "radius":
        for entry in _entries(values):
            entry.pop("radius", None)
    for entry, key in _places(values, field, value):
        entry[key] = value


def _places(values: dict[str, Any], field: str, value: Any) -> list[tuple[Any, Any]]:
    """Where a field stands that may be set to a value: mappings or lists, and the key or number in each."""
    first, *rest = field.split(".")
    match = re.fullmatch(r"segments(?:\[([^\]]+)\])?", first)
    if match is None:
        return [_place(values, [first, *rest], value, field)]
    if not rest:
        raise InputError(f"[{field!r}]", "names no field", field, "segments.KEY")
    entries = _entries(values) if match[1] is None else [_one_segment(values, match[1], field)]
    return [_place(entry, rest, value, field) for entry in entries]


def _entries(values: dict[str, Any]) -> list[dict[str, Any]]:
    entries = values["segments"]
    return [entries] if isinstance(entries, dict) else entries


def _one_segment(values: dict[str, Any], which: str, field: str) -> dict[str, Any]:
    """The mapping of one segment, by its place or its name; segments that were written together are taken apart."""
    apart = [
        copy.deepcopy({key: each for key, each in entry.items() if key != "count"})
        for entry in _entries(values)
        for _ in range(entry.get("count", 1))
    ]
    names = [entry.get("name", f"s{k + 1}") for k, entry in enumerate(apart)]
    places = {**{str(k): k for k in range(len(apart))}, **{name: k for k, name in enumerate(names)}}
    if which not in places:
        expected = f"0 to {len(apart) - 1}, or one of {', '.join(names)}"
        raise InputError(f"[{field!r}]", "there is no such segment", which, expected)
    values["segments"] = apart
    return apart[places[which]]


def _place(entry: dict[str, Any], path: list[str], value: Any, field: str) -> tuple[Any, Any]:
    """Find a field, or an element of a list: of a length that is one number, both ends are that.

    A robot that stands or carries its tool nowhere special has these places, too.
    """
    *outer, last = path
    if last == "count" and not outer and "length" not in entry:
        raise InputError(f"[{field!r}]", "is no field of it", value, "segments.count")
    for key in outer:
        if key in PLACES and key not in entry:
            entry[key] = {}
        if not isinstance(entry.get(key), dict):
            raise InputError(f"[{field!r}]", f"this robot has no {key}", value, "a field that is there")
        entry = entry[key]
    match = re.fullmatch(r"(\w+)\[(\d+)\]", last)
    if match is None:
        return entry, last
    last, i = match[1], int(match[2])
    listed = entry.get(last, [0.0, 0.0, 0.0] if last == "position" else None)
    if last == "length" and isinstance(listed, int | float):
        listed = [listed, listed]
    if not isinstance(listed, list) or i >= len(listed):
        raise InputError(f"[{field!r}]", "is no element of it", value, "an element of a list that is there")
    entry[last] = list(listed)
    return entry[last], i
