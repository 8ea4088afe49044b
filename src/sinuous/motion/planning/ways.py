"""The sources of ways, taken in turn until one has a way."""

from collections.abc import Iterator
from typing import Protocol

from sinuous.motion.planning.ends import Ends
from sinuous.motion.planning.grown import grown
from sinuous.motion.planning.question import Question
from sinuous.motion.planning.withdrawn import withdrawn
from sinuous.solving.planning.trees import Way


class Source(Protocol):
    """Looks for ways. The sources of a plan take turns: each goes on when its next answer is asked for."""

    def __call__(self, question: Question, ends: Ends) -> Iterator[Way | None]:
        """Yield a way, or `None` where another source may try; end when there is nothing left to try."""
        ...


SOURCES: tuple[Source, ...] = (grown, withdrawn)
"""In the order in which they are asked; what is quick comes first."""


def find_way(question: Question) -> Way | None:
    """Ask the sources in turn; `None` when the time is over, or none has anything left to try."""
    ends = Ends(question)
    asked = [source(question, ends) for source in SOURCES]
    while asked:
        for ways in tuple(asked):
            if question.watch.seconds_left() <= 0.0:
                return None
            try:
                way = next(ways)
            except StopIteration:
                asked.remove(ways)
                continue
            if way is not None:
                return way
    return None
