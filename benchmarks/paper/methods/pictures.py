"""Success and median time, and the share solved within a time."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.harness.markdown import span
from benchmarks.paper.contest import Record, Tally
from benchmarks.paper.methods.families import FAMILIES
from benchmarks.pictures.style import INK, PALE, legend, new_figure, style, tidy


def draw_overview(tallies: dict[str, dict[str, Tally]], labels: Sequence[str]) -> Any:
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


def draw_profiles(found: dict[str, dict[str, list[Record]]], budget: float) -> Any:
    """Draw for each kind of problem the share that every method solved within a time, up to the budget, seconds."""
    figure = new_figure(13.0, 6.2)
    panels = figure.subplots(2, (len(found) + 1) // 2, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, (family, records) in zip(panels, found.items(), strict=False):
        tidy(axes, FAMILIES[family].short.replace("\n", " "), log_x=True)
        for label, own in records.items():
            times = np.sort([1e3 * record["seconds"] for record in own if record["right"]])
            share = 100.0 * np.arange(len(times) + 1) / len(own)
            edges = np.concatenate([[1e-3], times, [1e3 * budget]]) if len(times) else np.array([1e-3, 1e3 * budget])
            look = style(label)
            axes.step(edges, np.append(share, share[-1]), where="post", color=look.color, linewidth=look.width)
    for axes in panels[len(panels) // 2 :]:
        axes.set_xlabel("ms")
    for axes in panels[:: len(panels) // 2]:
        axes.set_ylabel("solved, %")
    panels[0].set_xlim(2e-3, 1e3 * budget)
    panels[0].set_ylim(0.0, 103.0)
    legend(
        figure, list(dict.fromkeys(label for records in found.values() for label in records)), columns=9, marks=False
    )
    return figure
