"""The routes of one question, and what is made of each: chains that are fitted to it, grown along it, or led through.

What of this is tried, and in which order, is `solver.strategy`'s.
"""

from collections.abc import Collection, Iterator
from functools import cached_property
from itertools import compress
from typing import NamedTuple

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.tables import (
    FULL,
    POSE_POSITION,
    QUERY_FREE_LENGTH,
    QUERY_GOAL,
    QUERY_GOAL_RADIUS,
    QUERY_NORMAL,
    QUERY_RADIUS,
    QUERY_SHORTEST,
    ROUTE,
    SOURCES,
)
from sinuous.solver.attempts import IKQuery, StartBatch
from sinuous.solver.options import EDGES, SIDE_TUBES
from sinuous.solver.polylines import lengths_along, respaced
from sinuous.solver.routing.chains import TANGENT, BottleneckDecomposition, JoinedChains, find_terminal_poses
from sinuous.solver.routing.partial_chains import (
    FIRST_WIDTH,
    LEG_POINTS,
    divide_route,
    leg_queries,
    lengthen_route,
    set_route_end,
    straight_legs,
)
from sinuous.solver.routing.searches import CELLS, FoundRoutes, Searches, SearchPlan
from sinuous.solver.routing.tubes import chains_out_of_tube, find_tube_around, line_to_target_in_tube

CUT = 0.9
"""Distance from the obstacles, in radii of the body, below which a route over coarse cells may lead through a wall."""

TIGHT, ROOM = 10, 1.9
"""Percentage of a route that may be tight, and how far from the obstacles the rest is where it has room, in radii of
the body (rods, box duct)."""

ENDS = 0.04
"""Share of a route at either end of which that is not asked."""

STOWED = 1.1
"""Least length of a chain, in lengths of its route, from which on some of it has to be stowed beside the route."""

NEAR = 2.5
"""Distance from a route, in radii of the body, up to which it leads past an intermediate target."""

TABLES = 2
"""Sizes of tables that one search tries, from its own on."""


class RouteCandidate(NamedTuple):
    """A route, along which chains are made.

    Attributes
    ----------
    route : ndarray (K, 3)
    clear : bool
        Whether it is known not to lead through walls, as one over coarse cells may.
    rank : int
        How many were known before it, and one.
    weight : int
        One for itself, one where it is not clear, and one for each that was known before it and is as clear.
    """

    route: Floats
    clear: bool
    rank: int
    weight: int


