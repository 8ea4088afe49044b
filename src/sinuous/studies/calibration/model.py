"""Where a robot's places are for values of its actuators, and exact derivatives of that by the parameters of a fit.

In equilibrium `S (q - rest) = A' f` with `f = k max(0, d - A q)`; a change of anything in it moves `q` by
`H^-1 (A' df + dA' f - dS (q - rest) + S drest)`, where `H = S + A' k A` over the lines that pull. Rigid actuators are
lines of stiffness 1 that push, too, and nothing resists them: that is their least-squares solution. Bodies that gravity
bends are in equilibrium (`sinuous.kernels.statics.table_derivatives`).

Bodies at values of the actuators, and where their places are: without load, or in equilibrium under their weight.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.kernels.statics import layout as t
from sinuous.model.elastic import Springs
from sinuous.model.robot import Robot
from sinuous.statics.body import body_of, tables_of
from sinuous.statics.equilibrium import longest_body
from sinuous.statics.rest import Rest
from sinuous.studies.calibration.measurements import Place
from sinuous.studies.calibration.parameters import Values, changed, is_fixed, is_soft, lines_of

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
        states[..., :-1, t.TORSION] = np.cumsum(swings[..., :0:-1], axis=-1)[..., ::-1]  # a twist rolls all arcs beyond
        across = np.stack([-offset[:, 1], offset[:, 0], np.zeros(len(roll))], axis=1)
        spin = rotation @ across[..., None]
        states[..., :arc, t.TORSION] += spin
        states[..., arc, t.TORSION] += share * spin[..., 0]
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


STEP = 1e-6
"""Of differences of tables of loaded bodies: share of how far a parameter may be off, or of gravity."""


class RobotModel(NamedTuple):
    """A robot, its drawn self, and what is asked about it.

    Attributes
    ----------
    robot, drawn : Robot
        With the values of the parameters, and without.
    values : Values
    places : tuple of Place
    """

    robot: Robot
    drawn: Robot
    values: Values
    places: tuple[Place, ...]


def model(drawn: Robot, values: Values, places: tuple[Place, ...]) -> RobotModel:
    """Make a model of a robot with other values of its parameters."""
    tool = values.of("tool")
    if tool is not None:
        places = tuple(place._replace(offset=place.offset + tool) for place in places)
    return RobotModel(changed(drawn, values), drawn, values, places)


def predicted(own: RobotModel, actuators: Floats) -> Floats:
    """Points (N, k, 3) of the places at values of actuators (N, m), in the robot's world."""
    bodies = at_rest(own.robot, actuators)
    return np.stack([bodies.point(place).position for place in own.places], axis=1)


def derivatives(own: RobotModel, actuators: Floats, of_gravity: bool = False) -> tuple[Floats, Floats]:
    """Points (N, k, 3), and their derivatives (N, k, 3, P) by the parameters, and by gravity (3) if asked."""
    bodies, tool = at_rest(own.robot, actuators), own.values.columns("tool")
    if isinstance(bodies, Loaded):
        sensitivity = bodies.sensitivity(*_beside(own, of_gravity))
    elif not own.robot.drive.coordinates.free:  # planes turn with tendons
        robots, steps = _beside(own, False)
        others = [each for each in (at_rest(robot, actuators) for robot in robots) if not isinstance(each, Loaded)]
        moved = [(each.q - bodies.q) / h for each, h in zip(others, steps, strict=True)]
        sensitivity = np.moveaxis(np.reshape(moved, (len(steps), len(actuators), 3 * len(own.robot))), 0, -1)
    else:
        sensitivity = _sensitivity(own, actuators, bodies.q)
    joints = own.values.columns("joints")
    if joints is not None:  # where a joint stands with an offset it would be with so much more of its value
        sensitivity[..., joints] = bodies.by_joints()
    points, slopes = [], []
    for place in own.places:
        point = bodies.point(place)
        slope = np.matmul(point.jacobian, sensitivity)
        if tool is not None:
            slope[..., tool] += point.rotation
        points.append(point.position)
        slopes.append(slope)
    return np.stack(points, axis=1), np.stack(slopes, axis=1)


def _beside(own: RobotModel, of_gravity: bool) -> tuple[list[Robot], Floats]:
    """Robots with a little more of each parameter, and by how much."""
    steps, gravity = STEP * own.values.widths, own.robot.gravity
    robots = [changed(own.drawn, own.values.with_x(own.values.x + step)) for step in np.diag(steps)]
    if of_gravity and gravity is not None:
        step = STEP * float(np.linalg.norm(gravity))
        robots += [own.robot.changed(gravity=gravity + axis) for axis in step * np.eye(3)]
        steps = np.concatenate([steps, np.full(3, step)])
    return robots, steps


