"""How far the tip leaves a straight line on its way from one configuration to another."""

import numpy as np

from sinuous.base.checks import Floats
from sinuous.kernels.certificate.tip import leave_line, turn_off
from sinuous.kernels.packing import pose_row
from sinuous.kernels.statics.layout import TORSION
from sinuous.model.robot import Robot, robot_group
from sinuous.solver.certificates.steps import LoadedShapes
from sinuous.statics.between import Leave, leave
from sinuous.statics.body import rolled
from sinuous.statics.equilibrium import longest_body


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
        self._ways = LoadedShapes(robot) if robot.has_external_load else None
        body = longest_body(robot) if robot.has_external_load else robot
        self._group, self._q = robot_group(body), np.empty((len(body), 3))
        self._frames, self.line = np.empty((len(body) + 1, 12)), np.zeros((2, 3))
        self._tool = robot.tool
        self._lever = float(np.linalg.norm(robot.tool[:3, 3])), float(np.linalg.norm(robot.tool[:2, 3]))
        ends = np.zeros((2, len(robot), 3))
        self.deviation(ends, 0.0)  # compiled, or loaded
        turn_off(self._group, np.zeros((2, len(body), 3)), self.line, np.zeros((5, 3)), self._q, self._frames)

    def deviation(self, ends: Floats, enough: float) -> float:
        """Return an upper bound of how far the tip is from the line in a motion that is linear in q.

        Parameters
        ----------
        ends : ndarray (2, n, 3)
            The first and the last configuration, where the tip is on the line.
        enough : float
            What is not above this need not be bounded more tightly (length unit).
        """
        if self._ways is not None:
            return self._under_load(self._ways, ends, enough)
        return leave_line(self._group, ends, self.line, enough, self._q, self._frames)

    def angle(self, ends: Floats, turn: Floats) -> float:
        """Return how far the tip is turned from all of a line at places of a motion that is linear in q, at most (rad).

        Parameters
        ----------
        ends : ndarray (2, n, 3)
        turn : ndarray (5, 3)
            How the tip turns along it; see `kernels.certificate.tip.turn_off`.
        """
        if self._ways is not None:
            one, other = self._ways.at(ends[0]), self._ways.at(ends[1])
            group = self._group.copy()
            group[-12:] = pose_row(rolled(0.5 * float(one.rolls[-1] + other.rolls[-1])) @ self._tool)[0]
            arcs = np.stack([one.arcs, other.arcs])
            return float(turn_off(group, arcs, self.line, turn, self._q, self._frames))
        return turn_off(self._group, ends, self.line, turn, self._q, self._frames)

    def _under_load(self, ways: LoadedShapes, ends: Floats, enough: float) -> float:
        """The same for the loaded body; where nothing bounds the equilibria between, as far as the ends show it."""
        one, other = ways.at(ends[0]), ways.at(ends[1])
        if one.states is None or other.states is None:
            return np.inf
        arcs = np.stack([one.arcs, other.arcs])
        group, (lever, across) = self._group.copy(), self._lever
        group[-12:] = pose_row(rolled(float(one.rolls[-1])) @ self._tool)[0]
        bound = float(leave_line(group, arcs, self.line, enough, self._q, self._frames))
        # The tool goes round with the roll of the tip, and bends turn it meanwhile.
        turned = float(np.hypot(*(arcs[1] - arcs[0])[:, :2].T).sum())
        roll = float(np.abs(other.states - one.states)[:, TORSION].sum())
        off = leave(one, other) if ways.bounded else Leave(0.0, 0.0)
        if off.aside == np.inf:
            return np.inf
        return bound + across * roll * (roll + 2.0 * turned) + off.aside + lever * off.turn
