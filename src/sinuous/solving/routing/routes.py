"""The start source for narrow places: routes through free space from the base to a target, and the chain along them."""

import math
from collections.abc import Callable, Iterator
from time import monotonic
from typing import NamedTuple

import numpy as np

from sinuous import packing
from sinuous.checks import Floats
from sinuous.kernels.fitting.fit import fit_route, fit_workspace_size
from sinuous.kernels.fitting.query import route_query
from sinuous.kernels.freespace.cells import memory_size
from sinuous.kernels.freespace.find import find_routes
from sinuous.kernels.freespace.lengthen import lengthen_route, lengthen_workspace_size
from sinuous.kernels.roadmap.find import find_by_edges, roadmap_size
from sinuous.kernels.tables import FULL, PROVED_CLOSED, QUERY_WIDTH, ROUTE, SOURCES
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.problem.tolerance import Tolerance
from sinuous.robot.robot import Robot
from sinuous.scene.scene import Scene
from sinuous.solving.routing.buffers import BufferPool
from sinuous.solving.routing.edges import walls_of
from sinuous.solving.routing.growth import (
    FEW,
    LEG_POINTS,
    MANY,
    ONE,
    Beam,
    gone_on,
    grown,
    leg_queries,
    respaced,
    settled,
)
from sinuous.solving.routing.plans import CELLS, Plan, coarser, plans_of
from sinuous.solving.routing.turned import Groups, turned, turned_back
from sinuous.solving.sources import Batch, Question

CELLS_A_START = 100
"""Cells that a search may look at for each scattered start that follows it: a descent costs about as much."""

AFTER_EDGES = 20
"""Scattered starts that follow a route around edges."""

ALONG = 2
"""Routes of one search along which chains are grown."""

POINTS = 1024
"""Most points of a route."""

SIDES = tuple(turns * math.pi for turns in (0.0, 1.0, 0.5, 1.5, 0.25, 1.25, 0.75, 1.75))
"""To which sides a route is bent, in rad, that is too short for the robot."""

MISSES = 2
"""Sides for which nothing comes of it, before others are no longer tried."""

ROD_POINTS = 160
"""Points of such a route."""

MEMORY = BufferPool(most=2, largest=memory_size(CELLS[2]))
"""What all searches of this process work in. A search takes 118 bytes a cell and 0.2 MB: 16 MB at most in the last but
one size, 62 MB in the largest. The largest is not kept after the search; of the others two are."""


class Found(NamedTuple):
    """What came of one search.

    Attributes
    ----------
    routes : list of ndarray (K, 3)
        Points from the base to the target, evenly spaced, in the length unit.
    ended : int
        How the last search ended: FOUND, CLOSED, FULL, TIMED_OUT or PROVED_CLOSED of `sinuous.kernels.tables`.
    cells : int
        How many cells it looked at.
    """

    routes: list[Floats]
    ended: int
    cells: int


