"""What the paper publishes of its four poses, and what each method made of them here."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from benchmarks.harness.times import Times
from benchmarks.paper.contest import Record, Tally
from benchmarks.paper.entrants import FAITHFUL, Entrant

EXACT = "newton, to 1e-6"
"""Label of our own method when it goes on to 1e-6 mm and rad."""


class Published(NamedTuple):
    """A line of the paper's table, on the authors' machine: seconds, mm, rad, and iterations as far as it says them."""

    seconds: float
    position: float | None
    angle: float | None
    iterations: str = ""


PUBLISHED: dict[str, dict[str, Published]] = {
    "A": {
        "fabrikc": Published(0.183, 0.863, 0.0),
        "dls": Published(0.112, 4.52, 0.85),
        "slinki": Published(0.0122, 0.766, 0.0),
        FAITHFUL: Published(0.0169, 0.0, 0.014),
    },
    "B": {
        "fabrikc": Published(0.206, 0.775, 0.0),
        "dls": Published(0.124, 0.0, 0.0),
        "slinki": Published(0.0118, 0.632, 0.0),
        FAITHFUL: Published(0.0028, 0.0, 0.017),
    },
    "C": {FAITHFUL: Published(0.0159, None, None, "15")},
    "D": {FAITHFUL: Published(0.172, None, None, "over 100")},
}
"""By pose, and by the method here that is nearest: exFABRIKc as `fabrikc`, Opti.DLS as `dls`, Opti.path as what we
read in the paper."""


class Row(NamedTuple):
    """What one method made of one pose: all of its records, summed up."""

    label: str
    records: list[Record]
    tally: Tally
    times: Times

    @property
    def last(self) -> Record:
        """One of the answers, a confirmed one if there is any."""
        return next((record for record in self.records if record["right"]), self.records[-1])

    def plain(self, pose: str) -> dict[str, Any]:
        """Return all that the table says, and the configuration."""
        published = PUBLISHED[pose].get(self.label)
        return {
            "runs": self.tally.runs,
            "right": self.tally.right,
            "wrong": self.tally.wrong,
            "seconds": vars(self.times),
            **{key: self.last[key] for key in ("status", "position", "angle", "excess", "iterations", "starts", "q")},
            "published": None if published is None else published._asdict(),
        }


def rows_of(pose: str, pieces: dict[str, Any], everyone: Sequence[Entrant]) -> list[Row]:
    """Return a row for each method that solved this pose in some piece."""
    own = [piece for name, piece in pieces.items() if name.startswith(f"pose {pose},")]
    rows = []
    for entrant in everyone:
        records = [record for piece in own for record in piece.get(entrant.label, [])]
        if records:
            times = Times.of([record["seconds"] for record in records])
            rows.append(Row(entrant.label, records, Tally.of(records), times))
    return rows
