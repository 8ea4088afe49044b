"""What drives a chain of joints in a simulation: the motors of the robot, as servos that are stiff alike.

A servo pushes with `stiffness x (wish - displacement)`. In coordinates of the robot, scaled so that the inertia is 1,
all servos together are a matrix of stiffness; it is as large as the time step allows, and damped by a share of the
inertia and one of the stiffness (Rayleigh), so that every mode is damped critically or more.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sinuous import checks
from sinuous.arguments import Batch
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.export.chain import JointChain
from sinuous.frozen import Frozen
from sinuous.reprs import call

if TYPE_CHECKING:
    from sinuous.robot.robot import Robot

COORDINATES = ("bend_x", "bend_y", "length")

STEP = 0.002
"""Time step of the simulation, s."""

STIFFEST = 0.2
"""Phase in rad by which the stiffest mode turns in one step of a simulation; from 2 on the integration explodes."""

SLOWEST = 1e-6
"""Modes whose stiffness is less than this share of the largest are driven by nothing."""


class Drive(NamedTuple):
    """A servo on a linear combination of joints.

    Attributes
    ----------
    name : str
        Of the actuator, or of the coordinate that it moves.
    joints : dict
        Weights of the joints that it pulls at, by their names; the sum of their values, so weighed, and `constant` are
        the displacement.
    constant : float
    gain, offset : float
        The value that it is told is gain x displacement + offset.
    limits : (float, float)
        Least and largest of these values.
    stiffness, damping : float
        Force for each unit of the value, and for each unit of its speed.
    """

    name: str
    joints: dict[str, float]
    constant: float
    gain: float
    offset: float
    limits: tuple[float, float]
    stiffness: float
    damping: float


class DrivenChain(Frozen):
    """A chain of joints with drives: of every actuator of the robot, and of every coordinate that none determines.

    Parameters
    ----------
    robot : Robot
    chain : JointChain
    undetermined : ndarray of bool (n, 3)
        Coordinates that can move and that no actuator determines.
    mass : float
        Of the whole arm, spread evenly over its greatest length.

    Attributes
    ----------
    drives : tuple of Drive
        Without actuators that can move nothing.
    armature, damping : ndarray (j,)
        Inertia and damping of every joint, beside that of what hangs on it.
    """

    chain: JointChain
    mass: float
    drives: tuple[Drive, ...]
    armature: Floats
    damping: Floats
    _rows: Floats
    _offsets: Floats

    def __init__(self, robot: "Robot", chain: JointChain, undetermined: NDArray[np.bool_], mass: float) -> None:
        columns = np.flatnonzero(chain.matrix.any(axis=0))
        if not len(columns):
            raise InputError("robot", "nothing of it can move", robot, "a segment that bends or stretches")
        open_ones = np.flatnonzero(undetermined.ravel())
        rows = np.concatenate([robot.drive.jacobian, np.eye(3 * len(robot))[open_ones]])
        moving = np.flatnonzero(rows[:, columns].any(axis=1))
        own, wanted = robot.drive.motors, len(open_ones)
        gain, offset = np.append(own.gain, np.ones(wanted)), np.append(own.offset, np.zeros(wanted))
        names = [*(a.name for a in robot.actuators), *(_coordinate(robot, int(c)) for c in open_ones)]
        limits = [*(a.limits for a in robot.actuators), *(_limits(robot, int(c)) for c in open_ones)]
        inertia = np.tile([robot.mean_length**2] * 2 + [1.0], len(robot)) * mass
        squares = (chain.matrix**2).sum(axis=0)
        stiffness, of_stiffness, of_inertia = _servos(rows[np.ix_(moving, columns)], inertia[columns])
        still = np.delete(np.arange(3 * len(robot)), columns)
        fixed = np.array([[0.0, 0.0, segment.length[1]] for segment in robot.segments]).ravel()[still]
        drives = []
        for i, own_stiffness in zip(moving.tolist(), stiffness.tolist(), strict=True):
            weights = chain.matrix[:, columns] @ (rows[i, columns] / squares[columns])
            joints = {chain.names[j]: float(weights[j]) for j in np.flatnonzero(weights)}
            turned = own_stiffness / gain[i] ** 2
            constant, told = float(rows[i, still] @ fixed), (float(gain[i]), float(offset[i]))
            drives.append(Drive(names[i], joints, constant, *told, limits[i], turned, of_stiffness * turned))
        armature = (chain.matrix != 0.0) @ np.divide(inertia, squares, out=np.zeros(len(squares)), where=squares > 0.0)
        self._set(chain=chain, mass=mass, drives=tuple(drives), armature=armature)
        self._set(damping=of_inertia * armature, _rows=(gain[:, None] * rows)[moving], _offsets=offset[moving])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all drives, in the order of their controls."""
        return tuple(drive.name for drive in self.drives)

    def controls(self, q: Batch) -> Floats:
        """What drives are told (..., d) so that the robot takes configurations (..., n, 3)."""
        checked = checks.stack("q", q, (len(self.chain.robot), 3))
        return checked.reshape(*checked.shape[:-2], -1) @ self._rows.T + self._offsets

    def __len__(self) -> int:
        return len(self.drives)

    def __repr__(self) -> str:
        return call("DrivenChain", [f"{len(self)} drives", f"{len(self.chain)} joints"])


def _servos(rows: Floats, inertia: Floats) -> tuple[Floats, float, float]:
    """Stiffness of servos on displacements `rows` (d, c) of coordinates with such inertia (c,); shares of damping.

    Returns the stiffness (d,), and which multiples of stiffness and of inertia the damping is.
    """
    scaled = rows / np.sqrt(inertia)
    stiffness = 1.0 / (scaled**2).sum(axis=1)
    modes = np.linalg.svd(np.sqrt(stiffness)[:, None] * scaled, compute_uv=False)
    fastest = STIFFEST / STEP
    slowest = fastest * float(modes[modes > np.sqrt(SLOWEST) * modes[0]][-1] / modes[0])
    return stiffness * (fastest / modes[0]) ** 2, 2.0 / fastest, 2.0 * slowest


def _coordinate(robot: "Robot", column: int) -> str:
    return f"{robot.segment_names[column // 3]}.{COORDINATES[column % 3]}"


def _limits(robot: "Robot", column: int) -> tuple[float, float]:
    """Least and largest value of a coordinate."""
    segment, kind = divmod(column, 3)
    low, high = robot.segments[segment].length
    most = min(robot.segments[segment].max_bend, robot.curvatures[segment] * high)
    return (low, high) if kind == 2 else (-most, most)


def couplings(chain: JointChain) -> list[tuple[str, str, float]]:
    """Joints that move together: a joint, the first one of its coordinate, and how many times as far it moves."""
    first: dict[tuple[int, int], int] = {}
    found: list[tuple[str, str, float]] = []
    for i, joint in enumerate(chain.joints):
        leader = chain.joints[first.setdefault((joint.segment, joint.coordinate), i)]
        if leader is not joint:
            found.append((joint.name, leader.name, joint.weight / leader.weight))
    return found
