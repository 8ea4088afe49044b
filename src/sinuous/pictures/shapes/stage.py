"""What is seen of a scene: the box that a picture shows, and where it is looked at from."""

import math
from typing import Any, NamedTuple

import numpy as np

from sinuous.checks import Floats
from sinuous.pictures.contents import Contents
from sinuous.pictures.shapes.dots import Dotted, dots
from sinuous.pictures.style import View
from sinuous.scene.extents import box_of
from sinuous.scene.obstacles import HalfSpace

REACH = 0.25
"""How far beyond robots and targets obstacles are shown, as a share of their extent."""

ROOM = 0.03
"""Between what is shown and the sides of the box, as a share of its longest side."""

ARROW = 0.13
"""Length of arrows, as a share of what is shown."""

SLENDER = 0.3
"""Least side of the box, as a share of its longest."""

NUMBERS = 4
"""Along the longest side of the box."""

ROUNDS = 3
"""How often the size of the box is corrected; numbers and names keep theirs."""

SAMPLES = 12
"""Places of a robot on its way that count for what is shown."""


class Stage(NamedTuple):
    """The box (two corners) that a picture shows."""

    low: Floats
    high: Floats

    @property
    def middle(self) -> Floats:
        """Of the box."""
        return 0.5 * (self.low + self.high)

    @property
    def span(self) -> float:
        """The longest side of the box."""
        return float((self.high - self.low).max())

    def joined(self, low: Floats, high: Floats) -> "Stage":
        """Return the box around this one and another."""
        return Stage(np.minimum(self.low, low), np.maximum(self.high, high))


def stage_of(contents: Contents) -> Stage:
    """Return the box around robots, targets and paths, and what of the obstacles is not far from them."""
    points = _places(contents)
    boxes = [box for obstacle in contents.obstacles if (box := _extent(obstacle)) is not None]
    if not len(points):
        points = np.concatenate(boxes) if boxes else np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    points = np.concatenate([points, _arrows(contents, ARROW * float(np.ptp(points, axis=0).max()))])
    low, high = points.min(axis=0), points.max(axis=0)
    reach = REACH * max(float((high - low).max()), 1e-9)
    least, most = low - reach, high + reach
    boxes += [feet for each in contents.obstacles if (feet := _feet(each, low, high, reach)) is not None]
    for box in boxes:
        middle = box.mean(axis=0)
        if np.ptp(box, axis=0).max() < 2.0 * reach:  # a small one that is near is seen whole
            inside = ((middle > least) & (middle < most)).all()
            low, high = (np.minimum(low, box[0]), np.maximum(high, box[1])) if inside else (low, high)
        else:
            low, high = np.minimum(low, np.maximum(box[0], least)), np.maximum(high, np.minimum(box[1], most))
    longest = max(float((high - low).max()), 1e-9)
    half = np.maximum(0.5 * (high - low), 0.5 * SLENDER * longest) + ROOM * longest
    return Stage(0.5 * (low + high) - half, 0.5 * (low + high) + half)


def _arrows(contents: Contents, size: float) -> Floats:
    """Ends (m, 3) of the arrows of this size that stand for orientations."""
    ends = []
    for target, end in contents.asked:
        axes = [] if target.direction is None else [target.direction]
        axes += [] if target.rotation is None else list(target.rotation.T)
        ends += [end[:3, 3] + size * axis for axis in axes]
    return np.array(ends).reshape(-1, 3)


def _extent(obstacle: Any) -> Floats | None:
    if isinstance(obstacle, Dotted):
        points = dots(obstacle)
        return np.stack([points.min(axis=0), points.max(axis=0)]) if len(points) else None
    return box_of(obstacle)


def _feet(obstacle: Any, low: Floats, high: Floats, reach: float) -> Floats | None:
    """Corners (2, 3) of the box around the middle of another and the nearest place of a half-space not far from it."""
    if not isinstance(obstacle, HalfSpace):
        return None
    middle = 0.5 * (low + high)
    away = (middle - obstacle.point) @ obstacle.normal
    beyond = abs(away) - float(np.abs(0.5 * (high - low)) @ np.abs(obstacle.normal))
    foot = middle - away * obstacle.normal
    return np.stack([np.minimum(foot, middle), np.maximum(foot, middle)]) if beyond < reach else None


