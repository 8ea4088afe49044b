"""`python -m benchmarks speed`: every figure that this project claims, measured in one run."""

from benchmarks.harness import Part
from benchmarks.speed import budgets, endurance, fields, parts, rivals, solves, startup

PARTS: dict[str, Part] = {
    "cold": solves.measure,
    "reachable": solves.reachable_targets,
    "poses": solves.poses,
    "rivals": rivals.measure,
    "honesty": solves.false_claims,
    "budgets": budgets.measure,
    "fields": fields.measure,
    "parts": parts.measure,
    "startup": startup.measure,
    "endurance": endurance.measure,
}
"""What is measured, in order."""
