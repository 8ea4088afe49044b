"""The four targets of the paper (P1), a hundred times each."""

from collections.abc import Iterator

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.plan import Plan
from benchmarks.problems import PAPER_POSES, ProblemSet, paper_poses
from benchmarks.solvers.answers import Answers, solve_all

SECTION = "the paper's four targets: 5 segments of 45-70 mm, bends to 2.4, to 1e-6 mm and 1e-6 rad"


def measure(plan: Plan) -> Iterator[Line]:
    """One line a target, then whether all are solved."""
    poses = paper_poses()
    everything: list[Answers] = []
    for name, target in zip(PAPER_POSES, poses.targets, strict=True):
        repeats = [target] * plan.count(100, 10)
        answers = solve_all(plan, ProblemSet(poses.robot, repeats, poses.scene, poses.tolerance), name)
        everything.append(answers)
        yield Line(SECTION, f"target {name}", answers.times.median, "us", Goal(100e-6), answers.times, answers.solved)
    least = min(answers.percent for answers in everything)
    yield Line(SECTION, "solved, each time", least, "%", Goal(100.0, at_most=False, correctness=True))
