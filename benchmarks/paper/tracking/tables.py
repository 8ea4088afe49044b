"""One table a density of spheres."""

from collections.abc import Sequence

from benchmarks.harness.markdown import figure, span, table
from benchmarks.paper.contest import Tally
from benchmarks.paper.tracking.tracks import Tracks, flat, plain

HEADINGS = (
    "method", "tracked", "", "whole paths", "from the last shape", "median", "p95", "worst", "iterations",
    "least clearance, mm", "jumps", "preparing",
)  # fmt: skip


def density_table(tracks: Tracks) -> str:
    """Return the table of one density, with what any of the methods reached."""
    rows: list[Sequence[str]] = [HEADINGS]
    for label, scenes in tracks.items():
        summary, tally = plain(scenes), Tally.of(flat(scenes))
        rows.append(
            [
                label,
                f"{tally.right}/{tally.runs}",
                f"{tally.percent:.1f} %",
                f"{summary['paths']}/{len(scenes)}",
                str(summary["warm"]),
                *(span(seconds) for seconds in (tally.times.median, tally.times.p95, tally.times.worst)),
                figure(tally.iterations),
                figure(summary["least_clearance"], ".2g"),
                str(summary["jumps"]),
                span(summary["prepared"]),
            ]
        )
    everyone = [flat(scenes) for scenes in tracks.values()]
    reached = sum(any(record["right"] for record in waypoint) for waypoint in zip(*everyone, strict=True))
    total = len(everyone[0])
    rows.append(["by any", f"{reached}/{total}", f"{100.0 * reached / total:.1f} %", *[""] * (len(HEADINGS) - 3)])
    return table(rows)
