"""`python -m benchmarks table1`: the paper's four poses, every method a hundred times, beside what the paper publishes."""

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.experiments.contest import Record, Tally, solve_in_turns
from benchmarks.experiments.entrants import FAITHFUL, Entrant, divide, entrants, roster
from benchmarks.experiments.figures import legend, new_figure, style, tidy
from benchmarks.experiments.frame import Findings, Piece, conduct
from benchmarks.experiments.scenes import FREE_BEND, PAPER_TOLERANCE, paper_pose
from benchmarks.experiments.shapes import draw_arms
from benchmarks.markdown import span, table
from benchmarks.plan import Plan
from benchmarks.problems import PAPER_POSES
from benchmarks.timing import Times
from sinuous.problem.tolerance import Tolerance

BUDGET = 0.1
"""Seconds of one solve, with all its starts."""

REPEATS = 10
"""In one piece, of which there are ten a pose."""


EXACT = "newton, to 1e-6"
"""Label of our own method when it goes on to 1e-6 mm and rad."""


class Published(NamedTuple):
    """A line of the paper's table, on the authors' machine: seconds, mm, rad, and iterations as far as it says them."""

    seconds: float
    position: float | None
    angle: float | None
    iterations: str = ""


PUBLISHED: dict[str, dict[str, Published]] = {
    "A": {
        "fabrikc": Published(0.183, 0.863, 0.0),
        "dls": Published(0.112, 4.52, 0.85),
        "slinki": Published(0.0122, 0.766, 0.0),
        FAITHFUL: Published(0.0169, 0.0, 0.014),
    },
    "B": {
        "fabrikc": Published(0.206, 0.775, 0.0),
        "dls": Published(0.124, 0.0, 0.0),
        "slinki": Published(0.0118, 0.632, 0.0),
        FAITHFUL: Published(0.0028, 0.0, 0.017),
    },
    "C": {FAITHFUL: Published(0.0159, None, None, "15")},
    "D": {FAITHFUL: Published(0.172, None, None, "over 100")},
}
"""By pose, and by the method here that is nearest: exFABRIKc as `fabrikc`, Opti.DLS as `dls`, Opti.path as what we
read in the paper."""


