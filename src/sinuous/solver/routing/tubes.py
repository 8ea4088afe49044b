"""What leads to a route without any cells: tubes, and the sharp edges of meshes.

What lies in a tube is said by the tube. What is left is a shorter robot, that stands where the tube opens: mostly an
easy question. A route to the target is of no use for it: it bends around the rim, and a chain that is much longer than
the route is drawn together in the tube, too. Other tubes open beside edges, which a route may lead around.
"""

import heapq
import itertools
import math
from collections.abc import Callable, Iterator
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import tables as t
from sinuous.kernels.clock import CLOCK_SIZE
from sinuous.kernels.tubes import BRANCH, MOUTH, WALL, find_tubes, follow_tube
from sinuous.scene.mesh import Mesh
from sinuous.scene.snapshot import Snapshot
from sinuous.scene.triangles import Integers
from sinuous.solver.attempts import Deadline
from sinuous.solver.polylines import lengths_along, points_at, respaced
from sinuous.solver.routing.partial_chains import (
    Groups,
    backbone_of,
    first_segments,
    fit_chain,
    problem_beyond,
    search_part,
    segments_in,
    set_route_end,
    set_route_start,
)

SHARP = math.cos(math.radians(30.0))
"""Largest cosine of the angle between the normals of both faces of a sharp edge."""

MOST = 400
"""Sharp edges of a mesh from which on it is none of walls: a route around them is not looked for."""

SMOOTH = 8
"""Triangles of a mesh for each sharp edge from which on it is smooth: what leads around it turns elsewhere, too."""

WIDTH = 10
"""Numbers of an edge, see `kernels.roadmap.places`."""


class SharpWalls(NamedTuple):
    """What is sharp-edged: edges (e, 10) that stick out, and triangles (t, 12), as `find_by_edges` takes them."""

    edges: Floats
    triangles: Floats


_NONE = SharpWalls(np.empty((0, WIDTH)), np.empty((0, 12)))
_KNOWN: "WeakKeyDictionary[Mesh, SharpWalls]" = WeakKeyDictionary()


def walls_of(scene: Snapshot) -> SharpWalls:
    """Return the walls of all solid meshes that are not smooth."""
    found = [walls for walls in _all(scene) if len(walls.triangles) < SMOOTH * len(walls.edges)]
    return SharpWalls(*map(np.concatenate, zip(*found, strict=True))) if found else _NONE


def rims_of(scene: Snapshot) -> Floats:
    """Return the sharp edges (e, 10) of all solid meshes, also of smooth ones: mouths of tubes may lie beside them."""
    return np.concatenate([_NONE.edges, *(walls.edges for walls in _all(scene))])


def _all(scene: Snapshot) -> list[SharpWalls]:
    return [_of(mesh) for mesh in scene.obstacles if isinstance(mesh, Mesh) and mesh.watertight and not mesh.inside]


def _of(mesh: Mesh) -> SharpWalls:
    walls = _KNOWN.get(mesh)
    if walls is None:
        edges = _sticking_out(mesh.vertices, mesh.faces)
        walls = _KNOWN[mesh] = SharpWalls(edges, _faces(mesh)) if 0 < len(edges) <= MOST else _NONE
    return walls


def _faces(mesh: Mesh) -> Floats:
    """Triangles (t, 12), as `kernels.roadmap.sight` reads them."""
    corners = mesh.vertices[mesh.faces]
    corners[:, 1:] -= corners[:, :1]
    return np.hstack([corners.reshape(-1, 9), np.cross(corners[:, 1], corners[:, 2])])


