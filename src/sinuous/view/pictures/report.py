"""Answers as files of pictures: `--plot` of the command line."""

from pathlib import Path
from typing import Any

from sinuous.base.documents import written
from sinuous.motion.motion import Motion
from sinuous.view.display.bounds import best_view
from sinuous.view.display.contents import Contents, Things, gather
from sinuous.view.pictures.animate import animate
from sinuous.view.pictures.diagrams import Kind, diagram, diagrams_of
from sinuous.view.pictures.files import MOVIES, check_picture
from sinuous.view.pictures.plot import draw_in, still
from sinuous.view.pictures.space import axes_box, new_figure, room_of, sizes

SHOWN: tuple[Kind, ...] = ("times", "clearance", "actuators")
"""Diagrams beside a motion."""

DIAGRAM = (5.0, 2.7)
"""Size of each, in inches."""


def write_picture(path: str | Path, *things: Things) -> None:
    """Draw things into a file, from the side where a robot shows most; beside a motion stand its diagrams.

    Parameters
    ----------
    path : path
        Its ending says which kind of picture: `.png`, `.svg`, `.pdf` and what else Matplotlib knows, or `.gif` and
        `.mp4`, which move.
    *things
        As for `plot`.

    Raises
    ------
    InputError
        When something that is needed is missing, the kind is another, or the file cannot be written.
    """
    file = Path(path)
    check_picture("path", file)
    contents = gather(things)
    if file.suffix.lower().lstrip(".") in MOVIES:
        animate(*things, path=file, view=best_view(contents))
        return
    with written(file, "path"):
        (_with_diagrams(contents) if contents.moving else still(contents)).savefig(file)


def _with_diagrams(contents: Contents) -> Any:
    """Return a figure with the first motion at the left and its diagrams at the right."""
    box, view = axes_box(contents), best_view(contents)
    motion = next(answer for answer in contents.answers if isinstance(answer, Motion))
    shown = [kind for kind in SHOWN if kind in diagrams_of(motion)]
    width, height = sizes(box, view)["figsize"]
    height = max(height, DIAGRAM[1] * len(shown))
    figure = new_figure(figsize=(width + DIAGRAM[0], height), dpi=150)
    room = room_of(figure)
    room[1, 0] = width * figure.dpi
    draw_in(figure, contents, box, view, room)
    left, right = width + 0.75, width + DIAGRAM[0] - (1.0 if "actuators" in shown else 0.15)
    sides = {"left": left / figure.get_figwidth(), "right": right / figure.get_figwidth()}
    grid = figure.add_gridspec(len(shown), 1, top=1.0 - 0.4 / height, bottom=0.5 / height, hspace=0.55, **sides)
    for k, kind in enumerate(shown):
        diagram(motion, kind, ax=figure.add_subplot(grid[k, 0]))
    return figure
