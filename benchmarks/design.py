"""`python -m benchmarks design`: a design against the best of many random robots, and against the template.

Ten problems, in a drum with blades, beside a bent pipe and in a room, each with a template that does all its tasks.
"""

from collections.abc import Iterator
from itertools import islice, pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, timed
from sinuous.base.checks import Floats
from sinuous.scene.obstacles import Obstacle
from sinuous.studies.designing.find import DEFAULT_STARTS, SOLVE_SECONDS, design
from sinuous.studies.designing.judge import Judge, read_objectives
from sinuous.studies.designing.search import Space
from sinuous.studies.tasks.assess import assess
from sinuous.studies.tasks.tasks import read_tasks

SECTION = "a robot for 20 tasks, 4 varied fields, 2 workers, against {count} random ones"
PROBLEMS = 10
ROBOTS = 600

TASKS = 20
FAR = 400
"""Shapes that are drawn at most for each task."""


class DesignProblem(NamedTuple):
    """What is asked.

    Attributes
    ----------
    name : str
    template : Robot
        Does all tasks: each is where its tip is in a clear shape.
    tasks : list of Target
    scene : list of Obstacle
    vary : dict
        Four fields.
    minimise : str
    """

    name: str
    template: sn.Robot
    tasks: list[sn.Target]
    scene: list[Obstacle]
    vary: dict[str, Any]
    minimise: str


def problem(number: int, rng: Generator) -> DesignProblem:
    """Return problem `number`: kinds and objectives take turns."""
    kinds = ("drum", "pipe", "room")
    kind, minimise = kinds[number % 3], ("length", "bend", "clearance")[number // 3 % 3]
    template = sn.Robot.uniform(4, 100.0, max_bend=1.8, radius=4.0)
    scene = {"drum": _drum, "pipe": _pipe, "room": _room}[kind](rng)
    vary = {
        "segments.count": [3, 4, 5],
        "segments.length": (50.0, 140.0),
        "segments.max_bend": (0.8, 2.4),
        "base.position[2]": (-40.0, 60.0),
    }
    return DesignProblem(f"{kind} {number}, {minimise}", template, _tasks(template, scene, rng), scene, vary, minimise)


def _drum(rng: Generator) -> list[Obstacle]:
    """A drum about the robot, with blades that stand out of its wall."""
    drum: list[Obstacle] = [sn.Cylinder((0.0, 0.0, -200.0), (0.0, 0.0, 600.0), 260.0, inside=True, name="drum")]
    for angle in rng.uniform(0.0, 2.0 * np.pi) + np.arange(5) * 2.0 * np.pi / 5.0:
        way = np.array([np.cos(angle), np.sin(angle), 0.0])
        place = 220.0 * way + (0.0, 0.0, rng.uniform(120.0, 280.0))
        across = np.array([-way[1], way[0], 0.0])
        drum.append(sn.Box(place, (90.0, 8.0, 120.0), np.column_stack([way, across, (0.0, 0.0, 1.0)])))
    return drum


def _pipe(rng: Generator) -> list[Obstacle]:
    """A pipe of capsules that bends away from the base, and the robot reaches around it."""
    places = [np.array([rng.uniform(60.0, 90.0), 0.0, 60.0])]
    for turn in rng.uniform(-0.5, 0.5, 4):
        places.append(places[-1] + 70.0 * np.array([np.sin(turn), np.cos(turn) * 0.3, 0.9]))
    return [sn.Capsule(a, b, 22.0) for a, b in pairwise(places)]


def _room(rng: Generator) -> list[Obstacle]:
    """A room with a table, a beam and some balls."""
    room: list[Obstacle] = [sn.Box((0.0, 0.0, 200.0), (700.0, 700.0, 700.0), inside=True, name="room")]
    room.append(sn.Box((130.0, rng.uniform(-40.0, 40.0), 100.0), (80.0, 200.0, 20.0), name="table"))
    room.append(sn.Box((-120.0, 0.0, rng.uniform(220.0, 280.0)), (30.0, 400.0, 30.0), name="beam"))
    for _ in range(4):
        way = rng.normal(size=3)
        room.append(sn.Sphere(170.0 * way / np.linalg.norm(way) + (0.0, 0.0, 220.0), 28.0))
    return room


def _tasks(template: sn.Robot, scene: list[Obstacle], rng: Generator) -> list[sn.Target]:
    """Places of the tip in clear shapes of the template."""
    shapes = (_shape(template, rng) for _ in range(FAR * TASKS))
    clear = (q for q in shapes if sn.check(template, q, scene).ok)
    return [sn.Target(template.tip(q)[:3, 3]) for q in islice(clear, TASKS)]


def _shape(template: sn.Robot, rng: Generator) -> Floats:
    ways = rng.normal(size=(len(template), 2))
    bends = rng.uniform(0.1, 1.2, size=(len(template), 1)) * ways / np.linalg.norm(ways, axis=1)[:, None]
    return np.column_stack([bends, np.full(len(template), 100.0)])


def measure(plan: Plan) -> Iterator[Line]:
    """A line a problem, then how often it was better, and the longest time."""
    problems, count = plan.count(PROBLEMS, 1), plan.count(1000, 20)
    section = SECTION.format(count=f"{count:,}")
    seconds, better, beyond = [], 0, 0
    for number in range(problems):
        asked = problem(number, plan.rng(91, number))
        given = asked.template, asked.tasks, asked.scene
        robots = plan.count(ROBOTS, 64)
        options: dict[str, Any] = {"vary": asked.vary, "minimise": asked.minimise, "robots": robots, "workers": 2}
        found, spent = timed(design, *given, **options)
        seconds.append(spent)
        best = np.inf if found.best is None else _least(asked, found.best.objectives[asked.minimise])
        true = found.solved and assess(found.robot, asked.tasks, asked.scene).solved
        chance, template = _random(asked, count, plan)
        better += bool(true and best < chance)
        beyond += bool(true and best < template)
        told = f"template {abs(template):.4g}, best of {count:,} random {abs(chance):.4g}; {found.tried:,} tried"
        yield Line(section, asked.name, abs(float(best)), "", note=told)
        yield Line(section, f"{asked.name}: time", seconds[-1], "s")
    yield Line(section, "better than the best random robot", float(better), "", Goal(0.9 * problems, at_most=False))
    yield Line(section, "better than the template", float(beyond), "", Goal(float(problems), at_most=False))
    yield Line(section, "longest time", max(seconds), "s", Goal(60.0))


def _least(asked: DesignProblem, value: float) -> float:
    return -value if asked.minimise == "clearance" else value


def _random(asked: DesignProblem, count: int, plan: Plan) -> tuple[float, float]:
    """The least of random robots that do all tasks, and what the template has."""
    space = Space(asked.template, asked.vary)
    minimise = read_objectives(asked.minimise, asked.template)
    options = {"time": SOLVE_SECONDS, "max_starts": DEFAULT_STARTS}
    judge = Judge(space, read_tasks(asked.tasks), sn.Scene(asked.scene), minimise, options)
    rng, least = plan.rng(92), np.inf
    for _ in range(count):
        combination = space.combinations[int(rng.integers(len(space.combinations)))]
        robot = space.robot(combination, rng.random(len(space.ranges)))
        least = min(least, judge.judge(robot, np.array([least]), stops=True).objectives[0])
    return least, judge.judge(asked.template).objectives[0]


PARTS: dict[str, Part] = {"contest": measure}
"""What is measured, by name."""
