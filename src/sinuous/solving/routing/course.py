"""What is tried along the routes of one question, and when: what costs little first, for every route."""

import heapq
from collections.abc import Iterator
from functools import partial
from itertools import compress

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import FULL, PROVED_CLOSED, QUERY_RADIUS, QUERY_SHORTEST, ROUTE, SOURCES
from sinuous.solving.polylines import lengths_along, respaced
from sinuous.solving.routing.growth import FEW, GLANCE, LEG_POINTS, Beam, divided, gone_on, grown, leg_queries, settled
from sinuous.solving.routing.narrow.narrows import Narrows
from sinuous.solving.routing.plans import BENT, CELLS, GATES, GROWN, Chore, Line, Plan, Task, chores_of
from sinuous.solving.routing.searches import SIDES, Found, Searches
from sinuous.solving.routing.tubes import out_of, tube_around, within
from sinuous.solving.routing.turned import Groups, turned, turned_back
from sinuous.solving.starts.sources import Batch, Question

CELLS_A_START = 400
"""Cells that a search looks at in the time of a scattered start, about."""

FIRST = 3
"""Scattered starts before any search, where that takes longer: beside meshes, unless these enclose the base, and where
nothing has edges."""

AFTER_EDGES = (5, 10)
"""Scattered starts that follow a route around edges: after what is tried `AT_ONCE`, and after `SOON`."""

AT_ONCE, SOON = 6, 14
"""What may be tried along such a route before the next scattered starts, in starts."""

SHARE, AMONG_BALLS = 0.6, 2.0
"""Scattered starts for each one that the work along routes costs: as a rule; and among balls alone, which enclose
nothing, so that chains along a route are hardly better than scattered ones, and dearer than they are said to be."""

CUT = 0.9
"""Room, in radii of the body, up to which a route over coarse cells may lead through a wall."""

ALONG = 2
"""Routes of one search along which chains are grown; through gates of the first one alone."""

STOWED = 1.1
"""Least length of a chain, in lengths of its route, from which on some of it has to be stowed beside the route."""

MISSES = 2
"""Sides for which nothing comes of it, before others are no longer tried."""

NEAR = 2.5
"""Distance from a route, in radii of the body, up to which it leads past an elbow."""

ALIKE, COMPARED = 0.1, 60
"""Distance of two routes, in radii of the body, up to which they are much the same; and points that are compared."""


