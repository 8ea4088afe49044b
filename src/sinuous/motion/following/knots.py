"""The knots of a motion while it is found."""

from typing import NamedTuple

from sinuous.checks import Floats
from sinuous.motion.following.straight import Straight
from sinuous.problem.target import Target
from sinuous.solution.solution import Solution


class Knot(NamedTuple):
    """A configuration of the motion, and how the robot came there.

    Attributes
    ----------
    q : ndarray (n, 3)
    came : ndarray (1, 14) or None
        What is proved of the step that leads there; the first knot has none.
    targets : tuple of Target
        What is asked there; nothing on the way around.
    solution : Solution or None
        The one that it was taken from.
    way : Straight or None
        The line that the tip follows in the step that leads there, where it has to.
    shares : (float, float)
        The part of that line.
    fixed : bool
        Whether it has to stay: the start.
    time : float
        When the robot is there, where obstacles move.
    """

    q: Floats
    came: Floats | None
    targets: tuple[Target, ...] = ()
    solution: Solution | None = None
    way: Straight | None = None
    shares: tuple[float, float] = (0.0, 1.0)
    fixed: bool = False
    time: float = 0.0

    @property
    def clear(self) -> tuple[float, float]:
        """Proved clearance and self-clearance there; 0 where they are not known."""
        if self.solution is None or not self.solution.solved:
            return 0.0, 0.0
        outcome = self.solution._outcome
        return outcome.clearance, outcome.self_clearance

    @property
    def begin(self) -> Solution | Floats:
        """What a solve may go on from there: the solution, which is not checked again, if there is one."""
        return self.q if self.solution is None else self.solution
