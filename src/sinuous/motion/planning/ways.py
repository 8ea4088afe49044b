"""The sources of ways, taken in turn until one has a way."""

from sinuous.motion.planning.grown import grown
from sinuous.motion.planning.question import Question, Source
from sinuous.motion.planning.withdrawn import withdrawn
from sinuous.solving.planning.trees import Way

SOURCES: tuple[Source, ...] = (grown, withdrawn)
"""In the order in which they are asked; what is quick comes first."""


def find_way(question: Question) -> Way | None:
    """Ask the sources in turn; `None` when the time is over, or none has anything left to try."""
    asked = [source(question) for source in SOURCES]
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
