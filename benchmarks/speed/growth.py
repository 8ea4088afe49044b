"""How the time of an iteration grows with the number of segments: the step is exact, and linear in it."""

from collections.abc import Iterator

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times, exponent
from benchmarks.problems import arm, reachable, relative_tolerance
from benchmarks.solvers.answers import right
from benchmarks.solvers.inner import inner_times

SECTION = "time per iteration against the number of segments (inside the kernel, all of a solve over its iterations)"
SIZES = (5, 10, 20, 40, 80, 160, 320, 640)
TOTAL_BEND = 12.0
"""Sum of the largest bends: that of five segments with 2.4 each, so that long arms do not curl up."""


def measure(plan: Plan) -> Iterator[Line]:
    """One line a size, and the exponent."""
    medians = []
    sizes = SIZES[: plan.count(len(SIZES), 5)]
    for n in sizes:
        drawn = reachable(arm(n, TOTAL_BEND / n), plan.count(100, 5), plan.rng(4, n))
        problems = drawn.with_tolerance(relative_tolerance(drawn.robot, 1e-6))
        run = inner_times(problems, max(1, plan.count(2000, 100) // n))
        good = run.solved & right(problems, run.q) & (run.iterations > 0)
        times = Times.of(run.seconds[good] / run.iterations[good])
        medians.append(times.median)
        yield Line(SECTION, f"{n} segments", times.median, "us", None, times, (int(good.sum()), len(good)))
    yield Line(SECTION, "exponent", exponent(sizes, medians), "", Goal(1.1))
