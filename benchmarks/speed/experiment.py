"""`python -m benchmarks speed`: every figure that this project claims, measured in one run."""

from collections.abc import Iterator, Sequence
from functools import partial
from importlib import import_module

from benchmarks.harness.experiment import Measurement, OfLines
from benchmarks.harness.plan import Plan

SECTIONS = (
    "cold",
    "reachable",
    "growth",
    "paper",
    "poses",
    "rivals",
    "honesty",
    "budgets",
    "fields",
    "startup",
    "endurance",
)
"""What is measured, in order: files of this folder, each with `measure(plan)`."""


class Speed(OfLines):
    """The experiment; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    sections : sequence of str
        Some of `SECTIONS`.
    """

    def __init__(self, plan: Plan, sections: Sequence[str] = SECTIONS) -> None:
        super().__init__("speed", plan)
        self._sections = sections

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """One section is one piece."""
        for name in self._sections:
            yield name, partial(import_module(f"benchmarks.speed.{name}").measure, self.plan)
