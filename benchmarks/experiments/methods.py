"""`python -m benchmarks methods`: all methods on common random problems that can be solved, with and without obstacles."""

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.random import Generator

from benchmarks.experiments.contest import Record, Tally, all_records, solve_in_turns
from benchmarks.experiments.entrants import divide, entrants, roster
from benchmarks.experiments.figures import INK, PALE, legend, new_figure, style, tidy
from benchmarks.experiments.frame import Findings, Piece, conduct
from benchmarks.experiments.scenes import FREE_BEND, PAPER_TOLERANCE
from benchmarks.markdown import span, table
from benchmarks.plan import Plan
from benchmarks.problems import ProblemSet, among_spheres, arm, direction_targets, random_configurations
from benchmarks.reference import tip_poses
from sinuous.checks import Floats
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene

BUDGET = 0.05
"""Seconds of one solve, with all its starts."""

TOGETHER = 20
"""Problems in one piece; among obstacles, in one scene."""

PIECES = 10
"""For each set of problems."""

SPHERES = 40

BEND = 2.4


class Family(NamedTuple):
    """Random problems of one kind.

    Attributes
    ----------
    short : str
        For figures; a line break where it is long.
    words : str
        For headings.
    draw : callable
        Takes how many, and random numbers.
    """

    short: str
    words: str
    draw: Callable[[int, Generator], ProblemSet]


def _free(robot: Robot, targets: list[Target], tolerance: Tolerance = PAPER_TOLERANCE) -> ProblemSet:
    return ProblemSet(robot, targets, Scene(), tolerance.for_robot(robot))


def _gentle(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(5, FREE_BEND), direction_targets(arm(5, 1.2), random_configurations(arm(5, 1.2), count, rng)))


def _directions(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(5, BEND), direction_targets(arm(5, BEND), random_configurations(arm(5, BEND), count, rng)))


def _exact(count: int, rng: Generator) -> ProblemSet:
    return _directions(count, rng).with_tolerance(Tolerance().for_robot(arm(5, BEND)))


def _positions(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(5, BEND), _position_targets(_tips(arm(5, BEND), count, rng)))


def _rotations(count: int, rng: Generator) -> ProblemSet:
    tips = _tips(arm(5, BEND), count, rng)
    return _free(arm(5, BEND), [Target(tip[:3, 3], rotation=tip[:3, :3]) for tip in tips])


def _inextensible(count: int, rng: Generator) -> ProblemSet:
    robot = Robot.uniform(5, 57.5, BEND, base=arm(5, BEND).base)
    return _free(robot, direction_targets(robot, random_configurations(robot, count, rng)))


def _spheres_directions(count: int, rng: Generator) -> ProblemSet:
    return among_spheres(arm(5, BEND, radius=4.0), SPHERES, count, rng).with_tolerance(PAPER_TOLERANCE)


def _spheres_positions(count: int, rng: Generator) -> ProblemSet:
    drawn = _spheres_directions(count, rng)
    return ProblemSet(drawn.robot, [Target(t.position) for t in drawn.targets], drawn.scene, drawn.tolerance)


def _long(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(20, 1.2), direction_targets(arm(20, 1.2), random_configurations(arm(20, 1.2), count, rng)))


def _thicket(count: int, rng: Generator) -> ProblemSet:
    return among_spheres(arm(8, 1.5, radius=8.0), 3 * SPHERES, count, rng).with_tolerance(PAPER_TOLERANCE)


def _tips(robot: Robot, count: int, rng: Generator) -> Floats:
    return tip_poses(robot, random_configurations(robot, count, rng))


def _position_targets(tips: Floats) -> list[Target]:
    return [Target(tip[:3, 3]) for tip in tips]


FAMILIES = {
    "gentle": Family(
        "gentle poses,\nno bend limit", "Gentle poses: drawn with bends to 1.2, no limit on bends", _gentle
    ),
    "direction": Family("position and\ndirection", f"Position and direction, bends to {BEND}", _directions),
    "exact": Family("the same,\nexactly", "Position and direction, to 1e-4 of the length and 1e-3 rad", _exact),
    "position": Family("position", "Position alone", _positions),
    "rotation": Family("full pose", "Position and whole rotation", _rotations),
    "inextensible": Family("fixed lengths", "Position and direction, lengths fixed at 57.5 mm", _inextensible),
    "long": Family("20 segments", "Position and direction, 20 segments, bends to 1.2", _long),
    "spheres, direction": Family(
        "spheres,\ndirection", f"Position and direction among {SPHERES} spheres, 4 mm thick", _spheres_directions
    ),
    "spheres, position": Family(
        "spheres,\nposition", f"Position alone among {SPHERES} spheres, 4 mm thick", _spheres_positions
    ),
    "spheres, thicket": Family(
        "thicket",
        f"Position and direction, 8 segments with bends to 1.5, 8 mm thick, among {3 * SPHERES} spheres",
        _thicket,
    ),
}


