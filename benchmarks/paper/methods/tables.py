"""One table a kind of problem."""

from collections.abc import Sequence
from typing import Any

from benchmarks.harness.markdown import figure, span, table
from benchmarks.paper.contest import Record, Tally


def plain(records: Sequence[Record]) -> dict[str, Any]:
    """Return all that the table says of one method, for JSON."""
    tally = Tally.of(records)
    return {**vars(tally), "times": vars(tally.times), "missed": _missed(records)}


def _missed(records: Sequence[Record]) -> dict[str, int]:
    """Count what was wrong with the answers that are not right."""
    bad = [record for record in records if not record["right"]]
    outside = sum(record["excess"] > 1e-6 for record in bad)
    touching = sum(record["clearance"] is not None and record["clearance"] < 0.0 for record in bad)
    off = sum(record["excess"] <= 1e-6 and not (record["clearance"] or 0.0) < 0.0 for record in bad)
    return {"limits": outside, "obstacle": touching, "target": off}


HEADINGS = (
    "method", "solved", "", "from the first start", "median", "p95", "worst", "iterations", "position error, mm",
    "angle error, rad", "limits", "obstacle", "target",
)  # fmt: skip


def family_table(found: dict[str, list[Record]], unable: dict[str, str], labels: Sequence[str]) -> str:
    """Return the table of one kind of problem, and why some methods were not run."""
    rows: list[Sequence[str]] = [HEADINGS]
    for label in labels:
        if label in unable:
            rows.append([label, "not run", *[""] * (len(HEADINGS) - 2)])
            continue
        tally, missed = Tally.of(found[label]), _missed(found[label])
        rows.append(
            [
                label,
                f"{tally.right}/{tally.runs}",
                f"{tally.percent:.1f} %",
                str(tally.first),
                *(span(seconds) for seconds in (tally.times.median, tally.times.p95, tally.times.worst)),
                figure(tally.iterations),
                figure(tally.position, ".2g"),
                figure(tally.angle, ".2g"),
                *(str(count or "") for count in missed.values()),
            ]
        )
    reasons = [f"`{label}` {reason}." for label, reason in unable.items()]
    return "\n\n".join([table(rows), *([" ".join(["Not run:", *reasons])] if reasons else [])])
