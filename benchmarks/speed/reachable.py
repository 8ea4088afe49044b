"""Every target that can be reached is reached: many random ones, for short arms and long."""

from collections.abc import Iterator

from benchmarks import problems
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.solvers.answers import solve_all

SECTION = "random reachable targets, position and direction, to 1e-6 of the length and 1e-6 rad"
ARMS = {3: 2.4, 5: 2.4, 8: 2.0, 20: 1.2}
"""Number of segments, and their largest bend."""


def measure(plan: Plan) -> Iterator[Line]:
    """Without obstacles, from the single arc on; all must be solved."""
    for n, max_bend in ARMS.items():
        drawn = problems.reachable(problems.arm(n, max_bend), plan.count(10_000, 50), plan.rng(3, n))
        asked = drawn.with_tolerance(problems.relative_tolerance(drawn.robot, 1e-6))
        what = f"solved, {n} segments, bends to {max_bend}"
        answers = solve_all(plan, asked, what)
        goal = Goal(100.0, at_most=False, correctness=True)
        yield Line(SECTION, what, answers.percent, "%", goal, answers.times, answers.solved, answers.complaint)
