"""`python -m benchmarks design`: ten problems, each with a template that does all its tasks."""

from collections.abc import Sequence

from benchmarks.harness.experiment import OfSections
from benchmarks.harness.plan import Plan

SECTIONS = ("contest",)
"""What is measured, in order: files of this folder, each with `measure(plan)`."""


class OfDesigns(OfSections):
    """The experiment; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    sections : sequence of str
        Some of `SECTIONS`.
    """

    def __init__(self, plan: Plan, sections: Sequence[str] = SECTIONS) -> None:
        super().__init__("design", plan, sections)
