"""`python -m benchmarks segments`: how the time of an iteration, and of a solve, grows with the number of segments."""

from collections.abc import Mapping, Sequence
from typing import Any

from benchmarks.harness.experiment import Findings
from benchmarks.harness.markdown import figure, span, table
from benchmarks.harness.plan import Plan
from benchmarks.harness.times import exponent
from benchmarks.paper.contest import Contest, Record, solve_in_turns, tally
from benchmarks.paper.entrants import DIFFERENCES, Entrant, gradients, roster
from benchmarks.paper.scenes import FREE_BEND, PAPER_TOLERANCE
from benchmarks.problems import ProblemSet, arm, direction_targets, random_configurations
from sinuous.scene.scene import Scene

BUDGET = 0.25
"""Seconds of one solve, with all its initial configurations."""

SIZES = (5, 6, 7, 8, 9, 10, 20, 40, 80, 160, 320, 640)
"""Numbers of segments: those of the paper, and beyond."""

MOST_DIFFERENCES = 80
"""Segments for which differences do not take minutes."""

TOTAL_BEND = 6.0
"""Sum of the bends that the random poses are drawn with, so that long arms do not curl up."""

POSES, ROUNDS = 40, 4
"""Poses of each size, and times that all sizes are gone through: a slow minute of the machine bends no curve."""


class Segments(Contest):
    """The experiment; see `Experiment`. A group is a number of segments, a piece a round."""

    name = "segments"
    about = (
        f"{POSES} reachable positions and directions of each size without obstacles, from cold, to "
        f"{PAPER_TOLERANCE.position:g} mm and {PAPER_TOLERANCE.angle} rad, {ROUNDS} times each. Time of an iteration: "
        "all of a solve, with its initial configurations, over its iterations, summed over the confirmed solves that "
        "had any. Exponents are slopes of straight lines through logarithms, by least squares."
    )

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        super().__init__(plan, gradients(names))

    def groups(self) -> Mapping[str, tuple[str, int]]:
        """Return the sizes."""
        sizes = (5, 10, 20) if self.plan.quick else SIZES
        return {str(count): (f"{count} segments", self.plan.count(ROUNDS, 1)) for count in sizes}

    def problems(self, group: str, number: int) -> ProblemSet:
        """Return the same random poses in all rounds."""
        count = int(group)
        drawn = arm(count, TOTAL_BEND / count)
        q = random_configurations(drawn, self.plan.count(POSES, 4), self.plan.rng(41, count))
        return ProblemSet(arm(count, FREE_BEND), direction_targets(drawn, q), Scene(), PAPER_TOLERANCE)

    def solve(self, entrants: Sequence[Entrant], problems: ProblemSet) -> dict[str, list[Record]]:
        """Solve from cold."""
        able = [e for e in entrants if e.label != DIFFERENCES or len(problems.robot) <= MOST_DIFFERENCES]
        return solve_in_turns(able, problems, seconds=BUDGET, seed=self.plan.seed)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """One table, with the exponents."""
        rows = [["method", "segments", "solved", "an iteration", "median solve", "worst solve", "iterations"]]
        data, wrong = dict[str, Any](), 0
        for label in (entrant.label for entrant in self.entrants):
            curve = list[tuple[int, float, float]]()
            for group, (_, count) in self.groups().items():
                records = [record for number in range(count) for record in pieces[f"{group}: {number}"].get(label, [])]
                if not records:
                    continue
                own, step = tally(records), _iteration(records)
                curve.append((int(group), step, own["median"]))
                times = (span(seconds) for seconds in (step, own["median"], own["worst"]))
                rows.append([label, group, f"{own['right']}/{own['runs']}", *times, figure(own["iterations"])])
                wrong += own["wrong"]
            sizes, steps, solves = zip(*curve, strict=True)
            data[label] = {"sizes": sizes, "iteration": steps, "solve": solves, "exponent": exponent(sizes, steps)}
            rows.append(
                [label, "exponent", "", *(f"n^{exponent(sizes, each):.2f}" for each in (steps, solves)), "", ""]
            )
        text = [self.about, table(rows), "## Methods", roster(self.entrants, {})]
        return Findings(text="\n\n".join(text), data={"found": data}, wrong=wrong)


def _iteration(records: Sequence[Record]) -> float:
    """Seconds of an iteration; NaN where no confirmed solve had any."""
    busy = [record for record in records if record["right"] and record["iterations"] > 0]
    seconds, steps = (sum(record[key] for record in busy) for key in ("seconds", "iterations"))
    return seconds / steps if steps else float("nan")
