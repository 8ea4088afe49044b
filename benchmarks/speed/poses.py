"""Three inextensible segments to a full pose (P2): the problem that the fastest published code was made for."""

from collections.abc import Iterator

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.kinematics import tip_poses, twist_norm
from benchmarks.problems import ProblemSet, full_poses
from benchmarks.solvers.answers import Answers, solve_all
from sinuous.base.checks import Floats

SECTION = "full poses, three inextensible segments of length 1, numpy seeds 0 to 9, se(3) error below 1e-6"
LARGEST_ERROR = 1e-6


def measure(plan: Plan) -> Iterator[Line]:
    """All must be solved; then how fast."""
    seeds = range(plan.count(10, 2))
    sets = {seed: full_poses(seed, plan.count(1000, 25)) for seed in seeds}
    runs = {seed: solve_all(plan, problems, f"full poses, seed {seed}") for seed, problems in sets.items()}
    good = {seed: run.confirmed & (_errors(sets[seed], run) < LARGEST_ERROR) for seed, run in runs.items()}
    times = Times.of(np.concatenate([run.seconds for run in runs.values()]))
    solved = sum(int(flags.sum()) for flags in good.values()), times.count
    failed = [f"seed {seed}: {np.flatnonzero(~flags)[:5].tolist()}" for seed, flags in good.items() if not flags.all()]
    goal = Goal(100.0, at_most=False, correctness=True)
    yield Line(SECTION, "solved", 100.0 * solved[0] / solved[1], "%", goal, times, solved, "; ".join(failed))
    yield Line(SECTION, "median", times.median, "us", Goal(12e-6))
    yield Line(SECTION, "p99", times.p99, "us", Goal(300e-6), noise=1.0)


def _errors(problems: ProblemSet, run: Answers) -> Floats:
    """Return the norms of the errors in se(3)."""
    wanted = np.tile(np.eye(4), (len(problems.targets), 1, 1))
    wanted[:, :3, :3] = [target.rotation for target in problems.targets]
    wanted[:, :3, 3] = [target.position for target in problems.targets]
    return twist_norm(tip_poses(problems.robot, run.q), wanted)
