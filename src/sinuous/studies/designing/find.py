"""`design`: a robot for a set of tasks; and the file that asks for one.

It holds a robot, obstacles, tasks, what is varied and what is minimised.
"""

import json
import pickle
import time as clock
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.status import Status
from sinuous.base import checks
from sinuous.base.arguments import Number, Whole
from sinuous.base.errors import InputError
from sinuous.base.progress import ProgressBar
from sinuous.files.documents import read_values
from sinuous.files.nouns import known_entries, read_question
from sinuous.model.robot import Robot
from sinuous.motion.job import Job, job_of
from sinuous.scene.scene import SceneLike, as_scene
from sinuous.solver.many import read_workers
from sinuous.solver.options import SolveArguments
from sinuous.solver.solver import Solver
from sinuous.studies.designing.descent import Judging, can_descend
from sinuous.studies.designing.design import Change, Cut, Design, FoundRobot
from sinuous.studies.designing.judge import Judge, Objective, read_objectives
from sinuous.studies.designing.search import Drawn, RobotCandidates, RobotSearch, Space, front
from sinuous.studies.runs.engine import Arrays, Checkpoint, Engine, hash_of, problem_record
from sinuous.studies.runs.engines import open_engine
from sinuous.studies.tasks.tasks import Cover, Follow, Meet, Move, read_tasks

DEFAULT_ROBOTS = 2000
"""Robots that are judged, by default."""

DEFAULT_SECONDS = 60.0
"""Seconds, by default."""

DEFAULT_STARTS, SOLVE_SECONDS = 24, 1.0
"""Most starts and seconds of a target, by default: a robot that needs more is not one to build."""

FIELD_CHANGE = 0.01
"""Change of a field whose cost is told."""

PROOFS = (Status.OUT_OF_REACH, Status.TARGET_BLOCKED, Status.BASE_BLOCKED)
"""Statuses that are proofs, and cheap."""


def design(
    template: Robot,
    tasks: Mapping[str, Any] | Iterable[Any],
    scene: SceneLike | None = None,
    *,
    vary: Mapping[str, Any],
    minimise: str | Iterable[str],
    robots: Whole = DEFAULT_ROBOTS,
    budget: Number = DEFAULT_SECONDS,
    engine: object = "threads",
    workers: Whole | None = None,
    out: str | Path | None = None,
    progress: bool = False,
    **options: Unpack[SolveArguments],
) -> Design:
    """Find the robot that does all tasks and has the least of something: the best of a template's variations.

    What no robot with some listed values can do is proved where that is possible, and not tried. The others are tried
    in generations: near the best that are known, and anywhere. Each is judged by all tasks, solved and proved.

    Parameters
    ----------
    template : Robot
    tasks : mapping or iterable of (Target, list of Target, Follow, Cover, or Move)
        As for `assess`.
    scene : Scene or list of obstacles, optional
    vary : mapping of str to (low, high) or list
        Fields of the robot file, as for `sweep`, and elements of lists like `base.position[2]`: each with a range (a
        tuple of two numbers) or a list of values.
    minimise : str or two of them
        `actuators` (their number), `length`, `bend` (largest), `travel` (of actuators), `tension` (largest),
        `clearance` (the least; it is maximised), `uncovered` (share of targets that are not met). Of two the front is
        found: robots that no other is better than.
    robots : int
        How many are judged.
    budget : float
        Seconds; the generation that is under way is finished.
    engine : str, executor or Dask client
        As for `solve_batch`.
    workers : int, optional
        By default one a core.
    out : path, optional
        The table of the front (CSV). Until it is there, a folder beside it keeps what is done, and the same call goes
        on where an earlier one was interrupted.
    progress : bool
        Whether to show on a terminal how many are judged.
    **options
        As for `Solver`, of each target: by default `time` is 1 s and `max_starts` 24.

    Returns
    -------
    Design

    Raises
    ------
    InputError
        When an argument is not what it should be, or it is proved that no robot of these can do a task.
    UnfinishedError
        When workers are lost; what is done is kept beside `out`.
    """
    began = clock.perf_counter()
    space, asked, place = Space(template, vary), read_tasks(tasks), as_scene(scene)
    wanted = read_objectives(minimise, template)
    count, seconds = checks.integer("robots", robots, 1, 10_000_000), checks.number("budget", budget, above=0.0)
    chosen: dict[str, Any] = {"time": SOLVE_SECONDS, "max_starts": DEFAULT_STARTS, **options}
    judge = Judge(space, asked, place, wanted, chosen)
    Solver(template, place, **chosen)  # options are checked, and what is suspicious of the template is said
    cut = list(_cut(judge)) if "uncovered" not in wanted else []
    tried_not = {number for number, _ in cut}
    left = [number for number in range(len(space.combinations)) if number not in tried_not]
    if not left:
        first = cut[0][1]
        raise InputError("tasks", f"no robot of these can do {first.task}: {first.reason}", list(asked), "wider ranges")
    sizes, seed = (len(asked), space.segments), int(chosen.get("seed", 0))
    search = RobotSearch(left, len(space.ranges), seed, sizes, space.shares_of(template), can_descend(judge))
    with ProgressBar(count if checks.truth("progress", progress) else 0) as bar:
        run = _DesignRun(judge, search, _kept(judge, out), bar.advance)
        found = run.until(count, began + seconds, engine, read_workers(workers))
    result = _told(judge, found, tuple(each for _, each in cut), clock.perf_counter() - began)
    if out is not None:
        result.to_csv(out)
        run.kept.remove()
    return result


