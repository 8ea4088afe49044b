"""A route as a guide: how far along it a place of the body sees, and what length of backbone it needs from there."""

import math
from collections import namedtuple

from sinuous.kernels.body.chords import nearest_share
from sinuous.kernels.chain.single_arc import arc_length
from sinuous.kernels.fields.distances import Scene, evaluate, is_large
from sinuous.kernels.fields.hierarchy import crossed_leaf, item_of, tree_over
from sinuous.kernels.fields.solids import INTERPOLATED
from sinuous.kernels.maths.vectors import Vec, add_scaled, dot, get_vec, norm, scale, sub
from sinuous.kernels.tables import CENTER, EXTENT, HIERARCHY_HEADER, KIND, TREE

SIGHT_CLEARANCE, SIGHT_STEP = 0.3, 0.3
"""A line of sight keeps so far from the obstacles, and is examined no more closely; in radii of the body."""

FIRST_REACH, FARTHEST_REACH = 4.0, 16.0
"""How far a first evaluation reaches, and any; the next one reaches twice as far where nothing was in reach. In
radii."""

SIGHT_EVALUATIONS = 24
"""Most evaluations along one line of sight."""

WIDEST_SIGHT = 2.2
"""Angle between tangent and line of sight from which on a single arc is no measure of what is needed, rad."""

TURN_LENGTH = 0.5
"""Length that it takes to turn into the guide, in radii of the tightest turn for each radian."""

Guide = namedtuple("Guide", ["points", "spacing", "back", "radius", "turn"])
"""Points (K, 3) of a route, evenly spaced, and the distance between neighbours; the unit vector to where it comes from
at its end (zero: from anywhere); the radius of the body and of its tightest turn."""


def is_route(guide: Guide) -> bool:
    """Whether it is a route: two points are only where one begins and ends."""
    return guide.points.shape[0] > 2


def _passes_ball(scene: Scene, j: int, p: Vec, line: Vec, clear: float) -> bool:
    """Whether a line from `p` keeps `clear` of the ball about obstacle `j`: most primitives are far away."""
    if scene.table[j, KIND] >= TREE:
        return False
    center, far = get_vec(scene.table, j, CENTER), clear + scene.table[j, EXTENT]
    off = add_scaled(sub(center, p), -nearest_share(center, p, line), line)
    return bool(dot(off, off) >= far * far)


def _blocks_line(scene: Scene, j: int, p: Vec, line: Vec, radius: float) -> bool:
    """Whether obstacle `j` is on a line from `p`, or too near to it: what is far away is passed in one evaluation."""
    length, clear = norm(line), SIGHT_CLEARANCE * radius
    if _passes_ball(scene, j, p, line, clear):
        return False
    gone, reach = 0.0, FIRST_REACH * radius
    for _ in range(SIGHT_EVALUATIONS):
        if gone >= length:
            break
        d, _ = evaluate(scene, j, add_scaled(p, gone / length, line), clear + reach, INTERPOLATED)
        if d < clear:
            return True
        gone += max(d - clear, SIGHT_STEP * radius)
        reach = min(2.0 * reach, FARTHEST_REACH * radius) if d - clear >= reach else reach
    return gone < length


def sees_point(scene: Scene, guide: Guide, p: Vec, i: int) -> bool:
    """Whether the line from `p` to point `i` of the guide is free; each obstacle is examined by itself."""
    line = sub(get_vec(guide.points, i, 0), p)
    if is_large(scene):
        return _sees_among_many(scene, p, line, guide.radius)
    for j in range(scene.table.shape[0]):  # noqa: SIM110 (a kernel)
        if _blocks_line(scene, j, p, line, guide.radius):
            return False
    return True


def _sees_among_many(scene: Scene, p: Vec, line: Vec, radius: float) -> bool:
    """The same in a large scene."""
    tree, node, j = tree_over(scene.store), 0, -1
    for at in range(HIERARCHY_HEADER, tree.items):
        if _blocks_line(scene, int(scene.store[at]), p, line, radius):
            return False
    while True:
        node = crossed_leaf(scene.store, tree, node, p, line, SIGHT_CLEARANCE * radius)
        if node == 0:
            return True
        before, j = j, int(scene.store[item_of(tree, node)])
        if j != before and _blocks_line(scene, j, p, line, radius):
            return False


def last_seen(scene: Scene, guide: Guide, p: Vec, since: int) -> int:
    """Point of the guide farthest along it that is seen from `p`, sought from point `since` on; -1: none is seen."""
    i, last = since, guide.points.shape[0] - 1
    if sees_point(scene, guide, p, last):
        return last
    unit = max(1, int(guide.radius / guide.spacing))
    back = unit
    while not sees_point(scene, guide, p, i):
        if i == 0:
            return -1
        i = max(0, i - back)
        back *= 2
    ahead = unit
    while ahead >= unit:
        if i + ahead <= last and sees_point(scene, guide, p, i + ahead):
            i += ahead
            ahead *= 2
        else:
            ahead //= 2
    return i


def _direction_back(guide: Guide, i: int) -> Vec:
    """Where the guide comes from at its point `i`; zero where it may come from anywhere."""
    if i == guide.points.shape[0] - 1:
        return guide.back
    return sub(get_vec(guide.points, i, 0), get_vec(guide.points, i + 1, 0))


def _turning_length(guide: Guide, p: Vec, tangent: Vec, i: int) -> float:
    """Length of backbone that leads from `p`, along a unit tangent, to point `i` of the guide and there into it."""
    line = sub(get_vec(guide.points, i, 0), p)
    chord = norm(line)
    if chord < 1e-9 * guide.turn:
        return 0.0
    towards = scale(1.0 / chord, line)
    half = math.acos(min(1.0, max(-1.0, dot(towards, tangent))))
    length = chord + 2.0 * guide.turn * half
    if half < WIDEST_SIGHT:
        length = min(length, arc_length(chord, half))
    # The arc arrives along the mirror image of the tangent that it leaves along.
    arrives = sub(scale(2.0 * dot(tangent, towards), towards), tangent)
    back = _direction_back(guide, i)
    if norm(back) > 0.0:
        length += TURN_LENGTH * guide.turn * math.acos(min(1.0, max(-1.0, -dot(arrives, back) / norm(back))))
    return length


def needed_length(guide: Guide, p: Vec, tangent: Vec, i: int) -> float:
    """Length of backbone that is needed from `p`, with a unit tangent, by point `i` of the guide to its end."""
    return _turning_length(guide, p, tangent, i) + (guide.points.shape[0] - 1 - i) * guide.spacing
