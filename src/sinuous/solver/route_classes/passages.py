"""Routes of different classes: those through passages that no solution leads through yet.

A route is searched for; then, for each passage that it leads through, again with that passage closed by a blocking
surface, and so on with what is found then (as Lawler 1972 divides what is left for the next best solution). Starts are
made of the first route of a class, and of others while the class is not solved; passages of all are closed. In which
order this is done is `solver.strategy`'s.

A blocking surface is the part of a plane across a route that is seen from the route. It ends at the obstacles, so it
leaves open what is behind them. Planes at several points, with several tilts, are compared, and the plane is taken of
which least is seen. Where a route leads through a door askew, this is nearly the plane of the wall; a blocking surface
in another plane would stand in the room beside the door.
"""

from collections.abc import Callable, Generator, Iterator
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.tables import QUERY_GOAL, QUERY_LONGEST, QUERY_ORIGIN, QUERY_RADIUS
from sinuous.problem.problem import Problem
from sinuous.scene.mesh import Mesh
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.attempts import Deadline, IKQuery, StartBatch
from sinuous.solver.polylines import lengths_along, points_at
from sinuous.solver.route_classes.curves import RouteCurves, across
from sinuous.solver.routing.candidates import RouteCandidate, RouteCandidates
from sinuous.solver.routing.partial_chains import FIRST_WIDTH
from sinuous.solver.routing.searches import Searches, SearchPlan

RAYS = 256
"""Lines of sight that a blocking surface is made of."""

FEW_RAYS = 16
"""Lines of sight by which planes are compared."""

PLACES = 9
"""Points of a passage from which planes are compared."""

FAR = 10.0
"""Length of these lines of sight, in units of the room that there is."""

NEAR_OBSTACLES = 0.25
"""Distance from the obstacles at which these lines of sight end, in units of the room that there is."""

TILTS = (0.3, 0.6, 0.9)
"""Angles by which planes are tilted against the route at first, rad."""

FINER = (0.2, 0.1, 0.05)
"""Angles by which planes are then tilted, one after the other, against the best plane so far, rad. The best plane is
also moved by as much, in units of the room."""

AROUND = 8
"""Directions in which a plane is tilted by each angle."""

WIDER = 1.15
"""Least room between two passages of a route, in units of the room in each of them."""

ABOUT = 2.0
"""Least length of a passage along the route, to either side of its narrowest place, in units of the room there: a route
that leads through a door askew has most room in the middle of the door."""

MOST_POINTS = 1000
"""Most points of a refined route."""

PASSAGES = 3
"""Most passages of a route, the narrowest ones."""


class Passage(NamedTuple):
    """Where a route passes obstacles.

    Attributes
    ----------
    places, axes : ndarray (k, 3)
        Points of the route there, and its unit tangents.
    room : float
        Distance of the obstacles where it is narrowest.
    """

    places: Floats
    axes: Floats
    room: float


class SurfaceBounds(NamedTuple):
    """What a blocking surface has to keep.

    Attributes
    ----------
    ends : ndarray (2, 3)
        Where routes begin and end.
    off_ends : float
        Distance that it keeps from there.
    reach : float
        How far it reaches.
    keep : float
        Distance from the obstacles at which it ends.
    thickness : float
    """

    ends: Floats
    off_ends: float
    reach: float
    keep: float
    thickness: float


def refined(route: Floats, spacing: float) -> Floats:
    """Return a route with points (k, 3) at most so far apart: a thin wall may stand between those that it has."""
    along = lengths_along(route)
    count = int(min(MOST_POINTS, np.ceil(along[-1] / spacing) + 1)) if spacing > 0.0 else len(route)
    wanted = np.linspace(0.0, along[-1], max(count, len(route)))
    return points_at(route, along, wanted)


