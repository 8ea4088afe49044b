"""What notebooks show: a small picture beside a small table. Nothing runs behind it."""

import base64
import io
from collections.abc import Mapping
from html import escape
from typing import Any

from sinuous.motion.motion import Motion
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.words import duration

AREA, DPI = 3.2, 90.0
"""Longer side of the picture, in inches, and its pixels in one."""

FRAME = "display:flex;flex-wrap:wrap;gap:1.2em;align-items:center"
CELL = "text-align:left;padding:1px 10px 1px 0;vertical-align:top"


def html(noun: Solution | Motion | Robot | Scene) -> str:
    """Return HTML with a picture (where Matplotlib is installed) and a table."""
    rows = "".join(
        f'<tr><th style="{CELL};font-weight:600">{escape(key)}</th><td style="{CELL}">{escape(value)}</td></tr>'
        for key, value in _rows(noun).items()
    )
    caption = f'<div style="font-weight:700;margin-bottom:.3em">{escape(_caption(noun))}</div>'
    table = f'<div>{caption}<table style="border-collapse:collapse">{rows}</table></div>'
    return f'<div style="{FRAME}">{_picture(noun)}{table}</div>'


def _picture(noun: Any) -> str:
    try:
        import matplotlib as _  # noqa: F401, PLC0415
    except ImportError:
        return ""
    from sinuous.pictures.contents import gather  # noqa: PLC0415
    from sinuous.pictures.plot import draw_contents, new_axes, new_figure, room_of, sizes  # noqa: PLC0415
    from sinuous.pictures.shapes.stage import best_view, fill, stage_of  # noqa: PLC0415

    if isinstance(noun, Scene) and not len(noun):
        return ""
    contents = gather([noun])
    stage, view = stage_of(contents), best_view(contents)
    figure = new_figure(**sizes(stage, view, AREA) | {"dpi": DPI})
    axes = new_axes(figure)
    draw_contents(axes, contents, stage, view)
    fill(axes, stage, room_of(figure, head=0.0))
    file = io.BytesIO()
    figure.savefig(file, format="png")
    text = base64.b64encode(file.getvalue()).decode()
    return f'<img alt="{escape(_caption(noun))}" src="data:image/png;base64,{text}">'


def _caption(noun: Any) -> str:
    if isinstance(noun, Solution | Motion):
        return f"{type(noun).__name__}: {noun.status}"
    return f"Robot {noun.name}" if isinstance(noun, Robot) and noun.name else type(noun).__name__


def _rows(noun: Any) -> Mapping[str, str]:
    if isinstance(noun, Solution):
        return _of_solution(noun)
    if isinstance(noun, Motion):
        return _of_motion(noun)
    return _of_robot(noun) if isinstance(noun, Robot) else _of_scene(noun)


def _of_solution(solution: Solution) -> dict[str, str]:
    numbers = {
        "position error": solution.position_error,
        "angle error": solution.angle_error,
        "clearance": solution.clearance,
        "self-clearance": solution.self_clearance,
    }
    rows = {} if solution.solved else {"because": solution.sentence}
    if solution.worst is not None:
        rows["worst"] = str(solution.worst)
    rows |= {key: f"{value:.3g}" for key, value in numbers.items() if value is not None}
    starts = "1 start" if solution.starts == 1 else f"{solution.starts} starts"
    rows["effort"] = f"{solution.iterations} iterations, {starts}, {duration(solution.seconds)}"
    return rows


def _of_motion(motion: Motion) -> dict[str, str]:
    rows = {}
    if motion.solutions:
        solved = sum(solution.solved for solution in motion.solutions)
        rows["waypoints"] = f"{solved} of {len(motion.solutions) + motion.remaining} solved"
    if motion.worst is not None:
        rows["worst"] = str(motion.worst)
    if len(motion.q) > 1:
        rows["between"] = f"{motion.between} clear" if motion.between == "proved" else motion.between
        rows["time"] = f"{motion.times[0]:.4g} to {motion.times[-1]:.4g}, {len(motion.q)} knots"
    if motion.clearance is not None:
        rows["clearance"] = f"{motion.clearance:.3g}"
    bend, length = motion.largest_step
    rows["largest step"] = f"{bend:.3g} rad, {length:.3g} of length"
    rows["effort"] = duration(motion.seconds)
    return rows


def _of_robot(robot: Robot) -> dict[str, str]:
    low, high = (sum(segment.length[i] for segment in robot.segments) for i in (0, 1))
    thin, thick = min(robot.radii), max(robot.radii)
    rows = {
        "segments": str(len(robot)),
        "length": f"{low:g}" if low == high else f"{low:g} to {high:g}",
        "radius": f"{thin:g}" if thin == thick else f"{thin:g} to {thick:g}",
    }
    if robot.actuators:
        rows["actuators"] = str(len(robot.actuators))
    return rows


def _of_scene(scene: Scene) -> dict[str, str]:
    kinds: dict[str, int] = {}
    for obstacle in scene.obstacles:
        kinds[obstacle.kind.replace("_", " ")] = kinds.get(obstacle.kind.replace("_", " "), 0) + 1
    return {"obstacles": str(len(scene)), **{kind: str(count) for kind, count in kinds.items()}}
