"""What a solve tries, in which order, and with which effort: the whole strategy in one file.

A solve begins with a compiled call that follows a few starts (`opening_starts`): most solves end there. What is left
undecided goes through a queue of attempts, the one with the lowest priority first. An attempt makes starts, and may add
further attempts: a route that was found adds 'fit a chain to it', 'grow chains along it', each with more and more
effort. After each attempt scattered starts follow, in proportion to the effort that it took. It ends with the first
solution, a proof, the time, or the most starts that the user allows.

Everything that is counted here is counted in *scattered starts*: what one takes, on average, to be followed. None of it
is measured while it runs, so that the same seed gives the same answer, unless the time runs out.

Two numbers belong to an attempt. Its *priority* says when it is made: all that has a lower one comes before it. Its
*effort* is the effort that is counted for it, once it is made, and what scattered starts are in proportion to. For most
attempts both are the same; a priority is higher where an attempt succeeds seldom, and is multiplied by the weight of
its route, so that the second route is worth half as much as the first one.

The figures were set on the places of `python -m benchmarks clutter`; with each are named the families that it matters
for most.
"""

from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.kernels import tables
from sinuous.kernels.tables import CODE, GIVEN, PROVED_CLOSED, RECORD_WIDTH, SOLVED, SOURCE, SOURCES, STARTS
from sinuous.methods.method import capabilities
from sinuous.model.robot import Robot
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene
from sinuous.solver.attempts import AttemptQueue, AttemptsBeyond, IKQuery, RandomRestarts, StartBatch, TimeUp, ending
from sinuous.solver.options import EDGES, REMEMBERED, ROOTS, SCATTERED, SIDE_TUBES, SolveOptions
from sinuous.solver.polylines import respaced
from sinuous.solver.route_classes.curves import RouteCurves
from sinuous.solver.route_classes.passages import Passages
from sinuous.solver.routing.candidates import RouteCandidate, RouteCandidates, starts_along
from sinuous.solver.routing.partial_chains import FIRST_WIDTH, LAST_WIDTH, leading_rows, segments_in
from sinuous.solver.routing.roots import Root, Roots
from sinuous.solver.routing.searches import CELLS, Searches, SearchPlan
from sinuous.solver.shapes import NEAREST

OPENING = 3
"""Starts of the first call among obstacles: most that suffice are among the first, and routes are known as soon."""

OPENING_ALONE = 16
"""Starts of the first call where no attempt but scattered starts follows."""

SHARE = 0.6
"""Scattered starts for each unit of effort that other attempts took. More helps among balls, less in tubes."""

SHARE_AMONG_BALLS = 2.0
"""The same where all obstacles are balls and capsules: they enclose nothing, so that chains along a route are hardly
better than scattered starts, and take longer than they are said to (spheres 40, spheres 100)."""

SHARE_AMONG_MANY = 0.2
"""The same among so many bodies, balls or not, that a scene is crowded: hardly any scattered start gets
through (rods, sheets)."""

SCATTERED_FIRST = 3
"""Scattered starts before any route is looked for, which takes longer than they do (plates, shelf)."""

CELLS_A_START = 250
"""Cells that a search examines in the time of one scattered start (halls, doors)."""

CELLS_A_START_AMONG_MANY = 2500
"""The same among so many bodies that a scene is crowded (rods, sheets)."""

PRIORITY_AFTER_EDGES = 14
"""Priority of the first search over cells, where a route around edges is known: what is tried along that comes before
(two doors, cells)."""

PRIORITY_FINE_CELLS = 8
"""Priority of the first search over fine cells. One over larger ones comes at once where no clear route is known (duct,
branches, box duct)."""

MOST_TERMINAL_POSE_SEARCHES, PRIORITY_TERMINAL_POSE = 3, 6
"""Most searches for a route to where the backbone may end, where a tool leaves that open; and the priority of the
first, by which that of each following one is higher (two tubes)."""

SCATTERED_BEFORE_ROOTS = 64
"""Scattered starts of an arm with joints before any root is looked for (six axes, driven base, rail)."""

