"""`python -m benchmarks speed`: every figure that this project claims, measured in one run."""

from benchmarks.harness.experiment import Part
from benchmarks.speed import budgets, cold, endurance, fields, honesty, rivals, startup

PARTS: dict[str, Part] = {
    "cold": cold.measure,
    "reachable": cold.reachable_targets,
    "poses": cold.poses,
    "rivals": rivals.measure,
    "honesty": honesty.measure,
    "budgets": budgets.measure,
    "fields": fields.measure,
    "startup": startup.measure,
    "endurance": endurance.measure,
}
"""What is measured, in order."""
