"""What a calibration found, drawn: measured against predicted, errors over rows, and errors by pattern."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous.calibration.calibration import Calibration
from sinuous.display.style import CURVES, INK, LINE, PALE, SMALL, TITLE
from sinuous.pictures.files import need_matplotlib
from sinuous.writing.documents import written

if TYPE_CHECKING:
    from matplotlib.figure import Figure


MOST_PATTERNS = 16
"""Patterns that are named, the worst ones."""


def plot_calibration(calibration: Calibration, file: str | Path | None = None) -> "Figure":
    """Draw a calibration: measured against predicted, and errors of held-back rows, in time and by pattern.

    Parameters
    ----------
    calibration : Calibration
    file : str or Path, optional
        Where to write the picture.

    Raises
    ------
    InputError
        When Matplotlib is missing, or the file cannot be written.
    """
    need_matplotlib("plot")
    from matplotlib.figure import Figure  # noqa: PLC0415

    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    places, over, by = figure.subplot_mosaic([["places", "over"], ["places", "by"]]).values()
    _draw_places(places, calibration)
    _draw_over(over, calibration)
    _draw_by(by, calibration)
    if file is not None:
        with written(Path(file), "file"):
            figure.savefig(Path(file), dpi=150)
    return figure


def _draw_places(axes: Any, own: Calibration) -> None:
    measured = own.measurements.points[:, 0]
    predicted = measured + own.residuals[:, 0]
    spread = np.nanstd(measured, axis=0)
    a, b = sorted(np.argsort(spread)[-2:])  # the two axes along which it moves most
    axes.plot(measured[:, a], measured[:, b], ".", color=PALE, markersize=4, label="measured")
    axes.plot(predicted[:, a], predicted[:, b], ".", color=CURVES[0], markersize=2, label="predicted")
    pairs = np.stack([measured, predicted, np.full_like(measured, np.nan)], axis=1).reshape(-1, 3)
    axes.plot(pairs[:, a], pairs[:, b], "-", color=LINE, linewidth=0.4)
    axes.set_aspect("equal")
    axes.legend(fontsize=SMALL, frameon=False)
    _name(axes, "measured and predicted", f"{'xyz'[a]}, length unit", f"{'xyz'[b]}, length unit")


def _draw_over(axes: Any, own: Calibration) -> None:
    off = np.linalg.norm(own.held_back[:, 0], axis=1)
    axes.plot(own.rows, off, ".", color=INK, markersize=2)
    axes.axhline(own.bound(), color=CURVES[1], linewidth=1.0)
    axes.text(own.rows[0], own.bound(), " bound of the robot", va="bottom", fontsize=SMALL, color=INK)
    _name(axes, "error of held-back rows", "row", "length unit")


def _draw_by(axes: Any, own: Calibration) -> None:
    worst = list(own.by_pattern.items())[:MOST_PATTERNS]
    axes.barh([label for label, _ in worst], [each.p95 for _, each in worst], color=PALE)
    axes.barh([label for label, _ in worst], [each.mean for _, each in worst], color=CURVES[0])
    axes.invert_yaxis()
    axes.tick_params(labelsize=SMALL)
    _name(axes, "patterns with the largest errors: mean, and 95 %", "length unit", "")


def _name(axes: Any, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=TITLE, color=INK)
    axes.set_xlabel(x, fontsize=SMALL)
    axes.set_ylabel(y, fontsize=SMALL)