PRIORITY_ROOTS_OF_STAGE, PRIORITY_BETWEEN_ROOTS, EFFORT_OF_A_ROOT = 4, 2, 4
"""Priority of the first root where the whole robot has routes, too; by which that of each following one is higher; and
the effort of each (stage, six axes)."""

LED_BACK_WIDTHS = (4, 16, 64)
"""Widths of the beams of chains from the target that say where the robot may begin to bend (six axes)."""

ROUTE_POINTS = 256
"""Points of a route from a root to the mouth of a narrow place and on."""

PRIORITY_ALTERNATIVES = 20
"""Priority of the search for routes that differ (helix)."""

PRIORITY_LAST_SEARCH = 64
"""Priority of the last search, over many fine cells: for routes that differ (halls), and proofs that large rooms are
closed."""

PRIORITY_LAST = 200
"""Priority of what comes after all searches."""

ALTERNATIVES = 4
"""Routes that differ, of a search for more than one."""

EFFORT_OF_A_GROWN_CHAIN = 1.0
"""Effort of growing chains along a route from both ends, for each that beams keep (pipes, ducts, cells, halls). Beams
double as long as there is time."""

EFFORT_AMONG_MANY = 0.4
"""The same among so many bodies that a scene is crowded: routes are many, most of them turn too tightly for
the body, and wide beams find where it can (rods, sheets)."""

UNGUIDED_WIDTHS = (8, 16, 32, 64, 128, 256, 512)
"""Widths of the beams without a route."""

EFFORT_OF_AN_UNGUIDED_CHAIN = 0.2
"""Effort of a beam without a route, in scattered starts, for each chain that it keeps."""

PRIORITY_UNGUIDED = 2.0
"""Priority of a beam without a route, for each chain that it keeps: a route is quicker where there is one (folded,
cells)."""

PRIORITY_AMONG_MANY = 1.7
"""Priority of beams without a route among so many bodies that a scene is crowded: there the body can follow
hardly any route, but one with room (`RouteCandidates.add_route`), along which chains are grown first (rods, sheets, box
duct)."""

PRIORITY_UNGUIDED_AMONG_MANY = 0.02
"""What is added to it for each chain that a beam keeps."""

PRIORITY_SIDE_TUBES_AMONG_MANY = 2.5
"""Priority of a route through tubes there: looking for them takes longer than the first beams (rods)."""

GROWN_SEVERAL = 16
"""Width of beams where several solutions are wanted: chains along one route are much alike."""

DETOURS = 64
"""Most detours of a route (cells, two doors)."""

BOTTLENECK_EFFORTS = {3: 3, 6: 4, 20: 12, 50: 40, 150: 150}
"""By scattered starts of each part, the effort of chains through the narrowest place of a route (doors, cells,
halls)."""

PRIORITY_AT_ONCE = 0
"""Priority of what comes first."""

PRIORITY_REMEMBERED = -20
"""Priority of remembered shapes: before everything else."""

REMEMBERED_SEVERAL = 16
"""Remembered shapes that are tried where several solutions are wanted."""

PRIORITY_PASSAGES = -10
"""Priority of routes through other passages, where several solutions are wanted: before everything else. A search after
none was found with larger cells has a priority higher by 1 for each step."""

PRIORITY_OTHER_PASSAGES = 32
"""Priority of the first search for a route through other passages, where one solution is wanted (plates scan,
nested)."""

EFFORT_OF_OTHER_PASSAGES = 8
"""Effort of each of them, blocking surfaces and comparing included, and by how much the priority of each is higher than
that of the one before."""

PASSAGES_SEARCHES = 96
"""Most searches for routes through other passages."""

PASSAGES_CELLS_A_START = 1000
"""Cells that such a search looks at for each scattered start of its effort: more than elsewhere, because routes find
more classes than scattered starts do."""

MakePassages = Callable[[IKQuery, Floats], Passages]
"""From a question and what routes have to keep (QUERY_WIDTH,) to the passages of its routes."""