def _springs(robot: Robot) -> tuple[Springs, NDArray[np.intp]]:
    """All actuators as lines, and the coordinates that move."""
    drive = robot.drive
    columns = np.flatnonzero(drive.coordinates.unlocked)
    stiffness, one_sided = np.ones(len(drive)), np.zeros(len(drive), np.bool_)
    resistance, rest = np.zeros(3 * len(robot)), np.zeros(3 * len(robot))
    arms = np.array(drive.jacobian)
    if drive.elastic is not None:
        own = drive.elastic.springs
        stiffness[drive.elastic.places], one_sided[drive.elastic.places] = own.stiffness, own.one_sided
        where = columns[drive.elastic.determined]
        resistance[where], rest[where] = np.broadcast_to(own.resistance, (1, len(where)))[0], own.rest
    return Springs(resistance[columns], rest[columns], arms[:, columns], stiffness, one_sided), columns


def _sensitivity(own: RobotModel, actuators: Floats, q: Floats) -> Floats:
    """Derivatives (N, 3 n, P) of configurations by the parameters."""
    robot, values = own.robot, own.values
    places, sets = lines_of(robot)
    springs, columns = _springs(robot)
    bends = [np.flatnonzero((columns // 3 == k) & (columns % 3 < 2)) for k in range(len(robot))]
    fixed = [k for k, row in enumerate(robot.rows) if is_fixed(row)]
    soft = [k for k, row in enumerate(robot.rows) if is_soft(row)]
    lengths = np.array([robot.rows[k].length[0] for k in fixed])
    x, arms = q.reshape(len(q), -1), robot.drive.jacobian
    displaced = robot.drive.motors.displacements(actuators)
    elongation = displaced - x @ arms.T
    stiff = springs.pulls(elongation) * springs.stiffness
    force = stiff * elongation
    resisting = springs.resistance * (x[:, columns] - springs.rest)
    count = len(values.x)
    pushed = np.zeros((len(q), len(robot.drive), count))  # by how much forces grow, were the shape kept
    turned = np.zeros((len(q), len(columns), count))  # and what else the balance changes by
    listed = ((each.name, i) for each in values.groups for i in range(len(each.names)))
    for column, (name, i) in enumerate(listed):
        mine = places[sets == i]
        match name:
            case "offsets":
                pushed[:, places[i], column] = stiff[:, places[i]]
            case "gains":
                offsets = values.of("offsets")
                extra = 0.0 if offsets is None else offsets[sets == i]
                pushed[:, mine, column] = stiff[:, mine] * (displaced[:, mine] - extra)
            case "stretch":
                pushed[:, mine, column] = force[:, mine]
            case "circles" | "angles":
                change = np.zeros_like(arms)
                change[mine] = _moved(arms[mine], name)
                pushed[:, mine, column] = -stiff[:, mine] * (x @ change[mine].T)
                turned[:, :, column] += force[:, mine] @ change[np.ix_(mine, columns)]
            case "stiffness":
                turned[:, bends[soft[i]], column] -= resisting[:, bends[soft[i]]]
            case "rest":
                bend = bends[soft[i // 2]][i % 2]
                turned[:, bend, column] += springs.resistance[bend]
            case "lengths":
                turned[:, bends[fixed[i]], column] += resisting[:, bends[fixed[i]]]
                pushed[:, :, column] = -stiff * (arms[:, 3 * fixed[i] + 2] * lengths[i])
    hessian = springs.hessian(springs.pulls(elongation))
    right = np.einsum("mc,nmp->ncp", springs.arms, pushed) + turned
    result = np.zeros((len(q), x.shape[1], count))
    result[:, columns] = np.linalg.solve(hessian, right)
    if (grown := values.columns("lengths")) is not None:
        result[:, 3 * np.array(fixed) + 2, np.arange(grown.start, grown.stop)] = lengths
    return result


def _moved(rows: Floats, name: str) -> Floats:
    """Derivative of lines (g, 3 n) by the logarithm of their circle, or by the angle of all."""
    result = np.zeros_like(rows)
    x, y = rows[:, 0::3], rows[:, 1::3]
    result[:, 0::3], result[:, 1::3] = (x, y) if name == "circles" else (-y, x)
    return result
