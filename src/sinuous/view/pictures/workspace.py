"""Pictures of a map of the workspace: three slices, and in space what is reached behind the robot."""

import html
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Vector
from sinuous.base.checks import Floats, written
from sinuous.model.robot import Robot
from sinuous.scene.scene import SceneLike, as_scene
from sinuous.studies.workspace.reach import Reach, Truths, Verdict
from sinuous.view.display import style
from sinuous.view.display.bounds import Bounds, best_view, direction_of
from sinuous.view.display.contents import Contents, gather
from sinuous.view.display.style import Viewpoint
from sinuous.view.pictures import figures
from sinuous.view.pictures.diagrams import DASHED, finish_axes
from sinuous.view.pictures.paint import Painted, add_facets, lit, obstacle_walls, paint_arms, paint_walls, places_of
from sinuous.view.pictures.plot import draw_dots

PLANES = ((2, "x", "y"), (1, "x", "z"), (0, "y", "z"))
"""Axis across each slice, and what lies along its picture."""

REACHED, POSITION_ALONE = "#8accb6", "#d5ece4"
"""Colours of what is reached, and of what is reached in none of the directions that were asked for."""

HOLES = {
    Verdict.TARGET_BLOCKED: (style.OBSTACLE, "proved: the body would overlap an obstacle"),
    Verdict.BASE_BLOCKED: (style.METAL, "proved: the base is blocked"),
    Verdict.OBSTACLE: (style.UNSOLVED[0], "an obstacle is in the way of all that was found"),
    Verdict.LIMITS: (style.GRID, "limits stop all that was found"),
    Verdict.NOT_FOUND: (style.UNSOLVED[1], "not found"),
}
"""Colours of what is not reached, and words for it; out of reach is white."""

SHADES = 8
"""Colours of shares in space."""

MOST_CUBES = 30
"""Cubes along the longest side in space; of more voxels, several make one."""

SLICE_INCHES, SPACE_INCHES, LEGEND_INCHES = 3.1, 4.2, 0.7


def plot_reach(
    found: Reach,
    file: str | Path,
    at: Vector | None = None,
    *,
    robot: Robot | None = None,
    scene: SceneLike | None = None,
) -> None:
    """Draw a map: three slices of what is reached and why not more, and in space what is reached behind the robot.

    Parameters
    ----------
    found : Reach
    file : path
        Its ending says which kind of picture; `.html` is a page with the picture and the totals.
    at : array_like (3,), optional
        Where the slices cross; by default the voxel nearest to the middle of what is reached.
    robot : Robot, optional
    scene : Scene or list of obstacles, optional
        Drawn with the map.

    Raises
    ------
    InputError
        When Matplotlib is missing, does not know the kind of file, `at` is outside the map, or the file cannot be
        written.
    """
    target = Path(file)
    figures.check_picture("file", target, others=("html",))
    figure = draw_map(found, at, [] if robot is None else [robot], as_scene(scene))
    if target.suffix.lower() != ".html":
        figures.save_figure(figure, target)
        return
    page = _page(found, figures.image_in_page(figure, "slices of the workspace", **figures.TIGHT))
    with written(target, "file"):
        target.write_text(page, encoding="utf-8")


def draw_map(found: Reach, at: Vector | None = None, *things: Any) -> Any:
    """Return the figure of a map with what else there is; see `plot_reach`."""
    index = _middle(found) if at is None else found._index(checks.vector("at", at))
    width, height = SPACE_INCHES + 3.0 * SLICE_INCHES, SPACE_INCHES + LEGEND_INCHES
    figure = figures.new_figure(figsize=(width, height), dpi=110)
    drawn = [thing for thing in things if thing]
    _draw_space(figure, found, gather(drawn) if drawn else Contents(), SPACE_INCHES / width)
    colours, kinds = _colours(found)
    for column, plane in enumerate(PLANES):
        left = (SPACE_INCHES + column * SLICE_INCHES + 0.65) / width
        room = (left, (LEGEND_INCHES + 0.65) / height, (SLICE_INCHES - 0.85) / width, (SPACE_INCHES - 1.2) / height)
        _draw_slice(figure.add_axes(room), found, colours, plane, index)
    _draw_legend(figure, kinds, len(found.directions) > 1)
    words = str(found).splitlines()[1:3] if len(found.directions) else str(found).splitlines()[1:2]
    said = "\n".join(line.strip() for line in words)
    figure.text(0.01, 1.0, said, fontsize=style.TITLE_PT, color=style.INK, va="bottom")
    return figure


