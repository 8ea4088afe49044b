"""Where a robot's places are for values of its actuators, and exact derivatives of that by the parameters of a fit.

In equilibrium `S (q - rest) = A' f` with `f = k max(0, d - A q)`; a change of anything in it moves `q` by
`H^-1 (A' df + dA' f - dS (q - rest) + S drest)`, where `H = S + A' k A` over the lines that pull. Rigid actuators are
lines of stiffness 1 that push, too, and nothing resists them: that is their least-squares solution. Bodies that gravity
bends are in equilibrium (`sinuous.kernels.statics.answers`).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.calibration.bodies import Loaded, at_rest
from sinuous.calibration.measurements import Place
from sinuous.calibration.parameters import LineTable, Values, changed, lines_of
from sinuous.checks import Floats
from sinuous.robot.elastic import Springs
from sinuous.robot.robot import Robot

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
    lines : LineTable
        Of `robot`.
    """

    robot: Robot
    drawn: Robot
    values: Values
    places: tuple[Place, ...]
    lines: LineTable


def model(drawn: Robot, values: Values, places: tuple[Place, ...]) -> RobotModel:
    """Make a model of a robot with other values of its parameters."""
    tool = values.of("tool")
    if tool is not None:
        places = tuple(place._replace(offset=place.offset + tool) for place in places)
    robot = changed(drawn, values)
    return RobotModel(robot, drawn, values, places, lines_of(robot))


def predicted(own: RobotModel, actuators: Floats) -> Floats:
    """Points (N, k, 3) of the places at values of actuators (N, m), in the robot's world."""
    bodies = at_rest(own.robot, actuators)
    return np.stack([bodies.point(place).position for place in own.places], axis=1)


def derivatives(own: RobotModel, actuators: Floats, of_gravity: bool = False) -> tuple[Floats, Floats]:
    """Points (N, k, 3), and their derivatives (N, k, 3, P) by the parameters, and by gravity (3) if asked."""
    bodies, tool = at_rest(own.robot, actuators), own.values.columns("tool")
    if isinstance(bodies, Loaded):
        sensitivity = bodies.sensitivity(*_beside(own, of_gravity))
    else:
        sensitivity = _sensitivity(own, actuators, bodies.q)
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


def _fixed(robot: Robot) -> NDArray[np.intp]:
    """Columns of the lengths that a fit may change."""
    return np.array([3 * k + 2 for k, s in enumerate(robot.segments) if s.length[0] == s.length[1] > 0.0], np.intp)


def _lengths(robot: Robot) -> Floats:
    return np.array([s.length[0] for s in robot.segments if s.length[0] == s.length[1] > 0.0])


def _springs(robot: Robot) -> tuple[Springs, NDArray[np.intp]]:
    """All actuators as lines, and the coordinates that move."""
    moves = np.array([[s.max_bend > 0.0, s.max_bend > 0.0, s.length[0] < s.length[1]] for s in robot.segments])
    columns = np.flatnonzero(moves.ravel())
    drive = robot.drive
    stiffness, one_sided = np.ones(len(drive)), np.zeros(len(drive), np.bool_)
    resistance, rest = np.zeros(moves.size), np.zeros(moves.size)
    arms = np.array(drive.jacobian)
    if drive.elastic is not None:
        own = drive.elastic.springs
        stiffness[drive.elastic.places], one_sided[drive.elastic.places] = own.stiffness, own.one_sided
        where = np.flatnonzero(drive.elastic.determined.ravel())
        resistance[where], rest[where] = np.broadcast_to(own.resistance, (1, len(where)))[0], own.rest
    return Springs(resistance[columns], rest[columns], arms[:, columns], stiffness, one_sided), columns


def _sensitivity(own: RobotModel, actuators: Floats, q: Floats) -> Floats:
    """Derivatives (N, 3 n, P) of configurations by the parameters."""
    robot, lines, values = own.robot, own.lines, own.values
    springs, columns = _springs(robot)
    x = q.reshape(len(q), -1)
    displaced = robot.drive.motors.displacements(actuators)
    elongation = displaced - x @ robot.drive.jacobian.T
    stiff = springs.pulls(elongation) * springs.stiffness
    force = stiff * elongation
    count = len(values.x)
    pushed = np.zeros((len(q), len(robot.drive), count))  # by how much forces grow, were the shape kept
    turned = np.zeros((len(q), len(columns), count))  # and what else the balance changes by
    own_x = x[:, columns] - springs.rest
    at = 0
    for each in values.groups:
        for i in range(len(each.names)):
            column = at + i
            match each.name:
                case "offsets":
                    place = lines.places[i]
                    pushed[:, place, column] = stiff[:, place]
                case "gains":
                    mine = lines.places[lines.sets == i]
                    offsets = values.of("offsets")
                    extra = 0.0 if offsets is None else offsets[lines.sets == i]
                    pushed[:, mine, column] = stiff[:, mine] * (displaced[:, mine] - extra)
                case "stretch":
                    mine = lines.places[lines.sets == i]
                    pushed[:, mine, column] = force[:, mine]
                case "circles" | "angles":
                    mine = lines.places[lines.sets == i]
                    change = np.zeros_like(robot.drive.jacobian)
                    change[mine] = _moved(robot.drive.jacobian[mine], each.name)
                    pushed[:, mine, column] = -stiff[:, mine] * (x @ change[mine].T)
                    turned[:, :, column] += force[:, mine] @ change[np.ix_(mine, columns)]
                case "stiffness" | "rest" | "lengths":
                    _resist(own, each.name, i, springs, columns, own_x, turned[:, :, column])
                    if each.name == "lengths":
                        fixed = _fixed(robot)[i]
                        grown = robot.drive.jacobian[:, fixed] * _lengths(robot)[i]
                        pushed[:, :, column] = -stiff * grown
        at += len(each.names)
    hessian = springs.hessian(springs.pulls(elongation))
    right = np.einsum("mc,nmp->ncp", springs.arms, pushed) + turned
    result = np.zeros((len(q), x.shape[1], count))
    result[:, columns] = np.linalg.solve(hessian, right)
    if (grown := values.columns("lengths")) is not None:
        result[:, _fixed(robot), np.arange(grown.start, grown.stop)] = _lengths(robot)
    return result


def _moved(rows: Floats, name: str) -> Floats:
    """Derivative of lines (g, 3 n) by the logarithm of their circle, or by the angle of all."""
    result = np.zeros_like(rows)
    result[:, 0::3], result[:, 1::3] = (
        (rows[:, 0::3], rows[:, 1::3]) if name == "circles" else (-rows[:, 1::3], rows[:, 0::3])
    )
    return result


def _resist(
    own: RobotModel, name: str, i: int, springs: Springs, columns: NDArray[np.intp], bent: Floats, out: Floats
) -> None:
    """Add to `out` (N, c) what a parameter of the segments' own resistance changes."""
    robot = own.robot
    if name == "lengths":
        k = int(_fixed(robot)[i]) // 3
        for c in np.flatnonzero((columns // 3 == k) & (columns % 3 < 2)):
            out[:, c] += springs.resistance[c] * bent[:, c]
        return
    soft = [k for k, s in enumerate(robot.segments) if s.stiffness is not None and s.max_bend > 0.0]
    if name == "rest":
        own_column = int(np.flatnonzero(columns == 3 * soft[i // 2] + i % 2)[0])
        out[:, own_column] += springs.resistance[own_column]
        return
    for c in np.flatnonzero((columns // 3 == soft[i]) & (columns % 3 < 2)):
        out[:, c] -= springs.resistance[c] * bent[:, c]
