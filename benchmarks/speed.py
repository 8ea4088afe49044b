"""`python -m benchmarks speed`: every figure that this project claims, measured in one run."""

from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path

from benchmarks.conduct import conduct, require
from benchmarks.plan import Plan
from benchmarks.report import Line

SECTIONS = ("cold", "reachable", "growth", "paper", "poses", "rivals", "honesty", "fields", "startup", "endurance")
"""Experiments, in order: files in `benchmarks.sections`."""

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
        Exit code; see `conduct`.

    Raises
    ------
    InputError
        When the packages to measure against are not installed.
    """
    require(NEEDED)
    plan = Plan(seed, quick)
    return conduct(_lines(plan, sections), plan, json, out)


def _lines(plan: Plan, sections: Sequence[str]) -> Iterator[Line]:
    for name in sections:
        measure: Callable[[Plan], Iterator[Line]] = import_module(f"benchmarks.sections.{name}").measure
        yield from measure(plan)