class RouteCandidates:
    """The routes of one question.

    Parameters
    ----------
    searches : Searches
    question : IKQuery
    query : ndarray (QUERY_WIDTH,)
        What routes have to keep.
    without : collection of str
        Attempts that are switched off.

    Attributes
    ----------
    known : list of RouteCandidate
        In the order in which they were found.
    enclosed : bool
        Whether the base was found to lie in a tube that does not open.
    """

    def __init__(self, searches: Searches, question: IKQuery, query: Floats, without: Collection[str] = ()) -> None:
        self.searches, self.question, self.query = searches, question, query
        self.known: list[RouteCandidate] = []
        self.enclosed = False
        self._without, self._problem, self._deadline = without, question.problem, question.deadline
        self._groups = searches.groups(question.problem)
        self._bottlenecks: dict[int, BottleneckDecomposition] = {}
        self._chains: dict[int, JoinedChains] = {}
        self._legs: dict[int, Floats | None] = {}
        self._too_small: dict[float, int] = {}
        self._told: dict[float, int] = {}
        self._tried: set[bytes] = set()

    def chains_in_base_tube(self) -> Iterator[StartBatch]:
        """Yield chains along the tube that the base lies in, where there is one."""
        if self._groups[0][1] > 0.0:
            return  # limits of actuators join what is in the tube and what is not
        tube = find_tube_around(self._groups[1], self.query, self._deadline())
        self.enclosed = tube is not None and not tube.open
        line = None if tube is None else line_to_target_in_tube(tube, self.query)
        if line is not None:
            fitted = self.searches.fit(self._problem, [line], self._deadline)
            yield starts_along(fitted, (line,)[: len(fitted)])
        elif tube is not None and tube.open:
            for chain, route in chains_out_of_tube(tube, self._groups, self._deadline):
                yield starts_along(chain[None], (route,))

    def route_around_edges(self, query: Floats) -> Floats | None:
        """Return a route (K, 3) around edges; `None` where none is found."""
        off = EDGES in self._without or _is_planar(query)
        return None if off else self.searches.by_edges(self._problem, query, self._deadline())

    def route_through_side_tubes(self, query: Floats) -> Floats | None:
        """Return a route (K, 3) through tubes that open beside edges; `None` where none is found.

        Where the base lies in a closed tube, that one leads on.
        """
        off = SIDE_TUBES in self._without or self.enclosed or _is_planar(query)
        return None if off else self.searches.by_tubes(self._problem, query, self._deadline)

    def search_cells(self, plan: SearchPlan) -> FoundRoutes:
        """Search as a plan says; where a table is too small for a first route, with the next one at once.

        Returns what was found, with the cells of all tables, and without the routes that the same cells gave before.
        """
        found, cells = FoundRoutes([], FULL, 0), 0
        for size in CELLS[CELLS.index(plan.cells) :][:TABLES]:
            if size <= self._too_small.get(plan.cell, 0):
                continue
            seconds = self._deadline()
            found = self.searches.find(self._problem, self.query, plan._replace(cells=size), seconds)
            cells += found.cells
            if found.ended != FULL or found.routes:
                break
            self._too_small[plan.cell] = size
            if self.any_clear:
                break
        told = self._told.get(plan.cell, 0)
        self._told[plan.cell] = max(told, len(found.routes))
        return found._replace(routes=found.routes[told:], cells=cells)

    def add_route(self, route: Floats, finest: bool) -> RouteCandidate:
        """Take a route as a candidate.

        `finest`: it leads around edges, or over the finest cells, and needs no look whether it is clear.
        """
        clear = finest or self._clear(route, self.query)
        weight = 1 + (not clear) + sum(other.clear >= clear for other in self.known)
        if self._problem.scene.is_crowded and not self._has_room(route):
            weight += 1
        self.known.append(RouteCandidate(route, clear, 1 + len(self.known), weight))
        return self.known[-1]

    @property
    def has_tool(self) -> bool:
        """Whether the backbone ends away from the target, and it is not said where."""
        return bool(self.query[QUERY_GOAL_RADIUS] > 0.0)

    def route_to_terminal_pose(self, number: int) -> Floats | None:
        """Return a route (K, 3) to a pose in which the backbone may end: number `number`, those with most room first.

        Where a tool leaves open where that is, a route to the target ends somewhere about it, also beyond a wall. A
        first route has to be known.
        """
        if number >= len(self._terminal_poses):
            return None
        query, terminal_pose = self.query.copy(), self._terminal_poses[number]
        query[QUERY_GOAL_RADIUS] = 0.0
        set_route_end(query, terminal_pose[POSE_POSITION:], -terminal_pose[TANGENT])
        return self._leg(query)

    @cached_property
    def _terminal_poses(self) -> Floats:
        """Poses (r, 12) in which the backbone may end, best first, for the first route; see `find_terminal_poses`."""
        return find_terminal_poses(self._groups, self.known[0].route)

    def is_longer_than(self, route: Floats) -> bool:
        """Whether a chain has to be much longer than a route (K, 3): it is seldom clear where it is fitted."""
        return bool(self.query[QUERY_SHORTEST] > STOWED * lengths_along(route)[-1])

    def fitted_chains(self, routes: list[Floats]) -> Iterator[StartBatch]:
        """Yield configurations along routes (K, 3)."""
        fits = self.searches.fit(self._problem, routes, self._deadline)
        new = np.array([self._is_new(q) for q in fits], bool)
        yield starts_along(fits[new], tuple(compress(routes, new)))

    def grown_chains(self, candidate: RouteCandidate, width: int) -> Iterator[StartBatch]:
        """Yield chains that are grown along a route from both ends, by beams of a width, and joined."""
        legs = self.legs_of(candidate)
        if legs is None:
            return
        yield self._nothing()
        if candidate.rank not in self._chains:
            self._chains[candidate.rank] = JoinedChains(self._groups, legs, self._deadline)
        joined = self._chains[candidate.rank]
        quick = width == FIRST_WIDTH and self._problem.scene.is_crowded  # others are tried before the rest
        for chain in joined.chains_past_all_targets(width) if quick else joined.chains_of_width(width):
            if self._is_new(chain):
                yield starts_along(chain[None], (candidate.route,))

    def chains_that_meet(self, width: int) -> Iterator[StartBatch]:
        """Yield chains that are grown from both ends without a route, by beams of a width, where they nearly meet."""
        yield self._nothing()
        for chain in self._unguided.chains_that_meet(width):
            yield starts_along(chain[None], ())

    @cached_property
    def _unguided(self) -> JoinedChains:
        return JoinedChains(self._groups, straight_legs(self._groups), self._deadline)

    def detour_chains(self, candidate: RouteCandidate, number: int) -> Iterator[StartBatch]:
        """Yield chains along a route that is led aside until it is as long as the robot, by the least beams."""
        legs = self.legs_of(candidate)
        longer = None if legs is None else lengthen_route(self._groups, legs, number, self._deadline)
        if longer is None:
            return
        route = np.concatenate([longer[0], *longer[1:, 1:]])
        if self._problem.scene.is_crowded and not self._clear(route, self.query):
            return  # among very many obstacles lines of sight lead through gaps that are too narrow
        yield self._nothing()
        for chain in JoinedChains(self._groups, longer, self._deadline).chains_past_all_targets(FIRST_WIDTH):
            if self._is_new(chain):
                yield starts_along(chain[None], (route,))

    def bottleneck_chains(self, candidate: RouteCandidate, starts: int) -> Iterator[StartBatch]:
        """Yield chains through the narrowest place of a route, of which each half is solved by itself."""
        legs = self.legs_of(candidate)
        if legs is None or not candidate.clear:
            return
        if candidate.rank not in self._bottlenecks:
            widths = np.stack([self.searches.widths_across(self._problem, leg) for leg in legs])
            self._bottlenecks[candidate.rank] = BottleneckDecomposition(self._groups, legs, widths)
        if not self._bottlenecks[candidate.rank].any:
            return
        yield self._nothing()
        for chain in self._bottlenecks[candidate.rank].chains(starts, self._deadline):
            if self._is_new(chain):
                yield starts_along(chain[None], (candidate.route,))

    @property
    def any_clear(self) -> bool:
        """Whether a clear route is known."""
        return any(candidate.clear for candidate in self.known)

    def _clear(self, route: Floats, query: Floats) -> bool:
        """Whether a route (K, 3) keeps away from walls, and near its ends, where it may be narrow, out of them.

        Neither what is within the mount nor what is nearer to the target than the tool is long concerns the backbone.
        """
        away = np.linalg.norm(route - query[QUERY_GOAL : QUERY_GOAL + 3], axis=1) >= query[QUERY_GOAL_RADIUS]
        concerned = route[away & (lengths_along(route) >= query[QUERY_FREE_LENGTH])]
        distances, skipped = self.searches.distances(self._problem, concerned), max(1, round(ENDS * len(concerned)))
        least = distances[skipped:-skipped].min(initial=np.inf)
        return bool(least > CUT * query[QUERY_RADIUS] and distances.min(initial=np.inf) > 0.0)

    def _has_room(self, route: Floats) -> bool:
        """Whether a route (K, 3) leaves room about the body nearly everywhere, so that the body can follow it."""
        distances = self.searches.distances(self._problem, route)
        return bool(np.percentile(distances, TIGHT) > ROOM * self.query[QUERY_RADIUS])

    def _nothing(self) -> StartBatch:
        """A batch without any start."""
        return starts_along(np.empty((0, int(self._groups[0][0]), 3)), ())

    def _is_new(self, chain: Floats) -> bool:
        """Say whether a chain (n, 3) did not come before."""
        key = chain.tobytes()
        new = key not in self._tried
        self._tried.add(key)
        return new

    def legs_of(self, candidate: RouteCandidate) -> Floats | None:
        """Return the legs (l, K, 3) of a route from target to target; `None` where there is no route to one of them."""
        if candidate.rank not in self._legs:
            self._legs[candidate.rank] = self._made_legs(candidate)
        return self._legs[candidate.rank]

    def _made_legs(self, candidate: RouteCandidate) -> Floats | None:
        legs = divide_route(self._groups, candidate.route, NEAR * self.query[QUERY_RADIUS])
        if legs is not None:
            return legs
        return self._found_legs

    @cached_property
    def _found_legs(self) -> Floats | None:
        """Legs (l, K, 3) that are searched for one by one; `None` where one is not found."""
        legs: list[Floats] = []
        for query in leg_queries(self._groups):
            leg = self._leg(query)
            if leg is None:
                return None
            legs.append(respaced(leg, LEG_POINTS))
        return np.stack(legs)

    def _leg(self, query: Floats) -> Floats | None:
        """Return the route (K, 3) of one leg (QUERY_WIDTH,), around edges or over cells; `None` where none is found.

        Over cells the first that is clear; where none is, the last.
        """
        leg = self.route_around_edges(query)
        leg = self.route_through_side_tubes(query) if leg is None else leg
        for plan in self.searches.leg_plans if leg is None else ():
            found = self.searches.find(self._problem, query, plan, self._deadline())
            leg = found.routes[0] if found.routes else leg
            if leg is not None and self._clear(leg, query):
                break
        return leg


def _is_planar(query: Floats) -> bool:
    """Whether routes have to stay in a plane: those around edges and through side tubes leave it."""
    return bool(query[QUERY_NORMAL : QUERY_NORMAL + 3].any())


def starts_along(
    initial: Floats, routes: tuple[Floats, ...], effort: float = 0.0, closed: float | None = None
) -> StartBatch:
    """Configurations along routes, which are frozen."""
    for route in routes:
        route.setflags(write=False)
    return StartBatch(SOURCES[ROUTE], initial, effort=effort, closed=closed, routes=routes)
