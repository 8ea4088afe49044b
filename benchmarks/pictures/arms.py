"""Arms as lines in space: what several methods made of one target, or of one waypoint among obstacles."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.pictures.style import INK, style
from benchmarks.problems import ProblemSet
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.problem.target import Target
from sinuous.view.display.bounds import Bounds, best_view
from sinuous.view.display.contents import Arm, Contents, MovingArm
from sinuous.view.display.style import TARGET, Viewpoint
from sinuous.view.pictures.plot import draw_contents
from sinuous.view.pictures.space import axes_box, set_bounds

ALONG = 24
"""Points of a line, a segment."""

VIEW = Viewpoint(18.0, -60.0)


def draw_arms(axes: Any, robot: Robot, arms: dict[str, Floats], target: Target, title: str) -> None:
    """Draw the backbones of configurations (n, 3), one a method, with the ends of their segments, and the target."""
    place = np.asarray(target.position)
    lines = {label: robot.backbone(q, ALONG) for label, q in arms.items()}
    low, high = _roomy(np.concatenate([*lines.values(), place[None], robot.base[None, :3, 3]]))
    set_bounds(axes, Bounds(low, high), VIEW)
    _closer(axes, 1.15)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_ticklabels([])
        axis.set_label_text("")
    for label, line in lines.items():
        look = style(label)
        axes.plot(*line.T, color=look.color, linewidth=look.width, alpha=0.9, zorder=3)
        axes.plot(*line[ALONG::ALONG].T, look.marker, color=look.color, markersize=3.0, zorder=4)
    axes.scatter(*place, color=TARGET, s=26, depthshade=False, zorder=6)
    if target.direction is not None:
        arrow = 0.2 * float((high - low).max()) * target.direction
        axes.quiver(*place, *arrow, color=TARGET, linewidth=2.0, arrow_length_ratio=0.3, zorder=6)
    axes.set_title(title, fontsize=11, color=INK)


def _roomy(points: Floats) -> tuple[Floats, Floats]:
    """Corners of a box around points, no side of which is much shorter than the longest."""
    low, high = points.min(axis=0), points.max(axis=0)
    half = np.maximum(0.5 * (high - low), 0.3 * float((high - low).max()))
    return 0.5 * (low + high) - half, 0.5 * (low + high) + half


def _closer(axes: Any, zoom: float) -> None:
    """Fill the panel."""
    sides = [high - low for low, high in (axes.get_xlim(), axes.get_ylim(), axes.get_zlim())]
    axes.set_box_aspect(sides, zoom=zoom)


def draw_track(axes: Any, problems: ProblemSet, records: Sequence[dict[str, Any]], title: str) -> None:
    """Draw the motion that a method found through a scene: its last confirmed shape whole, some before as ghosts."""
    right = [i for i, record in enumerate(records) if record["right"]]
    q = np.array([records[i]["q"] for i in right])
    places = [place for i in right if (place := problems.targets[i].position) is not None]
    moving = MovingArm(Arm(problems.robot, q[0]), q, np.arange(len(right), dtype=np.float64))
    contents = Contents(moving=[moving], obstacles=list(problems.scene.obstacles), paths=[np.stack(places)])
    draw_contents(axes, contents, axes_box(contents), best_view(contents))
    _closer(axes, 1.2)
    axes.set_title(title, fontsize=11, color=INK)
