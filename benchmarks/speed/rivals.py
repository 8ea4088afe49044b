"""How much faster than what everybody has at hand: the same problems, in the same run, taking turns."""

from collections.abc import Iterator
from time import perf_counter

import numpy as np

import sinuous as sn
from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.judge import Flags
from benchmarks.problems import ProblemSet, arm, reachable, relative_tolerance
from benchmarks.speed.peers import Ipopt, LeastSquares, Peer
from sinuous.base.checks import Floats

SECTION = (
    "against others: 5 segments, position and direction, to 1e-6 of the length and 1e-6 rad, medians over solved ones"
)
GOALS = {
    "SciPy least_squares, trf": Goal(50.0, at_most=False),
    "SciPy least_squares, dogbox": Goal(50.0, at_most=False),
    "IPOPT, least squares": Goal(500.0, at_most=False),
    "IPOPT, equalities": Goal(500.0, at_most=False),
}


BLOCK = 10
"""Problems that a solver gets at a time."""


class Ours:
    """`Solver.solve`, called like the others."""

    def __init__(self, problems: ProblemSet) -> None:
        self._solver = sn.Solver(problems.robot, tolerance=problems.tolerance)

    def solve(self, target: sn.Target) -> tuple[Floats, float]:
        """Return the configuration, and the seconds around the call."""
        began = perf_counter()
        q = self._solver.solve(target).q
        return q, perf_counter() - began


def measure(plan: Plan) -> Iterator[Line]:
    """Every solver on a few problems, then on the next few: a busy machine is equally unfair to all.

    Not one problem each in turn: then ours would run from cold caches, which cost it more than all of its arithmetic.
    """
    drawn = reachable(arm(5, 2.4), plan.count(300, 10), plan.rng(5))
    problems = drawn.with_tolerance(relative_tolerance(drawn.robot, 1e-6))
    solvers: dict[str, Peer] = {
        "ours": Ours(problems),
        "SciPy least_squares, trf": LeastSquares(problems),
        "SciPy least_squares, dogbox": LeastSquares(problems, dogbox=True),
        "IPOPT, least squares": Ipopt(problems),
        "IPOPT, equalities": Ipopt(problems, equalities=True),
    }
    q: dict[str, list[Floats]] = {name: [] for name in solvers}
    seconds: dict[str, list[float]] = {name: [] for name in solvers}
    targets = problems.targets
    blocks = [targets[i : i + BLOCK] for i in range(0, len(targets), BLOCK)]
    for block in plan.track(blocks, "against others", len(blocks)):
        for name, solver in solvers.items():
            solver.solve(block[0])
            for target in block:
                answer, spent = solver.solve(target)
                q[name].append(answer)
                seconds[name].append(spent)
    good = {name: problems.right(np.array(q[name])) for name in solvers}
    times = {name: _times(seconds[name], good[name]) for name in solvers}
    yield Line(SECTION, "ours", times["ours"].median, "us", None, times["ours"], _tally(good["ours"]))
    for name, goal in GOALS.items():
        ratio = times[name].median / times["ours"].median
        yield Line(SECTION, f"ours faster than {name}", ratio, "x", goal, times[name], _tally(good[name]))


def _times(seconds: list[float], good: Flags) -> Times:
    return Times.of(np.array(seconds)[good]) if good.any() else Times(0, *[float("nan")] * 4)


def _tally(good: Flags) -> tuple[int, int]:
    return int(good.sum()), len(good)
