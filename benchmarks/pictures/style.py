"""How all figures of the experiments look: one colour and one mark a method, pale grids, no needless frames."""

from collections.abc import Sequence
from typing import Any, NamedTuple

DPI = 150
"""Dots an inch."""

INK, PALE, GRID, BAND = "#333333", "#777d85", "#e6e9ec", "#f1ece2"


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
    "opti_path, differences": Style("#e08a3c", "D"),
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


def new_figure(width: float, height: float) -> Any:
    """Return a figure of its own, in inches, which touches neither pyplot nor the backend of a caller."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def tidy(axes: Any, title: str = "", *, log_x: bool = False, log_y: bool = False) -> None:
    """Give axes the look of the house."""
    axes.set_title(title, fontsize=11, color=INK, loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color("#b0b6bd")
    axes.tick_params(which="both", color="#b0b6bd", labelcolor=PALE, labelsize=9)
    axes.xaxis.label.set_color(PALE)
    axes.yaxis.label.set_color(PALE)
    axes.grid(visible=True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    if log_x:
        _plain_decades(axes.xaxis, axes.set_xscale)
    if log_y:
        _plain_decades(axes.yaxis, axes.set_yscale)


def _plain_decades(axis: Any, set_scale: Any) -> None:
    """Make an axis logarithmic, with numbers instead of powers."""
    from matplotlib.ticker import NullFormatter  # noqa: PLC0415

    set_scale("log")
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def legend(figure: Any, labels: Sequence[str], *, marks: bool = True, columns: int = 5, band: str = "") -> None:
    """Put one legend under all panels of a figure: the styles of these methods, and what a shaded band is."""
    from matplotlib.lines import Line2D  # noqa: PLC0415
    from matplotlib.patches import Patch  # noqa: PLC0415

    handles: list[Any] = [
        Line2D(
            [],
            [],
            color=style(label).color,
            marker=style(label).marker if marks else "",
            linewidth=style(label).width,
            markersize=5.5,
            label=label,
        )
        for label in labels
    ]
    handles += [Patch(color=BAND, label=band)] if band else []
    figure.legend(
        handles=handles, loc="outside lower center", ncols=min(columns, len(handles)), frameon=False, labelcolor=INK
    )
