"""`python -m benchmarks speed`: every figure that this project claims, measured in one run."""

from collections.abc import Sequence

from benchmarks.harness.experiment import OfSections
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


class Speed(OfSections):
    """The experiment; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    sections : sequence of str
        Some of `SECTIONS`.
    """

    def __init__(self, plan: Plan, sections: Sequence[str] = SECTIONS) -> None:
        super().__init__("speed", plan, sections)
