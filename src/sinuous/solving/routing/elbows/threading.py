"""Starts for elbows in tubes: chains through the tube, part after part, between the other starts of routes."""

from collections.abc import Iterable, Iterator

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import QUERY_GOAL, QUERY_RADIUS, ROUTE, SOURCES
from sinuous.solving.routing.crossing import Parts
from sinuous.solving.routing.elbows.inside import tube_of
from sinuous.solving.routing.elbows.ways import Ways
from sinuous.solving.routing.gates import Way
from sinuous.solving.routing.growth import FEW, GLANCE, MANY, ONE, SOME, Beam, leg_queries
from sinuous.solving.routing.searches import Searches
from sinuous.solving.starts.sources import Batch, Question

COSTS = {GLANCE: 0, ONE: 10, SOME: 50, FEW: 200, MANY: 600}
"""How much effort is made, and what routes have cost before, in scattered starts."""

A_START = 4
"""What a start from a route costs, in scattered starts."""

CLEAR = 0.9
"""Room, in radii of the body, that a route over coarse cells has to keep: else the finest ones are asked."""


class Threading:
    """Chains through the tube that an elbow lies in, for one question.

    Parameters
    ----------
    searches : Searches
    question : Question
    """

    def __init__(self, searches: Searches, question: Question) -> None:
        self._searches, self._question = searches, question
        self._problem, self._left = question.problem, question.seconds_left
        self._groups = searches.groups(question.problem)
        self._parts: list[tuple[Way, Parts]] = []
        self._ways = self._begun()
        self._tried: set[bytes] = set()

    def among(self, batches: Iterable[Batch]) -> Iterator[Batch]:
        """Yield batches, and chains with more and more effort between them."""
        due, cost = list(COSTS), 0
        for batch in batches:
            while due and cost >= COSTS[due[0]]:
                yield from self._chains(due.pop(0))
            yield batch
            cost += batch.then + A_START * len(batch.initial)
        for beam in due:
            yield from self._chains(beam)

    def _chains(self, beam: Beam) -> Iterator[Batch]:
        """Yield chains whose parts took no more effort than this, each once."""
        for way, parts in self._all():
            chain, _ = parts.solved(beam, self._left)
            if chain is None or chain.tobytes() in self._tried:
                continue
            self._tried.add(chain.tobytes())
            route = np.concatenate([leg[0] for leg in way.legs])
            route.setflags(write=False)
            yield Batch(SOURCES[ROUTE], chain[None], routes=(route,))

    def _all(self) -> Iterator[tuple[Way, Parts]]:
        """Yield the ways that are known, then the others, while there is time."""
        yield from list(self._parts)
        while self._left() > 0.0:
            way = next(self._ways, None)
            if way is None:
                return
            self._parts.append((way, Parts(self._groups, way)))
            yield self._parts[-1]

    def _begun(self) -> Iterator[Way]:
        """Yield all ways; none where no elbow lies in a tube."""
        queries = [] if self._question.several else leg_queries(self._groups)
        if len(queries) != 2:  # one elbow
            return
        elbow = queries[0][QUERY_GOAL : QUERY_GOAL + 3]
        tube = tube_of(self._groups[1], queries[0], elbow, self._problem.scene.distance, self._left())
        if tube is not None:
            yield from Ways(self._groups, queries, tube, self._route)

    def _route(self, query: Floats) -> Floats | None:
        """Return a route (K, 3), around edges or over cells, as coarse as suffice; `None` where none is found."""
        searches = self._searches
        route = searches.by_edges(self._problem, query, max(0.0, self._left()))
        for plan in searches.leg_plans(finest=False) if route is None else ():
            found = searches.find(self._problem, query, plan, max(0.0, self._left()))
            if found.routes and self._problem.scene.distance(found.routes[0]).min() >= CLEAR * query[QUERY_RADIUS]:
                return found.routes[0]
        return route