class Methods:
    """The experiment; see `Experiment`."""

    name = "methods"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = entrants(names)

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "problems": list(FAMILIES),
            "of_each": self._together * self._pieces,
            "seconds_a_solve": BUDGET,
        }

    @property
    def _together(self) -> int:
        return self.plan.count(TOGETHER, 3)

    @property
    def _pieces(self) -> int:
        return self.plan.count(PIECES, 1)

    def _problems(self, family: str, number: int) -> ProblemSet:
        return FAMILIES[family].draw(self._together, self.plan.rng(30, list(FAMILIES).index(family), number))

    def pieces(self) -> Iterable[Piece]:
        """Twenty problems of a kind, solved by all methods, are one piece."""
        for number in range(self._pieces):
            for family in FAMILIES:
                yield f"{family}: {number}", partial(self._measure, family, number)

    def _measure(self, family: str, number: int) -> dict[str, list[Record]]:
        problems = self._problems(family, number)
        able, _ = divide(self._entrants, problems)
        return solve_in_turns(able, problems, seconds=BUDGET, seed=self.plan.seed)

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up by kind of problem and method."""
        labels = [entrant.label for entrant in self._entrants]
        found = {
            family: all_records(pieces[f"{family}: {number}"] for number in range(self._pieces)) for family in FAMILIES
        }
        unable = {family: divide(self._entrants, self._problems(family, 0))[1] for family in FAMILIES}
        text = [
            f"Segments of 45 to 70 mm, mostly five; {self._together * self._pieces} problems of each kind, every one "
            f"the pose of a configuration within limits and free of obstacles, to {PAPER_TOLERANCE.position:g} mm "
            f"and {PAPER_TOLERANCE.angle} rad mostly, from cold, at most {1e3 * BUDGET:g} ms each. "
            "Methods take turns of ten problems; a solve during which another process had the processor is "
            "repeated. Times and errors are medians of confirmed answers; `limits`, "
            "`obstacle` and `target` count the answers that verification found outside a limit, touching, or off the "
            "target.",
            "![Success and median time](methods_overview.png)",
            "![Share solved within a time](methods_profiles.png)",
        ]
        for family, records in found.items():
            text += [f"## {FAMILIES[family].words}", _family_table(records, unable[family], labels)]
        text += ["## Methods", roster(self._entrants, {})]
        tallies = {family: {k: Tally.of(r) for k, r in records.items()} for family, records in found.items()}
        data = {
            "families": {f: {k: _plain(r) for k, r in records.items()} for f, records in found.items()},
            "not_run": unable,
        }
        figures = {"methods_overview": _draw_overview(tallies, labels), "methods_profiles": _draw_profiles(found)}
        wrong = sum(tally.wrong for each in tallies.values() for tally in each.values())
        return Findings("\n\n".join(text), data, figures, wrong)


def _plain(records: Sequence[Record]) -> dict[str, Any]:
    tally = Tally.of(records)
    return {**vars(tally), "times": vars(tally.times), "missed": _missed(records)}


def _missed(records: Sequence[Record]) -> dict[str, int]:
    """Count what was wrong with the answers that are not right."""
    bad = [record for record in records if not record["right"]]
    outside = sum(record["excess"] > 1e-6 for record in bad)
    touching = sum(record["clearance"] is not None and record["clearance"] < 0.0 for record in bad)
    off = sum(record["excess"] <= 1e-6 and not (record["clearance"] or 0.0) < 0.0 for record in bad)
    return {"limits": outside, "obstacle": touching, "target": off}


HEADINGS = (
    "method", "solved", "", "from the first start", "median", "p95", "worst", "iterations", "position error, mm",
    "angle error, rad", "limits", "obstacle", "target",
)  # fmt: skip


def _family_table(found: dict[str, list[Record]], unable: dict[str, str], labels: Sequence[str]) -> str:
    rows: list[Sequence[str]] = [HEADINGS]
    for label in labels:
        if label in unable:
            rows.append([label, "not run", *[""] * (len(HEADINGS) - 2)])
            continue
        tally, missed = Tally.of(found[label]), _missed(found[label])
        rows.append(
            [
                label,
                f"{tally.right}/{tally.runs}",
                f"{tally.percent:.1f} %",
                str(tally.first),
                *(span(seconds) for seconds in (tally.times.median, tally.times.p95, tally.times.worst)),
                f"{tally.iterations:g}",
                f"{tally.position:.2g}",
                f"{tally.angle:.2g}",
                *(str(count or "") for count in missed.values()),
            ]
        )
    reasons = [f"`{label}` {reason}." for label, reason in unable.items()]
    return "\n\n".join([table(rows), *([" ".join(["Not run:", *reasons])] if reasons else [])])


def _draw_overview(tallies: dict[str, dict[str, Tally]], labels: Sequence[str]) -> Any:
    """Draw a field for each method and kind of problem: how many were solved, in how long."""
    figure = new_figure(13.0, 1.4 + 0.55 * len(labels))
    axes = figure.add_subplot()
    share = np.full((len(labels), len(tallies)), np.nan)
    for column, found in enumerate(tallies.values()):
        for row, label in enumerate(labels):
            if label in found:
                share[row, column] = found[label].percent
            _write_field(axes, row, column, found.get(label))
    axes.imshow(share, cmap=_shades(), vmin=0.0, vmax=100.0, aspect="auto")
    axes.set_xticks(range(len(tallies)), [FAMILIES[family].short for family in tallies])
    axes.set_yticks(range(len(labels)), labels)
    axes.tick_params(length=0, colors=INK, labelsize=9.5, top=False, labeltop=True, labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.set_xticks(np.arange(0.5, len(tallies) - 1), minor=True)
    axes.set_yticks(np.arange(0.5, len(labels) - 1), minor=True)
    axes.grid(visible=True, which="minor", color="white", linewidth=2.5)
    axes.tick_params(which="minor", length=0)
    return figure


def _shades() -> Any:
    """From pale red over white to the teal of the house; what was not run is grey."""
    from matplotlib.colors import LinearSegmentedColormap  # noqa: PLC0415

    shades = LinearSegmentedColormap.from_list("share", ["#e9b3b0", "#f6e7d8", "#d3e4e4", "#6fa9b8"])
    return shades.with_extremes(bad="#f1f2f4")


def _write_field(axes: Any, row: int, column: int, tally: Tally | None) -> None:
    if tally is None:
        axes.text(column, row, "not run", ha="center", va="center", fontsize=8.5, color=PALE)
        return
    axes.text(column, row - 0.14, f"{tally.percent:.3g} %", ha="center", va="center", fontsize=11, color=INK)
    if tally.right:
        axes.text(column, row + 0.25, span(tally.times.median), ha="center", va="center", fontsize=8.5, color="#4d545c")


def _draw_profiles(found: dict[str, dict[str, list[Record]]]) -> Any:
    """Draw for each kind of problem the share that every method solved within a time."""
    figure = new_figure(13.0, 6.2)
    panels = figure.subplots(2, (len(found) + 1) // 2, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, (family, records) in zip(panels, found.items(), strict=False):
        tidy(axes, FAMILIES[family].short.replace("\n", " "), log_x=True)
        for label, own in records.items():
            times = np.sort([1e3 * record["seconds"] for record in own if record["right"]])
            share = 100.0 * np.arange(len(times) + 1) / len(own)
            edges = np.concatenate([[1e-3], times, [1e3 * BUDGET]]) if len(times) else np.array([1e-3, 1e3 * BUDGET])
            look = style(label)
            axes.step(edges, np.append(share, share[-1]), where="post", color=look.color, linewidth=look.width)
    for axes in panels[len(panels) // 2 :]:
        axes.set_xlabel("ms")
    for axes in panels[:: len(panels) // 2]:
        axes.set_ylabel("solved, %")
    panels[0].set_xlim(2e-3, 1e3 * BUDGET)
    panels[0].set_ylim(0.0, 103.0)
    legend(
        figure, list(dict.fromkeys(label for records in found.values() for label in records)), columns=9, marks=False
    )
    return figure


def run(
    seed: int = 0, quick: bool = False, json: bool = False, out: Path | None = None, anew: bool = False,
    methods: Sequence[str] = (),
) -> int:  # fmt: skip
    """Measure what the folder `out` lacks, write and print the results; see `conduct` for what is returned."""
    return conduct(Methods(Plan(seed, quick), methods), out, json=json, anew=anew)
