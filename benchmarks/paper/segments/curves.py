"""What one method needs, size by size."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness.times import exponent
from benchmarks.paper.contest import Record


class Curve(NamedTuple):
    """What one method needs, size by size: seconds an iteration and a solve, and (right, runs)."""

    label: str
    sizes: list[int]
    iteration: list[float]
    solve: list[float]
    worst: list[float]
    iterations: list[float]
    solved: list[tuple[int, int]]

    def slope(self, values: list[float]) -> float:
        """Return the exponent, NaN of less than two sizes."""
        known = [(n, value) for n, value in zip(self.sizes, values, strict=True) if np.isfinite(value)]
        return exponent(*zip(*known, strict=True)) if len(known) > 1 else float("nan")


def piece_name(kind: str, count: int, number: int) -> str:
    """Return the name of a piece."""
    return f"{kind}, {count} segments, round {number}"


def curves_of(
    pieces: dict[str, Any], kind: str, sizes: Sequence[int], labels: Sequence[str], rounds: Iterable[int]
) -> list[Curve]:
    """Return one curve a method, over all rounds; a method that has no size has an empty one."""
    curves = []
    for label in labels:
        curve = Curve(label, [], [], [], [], [], [])
        for count in sizes:
            found = [pieces[piece_name(kind, count, number)].get(label) for number in rounds]
            if found[0] is not None:
                _extend(curve, count, [_together(records) for records in zip(*found, strict=True)])
        curves.append(curve)
    return curves


def _together(records: Sequence[Record]) -> Record:
    """Return one problem's record over all rounds: the quickest, and right if always."""
    seconds = min(record["seconds"] for record in records)
    return {**records[0], "seconds": seconds, "right": all(record["right"] for record in records)}


def _extend(curve: Curve, count: int, records: Sequence[Record]) -> None:
    good = [record for record in records if record["right"]]
    busy = [record for record in good if record["iterations"] > 0]
    seconds, steps = (sum(record[key] for record in busy) for key in ("seconds", "iterations"))
    times = [record["seconds"] for record in good] or [float("nan")]
    curve.sizes.append(count)
    curve.iteration.append(seconds / steps if steps else float("nan"))
    curve.solve.append(float(np.median(times)))
    curve.worst.append(max(times))
    curve.iterations.append(float(np.median([record["iterations"] for record in good])) if good else float("nan"))
    curve.solved.append((len(good), len(records)))


def plain(curve: Curve) -> dict[str, Any]:
    """Return a curve with its exponents, for JSON."""
    slopes = {"iteration_exponent": curve.slope(curve.iteration), "solve_exponent": curve.slope(curve.solve)}
    return {**curve._asdict(), **slopes}
