"""One table for all curves."""

from collections.abc import Sequence

from benchmarks.harness.markdown import figure, span, table
from benchmarks.paper.segments.curves import Curve

HEADINGS = ("method", "segments", "solved", "an iteration", "median solve", "worst solve", "iterations")


def curve_table(curves: Sequence[Curve]) -> str:
    """Return one row a method and size, and the exponents."""
    rows: list[Sequence[str]] = [HEADINGS]
    for curve in curves:
        for i, count in enumerate(curve.sizes):
            right, runs = curve.solved[i]
            times = (span(values[i]) for values in (curve.iteration, curve.solve, curve.worst))
            rows.append([curve.label, str(count), f"{right}/{runs}", *times, figure(curve.iterations[i])])
        exponents = (f"n^{curve.slope(values):.2f}" for values in (curve.iteration, curve.solve))
        rows.append([curve.label, "exponent", "", *exponents, "", ""])
    return table(rows)
