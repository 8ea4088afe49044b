"""A motion in words."""

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from sinuous.solution.status import Status
from sinuous.words import duration

if TYPE_CHECKING:
    from sinuous.motion.motion import Motion


def text(motion: "Motion") -> str:
    """Return what `print` shows of a motion."""
    bend, length = motion.largest_step
    parts = [f"Motion: {motion.status} ({_sentence(motion)})"]
    if motion.clearance is not None:
        where = "all the way" if motion.between == "proved" and len(motion.q) > 1 else "at the waypoints"
        parts.append(f"  clearance  {motion.clearance:.3g} {where}")
    if motion.between == "unproved":
        parts.append(f"  between    {len(motion.unproved_steps)} of {len(motion.q) - 1} steps are not proved clear")
    if len(motion.q) > 1:
        parts.append(f"  time       {motion.times[0]:.4g} to {motion.times[-1]:.4g}, {len(motion.q)} knots")
    parts.append(f"  steps      at most {bend:.3g} rad of bend and {length:.3g} of length")
    parts.append(f"  effort     {duration(motion.seconds)}{_median(motion)}")
    return "\n".join(parts)


def counted(motion: "Motion") -> str:
    """Say how many waypoints the motion comes to: a plan may know a shape for its goal, and no way there."""
    reached = len(motion.solutions) - motion.waypoint_knots.count(None)
    return f"{reached} of {len(motion.solutions) + motion.remaining} waypoints"


def _sentence(motion: "Motion") -> str:
    failed = next((i for i, solution in enumerate(motion.solutions) if not solution.solved), None)
    if failed is not None:
        solution = motion.solutions[failed]
        return f"{counted(motion)}; waypoint {failed + 1}: {solution.worst or solution.sentence}"
    begun = counted(motion) if motion.solutions else motion.status.sentence
    if motion.worst is not None:
        return f"{begun}; {motion.worst}"
    if motion.solutions and motion.status is Status.TIME_LIMIT and not motion.remaining:
        return f"{begun}; {motion.status.sentence}"
    return f"{begun}; {_where(motion)} not proved clear" if motion.unproved_steps else begun


def _where(motion: "Motion") -> str:
    """Between which waypoints the first step that is not proved lies."""
    first = motion.unproved_steps[0]
    known = [(i, knot) for i, knot in enumerate(motion.waypoint_knots, 1) if knot is not None]
    for (i, a), (j, b) in pairwise(known):
        if a < first <= b:
            return f"the way from waypoint {i} to {j} is"
    return f"step {first} is"


def _median(motion: "Motion") -> str:
    if not motion.solutions:
        return ""
    middle = float(np.median([solution.seconds for solution in motion.solutions]))
    return f", median {duration(middle)} a solve"
