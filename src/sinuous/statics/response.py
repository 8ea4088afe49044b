"""How a body at rest under load answers to small changes of its drive, its loads and the robot.

Each derivative is a central difference of equilibria that Newton's method finds from the one that is derived, in two or
three steps: exact to the second order of a step of 1e-4, in the scale of what changes.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from sinuous.base.arguments import LoadParameter
from sinuous.base.checks import Floats
from sinuous.base.parameter_groups import TWIST, ByGroups, Column, read_names
from sinuous.model.loads import Force, Load
from sinuous.model.segment import Stiffness, coordinate_names
from sinuous.statics.body import body_of

if TYPE_CHECKING:
    from sinuous.model.robot import Robot

STEP = 1e-4
"""Of the differences, in the scale of what changes."""

KINK = 1e-2
"""Difference between the derivatives to both sides, relative to the larger, from which on there is a kink."""

ROUNDING = 1e-9
"""What states of equilibria are exact to."""

STIFFNESSES = ("bend", "twist", "stretch")


class EquilibriumQuestion(NamedTuple):
    """What an equilibrium is of: a robot, its loads beside its own, and its drive.

    Attributes
    ----------
    robot : Robot
    loads : tuple of Force or Payload
    drive : str
        What `values` are: `q` (n, 3), `actuators` (m,) in the units of the motors, or `tensions` (m,).
    values : ndarray
    initial : ndarray (n, 3) or None
        Of what no actuator determines, its configuration without load.
    """

    robot: "Robot"
    loads: tuple[Load, ...]
    drive: str
    values: Floats
    initial: Floats | None


class Resting(Protocol):
    """What is derived: an `Equilibrium`."""

    question: EquilibriumQuestion
    states: Floats
    tensions: Floats
    stable: bool

    @property
    def tip(self) -> Floats:
        """Pose (4, 4) of the tool."""

    def beside(self, question: EquilibriumQuestion) -> "Resting | None":
        """Return the equilibrium of another question that is found from this one."""


class Response(ByGroups[LoadParameter]):
    """Derivatives of an equilibrium, by groups of parameters; as `Derivative` of an answer.

    Attributes
    ----------
    wrt : tuple of str
        Columns of groups have `labels` like `loads[0].force_x`, `s1.stiffness.bend`.
    regular : bool
        Whether there is a derivative: not where the body is unstable, or a tendon just becomes slack.
    states : mapping of str to ndarray (N, 4, p)
        Derivatives of the states of all arcs by a group of p parameters.
    tip : mapping of str to ndarray (6, p)
        Twists of the tool: angular velocity, and velocity of its origin, in world axes.
    tensions : mapping of str to ndarray (m, p)
        NaN of actuators without.
    """

    def __init__(self, found: "Resting", wrt: LoadParameter | Iterable[LoadParameter]) -> None:
        known = [name for name in GROUPS if name not in DRIVES or name == found.question.drive]
        columns = {name: tuple(GROUPS[name](found.question)) for name in read_names(wrt, known)}
        derived = {name: [_derive(found, column) for column in listed] for name, listed in columns.items()}
        regular = found.stable and all(each.regular for listed in derived.values() for each in listed)
        nothing = _State(*(np.empty((*shape, 0)) for shape in (found.states.shape, (6,), found.tensions.shape)))
        self.states, self.tip, self.tensions = (
            {
                name: np.concatenate([nothing[i], *(each.change[i][..., None] for each in derived[name])], axis=-1)
                for name in columns
            }
            for i in range(len(nothing))
        )
        super().__init__(columns, self.states, regular)


class _State(NamedTuple):
    """States (N, 4), twist (6,) of the tool from where it was, and tensions (m,); or how these change."""

    states: Floats
    tip: Floats
    tensions: Floats


class _Derived(NamedTuple):
    change: _State
    regular: bool


def _derive(found: "Resting", column: Column) -> _Derived:
    """Derive by one parameter; NaN, and not regular, where there is no equilibrium to one side."""
    h, here = STEP * column.scale, _State(found.states, np.zeros(6), found.tensions)
    below, above = (_beside(found, column.changed(sign * h)) for sign in (-1.0, 1.0))
    if below is None or above is None:
        return _Derived(_State(*(np.full(each.shape, np.nan) for each in here)), False)
    change = _State(*((after - before) / (2.0 * h) for before, after in zip(below, above, strict=True)))
    ahead, behind = above.states - here.states, here.states - below.states
    bent = float(np.abs(ahead - behind).max())
    return _Derived(change, bent <= ROUNDING + KINK * float(np.abs(ahead + behind).max()))


def _beside(found: "Resting", question: EquilibriumQuestion) -> _State | None:
    """The equilibrium of a question that differs a little; `None` where there is none nearby."""
    near = found.beside(question)
    if near is None:
        return None
    turn = near.tip[:3, :3] @ found.tip[:3, :3].T
    skew = 0.5 * (turn - turn.T)
    twist = np.array([skew[2, 1], skew[0, 2], skew[1, 0], *(near.tip[:3, 3] - found.tip[:3, 3])])
    return _State(near.states, twist, near.tensions)


def softest(robot: "Robot") -> float:
    """Moment that bends the softest segment by 1 rad."""
    lengths = np.array([0.5 * sum(row.length) for row in robot.rows])
    own: float = (body_of(robot).stiffness[:, 0] / lengths).min()
    return own if np.isfinite(own) else 1.0


def _entries(
    names: Sequence[str], value: Floats, scale: float | Floats, put: Callable[[Floats], EquilibriumQuestion]
) -> Iterator[Column]:
    """Columns of the numbers of an array, of one scale or one each, which `put` puts into the question."""
    scales = np.broadcast_to(scale, value.size).tolist()
    units = np.eye(value.size).reshape(-1, *value.shape)
    for name, own, unit in zip(names, scales, units, strict=True):
        yield Column(name, own, lambda h, unit=unit: put(value + h * unit))


def _of_loads(question: EquilibriumQuestion) -> Iterator[Column]:
    return _of_each(question, "loads", question.loads, lambda loads: question._replace(loads=loads))


def _of_payload(question: EquilibriumQuestion) -> Iterator[Column]:
    robot = question.robot
    put = lambda loads: question._replace(robot=robot.changed(payload=loads))  # noqa: E731
    return _of_each(question, "payload", robot.payload, put)


def _of_each(
    question: EquilibriumQuestion,
    name: str,
    loads: Sequence[Load],
    put: Callable[[tuple[Any, ...]], EquilibriumQuestion],
) -> Iterator[Column]:
    robot, moment = question.robot, softest(question.robot)
    force = moment / robot.mean_length
    gravity = 1.0 if robot.gravity is None else max(float(np.linalg.norm(robot.gravity)), 1e-12)
    for i, load in enumerate(loads):
        scales = {"force": force, "moment": moment, "mass": force / gravity, "position": robot.mean_length}
        for key in ("force", "moment", "position") if isinstance(load, Force) else ("mass", "position"):
            value = np.atleast_1d(getattr(load, key))
            own = [f"{name}[{i}].{key}{axis}" for axis in (("_x", "_y", "_z") if value.size == 3 else ("",))]

            def changed(other: Floats, i: int = i, load: Load = load, key: str = key) -> EquilibriumQuestion:
                one = load.changed(**{key: other if other.size == 3 else float(other[0])})
                return put((*loads[:i], one, *loads[i + 1 :]))

            yield from _entries(own, value, scales[key], changed)


def _of_gravity(question: EquilibriumQuestion) -> Iterator[Column]:
    robot = question.robot
    if robot.gravity is None:
        return
    names, scale = ("gravity_x", "gravity_y", "gravity_z"), max(float(np.linalg.norm(robot.gravity)), 1e-12)
    put = lambda gravity: question._replace(robot=robot.changed(gravity=gravity))  # noqa: E731
    yield from _entries(names, robot.gravity, scale, put)


def _of_stiffness(question: EquilibriumQuestion) -> Iterator[Column]:
    robot = question.robot
    for k, segment in enumerate(robot.segments):
        for key in STIFFNESSES if segment.stiffness is not None else ():
            own = np.array([getattr(segment.stiffness, each) for each in STIFFNESSES])
            value = own[STIFFNESSES.index(key)]
            if np.isfinite(value):

                def changed(h: float, k: int = k, own: Floats = own, key: str = key) -> EquilibriumQuestion:
                    more = own + h * (np.array(STIFFNESSES) == key)
                    one = Stiffness(*(float(each) if np.isfinite(each) else None for each in more))
                    parts = [s.changed(stiffness=one) if j == k else s for j, s in enumerate(robot.segments)]
                    return question._replace(robot=robot.changed(segments=parts))

                yield Column(f"{robot.segment_names[k]}.stiffness.{key}", float(value), changed)


def _of_base(question: EquilibriumQuestion) -> Iterator[Column]:
    return motions_of_base(question.robot, lambda robot: question._replace(robot=robot))


def motions_of_base(robot: "Robot", put: Callable[["Robot"], Any]) -> Iterator[Column]:
    """Columns of a small motion of the base; `put` puts the robot that has moved into the question."""
    from scipy.spatial.transform import Rotation  # noqa: PLC0415

    for i, name in enumerate(TWIST):

        def changed(h: float, i: int = i) -> Any:
            base = robot.base.copy()
            if i < 3:
                base[:3, :3] = Rotation.from_rotvec(h * np.eye(3)[i]).as_matrix() @ base[:3, :3]
            else:
                base[i - 3, 3] += h
            return put(robot.changed(base=base))

        yield Column(f"base.{name}", 1.0 if i < 3 else robot.mean_length, changed)


def _of_drive(question: EquilibriumQuestion) -> Iterator[Column]:
    robot, drive = question.robot, question.drive
    names, arm = [each.name for each in robot.actuators], 0.05 * robot.mean_length
    scale: float | Floats = softest(robot) / arm
    if drive == "q":
        names, scale = coordinate_names(robot.row_names), np.tile([1.0, 1.0, robot.mean_length], len(robot))
    elif drive == "actuators":
        scale = arm * float(np.abs(robot.drive.motors.gain).max(initial=1.0))
    return _entries(names, question.values, scale, lambda other: question._replace(values=other))


DRIVES = "q", "actuators", "tensions"
GROUPS: dict[LoadParameter, Callable[[EquilibriumQuestion], Iterator[Column]]] = {
    "loads": _of_loads,
    "payload": _of_payload,
    "gravity": _of_gravity,
    "stiffness": _of_stiffness,
    "base": _of_base,
    "q": _of_drive,
    "actuators": _of_drive,
    "tensions": _of_drive,
}
"""All groups of parameters; of the last three that with which the equilibrium was asked for.

- `loads`, `payload`: of each force its force, its moment and its position, of each mass the mass and its position, as
  `Force` and `Payload` have them; those that were given, and those that the robot carries;
- `gravity`: three; `base`: a small rotation about its own origin, in world axes (3), and the motion of that origin (3);
- `stiffness`: of each segment those of bend, twist and stretch that are finite;
- `q`: the configuration without load (3 n); `actuators`, `tensions`: a value each.
"""
