"""What notebooks show: a small picture beside a small table. Nothing runs behind it."""

import base64
import io
from collections import Counter
from html import escape
from typing import Any

from sinuous.display.captions import rows_of
from sinuous.display.contents import gather
from sinuous.motion.motion import Motion
from sinuous.pictures.plot import still
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solution.solution import Solution
from sinuous.words import span

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
    if isinstance(noun, Scene) and not len(noun):
        return ""
    figure = still(gather([noun]), AREA, DPI, head=0.0)
    file = io.BytesIO()
    figure.savefig(file, format="png")
    text = base64.b64encode(file.getvalue()).decode()
    return f'<img alt="{escape(_caption(noun))}" src="data:image/png;base64,{text}">'


def _caption(noun: Any) -> str:
    if isinstance(noun, Solution | Motion):
        return f"{type(noun).__name__}: {noun.status}"
    return f"Robot {noun.name}" if isinstance(noun, Robot) and noun.name else type(noun).__name__


def _rows(noun: Any) -> dict[str, str]:
    if isinstance(noun, Solution | Motion):
        return rows_of(noun)
    return _of_robot(noun) if isinstance(noun, Robot) else _of_scene(noun)


def _of_robot(robot: Robot) -> dict[str, str]:
    low, high = (sum(segment.length[i] for segment in robot.segments) for i in (0, 1))
    rows = {
        "segments": str(len(robot)),
        "length": span((low, high)),
        "radius": span((min(robot.radii), max(robot.radii))),
    }
    return rows | ({"actuators": str(len(robot.actuators))} if robot.actuators else {})


def _of_scene(scene: Scene) -> dict[str, str]:
    kinds = Counter(obstacle.kind.replace("_", " ") for obstacle in scene.obstacles)
    return {"obstacles": str(len(scene)), **{kind: str(count) for kind, count in kinds.items()}}
