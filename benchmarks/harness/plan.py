"""How large a run is, what its random numbers begin with, and how it shows that it is alive."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.random import Generator
from rich.console import Console
from rich.progress import Progress

Item = TypeVar("Item")

_shown: list[str] = []
"""What has a progress bar."""


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
        """Go through items with a progress bar, in terminals; what runs within shows none of its own.

        The bar has no thread of its own, which would disturb what is timed: it is drawn between two items.
        """
        console = Console(stderr=True)
        if not console.is_terminal or _shown:
            yield from items
            return
        _shown.append(what)
        try:
            with Progress(console=console, auto_refresh=False, transient=True) as progress:
                task = progress.add_task(what, total=total)
                for item in items:
                    yield item
                    progress.update(task, advance=1, refresh=True)
        finally:
            _shown.clear()