class Course:
    """The order of all that is tried along routes, for one question.

    Parameters
    ----------
    searches : Searches
    question : Question
    query : ndarray (28,)
        What routes have to keep.
    """

    def __init__(self, searches: Searches, question: Question, query: Floats) -> None:
        self._searches, self._question, self._query = searches, question, query
        self._problem = question.problem
        self._groups = searches.groups(question.problem)
        self._lines: list[Line] = []
        self._tasks: list[Task] = []
        self._spent, self._enclosed = 0, False
        self._share = AMONG_BALLS if searches.only_balls(question.problem) else SHARE
        self._between = next((plan for plan in searches.plans if plan.between), None)
        self._misses: dict[int, int] = {}
        self._legs: dict[int, Floats | None] = {}
        self._found_legs: dict[bool, Floats | None] = {}
        looks = partial(searches.room, question.problem), partial(searches.beside, question.problem)
        self._narrows = Narrows(self._groups, *looks, question.seconds_left)
        self._tried: set[bytes] = set()

    def batches(self) -> Iterator[Batch]:
        """Yield what comes of the tube that the base lies in, of a route around edges, then of those over cells."""
        if not self._question.several:
            yield from self._tube()
        if self._question.seconds_left() > 0.0 and not (self._enclosed or self._searches.edges_first(self._problem)):
            yield self._scattered(FIRST)
        plans, route = self._searches.plans, self._around(self._query)
        if route is not None:
            plans = tuple(plan for plan in plans if plan.routes > 1)  # the others look for one route too
            yield from self._laid([route], finest=True)
            yield from self._try(AT_ONCE)
            yield self._scattered(AFTER_EDGES[0])
            yield from self._try(SOON)
            yield self._scattered(AFTER_EDGES[1])
        told: dict[tuple[float, bool], int] = {}
        too_few: dict[float, int] = {}
        for plan in plans:
            if self._question.seconds_left() <= 0.0:
                return
            if plan.cells <= too_few.get(plan.cell, 0) or (plan.between and self._lines):
                continue
            self._between = None if plan.between else self._between
            last, found = self._find(plan, too_few)
            known = told.get((last.cell, last.exact), 0)
            told[last.cell, last.exact] = max(known, len(found.routes))
            closed = last.cell if found.ended == PROVED_CLOSED else None
            yield from self._laid(found.routes[known:], last.cell == self._searches.plans[-1].cell, last.exact, closed)
            if closed is not None:
                return
            yield from self._try(last.effort)
            yield self._scattered(max(last.then, found.cells // CELLS_A_START))
        yield from self._try(None)

    def _tube(self) -> Iterator[Batch]:
        """Yield chains along the tube that the base lies in, where there is one."""
        if self._groups[0][1] > 0.0 or self._question.seconds_left() <= 0.0:
            return  # limits of actuators join what is in the tube and what is not
        tube = tube_around(self._groups[1], self._query, self._question.seconds_left())
        self._enclosed = tube is not None and not tube.open
        line = None if tube is None else within(tube, self._query)
        if line is not None:
            laid = self._searches.fit(self._problem, [line], self._question.seconds_left)
            yield along(laid, (line,)[: len(laid)])
        elif tube is not None and tube.open:
            for chain, route in out_of(tube, self._groups, self._question.seconds_left):
                yield along(chain[None], (route,))

    def bent(self, route: Floats) -> Iterator[Batch]:
        """Yield configurations along one route (K, 3), and along ones as long as the robot, bent to most sides."""
        yield from self._laid([route], finest=True)
        for line in self._lines:
            for side in range(len(SIDES)):
                yield from self._longer(line, side)

    def _around(self, query: Floats) -> Floats | None:
        """Return a route (K, 3) around edges, else one through tubes beside them; `None` where neither is found."""
        left, searches = self._question.seconds_left, self._searches
        route = searches.by_edges(self._problem, query, left()) if left() > 0.0 else None
        if route is None and left() > 0.0 and not self._enclosed:  # where the base lies in a tube, that one leads on
            route = searches.by_tubes(self._problem, query, left)
        return route

    def _find(self, plan: Plan, too_few: dict[float, int]) -> tuple[Plan, Found]:
        """Search as a plan says; where its table is too small for a first route, with others at once.

        These are the plan between coarse and fine cells, if it was left out, and then the next larger tables. Returns
        the last plan, too.
        """
        cells = 0
        while True:
            found = self._found(self._query, plan)
            cells += found.cells
            if found.ended != FULL or found.routes:
                return plan, found._replace(cells=cells)
            too_few[plan.cell] = plan.cells
            if self._through_free():
                return plan, found._replace(cells=cells)
            between, self._between = self._between, None
            if between is not None and between.cell > plan.cell:
                other = self._found(self._query, between)
                cells += other.cells
                if other.routes:
                    return between, other._replace(cells=cells)
            larger = [size for size in CELLS[:-1] if size > plan.cells]
            if not larger:
                return plan, found._replace(cells=cells)
            plan = plan._replace(cells=larger[0])

    def _found(self, query: Floats, plan: Plan) -> Found:
        """Search as a plan says, in the time that is left."""
        return self._searches.find(self._problem, query, plan, max(0.0, self._question.seconds_left()))

    def _through_free(self) -> bool:
        """Whether a line is known that does not cut through walls."""
        return any(line.finest or self._room(line) > CUT for line in self._lines)

    def _laid(
        self, routes: list[Floats], finest: bool, exact: bool = False, closed: float | None = None
    ) -> Iterator[Batch]:
        """Note what is to be tried along routes (K, 3), and yield configurations along them.

        A chain that is longer than the route is seldom clear where it is laid: what leads through gates comes before.
        """
        for place, route in enumerate(routes):
            self._note(route, finest, exact, place)
        if routes and self._query[QUERY_SHORTEST] > STOWED * lengths_along(routes[0])[-1]:
            yield from self._try(GATES[GLANCE])
        laid = self._searches.fit(self._problem, routes, self._question.seconds_left)
        new = np.array([self._is_new(q) for q in laid], bool)
        yield along(laid[new], tuple(compress(routes, new)), closed=closed)

    def _note(self, route: Floats, finest: bool, exact: bool = False, place: int = 0) -> None:
        """Note what is to be tried along a route, unless one of its kind is known: it is number `place` of a search."""
        near = ALIKE * self._query[QUERY_RADIUS]
        points = respaced(route, COMPARED) if self._lines else route
        alike = [
            line
            for line in self._lines
            if line.exact >= exact and np.linalg.norm(respaced(line.route, COMPARED) - points, axis=1).max() < near
        ]
        if any(line.finest >= finest for line in alike):
            return
        first = not any(line.finest for line in self._lines)
        weight = 1 + sum(line.finest >= finest for line in self._lines)
        line = Line(route, finest, exact, 1 + len(self._lines), weight)
        self._lines.append(line)
        sides = (len(SIDES) if line.rank == 1 or first else 1) if finest else 0
        self._add(line, chores_of(not alike and place < ALONG, place == 0, finest, sides), 0)

    def _add(self, line: Line, chores: tuple[Chore, ...], number: int) -> None:
        """Note that of these chores along a line this one is the next, if there is one."""
        if number < len(chores):
            heapq.heappush(self._tasks, Task(chores[number].cost * line.weight, line.rank, number, line, chores))

    def _try(self, effort: int | None) -> Iterator[Batch]:
        """Yield what comes of all tasks that cost no more than an effort (`None`: any), the cheapest first.

        Where several solutions are wanted chains are grown at last, because those along one route are much alike.
        """
        put_off: list[Task] = []
        while self._tasks and (effort is None or self._tasks[0].cost <= effort):
            if self._question.seconds_left() <= 0.0:
                return
            task = heapq.heappop(self._tasks)
            _, beam, which = task.chores[task.number]
            self._add(task.line, task.chores, task.number + 1)
            if beam is None:
                yield from self._longer(task.line, which)
            elif self._question.several and effort is not None:
                put_off.append(task._replace(chores=task.chores[: task.number + 1]))
            elif not self._question.several or beam == FEW:
                yield from self._grown(task.line, beam, which)
        for task in put_off:
            heapq.heappush(self._tasks, task)

    def _scattered(self, least: int) -> Batch:
        """No start, and scattered ones after it: so many, or more after dear tasks."""
        then, self._spent = max(least, round(self._share * self._spent)), 0
        return along(np.empty((0, len(self._problem.robot), 3)), (), then=then)

    def _longer(self, line: Line, side: int) -> Iterator[Batch]:
        """Yield a configuration along a line that is as long as the robot, bent to one side, where there is room."""
        seconds = self._question.seconds_left()
        if seconds <= 0.0 or self._misses.get(line.rank, 0) >= MISSES:
            return
        self._spent += BENT[side]
        longer = self._searches.lengthen(self._problem, self._query, line.route, SIDES[side], seconds)
        if longer is None:
            self._misses[line.rank] = self._misses.get(line.rank, 0) + 1
            return
        initial = self._searches.fit(self._problem, [longer], self._question.seconds_left)
        yield along(initial, (longer,)[: len(initial)])

    def _grown(self, line: Line, beam: Beam, gate: int) -> Iterator[Batch]:
        """Yield chains that are grown along a line: through a gate, or (-1) from either end."""
        legs = self._legs_of(line)
        if legs is None:
            return
        if gate >= 0:
            yield from self._through(line, legs, beam, gate)
            return
        self._spent += GROWN[beam]
        for chain in self._chains(self._groups, legs, beam):
            yield along(chain[None], (line.route,))
        other = turned(self._groups, line.route)
        if other is None:
            return
        for chain in self._chains(other, legs[:, ::-1].copy(), beam):
            yield along(turned_back(self._groups, other, chain)[None], (line.route,))

    def _through(self, line: Line, legs: Floats, beam: Beam, number: int) -> Iterator[Batch]:
        """Yield chains through the narrowest place of a line, of which each part is solved by itself."""
        if not (line.finest or self._room(line) > CUT):
            return
        crossing = self._narrows.crossing(line.rank, legs)
        if number >= len(crossing):
            return
        self._spent += GATES[beam]
        for chain in crossing.chains(number, beam, self._question.seconds_left):
            if self._is_new(chain):
                yield along(chain[None], (line.route,))

    def _room(self, line: Line) -> float:
        """Distance from the obstacles that a line keeps, in radii of the body."""
        legs = self._legs_of(line)
        return 0.0 if legs is None else self._narrows.room(line.rank, legs)

    def _chains(self, groups: Groups, legs: Floats, beam: Beam) -> Iterator[Floats]:
        """Yield chains (n, 3) that grown along legs (l, K, 3), as they are, then drawn to the targets; none twice."""
        seconds = self._question.seconds_left()
        if seconds <= 0.0 or not self._is_new(legs, groups[3], np.array(beam)):
            return
        chains = grown(groups, legs, beam, seconds)
        new = [chain for chain in chains if self._is_new(chain)]
        yield from new
        yield from filter(self._is_new, settled(groups, new, self._question.seconds_left))

    def _is_new(self, *what: Floats) -> bool:
        """Say whether something, a chain (n, 3) or what chains are grown along, did not come before."""
        key = b"".join(array.tobytes() for array in what)
        new = key not in self._tried
        self._tried.add(key)
        return new

    def _legs_of(self, line: Line) -> Floats | None:
        """Return the legs (l, K, 3) of a line from target to target; `None` where there is no route to one of them."""
        if line.rank not in self._legs:
            self._legs[line.rank] = self._made_legs(line)
        return self._legs[line.rank]

    def _made_legs(self, line: Line) -> Floats | None:
        legs = divided(self._groups, line.route, NEAR * self._query[QUERY_RADIUS])
        if legs is not None:
            return legs
        if line.finest not in self._found_legs:
            self._found_legs[line.finest] = self._search_legs(line.finest)
        return self._found_legs[line.finest]

    def _search_legs(self, finest: bool) -> Floats | None:
        legs: list[Floats] = []
        for query in leg_queries(self._groups):
            ways = [query]
            if legs:
                ways.insert(0, query.copy())  # else the body may arrive there from elsewhere, and go on to elsewhere
                gone_on(ways[0], legs[-1])
            leg = self._leg(ways, finest)
            if leg is None:
                return None
            legs.append(respaced(leg, LEG_POINTS))
        return np.stack(legs)

    def _leg(self, ways: list[Floats], finest: bool) -> Floats | None:
        """Return the route (K, 3) of one leg, asked for in either way (28,); `None` where none is found.

        Both are looked for around edges before any over cells, which take a hundred times as long.
        """
        for query in ways:
            leg = self._around(query)
            if leg is not None:
                return leg
        for query in ways:
            for plan in self._searches.leg_plans(finest):
                found = self._found(query, plan)
                if found.routes:
                    return found.routes[0]
        return None


def along(initial: Floats, routes: tuple[Floats, ...], then: int = 0, closed: float | None = None) -> Batch:
    """Configurations along routes, which are frozen."""
    for route in routes:
        route.setflags(write=False)
    return Batch(SOURCES[ROUTE], initial, then=then, closed=closed, routes=routes)
