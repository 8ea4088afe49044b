"""What every prepared algorithm can do, so that all are called the same way."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from sinuous.checks import Floats
from sinuous.kernels.tables import Budget, Outcome

if TYPE_CHECKING:
    from sinuous.problem.preferences import Preferences
    from sinuous.problem.problem import Problem
    from sinuous.problem.target import Tolerance
    from sinuous.robot.robot import Robot
    from sinuous.scene.scene import Scene
    from sinuous.scene.snapshot import Snapshot


class Case(NamedTuple):
    """What a method is prepared for."""

    robot: "Robot"
    scene: "Scene"
    tolerance: "Tolerance"
    preferences: "Preferences"


class Call(NamedTuple):
    """A compiled function and its arguments: a problem as it is built for a method, to be looked at or timed.

    Attributes
    ----------
    entry : callable
    arguments : tuple
        Groups of robot, scene and settings, targets, initial configurations, budget, workspace, and the array that is
        filled with the answer; layouts: see `sinuous.kernels.tables`.
    """

    entry: Callable[..., Any]
    arguments: tuple[Any, ...]


class Method(Protocol):
    """A prepared algorithm."""

    def build(self, problem: "Problem", initial: Floats, budget: Budget) -> Call:
        """Return what `run` would call."""
        ...

    def run(self, problem: "Problem", initial: Floats, budget: Budget, reference: Floats | None = None) -> Outcome:
        """Solve a problem from the configurations `initial` (g, n, 3), then from own starts.

        `budget` holds the numbers of the own starts to try, from the first up to, without it, the last; a seed; and
        seconds. `reference` (n, 3) is what preferences mean by the initial configuration; by default the first of
        `initial`. The run ends at the first start that is solved; `Outcome.starts` is 0 when the method has no starts
        of these numbers.
        """
        ...

    def run_many(self, scene: "Snapshot", rows: Floats, initial: Floats, budget: Budget, answers: Floats) -> None:
        """Solve m problems in one scene as `run` does one; may run in many threads at once.

        `rows` (m, t, 15) are the targets of each and `initial` (m, g, n, 3) its initial configurations, as kernels take
        them: writable, and in the order of C. Fills `answers` (m, 11 + 3 n).
        """
        ...
