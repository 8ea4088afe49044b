"""`python -m benchmarks derivatives`: what derivatives of answers cost, and whether differences agree with them."""

from collections.abc import Iterator, Sequence
from functools import partial

from benchmarks.derivatives.agreement import COMPARED
from benchmarks.derivatives.agreement import measure as measure_family
from benchmarks.harness.experiment import Measurement, OfSections
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

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """One section is one piece; of agreement each family is one, so that a run goes on after the last."""
        for name, measure in super().parts():
            if name == "agreement":
                for family in COMPARED:
                    yield f"{name} {family}", partial(measure_family, self.plan, family)
            else:
                yield name, measure
