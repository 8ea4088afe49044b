"""`assess`: which of a set of tasks robots can do."""

import warnings
from collections.abc import Iterable, Mapping
from typing import Any, Unpack

from sinuous import checks
from sinuous.assessing.assessment import Assessment, Row
from sinuous.assessing.tasks import read_tasks
from sinuous.errors import InputError, SuspiciousInput
from sinuous.progress import ProgressBar
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike, as_scene
from sinuous.solving.options import SolveArguments
from sinuous.solving.solver import Solver


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
    rows: list[Row] = []
    with ProgressBar(len(robots) * len(asked) if checks.truth("progress", progress) else 0) as bar:
        for i, (name, each) in enumerate(robots.items()):
            with warnings.catch_warnings():
                if i:  # what is suspicious of the scene is said once
                    warnings.simplefilter("ignore", SuspiciousInput)
                solver = Solver(each, place, **options)
            for task in asked:
                rows.append(Row(name, task, asked[task].kind, asked[task].do(solver)))
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
