"""Time against the number of segments."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from benchmarks.paper.segments.curves import Curve
from benchmarks.pictures.style import legend, new_figure, style, tidy


def draw(curves: Sequence[Curve], what: str, *, decades: bool) -> Any:
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


def _draw_curve(axes: Any, curve: Curve, values: list[float]) -> _Power | None:
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
