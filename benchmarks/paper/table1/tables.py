"""One table a pose."""

from collections.abc import Sequence

import numpy as np

from benchmarks.harness.markdown import span, table
from benchmarks.paper.table1.rows import PUBLISHED, Published, Row

HEADINGS = (
    "method", "solved", "position error, mm", "orientation error, rad", "median", "p95", "worst", "iterations",
    "starts", "largest bend", "published: time", "mm", "rad", "iterations",
)  # fmt: skip


def pose_table(pose: str, rows: Sequence[Row]) -> str:
    """Return the table of one pose."""
    return table([HEADINGS, *(_cells(row, PUBLISHED[pose].get(row.label)) for row in rows)])


def _cells(row: Row, published: Published | None) -> list[str]:
    last = row.last
    bend = float(np.linalg.norm(np.array(last["q"])[:, :2], axis=-1).max())
    cells = [
        row.label,
        f"{row.tally.right}/{row.tally.runs}",
        _error(last["position"]),
        _error(last["angle"]),
        *(span(seconds) for seconds in (row.times.median, row.times.p95, row.times.worst)),
        str(last["iterations"]),
        str(last["starts"]),
        f"{bend:.2f}",
    ]
    if published is None:
        return [*cells, "", "", "", ""]
    errors = ["" if error is None else f"{error:g}" for error in (published.position, published.angle)]
    return [*cells, span(published.seconds), *errors, published.iterations]


def _error(value: float) -> str:
    return "0" if value < 1e-9 else f"{value:.2g}" if value < 1e-3 or value >= 100.0 else f"{value:.3g}"
