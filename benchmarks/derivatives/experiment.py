"""`python -m benchmarks derivatives`: what derivatives of answers cost, and whether differences agree with them."""

from collections.abc import Sequence

from benchmarks.harness.experiment import OfSections
from benchmarks.harness.plan import Plan

SECTIONS = ("costs", "agreement", "calibration")
"""What is measured, in order: files of this folder, each with `measure(plan)`."""


class OfDerivatives(OfSections):
    """The experiment; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    sections : sequence of str
        Some of `SECTIONS`.
    """

    def __init__(self, plan: Plan, sections: Sequence[str] = SECTIONS) -> None:
        super().__init__("derivatives", plan, sections)
