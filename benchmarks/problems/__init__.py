"""Random problems from seeds, and the ones that the literature names."""

from benchmarks.problems.clutter import clutter
from benchmarks.problems.published import PAPER_POSES, full_poses, paper_poses
from benchmarks.problems.sets import (
    ProblemSet,
    among_spheres,
    arm,
    direction_targets,
    free_configurations,
    random_configurations,
    reachable,
    relative_tolerance,
)

__all__ = [
    "PAPER_POSES",
    "ProblemSet",
    "among_spheres",
    "arm",
    "clutter",
    "direction_targets",
    "free_configurations",
    "full_poses",
    "paper_poses",
    "random_configurations",
    "reachable",
    "relative_tolerance",
]
