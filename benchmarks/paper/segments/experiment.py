"""`python -m benchmarks segments`: how the time of an iteration, and of a solve, grows with the number of segments."""

from collections.abc import Iterable, Sequence
from functools import partial
from typing import Any

import numpy as np

from benchmarks.harness.experiment import Findings, Indivisible, Piece
from benchmarks.harness.plan import Plan
from benchmarks.paper.contest import Judge, Record, follow_in_turns, judge_track
from benchmarks.paper.entrants import DIFFERENCES, gradients, roster
from benchmarks.paper.scenes import FREE_BEND, PAPER_TOLERANCE, POINTS, path_through
from benchmarks.paper.segments.curves import curves_of, piece_name, plain
from benchmarks.paper.segments.pictures import draw
from benchmarks.paper.segments.tables import curve_table
from benchmarks.problems import ProblemSet, arm, direction_targets, random_configurations
from sinuous.scene.scene import Scene

BUDGET = 0.25
"""Seconds of one solve, with all its initial configurations."""

FOLLOWED = (5, 6, 7, 8, 9, 10)
"""Numbers of segments, as in the paper, of the robots that follow a path."""

SPHERES, FOLLOWS = 35, 5
"""Spheres before the path, and how often it is followed in a round."""

ROUNDS = 4
"""Times that all sizes are gone through, so that a slow minute of the machine bends no curve. So a path is followed
twenty times, as in the paper."""

GROWN = (5, 10, 20, 40, 80, 160, 320, 640)
"""Numbers of segments of the robots that meet random poses without obstacles."""

LARGEST = {"newton": 640, "opti_path": 640, DIFFERENCES: 80}
"""Who takes part, and up to how many segments: more would take minutes."""

TOTAL_BEND = 6.0
"""Sum of the bends that the random poses are drawn with, so that long arms do not curl up."""

POSES, SOLVES = 40, 2
"""Poses of each size, and how often each is solved in a round."""


class Segments(Indivisible):
    """The experiment; see `Experiment`."""

    name = "segments"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = gradients(names)
        self._judges: dict[str, Judge] = {}

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "followed": list(self._followed),
            "waypoints": self._points,
            "followed_in_a_round": self._follows,
            "grown": list(self._grown),
            "poses": self._poses,
            "rounds": self._rounds,
            "seconds_a_solve": BUDGET,
        }

    @property
    def _followed(self) -> Sequence[int]:
        return FOLLOWED if not self.plan.quick else (5, 7)

    @property
    def _grown(self) -> Sequence[int]:
        return GROWN if not self.plan.quick else GROWN[:3]

    @property
    def _points(self) -> int:
        return self.plan.count(POINTS, 10)

    @property
    def _follows(self) -> int:
        return self.plan.count(FOLLOWS, 1)

    @property
    def _poses(self) -> int:
        return self.plan.count(POSES, 4)

    @property
    def _rounds(self) -> int:
        return self.plan.count(ROUNDS, 1)

    def pieces(self) -> Iterable[Piece]:
        """One size, solved by all methods in one round, is one piece."""
        for number in range(self._rounds):
            for count in self._followed:
                yield piece_name("path", count, number), partial(self._follow, count)
            for count in self._grown:
                yield piece_name("poses", count, number), partial(self._meet, count)

    def _follow(self, count: int) -> dict[str, list[Record]]:
        """Follow the path some times; times are medians over these, for answers repeat themselves."""
        problems = path_through(count, SPHERES, self.plan.rng(40), self._points)
        runs = [
            follow_in_turns(self._entrants, problems, seconds=BUDGET, seed=self.plan.seed) for _ in range(self._follows)
        ]
        found = {}
        for entrant in self._entrants:
            records = judge_track(self._judge(f"path {count}", problems), runs[0][entrant.label])
            times = np.median([[one.seconds for one in run[entrant.label].solutions] for run in runs], axis=0)
            found[entrant.label] = [{**r, "seconds": s} for r, s in zip(records, times.tolist(), strict=True)]
        return found

    def _meet(self, count: int) -> dict[str, list[Record]]:
        """Meet random poses, in turns; times are those of the compiled code alone. The first turn warms up."""
        problems = _random_poses(count, self._poses, self.plan.rng(41, count))
        able = [entrant for entrant in self._entrants if LARGEST[entrant.label] >= count]
        solvers = {entrant.label: entrant.solver(problems, BUDGET, self.plan.seed) for entrant in able}
        runs = [
            {label: solver.solve_many(problems.targets, workers=1) for label, solver in solvers.items()}
            for _ in range(SOLVES + 1)
        ][1:]
        judge_of = self._judge(f"poses {count}", problems)
        found: dict[str, list[Record]] = {}
        for label in solvers:
            times = np.median([run[label].seconds for run in runs], axis=0).tolist()
            answers = zip(runs[-1][label], times, strict=True)
            found[label] = [judge_of.record(i, one, seconds, keep=False) for i, (one, seconds) in enumerate(answers)]
        return found

    def _judge(self, what: str, problems: ProblemSet) -> Judge:
        """Return the judge of these problems, the same in all rounds: it knows answers that it has seen before."""
        return self._judges.setdefault(what, Judge(problems))

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Two tables, two figures, and exponents."""
        labels = [entrant.label for entrant in self._entrants]
        rounds = range(self._rounds)
        followed = curves_of(pieces, "path", self._followed, labels, rounds)
        grown = curves_of(pieces, "poses", self._grown, labels, rounds)
        text = [
            "Time of an iteration: all of a solve, with its initial configurations and its proof, over its iterations, "
            "summed over the confirmed solves that had any. Of every solve the quickest round counts. Exponents are "
            "slopes of straight lines through logarithms, by least squares.",
            f"## A path through {SPHERES} spheres, {self._followed[0]} to {self._followed[-1]} segments",
            f"The same path and the same spheres, total length 480 mm, lengths within a tenth; {self._points} "
            f"waypoints, each from the last, followed {self._follows * self._rounds} times in turns. Times are "
            "around the whole call.",
            "![Time against the number of segments, on a path](segments_path.png)",
            curve_table(followed),
            f"## Random poses without obstacles, {self._grown[0]} to {self._grown[-1]} segments",
            f"{self._poses} reachable positions and directions of each size, from cold, to "
            f"{PAPER_TOLERANCE.position:g} mm and {PAPER_TOLERANCE.angle} rad, each solved {SOLVES * self._rounds} "
            "times; times are those of the compiled code alone, without Python around it.",
            "![Time against the number of segments, random poses](segments_growth.png)",
            curve_table(grown),
            "## Methods",
            roster(self._entrants, {}),
        ]
        figures = {
            "segments_path": draw(followed, "a waypoint", decades=False),
            "segments_growth": draw(grown, "a solve", decades=True),
        }
        data = {"path": [plain(curve) for curve in followed], "poses": [plain(curve) for curve in grown]}
        wrong = sum(
            record["claimed"] and not record["right"] for p in pieces.values() for r in p.values() for record in r
        )
        return Findings(text="\n\n".join(text), data=data, pictures=figures, wrong=wrong)


def _random_poses(count: int, poses: int, rng: np.random.Generator) -> ProblemSet:
    drawn = arm(count, TOTAL_BEND / count)
    targets = direction_targets(drawn, random_configurations(drawn, poses, rng))
    return ProblemSet(arm(count, FREE_BEND), targets, Scene(), PAPER_TOLERANCE)
