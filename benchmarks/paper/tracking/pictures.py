"""Times of waypoints, what was tracked, and one scene."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.paper.contest import Record, Tally
from benchmarks.paper.tracking.tracks import Tracks, flat, least_clearance
from benchmarks.pictures.arms import draw_track
from benchmarks.pictures.style import BAND, legend, new_figure, style, tidy
from benchmarks.problems import ProblemSet

CONTACT = 1e-5
"""Clearance (mm) below which a figure shows no differences."""


PUBLISHED = 6.0, 20.0
"""Milliseconds that the paper's method typically takes for a waypoint, on the authors' machine."""


def draw_times(by_density: dict[int, Tracks]) -> Any:
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


def draw_fractions(by_density: dict[int, Tracks]) -> Any:
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
        densities = [flat(tracks[label]) for tracks in by_density.values()]
        tallies = [Tally.of(records) for records in densities]
        for axes, values in (
            (left, [tally.percent for tally in tallies]),
            (middle, [1e3 * tally.times.median for tally in tallies]),
            (right, [max(least_clearance(records), CONTACT) for records in densities]),
        ):
            axes.plot(
                list(by_density), values, color=look.color, marker=look.marker, linewidth=look.width, markersize=6
            )
    left.set_ylim(top=101.0)
    legend(figure, list(next(iter(by_density.values()))), columns=6)
    return figure


def draw_scene(problems: ProblemSet, tracks: Tracks, spheres: int) -> Any:
    """Draw the motions of up to two methods through the densest scene: ours, and the paper's."""
    shown = [label for label in ("newton", "opti_path") if any(r["right"] for r in tracks.get(label, [[]])[0])]
    shown = shown or [label for label, scenes in tracks.items() if any(r["right"] for r in scenes[0])][:1]
    figure = new_figure(6.0 * max(1, len(shown)), 5.2)
    for number, label in enumerate(shown, 1):
        axes = figure.add_subplot(1, len(shown), number, projection="3d", computed_zorder=False)
        records = tracks[label][0]
        reached = sum(record["right"] for record in records)
        draw_track(axes, problems, records, f"{label}: {reached} of {len(records)} waypoints, {spheres} spheres")
    return figure
