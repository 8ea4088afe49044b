"""Derivatives of many answers at once, as arrays; and what layers of learning libraries have in common.

Layers take batches of goals, and give configurations and their derivatives.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.derivatives.derivative import actuator_change, derivative_of, tip_twist
from sinuous.answer.derivatives.parameters import DerivativePlan
from sinuous.answer.derivatives.preferred import Wish
from sinuous.base import checks
from sinuous.base.arguments import Batch, Parameter, Rows
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, warn_of
from sinuous.base.frozen import call
from sinuous.base.parameter_groups import PerGroup, read_tangent
from sinuous.kernels.derivative import layout as a
from sinuous.kernels.derivative.query import derive_many
from sinuous.kernels.tables import HAS_POSITION, ORIENTATION
from sinuous.model.segment import straight
from sinuous.problem.problem import Preferences, Problem
from sinuous.problem.target import Target, TipGoals, on_rows
from sinuous.problem.target_sets import ManyProblems


class Derivatives:
    """How many answers change with what they depend on, to first order; as `Derivative`, with one more axis in front.

    Attributes
    ----------
    wrt : tuple of str
    regular : ndarray (m,) of bool
        False also where an answer is not solved; its derivatives are NaN.
    q : mapping of str to ndarray (m, n, 3, p)
        Derivatives of the configurations by a group of p parameters.
    tip : mapping of str to ndarray (m, 6, p)
    actuators : mapping of str to ndarray (m, k, p)
    """

    __slots__ = ("_chosen", "_configurations", "_moved", "_problem", "_status", "wrt")

    def __init__(
        self,
        problem: Problem,
        q: Floats,
        wrt: tuple[Parameter, ...],
        moved: Floats,
        status: Floats,
        chosen: Mapping[Parameter, Any],
    ) -> None:
        self._problem, self._configurations, self._moved, self._status = problem, q, moved, status
        self.wrt, self._chosen = wrt, chosen

    def spread(self, count: int, rows: NDArray[np.int64]) -> "Derivatives":
        """Return so many rows, of which these have the numbers `rows`; all others are NaN."""
        moved = np.full((count, *self._moved.shape[1:]), np.nan)
        q, status = np.full((count, *self._configurations.shape[1:]), np.nan), np.full(count, float(a.KINK))
        moved[rows], q[rows], status[rows] = self._moved, self._configurations, self._status
        return type(self)(self._problem, q, self.wrt, moved, status, self._chosen)

    @property
    def regular(self) -> NDArray[np.bool_]:
        """Which answers have a derivative (m,)."""
        return np.asarray(self._status == 0.0)

    @property
    def configuration(self) -> Floats:
        """The configurations (m, n, 3) that were derived: answers, or the minima that preferences have near them."""
        return self._configurations

    @property
    def q(self) -> Mapping[Parameter, Floats]:
        """Derivatives (m, n, 3, p) of the configurations."""
        return PerGroup(self.wrt, self._of_q)

    @property
    def tip(self) -> Mapping[Parameter, Floats]:
        """Twists (m, 6, p) of the tool."""
        return PerGroup(self.wrt, partial(self._each, partial(tip_twist, self._problem)))

    @property
    def actuators(self) -> Mapping[Parameter, Floats]:
        """Derivatives (m, k, p) of the values of all actuators."""
        return PerGroup(self.wrt, partial(self._each, partial(actuator_change, self._problem.robot)))

    def __len__(self) -> int:
        return len(self._moved)

    def vjp(self, cotangent: Batch) -> dict[Parameter, Floats]:
        """Derivatives (m, p) of `sum(cotangent * q)` of each answer by each group, for cotangents (m, n, 3).

        Raises
        ------
        InputError
            When they have another shape.
        """
        given = checks.array("cotangent", cotangent, self._configurations.shape)
        flat = given.reshape(len(self), 1, self._moved.shape[1])
        whole = (flat @ self._moved)[:, 0]
        return {name: whole[:, self._chosen[name]] for name in self.wrt}

    def jvp(self, tangent: Batch | Mapping[Parameter, Batch]) -> Floats:
        """Motions (m, n, 3) of the configurations when the parameters move along tangents (m, p).

        Where an answer has a kink, whatever is active stays as it is; `solutions[i].jvp` tells what happens in this
        direction.

        Raises
        ------
        InputError
            When a name was not asked for, or a tangent has another shape.
        """
        moved = np.zeros(self._configurations.shape)
        for name, value in read_tangent(tangent, self.wrt).items():
            change = self.q[name]
            given = checks.array(f"tangent[{name!r}]", value, (len(self), change.shape[-1]))
            moved += np.einsum("mkcp,mp->mkc", change, given)
        return moved

    def __repr__(self) -> str:
        return call("Derivatives", [f"{len(self):,} answers", ", ".join(self.wrt), f"{self.regular.sum():,} regular"])

    def _of_q(self, name: Parameter) -> Floats:
        chosen = self._moved[:, :, self._chosen[name]]
        return chosen.reshape(*self._configurations.shape, chosen.shape[-1])

    def _each(self, compute: Any, name: Parameter) -> Floats:
        changes, q = self.q[name], self._configurations
        return np.stack([compute(q[i], {name: changes[i]}, name) for i in range(len(self))])


def _nothing_asked(problems: ManyProblems) -> Problem:
    """Some problem for no answers, of the kind of the others."""
    sets = problems.target_sets
    target = Target((0.0, 0.0, 0.0))
    if isinstance(sets, TipGoals):
        place, axis, turn = (part is not None for part in (sets.positions, sets.directions, sets.rotations))
        origin, axes = np.zeros(3), np.eye(3)
        target = Target(origin if place else None, direction=axes[2] if axis else None, rotation=axes if turn else None)
    return Problem.prepared(problems.robot, (target,), problems.scene, problems.tolerance)


def _alike(rows: Floats) -> bool:
    """Whether the same is asked of the targets (m, t, 15) of all answers."""
    asked = rows[:, :, [HAS_POSITION, ORIENTATION]]
    return bool((asked == asked[:1]).all())


def derivatives_of(
    problems: ManyProblems,
    q: Floats,
    solved: NDArray[np.bool_],
    liked: Mapping[int, Wish | None],
    wrt: tuple[Parameter, ...],
) -> Derivatives:
    """Derive those answers `q` (m, n, 3) that are solved; `liked` are chosen by these wishes.

    Raises
    ------
    InputError
        When targets are asked for, and not all answers have equally many.
    """
    runs = problems.target_sets.runs()
    if len(runs) > 1 and "target" in wrt:
        raise InputError("wrt", "needs equally many targets of each answer", "target", "other groups, or one by one")
    q = q.copy()
    problem = problems.problem(0) if len(q) else _nothing_asked(problems)
    plan = DerivativePlan(problem, wrt)
    moved, status = np.empty((len(q), 3 * q.shape[1], plan.columns)), np.empty(len(q))
    group, rows = problems.scene._kernel_group, []
    for first, last in runs:
        own = plan if first == 0 else DerivativePlan(problems.problem(first), wrt)
        rows.append(on_rows(problems.robot, problems.target_sets.chunk(first, last)))
        tables = own.group, group, own.settings, rows[-1], own.asked, own.lines
        workspace = np.empty(own.workspace.size + own.answer)
        derive_many(*tables, q[first:last], workspace, moved[first:last], status[first:last])
    for i, wish in liked.items():
        if wish is None:
            status[i] += a.PREFERRED
        elif solved[i]:
            least = derivative_of(problems.problem(i), q[i], wrt, True, wish)
            q[i], moved[i], status[i] = least.configuration, least._rows.moved, least._rows.answer[a.STATUS]
    moved[~solved], status[~solved] = np.nan, a.KINK
    chosen = {name: plan.chosen(name, problem) for name in wrt}
    if "target" in wrt and rows and not _alike(rows[0]):
        chosen["target"] = slice(*plan.spans["target"])
    return Derivatives(problem, q, wrt, moved, status, chosen)


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
    every = {"positions": (positions, 1), "directions": (directions, 1), "rotations": (rotations, 2)}
    given = {key: (value, axes) for key, (value, axes) in every.items() if value is not None}
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
    given_goals = {key: value for key, value in goals._asdict().items() if value is not None}
    flat = {key: value.reshape(-1, *value.shape[len(front) :]) for key, value in given_goals.items()}
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
