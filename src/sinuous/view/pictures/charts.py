"""Charts of studies: of an assessment, a design, a calibration, and a map of the workspace."""

import html
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Vector
from sinuous.base.documents import written
from sinuous.base.errors import InputError
from sinuous.studies.workspace.reach import Reach, Verdict
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


PLANES = ((2, "x", "y"), (1, "x", "z"), (0, "y", "z"))
"""Axis across each slice, and what lies along its picture."""

HOLE_COLOURS = ("#ffffff", "#f3f4f6", "#7d6b91", "#7d6b91", "#c8384a", "#e0a458", "#9aa3ad")
"""Of the reasons of holes, in the order of `Verdict`."""

MOST_DOTS = 40_000

DOTS_WIDTH = 260.0
"""Width of the picture in three dimensions, in the unit of its dots."""


def check_map(key: str, file: Path) -> None:
    """Refuse a picture or page that cannot be drawn, before anything is solved.

    Raises
    ------
    InputError
        When Matplotlib is missing, or does not know the kind of file.
    """
    check_picture(key, file, ("html", *figures.still_kinds()))


def plot_reach(found: Reach, file: str | Path, at: Vector | None = None) -> None:
    """Draw a map: three slices of the share of directions, of the reasons of holes, of what obstacles take, and all.

    Parameters
    ----------
    found : Reach
    file : path
        Its ending says which kind of picture; `.html` is a page with the picture and the totals.
    at : array_like (3,), optional
        Where the slices cross; by default the voxel nearest to the middle of what is reached.

    Raises
    ------
    InputError
        When Matplotlib is missing, does not know the kind of file, `at` is outside the map, or the file cannot be
        written.
    """
    target = Path(file)
    check_map("file", target)
    figure = draw_map(found, at)
    if target.suffix.lower() != ".html":
        figures.save_figure(figure, target)
        return
    page = _page(found, figures.image_in_page(figure, "slices of the workspace", **figures.TIGHT))
    with written(target, "file"):
        target.write_text(page, encoding="utf-8")


def draw_map(found: Reach, at: Vector | None = None) -> Any:
    """Return the figure of a map; see `plot_reach`."""
    return _draw(found, _middle(found) if at is None else found._index(checks.vector("at", at)))


def _middle(found: Reach) -> tuple[int, int, int]:
    taken = np.argwhere(found.free_share > 0.0)
    x, y, z = np.rint(taken.mean(axis=0)).astype(int).tolist() if len(taken) else [n // 2 for n in found.voxels.shape]
    return x, y, z


class _Row(NamedTuple):
    """A row of a map: values of all voxels, what they are, their colours, and the voxels that are seen in space."""

    values: Any
    label: str
    style: dict[str, Any]
    seen: Any
    which: str


def _rows(found: Reach) -> Iterator[_Row]:
    shares = {"vmin": 0.0, "vmax": 1.0}
    behind = found.voxels.middles[..., 1] >= found.base[1] - 0.5 * found.voxels.spacing
    label = "share of directions solved and proved"
    yield _Row(found.share, label, {**shares, "cmap": "viridis"}, found.reachable & behind, "the far half")
    if found.names:
        label, seen = "share that obstacles take away", found.lost > 0.5
        yield _Row(found.lost, label, {**shares, "cmap": "magma_r"}, seen, "where obstacles take more than half")
    from matplotlib.colors import ListedColormap  # noqa: PLC0415

    holes = np.where(found.share > 0.0, Verdict.SOLVED, found.reasons)
    kinds = {"vmin": -0.5, "vmax": len(Verdict) - 0.5, "cmap": ListedColormap(HOLE_COLOURS)}
    seen = ~np.isin(holes, (Verdict.SOLVED, Verdict.OUT_OF_REACH)) & behind
    yield _Row(holes, "holes, and why", kinds, seen, "holes of the far half")


def _draw(found: Reach, index: tuple[int, int, int]) -> Any:
    rows = list(_rows(found))
    figure = figures.new_figure(figsize=(15.0, 3.9 * len(rows)), dpi=90, layout="constrained")
    grid = figure.add_gridspec(len(rows), 4, width_ratios=(1.0, 1.0, 1.0, 1.3))
    for i, row in enumerate(rows):
        for column, plane in enumerate(PLANES):
            drawn = _slice(figure.add_subplot(grid[i, column]), found, row.values, plane, index, row.style)
        bar = figure.colorbar(drawn, ax=figure.axes[-3:], shrink=0.85, label=row.label)
        if row.label.startswith("holes"):
            bar.set_ticks(range(len(Verdict)), labels=[code.name.lower().replace("_", " ") for code in Verdict])
        _draw_seen(figure.add_subplot(grid[i, 3], projection="3d"), found, row)
    return figure


def _slice(axes: Any, found: Reach, values: Any, plane: tuple[int, str, str], index: Any, style: Any) -> Any:
    """Draw the voxels of a plane."""
    across, first, second = plane
    own = ["xyz".index(first), "xyz".index(second)]
    low = found.voxels.first - 0.5 * found.voxels.spacing
    high = low + found.voxels.spacing * np.array(found.voxels.shape)
    extent = [low[own[0]], high[own[0]], low[own[1]], high[own[1]]]
    picture = np.take(values, index[across], axis=across).T
    drawn = axes.imshow(picture, origin="lower", extent=extent, interpolation="nearest", **style)
    place = found.voxels.first[across] + found.voxels.spacing * index[across]
    axes.set_title(f"{'xyz'[across]} = {place:.4g}", fontsize=10)
    axes.set(xlabel=first, ylabel=second)
    return drawn


def _draw_seen(axes: Any, found: Reach, row: _Row) -> None:
    """Draw the voxels of a row that are seen in space, all at one scale."""
    points, colours = found.voxels.middles[row.seen], row.values[row.seen]
    step, size = max(1, len(points) // MOST_DOTS), max(4.0, 0.25 * (DOTS_WIDTH / max(found.voxels.shape)) ** 2)
    axes.scatter(*points[::step].T, c=colours[::step], s=size, alpha=0.6, linewidths=0.0, **row.style)
    low = found.voxels.first - 0.5 * found.voxels.spacing
    high = low + found.voxels.spacing * np.array(found.voxels.shape)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]), xlabel="x", ylabel="y", zlabel="z")
    axes.set_box_aspect(np.array(found.voxels.shape, float))
    axes.set_title(row.which, fontsize=10)


def _page(found: Reach, image: str) -> str:
    """One file that opens anywhere."""
    style = "body{font-family:sans-serif;max-width:100rem;margin:2rem auto;padding:0 1rem}img{max-width:100%}"
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Workspace</title><style>{style}</style>'
        f"<h1>Workspace</h1><pre>{html.escape(str(found))}</pre>{image}</html>\n"
    )
