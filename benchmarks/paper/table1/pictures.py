"""Times and shapes."""

from typing import Any

import numpy as np

from benchmarks.paper.scenes import paper_pose
from benchmarks.paper.table1.rows import EXACT, PUBLISHED, Published, Row
from benchmarks.pictures.arms import draw_arms
from benchmarks.pictures.style import legend, new_figure, style, tidy


def draw_times(lines: dict[str, list[Row]]) -> Any:
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


def _draw_time(axes: Any, place: int, row: Row, published: Published | None) -> None:
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


def draw_shapes(lines: dict[str, list[Row]]) -> Any:
    """Draw one panel a pose: a shape of every method that met it."""
    figure = new_figure(12.0, 4.4)
    for number, (pose, rows) in enumerate(lines.items(), 1):
        problems = paper_pose(pose, 1)
        arms = {row.label: np.array(row.last["q"]) for row in rows if row.last["right"] and row.label != EXACT}
        axes = figure.add_subplot(1, len(lines), number, projection="3d", computed_zorder=False)
        draw_arms(axes, problems.robot, arms, problems.targets[0], f"pose {pose}")
    legend(figure, [row.label for row in next(iter(lines.values())) if row.label != EXACT], columns=9)
    return figure
