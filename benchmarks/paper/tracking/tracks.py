"""What methods made of a path, summed up."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.paper.contest import Record, Tally
from benchmarks.paper.scenes import TOTAL

JUMP = 0.1 * TOTAL
"""Motion (mm) of some point of the body between two waypoints that is a jump to another shape; a step of the path is a
tenth of that."""


Tracks = dict[str, list[list[Record]]]
"""Of every method, the records of every scene."""


def flat(tracks: Sequence[Sequence[Record]]) -> list[Record]:
    """Return the records of all scenes one after the other."""
    return [record for track in tracks for record in track]


def whole(tracks: Sequence[Sequence[Record]]) -> int:
    """Count the scenes whose waypoints were all reached."""
    return sum(all(record["right"] for record in track) for track in tracks)


def least_clearance(records: Sequence[Record]) -> float:
    """Return the least clearance of confirmed waypoints; NaN without any."""
    found = [record["clearance"] for record in records if record["right"]]
    return min(found) if found else float("nan")


def jumps(records: Sequence[Record]) -> int:
    """Count motions that are longer than `JUMP`."""
    return sum(record.get("motion", 0.0) > JUMP for record in records)


def plain(tracks: Sequence[Sequence[Record]]) -> dict[str, Any]:
    """Return all that the table says of one method, for JSON."""
    records = flat(tracks)
    tally = Tally.of(records)
    return {
        "waypoints": tally.runs,
        "right": tally.right,
        "wrong": tally.wrong,
        "paths": whole(tracks),
        "warm": sum(record["right"] and record["start"] == "given" for record in records),
        "seconds": vars(tally.times),
        "iterations": tally.iterations,
        "prepared": float(np.median([track[0]["prepared"] for track in tracks])),
        "least_clearance": least_clearance(records),
        "jumps": jumps(records),
    }
