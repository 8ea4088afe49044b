"""Inverse kinematics as a function of PyTorch: gradients flow through answers, past limits and obstacles.

Tried with PyTorch 2.13 and 2.14. It needs the extra `torch`; nothing else of the package imports it.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from sinuous.answer.derivatives.many import HostGoals, check_unsolved, lead_of, solved
from sinuous.base.errors import InputError

try:
    import torch
except ImportError as error:  # pragma: no cover
    raise InputError("torch", "is not installed", None, "pip install sinuous[torch]") from error

from torch import Tensor

from sinuous.solver.solver import Solver


class _Solve(torch.autograd.Function):
    """Solve goals. Nothing flows through it: derivatives are its second output, and `_Follow` multiplies by them."""

    generate_vmap_rule = False

    @staticmethod
    def forward(
        positions: Tensor | None,
        directions: Tensor | None,
        rotations: Tensor | None,
        solver: Solver,
        initial: Any,
        unsolved: str,
        lead: bool,
    ) -> tuple[Tensor, Tensor]:
        """Return configurations (..., n, 3) and derivatives (..., n, 3, p)."""
        given = positions, directions, rotations
        kind = next(each for each in given if each is not None)
        goals = HostGoals(*(None if each is None else _array(each) for each in given))
        q, change = solved(solver, goals, None if initial is None else _array(initial), unsolved, lead)
        own = {"dtype": kind.dtype, "device": kind.device}
        return torch.as_tensor(q, **own), torch.as_tensor(change, **own)

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        """Keep gradients out."""
        ctx.mark_non_differentiable(*output)

    @staticmethod
    def vmap(info: Any, in_dims: Any, *inputs: Any) -> Any:
        """Solve all of a batch at once."""
        goals = [
            each
            if each is None
            else (each.expand(info.batch_size, *each.shape) if dim is None else each.movedim(dim, 0))
            for each, dim in zip(inputs[:3], in_dims[:3], strict=True)
        ]
        return _Solve.apply(*goals, *inputs[3:]), (0, 0)


class _Once(torch.autograd.Function):
    """Derivatives (..., n, 3, p) at goals, which have no derivatives of their own."""

    generate_vmap_rule = True

    @staticmethod
    def forward(change: Tensor, *goals: Tensor | None) -> Tensor:
        """Return the derivatives."""
        return change.clone()

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        """Keep nothing."""

    @staticmethod
    def backward(ctx: Any, *_: Any) -> Any:
        """Refuse what would be taken for 0."""
        raise NotImplementedError("sinuous.torch.solve has no second derivatives; expected those of first order alone")

    jvp = backward


class _Follow(torch.autograd.Function):
    """Configurations that move by their derivatives as goals move."""

    generate_vmap_rule = True

    @staticmethod
    def forward(q: Tensor, change: Tensor, moves: Tensor, *goals: Tensor | None) -> Tensor:
        """Return the configurations (..., n, 3): `moves` (..., p) are 0."""
        return q.clone()

    @staticmethod
    def setup_context(ctx: Any, inputs: Any, output: Any) -> None:
        """Keep derivatives, and where they are those."""
        _, change, _, *goals = inputs
        ctx.save_for_backward(change, *goals)
        ctx.save_for_forward(change, *goals)

    @staticmethod
    def backward(ctx: Any, grad: Tensor) -> Any:
        """Return the gradient by `moves`."""
        change = _Once.apply(*ctx.saved_tensors)
        return None, None, torch.einsum("...kcp,...kc->...p", change, grad), None, None, None

    @staticmethod
    def jvp(ctx: Any, _: Any, __: Any, moves: Tensor, *___: Any) -> Tensor:
        """Return how configurations move."""
        return torch.einsum("...kcp,...p->...kc", _Once.apply(*ctx.saved_tensors), moves)


def _array(tensor: Any) -> Any:
    """Numbers of a tensor."""
    if isinstance(tensor, Tensor):
        return tensor.detach().cpu().numpy().astype(np.float64)
    return np.asarray(tensor, np.float64)


def solve(
    solver: Solver,
    positions: Tensor | None = None,
    *,
    directions: Tensor | None = None,
    rotations: Tensor | None = None,
    initial: Any = None,
    unsolved: str = "raise",
    lead: bool = True,
) -> Tensor:
    """Solve goals of the tip; gradients, forward mode and `torch.func.vmap` go through the answers.

    An answer is the nearest one to `initial`, and gradients are its own. At a kink, and in contact
    with an obstacle, whatever is active stays as it is, and a warning says so. A solver with `prefer` has the answers
    that it prefers.

    Parameters
    ----------
    solver : Solver
    positions : Tensor (..., 3), optional
    directions : Tensor (..., 3), optional
        Of the tangent; any length but zero.
    rotations : Tensor (..., 3, 3), optional
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
    Tensor (..., n, 3)
        Configurations, of the type of the goals.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    NotImplementedError
        When a second derivative is asked for.
    NotSolvedError
        When a goal is not solved.
    """
    lead_of(positions, directions, rotations)
    given = positions, directions, rotations
    held = [None if each is None else each.detach() for each in given]
    q, change = _Solve.apply(*held, solver, initial, check_unsolved(unsolved), lead)
    return _Follow.apply(q, change, _moves(given, held), *given)


def _moves(given: Sequence[Tensor | None], held: Sequence[Tensor | None]) -> Tensor:
    """Small motions (..., p) of goals away from where they are held: zero, with the derivatives that goals have."""
    (positions, directions, rotations), (place, along, turned), parts = given, held, []
    if positions is not None:
        parts.append(positions - place)
    if directions is not None and along is not None:
        size = torch.linalg.vector_norm(along, dim=-1, keepdim=True)
        parts.append(torch.linalg.cross(along, directions - along) / size**2)
    if rotations is not None and turned is not None:
        axes = torch.linalg.cross(turned.transpose(-1, -2), (rotations - turned).transpose(-1, -2))
        parts.append(0.5 * axes.sum(dim=-2))
    return torch.cat(parts, dim=-1)
