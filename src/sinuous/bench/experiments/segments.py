"""`sinuous bench segments`: how the time of an iteration, and of a solve, grows with the number of segments."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sinuous.bench.experiments.contest import Judge, Record, follow_in_turns, judge_track
from sinuous.bench.experiments.entrants import DIFFERENCES, gradients, roster
from sinuous.bench.experiments.figures import legend, new_figure, style, tidy
from sinuous.bench.experiments.frame import Findings, Piece, conduct
from sinuous.bench.experiments.scenes import FREE_BEND, PAPER_TOLERANCE, POINTS, path_through
from sinuous.bench.markdown import span, table
from sinuous.bench.plan import Plan
from sinuous.bench.problems import ProblemSet, arm, direction_targets, random_configurations
from sinuous.bench.timing import exponent
from sinuous.scene.scene import Scene

BUDGET = 0.25
"""Seconds of one solve, with all its starts."""

FOLLOWED = (5, 6, 7, 8, 9, 10)
"""Numbers of segments, as in the paper, of the robots that follow a path."""

SPHERES, REPEATS = 35, 20
"""Spheres before the path, and how often it is followed: as often as in the paper."""

GROWN = (5, 10, 20, 40, 80, 160, 320, 640)
"""Numbers of segments of the robots that meet random poses without obstacles."""

LARGEST = {"newton": 640, "opti_path": 640, DIFFERENCES: 80}
"""Who takes part, and up to how many segments: more would take minutes."""

TOTAL_BEND = 6.0
"""Sum of the bends that the random poses are drawn with, so that long arms do not curl up."""

POSES, ROUNDS = 40, 5
"""Poses of each size, and how often each is solved."""


class Segments:
    """The experiment; see `Experiment`."""

    name = "segments"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = gradients(names)

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "followed": list(self._followed),
            "waypoints": self._points,
            "repeats": self._repeats,
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
    def _repeats(self) -> int:
        return self.plan.count(REPEATS, 2)

    @property
    def _poses(self) -> int:
        return self.plan.count(POSES, 4)

    @property
    def _rounds(self) -> int:
        return self.plan.count(ROUNDS, 2)

    def pieces(self) -> Iterable[Piece]:
        """One size, solved by all methods, is one piece."""
        for count in self._followed:
            yield f"path, {count} segments", partial(self._follow, count)
        for count in self._grown:
            yield f"poses, {count} segments", partial(self._meet, count)

    def _follow(self, count: int) -> dict[str, list[Record]]:
        """Follow the path again and again; times are medians over the repeats, for answers repeat themselves."""
        problems = path_through(count, SPHERES, self.plan.rng(40), self._points)
        runs = [
            follow_in_turns(self._entrants, problems, seconds=BUDGET, seed=self.plan.seed) for _ in range(self._repeats)
        ]
        found = {}
        for entrant in self._entrants:
            records = judge_track(problems, runs[0][entrant.label])
            times = np.median([[one.seconds for one in run[entrant.label].solutions] for run in runs], axis=0)
            found[entrant.label] = [{**r, "seconds": s} for r, s in zip(records, times.tolist(), strict=True)]
        return found

    def _meet(self, count: int) -> dict[str, list[Record]]:
        """Meet random poses, in turns; times are those of the compiled code alone, medians over the rounds."""
        problems = _random_poses(count, self._poses, self.plan.rng(41, count))
        able = [entrant for entrant in self._entrants if LARGEST[entrant.label] >= count]
        solvers = {entrant.label: entrant.solver(problems, BUDGET, self.plan.seed) for entrant in able}
        runs = [
            {label: solver.solve_many(problems.targets) for label, solver in solvers.items()} for _ in self._turns()
        ]
        judge_of = Judge(problems)
        found: dict[str, list[Record]] = {}
        for label in solvers:
            times = np.median([[solution.seconds for solution in run[label]] for run in runs[1:]], axis=0).tolist()
            answers = zip(runs[-1][label], times, strict=True)
            found[label] = [judge_of.record(i, one, seconds, keep=False) for i, (one, seconds) in enumerate(answers)]
        return found

    def _turns(self) -> range:
        """One round more than counts: the first warms up."""
        return range(self._rounds + 1)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Two tables, two figures, and exponents."""
        labels = [entrant.label for entrant in self._entrants]
        followed = _curves(pieces, "path", self._followed, labels)
        grown = _curves(pieces, "poses", self._grown, labels)
        text = [
            "Time of an iteration: all of a solve, with its starts and its proof, over its iterations, summed over the "
            "confirmed solves that had any. Exponents are slopes of straight lines through logarithms, by least "
            "squares.",
            f"## A path through {SPHERES} spheres, {self._followed[0]} to {self._followed[-1]} segments",
            f"The same path and the same spheres, total length 480 mm, lengths within a tenth; {self._points} "
            f"waypoints, each from the last, followed {self._repeats} times in turns; of every waypoint the median "
            "time counts, around the whole call.",
            "![Time against the number of segments, on a path](segments_path.png)",
            _curve_table(followed),
            f"## Random poses without obstacles, {self._grown[0]} to {self._grown[-1]} segments",
            f"{self._poses} reachable positions and directions of each size, from cold, to "
            f"{PAPER_TOLERANCE.position:g} mm and {PAPER_TOLERANCE.angle} rad, each solved {self._rounds} times; times "
            "are those of the compiled code alone, without Python around it.",
            "![Time against the number of segments, random poses](segments_growth.png)",
            _curve_table(grown),
            "## Methods",
            roster(self._entrants, {}),
        ]
        figures = {
            "segments_path": _draw(followed, "a waypoint"),
            "segments_growth": _draw(grown, "a solve"),
        }
        data = {"path": [_plain(curve) for curve in followed], "poses": [_plain(curve) for curve in grown]}
        wrong = sum(
            record["claimed"] and not record["right"] for p in pieces.values() for r in p.values() for record in r
        )
        return Findings("\n\n".join(text), data, figures, wrong)