class Router:
    """The start source of routes, for one robot; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance

    Attributes
    ----------
    plans : tuple of Plan
        The searches for one target, from the quickest to the most thorough.
    """

    name = SOURCES[ROUTE]

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance) -> None:
        self._robot = robot
        self._group, self._settings = packing.robot_group(robot), packing.settings_group(robot, tolerance)
        self.plans = plans_of(min(robot.radii), sum(segment.length[1] for segment in robot.segments))
        nowhere = Problem.prepared(robot, (Target((0.0, 0.0, 0.0)),), scene.snapshot(), tolerance)
        self._nowhere: Problem | None = nowhere  # to load the entries with

    def batches(self, question: Question) -> Iterator[Batch]:
        """Yield configurations along routes to the most distal target, around edges, then over cells, coarse to fine.

        Chains are grown along each route before the next search; where several solutions are wanted, after the last,
        because those along one route are much alike.
        """
        query = self.query(question.problem)
        if query is None:
            return
        seconds, plans = question.seconds_left(), self.plans
        route = self.by_edges(question.problem, query, seconds) if seconds > 0.0 else None
        if route is not None:
            plans = tuple(plan for plan in plans if plan.routes > 1)  # the others look for one route too
            yield from self._around_edges(question, query, route)
        yield from self._over_cells(question, query, plans)

    def _over_cells(self, question: Question, query: Floats, plans: tuple[Plan, ...]) -> Iterator[Batch]:
        """Yield what comes of routes that are searched for as plans say."""
        problem = question.problem
        told: dict[tuple[float, bool], int] = {}
        too_few: dict[float, int] = {}
        later: list[tuple[Plan, tuple[Floats, ...]]] = []
        for plan in plans:
            seconds = question.seconds_left()
            if seconds <= 0.0:
                return
            if plan.cells <= too_few.get(plan.cell, 0):
                continue
            found = self.find(problem, query, plan, seconds)
            if found.ended == FULL and not found.routes:
                too_few[plan.cell] = plan.cells
            known = told.get((plan.cell, plan.exact), 0)
            told[plan.cell, plan.exact] = max(known, len(found.routes))
            initial = self.fit(problem, found, known, question.seconds_left)
            closed = plan.cell if found.ended == PROVED_CLOSED else None
            routes = tuple(found.routes[known:][: len(initial)])
            yield _batch(initial, routes, closed=closed)
            if closed is not None:
                return
            finest = plan.cell == self.plans[-1].cell
            if question.several:
                later.append((plan, routes))
            else:
                yield from self._grown(question, plan, routes, ONE)
                if finest or plan.routes > 1:
                    yield from self._grown(question, plan, routes, FEW)
            if finest:  # coarser ones cut through walls
                yield from self._longer(problem, query, routes, question.seconds_left)
            yield _batch(initial[:0], (), then=max(plan.then, found.cells // CELLS_A_START))
            if not question.several and (finest or plan.routes > 1):
                yield from self._grown(question, plan, routes, MANY)
        for plan, routes in later:
            yield from self._grown(question, plan, routes, FEW)

    @property
    def single_plans(self) -> tuple[Plan, ...]:
        """Searches for one route, which prove nothing, from the quickest to the most thorough."""
        _, few, many, _ = CELLS
        coarse, fine = self.plans[0], self.plans[-1]
        first = coarser(coarse, min(self._robot.radii))
        among = ((first, few), (coarse, few), (fine, few), (coarse, many), (fine, many))
        plans = [plan._replace(cells=cells, routes=1, exact=False, prove=False) for plan, cells in among]
        return tuple(dict.fromkeys(plans))

    def along(self, question: Question, query: Floats, route: Floats) -> Iterator[Batch]:
        """Yield configurations along one route (K, 3), and along ones as long as the robot, bent to most sides."""
        initial = self.fit(question.problem, Found([route], 0, 0), 0, question.seconds_left)
        yield _batch(initial, (route,)[: len(initial)])
        yield from self._longer(question.problem, query, (route,), question.seconds_left)

    def query(self, problem: Problem) -> Floats | None:
        """Return what a route has to keep (28,), see `sinuous.kernels.tables`; `None`: no target has a position."""
        query = np.zeros(QUERY_WIDTH)
        asked = route_query(self._group, problem.scene._kernel_group, self._settings, problem._rows, query)
        return query if asked else None

    def find(self, problem: Problem, query: Floats, plan: Plan, seconds: float) -> Found:
        """Search for routes, as one plan says, for at most so many seconds."""
        planned = packing.plan_search(
            query,
            cell=plan.cell,
            clearance=plan.clearance,
            room=max(min(self._robot.radii), 0.5 * plan.cell),
            most_cells=plan.cells,
            exact=plan.exact,
            prove=plan.prove,
        )
        routes = np.empty((plan.routes, POINTS, 3))
        counts = np.zeros(plan.routes, np.int64)
        with MEMORY.borrow(memory_size(plan.cells)) as memory:
            group = problem.scene._kernel_group
            found, ended, cells = find_routes(group, planned, seconds, memory, routes, counts)
        lines = [route[:count] for route, count in zip(routes[:found], counts, strict=False)]
        return Found(lines, ended, cells)

    def by_edges(self, problem: Problem, query: Floats, seconds: float) -> Floats | None:
        """Return a route (K, 3) around edges, found in at most so many seconds; `None` proves nothing."""
        fine, radius = self.plans[-1], min(self._robot.radii)
        planned = packing.plan_search(
            query,
            cell=fine.cell,
            clearance=fine.clearance,
            room=max(radius, 0.5 * fine.cell),
            most_cells=0,
            exact=False,
            prove=False,
        )
        route = np.empty((POINTS, 3))
        with MEMORY.borrow(roadmap_size(POINTS)) as buffer:
            count = find_by_edges(
                problem.scene._kernel_group, planned, *walls_of(problem.scene), seconds, buffer, route
            )
        return route[:count] if count > 0 else None

    def fit(self, problem: Problem, found: Found, known: int, seconds_left: Callable[[], float]) -> Floats:
        """Return configurations (m, n, 3) along the routes, but for the first `known` ones, while there is time."""
        robot = self._robot
        sizes = len(robot), len(robot.actuation), len(problem.scene), len(problem.targets)
        workspace = np.empty(fit_workspace_size(*sizes, POINTS))
        fits = np.empty((max(0, len(found.routes) - known), len(robot), 3))
        groups = self._groups(problem)
        for i, (route, q) in enumerate(zip(found.routes[known:], fits, strict=True)):
            left = seconds_left()
            if left <= 0.0:
                return fits[:i]
            fit_route(*groups, route, left, workspace, q)
        return fits

    def load(self) -> float:
        """Compile the entries, or load them from the cache, where that is not done yet; return the seconds it took."""
        began = monotonic()
        problem, self._nowhere = self._nowhere, None
        if problem is not None:
            query = self.query(problem)
            if query is not None:
                self.find(problem, query, self.plans[0]._replace(cells=256), 0.0)
                self.by_edges(problem, query, 0.0)
                self.lengthen(problem, query, np.zeros((2, 3)), 0.0, 0.0)
            line = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
            self.fit(problem, Found([line], 0, 0), 0, lambda: 1.0)
            groups, still = self._groups(problem), np.zeros((len(self._robot), 3))
            grown(groups, line[None], FEW, 1.0)
            next(settled(groups, still[None], lambda: 1.0))
            turned_back(groups, groups, still)
        return monotonic() - began

    def lengthen(self, problem: Problem, query: Floats, route: Floats, side: float, seconds: float) -> Floats | None:
        """Return a route (K, 3) as long as the robot at its shortest, bent to a side (rad); `None` where none is."""
        rod, workspace = np.empty((ROD_POINTS, 3)), np.empty(lengthen_workspace_size(ROD_POINTS))
        group = problem.scene._kernel_group
        return rod if lengthen_route(group, query, np.array(route), side, seconds, workspace, rod) else None

    def _around_edges(self, question: Question, query: Floats, route: Floats) -> Iterator[Batch]:
        """Yield what comes of a route around edges: laid and grown along it, made longer; scattered starts."""
        fine = self.plans[-1]._replace(cells=CELLS[1])
        initial = self.fit(question.problem, Found([route], 0, 0), 0, question.seconds_left)
        routes = (route,)[: len(initial)]
        yield _batch(initial, routes)
        if not question.several:
            yield from self._grown(question, fine, routes, ONE)
            yield from self._grown(question, fine, routes, FEW)
        yield from self._longer(question.problem, query, routes, question.seconds_left)
        yield _batch(initial[:0], (), then=AFTER_EDGES)
        if not question.several:
            yield from self._grown(question, fine, routes, MANY)

    def _longer(
        self, problem: Problem, query: Floats, routes: tuple[Floats, ...], seconds_left: Callable[[], float]
    ) -> Iterator[Batch]:
        """Yield configurations along routes that were too short, one after the other: the first bent to most sides."""
        for i, route in enumerate(routes):
            misses = 0
            for side in SIDES if i == 0 else SIDES[:1]:
                seconds = seconds_left()
                longer = self.lengthen(problem, query, route, side, seconds) if seconds > 0.0 else None
                if longer is not None:
                    initial = self.fit(problem, Found([longer], 0, 0), 0, seconds_left)
                    yield _batch(initial, (longer,)[: len(initial)])
                elif (misses := misses + 1) == MISSES:
                    break

    def _grown(self, question: Question, plan: Plan, routes: tuple[Floats, ...], beam: Beam) -> Iterator[Batch]:
        """Yield chains that are grown along routes, along each from either end."""
        groups = self._groups(question.problem)
        for route in routes[:ALONG]:
            legs = self._legs(question, groups, route, plan)
            if legs is None:
                return
            for chain in self._chains(question, groups, legs, beam):
                yield _batch(chain[None], (route,))
            other = turned(groups, route)
            if other is None:
                continue
            for chain in self._chains(question, other, legs[:, ::-1].copy(), beam):
                yield _batch(turned_back(groups, other, chain)[None], (route,))

    def _chains(self, question: Question, groups: Groups, legs: Floats, beam: Beam) -> Iterator[Floats]:
        """Yield chains (n, 3) that are grown along legs (l, K, 3), as they are, then drawn to the targets."""
        seconds = question.seconds_left()
        chains = grown(groups, legs, beam, seconds) if seconds > 0.0 else legs[:0]
        yield from chains
        yield from settled(groups, chains, question.seconds_left)

    def _legs(self, question: Question, groups: Groups, route: Floats, plan: Plan) -> Floats | None:
        """Return the legs (l, K, 3) of a route from target to target; `None` where there is no route to one of them."""
        legs: list[Floats] = []
        for query in leg_queries(groups):
            if legs:
                gone_on(query, legs[-1])
            leg = self._leg(question, query, plan)
            if leg is None:
                return None
            legs.append(respaced(leg, LEG_POINTS))
        return np.stack(legs or [respaced(route, LEG_POINTS)])

    def _leg(self, question: Question, query: Floats, plan: Plan) -> Floats | None:
        """Return the route (K, 3) of one leg, around edges or as a plan says; `None` where none is found."""
        leg = self.by_edges(question.problem, query, max(0.0, question.seconds_left()))
        if leg is not None:
            return leg
        one = plan._replace(routes=1, prove=False)
        found = self.find(question.problem, query, one, max(0.0, question.seconds_left()))
        return found.routes[0] if found.routes else None

    def _groups(self, problem: Problem) -> Groups:
        return self._group, problem.scene._kernel_group, self._settings, problem._rows


def _batch(initial: Floats, routes: tuple[Floats, ...], then: int = 0, closed: float | None = None) -> Batch:
    """Configurations along routes, which are frozen."""
    for route in routes:
        route.setflags(write=False)
    return Batch(SOURCES[ROUTE], initial, then=then, closed=closed, routes=routes)
