"""Targets that others publish: the four of the paper (P1), and full poses of three inextensible segments (P2)."""

from collections.abc import Iterator

import numpy as np

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import Times
from benchmarks.judges.kinematics import tip_poses, twist_norm
from benchmarks.problems import PAPER_POSES, ProblemSet, full_poses, paper_poses
from benchmarks.solvers.answers import Answers, solve_all
from sinuous.base.checks import Floats

PAPER = "the paper's four targets: 5 segments of 45-70 mm, bends to 2.4, to 1e-6 mm and 1e-6 rad"
POSES = "full poses, three inextensible segments of length 1, numpy seeds 0 to 9, se(3) error below 1e-6"
LARGEST_ERROR = 1e-6


def paper(plan: Plan) -> Iterator[Line]:
    """One line a target, then whether all are solved."""
    asked = paper_poses()
    everything: list[Answers] = []
    for name, target in zip(PAPER_POSES, asked.targets, strict=True):
        repeats = [target] * plan.count(100, 10)
        answers = solve_all(plan, ProblemSet(asked.robot, repeats, asked.scene, asked.tolerance), name)
        everything.append(answers)
        yield Line(PAPER, f"target {name}", answers.times.median, "us", Goal(100e-6), answers.times, answers.solved)
    least = min(answers.percent for answers in everything)
    yield Line(PAPER, "solved, each time", least, "%", Goal(100.0, at_most=False, correctness=True))


def poses(plan: Plan) -> Iterator[Line]:
    """All must be solved; then how fast."""
    seeds = range(plan.count(10, 2))
    sets = {seed: full_poses(seed, plan.count(1000, 25)) for seed in seeds}
    runs = {seed: solve_all(plan, problems, f"full poses, seed {seed}") for seed, problems in sets.items()}
    good = {seed: run.confirmed & (_errors(sets[seed], run) < LARGEST_ERROR) for seed, run in runs.items()}
    times = Times.of(np.concatenate([run.seconds for run in runs.values()]))
    solved = sum(int(flags.sum()) for flags in good.values()), times.count
    failed = [f"seed {seed}: {np.flatnonzero(~flags)[:5].tolist()}" for seed, flags in good.items() if not flags.all()]
    goal = Goal(100.0, at_most=False, correctness=True)
    yield Line(POSES, "solved", 100.0 * solved[0] / solved[1], "%", goal, times, solved, "; ".join(failed))
    yield Line(POSES, "median", times.median, "us", Goal(12e-6))
    yield Line(POSES, "p99", times.p99, "us", Goal(300e-6), noise=1.0)


def _errors(problems: ProblemSet, run: Answers) -> Floats:
    """Return the norms of the errors in se(3)."""
    wanted = np.tile(np.eye(4), (len(problems.targets), 1, 1))
    wanted[:, :3, :3] = [target.rotation for target in problems.targets]
    wanted[:, :3, 3] = [target.position for target in problems.targets]
    return twist_norm(tip_poses(problems.robot, run.q), wanted)
