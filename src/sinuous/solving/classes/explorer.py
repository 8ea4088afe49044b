"""The start source for solutions of several classes: routes that lead through different passages.

A route is searched for; then, for each passage that it leads through, again with that passage closed by a screen, and
so on with what is found then (as Lawler 1972 divides what is left for the next best solution). A start is made of the
first route of a class, and of others while the class is not solved; passages of all are closed.
"""

from collections.abc import Callable, Generator, Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import QUERY_GOAL, QUERY_LONGEST, QUERY_ORIGIN, QUERY_RADIUS, ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.snapshot import Snapshot
from sinuous.solving.classes.curves import Curves
from sinuous.solving.classes.screens import Bounds, Passage, passages, refined, screen
from sinuous.solving.classes.tasks import Task, Tasks
from sinuous.solving.polylines import lengths_along
from sinuous.solving.routing.candidates import Candidates
from sinuous.solving.routing.chains import FIRST_WIDTH
from sinuous.solving.routing.plans import Plan
from sinuous.solving.routing.searches import Searches
from sinuous.solving.starts import Batch, Question

SEARCHES = 96
"""Most searches for routes."""

CELLS_A_START = 600
"""Cells that a search looks at for each scattered start of its cost: more than elsewhere, because routes find more
classes than scattered starts do."""

ALTERNATIVES = 4
"""Routes that differ, of a search after no start along the first one led to a solution."""

THICK = 0.5
"""Thickness of a screen, in units of the cells' edge."""

FINE = 0.5
"""Distance of the points of a route at which it is looked for passages, in radii of the body."""

NEAR = 1.0
"""Two passages are at one place when they are no farther apart, in radii of the body."""

OFF_ENDS = 2.0
"""How far screens stay off the ends of a route, in radii of the body and edges of cells together."""

SAME = 0.9
"""Cosine of the angle between the tangents at two passages at one place, at least."""

WIDE = 0.8
"""Distance that a route has to keep from the obstacles, in radii of the body."""


class Explorer:
    """The start source, for one question. Not to be shared between threads.

    Parameters
    ----------
    searches : Searches
    curves : Curves
        Of the same robot and scene.
    solved : callable
        Says of a curve (N, 3) whether one of its class is solved.
    """

    name = SOURCES[ROUTE]

    def __init__(self, searches: Searches, curves: Curves, solved: Callable[[Floats], bool]) -> None:
        self._searches, self._curves, self._solved = searches, curves, solved
        self._screens: list[tuple[Passage, Mesh]] = []
        self._known: list[Floats] = []

    def batches(self, question: Question) -> Iterator[Batch]:
        """Yield configurations along routes of different classes, while time is left."""
        query = self._searches.query(question.problem)
        if query is None:
            return
        plans = self._searches.single_plans
        bounds = _bounds(query, plans[0])
        todo, seen = Tasks(len(plans)), {frozenset[int]()}
        todo.add(Task(frozenset(), 0))
        for _ in range(SEARCHES):
            task = todo.next()
            if task is None or question.seconds_left() <= 0.0:
                return
            routes, cells = self._find(question, query, task, plans)
            yield Batch(self.name, question.initial[:0], cost=cells / CELLS_A_START)
            if not routes:
                todo.add(task._replace(plan=task.plan + 1), last=True)
                continue
            failed = yield from self._starts(question, query, routes)
            if failed:
                todo.add(Task(task.closed, task.plan + task.again, again=True))
            line = refined(routes[0], FINE * query[QUERY_RADIUS])
            for passage in passages(line, self._curves.scene.distance(line), bounds):
                closed = task.closed | {self._number(passage, query[QUERY_RADIUS], bounds)}
                if closed not in seen:
                    seen.add(closed)
                    todo.add(Task(closed, 0))

    def _starts(self, question: Question, query: Floats, routes: list[Floats]) -> Generator[Batch, None, bool]:
        """Yield configurations along routes (k, 3) of new classes, and of those that are not solved.

        Returns whether one still is not.
        """
        failed = False
        for route in routes:
            classes = len(self._known)
            known = self._recognise(route)
            if len(self._known) > classes or not self._solved(known):
                for batch in self._along(question, query, route):
                    yield batch
                    if self._solved(known):
                        break
                else:
                    failed = True
        return failed

    def _along(self, question: Question, query: Floats, route: Floats) -> Iterator[Batch]:
        """Yield configurations along one route (K, 3): laid, and grown."""
        candidates = Candidates(self._searches, question, query)
        candidate, _ = candidates.note(route, finest=True)
        yield from candidates.laid([route])
        assert candidate is not None  # the first one
        yield from candidates.grown(candidate, FIRST_WIDTH)

    def _find(self, question: Question, query: Floats, task: Task, plans: tuple[Plan, ...]) -> tuple[list[Floats], int]:
        """Return routes (k, 3) that lead through no closed passage and are wide enough, and how many cells they cost.

        One is searched for; again, where no start along it led to a solution, several that differ.
        """
        problem, plan = question.problem, plans[task.plan]
        scene = self._curves.scene.beside([self._screens[i][1] for i in sorted(task.closed)])
        shut = Problem.prepared(problem.robot, problem.targets, scene, problem.tolerance)
        plan = plan._replace(routes=ALTERNATIVES if task.again else 1)
        found = self._searches.find(shut, query, plan, question.seconds_left())
        least = WIDE * query[QUERY_RADIUS] if task.plan + 1 < len(plans) else -np.inf
        return [route for route in found.routes if self._keeps(problem.scene, route) >= least], found.cells

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

    def _number(self, passage: Passage, radius: float, bounds: Bounds) -> int:
        """Number of the screen that closes a passage; one at the place of another passage has that one's."""
        for i, (other, _) in enumerate(self._screens):
            gaps = np.linalg.norm(other.places[:, None] - passage.places, axis=-1)
            nearest = np.unravel_index(gaps.argmin(), gaps.shape)
            if gaps[nearest] < NEAR * radius and abs(other.axes[nearest[0]] @ passage.axes[nearest[1]]) > SAME:
                return i
        self._screens.append((passage, screen(self._curves, passage, bounds)))
        return len(self._screens) - 1


def _bounds(query: Floats, plan: Plan) -> Bounds:
    """What screens have to keep in the searches of a query (28,) with cells as large as a plan's."""
    ends = np.stack([query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_GOAL : QUERY_GOAL + 3]])
    radius, edge = float(query[QUERY_RADIUS]), plan.cell
    return Bounds(
        ends, OFF_ENDS * (radius + edge), float(query[QUERY_LONGEST]), max(0.2 * radius, 1e-3 * edge), THICK * edge
    )