class _DesignRun:
    """A search under way: generations are judged by an engine, and kept."""

    def __init__(self, judge: Judge, search: RobotSearch, kept: Checkpoint, advance: Any) -> None:
        self._judge, self._search, self.kept, self._advance = judge, search, kept, advance
        self._found: list[RobotCandidates] = []

    def until(self, count: int, end: float, engine: Any, workers: int) -> RobotCandidates:
        """Judge generations until there are `count` robots, or the time is over."""
        self.kept.open()
        known = len(self.kept.done())
        with open_engine(engine, Judging(self._judge), workers) as ready:
            while sum(int(each.tried.sum()) for each in self._found) < count:
                number = len(self._found)
                if number >= max(1, known) and clock.perf_counter() >= end:
                    break
                drawn = self._search.generation(number, self._found)
                rows = self.kept.once(number, partial(self._judged, ready, drawn, workers))
                own = {name: rows[name] for name in RobotCandidates._fields if name not in ("combination", "source")}
                self._found.append(RobotCandidates(combination=drawn.combination, source=drawn.source, **own))
                self._advance(int(rows["tried"].sum()))
        return RobotCandidates.joined(self._found)

    def _judged(self, engine: Engine, drawn: Drawn, workers: int) -> Arrays:
        """Have a generation judged, in chunks for all workers."""
        told, count = self._known(), len(drawn.combination)
        parts = np.array_split(np.arange(count), min(count, 4 * workers))
        chunks = ({**told, **{name: each[part] for name, each in drawn._asdict().items()}} for part in parts)
        blocks = engine.results(chunks, "a robot could not be judged")
        return {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}

    def _known(self) -> Arrays:
        """What judges are told of the generations before: see `Judge.judge`."""
        count, objectives = len(self._judge.tasks), len(self._judge.minimise)
        bounds, order, stops = np.full(objectives, np.inf), np.arange(count), False
        if self._found:
            found = RobotCandidates.joined(self._found)
            stops = bool(np.isfinite(found.objectives).any())
            order = np.argsort(-np.bincount(found.failed[found.failed >= 0], minlength=count), kind="stable")
            if objectives == 1:  # of two, a robot that is better in neither than some may still be in the front
                bounds = found.objectives.min(axis=0)
        return {"bounds": bounds, "order": order, "stops": np.array(stops)}


def _kept(judge: Judge, out: str | Path | None) -> Checkpoint:
    """Where generations are kept."""
    if out is None:
        return Checkpoint(None, {}, "this design")
    solver = judge.solver(judge.space.template)
    record = {
        **problem_record(judge.space.template, judge.scene.snapshot(), solver.options),
        "vary": json.dumps([list(map(str, each)) for each in (*judge.space.ranges, *judge.space.choices)]),
        "tasks": hash_of(pickle.dumps({name: vars(task) for name, task in judge.tasks.items()})),
        "minimise": ", ".join(judge.minimise),
    }
    return Checkpoint(Path(out), record, "this design")


