"""How far the tip leaves a straight line on its way from one configuration to another."""

import numpy as np

from sinuous.checks import Floats
from sinuous.kernels.between.tip import leave_line
from sinuous.robot.robot import Robot, robot_group


class Tip:
    """Bounds how far the tip of a robot leaves straight lines, one motion after the other.

    Parameters
    ----------
    robot : Robot

    Attributes
    ----------
    line : ndarray (2, 3)
        Where the line begins and ends; to be written.
    """

    def __init__(self, robot: Robot) -> None:
        self._group, self._q = robot_group(robot), np.empty((len(robot), 3))
        self._frames, self.line = np.empty((len(robot) + 1, 12)), np.zeros((2, 3))
        self.deviation(np.zeros((2, len(robot), 3)), 0.0)  # compiled, or loaded

    def deviation(self, ends: Floats, enough: float) -> float:
        """Return an upper bound of how far the tip is from the line in a motion that is linear in q.

        Parameters
        ----------
        ends : ndarray (2, n, 3)
            The first and the last configuration, where the tip is on the line.
        enough : float
            What is not above this need not be bounded more tightly (length unit).
        """
        bound: float = leave_line(self._group, ends, self.line, enough, self._q, self._frames)
        return bound
