"""Figures of an earlier run, kept in a file, and what became worse since by more than the noise.

Machines differ in speed, and one machine from minute to minute. So every time is divided by that of the reference
workload, which was measured around it in the same run, and quotients are compared. How much a quotient may grow is
twice the range that its rounds showed, and never less than the line's own `noise`. Counts are compared tightly: a goal
of correctness has to be held, and of 10,000 answers none may be lost but where limits of time decide, which is one.
"""

import json
import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.harness.experiment import Report
from benchmarks.harness.lines import Goal, Line, number, table
from sinuous.base.errors import InputError, shown
from sinuous.files.documents import json_line

SAFETY = 2.0
"""Ranges of the rounds that a figure may change by."""

LOST = 10_000
"""Answers of which one may be lost in any case: another path of a search ends elsewhere now and then."""

MEASURED = ("KiB",)
"""Units of figures of correctness that are noisy themselves: there the goal decides."""

SAME = ("experiment", "seed", "quick", "settings")
"""What has to be equal for figures to be comparable."""


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
        parts = [
            f"## Against {name}",
            "Times are compared as multiples of the reference workload of the same run; the change is that of the best "
            "round.",
            f"{self.compared} figures compared: {worse} worse, {len(self.changes) - worse} better, the others within "
            "their noise.",
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
    file.write_text(json_line({**kept, "figures": list(map(_kept, report.findings.lines))}) + "\n", encoding="utf-8")


def _kept(line: Line) -> dict[str, Any]:
    """What is kept of a line; `tolerance` is the relative change that means nothing."""
    spread = line.spread or 0.0
    names = ("section", "what", "unit", "reached", "reference", "less_is_better", "correctness", "solved", "slack")
    tolerance = max(line.noise, SAFETY * spread) if math.isfinite(spread) else line.noise
    return {**{name: getattr(line, name) for name in names}, "tolerance": tolerance}


def _line(figure: dict[str, Any]) -> Line:
    """The line of a figure, of which nothing is held: its goal says which way is better."""
    goal = Goal(math.nan, figure["less_is_better"], figure["correctness"])
    reached, solved = figure["reached"], figure["solved"]
    return Line(
        **{key: figure[key] for key in ("section", "what", "unit", "slack", "reference")},
        reached=math.nan if reached is None else reached,
        goal=goal,
        solved=None if solved is None else tuple(solved),
        noise=figure["tolerance"],
    )


def load(file: Path, option: str, now: dict[str, Any]) -> list[Line]:
    """Read the figures of a run that measured the same as one now.

    Raises
    ------
    InputError
        When the file cannot be read or is no baseline, or names the first of `SAME` that differs.
    """
    expected = "a file that --save-baseline wrote"
    try:
        held = json.loads(file.read_text(encoding="utf-8"))
        lines = [_line(figure) for figure in held["figures"]]
        differing = next((key for key in SAME if held[key] != now[key]), None)
    except OSError as error:
        raise InputError(option, f"cannot be read: {error.strerror}", str(file), expected) from None
    except (ValueError, TypeError, KeyError):
        raise InputError(option, "", str(file), expected) from None
    if differing is not None:
        raise InputError(option, "", held[differing], f"a baseline measured with {differing} {shown(now[differing])}")
    return lines


def compare(figures: Iterable[Line], lines: Iterable[Line], *, whole: bool = True) -> Comparison:
    """Say what changed by more than the noise.

    Parameters
    ----------
    figures : iterable of Line
        Of the baseline.
    lines : iterable of Line
        Of this run.
    whole : bool
        Whether all was measured: then a figure of the baseline that is not there any more is missed.
    """
    before, now = ({(line.section, line.what): line for line in own} for own in (figures, lines))
    both = [key for key in before if key in now]
    changes = [change for key in both for change in _changes(before[key], now[key])]
    missing = [": ".join(key) for key in before if key not in now] if whole else []
    return Comparison(changes, len(both), missing, [": ".join(key) for key in now if key not in before])


def _changes(before: Line, line: Line) -> Iterator[Change]:
    if before.correctness and line.held is False:
        yield _change(before, line, "", "none", worse=True)
        return
    if before.solved is not None and line.solved is not None:
        yield from _counted(before, before.solved, line.solved)
        if before.unit == "%":  # the same share once more
            return
    if not (math.isfinite(before.reached) and math.isfinite(line.reached)):
        if math.isfinite(before.reached) != math.isfinite(line.reached):
            yield _change(before, line, "", "", worse=math.isfinite(before.reached))
        return
    loss = line.reached - before.reached if line.less_is_better else before.reached - line.reached
    if not before.correctness:
        yield from _sized(before, line)
    elif before.unit not in MEASURED and loss > 0.0:
        yield _change(before, line, "", "none", worse=True)


def _counted(before: Line, solved: tuple[int, int], solved_now: tuple[int, int]) -> Iterator[Change]:
    """Compare how many answers were confirmed."""
    (right, runs), (now, count) = solved, solved_now
    allowed = max(0 if before.correctness else 1, count // LOST)
    lost = right * count / runs - now if runs else 0.0
    if abs(lost) > allowed:
        told = f"{right}/{runs}", f"{now}/{count}", f"{-lost:+.0f}", str(allowed)
        yield Change(before.section, before.what, *told, lost > 0.0)


def _sized(before: Line, line: Line) -> Iterator[Change]:
    """Compare a time, a rate or a ratio; the first two in terms of the reference workload.

    The best of the rounds counts: whatever else a machine does only makes a figure worse.
    """
    known = [value for value in line.rounds if math.isfinite(value)] or [line.reached]
    best = replace(line, reached=min(known) if line.less_is_better else max(known)).at(before.reference)
    growth = (best - before.reached) if before.less_is_better else (before.reached - best)
    # As a factor, either way: what may be a quarter slower may be a fifth less often.
    small, large = sorted((abs(before.reached), abs(best)))
    if abs(growth) > max(before.slack, small * before.noise):
        factor = f"x{large / small:.3g}" if small else ""
        yield _change(before, line, factor, f"x{1.0 + before.noise:.3g}", worse=growth > 0.0)


def _change(before: Line, line: Line, change: str, allowed: str, *, worse: bool) -> Change:
    told = number(before.reached, before.unit), number(line.reached, line.unit), change, allowed
    return Change(before.section, before.what, *told, worse)
