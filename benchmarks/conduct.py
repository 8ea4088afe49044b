"""From lines of figures to a printed report, a file and an exit code, whatever happens on the way."""

import sys
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path

from benchmarks import machine
from benchmarks.plan import Plan
from benchmarks.report import Line, Report
from sinuous.errors import InputError


def require(needed: dict[str, str]) -> None:
    """Refuse to begin without packages, given as modules and what to install for them.

    Raises
    ------
    InputError
        That names all that are missing.
    """
    missing = [package for module, package in needed.items() if find_spec(module) is None]
    if missing:
        raise InputError("bench", "needs packages that are not installed", missing, "pip install 'sinuous[bench]'")


def conduct(lines: Iterable[Line], plan: Plan, json: bool, out: Path | None) -> int:
    """Gather lines as they are measured, then print and write them.

    Parameters
    ----------
    lines : iterable of Line
        Measured while it is gone through.
    plan : Plan
    json : bool
        Print JSON, one line, instead of tables.
    out : Path, optional
        File to write the JSON to, also when interrupted.

    Returns
    -------
    int
        Exit code: 0 when every goal that concerns correctness was held, whatever the speed; 1 when one was not, or
        when the run was interrupted.
    """
    report = Report(machine.describe(), plan.seed, plan.quick)
    try:
        for line in lines:
            report.lines.append(line)
    except KeyboardInterrupt:
        report.interrupted = True
    finally:  # also when a section breaks: what was measured until then took minutes
        if out is not None:
            out.write_text(report.to_json() + "\n", encoding="utf-8")
        sys.stdout.write(report.to_json() + "\n" if json else report.to_text())
        sys.stdout.flush()
    return 0 if report.correct and not report.interrupted else 1
