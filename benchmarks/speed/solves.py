"""What one answer costs from cold, through `Solver.solve` and inside the kernel, and whether it is right.

Targets are random and reachable; or full poses that others publish, of three inextensible segments (P2); or of random
robots among all kinds of obstacles, possible and not, of which claims are judged.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from benchmarks.harness import Goal, Line, Plan, Times, Trial, in_processes, missed, refuted, solved_within, timed
from benchmarks.judges.judge import Flags, within_limits
from benchmarks.problems import ProblemSet, among_spheres, arm, full_poses, reachable
from benchmarks.wild.worlds import clutter
from sinuous.base.checks import Floats
from sinuous.kernels.compile import entry
from sinuous.kernels.solve.search import search
from sinuous.kernels.tables import SOLVED
from sinuous.solver.solver import Solver

LIE, OUTSIDE = "false claim", "outside limits"
"""What is wrong with an answer: the judge rejects what is called solved; or a limit is not kept, solved or not."""


def solve_all(problems: ProblemSet, **options: Any) -> list[Trial]:
    """Solve every problem from cold, through `Solver.solve`, by default as a user does, and judge the answers."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance, **options)
    solver.solve(problems.targets[0])
    trials, shapes, said = list[Trial](), list[Floats](), list[bool]()
    for number, target in enumerate(problems.targets):  # solutions are not kept: collecting thousands takes 0.1 s
        solution, spent = timed(solver.solve, target)
        trials.append(Trial(number, spent, str(solution.status)))
        shapes.append(solution.q)
        said.append(solution.solved)
    claims, q = np.flatnonzero(said), np.array(shapes)
    lies = claims[~problems.only(claims).right(q[claims])] if len(claims) else claims
    wrong = {LIE: lies, OUTSIDE: np.flatnonzero(~within_limits(problems.robot, q))}
    return [
        trial._replace(wrong=", ".join(what for what, where in wrong.items() if trial.number in where))
        for trial in trials
    ]


def answered(section: str, what: str, sets: Iterable[ProblemSet]) -> Line:
    """Solve the problems of several sets, which are numbered by these; all should be solved, and found right."""
    trials = [trial._replace(number=f"{i}.{trial.number}") for i, each in enumerate(sets) for trial in solve_all(each)]
    line = solved_within(math.inf, section, what, trials, note=missed(trials, math.inf))
    return replace(line, goal=Goal(100.0, at_most=False, correctness=True))


SECTION = (
    "cold start: 5 segments of 45-70 mm, bends to 2.4, position and direction "
    "(1e-4 of the length and 1e-3 rad by default, or 1e-6 of both; with spheres the proof is included)"
)
LOOP = 20
"""Times that a problem runs in the compiled loop; the mean counts."""
SCENES = 10
SPHERES = 40

TOLERANCES = {"default tolerance": None, "1e-6": 1e-6}
"""By default 1e-4 of the robot's mean length and 1e-3 rad; else relative to the length, and as many rad."""

REACHED = "random reachable targets, position and direction, to 1e-6 of the length and 1e-6 rad"
ARMS = {3: 2.4, 5: 2.4, 8: 2.0, 20: 1.2}
"""Number of segments, and their largest bend."""


