"""Pictures of contests: one colour and one mark a method, pale grids, no needless frames."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness.markdown import span

DPI = 150
"""Dots an inch."""

INK, PALE, GRID = "#333333", "#777d85", "#e6e9ec"

Figure = Any
"""What Matplotlib draws on; it is imported when something is drawn."""

Found = Mapping[str, Mapping[str, Sequence[Sequence[Mapping[str, Any]]]]]
"""Records of every piece, by group and method; see `contest`."""


class Style(NamedTuple):
    """How a method is drawn."""

    color: str
    marker: str
    width: float = 1.6


STYLES = {
    "newton": Style("#1f6f8b", "o", 2.4),
    "newton, to 1e-6": Style("#7fb2c4", "o"),
    "opti_path": Style("#c8384a", "s"),
    "opti_path, faithful": Style("#e08a3c", "D"),
    "dls": Style("#7a5195", "^"),
    "fabrikc": Style("#3c9d5d", "v"),
    "slinki": Style("#8c6d31", "<"),
    "fabrikx": Style("#3a6ec2", ">"),
    "fabrik_avoid": Style("#c264a8", "P"),
    "monte_carlo": Style("#8a8f98", "X"),
    "learned": Style("#2f2f6b", "*"),
    "learned, one step": Style("#6f6fb5", "*"),
    "learned, alone": Style("#b0b0dd", "*"),
}

SPARE = Style("#444444", "h")
"""For a method that nobody has given a style yet."""


def style(label: str) -> Style:
    """Return how a method is drawn, in every figure alike."""
    return STYLES.get(label, SPARE)


def new_figure(width: float, height: float) -> Figure:
    """Return a figure of its own, in inches, which touches neither pyplot nor the backend of a caller."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure as Drawn  # noqa: PLC0415

    figure = Drawn(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def tidy(axes: Any, title: str, *, log_x: bool = False, log_y: bool = False) -> None:
    """Give axes a title, a pale grid and, where they are logarithmic, numbers instead of powers."""
    from matplotlib.ticker import NullFormatter  # noqa: PLC0415

    axes.set_title(title, fontsize=11, color=INK, loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(which="both", labelcolor=PALE, labelsize=9)
    axes.grid(visible=True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    for axis, wanted, set_scale in ((axes.xaxis, log_x, axes.set_xscale), (axes.yaxis, log_y, axes.set_yscale)):
        if wanted:
            set_scale("log")
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())


def legend(figure: Figure, labels: Sequence[str]) -> None:
    """Put one legend under all panels of a figure."""
    from matplotlib.lines import Line2D  # noqa: PLC0415

    looks = [(label, style(label)) for label in labels]
    handles = [
        Line2D([], [], color=look.color, marker=look.marker, linewidth=look.width, label=label) for label, look in looks
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(7, len(handles)), frameon=False)


def _labels(found: Found) -> list[str]:
    return list(dict.fromkeys(label for each in found.values() for label in each))


def _milliseconds(pieces: Sequence[Sequence[Mapping[str, Any]]], *, right: bool) -> np.ndarray:
    """Times of the answers that are confirmed, or of those that are not."""
    return np.array([1e3 * one["seconds"] for piece in pieces for one in piece if one["right"] is right])


def draw_times(found: Found, published: Mapping[str, Mapping[str, float]]) -> Figure:
    """Draw one panel a group: median and 95th percentile of every method, beside seconds that were published."""
    labels = _labels(found)
    figure = new_figure(12.0, 1.6 + 0.34 * len(labels))
    panels = figure.subplots(1, len(found), sharey=True, sharex=True)
    for axes, (group, each) in zip(panels, found.items(), strict=True):
        tidy(axes, group, log_x=True)
        axes.set_xlabel("ms a solve")
        for label, pieces in each.items():
            place, look = labels.index(label), style(label)
            if len(times := _milliseconds(pieces, right=True)):
                middle, most = np.percentile(times, [50, 95])
                axes.plot([middle, most], [place, place], color=look.color, linewidth=2.0)
                axes.plot(middle, place, "o", color=look.color, markersize=7)
            if label in published.get(group, {}):
                axes.plot(1e3 * published[group][label], place, "o", color=look.color, markersize=8, fillstyle="none")
    panels[0].set_yticks(range(len(labels)), labels)
    panels[0].set_ylim(len(labels) - 0.5, -0.5)
    note = "dot: median of solved ones, bar: to the 95th percentile; ring: published, on other hardware"
    figure.supxlabel(note, fontsize=9, color=PALE)
    return figure


def draw_waypoints(found: Found) -> Figure:
    """Draw the time of every waypoint of the first path of each group."""
    figure = new_figure(12.0, 0.7 + 2.5 * ((len(found) + 1) // 2))
    panels = figure.subplots((len(found) + 1) // 2, 2, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, (group, each) in zip(panels, found.items(), strict=False):
        tidy(axes, f"{group} spheres", log_y=True)
        axes.set_xlabel("waypoint (a cross: not reached)")
        for label, pieces in each.items():
            times = np.array([1e3 * record["seconds"] for record in pieces[0]])
            right = np.array([record["right"] for record in pieces[0]])
            number, look = np.arange(1, len(times) + 1), style(label)
            axes.plot(number[right], times[right], look.marker, color=look.color, markersize=2.8, markeredgewidth=0.0)
            axes.plot(number[~right], times[~right], "x", color=look.color, markersize=4.0, alpha=0.7)
    for axes in panels[::2]:
        axes.set_ylabel("ms")
    legend(figure, _labels(found))
    return figure


def draw_overview(found: Found, labels: Sequence[str]) -> Figure:
    """Draw a field for each method and group: how many were solved, in how long."""
    from matplotlib.colors import LinearSegmentedColormap  # noqa: PLC0415

    figure = new_figure(13.0, 1.4 + 0.55 * len(labels))
    axes = figure.add_subplot()
    share = np.full((len(labels), len(found)), np.nan)
    for column, each in enumerate(found.values()):
        for row, label in enumerate(labels):
            if label not in each:
                axes.text(column, row, "not run", ha="center", va="center", fontsize=8.5, color=PALE)
                continue
            times = _milliseconds(each[label], right=True)
            share[row, column] = 100.0 * len(times) / sum(map(len, each[label]))
            told = f"{share[row, column]:.3g} %" + (f"\n{span(1e-3 * float(np.median(times)))}" if len(times) else "")
            axes.text(column, row, told, ha="center", va="center", fontsize=9, color=INK)
    shades = LinearSegmentedColormap.from_list("share", ["#e9b3b0", "#f6e7d8", "#d3e4e4", "#6fa9b8"])
    axes.imshow(share, cmap=shades.with_extremes(bad="#f1f2f4"), vmin=0.0, vmax=100.0, aspect="auto")
    axes.set_xticks(range(len(found)), [group.replace(", ", ",\n") for group in found])
    axes.set_yticks(range(len(labels)), labels)
    axes.tick_params(length=0, colors=INK, top=False, labeltop=True, labelbottom=False)
    axes.spines[:].set_visible(False)
    return figure


def draw_profiles(found: Found, budget: float) -> Figure:
    """Draw for each group the share that every method solved within a time, up to the budget, seconds."""
    figure = new_figure(13.0, 6.2)
    panels = figure.subplots(2, (len(found) + 1) // 2, sharex=True, sharey=True, squeeze=False).ravel()
    for axes, (group, each) in zip(panels, found.items(), strict=False):
        tidy(axes, group, log_x=True)
        axes.set_xlabel("ms")
        for label, pieces in each.items():
            times = np.sort(_milliseconds(pieces, right=True))
            share = 100.0 * np.arange(len(times) + 1) / sum(map(len, pieces))
            edges = np.concatenate([[1e-3], times, [1e3 * budget]])
            look = style(label)
            axes.step(edges, np.append(share, share[-1]), where="post", color=look.color, linewidth=look.width)
    for axes in panels[:: len(panels) // 2]:
        axes.set_ylabel("solved, %")
    panels[0].set_xlim(2e-3, 1e3 * budget)
    legend(figure, _labels(found))
    return figure
