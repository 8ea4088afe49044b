"""Bodies at values of the actuators, and where their places are: without load, or in equilibrium under their weight."""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.statics import layout as t
from sinuous.model.robot import Robot
from sinuous.statics.body import body_of, tables_of
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest
from sinuous.studies.calibration.measurements import Place

ANY_CONTRADICTION = 1e300
"""By how much values of rigid actuators may contradict each other: by anything, for that is what is fitted."""


class Point(NamedTuple):
    """A place of N bodies: positions (N, 3), the frames there (N, 3, 3), and derivatives (N, 3, c) by coordinates."""

    position: Floats
    rotation: Floats
    jacobian: Floats


class Free:
    """Bodies without load; their coordinates are configurations (N, n, 3)."""

    def __init__(self, robot: Robot, actuators: Floats) -> None:
        self.robot, self.q = robot, robot.from_actuators(actuators, tolerance=ANY_CONTRADICTION)

    def by_joints(self) -> Floats:
        """Derivatives (N, 3 n, j) of the coordinates by offsets of the joints."""
        where = self.robot._rigid.flat(len(self.robot))[: len(self.robot.joint_names)]
        return np.tile(np.eye(3 * len(self.robot))[:, where], (len(self.q), 1, 1))

    def point(self, place: Place) -> Point:
        """A place of all bodies."""
        return _point(self.robot, self.q, place)

    def tips(self) -> Floats:
        """Poses (N, 4, 4) of the tool."""
        return self.robot.tip(self.q)


def _drives(robot: Robot, actuators: Floats) -> "zip[tuple[Floats, Floats]]":
    """Configurations (n, 3) without load, and displacements (m,), at each of the values (N, m)."""
    shapes = robot.from_actuators(actuators, tolerance=ANY_CONTRADICTION)
    return zip(shapes, robot.drive.motors.displacements(actuators), strict=True)


def _rests(robot: Robot, actuators: Floats) -> list[Rest]:
    return [Rest(robot, q, None, displacements) for q, displacements in _drives(robot, actuators)]


def holds(robot: Robot, actuators: Floats) -> NDArray[np.bool_]:
    """At which values (N, m) of its actuators a robot holds its weight and payload (N,)."""
    if not robot.has_external_load:
        return np.ones(len(actuators), np.bool_)
    return np.array([rest.states is not None for rest in _rests(robot, actuators)], np.bool_)


class Loaded:
    """Bodies under gravity and payload; their coordinates are the states of their arcs, (N, 4) each.

    Raises
    ------
    InputError
        When one has no stable equilibrium.
    """

    def __init__(self, robot: Robot, actuators: Floats) -> None:
        self.robot, self._actuators, self.rests = robot, actuators, _rests(robot, actuators)
        for rest, values in zip(self.rests, actuators, strict=True):
            if rest.states is None:
                problem = "no stable equilibrium was found under gravity and payload at these values"
                raise InputError("actuators", problem, values.tolist(), "a load that the robot can hold")

    @cached_property
    def _rolls(self) -> Floats:
        """By how much arcs are rolled where they begin, and the last where it ends (R, N + 1)."""
        return np.array([np.concatenate([[0.0], rest.rolls]) for rest in self.rests])

    def point(self, place: Place) -> Point:
        """A place of all bodies."""
        own = body_of(self.robot)
        along = place.share * own.counts[place.segment]
        inside = min(int(along), int(own.counts[place.segment]) - 1)
        share = along - inside
        arc = int(own.ends[place.segment] - own.counts[place.segment]) + 1 + inside
        bends, rolls = np.array([rest.arcs for rest in self.rests]), self._rolls
        roll = (1.0 - share) * rolls[:, arc] + share * rolls[:, arc + 1]
        x, y, z = place.offset
        cosine, sine = np.cos(roll), np.sin(roll)
        offset = np.stack([cosine * x - sine * y, sine * x + cosine * y, np.full(len(roll), z)], axis=1)
        position, rotation, jacobian = _point(longest_body(self.robot), bends, Place(arc, share, offset))
        by_arcs = jacobian.reshape(len(roll), 3, -1, 3)
        states = np.zeros((*by_arcs.shape[:3], t.STATE_WIDTH))
        cosine, sine = np.cos(rolls[:, None, :-1]), np.sin(rolls[:, None, :-1])
        states[..., t.BEND_X] = cosine * by_arcs[..., 0] + sine * by_arcs[..., 1]
        states[..., t.BEND_Y] = cosine * by_arcs[..., 1] - sine * by_arcs[..., 0]
        states[..., t.LENGTH] = by_arcs[..., 2]
        swings = by_arcs[..., 1] * bends[:, None, :, 0] - by_arcs[..., 0] * bends[:, None, :, 1]
        states[..., :-1, t.TWIST] = np.cumsum(swings[..., :0:-1], axis=-1)[..., ::-1]  # a twist rolls all arcs beyond
        across = np.stack([-offset[:, 1], offset[:, 0], np.zeros(len(roll))], axis=1)
        spin = rotation @ across[..., None]
        states[..., :arc, t.TWIST] += spin
        states[..., arc, t.TWIST] += share * spin[..., 0]
        turn = np.zeros((len(roll), 3, 3))
        turn[:, 0, 0] = turn[:, 1, 1] = np.cos(roll)
        turn[:, 1, 0] = np.sin(roll)
        turn[:, 0, 1], turn[:, 2, 2] = -turn[:, 1, 0], 1.0
        return Point(position, rotation @ turn, states.reshape(len(roll), 3, -1))

    def sensitivity(self, beside: Sequence[Robot], steps: Floats) -> Floats:
        """Derivatives (R, 4 N, p) of the states by p parameters: robots with so much (p,) more of each."""
        states = self.rests[0].tables.states
        if not beside:
            return np.zeros((len(self.rests), states.size, 0))
        others = [[tables_of(robot, q, (), d) for q, d in _drives(robot, self._actuators)] for robot in beside]
        rows = zip(self.rests, zip(*others, strict=True), strict=True)
        return np.array([rest.answers(tables, steps).reshape(len(beside), -1).T for rest, tables in rows])

    def by_joints(self) -> Floats:
        """Derivatives (R, 4 N, j) of the states by offsets of the joints."""
        where = self.robot._rigid.flat(len(self.robot))[: len(self.robot.joint_names)]
        return np.array([rest.slopes[where].reshape(len(where), -1).T for rest in self.rests])

    def tips(self) -> Floats:
        """Poses (R, 4, 4) of the tool."""
        return np.array([rest.pose(None) for rest in self.rests])


def at_rest(robot: Robot, actuators: Floats) -> Free | Loaded:
    """The bodies of a robot at values (N, m) of its actuators."""
    return Loaded(robot, actuators) if robot.has_external_load else Free(robot, actuators)


def _point(robot: Robot, q: Floats, place: Place) -> Point:
    """A place of bodies without twist; its offset (3,), or (N, 3) of each."""
    k = place.segment
    cut = q.copy()
    cut[:, k] *= place.share
    frames = robot.forward(cut)[:, k]
    jacobian = robot._row_jacobian(cut, k + 1)
    jacobian[:, :, 3 * k : 3 * k + 3] *= place.share
    arm = (frames[:, :3, :3] @ place.offset[..., None])[..., 0]
    slope = jacobian[:, 3:] + np.cross(jacobian[:, :3], arm[:, :, None], axis=1)
    return Point(frames[:, :3, 3] + arm, frames[:, :3, :3], slope)
