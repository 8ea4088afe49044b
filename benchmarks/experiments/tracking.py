"""`python -m benchmarks tracking`: a path of 180 points behind random spheres, lengths within a tenth, tip direction free."""

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.experiments.contest import Judge, Record, Tally, follow_in_turns, judge_track
from benchmarks.experiments.entrants import divide, entrants, roster
from benchmarks.experiments.figures import BAND, legend, new_figure, style, tidy
from benchmarks.experiments.frame import Findings, Piece, conduct
from benchmarks.experiments.scenes import POINTS, TOTAL, path_through
from benchmarks.experiments.shapes import draw_track
from benchmarks.markdown import span, table
from benchmarks.plan import Plan
from benchmarks.problems import ProblemSet

SEGMENTS = 8
BUDGET = 0.1
"""Seconds of one waypoint, with all starts."""

SCENES = {10: 2, 20: 2, 40: 2, 70: 12}
"""Scenes by their number of spheres."""

CONTACT = 1e-5
"""Clearance (mm) below which a figure shows no differences."""

JUMP = 0.1 * TOTAL
"""Motion (mm) of some point of the body between two waypoints that is a jump to another shape; a step of the path is a
tenth of that."""

PUBLISHED = 6.0, 20.0
"""Milliseconds that the paper's method typically takes for a waypoint, on the authors' machine."""


class Tracking:
    """The experiment; see `Experiment`."""

    name = "tracking"

    def __init__(self, plan: Plan, names: Sequence[str] = ()) -> None:
        self.plan = plan
        self._entrants = entrants(names)
        self._able, self._unable = divide(self._entrants, self._problems(1, 0))

    def settings(self) -> dict[str, Any]:
        """Return what the figures depend on."""
        return {
            "methods": [entrant.label for entrant in self._entrants],
            "segments": SEGMENTS,
            "scenes": {str(spheres): count for spheres, count in self._scenes.items()},
            "waypoints": self._points,
            "seconds_a_waypoint": BUDGET,
        }

    @property
    def _scenes(self) -> dict[int, int]:
        return SCENES if not self.plan.quick else {10: 1, 40: 1}

    @property
    def _points(self) -> int:
        return self.plan.count(POINTS, 12)

    def _problems(self, spheres: int, scene: int) -> ProblemSet:
        return path_through(SEGMENTS, spheres, self.plan.rng(20, spheres, scene), self._points)

    def pieces(self) -> Iterable[Piece]:
        """One scene, followed by all methods, is one piece."""
        for scene in range(max(self._scenes.values())):
            for spheres, count in self._scenes.items():
                if scene < count:
                    yield _name(spheres, scene), partial(self._measure, spheres, scene)

    def _measure(self, spheres: int, scene: int) -> dict[str, list[Record]]:
        problems = self._problems(spheres, scene)
        found = follow_in_turns(self._able, problems, seconds=BUDGET, seed=self.plan.seed)
        judge_of = Judge(problems)
        return {label: judge_track(judge_of, followed, keep=scene == 0) for label, followed in found.items()}

    def findings(self, pieces: dict[str, Any]) -> Findings:
        """Sum up by density and method, and draw the first scene of each density."""
        by_density: dict[int, dict[str, list[list[Record]]]] = {
            spheres: {
                entrant.label: [pieces[_name(spheres, scene)][entrant.label] for scene in range(count)]
                for entrant in self._able
            }
            for spheres, count in self._scenes.items()
        }
        text = [
            f"{SEGMENTS} segments of {TOTAL / SEGMENTS:g} mm, lengths within a tenth, 1 mm thick, follow a closed "
            f"figure of eight of {self._points} points behind spheres of random places and radii; only the position of "
            "the tip is asked for, to 1e-4 of the length. Each waypoint begins from the last one solved; a method that "
            f"fails from there may use its other starts, for at most {1e3 * BUDGET:g} ms in all. Methods take turns of "
            'ten waypoints. Nothing guarantees that a waypoint can be reached; "by any" counts those that some method '
            "reached. Times are of confirmed waypoints; "
            "preparing a method for a scene, `opti_path`'s grid included, comes once before."
            f" A jump: some point of the body moved more than {JUMP:g} mm.",
            "![Time of every waypoint](tracking_times.png)",
            "![Tracked fraction and least clearance](tracking_fractions.png)",
            "![One scene](tracking_scene.png)",
        ]
        for spheres, tracks in by_density.items():
            text += [f"## {spheres} spheres, {self._scenes[spheres]} scenes", _density_table(tracks)]
        text += ["## Methods", roster(self._entrants, self._unable)]
        spheres = max(self._scenes)
        figures = {
            "tracking_times": _draw_times(by_density),
            "tracking_fractions": _draw_fractions(by_density),
            "tracking_scene": _draw_scene(self._problems(spheres, 0), by_density[spheres], spheres),
        }
        data = {"densities": {str(m): {k: _plain(t) for k, t in tracks.items()} for m, tracks in by_density.items()}}
        wrong = sum(Tally.of(_flat(t)).wrong for tracks in by_density.values() for t in tracks.values())
        return Findings("\n\n".join(text), {**data, "not_run": self._unable}, figures, wrong)


