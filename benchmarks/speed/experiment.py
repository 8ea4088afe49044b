"""`python -m benchmarks speed`: every figure that this project claims, measured in one run."""

from benchmarks.harness import Part
from benchmarks.speed import budgets, processes, rivals, scenes, solves

PARTS: dict[str, Part] = {
    "cold": solves.measure,
    "reachable": solves.reachable_targets,
    "poses": solves.poses,
    "rivals": rivals.measure,
    "honesty": solves.false_claims,
    "budgets": budgets.measure,
    "fields": scenes.measure_meshes,
    "parts": scenes.measure_parts,
    "startup": processes.measure_startup,
    "endurance": processes.measure_endurance,
}
"""What is measured, in order."""
