"""Whether the time that a solve is allowed is kept: how much longer it takes, where the time is used up."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from time import perf_counter, thread_time
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

import sinuous as sn
from benchmarks.harness import Goal, Line, Plan, Times
from benchmarks.places import Place, make
from benchmarks.problems import ProblemSet, among_spheres, arm, reachable
from benchmarks.wild.worlds import clutter
from sinuous.methods.method import METHODS, capabilities

SECTION = "budgets of 1 to 100 ms: how much longer a solve takes that uses its budget up"
SHORTEST, LONGEST = 1e-3, 0.1
TYPICAL, WORST = Goal(1e-3), Goal(5e-3)
TAKEN_AWAY = 3e-4
"""Seconds for which a process may have lost the processor in a run that counts: they count as if it had worked."""

TRIES = 4
"""Runs of a problem, until there is one that counts."""

PLACES = ("pipe 1.6", "plates", "drum", "shelf", "duct", "spheres 100", "pipe 1.6 scan", "plates scan", "shelf scan")


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
    for number, family in enumerate(FAMILIES):
        rng = plan.rng(13, number)
        asked = _asked(family, plan, rng)
        kept = [_run(*next(asked), rng, f"{family.name} {i}") for i in range(plan.count(family.problems, 12))]
        everything += kept
        yield from _lines(family.name, kept)
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


def _run(solver: sn.Solver, target: Any, rng: Generator, name: str) -> Kept:
    """Solve a problem until nobody disturbs it, and nothing happens that does not happen again: the least counts."""
    budget = float(np.exp(rng.uniform(np.log(SHORTEST), np.log(LONGEST))))
    runs = []
    for _ in range(TRIES):
        worked, began = thread_time(), perf_counter()
        solution = solver.solve(target, time=budget)
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
    if rng.random() < 0.5 or len(robot) == 1:
        return target
    assert target.position is not None
    away = rng.normal(size=3)
    away *= rng.uniform(1.1, 1.5) * robot.segments[-1].length[1] / np.linalg.norm(away)
    return [target, sn.Target(target.position + away, segment=len(robot) - 1)]


def _free(plan: Plan, rng: Generator) -> list[ProblemSet]:
    """Arms of 5 to 60 segments, to be met exactly."""
    return [reachable(arm(n, 12.0 / n), plan.count(200, 3), rng).within(1e-6) for n in (5, 12, 30, 60)]


def _spheres(_: Plan, rng: Generator) -> list[ProblemSet]:
    """Arms of 5 to 20 segments among 40 to 600 balls; most targets are drawn without looking at these."""
    sizes = (5, 40), (20, 40), (8, 200), (12, 600)
    sets = [among_spheres(arm(n, 12.0 / n, radius=2.0), m, 20, rng) for n, m in sizes]
    return [replace(each, targets=[*each.targets, *reachable(each.robot, 47, rng).targets]) for each in sets]


def _places(plan: Plan, rng: Generator) -> list[ProblemSet]:
    """Pipes, plates and others of meshes, boxes and clouds: the hidden target, and others about it."""
    return [_about(place, rng) for place in _made(plan.count(3, 1), plan.count(len(PLACES), 1))]


@cache
def _made(count: int, families: int) -> list[Place]:
    """Make so many places of so many families."""
    return [make(family, seed) for family in PLACES[:families] for seed in range(count)]


def _about(place: Place, rng: Generator) -> ProblemSet:
    assert place.target.position is not None
    shares = rng.choice([0.0, 0.02, 0.2], (30, 1))
    moved = place.target.position + shares * place.robot.mean_length * rng.normal(size=(30, 3))
    targets = [sn.Target(position, direction=place.target.direction) for position in moved]
    return ProblemSet(place.robot, targets, place.scene, place.tolerance)


def _cluttered(plan: Plan, rng: Generator) -> list[ProblemSet]:
    """Random robots among all kinds of obstacles, targets possible and not."""
    return [clutter(int(rng.integers(10**6)), 40) for _ in range(plan.count(25, 2))]


def _grazing(_: Plan, rng: Generator) -> list[ProblemSet]:
    """A straight body that is along all of a wall nearer to it than anybody can see: a proof takes many looks."""
    robot = sn.Robot.uniform(5, (45, 70), 2.4, radius=4.0)
    targets = [sn.Target((0, 0, 5 * length), direction=(0, 0, 1)) for length in rng.uniform(50, 65, 100).tolist()]
    walls = [sn.HalfSpace((4.0 + gap, 0, 0), (-1, 0, 0)) for gap in (1e-3, 1e-5, 1e-7, 1e-9)]
    return [ProblemSet(robot, targets, sn.Scene([wall] * 3), sn.Tolerance().for_robot(robot)) for wall in walls]


def _common(_: Plan, rng: Generator) -> list[ProblemSet]:
    """Arms of 5 to 20 segments among 40 balls, and without any."""
    sets = [among_spheres(arm(n, 12.0 / n, radius=2.0), 40, 20, rng) for n in (5, 20)]
    return [*sets, *(reachable(arm(n, 12.0 / n), 20, rng) for n in (5, 20))]


class Family(NamedTuple):
    """Problems of one kind: how many there are, what draws them, options of solvers, and if targets may be torn."""

    name: str
    problems: int
    sets: Callable[[Plan, Generator], list[ProblemSet]]
    options: Sequence[dict[str, Any]] = ({},)
    torn: bool = True


WISHES = (sn.Preferences(bends=1.0), sn.Preferences(clearance=5.0), sn.Preferences(start=1.0, clearance=5.0))

FAMILIES = (
    Family("free", 1500, _free),
    Family("spheres", 1500, _spheres),
    Family("places", 2500, _places),
    Family("clutter", 1000, _cluttered),
    Family("along a wall", 1000, _grazing, torn=False),
    Family(
        "preferences",
        1000,
        lambda plan, rng: _spheres(plan, rng) + _places(plan, rng),
        [{"prefer": wish} for wish in WISHES],
    ),
    Family("other methods", 1500, _common, [{"method": name} for name in METHODS if name != "newton"], torn=False),
)
"""10,000 problems in all. With preferences, what is solved is then improved."""


def _asked(family: Family, plan: Plan, rng: Generator) -> Iterator[tuple[sn.Solver, Any]]:
    """Draw problems of a family, of solvers with each of its options where the method takes obstacles or has none."""
    solvers = [
        (sn.Solver(each.robot, each.scene, tolerance=each.tolerance, **own), each.targets)
        for each in family.sets(plan, rng)
        for own in family.options
        if not len(each.scene) or capabilities(own.get("method", "newton")).obstacles
    ]
    while True:
        solver, targets = solvers[rng.integers(len(solvers))]
        target = targets[rng.integers(len(targets))]
        yield solver, _perhaps_torn(solver.robot, target, rng) if family.torn else target
