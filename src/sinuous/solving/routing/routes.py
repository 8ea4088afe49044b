"""The start source for narrow places: routes through free space from the base to a target, and chains along them."""

from collections.abc import Iterator

from sinuous.checks import Floats
from sinuous.kernels.tables import ROUTE, SOURCES
from sinuous.solving.routing.course import Course
from sinuous.solving.routing.elbows.threading import Threading
from sinuous.solving.routing.ends.ends import Ends
from sinuous.solving.routing.searches import Searches
from sinuous.solving.starts.sources import Batch, Question


class Router(Searches):
    """The start source of routes, for one robot; safe to share between threads."""

    name = SOURCES[ROUTE]

    def batches(self, question: Question) -> Iterator[Batch]:
        """Yield configurations along routes to the most distal target, and what is grown along them."""
        query = self.query(question.problem)
        if query is not None:
            batches = Ends(self, question, query).among(Course(self, question, query).batches())
            yield from Threading(self, question).among(batches)

    def along(self, question: Question, query: Floats, route: Floats) -> Iterator[Batch]:
        """Yield configurations along one route (K, 3), and along ones as long as the robot, bent to most sides."""
        return Course(self, question, query).bent(route)
