"""What layers of learning libraries have in common: batches of goals in, configurations and their derivatives out."""

import math
from dataclasses import replace
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from sinuous.answer.derivatives.many import Derivatives
from sinuous.base.arguments import Rows
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, warn_of
from sinuous.model.segment import straight
from sinuous.problem.problem import Preferences

KINK = (
    "touch a limit or an obstacle, or are of a robot that gravity bends: their gradients are one-sided, "
    "or those of the nearest answer"
)
"""What is said of answers without a derivative."""

_SOLVERS: WeakKeyDictionary[Any, Any] = WeakKeyDictionary()
"""Those of the nearest answers, by the solver that was given."""


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


def solved(solver: Any, goals: HostGoals, initial: Rows | None, unsolved: str, lead: bool) -> tuple[Floats, Floats]:
    """Solve goals with any axes in front by a `Solver`; with `lead`, by the answers nearest to where it begins.

    Returns configurations (..., n, 3), and their derivatives (..., n, 3, p).
    The p columns are three for a position, and three for an orientation, as a small rotation in world axes.
    """
    front, n = lead_of(*goals), len(solver.robot)
    flat = {
        key: value.reshape(-1, *value.shape[len(front) :])
        for key, value in goals._asdict().items()
        if value is not None
    }
    columns = 3 * len(flat)
    if math.prod(front) == 0:
        return np.empty((*front, n, 3)), np.empty((*front, n, 3, columns))
    own = _nearest(solver) if lead else solver
    given = {} if initial is None else {"initial": _initial(np.asarray(initial), n)}
    if lead and initial is None:
        given = {"initial": solver.robot.clamp(straight(solver.robot.rows))}
    answers = own.solve_many(**flat, **given)
    if unsolved == "raise":
        answers.raise_for_status()
    derivatives: Derivatives = answers.derivative("target")
    kinks = int((answers.solved & ~derivatives.regular).sum())
    if lead and kinks:
        warn_of([f"{kinks} of {len(answers)} answers {KINK}"])
    change = np.nan_to_num(derivatives.q["target"], nan=0.0)
    q = _led(answers, derivatives.configuration) if lead else np.array(answers.configuration)
    return q.reshape(*front, n, 3), change.reshape(*front, n, 3, columns)


def _nearest(solver: Any) -> Any:
    """Return a solver of the answers nearest to where it begins; one with preferences has its own."""
    if solver.options.prefer or solver.robot.has_external_load or solver.method != "newton":
        return solver
    if solver not in _SOLVERS:
        options = replace(solver.options, prefer=Preferences(start=1.0), clearance=None, self_clearance=None)
        _SOLVERS[solver] = type(solver)._of_checked(solver.robot, solver.scene, options)
    return _SOLVERS[solver]


def _led(answers: Any, least: Floats) -> Floats:
    """Take minima `least` (m, n, 3) where the room that was proved around an answer reaches there."""
    q, change = np.array(answers.configuration), np.abs(least - answers.configuration)
    reach = change[..., :2].sum(axis=(1, 2)) * q[..., 2].sum(axis=1) + change[..., 2].sum(axis=1)
    room = np.nan_to_num(np.minimum(answers.clearance, answers.self_clearance), nan=np.inf)
    moved = answers.solved & (reach < room)
    q[moved] = least[moved]
    return q


def _initial(initial: Floats, n: int) -> Floats:
    return initial if initial.ndim == 2 else initial.reshape(-1, n, 3)


def check_unsolved(unsolved: str) -> str:
    """Check what becomes of goals that are not solved."""
    if unsolved not in ("raise", "best"):
        raise InputError("unsolved", "", unsolved, "raise, or best")
    return unsolved
