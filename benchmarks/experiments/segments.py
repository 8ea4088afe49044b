"""`python -m benchmarks segments`: how the time of an iteration, and of a solve, grows with the number of segments."""

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.experiments.contest import Judge, Record, follow_in_turns, judge_track
from benchmarks.experiments.entrants import DIFFERENCES, gradients, roster
from benchmarks.experiments.figures import legend, new_figure, style, tidy
from benchmarks.experiments.frame import Findings, Piece, conduct
from benchmarks.experiments.scenes import FREE_BEND, PAPER_TOLERANCE, POINTS, path_through
from benchmarks.markdown import span, table
from benchmarks.plan import Plan
from benchmarks.problems import ProblemSet, arm, direction_targets, random_configurations
from benchmarks.timing import exponent
from sinuous.scene.scene import Scene

BUDGET = 0.25
"""Seconds of one solve, with all its starts."""

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


class Segments:
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
    def _poses(self) -> int:
        return self.plan.count(POSES, 4)

    @property
    def _rounds(self) -> int:
        return self.plan.count(ROUNDS, 1)

    def pieces(self) -> Iterable[Piece]:
        """One size, solved by all methods in one round, is one piece."""
        for number in range(self._rounds):
            for count in self._followed:
                yield _name("path", count, number), partial(self._follow, count)
            for count in self._grown:
                yield _name("poses", count, number), partial(self._meet, count)

    def _follow(self, count: int) -> dict[str, list[Record]]:
        """Follow the path some times; times are medians over these, for answers repeat themselves."""
        problems = path_through(count, SPHERES, self.plan.rng(40), self._points)
        runs = [follow_in_turns(self._entrants, problems, seconds=BUDGET, seed=self.plan.seed) for _ in range(FOLLOWS)]
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
            {label: solver.solve_many(problems.targets) for label, solver in solvers.items()} for _ in range(SOLVES + 1)
        ][1:]
        judge_of = self._judge(f"poses {count}", problems)
        found: dict[str, list[Record]] = {}
        for label in solvers:
            times = np.median([[solution.seconds for solution in run[label]] for run in runs], axis=0).tolist()
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
        followed = _curves(pieces, "path", self._followed, labels, rounds)
        grown = _curves(pieces, "poses", self._grown, labels, rounds)
        text = [
            "Time of an iteration: all of a solve, with its starts and its proof, over its iterations, summed over the "
            "confirmed solves that had any. Of every solve the quickest round counts. Exponents are slopes of straight "
            "lines through logarithms, by least squares.",
            f"## A path through {SPHERES} spheres, {self._followed[0]} to {self._followed[-1]} segments",
            f"The same path and the same spheres, total length 480 mm, lengths within a tenth; {self._points} "
            f"waypoints, each from the last, followed {FOLLOWS * self._rounds} times in turns. Times are "
            "around the whole call.",
            "![Time against the number of segments, on a path](segments_path.png)",
            _curve_table(followed),
            f"## Random poses without obstacles, {self._grown[0]} to {self._grown[-1]} segments",
            f"{self._poses} reachable positions and directions of each size, from cold, to "
            f"{PAPER_TOLERANCE.position:g} mm and {PAPER_TOLERANCE.angle} rad, each solved {SOLVES * self._rounds} "
            "times; times are those of the compiled code alone, without Python around it.",
            "![Time against the number of segments, random poses](segments_growth.png)",
            _curve_table(grown),
            "## Methods",
            roster(self._entrants, {}),
        ]
        figures = {
            "segments_path": _draw(followed, "a waypoint", decades=False),
            "segments_growth": _draw(grown, "a solve", decades=True),
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


def _name(kind: str, count: int, number: int) -> str:
    return f"{kind}, {count} segments, round {number}"


def _curves(
    pieces: dict[str, Any], kind: str, sizes: Sequence[int], labels: Sequence[str], rounds: Iterable[int]
) -> list[_Curve]:
    curves = []
    for label in labels:
        curve = _Curve(label, [], [], [], [], [], [])
        for count in sizes:
            found = [pieces[_name(kind, count, number)].get(label) for number in rounds]
            if found[0] is not None:
                _extend(curve, count, [_together(records) for records in zip(*found, strict=True)])
        curves.append(curve)
    return curves


def _together(records: Sequence[Record]) -> Record:
    """Return one problem's record over all rounds: the quickest, and right if always."""
    seconds = min(record["seconds"] for record in records)
    return {**records[0], "seconds": seconds, "right": all(record["right"] for record in records)}


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


def _draw(curves: Sequence[_Curve], what: str, *, decades: bool) -> Any:
    """Draw the time of an iteration and of a solve against the number of segments, with the fitted powers."""
    figure = new_figure(12.0, 4.8)
    left, right = figure.subplots(1, 2)
    sizes = sorted({count for curve in curves for count in curve.sizes})
    for axes, title, values in (
        (left, "an iteration, us", [curve.iteration for curve in curves]),
        (right, f"{what}, median, us", [curve.solve for curve in curves]),
    ):
        tidy(axes, title, log_x=decades, log_y=decades)
        axes.set_xlabel("segments")
        axes.set_xticks(sizes, [str(count) for count in sizes])
        axes.set_xticks([], minor=True)
        powers = [_draw_curve(axes, curve, own) for curve, own in zip(curves, values, strict=True)]
        if not decades:
            axes.set_ylim(bottom=0.0)
        _write_powers(axes, [power for power in powers if power is not None])
    legend(figure, [curve.label for curve in curves])
    return figure


class _Power(NamedTuple):
    """A fitted line: where it ends, its exponent, its colour."""

    x: float
    y: float
    slope: float
    color: str


def _draw_curve(axes: Any, curve: _Curve, values: list[float]) -> _Power | None:
    look, slope = style(curve.label), curve.slope(values)
    sizes, micros = np.array(curve.sizes, float), 1e6 * np.array(values)
    axes.plot(sizes, micros, look.marker, color=look.color, markersize=6)
    if not np.isfinite(slope):
        return None
    factor = np.exp(np.nanmean(np.log(micros) - slope * np.log(sizes)))
    fine = np.geomspace(sizes[0], sizes[-1], 50)
    axes.plot(fine, factor * fine**slope, color=look.color, linewidth=look.width, alpha=0.55, zorder=1)
    return _Power(float(sizes[-1]), float(factor * sizes[-1] ** slope), slope, look.color)


LINE = 18.0
"""Points that a written exponent needs of its column."""


def _write_powers(axes: Any, powers: Sequence[_Power]) -> None:
    """Write every exponent behind the end of its line, above the one below it."""
    scale = 72.0 / axes.figure.dpi
    taken: dict[float, float] = {}
    for power in sorted(powers, key=lambda power: power.y):
        height = scale * float(axes.transData.transform((power.x, power.y))[1])
        place = max(height, taken.get(power.x, -np.inf) + LINE)
        taken[power.x] = place
        axes.annotate(
            f"$n^{{{power.slope:.2f}}}$", (power.x, power.y), xytext=(8.0, place - height),
            textcoords="offset points", color=power.color, fontsize=11, va="center", annotation_clip=False,
        )  # fmt: skip


def run(
    seed: int = 0, quick: bool = False, json: bool = False, out: Path | None = None, anew: bool = False,
    methods: Sequence[str] = (),
) -> int:  # fmt: skip
    """Measure what the folder `out` lacks, write and print the results; see `conduct` for what is returned."""
    return conduct(Segments(Plan(seed, quick), methods), out, json=json, anew=anew)
