"""Where a robot's places are for values of its actuators, and exact derivatives of that by the parameters of a fit.

In equilibrium `S (q - rest) = A' f` with `f = k max(0, d - A q)`; a change of anything in it moves `q` by
`H^-1 (A' df + dA' f - dS (q - rest) + S drest)`, where `H = S + A' k A` over the lines that pull. Rigid actuators are
lines of stiffness 1 that push, too, and nothing resists them: that is their least-squares solution.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous.calibration.measurements import Place
from sinuous.calibration.parameters import Table, Values, lines_of
from sinuous.checks import Floats
from sinuous.robot.elastic import Springs
from sinuous.robot.robot import Robot

ANY = 1e300
"""By how much values of rigid actuators may contradict each other: by anything, for that is what is fitted."""


class Model(NamedTuple):
    """A robot, its drawn self, and what is asked about it.

    Attributes
    ----------
    robot : Robot
        With the values of the parameters.
    values : Values
    places : tuple of Place
    lines : Table
        Of `robot`.
    """

    robot: Robot
    values: Values
    places: tuple[Place, ...]
    lines: Table


def model(robot: Robot, values: Values, places: tuple[Place, ...]) -> Model:
    """Make a model of a robot that has these values already."""
    tool = values.of("tool")
    if tool is not None:
        places = tuple(place._replace(offset=place.offset + tool) for place in places)
    return Model(robot, values, places, lines_of(robot))


def shapes(own: Model, actuators: Floats) -> Floats:
    """Configurations (N, n, 3) for values of actuators (N, m); what contradicts itself is answered silently."""
    return own.robot.from_actuators(actuators, tolerance=ANY)


def predicted(own: Model, q: Floats) -> Floats:
    """Points (N, k, 3) of the places in configurations (N, n, 3), in the robot's world."""
    return np.stack([_point(own.robot, q, place)[0] for place in own.places], axis=1)


def derivatives(own: Model, actuators: Floats, q: Floats) -> tuple[Floats, Floats]:
    """Points (N, k, 3), and their derivatives (N, k, 3, P) by the parameters, in configurations of `shapes`."""
    sensitivity = _sensitivity(own, actuators, q)
    at = 0
    columns: dict[str, slice] = {}
    for each in own.values.groups:
        columns[each.name] = slice(at, at + len(each.names))
        at += len(each.names)
    points, slopes = [], []
    for place in own.places:
        point, rotation, jacobian = _point(own.robot, q, place)
        slope = np.matmul(jacobian, sensitivity)
        if "lengths" in columns:
            slope[..., columns["lengths"]] += jacobian[..., _fixed(own.robot)] * _lengths(own.robot)
        if "tool" in columns:
            slope[..., columns["tool"]] += rotation
        points.append(point)
        slopes.append(slope)
    return np.stack(points, axis=1), np.stack(slopes, axis=1)


def _fixed(robot: Robot) -> NDArray[np.intp]:
    """Columns of the lengths that a fit may change."""
    return np.array([3 * k + 2 for k, s in enumerate(robot.segments) if s.length[0] == s.length[1] > 0.0], np.intp)


def _lengths(robot: Robot) -> Floats:
    return np.array([s.length[0] for s in robot.segments if s.length[0] == s.length[1] > 0.0])


def _point(robot: Robot, q: Floats, place: Place) -> tuple[Floats, Floats, Floats]:
    """Positions (N, 3) of a place, the frames there (N, 3, 3), and derivatives (N, 3, 3 n) by the configuration."""
    k = place.segment
    cut = q.copy()
    cut[:, k] *= place.share
    frames = robot.forward(cut)[:, k]
    jacobian = robot.jacobian(cut, k + 1)
    jacobian[:, :, 3 * k : 3 * k + 3] *= place.share
    arm = frames[:, :3, :3] @ place.offset
    slope = jacobian[:, 3:] + np.cross(jacobian[:, :3], arm[:, :, None], axis=1)
    return frames[:, :3, 3] + arm, frames[:, :3, :3], slope


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


def _sensitivity(own: Model, actuators: Floats, q: Floats) -> Floats:
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
    return result


def _moved(rows: Floats, name: str) -> Floats:
    """Derivative of lines (g, 3 n) by the logarithm of their circle, or by the angle of all."""
    result = np.zeros_like(rows)
    result[:, 0::3], result[:, 1::3] = (
        (rows[:, 0::3], rows[:, 1::3]) if name == "circles" else (-rows[:, 1::3], rows[:, 0::3])
    )
    return result


def _resist(
    own: Model, name: str, i: int, springs: Springs, columns: NDArray[np.intp], bent: Floats, out: Floats
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