class Strategy:
    """What a solver tries, prepared once for a robot and a scene; safe to share between threads.

    Parameters
    ----------
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    options : SolveOptions
    """

    def __init__(self, robot: Robot, scene: Scene, tolerance: Tolerance, options: SolveOptions) -> None:
        takes_routes = capabilities(options.method).routes and len(scene) > 0 and len(robot.segments) > 0
        self._for_routes = (robot, scene, tolerance) if options.routes and takes_routes else None
        takes_memory = capabilities(options.method).initial and REMEMBERED not in options.without
        own = options.memory is not None and options.memory._serves(robot)  # a remedy's robot is another one
        self._memory = options.memory if takes_memory and own else None
        self._segments, self._options, self._joints = len(robot), options, len(robot.joints) > 0

    @cached_property
    def searches(self) -> Searches | None:
        """What finds routes, where they are searched for; made when the first starts have failed."""
        return None if self._for_routes is None else Searches(*self._for_routes)

    def load(self, *, anew: bool = False) -> None:
        """Compile what routes need, or load it, where that is not done yet, or `anew`."""
        if self.searches is not None:
            self.searches.load(anew=anew)

    def opening_starts(self, given: int) -> int:
        """How many starts the method makes by itself in the first call, after so many initial configurations."""
        most = OPENING_ALONE if self._for_routes is None or self._joints else OPENING
        return max(0, min(self._options.most_starts, most) - given)

    def opening(self, question: IKQuery) -> StartBatch:
        """Return the starts of the first call."""
        return StartBatch(SOURCES[GIVEN], question.initial, (0, self.opening_starts(len(question.initial))))

    def random_restarts(self, question: IKQuery) -> RandomRestarts:
        """Return the scattered starts that follow those of the first call."""
        given = len(question.initial)
        return RandomRestarts(self.opening_starts(given), self._options.most_starts - given)

    def batches(
        self, question: IKQuery, scattered: RandomRestarts | None = None, passages: MakePassages | None = None
    ) -> Iterator[StartBatch]:
        """Yield all starts after the first call; an attempt works only when its next batch is asked for.

        Parameters
        ----------
        question : IKQuery
        scattered : RandomRestarts, optional
            Those to go on with, where some of them were followed already.
        passages : callable, optional
            What knows other passages: where several solutions are wanted, routes through these come before all others.
        """
        left = self.random_restarts(question) if scattered is None else scattered
        own = question._replace(deadline=ending(question.deadline))
        with suppress(TimeUp):
            attempts = attempts_of(own, left, self.searches, without=self._options.without, passages=passages)
            if len(question.initial) or question.several:  # else they were tried in the first call
                attempts.add(REMEMBERED, PRIORITY_REMEMBERED, partial(self._remembered_batch, question), effort=0)
            yield from attempts.batches()

    @property
    def remembers(self) -> bool:
        """Whether there is a memory."""
        return self._memory is not None

    def remembered(self, rows: Floats, count: int = NEAREST) -> Floats:
        """Return the remembered shapes (m, k, n, 3) nearest to targets (m, t, 15); k is 0 where there is no memory."""
        memory = self._memory
        return np.empty((len(rows), 0, self._segments, 3)) if memory is None else memory._shapes.nearest(rows, count)

    def recalled(self, starts: Floats, answers: Floats) -> NDArray[np.bool_]:
        """Say of answers (m, 11 + 3 n) to calls from remembered shapes (m, k, n, 3) which began there.

        Returns
        -------
        ndarray (m,) of bool
            Which of them are hardly different from where they began.
        """
        rows = np.flatnonzero(answers[:, SOURCE] == GIVEN) if starts.shape[1] else np.empty(0, np.int64)
        answers[rows, SOURCE] = tables.REMEMBERED
        repeats = np.zeros(len(answers), np.bool_)
        rows = rows[answers[rows, CODE] == SOLVED]  # others count the starts after the one that was best, too
        if self._memory is not None and len(rows):
            began = starts[rows, answers[rows, STARTS].astype(np.int64) - 1]
            found = answers[rows, RECORD_WIDTH:].reshape(began.shape)
            repeats[rows] = self._memory._shapes.alike(found, began[:, None])[:, 0]
        return repeats

    def learn(self, found: Floats, starts: Floats | None = None) -> None:
        """Keep solutions (m, n, 3) in the memory, if there is one, but none that is hardly different from its starts.

        Starts: (m, k, n, 3).
        """
        if self._memory is None:
            return
        if starts is not None and starts.shape[1]:
            self._memory._learn(found, np.logical_not(self._memory._shapes.alike(found, starts).any(axis=1)))
        else:
            self._memory._learn(found)

    def _remembered_batch(self, question: IKQuery) -> Iterator[StartBatch]:
        count = REMEMBERED_SEVERAL if question.several else NEAREST
        initial = self.remembered(question.problem._rows[None], count)[0]
        if len(initial):
            yield StartBatch(REMEMBERED, initial)