def _name(spheres: int, scene: int) -> str:
    return f"{spheres} spheres, scene {scene}"


Tracks = dict[str, list[list[Record]]]
"""Of every method, the records of every scene."""


def _flat(tracks: Sequence[Sequence[Record]]) -> list[Record]:
    return [record for track in tracks for record in track]


def _whole(tracks: Sequence[Sequence[Record]]) -> int:
    return sum(all(record["right"] for record in track) for track in tracks)


def _least(records: Sequence[Record]) -> float:
    found = [record["clearance"] for record in records if record["right"]]
    return min(found) if found else float("nan")


def _jumps(records: Sequence[Record]) -> int:
    return sum(record.get("motion", 0.0) > JUMP for record in records)


def _plain(tracks: Sequence[Sequence[Record]]) -> dict[str, Any]:
    records = _flat(tracks)
    tally = Tally.of(records)
    return {
        "waypoints": tally.runs,
        "right": tally.right,
        "wrong": tally.wrong,
        "paths": _whole(tracks),
        "warm": sum(record["right"] and record["start"] == "given" for record in records),
        "seconds": vars(tally.times),
        "iterations": tally.iterations,
        "prepared": float(np.median([track[0]["prepared"] for track in tracks])),
        "least_clearance": _least(records),
        "jumps": _jumps(records),
    }


HEADINGS = (
    "method", "tracked", "", "whole paths", "from the last shape", "median", "p95", "worst", "iterations",
    "least clearance, mm", "jumps", "preparing",
)  # fmt: skip


def _density_table(tracks: Tracks) -> str:
    rows: list[Sequence[str]] = [HEADINGS]
    for label, scenes in tracks.items():
        plain, tally = _plain(scenes), Tally.of(_flat(scenes))
        rows.append(
            [
                label,
                f"{tally.right}/{tally.runs}",
                f"{tally.percent:.1f} %",
                f"{plain['paths']}/{len(scenes)}",
                str(plain["warm"]),
                *(span(seconds) for seconds in (tally.times.median, tally.times.p95, tally.times.worst)),
                f"{tally.iterations:g}",
                f"{plain['least_clearance']:.2g}",
                str(plain["jumps"]),
                span(plain["prepared"]),
            ]
        )
    everyone = [_flat(scenes) for scenes in tracks.values()]
    reached = sum(any(record["right"] for record in waypoint) for waypoint in zip(*everyone, strict=True))
    total = len(everyone[0])
    rows.append(["by any", f"{reached}/{total}", f"{100.0 * reached / total:.1f} %", *[""] * (len(HEADINGS) - 3)])
    return table(rows)