def _random_poses(count: int, poses: int, rng: np.random.Generator) -> ProblemSet:
    drawn = arm(count, TOTAL_BEND / count)
    targets = direction_targets(drawn, random_configurations(drawn, poses, rng))
    return ProblemSet(arm(count, FREE_BEND), targets, Scene(), PAPER_TOLERANCE)


class _Curve(NamedTuple):
    """What one method needs, size by size: seconds an iteration and a solve, and (right, runs)."""

    label: str
    sizes: list[int]
    iteration: list[float]
    solve: list[float]
    worst: list[float]
    iterations: list[float]
    solved: list[tuple[int, int]]

    def slope(self, values: list[float]) -> float:
        """Return the exponent, NaN of less than two sizes."""
        known = [(n, value) for n, value in zip(self.sizes, values, strict=True) if np.isfinite(value)]
        return exponent(*zip(*known, strict=True)) if len(known) > 1 else float("nan")


def _curves(pieces: dict[str, Any], kind: str, sizes: Sequence[int], labels: Sequence[str]) -> list[_Curve]:
    curves = []
    for label in labels:
        curve = _Curve(label, [], [], [], [], [], [])
        for count in sizes:
            records = pieces[f"{kind}, {count} segments"].get(label)
            if records is not None:
                _extend(curve, count, records)
        curves.append(curve)
    return curves


def _extend(curve: _Curve, count: int, records: Sequence[Record]) -> None:
    good = [record for record in records if record["right"]]
    busy = [record for record in good if record["iterations"] > 0]
    seconds, steps = (sum(record[key] for record in busy) for key in ("seconds", "iterations"))
    times = [record["seconds"] for record in good] or [float("nan")]
    curve.sizes.append(count)
    curve.iteration.append(seconds / steps if steps else float("nan"))
    curve.solve.append(float(np.median(times)))
    curve.worst.append(max(times))
    curve.iterations.append(float(np.median([record["iterations"] for record in good])) if good else float("nan"))
    curve.solved.append((len(good), len(records)))


def _plain(curve: _Curve) -> dict[str, Any]:
    slopes = {"iteration_exponent": curve.slope(curve.iteration), "solve_exponent": curve.slope(curve.solve)}
    return {**curve._asdict(), **slopes}


HEADINGS = ("method", "segments", "solved", "an iteration", "median solve", "worst solve", "iterations")


def _curve_table(curves: Sequence[_Curve]) -> str:
    rows: list[Sequence[str]] = [HEADINGS]
    for curve in curves:
        for i, count in enumerate(curve.sizes):
            right, runs = curve.solved[i]
            times = (span(values[i]) for values in (curve.iteration, curve.solve, curve.worst))
            rows.append([curve.label, str(count), f"{right}/{runs}", *times, f"{curve.iterations[i]:g}"])
        exponents = (f"n^{curve.slope(values):.2f}" for values in (curve.iteration, curve.solve))
        rows.append([curve.label, "exponent", "", *exponents, "", ""])
    return table(rows)


def _draw(curves: Sequence[_Curve], what: str) -> Any:
    """Draw the time of an iteration and of a solve against the number of segments, with the fitted lines."""
    figure = new_figure(12.0, 4.8)
    left, right = figure.subplots(1, 2)
    pick: Callable[[_Curve], list[float]]
    for axes, title, pick in (
        (left, "an iteration, us", lambda curve: curve.iteration),
        (right, f"{what}, median, us", lambda curve: curve.solve),
    ):
        tidy(axes, title, log_x=True, log_y=True)
        axes.set_xlabel("segments")
        sizes = sorted({count for curve in curves for count in curve.sizes})
        axes.set_xticks(sizes, [str(count) for count in sizes])
        axes.set_xticks([], minor=True)
        for curve in curves:
            _draw_curve(axes, curve, pick(curve))
    legend(figure, [curve.label for curve in curves])
    return figure


def _draw_curve(axes: Any, curve: _Curve, values: list[float]) -> None:
    look, slope = style(curve.label), curve.slope(values)
    sizes, micros = np.array(curve.sizes, float), 1e6 * np.array(values)
    axes.plot(sizes, micros, look.marker, color=look.color, markersize=6)
    if not np.isfinite(slope):
        return
    fitted = np.exp(np.nanmean(np.log(micros) - slope * np.log(sizes))) * sizes**slope
    axes.plot(sizes, fitted, color=look.color, linewidth=look.width, alpha=0.55, zorder=1)
    axes.annotate(
        f"$n^{{{slope:.2f}}}$", (sizes[-1], fitted[-1]), xytext=(7, 0), textcoords="offset points",
        color=look.color, fontsize=11, va="center", annotation_clip=False,
    )  # fmt: skip


def run(
    seed: int = 0, quick: bool = False, json: bool = False, out: Path | None = None, anew: bool = False,
    methods: Sequence[str] = (),
) -> int:  # fmt: skip
    """Measure what the folder `out` lacks, write and print the results; see `conduct` for what is returned."""
    return conduct(Segments(Plan(seed, quick), methods), out, json=json, anew=anew)