def attempts_of(
    question: IKQuery,
    scattered: RandomRestarts,
    searches: Searches | None,
    *,
    without: Collection[str] = (),
    passages: MakePassages | None = None,
) -> AttemptQueue:
    """Return the queue of all that is tried for a question.

    Parameters
    ----------
    question : IKQuery
    scattered : RandomRestarts
        The scattered starts that the first call has left.
    searches : Searches or None
        What finds routes, where they are searched for.
    without : collection of str
        Attempts that are switched off.
    passages : callable, optional
        See `Strategy.batches`.
    """
    share = SHARE
    if question.problem.scene.is_crowded:
        share = SHARE_AMONG_MANY
    elif searches is not None and searches.only_balls(question.problem):
        share = SHARE_AMONG_BALLS
    attempts = AttemptQueue(question, scattered, share, without)
    query = None if searches is None else searches.query(question.problem)
    if searches is not None and query is not None:
        searches.list_near(question.problem)
        joints = len(question.problem.robot.joints) > 0
        routes = None if joints else RouteAttempts(attempts, searches, question, query, passages)
        if leading_rows(segments_in(searches.groups(question.problem)[0])):
            RootAttempts(attempts, searches, question, routes)
    return attempts


class RootAttempts:
    """Routes and chains from several roots: each root has the attempts of a robot that begins there.

    Parameters
    ----------
    attempts : AttemptQueue
        Where they are added.
    searches : Searches
    question : IKQuery
    routes : RouteAttempts, optional
        Those of the whole robot, which has no joints.
    """

    def __init__(
        self, attempts: AttemptQueue, searches: Searches, question: IKQuery, routes: "RouteAttempts | None"
    ) -> None:
        self._attempts, self._searches, self._question, self._routes = attempts, searches, question, routes
        self._roots = Roots(searches, question.problem, question.deadline)
        self._found: Iterator[Root] | None = None
        self._first = PRIORITY_AT_ONCE if routes is None else PRIORITY_ROOTS_OF_STAGE
        if routes is None:
            attempts.add(SCATTERED, PRIORITY_AT_ONCE, self._scattered_first, effort=0)
        attempts.add(ROOTS, self._first, partial(self._begin, 0), EFFORT_OF_A_ROOT)

    def _scattered_first(self) -> Iterator[StartBatch]:
        yield self._attempts.restart_batch(SCATTERED_BEFORE_ROOTS)

    def _begin(self, number: int) -> Iterator[StartBatch]:
        """Add what is tried from the next root, and the root after it."""
        if self._found is None:
            self._found = self._roots.roots(None if self._routes is None else self._routes.first_route)
        root = next(self._found, None)
        if root is None:
            return
        later = self._first + number * PRIORITY_BETWEEN_ROOTS
        searches = self._searches.at(root.chain)
        query = searches.query(self._question.problem)
        if query is not None:
            beyond = AttemptsBeyond(self._attempts, root.chain, later)
            route = None  # on a stage the way from each root may lead through another mouth
            if self._routes is None and root.line is not None:
                route = np.vstack([query[tables.QUERY_ORIGIN : tables.QUERY_ORIGIN + 3], root.line])
            lead_back = partial(self._lead_back, root.chain, later)
            RouteAttempts(beyond, searches, self._question, query, route=route, on_route=lead_back)
        yield starts_along(self._roots.start_from(root.chain)[None], ())
        self._attempts.add(ROOTS, later + PRIORITY_BETWEEN_ROOTS, partial(self._begin, number + 1), EFFORT_OF_A_ROOT)

    def _lead_back(self, root: Floats, later: float, routes: "RouteCandidates", candidate: RouteCandidate) -> None:
        """Add chains from the target along a route from a root, whose own ends are new roots, by wider beams."""

        def make(width: int) -> Iterator[StartBatch]:
            legs = routes.legs_of(candidate)
            for start in () if legs is None else self._roots.led_back(root, legs, width):
                yield starts_along(start[None], (candidate.route,))

        for width in LED_BACK_WIDTHS:
            effort = EFFORT_OF_A_GROWN_CHAIN * width
            self._attempts.add(ROOTS, later + effort * candidate.weight, partial(make, width), effort)


