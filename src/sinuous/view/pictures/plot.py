"""Pictures in space with Matplotlib, still and moving: robots, scenes, targets, solutions and motions."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import Number, Whole
from sinuous.base.checks import Floats, written
from sinuous.base.errors import InputError
from sinuous.scene.moving import Moving
from sinuous.scene.obstacles import Obstacle
from sinuous.view.display import style
from sinuous.view.display.bounds import Bounds, best_view
from sinuous.view.display.contents import Contents, PlacedTarget, Things, gather
from sinuous.view.display.results import caption_of
from sinuous.view.display.style import Viewpoint, arrows_of
from sinuous.view.display.surfaces import Dotted, points_of
from sinuous.view.pictures import figures
from sinuous.view.pictures.figures import Pixels
from sinuous.view.pictures.paint import add_facets, obstacle_walls, paint_arm, paint_arms, paint_walls, places_of

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

GHOST_COUNT = 7
"""Shapes of a motion that are drawn, beside the last one."""

PATH_STEPS = 400
"""Places of a motion that the path of its tip goes through."""

FILM_INCHES, FILM_DPI = 4.6, 110.0
"""Longer side of a moving picture, in inches, and pixels in one."""

WAY_STEPS = 24
"""Places on its way at which obstacles are made see-through where they hide a robot."""


def plot(
    *things: Things, ax: "Axes3D | None" = None, view: Sequence[Number] = (30, -60), path: str | Path | None = None
) -> "Axes3D":
    """Draw robots, scenes, targets, solutions and motions together.

    Parameters
    ----------
    *things : Robot, Scene, obstacle, Target, Problem, Job, Solution, Solutions, Motion, or a list of them
        A robot is drawn straight; with an array of configurations, (n, 3) or (k, n, 3), right after it, in those. A
        solution brings its scene, its targets, and as a dashed line the route that led to it. Several robots have
        colours of their own; what is not solved is orange, and a cross marks the place that says why. A robot that
        gravity bends is drawn with its load, and see-through without; with an `uncertainty`, see-through around it is
        where the body may be. Of a motion the last shape is solid, with others on the way as ghosts, and a line is the
        path of the tip. What is in front of a robot is see-through.
    ax : Axes3D, optional
        Where to draw, made with `projection="3d"`; what was drawn there before stays. By default a new figure of
        pyplot.
    view : (float, float)
        Where it is looked at from, in degrees: elevation above the xy plane, azimuth about z from x.
    path : path, optional
        Write the picture into this file, too: `.png`, `.pdf`, `.svg`, or what else Matplotlib knows. `animate` writes
        what moves, and `show` pages that can be turned.

    Returns
    -------
    Axes3D
        What was drawn on.

    Raises
    ------
    InputError
        When Matplotlib is missing, a thing cannot be drawn, or the file cannot be written.
    """
    figures.need_matplotlib("plot")
    if path is not None:
        figures.check_picture("path", Path(path), others=())
    seen, contents = as_view(view), gather(things)
    box = figures.axes_box(contents)
    if ax is None:
        from matplotlib import pyplot  # noqa: PLC0415

        ax = draw_in(pyplot.figure(**figures.figure_size(box, seen)), contents, box, seen)
    else:
        if not hasattr(ax, "get_proj"):
            raise InputError("ax", "", ax, 'axes in space, made with projection="3d"')
        if ax.has_data():
            low, high = np.transpose([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
            box = box.joined(low, high)
        draw_contents(ax, contents, box, seen)
        ax.set_title(caption_of(contents.answers) if contents.answers else "", fontsize=style.TITLE_PT, color=style.INK)
        figures.fill_room(ax, box)
    if path is not None:
        with written(path, "path"):
            ax.figure.savefig(path)
    return ax


def as_view(view: Sequence[Number]) -> Viewpoint:
    """Check where a picture is looked at from."""
    return Viewpoint(*checks.array("view", view, (2,), "elevation and azimuth in degrees").tolist())


def draw_still(
    contents: Contents, area: float = figures.PICTURE_INCHES, dpi: float = 150.0, head: float = figures.HEAD_INCHES
) -> Any:
    """Return a figure of all that there is, from the side where a robot shows most.

    `area` is its longer side and `head` the height of its title, in inches.
    """
    box, view = figures.axes_box(contents), best_view(contents)
    figure = figures.new_figure(**figures.figure_size(box, view, area) | {"dpi": dpi})
    draw_in(figure, contents, box, view, figures.room_of(figure, head), head > 0.0)
    return figure


def draw_in(
    figure: Any, contents: Contents, box: Bounds, view: Viewpoint, room: Floats | None = None, titled: bool = True
) -> Any:
    """Draw everything into the room of a figure, corners (2, 2) in pixels, by default all of it; return the axes."""
    axes, own = figures.new_axes(figure), figures.room_of(figure) if room is None else room
    draw_contents(axes, contents, box, view)
    if titled:
        draw_head(figure, contents, own)
    figures.fill_room(axes, box, own)
    return axes


def draw_contents(axes: Any, contents: Contents, box: Bounds, view: Viewpoint) -> None:
    """Draw everything at its place in the box, motions and obstacles that move at their end."""
    figures.set_bounds(axes, box, view)
    draw_surfaces(axes, contents, box, view)
    draw_lines(axes, contents, box)


def draw_head(figure: Any, contents: Contents, room: Floats) -> None:
    """Write what the answers say above the room (pixels) of the picture, in letters small enough to fit."""
    if contents.answers:
        x, y = 0.5 * (room[0, 0] + room[1, 0]), room[1, 1] + 0.3 * figures.HEAD_INCHES * figure.dpi
        place = x / figure.bbox.width, y / figure.bbox.height
        head = figure.text(
            *place, caption_of(contents.answers), fontsize=style.TITLE_PT, color=style.INK, ha="center", va="bottom"
        )
        head.set_fontsize(style.TITLE_PT * min(1.0, (room[1, 0] - room[0, 0]) / head.get_window_extent().width))


def draw_surfaces(axes: Any, contents: Contents, box: Bounds, view: Viewpoint) -> None:
    """Draw all that has a surface, and the points of what has none."""
    arms = contents.arms_at(1.0)
    painted = paint_arms(arms, box, view)
    for moving in contents.moving:
        for share in [] if moving.ghost else np.linspace(0.0, 1.0, GHOST_COUNT + 1)[:-1].tolist():
            painted += paint_arm(moving.at(share)._replace(ghost=True), box, view)
    obstacles = contents.obstacles_at(1.0)
    add_facets(axes, paint_walls(obstacle_walls(obstacles, box), *places_of(arms, box), view) + painted)
    draw_dots(axes, obstacles, box)


def draw_dots(axes: Any, obstacles: Iterable[Obstacle], box: Bounds) -> list[Any]:
    """Draw clouds, grids and fields; return what was drawn."""
    drawn = []
    for obstacle in obstacles:
        if isinstance(obstacle, Dotted):
            points = points_of(obstacle)
            inside = ((points >= box.low) & (points <= box.high)).all(axis=-1)
            look = {"color": style.DOTS, "s": 1.6, "linewidths": 0.0, "depthshade": False, "zorder": 1}
            drawn.append(axes.scatter(*points[inside].T, **look))
    return drawn


def draw_lines(axes: Any, contents: Contents, box: Bounds, *, moving: bool = True) -> None:
    """Draw targets, paths, routes and forces; of motions where the tips go, and the forces at their end."""
    for target in contents.targets:
        draw_target(axes, target, style.ARROW_SHARE * box.span)
    for path in contents.paths:
        axes.plot(*path.T, color=style.PATH, linewidth=2.4, zorder=3, solid_capstyle="round")
    draw_forces(axes, contents.forces_at(1.0) if moving else contents.forces)
    for route in contents.routes:
        axes.plot(*route.T, color=style.ROUTE, linewidth=1.3, linestyle=(0, (4, 2)), zorder=4)
    for mark in contents.marks:
        axes.scatter(
            *mark, color=style.CONTACT, marker="X", s=60, edgecolors="white", linewidths=0.8, depthshade=False, zorder=8
        )
    for path in tip_paths(contents) if moving else ():
        axes.plot(*path.T, color=style.TIP_PATH, linewidth=1.4, zorder=4)


def draw_forces(axes: Any, forces: Iterable[Floats]) -> list[Any]:
    """Draw arrows along lines (2, 3) to where forces act; return what was drawn."""
    look = {"color": style.FORCE, "linewidth": 1.6, "arrow_length_ratio": 0.2, "zorder": 5}
    return [axes.quiver(*begin, *(end - begin), **look) for begin, end in forces]


def tip_paths(contents: Contents) -> list[Floats]:
    """Points (m, 3) that the tip of each motion goes through, evenly spaced in time."""
    shares = np.linspace(0.0, 1.0, PATH_STEPS + 1).tolist()
    ways = [moving for moving in contents.moving if not moving.ghost]
    return [way.begin.robot.tip(np.stack([way.at(share).q for share in shares]))[:, :3, 3] for way in ways]


def draw_target(axes: Any, placed: PlacedTarget, size: float) -> None:
    """Draw a point, and an arrow where a direction is asked, three where a whole rotation is."""
    target, place = placed
    axes.scatter(*place, color=style.TARGET, s=34, edgecolors="white", linewidths=0.8, depthshade=False, zorder=7)
    for arrow, colour in arrows_of(target):
        axes.quiver(*place, *(size * arrow), color=colour, linewidth=2.2, arrow_length_ratio=0.28, zorder=6)


def animate(
    *things: Things, path: str | Path, view: Sequence[Number] = (30, -60), seconds: Number = 4.0, fps: Whole = 15
) -> None:
    """Write an animation: motions from beginning to end; what has none is shown from all sides.

    Parameters
    ----------
    *things
        As for `plot`.
    path : path
        Ends in `.gif`, or in `.mp4` where the program ffmpeg is.
    view : (float, float)
        Elevation and azimuth in degrees, as for `plot`.
    seconds : float
        How long it takes. Several motions begin together and end together.
    fps : int
        Pictures a second.

    Raises
    ------
    InputError
        When something that is needed is missing, a thing cannot be drawn, or the file cannot be written.
    """
    file = Path(path)
    figures.check_picture("path", file, still=False)
    seen = as_view(view)
    rate = checks.integer("fps", fps, 1, 100)
    count = max(2, round(checks.number("seconds", seconds, above=0.0) * rate))
    contents = gather(things)
    with written(file, "path"):
        figures.write_movie(file, draw_frames(contents, seen, count), rate)


def draw_frames(contents: Contents, view: Viewpoint, count: int, *, area: float = FILM_INCHES) -> Iterator[Pixels]:
    """Yield pictures (height, width, 3), all of one size."""
    return _moving(contents, view, count, area) if contents.moving else _turning(contents, view, count, area)


def _moving(contents: Contents, view: Viewpoint, count: int, area: float) -> Iterator[Pixels]:
    """The view stays; obstacles are see-through wherever they hide a robot on its way."""
    box = figures.axes_box(contents)
    figure = figures.new_figure(**figures.figure_size(box, view, area) | {"dpi": FILM_DPI})
    axes = _prepared(figure, contents, box, view)
    figures.fill_room(axes, box, figures.room_of(figure))
    bodies = places_of(contents.arms_at(*np.linspace(0.0, 1.0, WAY_STEPS).tolist()), box)
    still = [obstacle for obstacle in contents.obstacles if not isinstance(obstacle, Moving)]
    walls = paint_walls(obstacle_walls(still, box), *bodies, view)
    draw_dots(axes, still, box)
    draw_lines(axes, contents, box, moving=False)
    paths = tip_paths(contents)
    for share in np.linspace(0.0, 1.0, count).tolist():
        arms = contents.arms_at(share)
        there = [own for own in contents.obstacles_at(share) if not any(own is one for one in still)]
        moved = paint_walls(obstacle_walls(there, box), *bodies, view) if there else []
        drawn = [add_facets(axes, walls + moved + paint_arms(arms, box, view)), *draw_dots(axes, there, box)]
        for moving in contents.moving:
            drawn += draw_forces(axes, moving.forces_at(share))
        for path in paths:
            until = 1 + round(share * (len(path) - 1))
            drawn += axes.plot(*path[:until].T, color=style.TIP_PATH, linewidth=1.6, zorder=4)
        yield _pixels(figure)
        for artist in drawn:
            artist.remove()


def _turning(contents: Contents, view: Viewpoint, count: int, area: float) -> Iterator[Pixels]:
    """The viewer goes once around, as far away as is needed from the worst side."""
    box = figures.axes_box(contents)
    half = 0.5 * np.array([*np.full(2, np.hypot(*(box.high - box.low)[:2])), (box.high - box.low)[2]])
    around = Bounds(box.middle - half, box.middle + half)
    figure = figures.new_figure(**figures.figure_size(around, Viewpoint(view.elevation, 0.0), area) | {"dpi": FILM_DPI})
    for turn in np.linspace(0.0, 360.0, count, endpoint=False).tolist():
        figure.clear()
        seen = Viewpoint(view.elevation, view.azimuth + turn)
        axes = _prepared(figure, contents, box, seen)
        axes.set_axis_off()
        figures.fill_room(axes, box, figures.room_of(figure))
        draw_surfaces(axes, contents, box, seen)
        draw_lines(axes, contents, box)
        yield _pixels(figure)


def _prepared(figure: Any, contents: Contents, box: Bounds, view: Viewpoint) -> Any:
    axes = figures.new_axes(figure)
    figures.set_bounds(axes, box, view)
    draw_head(figure, contents, figures.room_of(figure))
    return axes


def _pixels(figure: Any) -> Pixels:
    figure.canvas.draw()
    return np.array(figure.canvas.buffer_rgba())[..., :3]
