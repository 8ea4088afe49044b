"""What layers of learning libraries have in common: batches of goals in, configurations and their derivatives out."""

import math
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.derivatives.many import Derivatives
from sinuous.base.arguments import Rows
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError


class HostGoals(NamedTuple):
    """Goals as arrays of NumPy: positions (..., 3), directions (..., 3), rotations (..., 3, 3)."""

    positions: Floats | None = None
    directions: Floats | None = None
    rotations: Floats | None = None


def lead_of(positions: Any, directions: Any, rotations: Any) -> tuple[int, ...]:
    """Axes in front of the goals, which are (..., 3) and (..., 3, 3).

    Raises
    ------
    InputError
        When nothing is asked, or both directions and rotations, or the axes in front differ.
    """
    given = {
        key: (value, axes)
        for key, value, axes in (
            ("positions", positions, 1),
            ("directions", directions, 1),
            ("rotations", rotations, 2),
        )
        if value is not None
    }
    if not given:
        raise InputError("positions", "nothing is asked", None, "positions, directions or rotations")
    if directions is not None and rotations is not None:
        raise InputError("directions", "cannot be combined with rotations", tuple(directions.shape), "one of the two")
    leads = {}
    for key, (value, axes) in given.items():
        shape = tuple(value.shape)
        if len(shape) < axes or shape[len(shape) - axes :] != (3,) * axes:
            raise InputError(key, "", shape, f"the shape (..., {', '.join('3' * axes)})")
        leads[key] = shape[: len(shape) - axes]
    first = next(iter(leads))
    for key, lead in leads.items():
        if lead != leads[first]:
            raise InputError(key, "", lead, f"the same axes in front as {first}: {leads[first]}")
    return leads[first]


def solved(solver: Any, goals: HostGoals, initial: Rows | None, unsolved: str) -> tuple[Floats, Floats]:
    """Solve goals with any axes in front by a `Solver`.

    Returns configurations (..., n, 3), and their derivatives (..., n, 3, p).
    The p columns are three for a position, and three for an orientation, as a small rotation in world axes.
    """
    lead, n = lead_of(*goals), len(solver.robot)
    flat = {
        key: value.reshape(-1, *value.shape[len(lead) :]) for key, value in goals._asdict().items() if value is not None
    }
    columns = 3 * len(flat)
    if math.prod(lead) == 0:
        return np.empty((*lead, n, 3)), np.empty((*lead, n, 3, columns))
    given = {} if initial is None else {"initial": _initial(np.asarray(initial), n)}
    answers = solver.solve_many(**flat, **given)
    if unsolved == "raise":
        answers.raise_for_status()
    derivatives: Derivatives = answers.derivative("target")
    change = np.nan_to_num(derivatives.q["target"], nan=0.0)
    return np.array(answers.q).reshape(*lead, n, 3), change.reshape(*lead, n, 3, columns)


def _initial(initial: Floats, n: int) -> Floats:
    return initial if initial.ndim == 2 else initial.reshape(-1, n, 3)


def check_unsolved(unsolved: str) -> str:
    """Check what becomes of goals that are not solved."""
    if unsolved not in ("raise", "best"):
        raise InputError("unsolved", "", unsolved, "raise, or best")
    return unsolved
