"""What a run found and where: for people Markdown, for programs JSON."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from benchmarks.harness.experiment import Experiment, Findings
from benchmarks.harness.lines import UNITS, Line
from benchmarks.harness.markdown import table

BUSY = 0.1
"""Share of the processor that other processes may have before times mean little."""


@dataclass(frozen=True)
class Report:
    """The findings of one run.

    Attributes
    ----------
    experiment : Experiment
    machine : dict of str to str
    findings : Findings
    interrupted : bool
        Whether some of the pieces are missing.
    """

    experiment: Experiment
    machine: dict[str, str]
    findings: Findings
    interrupted: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return plain values for JSON; times in seconds."""
        plan, found = self.experiment.plan, self.findings
        return {
            "experiment": self.experiment.name,
            "machine": self.machine,
            "seed": plan.seed,
            "quick": plan.quick,
            "rounds": plan.rounds,
            "settings": dict(self.experiment.settings),
            "protocol": self.experiment.protocol,
            "interrupted": self.interrupted,
            "correct": found.correct,
            "busy": found.busy,
            "lines": [{**asdict(line), "held": line.held, "spread": line.spread} for line in found.lines],
        }

    def to_text(self) -> str:
        """Return the report for people, as Markdown."""
        plan, found = self.experiment.plan, self.findings
        shown = {**self.machine, "seed": str(plan.seed)}
        if self.experiment.protocol:
            shown["protocol"] = self.experiment.protocol
        if plan.rounds > 1:
            shown["rounds"] = str(plan.rounds)
        parts = ["\n".join(f"- {key}: {value}" for key, value in shown.items() if value != "not installed")]
        if plan.quick:
            parts.append("A quick run: counts are cut down, figures mean little.")
        if found.busy > BUSY:
            parts.append(
                f"BUSY: other processes had up to {100.0 * found.busy:.0f} % of the processor while this was measured; "
                "times mean little."
            )
        parts += _sections(found.lines)
        if self.interrupted:
            parts.append("Interrupted: this is what was measured until then.")
        return "\n\n".join(parts) + "\n"


def _sections(lines: Sequence[Line]) -> list[str]:
    """One table a section, then the notes of its lines; at the end how many goals were held."""
    if not lines:
        return []
    parts = []
    spread = any(line.spread is not None for line in lines)
    headings = [*HEADINGS, "spread"] if spread else HEADINGS
    for section in dict.fromkeys(line.section for line in lines):
        own = [line for line in lines if line.section == section]
        parts += [f"## {section}", table([headings, *(_row(line)[: len(headings)] for line in own)])]
        parts += [f"{line.what}: {line.note}" for line in own if line.note]
    held = [line.held for line in lines if line.goal is not None]
    return [*parts, f"{held.count(True)} of {len(held)} goals held."]


HEADINGS = ["what", "goal", "reached", "", "solved", "runs", "median", "p95", "p99", "worst"]


def _row(line: Line) -> list[str]:
    goal = "" if line.goal is None else f"{'<=' if line.goal.at_most else '>='} {number(line.goal.value, line.unit)}"
    solved = "" if line.solved is None else f"{line.solved[0]}/{line.solved[1]}"
    spread = "" if line.spread is None else f"{100.0 * line.spread:.1f} %"
    return [line.what, goal, number(line.reached, line.unit), line.verdict, solved, *_times(line), spread]


def _times(line: Line) -> list[str]:
    if line.times is None:
        return [""] * 5
    t = line.times
    unit = line.unit if line.unit in UNITS else ("us" if t.median < 1e-3 else "ms")
    return [str(t.count), *(number(value, unit) for value in (t.median, t.p95, t.p99, t.worst))]


def number(value: float, unit: str) -> str:
    """Text of a value, times in seconds, in its unit."""
    scaled = value * UNITS.get(unit, 1.0)
    if not math.isfinite(scaled):
        return "none"
    text = f"{scaled:.0f}" if scaled == round(scaled) or abs(scaled) >= 1000 else f"{scaled:.3g}"
    return f"{text} {unit}".strip()
