"""Pictures of a map of the workspace: slices, what obstacles take away, and the whole in three dimensions."""

import html
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Vector
from sinuous.base.documents import written
from sinuous.studies.workspace.reach import Reach, Verdict
from sinuous.view.pictures.files import TIGHT, check_picture, image_in_page, save_figure, stills
from sinuous.view.pictures.space import new_figure

PLANES = ((2, "x", "y"), (1, "x", "z"), (0, "y", "z"))
"""Axis across each slice, and what lies along its picture."""

COLOURS = ("#ffffff", "#f3f4f6", "#7d6b91", "#7d6b91", "#c8384a", "#e0a458", "#9aa3ad")
"""Of the reasons of holes, in the order of `Verdict`."""

MOST_DOTS = 40_000

DOT = 260.0
"""Width of the picture in three dimensions, in the unit of its dots."""


def check_map(key: str, file: Path) -> None:
    """Refuse a picture or page that cannot be drawn, before anything is solved.

    Raises
    ------
    InputError
        When Matplotlib is missing, or does not know the kind of file.
    """
    check_picture(key, file, ("html", *stills()))


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
    figure = map_of(found, at)
    if target.suffix.lower() != ".html":
        save_figure(figure, target)
        return
    page = _page(found, image_in_page(figure, "slices of the workspace", **TIGHT))
    with written(target, "file"):
        target.write_text(page, encoding="utf-8")


def map_of(found: Reach, at: Vector | None = None) -> Any:
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
    kinds = {"vmin": -0.5, "vmax": len(Verdict) - 0.5, "cmap": ListedColormap(COLOURS)}
    seen = ~np.isin(holes, (Verdict.SOLVED, Verdict.OUT_OF_REACH)) & behind
    yield _Row(holes, "holes, and why", kinds, seen, "holes of the far half")


def _draw(found: Reach, index: tuple[int, int, int]) -> Any:
    rows = list(_rows(found))
    figure = new_figure(figsize=(15.0, 3.9 * len(rows)), dpi=90, layout="constrained")
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
    step, size = max(1, len(points) // MOST_DOTS), max(4.0, 0.25 * (DOT / max(found.voxels.shape)) ** 2)
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
