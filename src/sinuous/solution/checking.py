"""Judge shapes from elsewhere, measured or planned: by the independent path, without a solve."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, overload

import numpy as np

from sinuous.arguments import Batch, Number
from sinuous.errors import InputError
from sinuous.problem.problem import check_sizes
from sinuous.problem.target import Targets, Tolerance, as_tolerance, target_list, target_table
from sinuous.robot.robot import Robot
from sinuous.scene.scene import SceneLike, as_snapshot
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.verification import Verification, Verifications, verified

KINDS = {"ok": np.bool_, "segment": np.object_, "obstacle": np.object_, "self_segments": np.object_}
"""What arrays of these attributes of a verification hold; all others are numbers."""


@overload
def check(
    robot: Robot,
    q: Sequence[Sequence[Number]],
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
) -> Verification: ...
@overload
def check(
    robot: Robot,
    q: Sequence[Sequence[Sequence[Number]]],
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
) -> Verifications: ...
@overload
def check(
    robot: Robot,
    q: Batch,
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
) -> Any: ...
def check(
    robot: Robot,
    q: Batch,
    scene: SceneLike | Snapshot | None = None,
    targets: Targets | None = None,
    *,
    tolerance: Tolerance | None = None,
) -> Any:
    """Judge shapes: limits, clearance, and targets where there are any. No kernel is used, nothing is solved.

    Parameters
    ----------
    robot : Robot
    q : array_like (..., n, 3)
        One configuration, or many.
    scene : Scene or list of obstacles, optional
    targets : Target or list of Target, optional
        To be met at once, by every configuration.
    tolerance : Tolerance, optional
        Of the targets; default as for a solve.

    Returns
    -------
    Verification or Verifications
        Of many configurations every attribute is an array (...).

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """
    if not isinstance(robot, Robot):
        raise InputError("robot", "", robot, "a Robot")
    shapes, place = robot.configuration("q", q), as_snapshot(scene)
    check_sizes(robot, place)
    asked = () if targets is None else target_list("targets", targets)
    if asked:
        target_table(robot, asked)
    exactly = as_tolerance(tolerance).for_robot(robot)
    found = [verified(robot, one, place, asked, exactly) for one in shapes.reshape(-1, len(robot), 3)]
    return found[0] if shapes.ndim == 2 else _stacked(found, shapes.shape[:-2])


def _stacked(found: list[Verification], lead: tuple[int, ...]) -> Verifications:
    arrays: dict[str, Any] = {}
    for name in (field.name for field in fields(Verification)):
        values = np.empty(len(found), KINDS.get(name, np.float64))
        for i, one in enumerate(found):
            values[i] = getattr(one, name)
        arrays[name] = values.reshape(lead)
    return Verifications(**arrays)
