"""Pictures of answers with Matplotlib: robot, scene and targets, and for a track the time of every waypoint.

Figures are made and saved by themselves; neither pyplot nor the backend that a caller has chosen is touched.
"""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.motion.motion import Motion
from sinuous.pictures.dots import Dotted, dots
from sinuous.pictures.surfaces import body, edges, normals, obstacle_surface
from sinuous.problem.target import Target
from sinuous.scene.obstacles import Primitive
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.solution import Solution

SEGMENTS = ("#1f6f8b", "#e0a458")
"""Colours of the segments, in turn."""
OBSTACLE, OUTLINE, DOTS, TOOL = "#8a8f98", "#9aa3ad", "#8a8f98", "#555b63"
TARGET, FAILED, GHOST, ROUTE, OTHER = "#c8384a", "#c8384a", "#1f6f8b", "#3c9d5d", "#7a5c99"
X, Y, Z = "#c8384a", "#3c9d5d", "#3a6ec2"
SEE_THROUGH = 0.4
ELEVATION = 18.0
GHOSTS = 12
"""Shapes of a track that are drawn as lines, beside the last one."""


def check_picture(key: str, file: Path) -> None:
    """Refuse a picture that cannot be drawn, before anything is solved.

    Raises
    ------
    InputError
        When Matplotlib is missing, or does not know the kind of file.
    """
    try:
        from matplotlib.backend_bases import FigureCanvasBase  # noqa: PLC0415
    except ImportError:
        raise InputError(key, "needs Matplotlib", str(file), "it installed: pip install sinuous[plot]") from None
    kinds = sorted(FigureCanvasBase.filetypes)
    if file.suffix.lower().lstrip(".") not in kinds:
        raise InputError(key, "", str(file), "a name that ends in ." + ", .".join(kinds))


