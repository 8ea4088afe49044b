"""Capsules that contain the shapes of a link: as small as a search makes them, and never smaller than the shape.

A capsule is convex, so it contains a shape when it contains the corners of its convex hull. Of an axis and a radius the
shortest capsule follows directly; the volume is minimised over both (Nelder-Mead) from the principal axes on.
A long shape is cut across into pieces where several capsules are much smaller than one: what is inside a piece of a
solid is within the hull of the surface there.
"""

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.spatial import ConvexHull, QhullError

from sinuous.base.checks import Floats
from sinuous.model.joints import LinkCapsule
from sinuous.model.poses import least_rotation

MOST_PIECES = 3
"""Capsules of one shape."""

WORTH = 0.8
"""One capsule more is taken where the volume of all falls to this share."""

MOST_TRIALS = 300
"""Capsules that a search tries."""

DIRECTIONS = 200
"""Directions in which a search looks for the outermost of many points."""

THINNEST = 1e-6
"""Least radius of a capsule, relative to its size, where a shape has no thickness."""

SLACK = 1e-9
"""By how much, relative to its size, a capsule is thicker than rounding demands."""

FLAT = 1e-6
"""A shape whose volume is smaller than this share of that of its box has none."""


class Shape(NamedTuple):
    """A collision shape in the frame of its link.

    Attributes
    ----------
    capsules : tuple of LinkCapsule
        That contain it.
    volume : float
        Its own; that of its convex hull where it is a mesh.
    """

    capsules: tuple[LinkCapsule, ...]
    volume: float


def volume_of(capsules: Iterable[LinkCapsule]) -> float:
    """Sum of the volumes of capsules."""
    lengths = ((float(np.linalg.norm(end - start)), radius) for start, end, radius in capsules)
    return math.fsum(_volume(length, radius) for length, radius in lengths)


def sphere_shape(pose: Floats, radius: float) -> Shape:
    """A ball."""
    return Shape((LinkCapsule(pose[:3, 3], pose[:3, 3], radius),), _volume(0.0, radius))


def capsule_shape(pose: Floats, radius: float, length: float) -> Shape:
    """A capsule about z, without its balls of this length."""
    half = 0.5 * length * pose[:3, 2]
    return Shape((LinkCapsule(pose[:3, 3] - half, pose[:3, 3] + half, radius),), _volume(length, radius))


def cylinder_shape(pose: Floats, radius: float, length: float) -> Shape:
    """A cylinder about z: the capsule of which the ball at either end goes through its rim."""

    def size(high: float) -> float:  # the balls rise by so much above the rims
        return _volume(length - 2.0 * high, math.hypot(radius, high))

    highs = np.linspace(0.0, 0.5 * length, 101)
    best = float(min(highs.tolist(), key=size))
    capsule = capsule_shape(pose, math.hypot(radius, best) * (1.0 + SLACK), length - 2.0 * best)
    return Shape(capsule.capsules, math.pi * radius * radius * length)


def box_shape(pose: Floats, size: Floats) -> Shape:
    """A box with these extents (3,)."""
    corners = 0.5 * size * np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    return solid_shape(corners @ pose[:3, :3].T + pose[:3, 3], float(np.prod(size)))


def solid_shape(points: Floats, volume: float | None = None, edges: Floats | None = None) -> Shape:
    """All within the convex hull of points (m, 3); with the edges (e, 2, 3) of a closed surface all within that."""
    corners, hull_edges, own = _hull(points)
    pieces, best = [corners], _draft(corners).volume
    for axis in _principal_axes(corners):
        for count in range(2, MOST_PIECES + 1):
            several = _cut(*((corners, hull_edges) if edges is None else (points, edges)), axis, count)
            total = math.fsum(_draft(piece).volume for piece in several)
            if total < WORTH ** (count - len(pieces) if count > len(pieces) else 0) * best:
                pieces, best = several, total
    return Shape(tuple(map(_smallest, pieces)), own if volume is None else volume)


def _hull(points: Floats) -> tuple[Floats, Floats, float]:
    """Corners (m, 3) of the convex hull of points, its edges (e, 2, 3), and its volume; of what is flat all pairs."""
    extent = np.ptp(points, axis=0)
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):  # all in one plane, on one line, or too few
        corners = np.unique(points, axis=0)
        pairs = np.stack(np.triu_indices(len(corners), 1), axis=-1) if len(corners) < 64 else np.zeros((0, 2), int)
        return corners, corners[pairs], 0.0
    sides = np.concatenate([hull.simplices[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))])
    edges = points[np.unique(np.sort(sides, axis=1), axis=0)]
    volume = float(hull.volume) if hull.volume > FLAT * float(np.prod(extent)) else 0.0
    return points[hull.vertices], edges, volume


