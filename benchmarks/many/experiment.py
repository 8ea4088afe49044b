"""`python -m benchmarks many`: batches through files, on one worker and on several, killed and not; and a map."""

from collections.abc import Iterator, Sequence
from functools import partial
from importlib import import_module

from benchmarks.harness.experiment import Measurement, OfLines
from benchmarks.harness.plan import Plan

SECTIONS = ("files", "workers", "deaths", "workspace")
"""What is measured, in order: files of this folder, each with `measure(plan)`."""


class Many(OfLines):
    """The experiment; see `Experiment`.

    Parameters
    ----------
    plan : Plan
    sections : sequence of str
        Some of `SECTIONS`.
    """

    def __init__(self, plan: Plan, sections: Sequence[str] = SECTIONS) -> None:
        super().__init__("many", plan)
        self._sections = sections

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """One section is one piece."""
        for name in self._sections:
            yield name, partial(import_module(f"benchmarks.many.{name}").measure, self.plan)