def plot_solution(answer: Solution | Motion, file: str | Path, others: Sequence[Solution] = ()) -> None:
    """Draw an answer into a file.

    Parameters
    ----------
    answer : Solution or Motion
        Of a motion the last shape is drawn whole, some others as lines, and beside them the time of every waypoint.
        Where a route led to the last shape it is a dashed line.
    file : path
        Its ending says which kind of picture.
    others : sequence of Solution
        Of the same problem; they are drawn as lines.

    Raises
    ------
    InputError
        When Matplotlib is missing, or does not know the kind of file.
    OSError
        When the file cannot be written.
    """
    check_picture("file", Path(file))
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    solutions = answer.solutions if isinstance(answer, Motion) else (answer,)
    two = len(solutions) > 1
    figure = Figure(figsize=(12.0, 6.4) if two else (7.2, 6.8), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(1, 2, width_ratios=(1.7, 1.0)) if two else figure.add_gridspec(1, 1)
    draw_shape(figure.add_subplot(grid[0, 0], projection="3d", computed_zorder=False), solutions, others)
    if two:
        _draw_times(figure.add_subplot(grid[0, 1]), solutions)
    figure.savefig(file, bbox_inches="tight", pad_inches=0.15)


def draw_shape(axes: Any, solutions: tuple[Solution, ...], others: Sequence[Solution] = ()) -> None:
    """Draw the last of `solutions`, its scene and all targets, and `others`, which answer the same, as lines.

    `axes` are 3D ones with `computed_zorder=False`.
    """
    last = solutions[-1]
    robot, scene = last.problem.robot, last.problem.scene
    targets = [target for solution in solutions for target in solution.problem.targets]
    places = np.stack([target.position for target in targets if target.position is not None] or [robot.base[:3, 3]])
    low, high = _bounds(np.concatenate([*(robot.backbone(s.q) for s in (*solutions, *others)), places]), scene)
    span = float((high - low).max())
    azimuth = set_view(axes, low, high, robot.backbone(last.q)[-1] - robot.base[:3, 3])
    _draw_surfaces(axes, last, 0.5 * (low + high), span, azimuth)
    axes.plot(*np.stack([robot.forward(last.q)[-1, :3, 3], robot.tip(last.q)[:3, 3]]).T, color=TOOL, zorder=4)
    _draw_ghosts(axes, solutions)
    for other in others:
        axes.plot(*robot.backbone(other.q).T, color=OTHER, linewidth=1.4, zorder=3)
    if last.route is not None:
        axes.plot(*last.route.T, color=ROUTE, linewidth=0.9, linestyle="--", zorder=5)
    if len(solutions) > 1:
        axes.plot(*places.T, color=TARGET, linewidth=1.6, zorder=5)
    else:
        for target in targets:
            _draw_target(axes, target, last, 0.14 * span)
    axes.set_title(_title(solutions), fontsize=11, color="#333333")


def _bounds(points: Floats, scene: Snapshot) -> tuple[Floats, Floats]:
    """Corners of what the picture shows: all `points`, and of the obstacles what is not far from them."""
    low, high = points.min(axis=0), points.max(axis=0)
    reach = 0.35 * float((high - low).max())
    for obstacle in scene.obstacles:
        if isinstance(obstacle, Dotted):
            corners = dots(obstacle)
        else:
            corners = obstacle_surface(obstacle, 0.5 * (low + high), 0.0).reshape(-1, 3)
        if not len(corners):
            continue
        low = np.minimum(low, np.maximum(corners.min(axis=0), points.min(axis=0) - reach))
        high = np.maximum(high, np.minimum(corners.max(axis=0), points.max(axis=0) + reach))
    return low, high


def _draw_surfaces(axes: Any, solution: Solution, center: Floats, span: float, azimuth: float) -> None:
    """Draw body and obstacles in one collection, so that their facets are sorted together by distance."""
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # noqa: PLC0415

    parts = []
    for k, surface in enumerate(body(solution.problem.robot, solution.q, 0.008 * span)):
        parts.append(_shaded(surface, SEGMENTS[k % 2], 1.0, azimuth))
    for obstacle in solution.problem.scene.obstacles:
        if isinstance(obstacle, Dotted):
            axes.scatter(*dots(obstacle).T, color=DOTS, s=1.5, linewidths=0.0, depthshade=False, zorder=1)
        elif isinstance(obstacle, Primitive) and getattr(obstacle, "inside", False):
            axes.add_collection3d(Line3DCollection(edges(obstacle), colors=OUTLINE, linewidths=0.8, zorder=1))
        else:
            parts.append(_shaded(obstacle_surface(obstacle, center, span), OBSTACLE, SEE_THROUGH, azimuth))
    facets, colours = (np.concatenate(list(arrays)) for arrays in zip(*parts, strict=True))
    seams = colours.copy()
    seams[seams[:, 3] < 1.0, 3] = 0.0  # two layers of a see-through colour would show every seam
    drawn = Poly3DCollection(facets, facecolors=colours, edgecolors=seams, linewidths=0.25, zorder=2)
    axes.add_collection3d(drawn)


def _shaded(surface: Floats, colour: str, opacity: float, azimuth: float) -> tuple[Floats, Floats]:
    """Facets (k, 4, 3) that face the viewer, and colours (k, 4) under a light from above the viewer's left shoulder."""
    from matplotlib.colors import to_rgb  # noqa: PLC0415

    facing = normals(surface)
    seen = facing @ _direction(azimuth, ELEVATION) > -0.05
    light = 0.5 + 0.5 * facing[seen] @ _direction(azimuth - 40.0, 50.0)
    base = np.array(to_rgb(colour))
    shades = base * (0.45 + 0.55 * light[:, None]) + 0.25 * (1.0 - base) * light[:, None] ** 4
    return surface[seen], np.concatenate([shades, np.full((len(shades), 1), opacity)], axis=-1)


def _direction(azimuth: float, elevation: float) -> Floats:
    """Return the unit vector towards a viewer, angles in degrees."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def _draw_ghosts(axes: Any, solutions: tuple[Solution, ...]) -> None:
    """Draw shapes on the way as lines, later ones darker."""
    chosen = np.unique(np.linspace(0, len(solutions) - 1, GHOSTS + 1).astype(int))[:-1]
    for i in chosen.tolist():
        points = solutions[i].problem.robot.backbone(solutions[i].q)
        axes.plot(*points.T, color=GHOST, alpha=0.15 + 0.35 * i / len(solutions), linewidth=1.2, zorder=3)


def _draw_target(axes: Any, target: Target, solution: Solution, size: float) -> None:
    """Draw a point, and an arrow where a direction is asked, three where a whole rotation is."""
    robot = solution.problem.robot
    end = robot.tip(solution.q) if target.segment is None else robot.forward(solution.q)[target.segment - 1]
    place = end[:3, 3] if target.position is None else target.position
    axes.scatter(*place, color=TARGET, s=28, depthshade=False, zorder=6)
    arrows = [] if target.direction is None else [(target.direction, TARGET)]
    if target.rotation is not None:
        arrows = list(zip(target.rotation.T, (X, Y, Z), strict=True))
    for arrow, colour in arrows:
        axes.quiver(*place, *(size * arrow), color=colour, linewidth=2.0, arrow_length_ratio=0.25, zorder=6)


def _title(solutions: tuple[Solution, ...]) -> str:
    solved = sum(solution.solved for solution in solutions)
    if len(solutions) > 1:
        return f"{solved} of {len(solutions)} waypoints solved"
    (solution,) = solutions
    clear = "" if solution.clearance is None else f", clearance at least {solution.clearance:.3g}"
    return f"{solution.status}{clear}, {1e6 * solution.seconds:.0f} µs"


def set_view(axes: Any, low: Floats, high: Floats, reach: Floats) -> float:
    """Look across the plane that the robot reaches out in, from a little above, at equal scales; return the azimuth."""
    room = 0.04 * float((high - low).max())
    for set_limits, a, b in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), low - room, high + room, strict=True):
        set_limits(a, b)
    axes.set_box_aspect(high - low + 2.0 * room, zoom=0.95)
    azimuth = math.degrees(math.atan2(reach[1], reach[0])) - 65.0
    axes.view_init(elev=ELEVATION, azim=azimuth)
    for axis, label in ((axes.xaxis, "x"), (axes.yaxis, "y"), (axes.zaxis, "z")):
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.line.set_color("#b0b6bd")
        axis._axinfo["grid"].update(color="#e6e9ec", linewidth=0.6)
        axis.set_major_locator(_few_ticks())
        axis.set_label_text(label, color="#666666")
        axis.set_tick_params(labelsize=7, labelcolor="#666666", color="#b0b6bd")
    return azimuth


def _few_ticks() -> Any:
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    return MaxNLocator(5)


def _draw_times(axes: Any, solutions: tuple[Solution, ...]) -> None:
    from matplotlib.ticker import LogLocator, NullFormatter  # noqa: PLC0415

    times = 1e3 * np.array([solution.seconds for solution in solutions])
    solved = np.array([solution.solved for solution in solutions])
    number = np.arange(1, len(solutions) + 1)
    axes.plot(number[solved], times[solved], "o", color=SEGMENTS[0], markersize=3.2, label="solved")
    if not solved.all():
        axes.plot(number[~solved], times[~solved], "x", color=FAILED, markersize=5, label="not solved")
        axes.legend(frameon=False)
    axes.axhline(float(np.median(times)), color=SEGMENTS[1], linewidth=1.2, zorder=0)
    axes.set(xlabel="waypoint", yscale="log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_title(f"time per waypoint, ms (median {np.median(times):.3g})", fontsize=11, color="#333333")
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(visible=True, color="#e6e9ec", linewidth=0.6)
    axes.set_axisbelow(True)
