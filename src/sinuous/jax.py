"""Inverse kinematics as a function of JAX: gradients of both modes flow through answers, past limits and obstacles.

Tried with JAX 0.10. It needs the extra `jax`; nothing else of the package imports it. Answers are as exact as the type
of the goals: let JAX use 64 bits, `jax.config.update("jax_enable_x64", True)`.
"""

from functools import partial
from typing import Any

import numpy as np

from sinuous.answer.derivatives.many import HostGoals, check_unsolved, lead_of, solved
from sinuous.base.errors import InputError

try:
    import jax
except ImportError as error:  # pragma: no cover
    raise InputError("jax", "is not installed", None, "pip install sinuous[jax]") from error

import jax.numpy as jnp

from sinuous.solver.solver import Solver

Goals = dict[str, Any]


def _called(solver: Solver, initial: Any, unsolved: str, lead: bool, goals: Goals) -> tuple[Any, Any]:
    """Configurations (..., n, 3) and derivatives (..., n, 3, p), as host arrays of the type of the goals."""
    arrays = {key: np.asarray(value, np.float64) for key, value in goals.items()}
    q, change = solved(solver, HostGoals(**arrays), initial, unsolved, lead)
    kind = next(iter(goals.values())).dtype
    return q.astype(kind), change.astype(kind)


@partial(jax.custom_jvp, nondiff_argnums=(0, 1, 2, 3))
def _answered(solver: Solver, initial: Any, unsolved: str, lead: bool, goals: Goals) -> tuple[Any, Any]:
    """Configurations and derivatives, which have no derivatives of their own."""
    front = lead_of(*(goals.get(key) for key in ("positions", "directions", "rotations")))
    n, kind = len(solver.robot), next(iter(goals.values())).dtype
    shapes = tuple(jax.ShapeDtypeStruct((*front, n, 3, *more), kind) for more in ((), (3 * len(goals),)))
    called = partial(_called, solver, initial, unsolved, lead)
    return jax.pure_callback(called, shapes, goals, vmap_method="broadcast_all")


@_answered.defjvp
def _refuse_second(*_: Any) -> Any:
    raise NotImplementedError("sinuous.jax.solve has no second derivatives; expected those of first order alone")


def _ways(goals: Goals, tangents: Goals) -> list[Any]:
    """Motions of positions (..., 3), and small rotations (..., 3) of directions or rotations, for small changes."""
    parts = [tangents["positions"]] if "positions" in goals else []
    if "directions" in goals:
        own = goals["directions"]
        parts.append(jnp.cross(own, tangents["directions"]) / jnp.sum(own * own, axis=-1, keepdims=True))
    if "rotations" in goals:
        parts.append(0.5 * jnp.cross(goals["rotations"], tangents["rotations"], axis=-2).sum(axis=-1))
    return parts


@partial(jax.custom_jvp, nondiff_argnums=(0, 1, 2, 3))
def _solve(solver: Solver, initial: Any, unsolved: str, lead: bool, goals: Goals) -> Any:
    return _answered(solver, initial, unsolved, lead, goals)[0]


@_solve.defjvp
def _moved(
    solver: Solver, initial: Any, unsolved: str, lead: bool, goals: tuple[Goals], tangents: tuple[Goals]
) -> tuple[Any, Any]:
    q, change = _answered(solver, initial, unsolved, lead, *goals)
    return q, jnp.einsum("...kcp,...p->...kc", change, jnp.concatenate(_ways(*goals, *tangents), axis=-1))


def solve(
    solver: Solver,
    positions: Any = None,
    *,
    directions: Any = None,
    rotations: Any = None,
    initial: Any = None,
    unsolved: str = "raise",
    lead: bool = True,
) -> Any:
    """Solve goals of the tip; `jax.grad`, `jax.jvp`, `jax.jit` and `jax.vmap` go through the answers.

    An answer is the nearest one to `initial`, and gradients are its own. At a kink, and in contact
    with an obstacle, whatever is active stays as it is, and a warning says so. A solver with `prefer` has the answers
    that it prefers.

    Parameters
    ----------
    solver : Solver
    positions : array (..., 3), optional
    directions : array (..., 3), optional
        Of the tangent; any length but zero.
    rotations : array (..., 3, 3), optional
        Instead of `directions`.
    initial : array_like (n, 3) or (..., n, 3), optional
        Constant; by default the straight shape, or what limits leave nearest to it.
    unsolved : str
        `raise`: an answer that is not solved is refused. `best`: its best configuration is returned, and its gradient
        is zero.
    lead : bool
        False: some microseconds an answer instead of 2 ms. Answers are those that the solver ends at, and gradients are
        those of the answers nearest to these, which is not how they change, unless the arm has no motion to spare.

    Returns
    -------
    array (..., n, 3)
        Configurations, of the type of the goals.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    NotImplementedError
        When a second derivative is asked for.
    NotSolvedError
        When a goal is not solved; within `jax.jit` and `jax.vmap` JAX raises an error of its own with this text.
    """
    lead_of(positions, directions, rotations)
    given = {"positions": positions, "directions": directions, "rotations": rotations}
    goals = {key: jnp.asarray(value) for key, value in given.items() if value is not None}
    return _solve(solver, initial, check_unsolved(unsolved), lead, goals)
