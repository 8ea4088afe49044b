"""Lines of points, whole: evenly spaced, how long, how far from the obstacles, and how much room is beside them."""

import math

from sinuous.kernels.compile import entry
from sinuous.kernels.fields.distances import Scene, closest, obstacle, read_scene
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.freespace.band import respace
from sinuous.kernels.maths.vectors import Array, Vec, across, add, add_scaled, dot, get_vec, norm, scale, sub

LINE_SIDES = 8
"""To how many sides of a line it is checked for room."""

SIDE_STEPS = 3
"""How far aside at most, in radii of the body."""

MOST_PIECES = 32
"""Into how many pieces a line is divided between two of its points, at most, each of a radius."""


@entry
def respace_line(line: Array, out: Array) -> None:
    """Fill `out` (M, 3), two points at least, with points that are evenly spaced along `line` (K, 3)."""
    respace(line, line.shape[0], out, out.shape[0])


@entry
def measure_line(line: Array, along: Array) -> None:
    """Fill `along` (K,) with the length of `line` (K, 3), one point at least, up to each of its points."""
    along[0] = 0.0
    for i in range(1, line.shape[0]):
        along[i] = along[i - 1] + norm(sub(get_vec(line, i, 0), get_vec(line, i - 1, 0)))


@entry
def distances_along(scene: Array, points: Array, reach: float, distances: Array) -> None:
    """Fill `distances` (K,) with those of `points` (K, 3) from the obstacles of the group `scene`, in the length unit.

    Beyond `reach` they may be anything that is not less.
    """
    obstacles = read_scene(scene)
    for i in range(points.shape[0]):
        distances[i], _ = closest(obstacles, get_vec(points, i, 0), reach, INTERPOLATED)


def _width_across(scene: Scene, place: Vec, ahead: Vec, radius: float, enough: float) -> float:
    """Most distance from the obstacles in the plane across a line; away from the nearest one it is checked first."""
    most, which = closest(scene, place, enough, INTERPOLATED)
    length = norm(ahead)
    if not 0.0 < most < enough or length == 0.0:
        return most
    x, y = across(scale(1.0 / length, ahead))
    _, away = obstacle(scene, which, place, math.inf)
    first, begun = math.atan2(dot(away, y), dot(away, x)), most
    for side in range(LINE_SIDES):
        angle = first + 2.0 * math.pi * side / LINE_SIDES
        way = add(scale(math.cos(angle), x), scale(math.sin(angle), y))
        for step in range(1, SIDE_STEPS + 1):
            d, _ = closest(scene, add_scaled(place, step * radius, way), enough, INTERPOLATED)
            if d <= begun:
                break
            most = max(most, d)
            if most >= enough:
                return most
    return most


@entry
def widths_across(scene: Array, line: Array, radius: float, enough: float, widths: Array) -> None:
    """Fill `widths` (K,) with the most distance from the obstacles across a `line` (K, 3), in the length unit.

    That is of places up to `SIDE_STEPS` radii aside. Along a wall it grows with every step, in a door it does not.
    Points that are farther apart than a radius have the least of what is nearer to them than to others: a wall between
    them is not stepped over. From `enough` on it may be anything that is not less; where the line overlaps an obstacle
    it is the distance of the place itself.
    """
    obstacles, last = read_scene(scene), line.shape[0] - 1
    for i in range(last + 1):
        place = get_vec(line, i, 0)
        ahead = sub(get_vec(line, min(i + 1, last), 0), get_vec(line, max(i - 1, 0), 0))
        widths[i] = _width_across(obstacles, place, ahead, radius, enough)
    for i in range(last):
        place = get_vec(line, i, 0)
        ahead = sub(get_vec(line, i + 1, 0), place)
        pieces = math.ceil(min(MOST_PIECES, norm(ahead) / radius)) if radius > 0.0 else 1
        for k in range(1, pieces):
            nearer = i if 2 * k <= pieces else i + 1
            between = _width_across(obstacles, add_scaled(place, k / pieces, ahead), ahead, radius, enough)
            widths[nearer] = min(widths[nearer], between)
