"""Diagrams of answers, and charts of studies: of an assessment, a design, and a calibration."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.base.checks import Floats, written
from sinuous.base.errors import InputError
from sinuous.methods.method import options_of
from sinuous.motion.motion import Motion
from sinuous.motion.trajectory import Trajectory
from sinuous.solver.solver import KeptOptions
from sinuous.view.display import style
from sinuous.view.display.results import Curves, actuators_of, bends_of, clearances_along, lengths_along, lengths_of
from sinuous.view.display.style import CURVES, INK, LINE, PALE, SMALL_PT, UNSOLVED, arm_tones
from sinuous.view.pictures import figures
from sinuous.view.pictures.figures import check_picture, need_matplotlib

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from sinuous.studies.calibration.calibration import Calibration
    from sinuous.studies.designing.design import Design
    from sinuous.studies.tasks.assess import Assessment

Kind = Literal["clearance", "convergence", "clearance map", "actuators", "bends", "lengths", "times"]

PLACES_PER_SEGMENT = 40
"""Places of a segment whose clearance is drawn."""

MOMENTS = 400
"""Times of a motion, beside those of its knots, at which its clearance is drawn."""

MOST_ITERATIONS = 400
"""Iterations whose errors are drawn."""

DASHED = (0, (4, 2))
"""Style of lines that are limits."""


def diagram(answer: Solution | Motion | Trajectory, kind: Kind, *, ax: "Axes | None" = None) -> "Axes":
    """Draw a diagram of a solution, a motion, or a trajectory.

    Parameters
    ----------
    answer : Solution, Motion or Trajectory
    kind : str
        Of a solution: `clearance` of every place of the body from the obstacles, in the length unit, from base to
        tip; `convergence`, the errors after every iteration, of methods with an option `iterations`.
        Of a motion: `clearance`, the least one at every moment; `clearance map`, of every place at every moment;
        `actuators`, `bends` (rad) and `lengths` of all segments; `times` that the waypoints took (ms).
    ax : Axes, optional
        By default those of a new figure of pyplot.

    Returns
    -------
    Axes
        What was drawn on.

    Raises
    ------
    InputError
        When there is no such diagram of this answer, or Matplotlib is missing.
    """
    need_matplotlib("diagram")
    if isinstance(answer, Trajectory):
        answer = answer.resampled(MOMENTS / answer.duration)
    if not isinstance(answer, Solution | Motion):
        raise InputError("answer", "", answer, "a Solution, a Motion or a Trajectory")
    checks.choice("kind", kind, get_args(Kind))
    known = diagrams_of(answer)
    if kind not in known:
        raise InputError("kind", "", kind, f"one that this {type(answer).__name__} has: {', '.join(known) or 'none'}")
    if ax is None:
        from matplotlib import pyplot  # noqa: PLC0415

        ax = pyplot.figure(figsize=(6.4, 3.6), dpi=150, layout="constrained").add_subplot()
    _DRAWN[kind](ax, answer)
    return ax


def diagrams_of(answer: Solution | Motion) -> list[str]:
    """Return the kinds of diagrams that an answer has."""
    place = answer.problem if isinstance(answer, Solution) else answer
    near = ["clearance"] if len(place.scene) else []
    if isinstance(answer, Solution):
        return [*near, *(["convergence"] if _counts_iterations(answer) else [])]
    times = ["times"] if answer.solutions else []
    if len(answer.configuration) < 2:
        return times
    driven = ["actuators"] if answer.robot.actuators else []
    return [*near, *(["clearance map"] if near else []), *driven, "bends", "lengths", *times]


def _moments(motion: Motion) -> tuple[Floats, Floats]:
    """Times (k,) of the knots and between them, and the configurations (k, n, 3) there."""
    begin, end = motion.times[0], motion.times[-1]
    every = np.unique(np.concatenate([np.linspace(begin, end, MOMENTS), motion.times]))
    return every, motion.at(every)


def _draw_clearance(axes: Any, answer: Solution | Motion) -> None:
    if isinstance(answer, Solution):
        _draw_along(axes, answer)
        return
    moments, q = _moments(answer)
    least = clearances_along(answer.robot, answer.scene, q, PLACES_PER_SEGMENT, moments).min(axis=-1)
    axes.plot(moments, least, color=style.CURVES[0], linewidth=1.8)
    _mark_least(axes, moments, least)
    _limit(axes, least)
    proved = answer.clearance is not None and answer.between == "proved"
    if proved:
        axes.axhline(
            answer.clearance, color=style.CURVES[2], linewidth=1.2, linestyle=DASHED, label="proved all the way"
        )
    finish_axes(axes, "least clearance of the body", x="time", y="length unit", legend=proved)


def _draw_along(axes: Any, solution: Solution) -> None:
    """Draw clearance along the body, under the colours that its segments have in pictures."""
    problem = solution.problem
    clearance = clearances_along(problem.robot, problem.scene, solution.configuration, PLACES_PER_SEGMENT)
    along = lengths_along(solution.configuration, PLACES_PER_SEGMENT)
    colours = arm_tones(solution.solved)
    for k in range(len(problem.robot)):
        part = slice(k * PLACES_PER_SEGMENT, (k + 1) * PLACES_PER_SEGMENT + 1)
        axes.plot(along[part], clearance[part], color=colours[k % 2], linewidth=2.6, solid_capstyle="butt")
        axes.axvline(along[part][-1], color=style.GRID, linewidth=0.8, zorder=0)
    _mark_least(axes, along, clearance)
    _limit(axes, clearance)
    finish_axes(axes, "clearance along the body", x="length of backbone from the base", y="length unit")


def _draw_convergence(axes: Any, answer: Solution) -> None:
    position, angle = _errors(answer)
    tolerance = answer.problem.tolerance
    wanted = (("position, length unit", position, tolerance.position), ("angle, rad", angle, tolerance.angle))
    for colour, (name, values, least) in zip(style.CURVES, wanted, strict=False):
        if np.isfinite(values).all():
            number = np.arange(1, len(values) + 1)
            axes.plot(number, values, color=colour, linewidth=1.8, marker="o", markersize=3.0, label=name)
            axes.axhline(least, color=colour, linewidth=1.0, linestyle=DASHED)
    axes.set_yscale("log")
    axes.xaxis.get_major_locator().set_params(integer=True)
    finish_axes(axes, f"errors of {answer.method}; dashed: tolerance", x="iteration", y="error", legend=True)


def _counts_iterations(solution: Solution) -> bool:
    """Whether its method can be stopped after any number of iterations, and it is known with which options it ran."""
    return isinstance(solution._resolver, KeptOptions) and hasattr(
        options_of(solution._resolver.options.method), "iterations"
    )


def _errors(solution: Solution) -> tuple[Floats, Floats]:
    """Errors in position and angle (k,) of the best configuration after 1, 2, ... iterations from the first start.

    The problem is solved again and again, each time with one iteration more; NaN where no target asks for it.
    """
    again = solution._resolver
    assert isinstance(again, KeptOptions)
    options: Any = options_of(again.options.method)
    given = solution._given.reshape(-1, *solution.configuration.shape)
    found: list[tuple[float | None, float | None]] = []
    for count in range(1, min(options.iterations, MOST_ITERATIONS) + 1):
        method = replace(options, iterations=count)
        one = again.solve(solution.problem, given[0] if len(given) else None, method=method, max_starts=1, routes=False)
        found.append((one.position_error, one.angle_error))
        if one.solved or one.iterations < count:
            break
    position, angle = np.array(found, np.float64).T  # where there is no error, NaN
    return position, angle


def finish_axes(axes: Any, title: str, *, x: str, y: str, legend: bool = False) -> None:
    """Give the axes of a diagram a title, labels with units, a pale grid and few lines, and a legend if wanted."""
    if legend:
        axes.legend(frameon=False, fontsize=style.SMALL_PT, labelcolor=style.PALE)
    axes.set_title(title, fontsize=style.TITLE_PT, color=style.INK, loc="left")
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(style.LINE)
    axes.tick_params(which="both", color=style.LINE, labelcolor=style.PALE, labelsize=style.SMALL_PT)
    axes.set_xlabel(x, color=style.PALE, fontsize=style.TEXT_PT)
    axes.set_ylabel(y, color=style.PALE, fontsize=style.TEXT_PT)
    axes.grid(visible=True, color=style.GRID, linewidth=0.7)
    axes.set_axisbelow(True)


def _mark_least(axes: Any, x: Floats, clearance: Floats) -> None:
    """Mark the least value, with its number beside it, on the side where there is room."""
    at = int(clearance.argmin())
    axes.plot(x[at], clearance[at], "o", color=style.TARGET, markersize=5, zorder=4)
    right = x[at] > 0.5 * (x[0] + x[-1])
    axes.annotate(
        f"{clearance[at]:.3g}",
        (x[at], clearance[at]),
        (-6 if right else 6, 6),
        textcoords="offset points",
        ha="right" if right else "left",
        color=style.INK,
        fontsize=style.SMALL_PT,
    )


def _limit(axes: Any, clearance: Floats) -> None:
    """Show zero, and what is below it, where something is."""
    finite = clearance[np.isfinite(clearance)]
    if finite.min() < 0.0:
        axes.axhline(0.0, color=style.TARGET, linewidth=1.0)
        axes.axhspan(1.1 * float(finite.min()), 0.0, color=style.TARGET, alpha=0.08, linewidth=0.0)
    else:
        axes.set_ylim(0.0, 1.12 * float(finite.max()))


def _draw_map(axes: Any, answer: Motion) -> None:
    moments, q = _moments(answer)
    clearance = clearances_along(answer.robot, answer.scene, q, PLACES_PER_SEGMENT, moments)
    count = len(answer.robot.segments)  # joints and links are below 0
    places = np.linspace(count - len(answer.robot), count, clearance.shape[-1])
    known = np.where(np.isfinite(clearance), clearance, np.nan)
    most = float(np.nanquantile(known, 0.9))
    drawn = axes.pcolormesh(
        moments, places, known.T, cmap="cividis", vmin=min(0.0, float(np.nanmin(known))), vmax=most, shading="gouraud"
    )
    bar = axes.figure.colorbar(drawn, ax=axes, extend="max", pad=0.02)
    bar.set_label("clearance, length unit", color=style.PALE, fontsize=style.SMALL_PT)
    bar.ax.tick_params(labelsize=style.SMALL_PT, labelcolor=style.PALE, color=style.GRID)
    bar.outline.set_visible(False)
    finish_axes(axes, "clearance of the body on its way", x="time", y="segment")
    axes.grid(visible=False)
    axes.yaxis.get_major_locator().set_params(integer=True)


def _draw_values(of: Callable[[Motion], Curves], axes: Any, answer: Motion) -> None:
    curves = of(answer)
    for k, name in enumerate(curves.names):
        dashes = ("-", (0, (4, 1.5)), (0, (1, 1)))[k // len(style.CURVES) % 3]
        look = {"color": style.CURVES[k % len(style.CURVES)], "linestyle": dashes, "linewidth": 1.5, "label": name}
        axes.plot(curves.times, curves.values[:, k], **look)
    if len(curves.names) <= style.MOST_IN_LEGEND:
        axes.legend(
            loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=style.SMALL_PT, labelcolor=style.PALE
        )
    finish_axes(axes, curves.title, x="time", y=curves.unit)


def _draw_times(axes: Any, answer: Motion) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter  # noqa: PLC0415

    times = 1e3 * np.array([solution.seconds for solution in answer.solutions])
    solved = np.array([solution.solved for solution in answer.solutions])
    number = np.arange(1, len(times) + 1)
    axes.plot(number[solved], times[solved], "o", color=style.CURVES[0], markersize=3.2, label="solved")
    if not solved.all():
        axes.plot(number[~solved], times[~solved], "x", color=style.TARGET, markersize=5, label="not solved")
    median = float(np.median(times))
    axes.axhline(median, color=style.CURVES[1], linewidth=1.4, zorder=0)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    finish_axes(axes, f"time per waypoint (median {median:.3g} ms)", x="waypoint", y="ms", legend=not solved.all())


_DRAWN: dict[str, Callable[[Any, Any], None]] = {
    "clearance": _draw_clearance,
    "clearance map": _draw_map,
    "convergence": _draw_convergence,
    "actuators": partial(_draw_values, actuators_of),
    "bends": partial(_draw_values, bends_of),
    "lengths": partial(_draw_values, lengths_of),
    "times": _draw_times,
}


MOST_LABELS = 12
"""Robots of a front whose fields are written beside them."""

MOST_PATTERNS = 16
"""Patterns of a calibration that are named, the worst ones."""


@contextmanager
def _chart(file: str | Path, size: tuple[float, float]) -> Iterator[Any]:
    """A figure of this size, in inches, that is written into a file in the end."""
    check_picture("file", Path(file), others=())
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
