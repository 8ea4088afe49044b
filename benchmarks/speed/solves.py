"""What one answer costs from cold, through `Solver.solve` and inside the kernel, and whether it is right.

Targets are random and reachable; or full poses that others publish, of three inextensible segments (P2); or of random
robots among all kinds of obstacles, possible and not, of which claims are judged.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness import Goal, Line, Plan, Times, in_processes, listed, timed
from benchmarks.judges.judge import Flags, within_limits
from benchmarks.problems import ProblemSet, among_spheres, arm, full_poses, reachable, relative_tolerance
from benchmarks.wild.worlds import clutter
from sinuous.base.checks import Floats
from sinuous.kernels.compile import entry
from sinuous.kernels.solve.search import search
from sinuous.kernels.tables import SOLVED
from sinuous.solver.solver import Solver


@dataclass(frozen=True)
class Answers:
    """What came of m problems.

    Attributes
    ----------
    seconds : ndarray (m,)
        Around the call, solved or not.
    claimed, confirmed : ndarray (m,) of bool
        Whether the solver says solved, and whether the judge agrees with that.
    """

    seconds: Floats
    claimed: Flags
    confirmed: Flags

    @property
    def times(self) -> Times:
        """Summary of the times of all problems."""
        return Times.of(self.seconds)

    @property
    def solved(self) -> tuple[int, int]:
        """How many were confirmed, of how many."""
        return int(self.confirmed.sum()), len(self.confirmed)

    @property
    def complaint(self) -> str:
        """Numbers of problems that are not confirmed, to begin a search with."""
        failed = {"not solved": ~self.confirmed, "FALSE": self.claimed & ~self.confirmed}
        return "; ".join(f"{what}: {listed(np.flatnonzero(own).tolist())}" for what, own in failed.items() if own.any())


def solve_all(problems: ProblemSet) -> Answers:
    """Solve every problem from cold, through `Solver.solve`, with the defaults of a user."""
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance)
    solver.solve(problems.targets[0])
    q, seconds, claimed = [], [], []
    for target in problems.targets:  # solutions are not kept: collecting garbage among thousands takes 0.1 s
        solution, spent = timed(solver.solve, target)
        seconds.append(spent)
        q.append(solution.q)
        claimed.append(solution.solved)
    said, found = np.array(claimed), np.array(q)
    return Answers(np.array(seconds), said, said & problems.right(found))


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
            asked = [_at(problems, relative) for problems in sets]
            yield _called(asked, f"{where}Solver.solve, {words}", called)
            yield _inside(asked, f"{where}inside the kernel, {words}", inside)


def _at(problems: ProblemSet, relative: float | None) -> ProblemSet:
    if relative is None:
        return problems
    return problems.with_tolerance(relative_tolerance(problems.robot, relative))


def _called(sets: list[ProblemSet], what: str, goal: Goal | None) -> Line:
    answers = [solve_all(problems) for problems in sets]
    times = Times.of([s for a in answers for s in a.seconds])
    solved = sum(a.solved[0] for a in answers), sum(a.solved[1] for a in answers)
    complaints = [f"scene {i}: {a.complaint}" for i, a in enumerate(answers) if a.complaint]
    return Line(SECTION, what, times.median, "us", goal, times, solved, "; ".join(complaints))


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
        asked = _at(reachable(arm(n, max_bend), plan.count(10_000, 50), plan.rng(3, n)), 1e-6)
        what = f"solved, {n} segments, bends to {max_bend}"
        answers = solve_all(asked)
        goal = Goal(100.0, at_most=False, correctness=True)
        share = 100.0 * float(answers.confirmed.mean())
        yield Line(REACHED, what, share, "%", goal, answers.times, answers.solved, answers.complaint)


POSES = "full poses, three inextensible segments of length 1, numpy seeds 0 to 9, se(3) error below 1e-6"


def poses(plan: Plan) -> Iterator[Line]:
    """All must be solved; then how fast. Both errors are below 0.7e-6, so their norm in se(3) is below 1e-6."""
    runs = {seed: solve_all(full_poses(seed, plan.count(1000, 25))) for seed in range(plan.count(10, 2))}
    times = Times.of(np.concatenate([run.seconds for run in runs.values()]))
    solved = sum(run.solved[0] for run in runs.values()), times.count
    failed = [f"seed {seed}: {run.complaint}" for seed, run in runs.items() if run.complaint]
    goal = Goal(100.0, at_most=False, correctness=True)
    yield Line(POSES, "solved", 100.0 * solved[0] / solved[1], "%", goal, times, solved, "; ".join(failed))
    yield Line(POSES, "median", times.median, "us", Goal(12e-6))
    yield Line(POSES, "p99", times.p99, "us", Goal(300e-6))


CLAIMS = 'no false "solved": random robots of all sorts among all kinds of obstacles, default tolerance'
TARGETS = 100
"""Targets in one scene."""

STARTS = 3
"""Starts of one solve: many answers, quickly, matter more here than that all are found."""


class Tally(NamedTuple):
    """Of one scene: claims, targets whose claim the judge rejects, and those whose answer is outside the limits."""

    claimed: int
    false: list[int]
    outside: list[int]


def examine(seed: int) -> Tally:
    """Solve and judge one scene; `clutter(seed, TARGETS)` makes it again."""
    problems = clutter(seed, TARGETS)
    solver = Solver(problems.robot, problems.scene, tolerance=problems.tolerance, max_starts=STARTS)
    solutions = [solver.solve(target) for target in problems.targets]
    claims = np.flatnonzero([solution.solved for solution in solutions])
    q = np.array([solution.q for solution in solutions])
    lies = claims[~problems.only(claims).right(q[claims])] if len(claims) else claims
    outside = np.flatnonzero(~within_limits(problems.robot, q))
    return Tally(len(claims), lies.tolist(), outside.tolist())


def false_claims(plan: Plan) -> Iterator[Line]:
    """Count false claims, and answers outside the limits."""
    seeds = range(1000 * plan.seed, 1000 * plan.seed + plan.count(1000, 5))
    found = list(in_processes(examine, seeds, alone=plan.quick))
    total = TARGETS * len(seeds)
    for what, name in (("false claims", "false"), ("answers outside limits, solved or not", "outside")):
        wrong = {seed: own for seed, tally in zip(seeds, found, strict=True) if (own := getattr(tally, name))}
        count = sum(map(len, wrong.values()))
        solved = (sum(tally.claimed for tally in found) - count, total) if name == "false" else None
        note = "; ".join(f"clutter({seed}): {own[:5]}" for seed, own in list(wrong.items())[:5])  # to make them again
        yield Line(CLAIMS, what, count, "", Goal(0, correctness=True), None, solved, note)