def measure(plan: Plan) -> Iterator[Line]:
    """Through `Solver.solve` and inside the kernel, at the default tolerance and at 1e-6."""
    count, robot = plan.count(2000, 50), arm(5, 2.4, radius=4.0)
    free = [reachable(arm(5, 2.4), count, plan.rng(1))]
    scenes = range(plan.count(SCENES, 2))
    crowded = [among_spheres(robot, SPHERES, count // SCENES, plan.rng(2, i)) for i in scenes]
    goals = Goal(15e-6), Goal(6e-6), Goal(35e-6), None
    for where, sets, called, inside in (("", free, *goals[:2]), (f"{SPHERES} spheres, ", crowded, *goals[2:])):
        for words, relative in TOLERANCES.items():
            asked = sets if relative is None else [problems.within(relative) for problems in sets]
            yield _called(asked, f"{where}Solver.solve, {words}", called)
            yield _inside(asked, f"{where}inside the kernel, {words}", inside)


def _called(sets: list[ProblemSet], what: str, goal: Goal | None) -> Line:
    line = answered(SECTION, what, sets)
    assert line.times is not None
    return replace(line, reached=line.times.median, unit="us", goal=goal)


def _inside(sets: list[ProblemSet], what: str, goal: Goal | None) -> Line:
    seconds, good = map(np.concatenate, zip(*map(_in_loop, sets), strict=True))
    times = Times.of(seconds)
    return Line(SECTION, what, times.median, "us", goal, times, (int(good.sum()), len(good)))


@entry
def repeat(times: int, *arguments: Any) -> int:
    """Search `times` times over, compiled; return the status of the last time."""
    status = 0
    for _ in range(times):
        status = search(*arguments)[0]
    return status


def _in_loop(problems: ProblemSet) -> tuple[Floats, Flags]:
    """Seconds (m,) of a search with the arguments that `Solver.solve` hands over, and which answers are right."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance)
    seconds, solved = [], []
    for target in [problems.targets[0], *problems.targets]:  # the first once more: it loads or compiles
        status, spent = timed(repeat, LOOP, *solver._first_call(target).arguments)
        seconds.append(spent / LOOP)
        solved.append(status == SOLVED)
    q = np.array([solver.solve(target).q for target in problems.targets])
    return np.array(seconds[1:]), np.array(solved[1:]) & problems.right(q)


def reachable_targets(plan: Plan) -> Iterator[Line]:
    """Without obstacles, from the single arc on; all must be solved."""
    for n, max_bend in ARMS.items():
        asked = reachable(arm(n, max_bend), plan.count(10_000, 50), plan.rng(3, n)).within(1e-6)
        yield answered(REACHED, f"solved, {n} segments, bends to {max_bend}", [asked])


POSES = "full poses, three inextensible segments of length 1, numpy seeds 0 to 9, se(3) error below 1e-6"


def poses(plan: Plan) -> Iterator[Line]:
    """All must be solved; then how fast. Both errors are below 0.7e-6, so their norm in se(3) is below 1e-6."""
    sets = (full_poses(seed, plan.count(1000, 25)) for seed in range(plan.count(10, 2)))
    line = answered(POSES, "solved", sets)
    times = line.times
    assert times is not None
    yield line
    yield Line(POSES, "median", times.median, "us", Goal(12e-6))
    yield Line(POSES, "p99", times.p99, "us", Goal(300e-6))


CLAIMS = 'no false "solved": random robots of all sorts among all kinds of obstacles, default tolerance'
TARGETS = 100
"""Targets in one scene."""

STARTS = 3
"""Starts of one solve: many answers, quickly, matter more here than that all are found."""


def examine(seed: int) -> list[Trial]:
    """Solve and judge one scene; `clutter(seed, TARGETS)` makes it again."""
    return solve_all(clutter(seed, TARGETS), max_starts=STARTS)


def false_claims(plan: Plan) -> Iterator[Line]:
    """Count false claims, and answers outside the limits."""
    seeds = range(1000 * plan.seed, 1000 * plan.seed + plan.count(1000, 5))
    found = dict(zip(seeds, in_processes(examine, seeds, alone=plan.quick), strict=True))
    solved = sum(trial.good(math.inf) for own in found.values() for trial in own), TARGETS * len(seeds)
    for what, kind in (("false claims", LIE), ("answers outside limits, solved or not", OUTSIDE)):
        wrong = {f"clutter({i})": [trial for trial in own if kind in trial.wrong] for i, own in found.items()}
        yield replace(refuted(CLAIMS, what, wrong), solved=solved if kind == LIE else None)
