"""What notebooks show, a small picture beside a small table; and what `--plot` writes. Nothing runs behind it."""

from collections import Counter
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.answer.explanation import Explanation
from sinuous.answer.solution import Solution
from sinuous.answer.solutions import Solutions
from sinuous.base.checks import written
from sinuous.base.errors import duration, listed, span
from sinuous.model.robot import Robot
from sinuous.motion.motion import Motion
from sinuous.motion.trajectory import Trajectory
from sinuous.scene.scene import Scene
from sinuous.studies.workspace.reach import Reach
from sinuous.view.display.bounds import best_view
from sinuous.view.display.contents import Contents, Things, gather
from sinuous.view.display.results import rows_of, status_in_words
from sinuous.view.pictures import figures
from sinuous.view.pictures.diagrams import Kind, diagram, diagrams_of
from sinuous.view.pictures.plot import animate, draw_in, draw_still
from sinuous.view.pictures.workspace import draw_map

INCHES, DPI = 3.2, 90.0
"""Longer side of the picture, in inches, and its pixels in one."""

MAP_DPI = 45.0
"""Pixels in an inch of a map, which is large."""

FRAME = "display:flex;flex-wrap:wrap;gap:1.2em;align-items:center"
CELL = "text-align:left;padding:1px 10px 1px 0;vertical-align:top"


Shown = Solution | Solutions | Motion | Trajectory | Robot | Scene | Explanation | Reach
"""What notebooks can show."""

MOST_DRAWN = 8
"""Solutions that are drawn together."""


def html(noun: Shown) -> str:
    """Return HTML with a picture (where Matplotlib is installed) and a table, or what it prints."""
    if isinstance(noun, Explanation | Reach):
        told = f'<pre style="margin:0">{escape(str(noun))}</pre>'
    else:
        rows = "".join(
            f'<tr><th style="{CELL};font-weight:600">{escape(key)}</th><td style="{CELL}">{escape(value)}</td></tr>'
            for key, value in _rows(noun).items()
        )
        caption = f'<div style="font-weight:700;margin-bottom:.3em">{escape(_caption(noun))}</div>'
        told = f'<div>{caption}<table style="border-collapse:collapse">{rows}</table></div>'
    return f'<div style="{FRAME}">{_picture(noun)}{told}</div>'


def _picture(noun: Any) -> str:
    try:
        import matplotlib as _  # noqa: F401, PLC0415
    except ImportError:
        return ""
    if isinstance(noun, Explanation) or (isinstance(noun, Scene | Solutions) and not len(noun)):
        return ""
    return figures.image_in_page(_figure(noun), _caption(noun), dpi=MAP_DPI if isinstance(noun, Reach) else DPI)


def _figure(noun: Any) -> Any:
    if isinstance(noun, Reach):
        return draw_map(noun)
    drawn = noun[:MOST_DRAWN] if isinstance(noun, Solutions) else noun
    return draw_still(gather([drawn]), INCHES, DPI, head=0.0)


def _caption(noun: Any) -> str:
    if isinstance(noun, Solution | Motion):
        return f"{type(noun).__name__}: {noun.status}"
    return f"Robot {noun.name}" if isinstance(noun, Robot) and noun.name else type(noun).__name__


def _rows(noun: Any) -> dict[str, str]:
    if isinstance(noun, Solution | Motion):
        return rows_of(noun)
    return next(rows for kind, rows in ROWS.items() if isinstance(noun, kind))(noun)


def _of_robot(robot: Robot) -> dict[str, str]:
    low, high = (sum(segment.length[i] for segment in robot.segments) for i in (0, 1))
    rows = {
        **({"joints": listed(robot.joint_names)} if robot.joints else {}),
        "segments": str(len(robot.segments)),
        "length": span((low, high)),
        "radius": span((min(robot.body_radii, default=0.0), max(robot.body_radii, default=0.0))),
    }
    return rows | ({"actuators": str(len(robot.actuators))} if robot.actuators else {})


def _of_scene(scene: Scene) -> dict[str, str]:
    kinds = Counter(obstacle.kind.replace("_", " ") for obstacle in scene.obstacles)
    return {"obstacles": str(len(scene)), **{kind: str(count) for kind, count in kinds.items()}}


def _of_solutions(many: Solutions) -> dict[str, str]:
    counts = Counter(status_in_words(status) for status in many.status.tolist())
    known = many.clearance[~np.isnan(many.clearance)]
    rows = {status: f"{count:,}" for status, count in counts.most_common()}
    rows |= {"least clearance": f"{known.min():.3g}, proved"} if len(known) else {}
    return rows | ({"time of each": f"{duration(float(np.median(many.seconds)))}, median"} if len(many) else {})


def _of_trajectory(timed: Trajectory) -> dict[str, str]:
    own = rows_of(timed.motion)
    return {"duration": f"{timed.duration:.4g} s", "phases": str(len(timed.times) - 1)} | {
        label: own[label] for label in ("between", "clearance") if label in own
    }


ROWS: dict[type, Callable[[Any], dict[str, str]]] = {
    Robot: _of_robot,
    Scene: _of_scene,
    Solutions: _of_solutions,
    Trajectory: _of_trajectory,
}
"""The table of each."""


SHOWN: tuple[Kind, ...] = ("times", "clearance", "actuators")
"""Diagrams beside a motion."""

DIAGRAM_INCHES = (5.0, 2.7)
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
    figures.check_picture("path", file)
    contents = gather(things)
    if file.suffix.lower().lstrip(".") in figures.MOVIES:
        animate(*things, path=file, view=best_view(contents))
        return
    with written(file, "path"):
        (_with_diagrams(contents) if contents.moving else draw_still(contents)).savefig(file)


def _with_diagrams(contents: Contents) -> Any:
    """Return a figure with the first motion at the left and its diagrams at the right."""
    box, view = figures.axes_box(contents), best_view(contents)
    motion = next(answer for answer in contents.answers if isinstance(answer, Motion))
    shown = [kind for kind in SHOWN if kind in diagrams_of(motion)]
    width, height = figures.figure_size(box, view)["figsize"]
    height = max(height, DIAGRAM_INCHES[1] * len(shown))
    figure = figures.new_figure(figsize=(width + DIAGRAM_INCHES[0], height), dpi=150)
    room = figures.room_of(figure)
    room[1, 0] = width * figure.dpi
    draw_in(figure, contents, box, view, room)
    left, right = width + 0.75, width + DIAGRAM_INCHES[0] - (1.0 if "actuators" in shown else 0.15)
    sides = {"left": left / figure.get_figwidth(), "right": right / figure.get_figwidth()}
    grid = figure.add_gridspec(len(shown), 1, top=1.0 - 0.4 / height, bottom=0.5 / height, hspace=0.55, **sides)
    for k, kind in enumerate(shown):
        diagram(motion, kind, ax=figure.add_subplot(grid[k, 0]))
    return figure
