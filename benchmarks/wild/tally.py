"""What came of many problems, as plain values that a journal can hold, and the lines of figures made of them."""

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, field
from typing import Any

from benchmarks.harness.lines import Goal, Line
from benchmarks.harness.times import Times
from benchmarks.wild.trials import FALSE, Trial
from benchmarks.wild.worlds import LIMIT

QUICK = 0.3
"""Seconds within which most should be solved."""

MANY, UNIT = 100_000, "of 100,000"
"""What counts are relative to."""

NONE = Goal(0, correctness=True)

SHOWN = 20
"""Names of problems in a note; the results for programs have all."""


@dataclass
class Tally:
    """Counts, times and names of what failed.

    Attributes
    ----------
    seconds : list of float
        Of every problem, solved or not.
    failed : dict of str to str
        Status of every problem that is not solved, by its name.
    late : list of str
        Names of those solved later than `QUICK`.
    false : dict of str to list of str
        Names of the problems with a false claim, by its kind.
    """

    seconds: list[float] = field(default_factory=list)
    failed: dict[str, str] = field(default_factory=dict)
    late: list[str] = field(default_factory=list)
    false: dict[str, list[str]] = field(default_factory=dict)

    def add(self, world: int, trials: Iterable[Trial]) -> None:
        """Count what came of the problems of a world."""
        for i, trial in enumerate(trials):
            name = f"{world}.{i}"
            self.seconds.append(round(trial.seconds, 7))
            if not trial.solved or trial.seconds > LIMIT:
                self.failed[name] = trial.status if trial.seconds <= LIMIT else f"{trial.status}, late"
            elif trial.seconds > QUICK:
                self.late.append(name)
            for kind in trial.false:
                self.false.setdefault(kind, []).append(name)

    @classmethod
    def together(cls, plain: Iterable[dict[str, Any]]) -> "Tally":
        """Sum up what a journal holds."""
        whole = cls()
        for part in plain:
            whole.seconds += part["seconds"]
            whole.failed.update(part["failed"])
            whole.late += part["late"]
            for kind, names in part["false"].items():
                whole.false.setdefault(kind, []).extend(names)
        return whole

    def plain(self) -> dict[str, Any]:
        """Return plain values."""
        return asdict(self)

    def names(self) -> dict[str, Any]:
        """Return the names of all that was not as it should be."""
        return {"failed": self.failed, "late": self.late, "false": self.false}

    def speed(self, section: str, what: str, most: float) -> Iterator[Line]:
        """How many were not solved in time; the goal is `most` of `MANY`."""
        count, times = len(self.seconds), Times.of(self.seconds)
        for limit, goal, names in (
            (LIMIT, Goal(most), [f"{name} {status}" for name, status in self.failed.items()]),
            (QUICK, None, self.late),
        ):
            missed = len(self.failed) + (len(self.late) if limit == QUICK else 0)
            solved = count - missed, count
            reached = MANY * missed / count
            note = _some("problems", names)
            yield Line(section, f"{what} within {limit:g} s", reached, UNIT, goal, times, solved, note)

    def claims(self, section: str) -> Iterator[Line]:
        """How many claims of each kind are false."""
        for kind in FALSE:
            names = self.false.get(kind, [])
            yield Line(section, f"false: {kind}", len(names), "", NONE, note=_some("problems", names))

    def claim(self, section: str, what: str) -> Line:
        """How many claims of any kind are false."""
        names = [f"{name} {kind}" for kind, named in self.false.items() for name in named]
        return Line(section, what, len(names), "", NONE, note=_some("problems", names))


def _some(what: str, names: list[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return f"{what}: {', '.join(names[:SHOWN])}{more}" if names else ""