def _cut(judge: Judge) -> Iterator[tuple[int, Cut]]:
    """Yield the combinations that a proof rules out: their numbers, and by which task."""
    for number, combination in enumerate(judge.space.combinations):
        widest = judge.space.widest(combination)
        if widest is None:
            continue
        robot, moved = widest
        values = {each.field: value for each, value in zip(judge.space.choices, combination, strict=True)}
        for name, task in judge.tasks.items():
            reason = _impossible(judge, robot, moved, task)
            if reason is not None:
                yield number, Cut(values, name, reason)
                break


def _impossible(judge: Judge, robot: Robot, moved: float, task: Any) -> str | None:
    """Why no robot that does no more than this one, with its base up to `moved` away, does a task; `None`: unknown.

    That the base may move is as if targets might: so they may be missed by as much, and obstacles do not count.
    """
    if not isinstance(task, Meet) or (moved > 0.0 and robot.actuation.size):
        return None
    try:
        task.check(robot)
        solver = judge.solver(robot)
        tolerance = solver.tolerance
        if moved > 0.0:
            wide = tolerance.__class__((tolerance.position or 0.0) + moved, tolerance.angle)
            solver = Solver(robot, None, tolerance=wide)
        found: Solution = solver.solve(task.targets, time=0.0)
    except InputError as error:
        return str(error)
    return found.sentence if found.status in PROOFS else None


def _told(judge: Judge, found: RobotCandidates, cut: tuple[Cut, ...], seconds: float) -> Design:
    best = front(found.objectives)
    names = list(judge.tasks)
    robots = tuple(_found(judge, found, int(i)) for i in best)
    changes = tuple(_changes(judge, found, int(best[0]))) if len(best) else ()
    failed = Counter(change.failed for change in changes if change.failed is not None)
    if not failed:
        tried = found.failed[found.failed >= 0]
        failed = Counter(names[i] for i in tried.tolist())
    deciding = failed.most_common(1)[0][0] if failed else None
    judged = int(found.tried[found.failed != -2].sum())
    most = int(found.done.max(initial=0))
    return Design(judge.minimise, robots, deciding, changes, cut, judged, most, len(names), seconds)


def _found(judge: Judge, found: RobotCandidates, i: int) -> FoundRobot:
    space = judge.space
    combination, shares = space.combinations[int(found.combination[i])], found.shares[i]
    robot = space.robot(combination, shares)
    assert robot is not None
    objectives = _signed(judge.minimise, found.objectives[i])
    values = space.values(combination, shares)
    answers = {
        name: q[: len(robot)] for name, q in zip(judge.tasks, found.answers[i], strict=True) if not np.isnan(q[0, 0])
    }
    return FoundRobot(robot, values, objectives, int(found.done[i]), len(judge.tasks), float(found.share[i]), answers)


def _signed(minimise: tuple[Objective, ...], values: Iterable[float]) -> dict[str, float]:
    """Objectives as they are told: the clearance with its own sign."""
    return {name: float(-value if name == "clearance" else value) for name, value in zip(minimise, values, strict=True)}


def _changes(judge: Judge, found: RobotCandidates, i: int) -> Iterator[Change]:
    """Yield what becomes of a robot when one of its fields changes by a percent."""
    space, names = judge.space, list(judge.tasks)
    combination = space.combinations[int(found.combination[i])]
    for place, each in enumerate(space.ranges):
        value = each.value(float(found.shares[i, place]))
        step = FIELD_CHANGE * (abs(value) or each.high - each.low)
        for other in (value - step, value + step):
            shares = found.shares[i].copy()
            shares[place] = each.share(other)
            judged = judge.judge(space.robot(combination, shares), begin=found.answers[i])
            counts = np.isfinite(judged.objectives).all()
            objectives = _signed(judge.minimise, judged.objectives) if counts else None
            yield Change(each.field, other, objectives, None if judged.failed == -1 else names[judged.failed])


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
