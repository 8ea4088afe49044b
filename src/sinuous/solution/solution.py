"""The answer to a solve: a status that says what was proved, the configuration, and what was worst."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sinuous.checks import Floats
from sinuous.errors import NotSolvedError
from sinuous.kernels.tables import SOURCES, Outcome
from sinuous.solution.reasons import Reason, base_in, closed_in, target_in, unreachable
from sinuous.solution.status import Status, status_of
from sinuous.solution.verification import Verification, Worst, find_worst, verify

if TYPE_CHECKING:
    from sinuous.problem.problem import Problem


_OVERLAPS = (Status.BLOCKED, Status.UNPROVED, Status.BASE_BLOCKED, Status.TARGET_BLOCKED)
"""Statuses of which clearance is the reason."""


class Solution:
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
    route : ndarray (k, 3) or None
        Where the start came from a route: its points, from the base to the target; read-only. To be drawn beside the
        body, which may leave it.
    seconds : float
        Time of the solve alone.
    method : str
    seed : int
    problem : Problem
        What was asked, with the obstacles as they were then.
    """

    # Properties over private slots: setting attributes as `sinuous.frozen.Frozen` does would cost a solve 0.3 us.
    __slots__ = ("_method", "_outcome", "_problem", "_reason", "_seconds", "_seed", "_status", "_worst")

    _reason: Reason | None
    _worst: Worst | None

    def __init__(self, problem: "Problem", outcome: Outcome, seconds: float, method: str, seed: int) -> None:
        self._problem = problem
        self._status = status_of(outcome)
        self._outcome = outcome
        self._seconds = seconds
        self._method = method
        self._seed = seed
        # By position: by its name, or by `flags`, it takes three times as long.
        outcome.q.setflags(False)  # type: ignore[call-arg]

    def __copy__(self) -> "Solution":
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> "Solution":
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return Solution, (self.problem, self._outcome, self.seconds, self.method, self.seed)

    @property
    def problem(self) -> "Problem":
        """What was asked, with the obstacles as they were then."""
        return self._problem

    @property
    def status(self) -> Status:
        """How it ended."""
        return self._status

    @property
    def q(self) -> Floats:
        """Configuration (n, 3), read-only."""
        return self._outcome.q

    @property
    def seconds(self) -> float:
        """Time of the solve alone."""
        return self._seconds

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._method

    @property
    def seed(self) -> int:
        """Of the scattered starts."""
        return self._seed

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
    def route(self) -> Floats | None:
        """Points (k, 3) of the route that the start was laid along; `None` unless a route led to the solution."""
        return self._outcome.route

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

    @property
    def reason(self) -> Reason | None:
        """What proves that there is no solution; `None` when nothing does."""
        if not hasattr(self, "_reason"):
            self._reason = self._find_reason()
        return self._reason

    @property
    def worst(self) -> Worst | None:
        """The constraint farthest from being met; `None` when solved."""
        if not hasattr(self, "_worst"):
            self._worst = None if self.solved else find_worst(self.problem, self.q, self.status in _OVERLAPS)
        return self._worst

    def _find_reason(self) -> Reason | None:
        if self.status is Status.OUT_OF_REACH:
            return unreachable(self.problem)
        if self.status is Status.TARGET_BLOCKED:
            return target_in(self.problem)
        if self.status is Status.BASE_BLOCKED:
            return base_in(self.problem)
        if self.status is Status.NO_ROUTE:
            return closed_in(self.problem, self._outcome.cell)
        return None

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
