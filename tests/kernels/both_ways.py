"""Run problems of all kinds, with every call of an entry both compiled and interpreted, and compare what comes of them.

A process of its own: `python -m tests.kernels.both_ways`. It prints the entries that were called, with how many calls
were compared and the largest difference, then what differs by more; and which forms of entries were compiled ahead, and
which only for these problems. With names of steps of `sinuous warm` it takes these alone.
"""

import inspect
import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, ClassVar

import numpy as np

from sinuous.kernels import compile as compiling
from sinuous.kernels.compile.tiers import FREE, name_of
from sinuous.kernels.tables import SECONDS

NEAR = 1e-9
"""Most difference, of numbers up to 1, of larger ones as a share."""

SCRATCH = ("workspace", "buffer", "clock", "work", "scratch", "columns")
"""Arguments that nobody reads after the call."""

UNORDERED = ("lists",)
"""Results in which what is equally good stands in any order."""

TIMED = ("search", "search_many", "prefer")
"""Entries whose records have, in their last place, the seconds that it took."""

compared: Counter[str] = Counter()
largest: dict[str, float] = {}
apart: list[str] = []
made: list["Both"] = []


class Both:
    """An entry whose first calls are made both ways.

    Parameters
    ----------
    compiled : callable
    """

    most = 4
    """Most calls of one entry that are compared, one of a problem: they take a thousand times as long, interpreted."""

    met: ClassVar[set[str]] = set()
    """Entries of which a call was compared in this problem."""

    def __init__(self, compiled: Any) -> None:
        self.compiled, self.name = compiled, f"{compiled.__module__.partition('.')[2]}.{compiled.__name__}"
        self.arguments = list(inspect.signature(compiled.py_func).parameters)
        made.append(self)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.compiled, name)

    def __call__(self, *given: Any) -> Any:
        free = "scene" in self.arguments and given[self.arguments.index("scene")] is None
        name = self.name + FREE if free else self.name
        if compared[name] >= self.most or name in self.met:
            return self.compiled(*given)
        self.met.add(name)
        again = [_copied(one) for one in given]
        answer = self.compiled(*given)
        other = self.compiled.interpreted(*again)
        compared[name] += 1
        pairs = [("answer", answer, other), *zip(self.arguments, given, again, strict=True)]
        for part, one, two in pairs:
            if part not in SCRATCH:
                self._compare(name, part, _numbers(one), _numbers(two))
        return answer

    def _compare(self, name: str, part: str, one: Any, two: Any) -> None:
        if self.compiled.__name__ in TIMED:
            one, two = _timeless(part, one), _timeless(part, two)
        if part in UNORDERED:
            one, two = np.sort(one), np.sort(two)
        with np.errstate(invalid="ignore"):  # infinities
            off = np.abs(one - two) / np.maximum(1.0, np.abs(one))
            off = np.where((one == two) | (np.isnan(one) & np.isnan(two)), 0.0, off)
        most = float(np.nan_to_num(off, nan=math.inf).max(initial=0.0))
        largest[name] = max(largest.get(name, 0.0), most)
        if most > NEAR:
            apart.append(f"{name}, call {compared[name]}, {part}: {one[off > NEAR][:4]} against {two[off > NEAR][:4]}")


def _timeless(part: str, numbers: Any) -> Any:
    """Take the seconds out of a record, or out of a row that begins with one."""
    if part == "answer":
        return numbers[:-1]
    if part == "answers":
        numbers = numbers.copy()
        numbers[..., SECONDS] = 0.0
    return numbers


def _copied(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, tuple):
        parts = map(_copied, value)
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    return value


def _numbers(value: Any) -> Any:
    """All numbers of a value; an array keeps its shape."""
    return np.asarray(value, float) if isinstance(value, np.ndarray) else np.array(list(_flat(value)), float)


def _flat(value: Any) -> Iterator[float]:
    if isinstance(value, tuple):
        for one in value:
            yield from _flat(one)
    elif isinstance(value, np.ndarray):
        yield from value.ravel()
    elif value is not None:
        yield float(value)


def install() -> None:
    """Let all entries that are made from now on run both ways."""
    entry, around = compiling.entry, compiling.entry_around
    compiling.entry = lambda function: Both(entry(function))  # type: ignore[assignment, return-value]
    compiling.entry_around = lambda inner, function: Both(around(inner, function))  # type: ignore[assignment, return-value]


