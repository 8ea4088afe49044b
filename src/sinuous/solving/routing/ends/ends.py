"""Starts for a base, a tip, or both, that lie in tubes.

A route from end to end is of little use there: it is that of a ball, which turns round in the tube, and leaves by the
nearer mouth. So a route is searched for from mouth to mouth, for what is left of the robot between what is laid along
the axes.
"""

from collections.abc import Iterator

from sinuous.checks import Floats
from sinuous.kernels.tables import QUERY_GOAL, QUERY_ORIGIN, QUERY_RADIUS
from sinuous.solving.polylines import respaced
from sinuous.solving.routing.candidates import along
from sinuous.solving.routing.crossing import Part
from sinuous.solving.routing.ends.axes import NEAR, axes_from_goal, joined
from sinuous.solving.routing.ends.rests import Rest, rests
from sinuous.solving.routing.growth import GLANCE, LEG_POINTS, Beam, divided, query_of
from sinuous.solving.routing.parts import backbone_of, fitted
from sinuous.solving.routing.searches import Searches
from sinuous.solving.routing.tubes import in_the_open, tube_around
from sinuous.solving.starts import Batch, Question


class Ends:
    """Chains of which what lies in tubes at either end is laid along their axes, for one question.

    Parameters
    ----------
    searches : Searches
    question : Question
    query : ndarray (28,)
        What a route to the tip has to keep.

    Attributes
    ----------
    possible : bool
        Whether anything is made.
    """

    def __init__(self, searches: Searches, question: Question, query: Floats) -> None:
        self._searches, self._question, self._query = searches, question, query
        self._left, self._groups = question.seconds_left, searches.groups(question.problem)
        # limits of actuators join what is in a tube and what is not; and several solutions lead not only through tubes
        self.possible = not (question.several or self._groups[0][1] > 0.0)
        self._rests: Iterator[Rest] | None = None
        self._into_tube = False
        self._known: list[tuple[Rest, Part]] = []
        self._tried: set[bytes] = set()

    def glance(self) -> Iterator[Batch]:
        """Yield chains that are made with a glance, if the tip lies in a tube; nothing where no walls are near it."""
        goal, radius = self._query[QUERY_GOAL : QUERY_GOAL + 3], float(self._query[QUERY_RADIUS])
        if not in_the_open(goal, radius, self._question.problem.scene.distance):
            yield from self.made(None)

    def made(self, beam: Beam | None) -> Iterator[Batch]:
        """Yield chains, each once; `None`: with a glance, if the tip lies in a tube."""
        for chain in self._chains(beam):
            if chain.tobytes() not in self._tried:
                self._tried.add(chain.tobytes())
                yield along(chain[None], (backbone_of(self._groups, chain),))

    def _chains(self, beam: Beam | None) -> Iterator[Floats]:
        """Yield chains (n, 3) whose parts took no more effort than this: what came nearest, where none is solved."""
        if self._rests is None and self._left() > 0.0:
            yield from self._begun()
        for rest, part in self._parts() if beam is not None or self._into_tube else ():
            chain = part.solved(GLANCE if beam is None else beam, self._left)
            chain = part.nearest if chain is None else chain
            if chain is not None:
                yield rest.whole(chain)

    def _begun(self) -> Iterator[Floats]:
        """Look for the tubes of both ends; yield chains along both axes, where these meet."""
        scene = self._groups[1]
        axes = axes_from_goal(scene, self._query, self._question.problem.scene.distance, self._left())
        tube = tube_around(scene, self._query, self._left())
        self._rests = rests(self._groups, tube, axes, self._left)
        self._into_tube = len(axes) > 0
        first = self._query[None, QUERY_ORIGIN : QUERY_ORIGIN + 3] if tube is None else tube.axis
        for axis in axes:
            line = joined(first, axis, NEAR * self._query[QUERY_RADIUS])
            if line is not None and self._left() > 0.0:
                yield fitted(self._groups, respaced(line, max(LEG_POINTS, len(line))), self._left())

    def _parts(self) -> Iterator[tuple[Rest, Part]]:
        """Yield what is left of the robot, while there is time; routes are searched for as they are needed."""
        yield from list(self._known)
        while self._rests is not None and self._left() > 0.0:
            rest = next(self._rests, None)
            if rest is None:
                return
            query = query_of(rest.groups)
            route = None if query is None else self._searches.clear_route(self._question.problem, query, self._left)
            if route is not None:
                legs = divided(rest.groups, route, NEAR * self._query[QUERY_RADIUS])
                legs = respaced(route, LEG_POINTS)[None] if legs is None else legs
                self._known.append((rest, Part(rest.groups, legs)))
                yield self._known[-1]
