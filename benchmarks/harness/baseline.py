"""Figures of an earlier run, kept in a file, and what became worse since by more than the noise.

Machines differ in speed, and one machine from minute to minute. So every time is divided by that of the reference
workload, which was measured around it in the same run, and quotients are compared. How much a quotient may grow is
kept with each figure: twice the range that its rounds showed, and never less than the line's own `noise`. Counts are
compared tightly: a goal of correctness has to be held, and of 10,000 answers none may be lost but where limits of time
decide, which is one.
"""

import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.harness.lines import Line
from benchmarks.harness.markdown import table
from benchmarks.harness.report import Report, number
from sinuous.base.errors import InputError, shown
from sinuous.files.results import plain

SAFETY = 2.0
"""Ranges of the rounds that a figure may change by."""

SAME = ("experiment", "seed", "quick", "settings")
"""What has to be equal for figures to be comparable."""


@dataclass(frozen=True)
class Figure:
    """One figure of a baseline.

    Attributes
    ----------
    section, what, unit : str
    reached : float or None
        In seconds where the unit is one of time; `None` where it was not finite.
    reference : float or None
        Seconds of the reference workload around it.
    less_is_better, correctness : bool
    solved : (int, int) or None
        How many answers were confirmed, out of how many.
    tolerance : float
        Relative change that means nothing.
    slack : float
        Change that means nothing, in the unit of `reached`.
    """

    section: str
    what: str
    unit: str
    reached: float | None
    reference: float | None
    less_is_better: bool
    correctness: bool
    solved: tuple[int, int] | None
    tolerance: float
    slack: float

    @classmethod
    def of(cls, line: Line) -> "Figure":
        """Keep a line."""
        spread = line.spread or 0.0
        return cls(
            section=line.section,
            what=line.what,
            unit=line.unit,
            reached=line.reached if math.isfinite(line.reached) else None,
            reference=line.reference,
            less_is_better=line.less_is_better,
            correctness=line.correctness,
            solved=line.solved,
            tolerance=max(line.noise, SAFETY * spread) if math.isfinite(spread) else line.noise,
            slack=line.slack,
        )


class Change(NamedTuple):
    """What became of one figure: as text, and whether it is worse."""

    section: str
    what: str
    before: str
    now: str
    change: str
    allowed: str
    worse: bool


class Comparison(NamedTuple):
    """Figures that changed by more than the noise, how many there were, and which are in one of both only."""

    changes: list[Change]
    compared: int
    missing: list[str]
    new: list[str]

    @property
    def worse(self) -> bool:
        """Whether something is slower or less often solved, or was not measured at all."""
        return bool(self.missing) or any(change.worse for change in self.changes)

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {**self._asdict(), "changes": [change._asdict() for change in self.changes], "worse": self.worse}

    def to_text(self, name: str) -> str:
        """Return Markdown."""
        worse = sum(change.worse for change in self.changes)
        counts = f"{self.compared} figures compared: {worse} worse, {len(self.changes) - worse} better"
        parts = [
            f"## Against {name}",
            "Times are compared as multiples of the reference workload of the same run; the change is that of the best "
            "round.",
            f"{counts}, the others within their noise.",
        ]
        for word, chosen in (("Worse", True), ("Better", False)):
            rows = [list(change[:-1]) for change in self.changes if change.worse is chosen]
            if rows:
                parts += [f"### {word}", table([["section", "what", "before", "now", "change", "allowed"], *rows])]
        parts += [f"Not measured: {what}" for what in self.missing] + [f"New: {what}" for what in self.new]
        return "\n\n".join(parts) + "\n"


def save(file: Path, report: Report) -> None:
    """Write the figures of a run, to compare later ones with."""
    head = report.to_dict()
    kept = {key: head[key] for key in (*SAME, "rounds", "busy", "machine")}
    figures = [plain(asdict(Figure.of(line))) for line in report.findings.lines]
    lines = ",\n".join("  " + json.dumps(figure, allow_nan=False) for figure in figures)
    text = json.dumps(plain(kept), indent=1, allow_nan=False)[:-2] + f',\n "figures": [\n{lines}\n ]\n}}\n'
    file.write_text(text, encoding="utf-8")


