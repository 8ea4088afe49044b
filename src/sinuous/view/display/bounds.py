"""Which part of the world is shown, from where, and what hides a body from there."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.scene.obstacles import HalfSpace, Obstacle, Primitive, Sphere
from sinuous.view.display.contents import Contents
from sinuous.view.display.style import ARROW_SHARE, Viewpoint, arrows_of
from sinuous.view.display.surfaces import Dotted, points_of

HIDING_SHARE = 0.03
"""Share of a body from which on an obstacle hides it."""


def find_hidden(obstacles: Sequence[Obstacle], points: Floats, eyes: Floats) -> NDArray[np.bool_]:
    """Which obstacles stand between points (m, 3) and eyes (e, 3): truth values (k, e, m).

    What a body must stay inside of never does: pages draw its far side alone. Obstacles stand still.
    """
    found = np.zeros((len(obstacles), len(eyes), len(points)), np.bool_)
    for own, obstacle in zip(found, obstacles, strict=True):
        if not obstacle.inside:
            own[...] = _between(obstacle, points, eyes)
    return found


def find_hiding(obstacles: Sequence[Obstacle], points: Floats, eyes: Floats) -> frozenset[int]:
    """Indices of the obstacles that hide more than a small part of the points (m, 3) from one of the eyes (e, 3)."""
    if not (len(points) and len(eyes)):
        return frozenset()
    shares = find_hidden(obstacles, points, eyes).mean(axis=-1).max(axis=-1)
    return frozenset(np.flatnonzero(shares > HIDING_SHARE).tolist())


def _between(obstacle: Obstacle, points: Floats, eyes: Floats) -> NDArray[np.bool_]:
    """Whether an obstacle meets the lines (e, m) from points to eyes."""
    if isinstance(obstacle, HalfSpace):
        behind = (eyes - obstacle.point) @ obstacle.normal < 0.0
        return np.repeat(behind[:, None], len(points), axis=1)
    center, rotation, half = _turned_box(obstacle)
    begin = (points - center) @ rotation / half
    along = (eyes[:, None] - points) @ rotation / half
    if isinstance(obstacle, Sphere):
        near = np.clip(-(along * begin).sum(axis=-1) / (along**2).sum(axis=-1), 0.0, 1.0)
        return ((begin + near[..., None] * along) ** 2).sum(axis=-1) < 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        sides = np.stack([(-1.0 - begin) / along, (1.0 - begin) / along])
    enters, leaves = sides.min(axis=0).max(axis=-1), sides.max(axis=0).min(axis=-1)
    return np.maximum(enters, 0.0) < np.minimum(leaves, 1.0)


def _turned_box(obstacle: Obstacle) -> tuple[Floats, Floats, Floats]:
    """Center, axes and half extents of the box around an obstacle."""
    if isinstance(obstacle, Primitive):
        center, rotation, half, rounding = obstacle.frame
        half = half + rounding
    else:
        ends = obstacle._box
        if ends is None:  # an empty grid
            return np.full(3, np.inf), np.eye(3), np.ones(3)
        center, rotation, half = ends.mean(axis=0), np.eye(3), 0.5 * np.ptp(ends, axis=0)
    return center, rotation, np.maximum(half, 1e-9 * (1.0 + np.abs(center).max()))


REACH_SHARE = 0.25
"""How far beyond robots and targets obstacles are shown, as a share of the extent of these."""

PLACES_PER_WAY = 12
"""Places of a robot on its way that must be seen."""

FOOT_RADII = 1.6
"""How far behind its base a robot reaches, with the plate that it stands on, in radii of its first segment."""


TURNS = (0.0, -25.0, 25.0, -50.0, 50.0, -80.0, 80.0, -115.0, 115.0, -150.0, 150.0, 180.0)
ELEVATIONS = (20.0, 40.0, 65.0)
"""Views that are tried: how far they are turned about z from the best one where nothing hides the robot, and how far
above the xy plane they are, in degrees."""

TURNING_COST = 0.3
"""Share of the robot that may be hidden before a view is turned by 180 degrees; by less for smaller turns."""

VIEWER_SPANS = 2.0
"""How far away the viewer is, in spans of what is shown."""

PLACES_PER_ROBOT = 72
"""Places along a robot that a viewer looks for."""


class Bounds(NamedTuple):
    """A box along the axes of the world.

    Attributes
    ----------
    low, high : ndarray (3,)
        Opposite corners.
    """

    low: Floats
    high: Floats

    @property
    def middle(self) -> Floats:
        """The middle of the box."""
        return 0.5 * (self.low + self.high)

    @property
    def span(self) -> float:
        """The longest side of the box."""
        return max(float((self.high - self.low).max()), 1e-12)

    def joined(self, low: Floats, high: Floats) -> "Bounds":
        """Return the box around this one and another."""
        return Bounds(np.minimum(self.low, low), np.maximum(self.high, high))


def bounds_of(contents: Contents) -> Bounds:
    """Return the box around robots, targets and paths, and what of the obstacles is not far from them."""
    points = _places(contents)
    boxes = [box for obstacle in contents.obstacles if (box := _box(obstacle)) is not None]
    if not len(points):
        points = np.concatenate(boxes) if boxes else np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    arrow = ARROW_SHARE * float(np.ptp(points, axis=0).max())
    ends = [place + arrow * axis for target, place in contents.targets for axis, _ in arrows_of(target)]
    points = np.concatenate([points, np.array(ends).reshape(-1, 3)])
    bounds = Bounds(points.min(axis=0), points.max(axis=0))
    reach = REACH_SHARE * max(float((bounds.high - bounds.low).max()), 1e-9)
    return _with_obstacles(bounds, reach, [*boxes, *_feet(contents.obstacles, bounds, reach)])


def _with_obstacles(bounds: Bounds, reach: float, boxes: Sequence[Floats]) -> Bounds:
    """Extend the bounds by the parts of boxes (2, 3) that are within `reach` of them; a small box is taken whole."""
    least, most = bounds.low - reach, bounds.high + reach
    for box in boxes:
        if np.ptp(box, axis=0).max() < 2.0 * reach:
            near = bool(((box.mean(axis=0) > least) & (box.mean(axis=0) < most)).all())
            part = box
        else:
            near = bool((box[0] < most).all() and (box[1] > least).all())
            part = np.clip(box, least, most)
        bounds = bounds.joined(part[0], part[1]) if near else bounds
    return bounds


def _box(obstacle: Obstacle) -> Floats | None:
    if isinstance(obstacle, Dotted):
        points = points_of(obstacle)
        return np.stack([points.min(axis=0), points.max(axis=0)]) if len(points) else None
    return obstacle._box


def _feet(obstacles: Sequence[Obstacle], bounds: Bounds, reach: float) -> list[Floats]:
    """Boxes (2, 3) around the middle of the bounds and the nearest place of every half-space not far from them."""
    boxes, half = [], 0.5 * (bounds.high - bounds.low)
    for obstacle in obstacles:
        if isinstance(obstacle, HalfSpace):
            away = (bounds.middle - obstacle.point) @ obstacle.normal
            foot = bounds.middle - away * obstacle.normal
            if abs(away) - float(half @ np.abs(obstacle.normal)) < reach:
                boxes.append(np.stack([np.minimum(foot, bounds.middle), np.maximum(foot, bounds.middle)]))
    return boxes


def _places(contents: Contents) -> Floats:
    """Points (m, 3) that must be seen: whole bodies with their bases, targets, paths."""
    found: list[Floats] = [place[None] for _, place in contents.targets]
    found += contents.paths + contents.forces_at(0.0) + contents.forces_at(1.0)
    for arm in contents.arms_at(*np.linspace(0.0, 1.0, PLACES_PER_WAY).tolist()):
        robot, q = arm.robot, arm.q
        points, radius = robot.backbone(q), max(robot.radii)
        behind = robot.base[:3, 3] - FOOT_RADII * robot.radii[0] * robot.base[:3, 2]
        found += [points - radius, points + radius, robot.tip(q)[None, :3, 3], behind[None]]
    return np.concatenate(found) if found else np.empty((0, 3))


def best_view(contents: Contents) -> Viewpoint:
    """Look across the plane that the first robot reaches out in, from a little above, or from where less hides it."""
    arm = next(contents.bodies, None)
    if arm is None:
        return Viewpoint()
    points = arm.robot.backbone(arm.q) - arm.robot.base[:3, 3]
    reach = points[np.hypot(points[:, 0], points[:, 1]).argmax()]
    azimuth = -60.0
    if math.hypot(reach[0], reach[1]) > 1e-6 * max(1e-300, float(np.abs(points).max())):
        azimuth = math.degrees(math.atan2(reach[1], reach[0])) - 65.0
    obstacles, bounds = contents.obstacles_at(1.0), bounds_of(contents)
    views = [Viewpoint(e, azimuth + turn) for turn in TURNS for e in ELEVATIONS]
    eyes = bounds.middle + VIEWER_SPANS * bounds.span * np.stack([direction_of(view) for view in views])
    lost = find_hidden(obstacles, seen_places(contents), eyes).any(axis=0).mean(axis=-1)
    effort = [abs(turn) / 180.0 + (e - ELEVATIONS[0]) / 90.0 for turn in TURNS for e in ELEVATIONS]
    return views[int((lost + TURNING_COST * np.array(effort)).argmin())]


def seen_places(contents: Contents) -> Floats:
    """Places (m, 3) that a viewer looks for: along the robots, also on their way."""
    bodies = [arm for arm in contents.arms_at(0.0, 0.5, 1.0) if not arm.ghost]
    found = [arm.robot.backbone(arm.q, max(1, PLACES_PER_ROBOT // len(arm.robot))) for arm in bodies]
    return np.concatenate(found) if found else np.empty((0, 3))


def direction_of(view: Viewpoint) -> Floats:
    """Return the unit vector (3,) towards the viewer."""
    e, a = math.radians(view.elevation), math.radians(view.azimuth)
    return np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
