"""The order in which start sources are asked: one for all kinds of solves."""

from collections.abc import Iterator

from sinuous.solving.starts.sources import Batch, Opening, Question, Scattered, Source

LOCAL = 3
"""Starts before routes are asked for: most that suffice are among the first, and many routes are known as quickly."""

ALONE = 16
"""Starts in the first compiled call where there is no other source."""


class Portfolio:
    """Start sources in order: the opening; then routes and scattered starts in turn; then scattered starts alone.

    Parameters
    ----------
    max_starts : int
        Most starts of one solve.
    routes : Source, optional
        The source of routes, where there is one.

    Attributes
    ----------
    opening : Opening
    """

    def __init__(self, max_starts: int, routes: Source | None = None) -> None:
        self.opening = Opening(min(max_starts, ALONE if routes is None else LOCAL))
        self._max_starts = max_starts
        self._routes = routes

    def batches(self, question: Question) -> Iterator[Batch]:
        """Yield all batches, the opening first. A source works only when its next batch is asked for."""
        yield from self.opening.batches(question)
        yield from self.further(question)

    def further(self, question: Question) -> Iterator[Batch]:
        """Yield all batches after the opening."""
        given = len(question.initial)
        scattered = Scattered(self.opening.own(given), self._max_starts - given)
        for batch in () if self._routes is None else self._routes.batches(question):
            yield batch
            yield scattered.take(question, batch.then)
        yield from scattered.batches(question)
