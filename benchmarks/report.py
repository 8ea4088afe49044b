"""What was measured, line by line: for people a table, for programs JSON."""

import json
import math
from dataclasses import asdict, dataclass, field
from typing import Any

from benchmarks.markdown import table
from benchmarks.timing import Times

UNITS = {"s": 1.0, "ms": 1e3, "us": 1e6}
"""Units of time, and how many of them a second has; other units are those of the number itself."""


@dataclass(frozen=True)
class Goal:
    """What a line is measured against.

    Attributes
    ----------
    value : float
        Bound, inclusive.
    at_most : bool
        Whether less is better.
    correctness : bool
        Whether missing it means that something is wrong, not merely slow.
    """

    value: float
    at_most: bool = True
    correctness: bool = False

    def held(self, reached: float) -> bool:
        """Whether a value is on the right side."""
        return reached <= self.value if self.at_most else reached >= self.value


@dataclass(frozen=True)
class Line:
    """One figure, its goal, and the times that it came from.

    Attributes
    ----------
    section, what : str
        Where it belongs, and what it is.
    reached : float
        In seconds where `unit` is one of time.
    unit : str
    goal : Goal, optional
    times : Times, optional
    solved : (int, int), optional
        How many answers the judge confirmed, out of how many.
    note : str
        How it was measured, or seeds that reproduce what went wrong.
    """

    section: str
    what: str
    reached: float
    unit: str = "us"
    goal: Goal | None = None
    times: Times | None = None
    solved: tuple[int, int] | None = None
    note: str = ""

    @property
    def held(self) -> bool | None:
        """Whether the goal is held; `None` where there is none."""
        return None if self.goal is None else self.goal.held(self.reached)

    @property
    def verdict(self) -> str:
        """One word for the table."""
        if self.goal is None or self.held is None:
            return ""
        return "held" if self.held else ("WRONG" if self.goal.correctness else "missed")


@dataclass
class Report:
    """All lines of one run.

    Attributes
    ----------
    machine : dict
    seed : int
    quick : bool
        Whether counts were cut down: figures of such a run prove that it runs, no more.
    lines : list of Line
    interrupted : bool
    """

    machine: dict[str, str]
    seed: int
    quick: bool
    lines: list[Line] = field(default_factory=list)
    interrupted: bool = False

    @property
    def correct(self) -> bool:
        """Whether every goal that concerns correctness was held; speed is another matter."""
        return all(line.held is not False for line in self.lines if line.goal is not None and line.goal.correctness)

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON; times in seconds, what is not finite as `None`."""
        plain: dict[str, Any] = _finite(
            {
                "machine": self.machine,
                "seed": self.seed,
                "quick": self.quick,
                "interrupted": self.interrupted,
                "correct": self.correct,
                "lines": [{**asdict(line), "held": line.held} for line in self.lines],
            }
        )
        return plain

    def to_json(self) -> str:
        """Return the report as one line of JSON."""
        return json.dumps(self.to_dict(), allow_nan=False)

    def to_text(self) -> str:
        """Return the report for people, as Markdown."""
        facts = {**self.machine, "seed": str(self.seed)}
        parts = ["\n".join(f"- {key}: {value}" for key, value in facts.items())]
        if self.quick:
            parts.append("A quick run: counts are cut down, figures mean little.")
        for section in dict.fromkeys(line.section for line in self.lines):
            lines = [line for line in self.lines if line.section == section]
            parts += [f"## {section}", table([HEADINGS, *(_row(line) for line in lines)])]
            parts += [f"{line.what}: {line.note}" for line in lines if line.note]
        held = [line.held for line in self.lines if line.goal is not None]
        parts.append(f"{held.count(True)} of {len(held)} goals held.")
        if self.interrupted:
            parts.append("Interrupted: this is what was measured until then.")
        return "\n\n".join(parts) + "\n"


def _finite(value: Any) -> Any:
    """Put `None` in the place of numbers that JSON cannot write, however deep."""
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


HEADINGS = ["what", "goal", "reached", "", "solved", "runs", "median", "p95", "p99", "worst"]


def _row(line: Line) -> list[str]:
    goal = "" if line.goal is None else f"{'<=' if line.goal.at_most else '>='} {_number(line.goal.value, line.unit)}"
    solved = "" if line.solved is None else f"{line.solved[0]}/{line.solved[1]}"
    return [line.what, goal, _number(line.reached, line.unit), line.verdict, solved, *_spread(line)]


def _spread(line: Line) -> list[str]:
    if line.times is None:
        return [""] * 5
    t = line.times
    unit = line.unit if line.unit in UNITS else ("us" if t.median < 1e-3 else "ms")
    return [str(t.count), *(_number(value, unit) for value in (t.median, t.p95, t.p99, t.worst))]


def _number(value: float, unit: str) -> str:
    scaled = value * UNITS.get(unit, 1.0)
    if not math.isfinite(scaled):
        return "none"
    text = f"{scaled:.0f}" if scaled == round(scaled) or abs(scaled) >= 1000 else f"{scaled:.3g}"
    return f"{text} {unit}".strip()