def _places(contents: Contents) -> Floats:
    """Points (m, 3) that must be seen: whole bodies with their bases, targets, paths."""
    found: list[Floats] = [asked.end[None, :3, 3] for asked in contents.asked]
    found += contents.paths
    ways = [moving.at(share) for moving in contents.moving for share in np.linspace(0.0, 1.0, SAMPLES)]
    for arm in [*contents.arms, *ways]:
        points, radius = arm.robot.backbone(arm.q), max(arm.robot.radii)
        behind = arm.robot.base[:3, 3] - 1.6 * arm.robot.radii[0] * arm.robot.base[:3, 2]
        found += [points - radius, points + radius, arm.robot.tip(arm.q)[None, :3, 3], behind[None]]
    return np.concatenate(found) if found else np.empty((0, 3))


def best_view(contents: Contents) -> View:
    """Look across the plane that the first robot reaches out in, from a little above."""
    arms = contents.all_arms
    if not arms:
        return View()
    points = arms[0].robot.backbone(arms[0].q) - arms[0].robot.base[:3, 3]
    reach = points[np.hypot(points[:, 0], points[:, 1]).argmax()]
    if math.hypot(reach[0], reach[1]) < 1e-6 * max(1e-300, float(np.abs(points).max())):
        return View(20.0, -60.0)
    return View(20.0, math.degrees(math.atan2(reach[1], reach[0])) - 65.0)


def towards(view: View) -> Floats:
    """Return the unit vector towards the viewer."""
    e, a = math.radians(view.elevation), math.radians(view.azimuth)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])


def screen(view: View) -> Floats:
    """Return the unit vectors (2, 3) to the right and upwards on the screen."""
    a = math.radians(view.azimuth)
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return np.stack([right, np.cross(towards(view), right)])


def extent(stage: Stage, view: View) -> Floats:
    """Width and height (2,) of the box on the screen, in the length unit."""
    size: Floats = np.abs(screen(view)) @ (stage.high - stage.low)
    return size


def set_stage(axes: Any, stage: Stage, view: View) -> None:
    """Show the box from there, at equal scales."""
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    limits = zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), stage.low, stage.high, strict=True)
    for set_limits, low, high in limits:
        set_limits(low, high)
    for axis, side in zip((axes.xaxis, axes.yaxis, axes.zaxis), stage.high - stage.low, strict=True):
        axis.set_major_locator(MaxNLocator(max(2, round(NUMBERS * side / stage.span)), steps=(1, 2, 2.5, 5, 10)))
    axes.set_proj_type("ortho")
    axes.view_init(elev=view.elevation, azim=view.azimuth)
    axes.set_box_aspect(stage.high - stage.low)


def fill(axes: Any, stage: Stage, frame: Floats | None = None) -> None:
    """Draw the box as large as there is room for it, its numbers and its names.

    `frame` (2, 2) are opposite corners of the room, in pixels, and the axes are moved to its middle; by default the
    room is that of the axes, which stay.
    """
    figure, zoom = axes.get_figure(root=True), 1.0
    for _ in range(ROUNDS):
        axes.set_box_aspect(stage.high - stage.low, zoom=zoom)
        low, high = _drawn(axes, stage)
        room = np.array([axes.bbox.p0, axes.bbox.p1]) if frame is None else frame
        zoom *= max(float(((room[1] - room[0]) / np.maximum(high - low, 1.0)).min()), 0.1)
        if frame is not None:
            shift = (room.mean(axis=0) - 0.5 * (low + high)) / [figure.bbox.width, figure.bbox.height]
            place = axes.get_position()
            axes.set_position([place.x0 + shift[0], place.y0 + shift[1], place.width, place.height])


def _drawn(axes: Any, stage: Stage) -> tuple[Floats, Floats]:
    """Opposite corners, in pixels, of the room that the box takes with its numbers and names."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform  # noqa: PLC0415

    axes.apply_aspect()
    axes.M = axes.get_proj()
    corners = np.array([[(stage.low, stage.high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
    x, y, _ = proj_transform(*corners.T, axes.M)
    points = [axes.transData.transform(np.stack([x, y], axis=-1))]
    renderer = axes.get_figure(root=True)._get_renderer()
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis) if axes._axis3don else ():
        box = axis.get_tightbbox(renderer)
        points.append(np.array([box.p0, box.p1]))
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)