def load(file: Path, option: str) -> dict[str, Any]:
    """Read a baseline; `figures` holds a list of `Figure`.

    Raises
    ------
    InputError
        When it cannot be read, or is no baseline.
    """
    expected = "a file that --save-baseline wrote"
    try:
        held = json.loads(file.read_text(encoding="utf-8"))
        figures = [
            Figure(**{**entry, "solved": None if entry["solved"] is None else tuple(entry["solved"])})
            for entry in held["figures"]
        ]
        return {**{key: held[key] for key in SAME}, "figures": figures}
    except OSError as error:
        raise InputError(option, f"cannot be read: {error.strerror}", str(file), expected) from None
    except (ValueError, TypeError, KeyError):
        raise InputError(option, "", str(file), expected) from None


def check(baseline: dict[str, Any], now: dict[str, Any], option: str) -> None:
    """Refuse to compare what was measured otherwise.

    Raises
    ------
    InputError
        That names the first of `SAME` that differs.
    """
    for key in SAME:
        if baseline[key] != now[key]:
            raise InputError(option, "", baseline[key], f"a baseline measured with {key} {shown(now[key])}")


def compare(figures: Iterable[Figure], lines: Iterable[Line], *, whole: bool = True) -> Comparison:
    """Say what changed by more than the noise.

    Parameters
    ----------
    figures : iterable of Figure
        Of the baseline.
    lines : iterable of Line
        Of this run.
    whole : bool
        Whether all was measured: then a figure of the baseline that is not there any more is missed.
    """
    before = {(figure.section, figure.what): figure for figure in figures}
    now = {(line.section, line.what): line for line in lines}
    both = [key for key in before if key in now]
    changes = [change for key in both for change in _changes(before[key], now[key])]
    missing = [": ".join(key) for key in before if key not in now] if whole else []
    return Comparison(changes, len(both), missing, [": ".join(key) for key in now if key not in before])


def _changes(before: Figure, line: Line) -> Iterator[Change]:
    if before.correctness and line.held is False:
        yield _change(before, line, "", "none", worse=True)
        return
    if before.solved is not None and line.solved is not None:
        yield from _counted(before, before.solved, line.solved)
        if before.unit == "%":  # the same share once more
            return
    if before.reached is None or not math.isfinite(line.reached):
        if (before.reached is None) != (not math.isfinite(line.reached)):
            yield _change(before, line, "", "", worse=before.reached is not None)
        return
    if before.correctness:
        if before.unit not in MEASURED and _loss(before.reached, line) > 0.0:
            yield _change(before, line, "", "none", worse=True)
        return
    yield from _sized(before, line)


MEASURED = ("KiB",)
"""Units of figures of correctness that are noisy themselves: there the goal decides."""


def _loss(reached: float, line: Line) -> float:
    return line.reached - reached if line.less_is_better else reached - line.reached


LOST = 10_000
"""Answers of which one may be lost in any case: another path of a search ends elsewhere now and then."""


def _counted(before: Figure, solved: tuple[int, int], solved_now: tuple[int, int]) -> Iterator[Change]:
    """Compare how many answers were confirmed."""
    (right, runs), (now, count) = solved, solved_now
    allowed = max(0 if before.correctness else 1, count // LOST)
    lost = right * count / runs - now if runs else 0.0
    if abs(lost) > allowed:
        shown = f"{right}/{runs}", f"{now}/{count}", f"{-lost:+.0f}", str(allowed)
        yield Change(before.section, before.what, *shown, lost > 0.0)


def _best(line: Line) -> float:
    """The best of the rounds: whatever else a machine does only makes a figure worse."""
    known = [value for value in line.rounds if math.isfinite(value)] or [line.reached]
    return min(known) if line.less_is_better else max(known)


def _sized(before: Figure, line: Line) -> Iterator[Change]:
    """Compare a time, a rate or a ratio; the first two in terms of the reference workload."""
    assert before.reached is not None
    now = replace(line, reached=_best(line)).at(before.reference)
    growth = (now - before.reached) if before.less_is_better else (before.reached - now)
    # As a factor, either way: what may be a quarter slower may be a fifth less often.
    small, large = sorted((abs(before.reached), abs(now)))
    allowed = max(before.slack, small * before.tolerance)
    if abs(growth) > allowed:
        factor = f"x{large / small:.3g}" if small else ""
        yield _change(before, line, factor, f"x{1.0 + before.tolerance:.3g}", worse=growth > 0.0)


def _change(before: Figure, line: Line, change: str, allowed: str, *, worse: bool) -> Change:
    old = number(math.nan if before.reached is None else before.reached, before.unit)
    return Change(before.section, before.what, old, number(line.reached, line.unit), change, allowed, worse)
