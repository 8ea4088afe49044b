"""Pictures in space with Matplotlib: robots, scenes, targets, solutions and motions."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous import checks
from sinuous.arguments import Number
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.pictures.contents import Asked, Contents, Moving, Things, gather
from sinuous.pictures.files import need_matplotlib
from sinuous.pictures.shapes.dots import Dotted, dots
from sinuous.pictures.shapes.paint import GHOST, add, paint_arm, paint_walls, places_of, tones, walls_of
from sinuous.pictures.shapes.stage import ARROW, Stage, extent, fill, set_stage, stage_of
from sinuous.pictures.style import DOTS, INK, PATH, ROUTE, TARGET, TIP_PATH, TITLE, View, X, Y, Z, tidy_space
from sinuous.scene.obstacles import Obstacle
from sinuous.solution.solution import Solution
from sinuous.words import duration

if TYPE_CHECKING:
    from mpl_toolkits.mplot3d import Axes3D

GHOSTS = 7
"""Shapes of a motion that are drawn, beside the last one."""

ALONG_PATH = 400
"""Places of a motion that the path of its tip goes through."""

AREA, EDGE, HEAD = 6.4, 0.1, 0.3
"""Longer side of a picture, what is left free at its sides, and the height of a title, in inches."""


def plot(*things: Things, ax: "Axes3D | None" = None, view: Sequence[Number] = (30, -60)) -> "Axes3D":
    """Draw robots, scenes, targets, solutions and motions together.

    Parameters
    ----------
    *things : Robot, Scene, obstacle, Target, Problem, Job, Solution, Solutions, Motion, or a list of them
        A robot is drawn straight; with an array of configurations, (n, 3) or (k, n, 3), right after it, in those. A
        solution brings its scene, its targets, and as a dashed line the route that led to it. Several robots have
        colours of their own; what is not solved is orange. Of a motion the last shape is solid, with others on the
        way as ghosts, and a line is the path of the tip. What is in front of a robot is see-through.
    ax : Axes3D, optional
        Where to draw, made with `projection="3d"`; what was drawn there before stays. By default a new figure of
        pyplot.
    view : (float, float)
        Where it is looked at from, in degrees: elevation above the xy plane, azimuth about z from x.

    Returns
    -------
    Axes3D
        What was drawn on; `ax.figure.savefig("shape.png")` keeps it.

    Raises
    ------
    InputError
        When Matplotlib is missing, or a thing cannot be drawn.
    """
    need_matplotlib("plot")
    seen = as_view(view)
    contents = gather(things)
    stage = stage_of(contents)
    own = ax is None
    if ax is None:
        from matplotlib import pyplot  # noqa: PLC0415

        ax = new_axes(pyplot.figure(**sizes(stage, seen)))
    elif not hasattr(ax, "get_proj"):
        raise InputError("ax", "", ax, 'axes in space, made with projection="3d"')
    elif ax.has_data():
        low, high = np.transpose([ax.get_xlim(), ax.get_ylim(), ax.get_zlim()])
        stage = stage.joined(low, high)
    draw_contents(ax, contents, stage, seen)
    if own:
        room = room_of(ax.figure)
        draw_head(ax.figure, contents, room)
        fill(ax, stage, room)
    else:
        ax.set_title(caption(contents) if contents.answers else "", fontsize=TITLE, color=INK)
        fill(ax, stage)
    return ax


def as_view(view: Sequence[Number]) -> View:
    """Check where a picture is looked at from."""
    return View(*checks.array("view", view, (2,), "elevation and azimuth in degrees").tolist())


def sizes(stage: Stage, view: View, area: float = AREA) -> dict[str, Any]:
    """Return size and resolution of a figure that the stage fills."""
    width, height = extent(stage, view)
    longest = max(width, height)
    return {"figsize": (area * max(width / longest, 0.6) + 0.6, area * max(height / longest, 0.5) + 0.6), "dpi": 150}


def new_figure(**size: Any) -> Any:
    """Return a figure of its own, which touches neither pyplot nor the backend of a caller."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    figure = Figure(**size)
    FigureCanvasAgg(figure)
    return figure


def new_axes(figure: Any) -> Any:
    """Return axes in space as large as the figure; `fill` moves them to their place."""
    width, height = figure.get_size_inches()
    side = max(width, height)
    axes = figure.add_axes((0.0, 0.0, side / width, side / height), projection="3d", computed_zorder=False)
    axes.patch.set_visible(False)
    return axes


def room_of(figure: Any, head: float = HEAD) -> Floats:
    """Opposite corners (2, 2), in pixels, of the room in a figure under a title of this height (inches)."""
    width, height = figure.get_size_inches()
    room: Floats = figure.dpi * np.array([[EDGE, EDGE], [width - EDGE, height - EDGE - head]])
    return room