def _middle(found: Reach) -> tuple[int, int, int]:
    taken = np.argwhere(found.free_positions == Verdict.SOLVED)
    x, y, z = np.rint(taken.mean(axis=0)).astype(int).tolist() if len(taken) else [n // 2 for n in found.voxels.shape]
    return x, y, z


class _Kind(NamedTuple):
    """A colour of a map and what it means."""

    colour: str
    words: str


def _colours(found: Reach) -> tuple[Floats, list[_Kind]]:
    """Colours (x, y, z, 3) of all voxels, and what those that are there mean."""
    from matplotlib.colors import to_rgb  # noqa: PLC0415

    colours, kinds = np.ones((*found.voxels.shape, 3)), []

    def paint(which: Truths, colour: str, words: str) -> None:
        if which.any():
            colours[which] = to_rgb(colour)
            kinds.append(_Kind(colour, words))

    shared = len(found.directions) > 1
    hit = found.share > 0.0
    if shared:
        colours[hit] = _shades(found.share[hit])
    else:
        paint(hit, REACHED, "reached" if not len(found.directions) else found.asked_in_words)
    paint(found.reachable & ~hit, POSITION_ALONE, "reached, but in none of these directions")
    reasons = found.reasons if len(found.directions) else found.positions
    for verdict, (colour, words) in HOLES.items():
        paint(~found.reachable & (reasons == verdict), colour, words)
    return colours, kinds


def _shades(shares: Floats) -> Floats:
    """Colours (m, 3), 0 to 1, of shares (m,)."""
    steps = np.rint(shares * SHADES).astype(int)
    return np.array([style.map_colour(k / SHADES) for k in range(SHADES + 1)])[steps] / 255.0


def _draw_slice(axes: Any, found: Reach, colours: Floats, plane: tuple[int, str, str], index: Any) -> None:
    """Draw the voxels of a plane, and where without obstacles what is reached would end."""
    across, first, second = plane
    own = ["xyz".index(first), "xyz".index(second)]
    low = found.voxels.first - 0.5 * found.voxels.spacing
    high = low + found.voxels.spacing * np.array(found.voxels.shape)
    picture = np.swapaxes(np.take(colours, index[across], axis=across), 0, 1)
    extent = [low[own[0]], high[own[0]], low[own[1]], high[own[1]]]
    axes.imshow(picture, origin="lower", extent=extent, interpolation="nearest")
    if found.names:
        free = np.take(found.free_positions == Verdict.SOLVED, index[across], axis=across).T
        middles = [low[k] + found.voxels.spacing * (0.5 + np.arange(found.voxels.shape[k])) for k in own]
        if min(free.shape) > 1 and free.any():
            axes.contour(*middles, free, levels=[0.5], colors=style.PALE, linewidths=0.9, linestyles=[DASHED])
    axes.plot(*found.base[own], "+", color=style.INK, markersize=7.0)
    place = found.voxels.first[across] + found.voxels.spacing * index[across]
    finish_axes(axes, f"{'xyz'[across]} = {place:.4g}", x=first, y=second)
    axes.grid(visible=False)


def _draw_legend(figure: Any, kinds: list[_Kind], shared: bool) -> None:
    from matplotlib.lines import Line2D  # noqa: PLC0415
    from matplotlib.patches import Patch  # noqa: PLC0415

    handles: list[Any] = []
    if shared:
        shares = (1.0, 0.75, 0.5, 0.25)
        names = ("all directions", "3 of 4", "half", "1 of 4")
        colours = _shades(np.array(shares))
        handles += [Patch(facecolor=own, label=name) for own, name in zip(colours, names, strict=True)]
    handles += [Patch(facecolor=colour, label=words) for colour, words in kinds]
    handles.append(Line2D([], [], color=style.PALE, linestyle=DASHED, label="without obstacles"))
    figure.legend(
        handles=handles, loc="lower center", ncols=4, frameon=False, fontsize=style.SMALL_PT, labelcolor=style.PALE
    )


def _draw_space(figure: Any, found: Reach, contents: Contents, share: float) -> None:
    """Draw what is reached behind the robot, as seen from where it shows most, with the robot and its obstacles."""
    low = found.voxels.first - 0.5 * found.voxels.spacing
    high = low + found.voxels.spacing * np.array(found.voxels.shape)
    reached = found.voxels.middles[found.reachable]
    if len(reached):
        low, high = reached.min(axis=0) - found.voxels.spacing, reached.max(axis=0) + found.voxels.spacing
    box, view = Bounds(low, high), best_view(contents)
    if any(True for _ in contents.bodies):
        own = figures.axes_box(contents)
        box = box.joined(*np.clip([own.low, own.high], low - 0.2 * box.span, high + 0.2 * box.span))
    axes = figures.new_axes(figure)
    axes.set_position((0.0, 0.0, share, SPACE_INCHES / (SPACE_INCHES + LEGEND_INCHES)))
    figures.set_bounds(axes, box, view)
    arms = contents.arms_at(1.0)
    walls = paint_walls(obstacle_walls(contents.obstacles_at(1.0), box), *places_of(arms, box), view)
    add_facets(axes, _paint_cubes(found, view) + walls + paint_arms(arms, box, view))
    draw_dots(axes, contents.obstacles_at(1.0), box)
    width, height = figure.get_size_inches() * figure.dpi
    legend = LEGEND_INCHES * figure.dpi
    figures.fill_room(axes, box, np.array([[4.0, legend], [share * width - 4.0, height - 4.0]]))


def _paint_cubes(found: Reach, view: Viewpoint) -> list[Painted]:
    """Facets of what is reached behind the plane through the base, x or y, that faces the viewer most."""
    step = max(1, -(-max(found.voxels.shape) // MOST_CUBES))
    size = step * found.voxels.spacing
    share = found.share if len(found.directions) > 1 else np.where(found.reachable, found.share, 0.0)
    share = share[step // 2 :: step, step // 2 :: step, step // 2 :: step]
    middles = found.voxels.middles[step // 2 :: step, step // 2 :: step, step // 2 :: step]
    ahead = direction_of(Viewpoint(0.0, view.azimuth))
    across = int(np.abs(ahead).argmax())
    behind = np.sign(ahead[across]) * (middles - found.base)[..., across] < -size
    there = np.pad((share > 0.0) & behind, 1)
    painted = []
    for axis in range(3):
        for side in (-1, 1):
            open_ = (there & ~np.roll(there, -side, axis=axis))[1:-1, 1:-1, 1:-1]
            if not open_.any():
                continue
            facets = middles[open_][:, None] + 0.5 * size * _face(axis, side)
            shades = np.rint(share[open_] * SHADES).astype(int)
            for shade in np.unique(shades).tolist():
                red, green, blue = style.map_colour(shade / SHADES)
                colour = f"#{red:02x}{green:02x}{blue:02x}" if len(found.directions) > 1 else REACHED
                painted.append(lit(facets[shades == shade], colour, 1.0, view))
    return painted


def _face(axis: int, side: int) -> Floats:
    """Corners (4, 3) of a face of a cube from -1 to 1, counterclockwise as seen from outside."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    corners = np.full((4, 3), float(side))
    corners[:, first], corners[:, second] = (-1.0, 1.0, 1.0, -1.0), (-1.0, -1.0, 1.0, 1.0)
    return corners if side > 0 else corners[::-1]


def _page(found: Reach, image: str) -> str:
    """One file that opens anywhere."""
    style_ = "body{font-family:sans-serif;max-width:100rem;margin:2rem auto;padding:0 1rem}img{max-width:100%}"
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Workspace</title><style>{style_}</style>'
        f"<h1>Workspace</h1><pre>{html.escape(str(found))}</pre>{image}</html>\n"
    )