def passages(route: Floats, distances: Floats, bounds: SurfaceBounds) -> list[Passage]:
    """Return where a route (k, 3) passes what is nearest to it, the narrowest passage first.

    `distances` (k,) of its points to the obstacles; between two passages, which are some way apart, they are larger.
    """
    spacing = float(np.linalg.norm(route[1] - route[0]))
    free = np.linalg.norm(route[:, None] - bounds.ends, axis=-1).min(axis=1) > bounds.off_ends
    chosen: list[int] = []
    while len(chosen) < PASSAGES and free.any():
        at = int(np.where(free, distances, np.inf).argmin())
        chosen.append(at)
        behind, ahead = (np.maximum.accumulate(side) for side in (distances[at::-1], distances[at:]))
        between = np.concatenate([behind[:0:-1], ahead])
        away = np.abs(np.arange(len(route)) - at) * spacing
        free &= (between > WIDER * distances) & (away > 2.0 * ABOUT * distances)
    tangents = np.gradient(route, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    found = []
    for i in chosen:
        some = _about(distances, i, round(ABOUT * float(distances[i]) / spacing))
        found.append(Passage(route[some], tangents[some], float(distances[i])))
    return found


def _about(distances: Floats, at: int, most: int) -> list[int]:
    """Some points about the point `at` of a route: where there is little more room than there, and `most` more."""
    wide = np.flatnonzero(distances > WIDER * distances[at])
    first = int(wide[wide < at].max(initial=-1)) + 1
    last = int(wide[wide > at].min(initial=len(distances))) - 1
    first, last = max(0, min(first, at - most)), min(len(distances) - 1, max(last, at + most))
    return sorted({round(i) for i in np.linspace(first, last, PLACES).tolist()})


def make_blocking_surface(curves: RouteCurves, passage: Passage, bounds: SurfaceBounds) -> Mesh | None:
    """Return a blocking surface that closes a passage: a fan of triangles, as far as is seen from a point of the route.

    `None`: the time of the curves did not suffice.
    """
    near = bounds._replace(
        reach=min(bounds.reach, FAR * passage.room), keep=max(bounds.keep, NEAR_OBSTACLES * passage.room)
    )
    normals = _tilted(passage.axes, TILTS)
    places = np.repeat(passage.places, len(normals) // len(passage.places), axis=0)
    place, normal = _narrowest(curves, places, normals, near)
    for tilt in FINER:
        if curves.seconds() <= 0.0:
            return None
        normals = np.tile(_tilted(normal[None], (tilt,)), (3, 1))
        shifts = np.repeat((0.0, -tilt * passage.room, tilt * passage.room), len(normals) // 3)
        place, normal = _narrowest(curves, place + shifts[:, None] * normal, normals, near)
    ((rays,), (lengths,)) = _stars(curves, place[None], normal[None], RAYS, bounds)
    rim = place + np.maximum(lengths, 0.5 * bounds.thickness)[:, None] * rays
    chosen = _corners(rim, 0.5 * bounds.thickness, curves.seconds)
    if curves.seconds() <= 0.0:
        return None
    rim = rim[chosen]
    corners = np.arange(1, len(rim) + 1)
    faces = np.stack([np.zeros_like(corners), corners, np.roll(corners, -1)], axis=1)
    return Mesh(np.vstack([place, rim]), faces, thickness=bounds.thickness)


def _narrowest(curves: RouteCurves, places: Floats, normals: Floats, bounds: SurfaceBounds) -> tuple[Floats, Floats]:
    """Of planes (m, 3), (m, 3) return the one, place and normal, in which least is seen from the place."""
    lengths = _stars(curves, places, normals, FEW_RAYS, bounds)[1]
    least = int((lengths * lengths).sum(axis=1).argmin())
    return places[least], normals[least]


def _tilted(axes: Floats, tilts: tuple[float, ...]) -> Floats:
    """Unit vectors about each of some axes (k, 3): itself, and others at these angles (rad) from it."""
    aside = across(axes)
    normals = [axes]
    for i, tilt in enumerate(tilts):
        for angle in 2.0 * np.pi / AROUND * (np.arange(AROUND) + 0.5 * (i % 2)):
            off = np.cos(angle) * aside[:, 0] + np.sin(angle) * aside[:, 1]
            normals.append(np.cos(tilt) * axes + np.sin(tilt) * off)
    return np.stack(normals, axis=1).reshape(-1, 3)


def _stars(
    curves: RouteCurves, places: Floats, normals: Floats, count: int, bounds: SurfaceBounds
) -> tuple[Floats, Floats]:
    """Directions (m, count, 3) across axes (m, 3), and how far is seen from places (m, 3) in them (m, count)."""
    angles = 2.0 * np.pi / count * np.arange(count)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ across(normals)
    starts = np.repeat(places[:, None], count, axis=1)
    ends = starts + bounds.reach * rays
    seen = curves.see(starts.reshape(-1, 3), ends.reshape(-1, 3), bounds.keep, curves.seconds())
    lengths = seen.lengths.reshape(-1, count)
    for end in bounds.ends:
        lengths = np.minimum(lengths, _up_to(end - places, rays, bounds.off_ends))
    return rays, lengths


def _corners(rim: Floats, off: float, deadline: Deadline) -> list[int]:
    """Points that are left of a closed line (m, 3) which may be moved by so much (Douglas & Peucker 1973), in time."""
    count = len(rim)
    kept, open_pieces = {0, count // 3, 2 * count // 3}, [(0, count // 3), (count // 3, 2 * count // 3)]
    open_pieces.append((2 * count // 3, count))
    while open_pieces and deadline() > 0.0:
        first, last = open_pieces.pop()
        chord = rim[last % count] - rim[first]
        between = rim[first + 1 : last] - rim[first]
        along = between @ chord / max(float(chord @ chord), 1e-300)
        away = np.linalg.norm(between - np.clip(along, 0.0, 1.0)[:, None] * chord, axis=1)
        if len(away) and away.max() > off:
            corner = first + 1 + int(away.argmax())
            kept.add(corner)
            open_pieces += [(first, corner), (corner, last)]
    return sorted(kept)


def _up_to(away: Floats, rays: Floats, radius: float) -> Floats:
    """Lengths (m, k) up to which rays (m, k, 3) stay out of balls about `away` (m, 3) of them; infinite past it."""
    along = np.einsum("mki,mi->mk", rays, away)
    inside = radius * radius - (away * away).sum(axis=1)[:, None] + along * along
    hits = (inside > 0.0) & (along > 0.0)
    return np.where(hits, along - np.sqrt(np.maximum(inside, 0.0)), np.inf)


THICK = 0.5
"""Thickness of a blocking surface, in edges of the cells."""

FINE = 0.5
"""Distance between the points of a route at which passages are looked for, in radii of the body."""

NEAR = 1.0
"""Distance of two passages, in radii of the body, up to which they are at one place."""

OFF_ENDS = 2.0
"""Distance of blocking surfaces from the ends of a route, in radii of the body and edges of cells together."""

COPIED = 2e9
"""Bytes of a scene that are copied in a second at least. A scene with a blocking surface is a copy, which looks at no
clock."""

SAME = 0.9
"""Least cosine of the angle between the tangents at two passages at one place."""

WIDE = 0.8
"""Distance that a route has to keep from the obstacles, in radii of the body."""


class Passages:
    """The passages that routes of one question lead through. Not to be shared between threads.

    Parameters
    ----------
    searches : Searches
    curves : RouteCurves
        Of the same robot and scene.
    question : IKQuery
    query : ndarray (QUERY_WIDTH,)
        What routes have to keep.
    solved : callable
        Says of a curve (N, 3) whether one of its class is solved.
    """

    def __init__(
        self,
        searches: Searches,
        curves: RouteCurves,
        question: IKQuery,
        query: Floats,
        solved: Callable[[Floats], bool],
    ) -> None:
        self._searches, self._curves, self._question, self._query = searches, curves, question, query
        self._solved = solved
        self._bounds = _bounds(query, searches.single_plans[0])
        self._blocking_surfaces: list[tuple[Passage, Mesh]] = []
        self._known: list[Floats] = []
        self._seen = {frozenset[int]()}

    def routes(self, closed: frozenset[int], plan: SearchPlan) -> tuple[list[Floats], int]:
        """Return routes (k, 3) that are wide enough and lead through no closed passage, and how many cells they cost.

        `closed` are numbers of blocking surfaces. Where there is no time for a copy of the scene nothing is found.
        """
        if closed and self._curves.scene.memory > COPIED * self._curves.seconds():
            return [], 0
        problem, plans = self._question.problem, self._searches.single_plans
        scene = self._curves.scene.beside([self._blocking_surfaces[i][1] for i in sorted(closed)])
        shut = Problem.prepared(problem.robot, problem.targets, scene, problem.tolerance)
        found = self._searches.find(shut, self._query, plan, self._curves.seconds())
        finest = plan.cell == plans[-1].cell and plan.cells == plans[-1].cells
        least = -np.inf if finest else WIDE * self._query[QUERY_RADIUS]
        return [route for route in found.routes if self._keeps(problem.scene, route) >= least], found.cells

    def starts(self, routes: list[Floats]) -> Generator[StartBatch, None, bool]:
        """Yield configurations along routes (k, 3) of new classes, and of those that are not solved.

        Returns whether one still is not.
        """
        failed = False
        for route in routes:
            new, known = self.differs(route), self._recognise(route)
            if new or not self._solved(known):
                for batch in self._along(route):
                    yield batch
                    if self._solved(known):
                        break
                else:
                    failed = True
        return failed

    def differs(self, route: Floats) -> bool:
        """Whether a route (K, 3) is of a new class, which is known from then on."""
        classes = len(self._known)
        self._recognise(route)
        return len(self._known) > classes

    def closing(self, closed: frozenset[int], route: Floats) -> Iterator[frozenset[int]]:
        """Yield what is closed together with each passage of a route (k, 3), unless that was closed before.

        Ends where the time does: a blocking surface takes as long as some searches.
        """
        if self._curves.seconds() <= 0.0:
            return
        line = refined(route, FINE * self._query[QUERY_RADIUS])
        for passage in passages(line, self._curves.scene.distance(line), self._bounds):
            number = self._number(passage)
            if number is None:
                return
            more = closed | {number}
            if more not in self._seen:
                self._seen.add(more)
                yield more

    def _along(self, route: Floats) -> Iterator[StartBatch]:
        """Yield configurations along one route (K, 3): fitted, and grown."""
        candidates = RouteCandidates(self._searches, self._question, self._query)
        yield from candidates.fitted_chains([route])
        yield from candidates.grown_chains(RouteCandidate(route, clear=True, rank=1, weight=1), FIRST_WIDTH)

    def _keeps(self, scene: Snapshot, route: Floats) -> float:
        """Least distance of a route from the obstacles that concern it."""
        gone = lengths_along(route)
        concerned = route[gone >= min(self._curves.mount, gone[-1])]
        return float(scene.distance(concerned).min())

    def _recognise(self, route: Floats) -> Floats:
        """Return the curve (N, 3) that stands for the class of a route; of a new class its own."""
        curve = self._curves.along(route)
        which = self._curves.alike_one(curve, self._known)
        if which is None:
            self._known.append(curve)
            return curve
        return self._known[which]

    def _number(self, passage: Passage) -> int | None:
        """Number of the blocking surface that closes a passage; one at the place of another passage has that one's.

        `None`: there was no time for it.
        """
        radius = float(self._query[QUERY_RADIUS])
        for i, (other, _) in enumerate(self._blocking_surfaces):
            gaps = np.linalg.norm(other.places[:, None] - passage.places, axis=-1)
            nearest = np.unravel_index(gaps.argmin(), gaps.shape)
            if gaps[nearest] < NEAR * radius and abs(other.axes[nearest[0]] @ passage.axes[nearest[1]]) > SAME:
                return i
        closing = make_blocking_surface(self._curves, passage, self._bounds) if self._curves.seconds() > 0.0 else None
        if closing is None:
            return None
        self._blocking_surfaces.append((passage, closing))
        return len(self._blocking_surfaces) - 1


def _bounds(query: Floats, plan: SearchPlan) -> SurfaceBounds:
    """What blocking surfaces have to keep in the searches of a query (QUERY_WIDTH,) with cells as large as a plan's."""
    ends = np.stack([query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_GOAL : QUERY_GOAL + 3]])
    radius, edge = float(query[QUERY_RADIUS]), plan.cell
    return SurfaceBounds(
        ends, OFF_ENDS * (radius + edge), float(query[QUERY_LONGEST]), max(0.2 * radius, 1e-3 * edge), THICK * edge
    )
