"""How large a run is, what its random numbers begin with, and how it shows that it is alive."""

import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.random import Generator
from rich.console import Console
from rich.progress import Progress

Item = TypeVar("Item")

REFRESH = 0.5
"""Seconds between two pictures of a progress bar."""

_shown: list[Progress] = []
"""The display that is open: what runs inside of something else adds its bar to it."""


@dataclass(frozen=True)
class Plan:
    """A run.

    Attributes
    ----------
    seed : int
    quick : bool
        Whether to cut all counts down, to see in seconds that everything runs.
    rounds : int
        How often everything is measured that is made of lines; the rounds show how much a figure spreads.
    """

    seed: int = 0
    quick: bool = False
    rounds: int = 1

    def count(self, full: int, quick: int) -> int:
        """Choose between the two sizes of an experiment."""
        return quick if self.quick else full

    def rng(self, *stream: int) -> Generator:
        """Return random numbers of their own for every experiment, which the seed determines."""
        return np.random.default_rng([self.seed, *stream])

    def track(self, items: Iterable[Item], what: str, total: int) -> Iterator[Item]:
        """Go through items with a progress bar, in terminals.

        The bar has no thread of its own, which would disturb what is timed: it is drawn between two items.
        """
        if _shown:
            yield from _bar(_shown[0], items, what, total)
            return
        console = Console(stderr=True)
        with Progress(console=console, auto_refresh=False, transient=True, disable=not console.is_terminal) as progress:
            _shown.append(progress)
            try:
                yield from _bar(progress, items, what, total)
            finally:
                _shown.clear()


def _bar(progress: Progress, items: Iterable[Item], what: str, total: int) -> Iterator[Item]:
    task = progress.add_task(what, total=total)
    due = 0.0
    try:
        for done, item in enumerate(items):
            yield item
            if time.monotonic() >= due:
                progress.update(task, completed=done + 1, refresh=True)
                due = time.monotonic() + REFRESH
    finally:
        progress.remove_task(task)
