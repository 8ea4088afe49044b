"""Moving pictures: robots on their way, or a scene that turns once."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Number, Whole
from sinuous.pictures.contents import Arm, Contents, Things, gather
from sinuous.pictures.files import MOVIES, check_picture, written
from sinuous.pictures.movies import write_movie
from sinuous.pictures.plot import (
    as_view,
    draw_dots,
    draw_head,
    draw_lines,
    draw_shapes,
    new_axes,
    new_figure,
    room_of,
    sizes,
    tip_path,
)
from sinuous.pictures.shapes.paint import add, paint_arm, paint_walls, places_of, tones, walls_of
from sinuous.pictures.shapes.stage import Stage, fill, set_stage, stage_of
from sinuous.pictures.style import TIP_PATH, View, tidy_space
from sinuous.scene.courses.moving import Moving

AREA, DPI = 4.6, 110.0
"""Longer side of a moving picture, in inches, and pixels in one."""

LOOKS = 24
"""Places on its way at which obstacles are made see-through where they hide a robot."""

Pixels = NDArray[np.uint8]


def animate(
    *things: Things,
    path: str | Path,
    view: Sequence[Number] = (30, -60),
    seconds: Number = 4.0,
    fps: Whole = 15,
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
    check_picture("path", file, MOVIES)
    seen = as_view(view)
    rate = checks.integer("fps", fps, 1, 100)
    count = max(2, round(checks.number("seconds", seconds, above=0.0) * rate))
    contents = gather(things)
    with written(file):
        write_movie(file, frames(contents, seen, count), rate)


def frames(contents: Contents, view: View, count: int, *, area: float = AREA) -> Iterator[Pixels]:
    """Yield pictures (height, width, 3), all of one size."""
    return _moving(contents, view, count, area) if contents.moving else _turning(contents, view, count, area)


def _moving(contents: Contents, view: View, count: int, area: float) -> Iterator[Pixels]:
    """The view stays; obstacles are see-through wherever they hide a robot on its way."""
    stage = stage_of(contents)
    figure = new_figure(**sizes(stage, view, area) | {"dpi": DPI})
    axes = _prepared(figure, contents, stage, view)
    fill(axes, stage, room_of(figure))
    on_the_way = [moving.at(share) for moving in contents.moving for share in np.linspace(0.0, 1.0, LOOKS).tolist()]
    bodies = places_of([*contents.arms, *on_the_way], stage)
    still = [obstacle for obstacle in contents.obstacles if not isinstance(obstacle, Moving)]
    walls = paint_walls(walls_of(still, stage), *bodies, view)
    draw_dots(axes, still, stage)
    draw_lines(axes, contents, stage, tips=False)
    paths = [tip_path(moving) for moving in contents.moving]
    for share in np.linspace(0.0, 1.0, count).tolist():
        arms = [*contents.arms, *(moving.at(share) for moving in contents.moving)]
        there = [own for own in contents.obstacles_at(share) if not any(own is one for one in still)]
        moved = paint_walls(walls_of(there, stage), *bodies, view) if there else []
        drawn = [add(axes, walls + moved + _painted(arms, stage, view)), *draw_dots(axes, there, stage)]
        for path in paths:
            until = 1 + round(share * (len(path) - 1))
            drawn += axes.plot(*path[:until].T, color=TIP_PATH, linewidth=1.6, zorder=4)
        yield _pixels(figure)
        for artist in drawn:
            artist.remove()


def _painted(arms: list[Arm], stage: Stage, view: View) -> list[Any]:
    return [part for arm, colours in tones(arms) for part in paint_arm(arm, colours, stage, view)]


def _turning(contents: Contents, view: View, count: int, area: float) -> Iterator[Pixels]:
    """The viewer goes once around, as far away as is needed from the worst side."""
    stage = stage_of(contents)
    width, height = (stage.high - stage.low)[:2]
    around = Stage(stage.middle - 0.5 * np.hypot(width, height), stage.middle + 0.5 * np.hypot(width, height))
    around.low[2], around.high[2] = stage.low[2], stage.high[2]
    figure = new_figure(**sizes(around, View(view.elevation, 0.0), area) | {"dpi": DPI})
    for turn in np.linspace(0.0, 360.0, count, endpoint=False).tolist():
        figure.clear()
        seen = View(view.elevation, view.azimuth + turn)
        axes = _prepared(figure, contents, stage, seen)
        axes.set_axis_off()
        fill(axes, stage, room_of(figure))
        draw_shapes(axes, contents, stage, seen)
        draw_lines(axes, contents, stage)
        yield _pixels(figure)


def _prepared(figure: Any, contents: Contents, stage: Stage, view: View) -> Any:
    axes = new_axes(figure)
    tidy_space(axes)
    set_stage(axes, stage, view)
    draw_head(figure, contents, room_of(figure))
    return axes


def _pixels(figure: Any) -> Pixels:
    figure.canvas.draw()
    return np.array(figure.canvas.buffer_rgba())[..., :3]