def _draw_times(by_density: dict[int, Tracks]) -> Any:
    """Draw the time of every waypoint of the first scene of each density."""
    figure = new_figure(12.0, 0.7 + 2.5 * ((len(by_density) + 1) // 2))
    panels = figure.subplots((len(by_density) + 1) // 2, 2, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, (spheres, tracks) in zip(panels, by_density.items(), strict=False):
        tidy(axes, f"{spheres} spheres", log_y=True)
        axes.axhspan(*PUBLISHED, color=BAND, linewidth=0.0, zorder=0)
        for label, scenes in reversed(tracks.items()):
            _draw_time(axes, label, scenes[0])
    for axes in panels[len(by_density) :]:
        axes.set_visible(False)
    for axes in panels[max(0, len(by_density) - 2) : len(by_density)]:
        axes.set_xlabel("waypoint (a cross: not reached)")
    for axes in panels[::2]:
        axes.set_ylabel("ms")
    legend(
        figure, list(next(iter(by_density.values()))), columns=7, band=f"paper: {PUBLISHED[0]:g} to {PUBLISHED[1]:g} ms"
    )
    return figure


def _draw_time(axes: Any, label: str, records: Sequence[Record]) -> None:
    look = style(label)
    times = 1e3 * np.array([record["seconds"] for record in records])
    right = np.array([record["right"] for record in records])
    number = np.arange(1, len(records) + 1)
    axes.plot(number[right], times[right], look.marker, color=look.color, markersize=2.8, markeredgewidth=0.0)
    axes.plot(number[~right], times[~right], "x", color=look.color, markersize=4.0, markeredgewidth=0.9, alpha=0.7)


def _draw_fractions(by_density: dict[int, Tracks]) -> Any:
    """Draw how much is tracked, how fast, and how near the body comes to a sphere, against the number of spheres."""
    figure = new_figure(12.0, 4.2)
    left, middle, right = figure.subplots(1, 3)
    for axes, title, decades in (
        (left, "tracked, %", False), (middle, "median time of a waypoint, ms", True),
        (right, "least clearance, mm", True),
    ):  # fmt: skip
        tidy(axes, title, log_y=decades)
        axes.set_xlabel("spheres")
        axes.set_xticks(list(by_density))
    for label in next(iter(by_density.values())):
        look = style(label)
        flat = [_flat(tracks[label]) for tracks in by_density.values()]
        tallies = [Tally.of(records) for records in flat]
        for axes, values in (
            (left, [tally.percent for tally in tallies]),
            (middle, [1e3 * tally.times.median for tally in tallies]),
            (right, [max(_least(records), CONTACT) for records in flat]),
        ):
            axes.plot(
                list(by_density), values, color=look.color, marker=look.marker, linewidth=look.width, markersize=6
            )
    left.set_ylim(top=101.0)
    legend(figure, list(next(iter(by_density.values()))), columns=6)
    return figure


def _draw_scene(problems: ProblemSet, tracks: Tracks, spheres: int) -> Any:
    """Draw the ways of up to two methods through the densest scene: ours, and the paper's."""
    shown = [label for label in ("newton", "opti_path") if any(r["right"] for r in tracks.get(label, [[]])[0])]
    shown = shown or [label for label, scenes in tracks.items() if any(r["right"] for r in scenes[0])][:1]
    figure = new_figure(6.0 * max(1, len(shown)), 5.2)
    for number, label in enumerate(shown, 1):
        axes = figure.add_subplot(1, len(shown), number, projection="3d", computed_zorder=False)
        records = tracks[label][0]
        reached = sum(record["right"] for record in records)
        draw_track(axes, problems, records, f"{label}: {reached} of {len(records)} waypoints, {spheres} spheres")
    return figure


def run(
    seed: int = 0, quick: bool = False, json: bool = False, out: Path | None = None, anew: bool = False,
    methods: Sequence[str] = (),
) -> int:  # fmt: skip
    """Measure what the folder `out` lacks, write and print the results; see `conduct` for what is returned."""
    return conduct(Tracking(Plan(seed, quick), methods), out, json=json, anew=anew)
