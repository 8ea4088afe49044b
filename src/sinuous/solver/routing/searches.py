"""Searches for routes through free space from the base to a target, and the chain along them."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from copy import copy
from typing import ClassVar, NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels import packing
from sinuous.kernels.fitting.lines import distances_along, widths_across
from sinuous.kernels.fitting.query import ball_radius
from sinuous.kernels.freespace.cells import memory_size
from sinuous.kernels.freespace.find import find_routes
from sinuous.kernels.freespace.grid import HALF_DIAGONAL
from sinuous.kernels.roadmap.find import find_by_edges, roadmap_size
from sinuous.kernels.tables import MANY_OBSTACLES, MAX_LENGTH, QUERY_FREE_LENGTH, QUERY_RADIUS, QUERY_SHORTEST
from sinuous.kernels.tubes import MOUTH
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Problem, settings_group
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Box
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.attempts import Deadline
from sinuous.solver.route_classes.curves import RouteCurves
from sinuous.solver.routing.chains import WIDE
from sinuous.solver.routing.partial_chains import (
    FIRST_WIDTH,
    LEG_POINTS,
    Groups,
    GrownChains,
    fit_chain,
    lengthen_route,
    problem_beyond,
    query_of,
    reverse_chain,
    segments_in,
    settle_chains,
)
from sinuous.solver.routing.tubes import (
    SharpWalls,
    Tube,
    chains_out_of_tube,
    find_tube_around,
    rims_of,
    route_through,
    tubes_beside,
    walls_of,
)


class BufferPool:
    """Buffers of numbers that threads take and give back.

    There are at most as many buffers as computations that run at once. After them, a few are kept: no more than `most`,
    none larger than `largest`. So an idle process holds at most `8 * most * largest` bytes.

    Parameters
    ----------
    most : int
        Buffers that are kept.
    largest : int
        Numbers (float64) of the largest one that is kept.
    """

    def __init__(self, most: int, largest: int) -> None:
        self._most, self._largest = most, largest
        self._kept: list[Floats] = []  # no lock, which a fork could leave closed: append and pop are atomic

    @contextmanager
    def borrow(self, size: int) -> Iterator[Floats]:
        """Lend a buffer of at least `size` numbers, with anything in it."""
        buffer = self._take(size) if size <= self._largest else np.empty(size)
        try:
            yield buffer
        finally:
            if len(buffer) <= self._largest and len(self._kept) < self._most:
                self._kept.append(buffer)

    def _take(self, size: int) -> Floats:
        """One that was given back, if it is large enough; a smaller one is replaced."""
        try:
            buffer = self._kept.pop()
        except IndexError:
            return np.empty(size)
        return buffer if len(buffer) >= size else np.empty(size)


COARSE = 64
"""Finest cells in the length of the longest robot, at most, at first."""

CELLS = (1 << 14, 1 << 17, 1 << 19)
"""Most cells of a search, by blocks of eight of which some nobody looks at."""

POINTS = 1024
"""Most points of a route."""

ROUNDING = 1e-9
"""By what share of its mount a body must be longer at least to end beyond it for certain."""

MEMORY = BufferPool(most=2, largest=memory_size(CELLS[1]))
"""What all searches of this process work in. A search takes 118 bytes a cell and 0.2 MB: 16 MB at most in the last but
one size, 62 MB in the largest. The largest is not kept after the search; of the others two are."""


class SearchPlan(NamedTuple):
    """One search.

    Attributes
    ----------
    cell : float
        Edge of the cells.
    clearance : float
        Distance from the obstacles with which a cell can be passed.
    cells : int
        Most cells that are looked at.
    routes : int
        Most routes to find.
    prove : bool
        Whether to prove that there is none, where none is found.
    """

    cell: float
    clearance: float
    cells: int
    routes: int
    prove: bool


class FoundRoutes(NamedTuple):
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


class Searches:
    """Searches for routes, and chains along them, for one robot; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance

    Attributes
    ----------
    robot : Robot
    radius : float
        Of the ball that routes are found for.
    coarse, middle, fine : SearchPlan
        The quickest searches with coarse cells, with smaller ones, and with fine ones.
    proves : bool
        Whether fine cells prove that a room is closed: where no segment is thinner than the ball.
    """

    loaded: ClassVar[bool] = False
    """Whether what they call is compiled, or loaded, in this process."""

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance) -> None:
        self.robot, self._scene, self._tolerance = robot, scene, tolerance
        self._group, self._settings = robot_group(robot), settings_group(robot, tolerance)
        self._walls: tuple[Snapshot, SharpWalls] | None = None
        self._root: Floats | None = None
        self.radius = ball_radius(segments_in(self._group))
        self._longest = sum(segment.length[1] for segment in robot.segments)
        self.coarse, self.middle, self.fine = _plans_of(self.radius, self._longest)
        self.proves = min(robot.needed_radii) >= self.radius

    def at(self, root: Floats) -> "Searches":
        """Return the same for what is left of the robot, where the chain (k, 3) of its first rows ends."""
        other, rest = copy(self), segments_in(self._group)[len(root) :]
        other._root, other.radius, other._longest = root, ball_radius(rest), float(rest[:, MAX_LENGTH].sum())
        other.coarse, other.middle, other.fine = _plans_of(other.radius, other._longest)
        other.proves = False  # another root may be where there is a route
        return other

    @property
    def single_plans(self) -> tuple[SearchPlan, ...]:
        """Searches for one route, which prove nothing, from the quickest to the most thorough."""
        few, many, _ = CELLS
        coarse, fine = self.coarse, self.fine
        edge = 2.0 * coarse.cell
        first = coarse._replace(cell=edge, clearance=_wide_enough(self.radius, edge))
        among = ((first, few), (coarse, few), (fine, few), (coarse, many), (fine, many))
        plans = [plan._replace(cells=cells) for plan, cells in among]
        return tuple(dict.fromkeys(plans))

    @property
    def leg_plans(self) -> tuple[SearchPlan, ...]:
        """Searches for the route from one target to the next, from the quickest to the most thorough."""
        many = CELLS[1]
        plans = self.coarse, self.middle, self.fine, self.fine._replace(cells=many)
        return tuple(dict.fromkeys(plans))

    def list_near(self, problem: Problem) -> None:
        """Have it noted who is near, where there are very many obstacles: see `Snapshot.list_near`."""
        problem.scene.list_near(self.robot.base[:3, 3], self._longest, self.radius)

    def query(self, problem: Problem) -> Floats | None:
        """Return what a route has to keep (QUERY_WIDTH,); see `query_of`."""
        return query_of(self.groups(problem))

    def find(self, problem: Problem, query: Floats, plan: SearchPlan, seconds: float) -> FoundRoutes:
        """Search for routes, as one plan says, for at most so many seconds.

        Obstacles do not concern the backbone within its mount. Where the body can be so short that its end lies there,
        it may stand in an obstacle, and that no free cell leads to it proves nothing.
        """
        planned = packing.plan_search(
            query,
            cell=plan.cell,
            clearance=plan.clearance,
            free_margin=max(self.radius, 0.5 * plan.cell),
            most_cells=plan.cells,
            prove=plan.prove and query[QUERY_SHORTEST] > (1.0 + ROUNDING) * query[QUERY_FREE_LENGTH],
        )
        routes = np.empty((plan.routes, POINTS, 3))
        counts = np.zeros(plan.routes, np.int64)
        with MEMORY.borrow(memory_size(plan.cells)) as memory:
            group = problem.scene._kernel_group
            found, ended, cells = find_routes(group, planned, seconds, memory, routes, counts)
        lines = [route[:count] for route, count in zip(routes[:found], counts, strict=False)]
        return FoundRoutes(lines, ended, cells)

    def by_edges(self, problem: Problem, query: Floats, seconds: float) -> Floats | None:
        """Return a route (K, 3) around edges, found in at most so many seconds; `None` proves nothing."""
        fine = self.fine
        planned = packing.plan_search(
            query,
            cell=fine.cell,
            clearance=fine.clearance,
            free_margin=max(self.radius, 0.5 * fine.cell),
            most_cells=0,
            prove=False,
        )
        route = np.empty((POINTS, 3))
        with MEMORY.borrow(roadmap_size(POINTS)) as buffer:
            count = find_by_edges(
                problem.scene._kernel_group, planned, *self._walls_of(problem.scene), seconds, buffer, route
            )
        return route[:count] if count > 0 else None

    def _walls_of(self, scene: Snapshot) -> SharpWalls:
        """What is sharp-edged in a scene, looked for once."""
        known = self._walls
        if known is None or known[0] is not scene:
            known = self._walls = scene, walls_of(scene)
        return known[1]

    def only_balls(self, problem: Problem) -> bool:
        """Whether all obstacles are such as balls and capsules: nothing is enclosed, and nothing has edges."""
        return not any(obstacle.has_edges or obstacle.inside for obstacle in problem.scene.obstacles)

    def by_tubes(self, problem: Problem, query: Floats, deadline: Deadline) -> Floats | None:
        """Return a route (K, 3) around edges and through tubes that open beside them; `None` proves nothing."""
        group, edges = problem.scene._kernel_group, rims_of(problem.scene)
        axes = tubes_beside(group, edges, query[QUERY_RADIUS], deadline())
        if not axes:
            return None

        def leg(asked: Floats) -> Floats | None:
            return self.by_edges(problem, asked, deadline())

        def last(asked: Floats) -> Floats | None:
            route = leg(asked)
            if route is None:
                found = self.find(problem, asked, self.fine, deadline())
                route = found.routes[0] if found.routes else None
            return route

        return route_through(axes, query, leg, last, POINTS)

    def fit(self, problem: Problem, routes: Sequence[Floats], deadline: Deadline) -> Floats:
        """Return configurations (m, n, 3) along routes (K, 3)."""
        groups, fits = self.groups(problem), list[Floats]()
        for route in routes:
            fits.append(fit_chain(groups, route, deadline()))
        return np.array(fits).reshape(-1, int(groups[0][0]), 3)

    def load(self, *, anew: bool = False) -> None:
        """Use the entries once, so that they are compiled, or read from the store, where that is not done yet."""
        if self.robot.joints and self._root is None:
            self.at(np.zeros((len(self.robot) - len(self.robot.segments), 3))).load(anew=anew)
        elif anew or not Searches.loaded:
            Searches.loaded = True
            problem = Problem.prepared(self.robot, (Target((0.0, 0.0, 0.0)),), self._scene.snapshot(), self._tolerance)
            query = self.query(problem)
            if query is not None:
                self.find(problem, query, self.coarse._replace(cells=256), 0.0)
                self.by_edges(problem, query, 0.0)
            line = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
            self.fit(problem, [line], lambda: 1.0)
            self.distances(problem, line)
            self.widths_across(problem, line)
            groups = self.groups(problem)
            still = np.zeros((int(groups[0][0]), 3))
            base = packing.robot_parts(groups[0]).base[None].copy()
            GrownChains(groups, line[None], base, FIRST_WIDTH, 1.0)
            lengthen_route(groups, np.linspace(line[0], line[1], LEG_POINTS)[None], 0, lambda: 0.0)
            next(settle_chains(groups, still[None], lambda: 1.0))
            reverse_chain(groups, groups, still)
            if query is not None:
                find_tube_around(problem.scene._kernel_group, query, 0.0)
            next(chains_out_of_tube(Tube(0.01 * line, MOUTH), groups, lambda: 1.0), None)
            problem_beyond(groups, still[:1])
            tubes_beside(groups[1], rims_of(problem.scene), 1.0, 0.0)
            RouteCurves(self.robot, problem.scene).load()
            row = tuple(Box((3.0 * i, 0.0, 0.0), (1.0, 1.0, 1.0)) for i in range(MANY_OBSTACLES))
            Snapshot(row).list_near(np.zeros(3), 1.0, 1.0)

    def distances(self, problem: Problem, points: Floats) -> Floats:
        """Return distances (K,) of points (K, 3) from the obstacles; far ones may be any beyond `WIDE` radii."""
        points, distances = points.copy(), np.empty(len(points))  # routes that were told are read-only: another type
        distances_along(
            problem.scene._kernel_group, points, WIDE * max(self.radius, *self.robot.needed_radii), distances
        )
        return distances

    def widths_across(self, problem: Problem, line: Floats) -> Floats:
        """Return the greatest distance (K,) from the obstacles across a line (K, 3); any beyond `WIDE` radii."""
        widths = np.empty(len(line))
        widths_across(problem.scene._kernel_group, line, self.radius, WIDE * self.radius, widths)
        return widths

    def groups(self, problem: Problem) -> Groups:
        """Return what entries are given of a problem."""
        groups = self._group, problem.scene._kernel_group, self._settings, problem._rows
        return groups if self._root is None else problem_beyond(groups, self._root)


def _wide_enough(radius: float, cell: float) -> float:
    """Clearance with which coarse cells can be passed."""
    return max(radius - 0.5 * cell, 0.25 * radius)


def _plans_of(radius: float, length: float) -> tuple[SearchPlan, SearchPlan, SearchPlan]:
    """Searches for one route with coarse, middle and fine cells, for a ball of this radius and a robot of this length.

    Cells of half the radius and less cannot leak through a wall, however thin it is. Coarser ones miss narrow passages.
    """
    fine = 0.5 * radius
    coarse = max(fine, length / COARSE)

    def plan(cell: float) -> SearchPlan:
        clearance = _wide_enough(radius, cell) if cell > fine else radius - HALF_DIAGONAL * fine
        return SearchPlan(cell, clearance, CELLS[0], 1, False)

    return plan(coarse), plan(math.sqrt(coarse * fine)), plan(fine)
