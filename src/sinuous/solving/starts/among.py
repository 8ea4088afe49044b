"""Batches of one source between those of another: the dearer these have been, the more effort is made."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from typing import TypeVar

from sinuous.solving.starts.sources import Batch

Effort = TypeVar("Effort", bound=Hashable)

A_START = 4
"""What a given start costs, in scattered starts."""


def among(
    batches: Iterable[Batch], costs: Mapping[Effort, int], made: Callable[[Effort], Iterable[Batch]]
) -> Iterator[Batch]:
    """Yield batches, and between them what is made with more and more effort.

    Parameters
    ----------
    batches : iterable of Batch
    costs : mapping
        By effort, the least first, what batches have cost before it is made, in scattered starts.
    made : callable
        From an effort to batches.
    """
    due, cost = list(costs), 0
    for batch in batches:
        while due and cost >= costs[due[0]]:
            yield from made(due.pop(0))
        yield batch
        cost += batch.then + A_START * len(batch.initial)
    for effort in due:
        yield from made(effort)
