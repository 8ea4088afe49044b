"""`python -m benchmarks many`: batches through files, on one worker and on several, killed and not; and a map."""

from collections.abc import Sequence

from benchmarks.harness.experiment import OfSections
from benchmarks.harness.plan import Plan

SECTIONS = ("files", "workers", "deaths", "workspace")
"""What is measured, in order: files of this folder, each with `measure(plan)`."""


class Many(OfSections):
    """The experiment; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    sections : sequence of str
        Some of `SECTIONS`.
    """

    def __init__(self, plan: Plan, sections: Sequence[str] = SECTIONS) -> None:
        super().__init__("many", plan, sections)