def _sticking_out(vertices: Floats, faces: Integers) -> Floats:
    """Edges (e, 10) between two faces that make a convex angle."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort(ends.T)
    ends, owner = ends[order], order // 3
    opposite = faces[:, [2, 0, 1]].reshape(-1)[order]
    pairs = ends.reshape(-1, 2, 2)[:, 0]  # watertight: every edge has two faces
    one, other = owner.reshape(-1, 2).T
    start, end = vertices[pairs[:, 0]], vertices[pairs[:, 1]]
    cosine = (normals[one] * normals[other]).sum(axis=1)
    below = ((vertices[opposite.reshape(-1, 2)[:, 1]] - start) * normals[one]).sum(axis=1)
    kept = np.flatnonzero((cosine < SHARP) & (below < 0.0) & (cosine > -0.9))
    way = (normals[one] + normals[other])[kept] / (1.0 + cosine[kept, None])
    line = (end - start)[kept]
    length = np.linalg.norm(line, axis=1, keepdims=True)
    return np.hstack([0.5 * (start + end)[kept], way, line / length, 0.5 * length])


POINTS = 1000
"""Most points of an axis."""

SHORTEST = 3.0
"""Length that a tube has at least."""

BESIDE = 2.5
"""How far from the axis a target in a tube is at most. In radii of the body."""

FINER = 0.4
"""Of the first steps, those by which a tube is followed again that ends at a wall."""

BARELY = 0.15
"""Of a segment, what may stick out of the tube and still count as in it."""

AHEAD = 2
"""Points of the axis that its direction at the mouth is taken over."""

STARTS = 6
"""Own starts of what is left of the chain, the first of which is the single arc."""

Distance = Callable[[Floats], Floats]
"""From points (m, 3) to their distances from the obstacles (m,), in the length unit."""


class Tube(NamedTuple):
    """A tube that the base lies in.

    Attributes
    ----------
    axis : ndarray (K, 3)
        Points, evenly spaced but for the first step, from the base on.
    ended : int
        Where it ends: MOUTH, END or BRANCH of `sinuous.kernels.tubes`.
    """

    axis: Floats
    ended: int

    @property
    def open(self) -> bool:
        """Whether it ends at a mouth."""
        return self.ended == MOUTH


def find_tube_around(scene: Floats, query: Floats, seconds: float) -> Tube | None:
    """Return the tube that the base lies in, from what a route keeps (QUERY_WIDTH,); `None` where there is none."""
    radius, longest = query[t.QUERY_RADIUS], query[t.QUERY_LONGEST]
    if radius <= 0.0:
        return None
    spacing = max(radius, longest / POINTS)
    tube = _followed(scene, query, spacing, seconds)
    if tube is not None and tube.ended == WALL and line_to_target_in_tube(tube, query) is None:
        tube = _followed(scene, query, FINER * spacing, seconds)  # it may bend too much for the first steps
    return tube


def _followed(scene: Floats, query: Floats, spacing: float, seconds: float) -> Tube | None:
    radius = query[t.QUERY_RADIUS]
    origin, axis = (query[at : at + 3] for at in (t.QUERY_ORIGIN, t.QUERY_AXIS))
    points, clock = np.empty((2 * POINTS, 3)), np.zeros(CLOCK_SIZE, np.int64)
    sizes = radius, spacing, query[t.QUERY_FREE_LENGTH]
    count, ended = follow_tube(scene, np.stack([origin, axis]), sizes, seconds, clock, points)
    known = points[:count]
    if ended not in (MOUTH, WALL, BRANCH) or lengths_along(known)[-1] < SHORTEST * radius:
        return None
    return Tube(known, ended)


def line_to_target_in_tube(tube: Tube, query: Floats) -> Floats | None:
    """Return the line (K, 3) along the axis to a target that lies in the tube; `None` where it does not."""
    goal = query[t.QUERY_GOAL : t.QUERY_GOAL + 3]
    gaps = np.linalg.norm(tube.axis - goal, axis=1)
    at = int(gaps.argmin())
    last = len(tube.axis) - 1
    if gaps[at] > BESIDE * query[t.QUERY_RADIUS] or at < 2 or (tube.open and at == last):
        return None
    return _spaced(np.vstack([tube.axis[:at], goal]))


def chains_out_of_tube(tube: Tube, groups: Groups, deadline: Deadline) -> Iterator[tuple[Floats, Floats]]:
    """Yield chains (n, 3) that lead out of a tube, and the routes (K, 3) along which they lie."""
    for head, line in chains_in_tube(tube, groups, deadline):
        yield _joined(groups, head, line, deadline)


def chains_in_tube(tube: Tube, groups: Groups, deadline: Deadline) -> Iterator[tuple[Floats, Floats]]:
    """Yield chains (m, 3) of the segments that a tube holds, and the lines (K, 3) along which they lie.

    First with the one that it holds only in part, then without.
    """
    robot, scene, settings, targets = groups
    n, segments = int(groups[0][0]), segments_in(groups[0])
    ends = np.cumsum(segments[:, [t.MIN_LENGTH, t.MAX_LENGTH]].mean(axis=1))
    length = lengths_along(tube.axis)[-1] - BARELY * segments[-1, t.MAX_LENGTH]
    inside = 1 + int(np.searchsorted(ends, length))
    for count in (inside, inside - 1) if inside <= n else ():
        if 0 < count < n:
            line = lengthen_axis(tube.axis, ends[count - 1])
            yield fit_chain((first_segments(robot, count), scene, settings, targets[:0]), line, deadline()), line


def _joined(groups: Groups, head: Floats, line: Floats, deadline: Deadline) -> tuple[Floats, Floats]:
    """A chain that begins with segments (m, 3) along a line (K, 3), and goes from there to the targets; its route."""
    rest = problem_beyond(groups, head)
    q = search_part(rest, np.empty((0, int(rest[0][0]), 3)), (0, STARTS), deadline).q
    return np.concatenate([head, q]), np.concatenate([line[:-1], backbone_of(rest, q)])


def lengthen_axis(axis: Floats, length: float) -> Floats:
    """The axis (K, 3) made so long: cut, or gone on straight."""
    along = lengths_along(axis)
    inside = axis[along < length]
    if length <= along[-1]:
        end = points_at(axis, along, np.array([length]))[0]
    else:
        ahead = axis[-1] - axis[max(0, len(axis) - 1 - AHEAD)]
        end = axis[-1] + (length - along[-1]) / np.linalg.norm(ahead) * ahead
    return _spaced(np.vstack([inside, end]))


def _spaced(line: Floats) -> Floats:
    """As many points, or a few at least, evenly spaced along a line (K, 3)."""
    return respaced(line, max(8, len(line)))


TUBES, AXIS_POINTS = 16, 4096
"""Most tubes, and most points of all their axes."""

LEGS = 8
"""Most legs of routes, from mouth to mouth, that are searched for."""

DRAWN = 0.9
"""What is left at least of the length of a route when it is drawn tight."""

FEWEST = 256
"""Points of a route at least."""

TANGENT_SPAN = 2
"""Points of an axis that its direction at a mouth is taken over."""

ORIGIN, GOAL = (slice(at, at + 3) for at in (t.QUERY_ORIGIN, t.QUERY_GOAL))

Leg = Callable[[Floats], Floats | None]
"""From what a route has to keep (QUERY_WIDTH,) to a route (K, 3), or to none."""


def tubes_beside(scene: Floats, edges: Floats, radius: float, seconds: float) -> list[Floats]:
    """Return the axes (K, 3) of tubes, open at both ends, that open beside edges of boxes, or of meshes (e, 10)."""
    if radius <= 0.0:
        return []
    points, ends = np.empty((AXIS_POINTS, 3)), np.zeros((TUBES, 3), np.int64)
    count = find_tubes(scene, edges, radius, seconds, np.zeros(CLOCK_SIZE, np.int64), points, ends)
    return [points[first:last].copy() for first, last, through in ends[:count] if through]


class _Path(NamedTuple):
    """A way from the origin through some tubes to the mouth of the next one, the last leg of which is not known yet.

    Attributes
    ----------
    bound : float
        Length of a route by it, at least.
    number : int
        Its own.
    gone : float
        Length up to the last mouth.
    lines : tuple of ndarray (K, 3)
        Legs and axes up to there.
    passed : tuple of int
        The tubes that they lead through.
    tube : int
        The next one; -1: the goal is next.
    axis : ndarray (K, 3)
        Its axis, from the mouth on that is next.
    """

    bound: float
    number: int
    gone: float
    lines: tuple[Floats, ...]
    passed: tuple[int, ...]
    tube: int
    axis: Floats


def route_through(axes: list[Floats], query: Floats, leg: Leg, last: Leg, most: int) -> Floats | None:
    """Return a route (K, 3) through tubes of these axes (K, 3), of at most so many points; `None` where none is found.

    Legs from mouth to mouth are searched for when they are needed, the most promising first; `last` those to the goal.
    """
    paths: list[_Path] = []
    numbers = itertools.count()
    _add_from(paths, numbers, axes, query, 0.0, (), ())
    for _ in range(LEGS):
        if not paths:
            return None
        path = heapq.heappop(paths)
        line = (leg if path.tube >= 0 else last)(_asked(query, path))
        if line is None:
            continue
        lines = (*path.lines, line, path.axis) if path.tube >= 0 else (*path.lines, line)
        if path.tube < 0:
            route = np.concatenate([lines[0], *(line[1:] for line in lines[1:])])
            length = lengths_along(route)[-1]
            return respaced(route, min(most, max(FEWEST, int(length / query[t.QUERY_RADIUS]))))
        gone = path.gone + lengths_along(line)[-1] + lengths_along(path.axis)[-1]
        _add_from(paths, numbers, axes, query, gone, lines, (*path.passed, path.tube))
    return None


def _add_from(
    paths: list[_Path],
    numbers: Iterator[int],
    axes: list[Floats],
    query: Floats,
    gone: float,
    lines: tuple[Floats, ...],
    passed: tuple[int, ...],
) -> None:
    """Note the paths that go on from the end of the last of some lines: through another tube, or to the goal."""
    end, goal = (lines[-1][-1] if lines else query[ORIGIN]), query[GOAL]
    new = [(-1, goal[None])] if lines else []
    new += [(i, axis[::way]) for i, axis in enumerate(axes) if i not in passed for way in (1, -1)]
    for tube, axis in new:
        rest = np.linalg.norm(axis[0] - end) + lengths_along(axis)[-1] + np.linalg.norm(goal - axis[-1])
        bound = float(gone + rest)
        if DRAWN * bound <= query[t.QUERY_LONGEST]:
            heapq.heappush(paths, _Path(bound, next(numbers), gone, lines, passed, tube, axis))


def _asked(query: Floats, path: _Path) -> Floats:
    """What the next leg of a path has to keep (QUERY_WIDTH,)."""
    asked = query.copy()
    if path.lines:
        last = path.lines[-1]
        set_route_start(asked, last[-1], _unit(last[-1] - last[-1 - TANGENT_SPAN]))
    if path.tube >= 0:
        set_route_end(asked, path.axis[0], _unit(path.axis[TANGENT_SPAN] - path.axis[0]))
        asked[t.QUERY_GOAL_RADIUS] = 0.0
    asked[t.QUERY_LONGEST] -= path.gone
    return asked


def _unit(vector: Floats) -> Floats:
    return vector / max(np.linalg.norm(vector), np.finfo(float).tiny)