class RouteAttempts:
    """What is tried along routes for one question: it adds attempts, and these add others.

    Parameters
    ----------
    attempts : Attempts
        Where they are added.
    searches : Searches
    question : IKQuery
    query : ndarray (QUERY_WIDTH,)
        What routes have to keep.
    passages : callable, optional
        See `Strategy.batches`.
    route : ndarray (K, 3), optional
        One that is known: others are searched for later.
    on_route : callable, optional
        What else is added for the first route of each search; then these are routes beyond a root.
    """

    def __init__(
        self,
        attempts: AttemptQueue | AttemptsBeyond,
        searches: Searches,
        question: IKQuery,
        query: Floats,
        passages: MakePassages | None = None,
        route: Floats | None = None,
        on_route: Callable[[RouteCandidates, RouteCandidate], None] | None = None,
    ) -> None:
        self._attempts, self._searches, self._question = attempts, searches, question
        self._plans = plans_of(searches)
        self._many = question.problem.scene.is_crowded
        self._grown_effort = EFFORT_AMONG_MANY if self._many else EFFORT_OF_A_GROWN_CHAIN
        self._candidates = RouteCandidates(searches, question, query, attempts.without)
        self._passes = 0
        self._make_passages = passages
        self._on_route = on_route
        if on_route is None and (passages is not None or not question.several):
            self._add_passage(frozenset(), 0)
        if route is not None:
            self._add_routes([respaced(route, ROUTE_POINTS)], finest=False)
        self._add_first(whole=on_route is None)

    @property
    def first_route(self) -> Floats | None:
        """The first route (K, 3) that was found; `None` where none is."""
        return self._candidates.known[0].route if self._candidates.known else None

    @cached_property
    def _passages(self) -> Passages:
        """The passages that routes lead through, once they are asked for."""
        if self._make_passages is not None:
            return self._make_passages(self._question, self._candidates.query)
        curves = RouteCurves(self._searches.robot, self._question.problem.scene, self._question.deadline)
        return Passages(self._searches, curves, self._question, self._candidates.query, solved=lambda curve: False)

    def _add_first(self, whole: bool) -> None:
        """Add what needs no route, and what finds routes."""
        if not self._question.several:
            self._attempts.add("base_tube", PRIORITY_AT_ONCE, self._candidates.chains_in_base_tube)
        if whole:
            self._attempts.add(SCATTERED, PRIORITY_AT_ONCE, self._scattered_first, effort=0)
        if not self._question.several:
            self._add_unguided()
        tubes = PRIORITY_SIDE_TUBES_AMONG_MANY if self._many else PRIORITY_AT_ONCE
        for name, priority, find in (
            (EDGES, PRIORITY_AT_ONCE, self._candidates.route_around_edges),
            (SIDE_TUBES, tubes, self._candidates.route_through_side_tubes),
        ):
            self._attempts.add(name, priority, partial(self._find_one, find), effort=0)
        self._attempts.add("cells", PRIORITY_AT_ONCE, partial(self._search, self._plans, True), effort=0)

    def _add_unguided(self) -> None:
        """Add chains without a route, by wider and wider beams."""
        for width in UNGUIDED_WIDTHS:
            priority = PRIORITY_UNGUIDED * width
            if self._many:
                priority = PRIORITY_AMONG_MANY + PRIORITY_UNGUIDED_AMONG_MANY * width
            make = partial(self._candidates.chains_that_meet, width)
            self._attempts.add("unguided", priority, make, EFFORT_OF_AN_UNGUIDED_CHAIN * width)

    def _add_passage(self, closed: frozenset[int], step: int, again: bool = False, later: bool = False) -> None:
        """Add a search for a route while some passages are closed; `later`: there probably is none."""
        if step < len(self._searches.single_plans):
            several = self._question.several
            first = PRIORITY_PASSAGES if several else PRIORITY_OTHER_PASSAGES + EFFORT_OF_OTHER_PASSAGES * self._passes
            priority = first + (1 + step if later else 0)
            make = partial(self._pass, closed, step, again)
            self._attempts.add("passages", priority, make, effort=0 if several else EFFORT_OF_OTHER_PASSAGES)

    def _pass(self, closed: frozenset[int], step: int, again: bool) -> Iterator[StartBatch]:
        """Search for a route while some passages are closed; add searches with the passages of that route closed, too.

        `again`: a route was found so already, but no solution along it, so several that differ are searched for.
        """
        if self._passes >= PASSAGES_SEARCHES:
            return
        self._passes += 1
        plan, passages = self._searches.single_plans[step]._replace(routes=ALTERNATIVES if again else 1), self._passages
        routes, cells = passages.routes(closed, plan)
        yield starts_along(self._question.initial[:0], (), effort=cells / PASSAGES_CELLS_A_START)
        if not routes:
            self._add_passage(closed, step + 1, again, later=True)
            return
        if self._question.several:
            failed = yield from passages.starts(routes)
            if failed:
                self._add_passage(closed, step + again, again=True)
        elif passages.differs(routes[0]):
            self._add_routes(routes, finest=False)
        for more in passages.closing(closed, routes[0]):
            self._add_passage(more, 0)

    def _scattered_first(self) -> Iterator[StartBatch]:
        """Scattered starts, unless the base lies in a closed tube: what gets out of that is found along it."""
        if not self._candidates.enclosed:
            yield self._attempts.restart_batch(SCATTERED_FIRST)

    def _find_one(self, find: Callable[[Floats], Floats | None]) -> Iterator[StartBatch]:
        """Look for a route without cells, unless one is known."""
        route = None if self._candidates.known else find(self._candidates.query)
        if route is not None:
            self._add_routes([route], finest=True)
        return iter(())

    def _search(self, searches: list[tuple[float, SearchPlan]], first: bool) -> Iterator[StartBatch]:
        """Search for routes over cells; add the next search."""
        candidates = self._candidates
        if first and candidates.known:
            searches = [(max(priority, PRIORITY_AFTER_EDGES), plan) for priority, plan in searches if plan.routes > 1]
            self._attempts.add("cells", PRIORITY_AFTER_EDGES, partial(self._search, searches, False), effort=0)
            return
        (_, plan), *others = searches
        found = candidates.search_cells(plan)
        closed = plan.cell if found.ended == PROVED_CLOSED else None
        self._add_routes(found.routes, plan.cell == self._searches.fine.cell)
        if candidates.any_clear:
            others = [(priority, other) for priority, other in others if other != self._searches.middle]
        if others:
            self._attempts.add("cells", others[0][0], partial(self._search, others, False), effort=0)
        effort = found.cells / (CELLS_A_START_AMONG_MANY if self._many else CELLS_A_START)
        yield starts_along(self._question.initial[:0], (), effort=effort, closed=closed)

    def _add_root(self, number: int) -> None:
        """Add a search for a route to where the backbone may end, where a tool leaves that open."""
        alone = len(self._question.problem.targets) == 1 and not self._question.several
        if number < MOST_TERMINAL_POSE_SEARCHES and alone and self._candidates.has_tool:
            make = partial(self._search_to_root, number)
            self._attempts.add("cells", PRIORITY_TERMINAL_POSE * (1 + number), make, effort=0)

    def _search_to_root(self, number: int) -> Iterator[StartBatch]:
        """Search for a route to where the backbone may end, and add the next search."""
        route = self._candidates.route_to_terminal_pose(number)
        if route is not None:
            self._add_routes([route], finest=False)
        self._add_root(number + 1)
        return iter(())

    def _add_routes(self, routes: list[Floats], finest: bool) -> None:
        """Add all that is tried along the routes (K, 3) of one search: chains are grown along the first one alone."""
        if not routes:
            return
        if not self._candidates.known:
            self._add_root(0)
        stowed = self._candidates.is_longer_than(routes[0])
        first = self._candidates.add_route(routes[0], finest)
        for other in routes[1:]:
            self._candidates.add_route(other, finest)
        if not self._question.several:
            self._add_bottleneck(first)
        self._add_grown(first)
        if not self._question.several:
            self._add_detour(first, first=0 if stowed else 3)
        if self._on_route is not None:
            self._on_route(self._candidates, first)
        priority = min(BOTTLENECK_EFFORTS.values()) if stowed else PRIORITY_AT_ONCE
        self._attempts.add("fitted", priority, partial(self._candidates.fitted_chains, routes), effort=0)

    def _add_along(
        self, name: str, candidate: RouteCandidate, effort: float, make: Callable[[], Iterator[StartBatch]]
    ) -> None:
        self._attempts.add(name, effort * candidate.weight, make, effort)

    def _add_grown(self, candidate: RouteCandidate) -> None:
        """Add chains along a route; those for several solutions come last, because they are much alike."""
        if self._question.several:
            make = partial(self._candidates.grown_chains, candidate, GROWN_SEVERAL)
            self._attempts.add("grown", PRIORITY_LAST, make, self._grown_effort * GROWN_SEVERAL)
            return
        width = FIRST_WIDTH
        while width <= LAST_WIDTH:
            self._add_along(
                "grown", candidate, self._grown_effort * width, partial(self._candidates.grown_chains, candidate, width)
            )
            width *= 2

    def _add_detour(self, candidate: RouteCandidate, first: int, number: int = 0) -> None:
        """Add chains along a lengthened route, with the effort of the least beams; each comes after the one before.

        The first has the priority of number `first`.
        """
        if number < DETOURS:
            effort = self._grown_effort * FIRST_WIDTH
            make = partial(self._detour, candidate, first, number)
            self._attempts.add("detours", effort * (1 + first + number) * candidate.weight, make, effort)

    def _detour(self, candidate: RouteCandidate, first: int, number: int) -> Iterator[StartBatch]:
        """Make chains along a route that is led aside, and add the next ones."""
        yield from self._candidates.detour_chains(candidate, number)
        self._add_detour(candidate, first, number + 1)

    def _add_bottleneck(self, candidate: RouteCandidate) -> None:
        """Add chains through the narrowest place of a route."""
        for starts, effort in BOTTLENECK_EFFORTS.items():
            self._add_along(
                "bottleneck", candidate, effort, partial(self._candidates.bottleneck_chains, candidate, starts)
            )


def plans_of(searches: Searches) -> list[tuple[float, SearchPlan]]:
    """Return the searches over cells, from the quickest to the most thorough, each with its priority."""
    coarse, fine = searches.coarse, searches.fine._replace(prove=searches.proves)
    first = [(PRIORITY_AT_ONCE, coarse), (PRIORITY_AT_ONCE, searches.middle), (PRIORITY_FINE_CELLS, fine)]
    first = first if coarse.cell > fine.cell else [(PRIORITY_AT_ONCE, fine)]
    others = (PRIORITY_ALTERNATIVES, coarse), (PRIORITY_LAST_SEARCH, fine._replace(cells=CELLS[1]))
    return [*first, *((priority, plan._replace(routes=ALTERNATIVES)) for priority, plan in others)]
