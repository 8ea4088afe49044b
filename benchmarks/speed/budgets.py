"""Whether the time that a solve is allowed is kept: how much longer it takes, where the time is used up."""

from collections.abc import Iterator
from functools import cache
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times
from benchmarks.places import Place, make
from benchmarks.problems import among_spheres, arm, reachable, relative_tolerance
from benchmarks.wild.worlds import clutter
from sinuous.base.checks import Floats
from sinuous.methods.method import METHODS, capabilities

SECTION = "budgets of 1 to 100 ms: how much longer a solve takes that uses its budget up"
SHORTEST, LONGEST = 1e-3, 0.1
TYPICAL, WORST = Goal(1e-3), Goal(5e-3)
TAKEN_AWAY = 3e-4
"""Seconds for which a process may have lost the processor in a run that counts: they count as if it had worked."""

TRIES = 4
"""Runs of a problem, until there is one that counts."""

PLACES = ("pipe 1.6", "plates", "drum", "shelf", "duct", "spheres 100", "pipe 1.6 scan", "plates scan", "shelf scan")


class Asked(NamedTuple):
    """A solver, and what it is asked."""

    solver: sn.Solver
    target: Any
    initial: Floats | None = None


class Kept(NamedTuple):
    """What came of one problem.

    Attributes
    ----------
    over : float
        Seconds beyond the budget; negative where it was not used up.
    undisturbed : bool
        Whether the process had the processor all the time.
    told : str
        What it was, to make it again.
    """

    over: float
    undisturbed: bool
    told: str


def measure(plan: Plan) -> Iterator[Line]:
    """Two lines a family, and what the wall clock says when disturbed runs count as well."""
    everything: list[Kept] = []
    for number, (name, draw, count) in enumerate(FAMILIES):
        rng = plan.rng(13, number)
        asked = draw(plan, rng)
        kept = [_run(next(asked), rng, f"{name} {i}") for i in range(plan.count(count, 12))]
        everything += kept
        yield from _lines(name, kept)
    yield from _lines("all", everything)
    wall = Times.of([max(0.0, one.over) for one in everything])
    lost = sum(not one.undisturbed for one in everything)
    note = f"{lost} of {len(everything)} never had the processor to themselves in {TRIES} runs"
    yield Line(SECTION, "all, with what other processes took away", wall.p99, "ms", None, wall, note=note)


def _lines(name: str, kept: list[Kept]) -> Iterator[Line]:
    """Tail and worst of the problems that used up their budgets, of those runs that nobody disturbed."""
    late = [one for one in kept if one.over > 0.0 and one.undisturbed]
    times = Times.of([one.over for one in late] or [0.0])
    worst = max(late, key=lambda one: one.over, default=None)
    note = f"{len(late)} of {len(kept)} used up their budgets" + ("" if worst is None else f"; worst: {worst.told}")
    yield Line(SECTION, f"{name}, 99 of 100", times.p99, "ms", TYPICAL, times, note=note)
    yield Line(SECTION, f"{name}, worst", times.worst, "ms", WORST, times)


def _run(asked: Asked, rng: Generator, name: str) -> Kept:
    """Solve a problem until nobody disturbs it, and nothing happens that does not happen again: the least counts."""
    budget = float(np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST))))
    runs = []
    for _ in range(TRIES):
        worked, began = thread_time(), perf_counter()
        solution = asked.solver.solve(asked.target, asked.initial, time=budget)
        seconds, worked = perf_counter() - began, thread_time() - worked
        undisturbed = seconds - worked < TAKEN_AWAY
        runs.append((not undisturbed, seconds - budget))
        if seconds <= budget or (undisturbed and seconds - budget <= TYPICAL.value):
            break
    disturbed, over = min(runs)
    told = f"{name}, {1e3 * budget:.3g} ms, {solution.method}, {solution.status}, {solution.starts} starts"
    return Kept(over, not disturbed, told)


def _perhaps_torn(robot: sn.Robot, target: sn.Target, rng: Generator) -> sn.Target | list[sn.Target]:
    """Ask in half of the cases for a place of the last segment but one too, too far away: nobody proves that."""
    if rng.random() < 0.5:
        return target
    assert target.position is not None
    away = rng.normal(size=3)
    away *= rng.uniform(1.1, 1.5) * robot.segments[-1].length[1] / np.linalg.norm(away)
    return [target, sn.Target(target.position + away, segment=len(robot) - 1)]