def problems() -> Iterator[tuple[str, Callable[[], object]]]:
    """Uses of the library that call all entries, by name."""
    import sinuous as sn
    from benchmarks.places import make
    from tests.scene.shapes import ball as ball_of_triangles

    robot = sn.Robot.uniform(3, (0.8, 1.2), radius=0.05, tendons=sn.Tendons(3, 0.05, displacement=(-1, 1)))
    bare = sn.Robot.uniform(4, (0.5, 1.5), radius=0.04, max_bend=2.0)
    corners = np.array([[1.5, 0, 1], [1.5, 1, 1], [2.5, 0, 1], [1.5, 0, 2.0]])
    mesh = sn.Mesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    cloud = sn.PointCloud(np.array([[2.0, 2.0, 2.0], [2.0, 2.0, 2.1], [1.0, 2.0, 1.0]]), 0.05)
    many = [
        sn.Sphere((0.5, 0, 1.5), 0.2),
        sn.Box((0, 1, 1), (0.2, 0.2, 3)),
        sn.Cylinder((1, -1, 0), (1, -1, 2), 0.1),
        sn.Capsule((-1, 0, 0), (-1, 0, 2), 0.1),
        mesh,
        cloud,
    ]
    target = sn.Target((1, 0, 2), direction=(1, 0, 0.5))
    turned = sn.Target((0.4, 0.3, 2.2), rotation=np.eye(3))
    few: Any = {"time": 60.0, "max_starts": 4}

    for who, body in (("tendons", robot), ("a bare robot", bare)):
        shape = np.tile([0.3, 0.2, 1.0], (len(body), 1))
        elbow, tip = (sn.Target(body.forward(shape)[k, :3, 3], segment=k + 1) for k in (1, len(body) - 1))
        for what, wish in (("a direction", target), ("a rotation", turned), ("an elbow", [tip, elbow])):
            for name, scene in (("nothing", None), ("everything", many)):
                yield f"{who}, {what}, among {name}", partial(sn.solve, body, wish, scene, **few)
    prefer = sn.Preferences(bends=1.0, clearance=0.1)
    yield "preferences", lambda: sn.solve(robot, target, prefer=prefer, **few)
    yield "preferences among obstacles", lambda: sn.solve(robot, target, many, prefer=prefer, **few)
    ball = sn.Scene(many[:1])
    solver = sn.Solver(robot, ball, **few)
    yield "many", lambda: solver.solve_many([target, sn.Target((1, 0.2, 2))])
    yield "classes", lambda: solver.solve_all(sn.Target((1, 0, 2)), count=2)
    solution = solver.solve(target)
    twist = (0.1, 0.0, 0.05, 0.0, 0.1, 0.0)
    yield "a tick", lambda: solver.step(solution.q, twist, 0.01)
    yield "a tick towards a target", lambda: solver.step(solution.q, target=sn.Target((1, 0.05, 2)), dt=0.01)
    pulled = sn.Tendons(3, 0.05, stiffness=500.0, tension=(0.0, 60.0))
    hanging = sn.Robot.uniform(
        2, 1.0, radius=0.05, tendons=pulled, stiffness=20.0, mass=0.2, arcs=2, gravity=(0, 0, -9.8)
    )
    yield "a tick under load", lambda: sn.Solver(hanging, ball).step([[0.3, 0.2, 1.0]] * 2, twist, 0.01)
    ends = solution, sn.Target((0.6, 0.4, 2.2))
    yield "a motion", lambda: sn.track(robot, sn.Target.each(np.array([[1, 0, 2], [1, 0.1, 2]])), ball)
    yield "a plan", lambda: sn.plan(robot, *ends, ball)
    yield "decimation", lambda: sn.Mesh(*ball_of_triangles(2)).decimated(0.2)
    yield "distances", lambda: (sn.Scene(many).distance(corners), sn.Scene(many).gradient(corners))
    door = make("door in mesh", 0)
    yield "a door", partial(sn.solve, door.robot, door.targets, door.scene, tolerance=door.tolerance, time=60)


def main() -> None:
    """Run all problems and print what was seen, as JSON."""
    install()
    from sinuous.cli.warm import steps
    from sinuous.scene import sampling

    failed: list[str] = []
    sampling.THREADS = 1  # threads write into one array, and each call is compared by itself
    sampling.LEAST = sampling.MOST = 2**10  # more say the same, and take most of the time
    sampling.CELLS, sampling.PAD = 100, 1

    def run(name: str, use: Callable[[], object]) -> None:
        Both.met.clear()
        try:
            use()
        except Exception as error:  # what a kernel raises, interpreted
            failed.append(f"{name}: {type(error).__name__}: {error}")

    chosen = sys.argv[1:]
    for step in steps():
        if not chosen or step.what in chosen:
            run(f"what is warmed for {step.what}", step.use)
    ahead = [name_of(one.compiled, form) for one in made for form in one.signatures]
    closed = [one.name for one in made for form in one.signatures if any("readonly" in str(each) for each in form)]
    forms = {one.name: len(one.signatures) for one in made}
    if not chosen:
        for name, use in problems():
            run(name, use)
    late = {one.name: str(one.signatures) for one in made if len(one.signatures) > forms[one.name]}
    forms_seen = {"ahead": ahead, "late": late, "closed": closed}
    print(json.dumps({"compared": compared, "largest": largest, "apart": apart, "failed": failed, **forms_seen}))  # noqa: T201


if __name__ == "__main__":
    main()
