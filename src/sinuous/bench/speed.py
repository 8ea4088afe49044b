"""`sinuous bench speed`: every figure that this project claims, measured in one run."""

import sys
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from sinuous.bench import machine
from sinuous.bench.plan import Plan
from sinuous.bench.report import Line, Report
from sinuous.errors import InputError

SECTIONS = ("cold", "reachable", "growth", "paper", "poses", "rivals", "honesty", "startup", "endurance")
"""Experiments, in order: files in `sinuous.bench.sections`."""

NEEDED = {"casadi": "casadi", "fcl": "python-fcl"}
"""Modules that a plain installation does not bring, and the packages that do."""


def run(
    seed: int = 0,
    quick: bool = False,
    json: bool = False,
    out: Path | None = None,
    sections: Sequence[str] = SECTIONS,
) -> int:
    """Measure, print, and say whether all is right.

    Parameters
    ----------
    seed : int
        Of all random problems.
    quick : bool
        Whether to cut all counts down, to see in seconds that everything runs.
    json : bool
        Print JSON, one line, instead of tables.
    out : Path, optional
        File to write the JSON to, also when interrupted.
    sections : sequence of str
        Experiments to run.

    Returns
    -------
    int
        Exit code: 0 when every goal that concerns correctness was held, whatever the speed; 1 when one was not, or
        when the run was interrupted.

    Raises
    ------
    InputError
        When the packages to measure against are not installed.
    """
    missing = [package for module, package in NEEDED.items() if find_spec(module) is None]
    if missing:
        raise InputError("bench", "needs packages that are not installed", missing, "pip install 'sinuous[bench]'")
    report = Report(machine.describe(), seed, quick)
    try:
        for line in _lines(Plan(seed, quick), sections):
            report.lines.append(line)
    except KeyboardInterrupt:
        report.interrupted = True
    finally:  # also when a section breaks: what was measured until then took minutes
        if out is not None:
            out.write_text(report.to_json() + "\n", encoding="utf-8")
        sys.stdout.write(report.to_json() + "\n" if json else report.to_text())
        sys.stdout.flush()
    return 0 if report.correct and not report.interrupted else 1


def _lines(plan: Plan, sections: Sequence[str]) -> Iterator[Line]:
    for name in sections:
        measure: Callable[[Plan], Iterator[Line]] = import_module(f"sinuous.bench.sections.{name}").measure
        yield from measure(plan)