def _free(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """Arms of 5 to 60 segments, to be met exactly."""
    sizes = [5, 12, 30, 60]
    solvers = []
    for n in sizes:
        robot = arm(n, 12.0 / n)
        solvers.append(sn.Solver(robot, tolerance=relative_tolerance(robot, 1e-6)))
    while True:
        solver = solvers[rng.integers(len(solvers))]
        (target,) = reachable(solver.robot, 1, rng).targets
        yield Asked(solver, _perhaps_torn(solver.robot, target, rng))


def _spheres(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """Arms of 5 to 20 segments among 40 to 600 balls; most targets are drawn without looking at these."""
    sizes = (5, 40), (20, 40), (8, 200), (12, 600)
    sets = [among_spheres(arm(n, 12.0 / n, radius=2.0), m, 20, rng) for n, m in sizes]
    solvers = [sn.Solver(each.robot, each.scene) for each in sets]
    while True:
        i = rng.integers(len(sets))
        drawn = sets[i].targets[rng.integers(20)] if rng.random() < 0.3 else reachable(sets[i].robot, 1, rng).targets[0]
        yield Asked(solvers[i], _perhaps_torn(sets[i].robot, drawn, rng))


@cache
def _made(count: int, families: int) -> list[tuple[Place, sn.Solver]]:
    """Make so many places of so many families."""
    places = [make(family, seed) for family in PLACES[:families] for seed in range(count)]
    return [(place, sn.Solver(place.robot, place.scene, tolerance=place.tolerance)) for place in places]


def _places(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """Pipes, plates and others of meshes, boxes and clouds: the hidden target, and others about it."""
    made = _made(plan.count(3, 1), plan.count(len(PLACES), 1))
    while True:
        place, solver = made[rng.integers(len(made))]
        target = place.target
        assert target.position is not None
        aside = rng.choice([0.0, 0.02, 0.2]) * place.robot.mean_length * rng.normal(size=3)
        moved = sn.Target(target.position + aside, direction=target.direction)
        yield Asked(solver, _perhaps_torn(place.robot, moved, rng))


def _clutter(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """Random robots among all kinds of obstacles, targets possible and not."""
    sets = [clutter(int(rng.integers(10**6)), 40) for _ in range(plan.count(25, 2))]
    solvers = [sn.Solver(each.robot, each.scene) for each in sets]
    while True:
        i = rng.integers(len(sets))
        yield Asked(solvers[i], _perhaps_torn(sets[i].robot, sets[i].targets[rng.integers(40)], rng))


def _grazing(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """A straight body that is along all of a wall nearer to it than anybody can see: a proof takes many looks."""
    solvers = []
    for gap in (1e-3, 1e-5, 1e-7, 1e-9):
        robot = sn.Robot.uniform(5, (45, 70), 2.4, radius=4.0)
        solvers.append(sn.Solver(robot, [sn.HalfSpace((4.0 + gap, 0, 0), (-1, 0, 0)) for _ in range(3)]))
    while True:
        length = rng.uniform(50, 65)
        target = sn.Target((0, 0, 5 * length), direction=(0, 0, 1))
        yield Asked(solvers[rng.integers(len(solvers))], target, np.tile([0.0, 0.0, length], (5, 1)))


def _preferences(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """The same as among spheres, in places and along a wall, and what is solved is then improved."""
    wishes = [sn.Preferences(bends=1.0), sn.Preferences(clearance=5.0), sn.Preferences(start=1.0, clearance=5.0)]
    solvers: dict[tuple[int, int], sn.Solver] = {}
    sources = [_spheres(plan, rng), _places(plan, rng)]
    while True:
        asked, wish = next(sources[rng.integers(len(sources))]), int(rng.integers(len(wishes)))
        key = id(asked.solver), wish
        if key not in solvers:
            plain = asked.solver
            solvers[key] = sn.Solver(plain.robot, plain.scene, tolerance=plain.tolerance, prefer=wishes[wish])
        yield asked._replace(solver=solvers[key])


def _methods(plan: Plan, rng: Generator) -> Iterator[Asked]:
    """All other methods, on arms of 5 to 20 segments among 40 balls, or without any."""
    sets = [among_spheres(arm(n, 12.0 / n, radius=2.0), 40, 20, rng) for n in (5, 20)]
    sets += [reachable(arm(n, 12.0 / n), 20, rng) for n in (5, 20)]
    solvers = []
    for name in METHODS:
        for each in sets:
            refused = len(each.scene) and not capabilities(name).obstacles
            if name != "newton" and not refused:
                solvers.append((sn.Solver(each.robot, each.scene, method=name), each))
    while True:
        solver, each = solvers[rng.integers(len(solvers))]
        yield Asked(solver, each.targets[rng.integers(20)])


FAMILIES = (
    ("free", _free, 1500),
    ("spheres", _spheres, 1500),
    ("places", _places, 2500),
    ("clutter", _clutter, 1000),
    ("along a wall", _grazing, 1000),
    ("preferences", _preferences, 1000),
    ("other methods", _methods, 1500),
)
"""Names, what draws the problems, and how many there are: 10,000 in all."""
