"""Several distinct solutions of one target, ranked, as an answer of the command solve."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from sinuous.solution.route_class import RouteClass
from sinuous.solution.solution import Solution


@dataclass(frozen=True)
class Alternatives:
    """What `solve --all` found.

    Attributes
    ----------
    solutions : tuple of Solution
        Distinct, all solved, best first; perhaps none.
    best : Solution
        The first of them; where there is none, what a plain solve says of the target.
    seconds : float
        Of the whole search.
    """

    solutions: tuple[Solution, ...]
    best: Solution
    seconds: float

    @property
    def solved(self) -> bool:
        """Whether there is a solution."""
        return self.best.solved

    def to_dict(self) -> dict[str, Any]:
        """Return what they have in common, and each, as plain values in the order of the file format."""
        best = self.best.to_dict()
        common = {key: best[key] for key in ("status", "base", "worst", "reason")}
        asked = {key: best[key] for key in ("method", "seed")}
        each = [solution.to_dict() for solution in self.solutions]
        return {**common, "seconds": self.seconds, **asked, "solutions": each}

    def __str__(self) -> str:
        if not self.solutions:
            return str(self.best)
        count = f"{len(self.solutions)} distinct solution{'s' if len(self.solutions) > 1 else ''}, best first"
        classes = {each.route_class.number: each.route_class for each in self.solutions if each.route_class is not None}
        rows = [["", *(["class"] if classes else []), "bend", "length", "clearance", "position", "angle", "start"]]
        rows += [[str(i), *_class(each, classes), *_cells(each)] for i, each in enumerate(self.solutions, 1)]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in rows]
        words = [f"  {route_class}" for _, route_class in sorted(classes.items())]
        return "\n".join([f"Alternatives: {self.best.status} ({count})", *lines, *words])


def _class(solution: Solution, classes: dict[int, RouteClass]) -> list[str]:
    """Number of the class of a solution, where there are classes."""
    own = solution.route_class
    return [] if not classes else ["-" if own is None else str(own.number)]


def _cells(solution: Solution) -> list[str]:
    """All bends (rad) and lengths together, proved clearance, errors, and the kind of start."""
    numbers = (
        float(np.hypot(solution.q[:, 0], solution.q[:, 1]).sum()),
        float(solution.q[:, 2].sum()),
        solution.clearance,
        solution.position_error,
        solution.angle_error,
    )
    return [*("-" if number is None else f"{number:.3g}" for number in numbers), solution.start]
