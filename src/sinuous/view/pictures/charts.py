"""Charts of studies: of an assessment, a design, and a calibration."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous.base.documents import written
from sinuous.base.errors import InputError
from sinuous.view.display.style import CURVES, INK, LINE, PALE, SMALL_PT, UNSOLVED
from sinuous.view.pictures import figures
from sinuous.view.pictures.diagrams import finish_axes
from sinuous.view.pictures.figures import check_picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sinuous.studies.calibration.calibration import Calibration
    from sinuous.studies.designing.design import Design
    from sinuous.studies.tasks.assess import Assessment

MOST_LABELS = 12
"""Robots of a front whose fields are written beside them."""

MOST_PATTERNS = 16
"""Patterns of a calibration that are named, the worst ones."""


@contextmanager
def _chart(file: str | Path, size: tuple[float, float]) -> Iterator[Any]:
    """A figure of this size, in inches, that is written into a file in the end."""
    check_picture("file", Path(file), figures.still_kinds())
    figure = figures.new_figure(figsize=size, dpi=110, layout="constrained")
    yield figure
    figures.save_figure(figure, Path(file))


def plot_assessment(found: "Assessment", file: str | Path) -> None:
    """Draw for every robot how much is done, how clear, and how long it takes.

    Parameters
    ----------
    found : Assessment
    file : path
        Its ending says which kind of picture.

    Raises
    ------
    InputError
        When Matplotlib is missing or does not know the kind of file, or it cannot be written.
    """
    totals, places = found.totals, np.arange(len(found.totals))
    panels = (
        ("tasks done (dots: targets met)", "%", [100.0 * total.done / total.tasks for total in totals]),
        ("least proved clearance", "length unit", [total.clearance or 0.0 for total in totals]),
        ("longest time to compute, and what limits the robot", "ms", [1e3 * total.seconds for total in totals]),
    )
    with _chart(file, (13.0, 1.6 + 0.32 * len(totals))) as figure:
        every = figure.subplots(1, 3, sharey=True)
        for axes, (title, unit, lengths) in zip(every, panels, strict=True):
            axes.barh(places, lengths, color=CURVES[0])
            finish_axes(axes, title, x=unit, y="")
        every[0].plot([100.0 * total.share for total in totals], places, "o", color=CURVES[1])
        every[0].set(xlim=(0.0, 105.0))
        every[0].set_yticks(places, [total.robot for total in totals])
        every[0].invert_yaxis()
        for place, total in enumerate(totals):
            if total.binds is not None:
                every[2].annotate(f" {total.binds}", (0.0, place), va="center", color=UNSOLVED[0], fontsize=8)


def plot_design(found: "Design", file: str | Path) -> None:
    """Draw the front: two objectives against each other, or one for each robot.

    Parameters
    ----------
    found : Design
    file : path
        Its ending says which kind of picture.

    Raises
    ------
    InputError
        When no robot was found, Matplotlib is missing or does not know the kind of file, or it cannot be written.
    """
    with _chart(file, (7.0, 5.0)) as figure:
        if not found.front:
            raise InputError("found", "no robot does all tasks", str(found), "a design with a robot")
        axes = figure.subplots()
        first, *others = found.minimise
        x = [each.objectives[first] for each in found.front]
        y = [each.objectives[others[0]] if others else 0.0 for each in found.front]
        axes.step(x, y, where="post", color=CURVES[1], linewidth=1.0)
        axes.plot(x, y, "o", color=CURVES[0])
        for each, *place in list(zip(found.front, x, y, strict=True))[:MOST_LABELS]:
            values = (f"{value:.3g}" if isinstance(value, float) else str(value) for value in each.values.values())
            axes.annotate(f" {', '.join(values)}", place, fontsize=8)
        finish_axes(axes, ", ".join(found.front[0].values), x=first, y=others[0] if others else "")


def plot_calibration(calibration: "Calibration", file: str | Path | None = None) -> "Figure":
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
    figures.need_matplotlib("plot")
    figure: Figure = figures.new_figure(figsize=(11.0, 7.0), layout="constrained")
    places, over, by = figure.subplot_mosaic([["places", "over"], ["places", "by"]]).values()
    _draw_places(places, calibration)
    _draw_over(over, calibration)
    _draw_by(by, calibration)
    if file is not None:
        with written(Path(file), "file"):
            figure.savefig(Path(file), dpi=150)
    return figure


def _draw_places(axes: Any, own: "Calibration") -> None:
    measured = own.measurements.points[:, 0]
    predicted = measured + own.residuals[:, 0]
    spread = np.nanstd(measured, axis=0)
    a, b = sorted(np.argsort(spread)[-2:])  # the two axes along which it moves most
    axes.plot(measured[:, a], measured[:, b], ".", color=PALE, markersize=4, label="measured")
    axes.plot(predicted[:, a], predicted[:, b], ".", color=CURVES[0], markersize=2, label="predicted")
    pairs = np.stack([measured, predicted, np.full_like(measured, np.nan)], axis=1).reshape(-1, 3)
    axes.plot(pairs[:, a], pairs[:, b], "-", color=LINE, linewidth=0.4)
    axes.set_aspect("equal")
    finish_axes(axes, "measured and predicted", x=f"{'xyz'[a]}, length unit", y=f"{'xyz'[b]}, length unit", legend=True)


def _draw_over(axes: Any, own: "Calibration") -> None:
    off = np.linalg.norm(own.held_back[:, 0], axis=1)
    axes.plot(own.rows, off, ".", color=INK, markersize=2)
    bound = own.bound(own.level)
    axes.axhline(bound, color=CURVES[1], linewidth=1.0)
    axes.text(own.rows[0], bound, " bound of the robot", va="bottom", fontsize=SMALL_PT, color=INK)
    finish_axes(axes, "error of held-back rows", x="row", y="length unit")


def _draw_by(axes: Any, own: "Calibration") -> None:
    worst = list(own.by_pattern.items())[:MOST_PATTERNS]
    axes.barh([label for label, _ in worst], [each.p95 for _, each in worst], color=PALE)
    axes.barh([label for label, _ in worst], [each.mean for _, each in worst], color=CURVES[0])
    axes.invert_yaxis()
    axes.tick_params(labelsize=SMALL_PT)
    finish_axes(axes, "patterns with the largest errors: mean, and 95 %", x="length unit", y="")
