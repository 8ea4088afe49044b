"""One step of a control loop: where to go, what that reaches, and what held it back."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, get_args

import numpy as np

from sinuous.answer.observer import Observed
from sinuous.base.arguments import StepConstraint, StepStatus
from sinuous.base.checks import Floats, closed
from sinuous.base.frozen import ShortRepr, call
from sinuous.kernels.body.proof import CLEAR
from sinuous.kernels.certificate.sweep import CLEARANCES_WIDTH, PROVED_BOUND
from sinuous.kernels.velocity import query as t
from sinuous.kernels.velocity.layout import (
    ACTUATOR_LIMIT,
    CLEARANCE_LIMIT,
    MEET_TARGETS,
    MOVE_POSITION,
    SELF_CLEARANCE_LIMIT,
)
from sinuous.model.actuation import Actuator
from sinuous.model.robot import Robot
from sinuous.problem.target import Tolerance
from sinuous.scene.snapshot import Snapshot

CONSTRAINTS: tuple[StepConstraint, ...] = get_args(StepConstraint)
"""What may hold a step back, in the order of `sinuous.kernels.velocity.layout`."""

NEARLY = 1e-3
"""How far a motion of the tip may be from the one that was asked for, as a share of it, to count as reached."""


@dataclass(frozen=True, repr=False)
class Active(ShortRepr):
    """A limit, a rate or an obstacle that held a step back.

    Attributes
    ----------
    constraint : str
        `length`, `bend`, `curvature`, `actuator` (limits, those of tensions too), `clearance`, `self_clearance`,
        `length_rate`, `bend_rate`, `actuator_rate` or `acceleration`.
    segment : int, str or None
        1 = first; or the name of a joint, or of the one whose link it is.
    obstacle : str or None
        Name of the obstacle, for `clearance`.
    actuator : str or None
        Name of the actuator, for `actuator` and `actuator_rate`.
    other_segment : int, str or None
        The segment that it would touch, for `self_clearance`.
    """

    constraint: StepConstraint
    segment: int | str | None
    obstacle: str | None = None
    actuator: str | None = None
    other_segment: int | str | None = None

    @classmethod
    def of(cls, row: Sequence[int], robot: Robot, scene: Snapshot, limited: Sequence[Actuator]) -> "Active":
        """Make it of a row of the kernels: a kind, a row (0 = first), and which obstacle, row or actuator."""
        kind, segment, which = row
        place = robot.labels[segment] if segment >= 0 else None
        if kind == CLEARANCE_LIMIT:
            return cls("clearance", place, obstacle=scene.name(which))
        if kind == SELF_CLEARANCE_LIMIT:
            return cls("self_clearance", place, other_segment=robot.labels[which])
        if segment < 0 or kind == ACTUATOR_LIMIT:
            return cls(CONSTRAINTS[kind], limited[which].segment, actuator=limited[which].name)
        return cls(CONSTRAINTS[kind], place)


class WantedStep(NamedTuple):
    """What a step was asked for.

    Attributes
    ----------
    robot : Robot
    scene : Snapshot
    tolerance : Tolerance
    dt : float
        Seconds.
    kind : int
        See `sinuous.kernels.velocity.layout`.
    motion : tuple of float
        Of the tip in that time (6), rad and length unit.
    limited : tuple of Actuator
        Those that have a limit or a rate, as the kernel numbers them.
    """

    robot: Robot
    scene: Snapshot
    tolerance: Tolerance
    dt: float
    kind: int
    motion: tuple[float, ...]
    limited: tuple[Actuator, ...]


class Step:
    """One step of a control loop, frozen.

    Attributes
    ----------
    q : ndarray (n, 3)
        Where to go: within all limits and rates; read-only.
    initial : ndarray (n, 3)
        Where it began; read-only.
    dt : float
        Seconds.
    scene : Snapshot
        The obstacles as they were then.
    observed : Observed or None
        By how much the real robot was elsewhere than its model, where that was measured.
    """

    __slots__ = ("_active", "_answer", "_q", "_wanted", "initial", "observed")

    initial: Floats
    observed: Observed | None
    _wanted: WantedStep
    _answer: Floats
    _q: Floats
    _active: tuple[Active, ...]

    def __init__(self, wanted: WantedStep, initial: Floats, answer: Floats, observed: Observed | None = None) -> None:
        q = answer[t.CONFIGURATION : t.CONFIGURATION + initial.size].reshape(initial.shape)
        q.setflags(False)  # type: ignore[call-arg]  # by position: by its name it takes three times as long
        for name, value in zip(("_wanted", "initial", "_answer", "_q"), (wanted, initial, answer, q), strict=True):
            object.__setattr__(self, name, value)
        object.__setattr__(self, "observed", observed)

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"cannot set {name!r}: Step is frozen")

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._wanted, np.array(self.initial), np.array(self._answer), self.observed)

    @property
    def configuration(self) -> Floats:
        """Configuration (rows, 3) of joints and segments to go to, read-only."""
        return self._q

    @property
    def q(self) -> Floats:
        """Of the segments: (n, 3), read-only; `configuration` where there are no joints."""
        return self._wanted.robot.segments_of(self._q)

    @property
    def joints(self) -> Floats:
        """Values (j,) of the joints before the segments, in the order of `robot.joint_names`."""
        return self._wanted.robot.joints_of(self._q)

    @property
    def dt(self) -> float:
        """Seconds."""
        return self._wanted.dt

    @property
    def scene(self) -> Snapshot:
        """The obstacles as they were then."""
        return self._wanted.scene

    @property
    def velocity(self) -> Floats:
        """Derivative (n, 3) of the configuration: rad/s, and length unit/s."""
        return np.asarray((self.configuration - self.initial) / self.dt)

    @property
    def twist(self) -> Floats:
        """Twist (6,) of the tip that this reaches, at the start of the step: (omega, v) in world axes, as asked for."""
        if self._wanted.robot.has_external_load:
            return np.asarray(self._answer[t.REACHED : t.REACHED + 6] / self.dt)
        return np.asarray(
            self.velocity.reshape(-1) @ self._wanted.robot._row_jacobian(self.initial, len(self.initial)).T
        )

    @property
    def share(self) -> float | None:
        """Part of the twist that is reached along the one that was asked for, 1 for all of it; `None` for targets.

        Rotations count in rad, displacements in mean lengths of the robot.
        """
        asked, reached = self._motions()
        square = float(asked @ asked)
        if self._wanted.kind == MEET_TARGETS:
            return None
        return float(reached @ asked) / square if square > 0.0 else 1.0

    @property
    def status(self) -> StepStatus:
        """How it ended.

        `reached`: what was asked for is reached. `held_back`: limits, rates, obstacles or a singular shape left less.
        `cut_short`: the rest of the step was not proved clear. `touching`: it begins in contact, or too near to one for
        any proof, or the time did not suffice for one; nothing is proved, and no gap becomes smaller.
        """
        if self.touching:
            return "touching"
        if self._answer[t.STEP_FRACTION] < 1.0:
            return "cut_short"
        return "reached" if self._is_reached() else "held_back"

    @property
    def proved(self) -> bool:
        """Whether the motion from `initial` to `q`, linear in q, is proved clear of obstacles and of the body.

        Under load it is the loaded body that is clear, and every tension is within its limits all the way.
        """
        return bool(self._answer[t.PROVED])

    @property
    def touching(self) -> bool:
        """Whether it begins in contact with an obstacle or itself, or nothing could be proved of where it begins."""
        return bool(self._answer[t.START] != CLEAR)

    @property
    def clearance(self) -> float | None:
        """Proved lower bound of the clearance at `q`; `None` without obstacles, and where nothing is proved of `q`.

        It is a number wherever the step is proved.
        """
        return self._bound(t.CLEARANCE, 0) if len(self.scene) else None

    @property
    def self_clearance(self) -> float | None:
        """The same from itself; `None` where the body may run through itself, and where nothing is proved of `q`.

        Infinite where no two places of the body come near each other that could touch.
        """
        return self._bound(t.SELF_CLEARANCE, 1) if self._wanted.robot.avoids_itself else None

    @property
    def position_error(self) -> float | None:
        """Largest distance from the targets at `q`; `None` without targets."""
        return float(self._answer[t.POSITION_ERROR]) if self._wanted.kind == MEET_TARGETS else None

    @property
    def angle_error(self) -> float | None:
        """Largest angle from the targets at `q`, rad; `None` without targets."""
        return float(self._answer[t.ANGLE_ERROR]) if self._wanted.kind == MEET_TARGETS else None

    @property
    def active(self) -> tuple[Active, ...]:
        """What held the step back, strongest first; once for each limit and each obstacle and segment."""
        if not hasattr(self, "_active"):
            object.__setattr__(self, "_active", self._find_active())
        return self._active

    def __repr__(self) -> str:
        share = [] if self.share is None else [f"share {self.share:.3g}"]
        held = [f"active {', '.join(dict.fromkeys(each.constraint for each in self.active))}"] if self.active else []
        return call("Step", [self.status, *share, *held])

    def _motions(self) -> tuple[Floats, Floats]:
        """The motion that was asked for and the one that is reached, to first order, in units that can be compared."""
        unit = self._wanted.robot.mean_length
        scales = np.array([0.0 if self._wanted.kind == MOVE_POSITION else 1.0] * 3 + [1.0 / unit] * 3)
        return scales * self._wanted.motion, scales * self._answer[t.REACHED : t.REACHED + 6]

    def _is_reached(self) -> bool:
        if self._wanted.kind == MEET_TARGETS:
            tolerance = self._wanted.tolerance
            off, turn = self._answer[t.POSITION_ERROR], self._answer[t.ANGLE_ERROR]
            return bool(off <= tolerance.position and turn <= tolerance.angle)
        asked, reached = self._motions()
        return bool(np.linalg.norm(reached - asked) <= NEARLY * np.linalg.norm(asked))

    def _bound(self, column: int, row: int) -> float | None:
        """What was proved of `q` itself; where there was no time for that, what the proof of the way says of all of it.

        Of a way that was cut short, that is no more than what is demanded.
        """
        value = float(self._answer[column])
        if value == -np.inf:
            if not self.proved:
                return None
            whole = self._answer[t.STEP_FRACTION] == 1.0
            value = (
                max(0.0, float(self._answer[t.CLEARANCES + row * CLEARANCES_WIDTH + PROVED_BOUND])) if whole else 0.0
            )
        return value + self._wanted.robot._least_clearances[row]

    def _find_active(self) -> tuple[Active, ...]:
        first = t.CONFIGURATION + self.configuration.size
        rows = self._answer[first : first + t.ACTIVE_WIDTH * int(self._answer[t.ACTIVE])].reshape(-1, t.ACTIVE_WIDTH)
        ordered = rows[np.argsort(-rows[:, 0], kind="stable"), 1:].astype(np.int64).tolist()
        return tuple(
            dict.fromkeys(Active.of(row, self._wanted.robot, self.scene, self._wanted.limited) for row in ordered)
        )


def _restored(wanted: WantedStep, initial: Floats, answer: Floats, observed: Observed | None = None) -> Step:
    return Step(wanted, closed(initial), answer, observed)
