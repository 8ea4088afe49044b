"""The answer to a solve: a status that says what was proved, the configuration, and what was worst."""

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import NotSolvedError
from sinuous.frozen import Frozen
from sinuous.kernels.tables import SOURCES, Outcome
from sinuous.solution.reasons import Reason, base_in, closed_in, target_in, unreachable
from sinuous.solution.status import Status, status_of
from sinuous.solution.verification import Verification, Worst, find_worst, verify

if TYPE_CHECKING:
    from sinuous.problem.problem import Problem


_OVERLAPS = (Status.BLOCKED, Status.UNPROVED, Status.BASE_BLOCKED, Status.TARGET_BLOCKED)
"""Statuses of which clearance is the reason."""


class _Open:
    """A solution while it is put together."""

    problem: "Problem"
    status: Status
    q: Floats
    seconds: float
    method: str
    seed: int
    _outcome: Outcome


class Solution(_Open, Frozen):
    """What a solve found; frozen. On failure it holds the best configuration found.

    With the method `newton` that one keeps all limits; other methods may violate some, and `worst` says which.

    Attributes
    ----------
    status : Status
    q : ndarray (n, 3)
        Configuration: bend_x, bend_y (rad), length of every segment; read-only.
    position_error, angle_error : float or None
        Largest distance (length unit) and angle (rad) to a target; `None` where no target asks for it.
    clearance : float or None
        Proved lower bound of the distance between body and obstacles; `None` without obstacles, or without a proof.
    iterations, starts : int
        Newton iterations in all, and how many starts they came from.
    start : str
        Which kind of start won: given, arc, route, random.
    seconds : float
        Time of the solve alone.
    method : str
    seed : int
    problem : Problem
        What was asked, with the obstacles as they were then.
    """

    __slots__ = ()

    def __new__(cls, problem: "Problem", outcome: Outcome, seconds: float, method: str, seed: int) -> "Solution":
        """Put together what a solve found; the configuration of `outcome` becomes read-only."""
        answer: Any = _Open()
        answer.problem = problem
        answer.status = status_of(outcome)
        answer.q = outcome.q
        answer.seconds = seconds
        answer.method = method
        answer.seed = seed
        answer._outcome = outcome
        outcome.q.setflags(write=False)
        answer.__class__ = cls  # closes it; seven calls of `object.__setattr__` would cost 0.3 us
        made: Solution = answer
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return Solution, (self.problem, self._outcome, self.seconds, self.method, self.seed)

    @property
    def iterations(self) -> int:
        """Iterations of all starts together."""
        return self._outcome.iterations

    @property
    def starts(self) -> int:
        """How many starts were tried."""
        return self._outcome.starts

    @property
    def start(self) -> str:
        """Which kind of start won: given, arc, random or route."""
        return SOURCES[self._outcome.source]

    @property
    def solved(self) -> bool:
        """Whether the status is `solved`."""
        return self.status is Status.SOLVED

    @property
    def position_error(self) -> float | None:
        """Largest distance of an end to its target position; `None` where none is asked for."""
        return self._outcome.position_error if any(t.position is not None for t in self.problem.targets) else None

    @property
    def angle_error(self) -> float | None:
        """Largest angle (rad) of an end to its target orientation; `None` where none is asked for."""
        return (
            self._outcome.angle_error
            if any(t.direction is not None or t.rotation is not None for t in self.problem.targets)
            else None
        )

    @property
    def clearance(self) -> float | None:
        """Proved lower bound of the distance between body and obstacles."""
        return self._outcome.clearance if self.solved and len(self.problem.scene) else None

    @property
    def base(self) -> Floats:
        """Pose (4, 4) of the robot's base."""
        return self.problem.robot.base

    @cached_property
    def reason(self) -> Reason | None:
        """What proves that there is no solution; `None` when nothing does."""
        if self.status is Status.OUT_OF_REACH:
            return unreachable(self.problem)
        if self.status is Status.TARGET_BLOCKED:
            return target_in(self.problem)
        if self.status is Status.BASE_BLOCKED:
            return base_in(self.problem)
        if self.status is Status.NO_ROUTE:
            return closed_in(self.problem, self._outcome.cell)
        return None

    @cached_property
    def worst(self) -> Worst | None:
        """The constraint farthest from being met; `None` when solved."""
        return None if self.solved else find_worst(self.problem, self.q, self.status in _OVERLAPS)

    def verify(self) -> Verification:
        """Recompute everything by an independent, slow path; see `sinuous.solution.verification`."""
        return verify(self.problem, self.q)

    def raise_for_status(self) -> "Solution":
        """Return this solution when it is solved.

        Raises
        ------
        NotSolvedError
            When it is not.
        """
        if not self.solved:
            raise NotSolvedError(str(self), self)
        return self

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain values, in the order of the file format."""
        worst, reason = self.worst, self.reason
        return {
            "status": str(self.status),
            "q": self.q.tolist(),
            "base": self.base.tolist(),
            "position_error": self.position_error,
            "angle_error": self.angle_error,
            "clearance": None if self.clearance is None or np.isinf(self.clearance) else self.clearance,
            "worst": None
            if worst is None
            else {
                "constraint": worst.constraint,
                "segment": worst.segment,
                "obstacle": worst.obstacle,
                "amount": worst.amount,
            },
            "reason": None
            if reason is None
            else {
                "bound": reason.bound,
                "needed": reason.needed,
                "available": reason.available,
                "obstacle": reason.obstacle,
            },
            "iterations": self.iterations,
            "starts": self.starts,
            "start": self.start,
            "seconds": self.seconds,
            "method": self.method,
            "seed": self.seed,
        }

    def __repr__(self) -> str:
        parts = [f"Solution: {self.status} ({self.status.sentence})"]
        if self.reason is not None:
            parts.append(f"  reason     {self.reason}")
        if self.worst is not None:
            parts.append(f"  worst      {self.worst}")
        for label, value in (
            ("position", self.position_error),
            ("angle", self.angle_error),
            ("clearance", self.clearance),
        ):
            if value is not None:
                parts.append(f"  {label:<10} {value:.3g}")
        parts.append(
            f"  effort     {self.iterations} iterations from {self.starts} starts, {1e6 * self.seconds:.0f} us"
        )
        parts.append("  q          " + np.array2string(self.q, precision=4, suppress_small=True, prefix=" " * 13))
        return "\n".join(parts)
