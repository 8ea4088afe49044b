"""Routes of different classes: those through passages that no solution leads through yet.

A route is searched for; then, for each passage that it leads through, again with that passage closed by a blocking
surface, and so on with what is found then (as Lawler 1972 divides what is left for the next best solution). Starts are
made of the first route of a class, and of others while the class is not solved; passages of all are closed. In which
order this is done is `solver.strategy`'s.
"""

from collections.abc import Callable, Generator, Iterator

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.tables import QUERY_GOAL, QUERY_LONGEST, QUERY_ORIGIN, QUERY_RADIUS
from sinuous.problem.problem import Problem
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.attempts import IKQuery, StartBatch
from sinuous.solver.polylines import lengths_along
from sinuous.solver.route_classes.blocking_surfaces import (
    Passage,
    SurfaceBounds,
    make_blocking_surface,
    passages,
    refined,
)
from sinuous.solver.route_classes.curves import RouteCurves
from sinuous.solver.routing.candidates import RouteCandidate, RouteCandidates
from sinuous.solver.routing.growth import FIRST_WIDTH
from sinuous.solver.routing.searches import Searches, SearchPlan

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
    query : ndarray (27,)
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
    """What blocking surfaces have to keep in the searches of a query (27,) with cells as large as a plan's."""
    ends = np.stack([query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_GOAL : QUERY_GOAL + 3]])
    radius, edge = float(query[QUERY_RADIUS]), plan.cell
    return SurfaceBounds(
        ends, OFF_ENDS * (radius + edge), float(query[QUERY_LONGEST]), max(0.2 * radius, 1e-3 * edge), THICK * edge
    )