def _principal_axes(points: Floats) -> Floats:
    """Unit vectors (3, 3), rows, along which points spread from most to least."""
    away = points - points.mean(axis=0)
    axes: Floats = np.linalg.eigh(away.T @ away)[1].T
    return axes[np.argsort(-np.ptp(points @ axes.T, axis=0))]


def _cut(corners: Floats, edges: Floats, axis: Floats, count: int) -> list[Floats]:
    """Corners of pieces between planes across an axis, evenly spaced."""
    heights = corners @ axis
    levels = np.linspace(heights.min(), heights.max(), count + 1)
    begin, end = (edges[:, i] @ axis for i in (0, 1))
    rings = []
    for level in levels[1:-1]:
        crossed = (begin - level) * (end - level) < 0.0
        share = ((level - begin[crossed]) / (end[crossed] - begin[crossed]))[:, None]
        rings.append(edges[crossed, 0] + share * (edges[crossed, 1] - edges[crossed, 0]))
    rings = [np.zeros((0, 3)), *rings, np.zeros((0, 3))]
    pieces = []
    for i in range(count):
        inside = (heights >= levels[i]) & (heights <= levels[i + 1])
        pieces.append(np.concatenate([rings[i], corners[inside], rings[i + 1]]))
    return [piece for piece in pieces if len(piece)]


class _Draft(NamedTuple):
    """A capsule before the search: its volume, the frame of which it lies along z, and the parameters of `_around`."""

    volume: float
    frame: Floats
    parameters: Floats


def _draft(points: Floats) -> _Draft:
    """Return the smallest of some capsules along the principal axes."""
    drafts = []
    for axis in _principal_axes(points):
        frame = least_rotation(axis)
        local = points @ frame
        middle = 0.5 * (local.min(axis=0) + local.max(axis=0))
        for wider in (0.0, 0.05, 0.15, 0.4):
            parameters = np.array([0.0, 0.0, middle[0], middle[1], wider])
            drafts.append(_Draft(_volume(*_around(points, frame, parameters)[:2]), frame, parameters))
    return min(drafts, key=lambda each: each.volume)


def _smallest(points: Floats) -> LinkCapsule:
    """Return the smallest capsule found that contains points (m, 3)."""
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    size = float(np.linalg.norm(points - middle, axis=1).max()) or 1.0
    local = (points - middle) / size
    draft, outer = _draft(local), _outermost(local)

    def volume(parameters: Floats) -> float:
        return _volume(*_around(outer, draft.frame, parameters)[:2])

    options: Any = {"maxfev": MOST_TRIALS, "xatol": 1e-4, "fatol": 1e-5}
    found = minimize(volume, draft.parameters, method="Nelder-Mead", options=options)
    _, radius, begin, end = _around(local, draft.frame, found.x)
    return LinkCapsule(middle + size * begin, middle + size * end, size * max(radius, THINNEST) * (1.0 + SLACK))


def _outermost(points: Floats) -> Floats:
    """Of many points, those that are farthest in some direction: enough for the search, not for what it ends with."""
    if len(points) <= DIRECTIONS:
        return points
    heights = np.linspace(-1.0, 1.0, DIRECTIONS)
    turns = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(DIRECTIONS)  # a Fibonacci sphere
    aside = np.sqrt(1.0 - heights * heights)
    directions = np.stack([aside * np.cos(turns), aside * np.sin(turns), heights])
    return points[np.unique((points @ directions).argmax(axis=0))]


def _around(points: Floats, frame: Floats, parameters: Floats) -> tuple[float, float, Floats, Floats]:
    """Length, radius and both ends of the shortest capsule about an axis that contains points.

    `parameters` (5,): by how much the axis is turned from the z axis of the frame, where it goes through its xy plane,
    and by which share the radius is larger than needed.
    """
    turned = frame @ least_rotation(_unit(parameters[:2]))
    x, y, z = (points @ turned).T
    aside = np.hypot(x - parameters[2], y - parameters[3])
    radius = float(aside.max()) * (1.0 + abs(float(parameters[4])))
    rise = np.sqrt(np.maximum(radius * radius - aside * aside, 0.0))
    low, high = float((z + rise).min()), float((z - rise).max())
    if low > high:  # a ball, with room
        low = high = 0.5 * (low + high)
    ends = (turned @ np.array([parameters[2], parameters[3], height]) for height in (low, high))
    return high - low, radius, *ends


def _unit(tilt: Floats) -> Floats:
    vector = np.array([tilt[0], tilt[1], 1.0])
    unit: Floats = vector / np.linalg.norm(vector)
    return unit


def _volume(length: float, radius: float) -> float:
    """Volume of a capsule."""
    return math.pi * radius * radius * (length + 4.0 / 3.0 * radius)
