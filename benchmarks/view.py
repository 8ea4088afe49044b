"""`python -m benchmarks view`: from an event of the mouse to a new shape, and pages in files."""

import os
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice
from pathlib import Path

import numpy as np

import sinuous as sn
from benchmarks.harness import Goal, Line, Part, Plan, Times, timed
from benchmarks.places import solids
from sinuous.base.checks import Floats
from sinuous.cli.view import TURN
from sinuous.view.page.page import Page

SECTION = "pages: 100 spheres and a mesh of 50,000 triangles"
IN_FILES = "pages in files: 200 knots of 8 segments among 100 obstacles"
RATE = 30.0
"""Events a second, as many as a hand makes."""


def job() -> sn.Job:
    """A robot of 8 segments among spheres, over a mesh."""
    rng = np.random.default_rng(0)
    robot = sn.Robot.uniform(8, length=(45, 70), max_bend=2.4, radius=4)
    beneath = solids.ball(np.array([0.0, 0.0, -140.0]), 80.0, 159).mesh("ball")  # 50,244 triangles
    scene = [beneath if i == 0 else sn.Sphere(place, 12) for i, place in enumerate(islice(_places(rng), 101))]
    return sn.Job(robot, sn.Target((150, 60, 300)), scene)


def _places(rng: np.random.Generator) -> Iterator[Floats]:
    """Draw places that are neither at the robot's base nor where it has to go, without end."""
    while True:
        place = rng.uniform((-300, -300, -100), (300, 300, 450))
        if np.linalg.norm(place) > 70 and np.hypot(place[0] - 100, place[1] - 40) > 120:
            yield place


def drags(plan: Plan) -> Iterator[Line]:
    """Drag the target, and a sphere, along curves, at the pace of a hand."""
    sys.setswitchinterval(TURN)  # as the command does
    page = Page(job())
    try:
        count = plan.count(600, 60)
        target = partial(page.move_target, 0)
        yield from _lines("target dragged", _times(page, count, lambda t: target(_curve(t), np.eye(3))))
        page.do("grasp", lambda: page.model.grasp(50))
        time.sleep(1.0)
        yield from _lines(
            "sphere dragged", _times(page, count, lambda t: page.move_obstacle(_aside(t), np.eye(3), False))
        )
    finally:
        page.stop()


def _curve(t: float) -> Floats:
    return np.array([150 + 60 * np.cos(t), 60 + 60 * np.sin(t), 300 + 20 * np.sin(3 * t)])


def _aside(t: float) -> Floats:
    return np.array([-200 + 60 * np.cos(t), -100 + 60 * np.sin(t), 200.0])


def _times(page: Page, count: int, move: Callable[[float], None]) -> list[float]:
    """Seconds from an event to the shape that answers it."""
    done = threading.Event()
    seconds = []
    page.answered = lambda number: done.set() if number > before else None
    for i in range(count):
        before = page.model.number
        done.clear()
        began = time.perf_counter()
        move(2 * np.pi * i / 200)
        done.wait(10.0)
        seconds.append(time.perf_counter() - began)
        time.sleep(max(0.0, 1 / RATE - seconds[-1]))
    return seconds


def _lines(what: str, seconds: list[float]) -> Iterator[Line]:
    times = Times.of(seconds)
    yield Line(SECTION, f"{what}: event to new shape, median", times.median, "ms", Goal(5e-3), times)
    yield Line(SECTION, f"{what}: event to new shape, p99", times.p99, "ms", Goal(20e-3), times)


def files(_: Plan) -> Iterator[Line]:
    """Write a motion as a page."""
    rng = np.random.default_rng(1)
    robot = sn.Robot.uniform(8, length=(45, 70), max_bend=2.4, radius=4)
    scene = sn.Scene([sn.Sphere(place, 12) for place in islice(_places(rng), 100)])
    shares = np.linspace(0.0, 1.0, 200)[:, None, None]
    ends = rng.uniform((-0.5, -0.5, 50), (0.5, 0.5, 65), (2, 8, 3))
    motion = sn.Motion(robot, (1 - shares) * ends[0] + shares * ends[1], scene)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "motion.html"
        sn.show(motion, path=file)
        seconds, size = timed(sn.show, motion, path=file)[1], os.path.getsize(file)
    yield Line(IN_FILES, "written in", seconds, "s", Goal(2.0))
    yield Line(IN_FILES, "size", size / 1e6, "MB", Goal(5.0))


PARTS: dict[str, Part] = {"drags": drags, "files": files}
"""What is measured, by name."""