def draw_contents(axes: Any, contents: Contents, stage: Stage, view: View) -> None:
    """Draw everything at its place on the stage, motions and obstacles that move at their end."""
    tidy_space(axes)
    set_stage(axes, stage, view)
    draw_shapes(axes, contents, stage, view)
    draw_lines(axes, contents, stage)


def draw_head(figure: Any, contents: Contents, room: Floats) -> None:
    """Write what the answers say above the room (pixels) of the picture, in letters small enough to fit."""
    if contents.answers:
        x, y = 0.5 * (room[0, 0] + room[1, 0]), room[1, 1] + 0.3 * HEAD * figure.dpi
        place = x / figure.bbox.width, y / figure.bbox.height
        head = figure.text(*place, caption(contents), fontsize=TITLE, color=INK, ha="center", va="bottom")
        head.set_fontsize(TITLE * min(1.0, (room[1, 0] - room[0, 0]) / head.get_window_extent().width))


def draw_shapes(axes: Any, contents: Contents, stage: Stage, view: View) -> None:
    """Draw all that has a surface."""
    arms = tones(contents.all_arms)
    painted = [part for arm, colours in arms for part in paint_arm(arm, colours, stage, view)]
    for moving, (_, colours) in zip(contents.moving, arms[len(contents.arms) :], strict=True):
        for share in np.linspace(0.0, 1.0, GHOSTS + 1)[:-1].tolist():
            painted += paint_arm(moving.at(share), colours, stage, view, GHOST)
    obstacles = contents.obstacles_at(1.0)
    walls = walls_of(obstacles, stage)
    add(axes, paint_walls(walls, *places_of(contents.all_arms, stage), view) + painted)
    draw_dots(axes, obstacles, stage)


def draw_dots(axes: Any, obstacles: Iterable[Obstacle], stage: Stage) -> list[Any]:
    """Draw clouds, grids and fields; return what was drawn."""
    drawn = []
    for obstacle in obstacles:
        if isinstance(obstacle, Dotted):
            points = dots(obstacle)
            inside = ((points >= stage.low) & (points <= stage.high)).all(axis=-1)
            look = {"color": DOTS, "s": 1.6, "linewidths": 0.0, "depthshade": False, "zorder": 1}
            drawn.append(axes.scatter(*points[inside].T, **look))
    return drawn


def draw_lines(axes: Any, contents: Contents, stage: Stage, *, tips: bool = True) -> None:
    """Draw targets, paths, routes, and where the tips of motions go."""
    for asked in contents.asked:
        draw_target(axes, asked, ARROW * stage.span)
    for path in contents.paths:
        axes.plot(*path.T, color=PATH, linewidth=2.4, zorder=3, solid_capstyle="round")
    for route in contents.routes:
        axes.plot(*route.T, color=ROUTE, linewidth=1.3, linestyle=(0, (4, 2)), zorder=4)
    for moving in contents.moving if tips else ():
        axes.plot(*tip_path(moving).T, color=TIP_PATH, linewidth=1.4, zorder=4)


def tip_path(moving: Moving) -> Floats:
    """Points (m, 3) that the tip goes through, evenly spaced in time."""
    arms = [moving.at(k / ALONG_PATH).q for k in range(ALONG_PATH + 1)]
    return moving.robot.tip(np.stack(arms))[:, :3, 3]


def draw_target(axes: Any, asked: Asked, size: float) -> None:
    """Draw a point, and an arrow where a direction is asked, three where a whole rotation is."""
    place, target = asked.end[:3, 3], asked.target
    axes.scatter(*place, color=TARGET, s=34, edgecolors="white", linewidths=0.8, depthshade=False, zorder=7)
    arrows = [] if target.direction is None else [(target.direction, TARGET)]
    if target.rotation is not None:
        arrows = list(zip(target.rotation.T, (X, Y, Z), strict=True))
    for arrow, colour in arrows:
        axes.quiver(*place, *(size * arrow), color=colour, linewidth=2.2, arrow_length_ratio=0.28, zorder=6)


def caption(contents: Contents) -> str:
    """What the answers say, in one line."""
    answers = contents.answers
    if len(answers) > 1:
        return f"{sum(answer.solved for answer in answers)} of {len(answers)} solved"
    answer = answers[0]
    clear = "" if answer.clearance is None else f", clearance at least {answer.clearance:.3g}"
    if isinstance(answer, Solution) or not answer.solutions:
        return f"{answer.status.replace('_', ' ')}{clear}, {duration(answer.seconds)}"
    solved = sum(solution.solved for solution in answer.solutions)
    begun = "" if answer.solved else f"{answer.status.replace('_', ' ')}: "
    return f"{begun}{solved} of {len(answer.solutions) + answer.remaining} waypoints solved{clear}"
