"""`python -m benchmarks derivatives`: what derivatives of answers cost, and whether differences agree with them."""

from functools import partial

from benchmarks.derivatives import agreement, costs
from benchmarks.harness.experiment import Part

PARTS: dict[str, Part] = {
    "costs": costs.measure,
    **{f"agreement {family}": partial(agreement.measure, family=family) for family in agreement.COMPARED},
}
"""What is measured, in order: of agreement each family is one part, so that a run goes on after the last."""