class Table1:
    """The experiment; see `Experiment`."""

    name = "table1"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = entrants(names)
        if any(entrant.label == "newton" for entrant in self._entrants):
            self._entrants.insert(1, Entrant(EXACT, "newton", Tolerance(1e-6, 1e-6)))

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "repeats": self._repeats * self._blocks,
            "seconds_a_solve": BUDGET,
            "position_tolerance": PAPER_TOLERANCE.position,
            "angle_tolerance": PAPER_TOLERANCE.angle,
            "max_bend": FREE_BEND,
        }

    @property
    def _repeats(self) -> int:
        return self.plan.count(REPEATS, 2)

    @property
    def _blocks(self) -> int:
        return self.plan.count(10, 1)

    def pieces(self) -> Iterable[Piece]:
        """Ten repeats of one pose by all methods are one piece."""
        for block in range(self._blocks):
            for pose in PAPER_POSES:
                yield f"pose {pose}, block {block}", partial(self._measure, pose)

    def _measure(self, pose: str) -> dict[str, list[Record]]:
        problems = paper_pose(pose, self._repeats)
        able, _ = divide(self._entrants, problems)
        return solve_in_turns(able, problems, seconds=BUDGET, seed=self.plan.seed, keep=True)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Tables, shapes and times."""
        lines = {pose: _lines(pose, pieces, self._entrants) for pose in PAPER_POSES}
        _, unable = divide(self._entrants, paper_pose("A", 1))
        text = [
            f"Five segments of 45 to 70 mm, no obstacles; to {PAPER_TOLERANCE.position:g} mm and "
            f"{PAPER_TOLERANCE.angle} rad. Each method {self._repeats * self._blocks} times a pose, in turns, each "
            f"time for at most {1e3 * BUDGET:g} ms. Errors are those that verification computed; times are of all "
            'repeats, solved or not, around the whole call. "Published" is what the paper prints for the method of '
            "this name (exFABRIKc stands beside `fabrikc`, Opti.DLS beside `dls`), measured on other hardware.",
            "![Times of all methods on the four poses](table1_times.png)",
            "![Shapes that meet the four poses](table1_shapes.png)",
        ]
        for pose, rows in lines.items():
            position, direction = PAPER_POSES[pose]
            text += [f"## Pose {pose}: position {position} mm, direction {direction}", _pose_table(pose, rows)]
        text += ["## Methods", roster(self._entrants, unable)]
        figures = {"table1_times": _draw_times(lines), "table1_shapes": _draw_shapes(lines)}
        data = {"poses": {pose: {r.label: r.plain(pose) for r in rows} for pose, rows in lines.items()}}
        wrong = sum(row.tally.wrong for rows in lines.values() for row in rows)
        return Findings("\n\n".join(text), {**data, "not_run": unable}, figures, wrong)


class _Row(NamedTuple):
    """What one method made of one pose: all of its records, summed up."""

    label: str
    records: list[Record]
    tally: Tally
    times: Times

    @property
    def last(self) -> Record:
        """One of the answers, a confirmed one if there is any."""
        return next((record for record in self.records if record["right"]), self.records[-1])

    def plain(self, pose: str) -> dict[str, Any]:
        """Return all that the table says, and the configuration."""
        published = PUBLISHED[pose].get(self.label)
        return {
            "runs": self.tally.runs,
            "right": self.tally.right,
            "wrong": self.tally.wrong,
            "seconds": vars(self.times),
            **{key: self.last[key] for key in ("status", "position", "angle", "excess", "iterations", "starts", "q")},
            "published": None if published is None else published._asdict(),
        }


def _lines(pose: str, pieces: dict[str, Any], everyone: Sequence[Entrant]) -> list[_Row]:
    own = [piece for name, piece in pieces.items() if name.startswith(f"pose {pose},")]
    rows = []
    for entrant in everyone:
        records = [record for piece in own for record in piece.get(entrant.label, [])]
        if records:
            times = Times.of([record["seconds"] for record in records])
            rows.append(_Row(entrant.label, records, Tally.of(records), times))
    return rows


HEADINGS = (
    "method", "solved", "position error, mm", "orientation error, rad", "median", "p95", "worst", "iterations",
    "starts", "largest bend", "published: time", "mm", "rad", "iterations",
)  # fmt: skip


def _pose_table(pose: str, rows: Sequence[_Row]) -> str:
    return table([HEADINGS, *(_cells(row, PUBLISHED[pose].get(row.label)) for row in rows)])


def _cells(row: _Row, published: Published | None) -> list[str]:
    last = row.last
    bend = float(np.linalg.norm(np.array(last["q"])[:, :2], axis=-1).max())
    cells = [
        row.label,
        f"{row.tally.right}/{row.tally.runs}",
        _error(last["position"]),
        _error(last["angle"]),
        *(span(seconds) for seconds in (row.times.median, row.times.p95, row.times.worst)),
        str(last["iterations"]),
        str(last["starts"]),
        f"{bend:.2f}",
    ]
    if published is None:
        return [*cells, "", "", "", ""]
    errors = ["" if error is None else f"{error:g}" for error in (published.position, published.angle)]
    return [*cells, span(published.seconds), *errors, published.iterations]


def _error(value: float) -> str:
    return "0" if value < 1e-9 else f"{value:.2g}" if value < 1e-3 or value >= 100.0 else f"{value:.3g}"


def _draw_times(lines: dict[str, list[_Row]]) -> Any:
    """Draw one panel a pose: median and 95th percentile of every method, beside what was published."""
    labels = [row.label for row in next(iter(lines.values()))]
    figure = new_figure(12.0, 1.6 + 0.34 * len(labels))
    panels = figure.subplots(1, len(lines), sharey=True, sharex=True)
    for axes, (pose, rows) in zip(panels, lines.items(), strict=True):
        tidy(axes, f"pose {pose}", log_x=True)
        for row in rows:
            _draw_time(axes, labels.index(row.label), row, PUBLISHED[pose].get(row.label))
        axes.grid(visible=False, axis="y")
        axes.set_xlabel("ms a solve")
    panels[0].set_yticks(range(len(labels)), labels)
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    panels[0].set_xlim(2e-3, 500.0)
    figure.supxlabel(
        "dot: median, bar: to the 95th percentile; cross: not solved; ring: published, on other hardware",
        fontsize=9,
        color="#777d85",
    )
    return figure


def _draw_time(axes: Any, place: int, row: _Row, published: Published | None) -> None:
    look = style(row.label)
    median, p95 = 1e3 * row.times.median, 1e3 * row.times.p95
    axes.axhline(place, color="#eef0f2", linewidth=0.8, zorder=0)
    if row.tally.right == row.tally.runs:
        axes.plot([median, p95], [place, place], color=look.color, linewidth=2.0, solid_capstyle="round")
        axes.plot(median, place, "o", color=look.color, markersize=7)
    else:
        axes.plot(median, place, "x", color=look.color, markersize=7, markeredgewidth=2.0)
    if published is not None:
        axes.plot(1e3 * published.seconds, place, "o", color=look.color, markersize=8, fillstyle="none")


def _draw_shapes(lines: dict[str, list[_Row]]) -> Any:
    figure = new_figure(12.0, 4.4)
    for number, (pose, rows) in enumerate(lines.items(), 1):
        problems = paper_pose(pose, 1)
        arms = {row.label: np.array(row.last["q"]) for row in rows if row.last["right"] and row.label != EXACT}
        axes = figure.add_subplot(1, len(lines), number, projection="3d", computed_zorder=False)
        draw_arms(axes, problems.robot, arms, problems.targets[0], f"pose {pose}")
    legend(figure, [row.label for row in next(iter(lines.values())) if row.label != EXACT], columns=9)
    return figure


def run(
    seed: int = 0, quick: bool = False, json: bool = False, out: Path | None = None, anew: bool = False,
    methods: Sequence[str] = (),
) -> int:  # fmt: skip
    """Measure what the folder `out` lacks, write and print the results; see `conduct` for what is returned."""
    return conduct(Table1(Plan(seed, quick), methods), out, json=json, anew=anew)
