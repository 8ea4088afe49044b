"""Tables in Markdown whose columns are also straight to the eye."""

import math
from collections.abc import Sequence


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


def figure(value: float, form: str = "g") -> str:
    """Text of a number; a median of nothing is none."""
    return f"{value:{form}}" if math.isfinite(value) else "none"


def span(seconds: float) -> str:
    """Text of a time in the unit that suits it, to three digits."""
    if not math.isfinite(seconds):
        return "none"
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        value = seconds / size
        if value >= 0.9995:
            return f"{value:.{2 if value < 9.995 else 1 if value < 99.95 else 0}f} {unit}"
    return f"{1e9 * seconds:.0f} ns"
