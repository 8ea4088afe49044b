"""What is minimised: numbers that a robot has, and those that its answers to the tasks have."""

import math
from collections.abc import Iterable, Sequence
from typing import Any, Literal, get_args

import numpy as np

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.packing import scales_of
from sinuous.model.robot import Robot

Objective = Literal["actuators", "length", "bend", "travel", "tension", "clearance", "uncovered"]
"""What may be minimised.

- `actuators`: their number; of a robot without any, the coordinates that can move;
- `length`: of the whole body, the largest that it may have;
- `bend`: the largest of any segment in any answer, rad;
- `travel`: the largest way of the value of any actuator, between all answers and the straight robot;
- `tension`: the largest of any elastic actuator in any answer;
- `clearance`: the least proved of any answer; it is maximised, so its sign is turned;
- `uncovered`: the share of the targets that are not met. All others are asked only of robots that do all tasks.
"""

OBJECTIVES: tuple[Objective, ...] = get_args(Objective)

MOST_OBJECTIVES = 2
"""Most objectives at once."""


def read_objectives(minimise: Any, template: Robot) -> tuple[Objective, ...]:
    """Check what is to be minimised.

    Raises
    ------
    InputError
    """
    listed = [minimise] if isinstance(minimise, str) else list(minimise) if isinstance(minimise, Iterable) else []
    if not 1 <= len(listed) <= MOST_OBJECTIVES:
        raise InputError("minimise", "", minimise, f"one or two of {', '.join(OBJECTIVES)}")
    for name in listed:
        if name not in OBJECTIVES:
            raise InputError("minimise", "", name, f"one or two of {', '.join(OBJECTIVES)}")
    if len(set(listed)) < len(listed):
        raise InputError("minimise", "names one twice", listed, "two different ones")
    if "travel" in listed and not len(template.drive):
        raise InputError("minimise", "needs actuators", "travel", "a robot with tendons, chambers or actuators")
    if "tension" in listed and template.drive.elastic is None:
        raise InputError("minimise", "needs a stiffness", "tension", "a robot with elastic tendons or chambers")
    return tuple(name for name in listed if name in OBJECTIVES)


def of_robot(name: Objective, robot: Robot) -> float | None:
    """What a robot has whatever its tasks; `None` where answers say it."""
    if name == "actuators":
        moves = scales_of(robot.limits) > 0.0
        return float(len(robot.drive) or moves.sum())
    if name == "length":
        return float(sum(segment.length[1] for segment in robot.segments))
    return None


def of_answers(name: Objective, robot: Robot, shapes: Sequence[Floats], clearance: float | None, share: float) -> float:
    """What answers (..., n, 3) to all tasks have."""
    own = of_robot(name, robot)
    if own is not None:
        return own
    if name == "uncovered":
        return 1.0 - share
    if name == "clearance":
        return 0.0 if clearance is None else -clearance
    return _of_shapes(
        name,
        robot,
        np.concatenate([np.empty((0, len(robot), 3)), *(shape.reshape(-1, len(robot), 3) for shape in shapes)]),
    )


def _of_shapes(name: Objective, robot: Robot, q: Floats) -> float:
    """What the shapes (k, n, 3) of all answers have."""
    if not len(q):
        return 0.0
    if name == "bend":
        return float(np.hypot(q[..., 0], q[..., 1]).max())
    if name == "tension":
        elastic = robot.drive.elastic
        return math.inf if elastic is None else float(np.abs(elastic.balance(q).tensions).max())
    values = robot.to_actuators(np.concatenate([q, robot.straight[None]]))
    return float(np.ptp(values, axis=0).max())
