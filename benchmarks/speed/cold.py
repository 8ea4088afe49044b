"""Position and direction from cold: what one answer costs, whether all targets are reached, how time grows.

And how much of it the proof takes that the body does not run through itself, where it does not come near.
"""

from collections.abc import Iterator

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times, exponent
from benchmarks.problems import ProblemSet, among_spheres, arm, reachable, relative_tolerance
from benchmarks.solvers.answers import right, solve_all
from benchmarks.solvers.inner import inner_times, self_proof_times

SECTION = (
    "cold start: 5 segments of 45-70 mm, bends to 2.4, position and direction "
    "(1e-4 of the length and 1e-3 rad by default, or 1e-6 of both; with spheres the proof is included)"
)
LOOP = 20
"""Times that a problem runs in the compiled loop; the mean counts."""
SHARES = "the proof that the body does not run through itself, as a share of a solve inside the kernel (radius 4 mm)"
SIZES, TOTAL_BEND = (5, 20), 12.0
SCENES = 10
SPHERES = 40

TOLERANCES = {"default tolerance": None, "1e-6": 1e-6}
"""By default 1e-4 of the robot's mean length and 1e-3 rad; else relative to the length, and as many rad."""

REACHED = "random reachable targets, position and direction, to 1e-6 of the length and 1e-6 rad"
ARMS = {3: 2.4, 5: 2.4, 8: 2.0, 20: 1.2}
"""Number of segments, and their largest bend."""

GROWTH = "time per iteration against the number of segments (inside the kernel, all of a solve over its iterations)"
GROWN = (5, 10, 20, 40, 80, 160, 320, 640)
"""Numbers of segments; the sum of their bends is `TOTAL_BEND`, so that long arms do not curl up."""


def measure(plan: Plan) -> Iterator[Line]:
    """Through `Solver.solve` and inside the kernel, at the default tolerance and at 1e-6."""
    count = plan.count(2000, 50)
    free = reachable(arm(5, 2.4), count, plan.rng(1))
    crowded = [
        among_spheres(arm(5, 2.4, radius=4.0), SPHERES, count // SCENES, plan.rng(2, i))
        for i in range(plan.count(SCENES, 2))
    ]
    for words, relative in TOLERANCES.items():
        yield _called(plan, [_at(free, relative)], f"Solver.solve, {words}", Goal(15e-6))
        yield _inside([_at(free, relative)], f"inside the kernel, {words}", Goal(6e-6))
    for words, relative in TOLERANCES.items():
        sets = [_at(problems, relative) for problems in crowded]
        yield _called(plan, sets, f"{SPHERES} spheres, Solver.solve, {words}", Goal(35e-6))
        yield _inside(sets, f"{SPHERES} spheres, inside the kernel, {words}", None)
    for n in SIZES:
        yield _share(plan, n)


def _share(plan: Plan, n: int) -> Line:
    """Middle and worst share over the solved targets of an arm; each time is the least of several."""
    problems = reachable(arm(n, TOTAL_BEND / n, radius=4.0), plan.count(200, 20), plan.rng(3, n))
    runs = [inner_times(problems, plan.count(10 * LOOP, LOOP)) for _ in range(3)]
    good = runs[0].solved & right(problems, runs[0].q)
    proofs = np.min([self_proof_times(problems, runs[0].q, plan.count(100 * LOOP, LOOP)) for _ in range(3)], axis=0)
    shares = 100.0 * (proofs / np.min([run.seconds for run in runs], axis=0))[good]
    solved = int(good.sum()), len(good)
    note = f"of {1e9 * np.median(proofs):.0f} ns; worst {shares.max():.1f} %"
    return Line(SHARES, f"{n} segments", float(np.median(shares)), "%", Goal(5.0), None, solved, note)


def _at(problems: ProblemSet, relative: float | None) -> ProblemSet:
    if relative is None:
        return problems
    return problems.with_tolerance(relative_tolerance(problems.robot, relative))


def _called(plan: Plan, sets: list[ProblemSet], what: str, goal: Goal) -> Line:
    answers = [solve_all(plan, problems, what) for problems in sets]
    times = Times.of([s for a in answers for s in a.seconds])
    solved = sum(a.solved[0] for a in answers), sum(a.solved[1] for a in answers)
    complaints = [f"scene {i}: {a.complaint}" for i, a in enumerate(answers) if a.complaint]
    return Line(SECTION, what, times.median, "us", goal, times, solved, "; ".join(complaints))


def _inside(sets: list[ProblemSet], what: str, goal: Goal | None) -> Line:
    runs = [inner_times(problems, LOOP) for problems in sets]
    times = Times.of([s for run in runs for s in run.seconds])
    good = [run.solved & right(problems, run.q) for run, problems in zip(runs, sets, strict=True)]
    solved = sum(int(flags.sum()) for flags in good), sum(len(flags) for flags in good)
    return Line(SECTION, what, times.median, "us", goal, times, solved)


def reachable_targets(plan: Plan) -> Iterator[Line]:
    """Without obstacles, from the single arc on; all must be solved."""
    for n, max_bend in ARMS.items():
        asked = _at(reachable(arm(n, max_bend), plan.count(10_000, 50), plan.rng(3, n)), 1e-6)
        what = f"solved, {n} segments, bends to {max_bend}"
        answers = solve_all(plan, asked, what)
        goal = Goal(100.0, at_most=False, correctness=True)
        yield Line(REACHED, what, answers.percent, "%", goal, answers.times, answers.solved, answers.complaint)


def growth(plan: Plan) -> Iterator[Line]:
    """One line a size, and the exponent: the step is exact, and linear in the number of segments."""
    medians = []
    sizes = GROWN[: plan.count(len(GROWN), 5)]
    for n in sizes:
        problems = _at(reachable(arm(n, TOTAL_BEND / n), plan.count(100, 5), plan.rng(4, n)), 1e-6)
        run = inner_times(problems, max(1, plan.count(2000, 100) // n))
        good = run.solved & right(problems, run.q) & (run.iterations > 0)
        times = Times.of(run.seconds[good] / run.iterations[good])
        medians.append(times.median)
        yield Line(GROWTH, f"{n} segments", times.median, "us", None, times, (int(good.sum()), len(good)))
    yield Line(GROWTH, "exponent", exponent(sizes, medians), "", Goal(1.1))
