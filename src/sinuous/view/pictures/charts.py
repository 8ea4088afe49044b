"""Charts of what was found of robots: of an assessment, a design and a calibration."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous.base.documents import written
from sinuous.base.errors import InputError
from sinuous.view.display.style import CURVES, INK, LINE, PALE, SMALL, UNSOLVED
from sinuous.view.pictures.diagrams import tidy
from sinuous.view.pictures.files import check_picture, need_matplotlib, save_figure, stills
from sinuous.view.pictures.space import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sinuous.studies.calibration.calibration import Calibration
    from sinuous.studies.designing.design import Design
    from sinuous.studies.tasks.assess import Assessment

MOST_LABELS = 12
"""Robots of a front whose fields are written beside them."""

MOST_PATTERNS = 16
"""Patterns of a calibration that are named, the worst ones."""


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
    check_picture("file", Path(file), stills())
    totals = found.totals
    names, places = [total.robot for total in totals], np.arange(len(totals))
    figure = new_figure(figsize=(13.0, 1.6 + 0.32 * len(totals)), dpi=110, layout="constrained")
    done, clear, time = figure.subplots(1, 3, sharey=True)
    done.barh(places, [100.0 * total.done / total.tasks for total in totals], color=CURVES[0])
    done.plot([100.0 * total.share for total in totals], places, "o", color=CURVES[1])
    done.set(xlim=(0.0, 105.0))
    done.set_yticks(places, names)
    done.invert_yaxis()
    clear.barh(places, [total.clearance or 0.0 for total in totals], color=CURVES[0])
    time.barh(places, [1e3 * total.seconds for total in totals], color=CURVES[0])
    for place, total in zip(places.tolist(), totals, strict=True):
        if total.binds is not None:
            time.annotate(f" {total.binds}", (0.0, place), va="center", color=UNSOLVED[0], fontsize=8)
    tidy(done, "tasks done (dots: targets met)", x="%", y="")
    tidy(clear, "least proved clearance", x="length unit", y="")
    tidy(time, "longest time to compute, and what limits the robot", x="ms", y="")
    save_figure(figure, Path(file))


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
    check_picture("file", Path(file), stills())
    if not found.front:
        raise InputError("found", "no robot does all tasks", str(found), "a design with a robot")
    figure = new_figure(figsize=(7.0, 5.0), dpi=110, layout="constrained")
    axes = figure.subplots()
    first, *others = found.minimise
    x = [each.objectives[first] for each in found.front]
    y = [each.objectives[others[0]] if others else 0.0 for each in found.front]
    axes.step(x, y, where="post", color=CURVES[1], linewidth=1.0)
    axes.plot(x, y, "o", color=CURVES[0])
    for each, place in list(zip(found.front, zip(x, y, strict=True), strict=True))[:MOST_LABELS]:
        said = ", ".join(f"{value:.3g}" if isinstance(value, float) else str(value) for value in each.values.values())
        axes.annotate(f" {said}", place, fontsize=8)
    tidy(axes, ", ".join(found.front[0].values), x=first, y=others[0] if others else "")
    save_figure(figure, Path(file))


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
    need_matplotlib("plot")
    figure: Figure = new_figure(figsize=(11.0, 7.0), layout="constrained")
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
    axes.legend(fontsize=SMALL, frameon=False)
    tidy(axes, "measured and predicted", x=f"{'xyz'[a]}, length unit", y=f"{'xyz'[b]}, length unit")


def _draw_over(axes: Any, own: "Calibration") -> None:
    off = np.linalg.norm(own.held_back[:, 0], axis=1)
    axes.plot(own.rows, off, ".", color=INK, markersize=2)
    axes.axhline(own.bound(), color=CURVES[1], linewidth=1.0)
    axes.text(own.rows[0], own.bound(), " bound of the robot", va="bottom", fontsize=SMALL, color=INK)
    tidy(axes, "error of held-back rows", x="row", y="length unit")


def _draw_by(axes: Any, own: "Calibration") -> None:
    worst = list(own.by_pattern.items())[:MOST_PATTERNS]
    axes.barh([label for label, _ in worst], [each.p95 for _, each in worst], color=PALE)
    axes.barh([label for label, _ in worst], [each.mean for _, each in worst], color=CURVES[0])
    axes.invert_yaxis()
    axes.tick_params(labelsize=SMALL)
    tidy(axes, "patterns with the largest errors: mean, and 95 %", x="length unit", y="")
