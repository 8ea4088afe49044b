"""One figure: what it is, what it reached, what it is measured against, its times; and tables of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Times:
    """Seconds of many runs, in short.

    Attributes
    ----------
    count : int
    median, p95, p99, worst : float
    """

    count: int
    median: float
    p95: float
    p99: float
    worst: float

    @classmethod
    def of(cls, seconds: ArrayLike) -> "Times":
        """Summarise at least one run."""
        values = np.asarray(seconds, np.float64)
        median, p95, p99 = np.percentile(values, [50, 95, 99]).tolist()
        return cls(len(values), median, p95, p99, float(values.max()))


UNITS = {"s": 1.0, "ms": 1e3, "us": 1e6}
"""Units of time, and how many of them a second has; other units are those of the number itself."""


@dataclass(frozen=True)
class Goal:
    """What a line is measured against.

    Attributes
    ----------
    value : float
        Bound, inclusive.
    at_most : bool
        Whether less is better.
    correctness : bool
        Whether missing it means that something is wrong, not merely slow.
    """

    value: float
    at_most: bool = True
    correctness: bool = False

    def held(self, reached: float) -> bool:
        """Whether a value is on the right side."""
        return reached <= self.value if self.at_most else reached >= self.value


@dataclass(frozen=True)
class Line:
    """One figure, its goal, and the times that it came from.

    Attributes
    ----------
    section, what : str
        Where it belongs, and what it is; together its name.
    reached : float
        In seconds where `unit` is one of time.
    unit : str
    goal : Goal, optional
    times : Times, optional
    solved : (int, int), optional
        How many answers the judge confirmed, out of how many.
    note : str
        How it was measured, or seeds that reproduce what went wrong.
    """

    section: str
    what: str
    reached: float
    unit: str = "us"
    goal: Goal | None = None
    times: Times | None = None
    solved: tuple[int, int] | None = None
    note: str = ""

    @property
    def held(self) -> bool | None:
        """Whether the goal is held; `None` where there is none."""
        return None if self.goal is None else self.goal.held(self.reached)

    @property
    def verdict(self) -> str:
        """One word for the table."""
        if self.goal is None or self.held is None:
            return ""
        return "held" if self.held else ("WRONG" if self.correctness else "missed")

    @property
    def correctness(self) -> bool:
        """Whether the goal is one of correctness."""
        return self.goal is not None and self.goal.correctness


def table(rows: Sequence[Sequence[str]], *, words: bool = False) -> str:
    """Return a table whose first row is its headings: the first column to the left, others to the right.

    With `words` all columns stand to the left.
    """
    widths = [max(3, *(len(row[column]) for row in rows)) for column in range(len(rows[0]))]
    left = [words or column == 0 for column in range(len(widths))]
    ruler = ["-" * width if first else "-" * (width - 1) + ":" for width, first in zip(widths, left, strict=True)]
    lines = []
    for row in [rows[0], ruler, *rows[1:]]:
        placed = zip(row, widths, left, strict=True)
        cells = [cell.ljust(width) if first else cell.rjust(width) for cell, width, first in placed]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


HEADINGS = ["what", "goal", "reached", "", "solved", "runs", "median", "p95", "p99", "worst"]


def tables_of(lines: Sequence[Line]) -> list[str]:
    """One table a section, then the notes of its lines; at the end how many goals were held."""
    if not lines:
        return []
    parts = []
    for section in dict.fromkeys(line.section for line in lines):
        own = [line for line in lines if line.section == section]
        parts += [f"## {section}", table([HEADINGS, *map(_row, own)])]
        parts += [f"{line.what}: {line.note}" for line in own if line.note]
    held = [line.held for line in lines if line.goal is not None]
    return [*parts, f"{held.count(True)} of {len(held)} goals held."]


def _row(line: Line) -> list[str]:
    goal = "" if line.goal is None else f"{'<=' if line.goal.at_most else '>='} {number(line.goal.value, line.unit)}"
    solved = "" if line.solved is None else f"{line.solved[0]}/{line.solved[1]}"
    return [line.what, goal, number(line.reached, line.unit), line.verdict, solved, *_times(line)]


def _times(line: Line) -> list[str]:
    if line.times is None:
        return [""] * 5
    t = line.times
    unit = line.unit if line.unit in UNITS else ("us" if t.median < 1e-3 else "ms")
    return [str(t.count), *(number(value, unit) for value in (t.median, t.p95, t.p99, t.worst))]


def number(value: float, unit: str) -> str:
    """Text of a value, times in seconds, in its unit."""
    scaled = value * UNITS.get(unit, 1.0)
    if not math.isfinite(scaled):
        return "none"
    text = f"{scaled:.0f}" if scaled == round(scaled) or abs(scaled) >= 1000 else f"{scaled:.3g}"
    return f"{text} {unit}".strip()
