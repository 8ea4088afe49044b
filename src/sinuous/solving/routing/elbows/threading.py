"""Starts for elbows in tubes: chains through the tube, part after part."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import QUERY_AXIS, QUERY_GOAL, QUERY_ORIGIN, QUERY_RADIUS
from sinuous.solving.routing.candidates import along
from sinuous.solving.routing.crossing import Parts
from sinuous.solving.routing.elbows.inside import Inside, tube_of
from sinuous.solving.routing.elbows.ways import Route, Ways
from sinuous.solving.routing.gates import Way
from sinuous.solving.routing.growth import GLANCE, Beam, leg_queries
from sinuous.solving.routing.parts import backbone_of
from sinuous.solving.routing.searches import AHEAD, Searches
from sinuous.solving.starts import Batch, Question

AMONG_WALLS = 7.0
"""How near walls are at most to a place `AHEAD` of the base that stands among them, in radii of the body."""


class Elbows:
    """Chains through the tube that an elbow lies in, for one question.

    Before and behind the tube no more is made of a route at first than edges give, or a straight line: mostly there is
    room, and the parts are solved from scattered starts.

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
        self._guessed = False
        self._ways = self._begun(self._guess)
        self._tried: set[bytes] = set()

    @property
    def possible(self) -> bool:
        """Whether there may be an elbow, and a first solution is looked for."""
        return len(self._problem.targets) > 1 and not self._question.several

    @property
    def from_inside(self) -> bool:
        """Whether the base stands among walls."""
        query = self._searches.query(self._problem)
        if query is None:
            return False
        radius, axis = query[QUERY_RADIUS], query[QUERY_AXIS : QUERY_AXIS + 3]
        place = query[QUERY_ORIGIN : QUERY_ORIGIN + 3] + AHEAD * radius * axis
        return bool(self._problem.scene.distance(place[None])[0] <= AMONG_WALLS * radius)

    def chains(self, beam: Beam) -> Iterator[Batch]:
        """Yield chains whose parts took no more effort than this, each once."""
        if beam != GLANCE and self._guessed:
            self._parts, self._ways, self._guessed = [], self._begun(self._route), False
        for way, parts in self._all():
            chain, _ = parts.solved(beam, self._left)
            if chain is None or chain.tobytes() in self._tried:
                continue
            self._tried.add(chain.tobytes())
            route = backbone_of(self._groups, chain) if self._guessed else np.concatenate([leg[0] for leg in way.legs])
            yield along(chain[None], (route,))

    def _all(self) -> Iterator[tuple[Way, Parts]]:
        """Yield the ways that are known, then the others, while there is time."""
        yield from list(self._parts)
        while self._left() > 0.0:
            way = next(self._ways, None)
            if way is None:
                return
            self._parts.append((way, Parts(self._groups, way)))
            yield self._parts[-1]

    def _begun(self, route: Route) -> Iterator[Way]:
        """Yield all ways, by routes of one kind; none where no elbow lies in a tube."""
        queries, tube = self._place
        if tube is not None:
            yield from Ways(self._groups, queries, tube, route)

    @cached_property
    def _place(self) -> tuple[list[Floats], Inside | None]:
        """What routes have to keep to the elbow and from there, and the tube that it lies in."""
        queries = leg_queries(self._groups) if self.possible else []
        if len(queries) != 2:  # one elbow
            return queries, None
        elbow = queries[0][QUERY_GOAL : QUERY_GOAL + 3]
        distance = self._problem.scene.distance
        return queries, tube_of(self._groups[1], queries[0], elbow, distance, self._left())

    def _guess(self, query: Floats) -> Floats:
        """Return a route (K, 3) around edges, or else the straight line, which may lead through walls."""
        route = self._searches.by_edges(self._problem, query, max(0.0, self._left()))
        if route is None:
            self._guessed = True
            route = np.stack([query[QUERY_ORIGIN : QUERY_ORIGIN + 3], query[QUERY_GOAL : QUERY_GOAL + 3]])
        return route

    def _route(self, query: Floats) -> Floats | None:
        """Return a route (K, 3), around edges or over cells, as coarse as suffice; `None` where none is found."""
        return self._searches.clear_route(self._problem, query, self._left)
