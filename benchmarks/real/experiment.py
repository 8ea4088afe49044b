"""`python -m benchmarks real`: robots as they are, each figure beside the published one."""

from collections.abc import Iterator

from benchmarks.harness.experiment import Measurement, OfLines
from benchmarks.harness.plan import Plan
from benchmarks.real import calibration, statics, under_load


class Real(OfLines):
    """The experiment; see `Experiment`."""

    def __init__(self, plan: Plan) -> None:
        super().__init__("real", plan)

    def parts(self) -> Iterator[tuple[str, Measurement]]:
        """Calibrated robots, then shapes and solves under load."""
        yield from calibration.parts(self.plan)
        yield from statics.parts(self.plan.quick)
        yield from under_load.parts(self.plan.quick)
