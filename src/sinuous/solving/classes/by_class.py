"""A stopping rule: enough solutions of different classes, and some of each to choose from."""

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.tables import Outcome
from sinuous.solving.classes.curves import Curves
from sinuous.solving.search import Distinct

CANDIDATES = 4
"""Distinct solutions of a class that are kept, the best ones."""

Dislike = Callable[[list[Floats]], Floats]
"""A number (m,) for each of m configurations (n, 3): what is smaller is better."""


class ByClass(Distinct):
    """Follows every start to its own solution, and puts what is distinct into classes.

    Stops when there are so many classes and `CANDIDATES` times as many solutions, or none seem to be left.

    Parameters
    ----------
    count : int
        Classes to find.
    apart, shape, max_starts, seconds
        See `Distinct`.
    curves : Curves
    dislike : callable

    Attributes
    ----------
    classes : list of list of Outcome
        Of every class the best solutions, best first.
    """

    patience: ClassVar[int] = 400
    """Starts in a row, routes not counted, that bring no class after the first one, before it stops."""

    def __init__(
        self,
        count: int,
        apart: float,
        shape: Callable[[Floats], Floats],
        max_starts: int,
        seconds: float,
        curves: Curves,
        dislike: Dislike,
    ) -> None:
        super().__init__(max_starts, apart, shape, max_starts, seconds)
        self._wanted, self._curves, self._dislike = count, curves, dislike
        self._firsts: list[Floats] = []
        self.classes: list[list[Outcome]] = []

    @property
    def open(self) -> bool:
        """Whether classes are missing, or solutions to choose from; and what `Distinct` asks."""
        enough = len(self.classes) >= self._wanted and len(self.found) >= CANDIDATES * self._wanted
        return super().open and not enough

    def has(self, curve: Floats) -> bool:
        """Whether there is a solution of the class of a curve (N, 3)."""
        return self._curves.alike_one(curve, self._firsts) is not None

    def _is_new(self) -> bool:
        """Put the last one found among the best of its class; return whether the class is new."""
        curve = self._curves.of(self.found[-1].q)
        number = self._curves.alike_one(curve, self._firsts)
        if number is not None:
            members = [*self.classes[number], self.found[-1]]
            order = np.argsort(self._dislike([each.q for each in members]), kind="stable")
            self.classes[number] = [members[i] for i in order[:CANDIDATES]]
        elif self.seconds_left > 0.0:  # else comparing took too long to say that it is new
            self._firsts.append(curve)
            self.classes.append([self.found[-1]])
            return True
        return False
