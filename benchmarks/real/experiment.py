"""`python -m benchmarks real`: robots as they are, each figure beside the published one."""

from benchmarks.harness.experiment import Part
from benchmarks.real import calibration, statics, under_load

PARTS: dict[str, Part] = {**calibration.PARTS, **statics.PARTS, **under_load.PARTS}
"""What is measured, in order: calibrated robots, then shapes and solves under load."""
