"""A body under load, at rest: where it is, what holds it, and whether it would stay there."""

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import LoadParameter, Whole
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.base.frozen import Frozen, call
from sinuous.kernels.statics import layout as t
from sinuous.model.loads import Force, Load
from sinuous.statics.body import KEPT, Tables, body_of, rolled, tables_of, unrolled
from sinuous.statics.response import EquilibriumQuestion, Response

if TYPE_CHECKING:
    from sinuous.model.robot import Robot

ALIKE = 1e-4
"""Distance between ends of arcs up to which two equilibria are one, relative to the length of the robot."""


class FoundState(NamedTuple):
    """What the kernel found: states (N, 4), tensions (t,), and its record."""

    states: Floats
    tensions: Floats
    record: Floats

    @property
    def reached(self) -> float:
        """Share of the load for which it is an equilibrium: 1 where one was found."""
        return float(self.record[0])


class Equilibrium(Frozen):
    """The shape of a robot under load.

    Attributes
    ----------
    robot : Robot
    q : ndarray (n, 3)
        The configuration that the drive would make without any load.
    loads : tuple of Force or Payload
        Beside gravity and payload of the robot.
    states : ndarray (N, 4)
        Of every arc, base to tip: `bend_x, bend_y` (rad), twist about the tangent at its end (rad), length.
    tensions : ndarray (m,)
        Of all actuators, in their order; positive pulls. NaN where an actuator is no tendon or chamber through a
        segment that has a stiffness.
    stable : bool
        Whether energy is least there, as far as small motions go.
    reaction : ndarray (6,)
        Moment about the base, and force, with which the base holds the robot; in world axes.
    iterations : int
        Newton steps.
    question : EquilibriumQuestion
        What was asked: robot, loads and drive.
    """

    robot: "Robot"
    q: Floats
    loads: tuple[Load, ...]
    states: Floats
    tensions: Floats
    stable: bool
    reaction: Floats
    iterations: int
    question: EquilibriumQuestion
    _begin: Any
    _pulls: Floats

    def __init__(self, question: EquilibriumQuestion, q: Floats, tables: Tables, found: FoundState) -> None:
        from sinuous.kernels.statics import equilibrium as kernel  # noqa: PLC0415

        robot = question.robot
        tensions = np.full(len(robot.drive), np.nan)
        tensions[body_of(robot).lines.actuators] = found.tensions
        reaction = -found.record[kernel.TOTAL_MOMENT : kernel.EQUILIBRIUM_WIDTH]
        for array in (found.states, tensions, reaction):
            array.flags.writeable = False
        self._set(
            robot=robot,
            q=q,
            loads=question.loads,
            question=question,
            states=found.states,
            tensions=tensions,
            stable=bool(found.record[kernel.UNSTABLE] == 0.0),
            reaction=reaction,
            iterations=int(found.record[kernel.NEWTON_STEPS]),
            _begin=tables,
            _pulls=found.tensions,
        )

    def __repr__(self) -> str:
        deflection = float(np.linalg.norm(self.tip[:3, 3] - self.robot.tip(self.q)[:3, 3]))
        parts = [f"{len(self.states)} arcs", f"tip moved by {deflection:.4g}", "stable" if self.stable else "unstable"]
        return call("Equilibrium", parts)

    @cached_property
    def arcs(self) -> Floats:
        """Configuration (N, 3) of `body`: bends turned so that no arc is twisted; read-only."""
        return checks.closed(unrolled(self.states))

    @cached_property
    def body(self) -> "Robot":
        """The body as a robot of arcs, one segment each: `arcs` is its shape. It has no drive, and no load."""
        return body_robot(self.robot, self.states[:, t.LENGTH], float(self.states[:, t.TORSION].sum()))

    @cached_property
    def poses(self) -> Floats:
        """Poses (rows, 4, 4) of the ends of all rows in the world, as `Robot.forward` gives those without load."""
        ends = body_of(self.robot).ends
        frames = self.body.forward(self.arcs)[ends]
        rolls = np.cumsum(self.states[:, t.TORSION])[ends]
        return frames @ np.stack([rolled(float(angle)) for angle in rolls])

    @property
    def tip(self) -> Floats:
        """Pose (4, 4) of the tool (of the tip, without one) in the world."""
        return self.poses[-1] @ self.robot.tool

    @cached_property
    def error(self) -> float:
        """How far the tip is from where it would be if segments were elastic rods: an estimate (length unit).

        Errors fall with the square of the number of arcs, so it is 4/3 of what twice as many arcs move it by. NaN with
        straight tendons, whose disks stand between arcs.
        """
        if body_of(self.robot).lines.straight.any():
            return float("nan")
        finer = self.robot.changed(segments=[each.changed(arcs=2 * each.arcs) for each in self.robot.segments])
        moved = find_equilibrium(self.question._replace(robot=finer)).tip - self.tip
        return 4.0 / 3.0 * float(np.linalg.norm(moved[:3, 3]))

    def forces(self) -> Iterator[tuple[Floats, Floats]]:
        """Yield where each force and payload pulls, and the force (3,), in world axes; weights of the body are not."""
        gravity = self.robot.gravity
        for load in (*self.robot.payload, *self.loads):
            pose = self.poses[self.robot.end_row(load.segment) - 1]
            place = pose[:3, 3] + pose[:3, :3] @ load.position
            if isinstance(load, Force):
                yield place, load.force
            elif gravity is not None:
                yield place, load.mass * gravity

    def backbone(self, samples: Whole = 20) -> Floats:
        """Points (N * samples + 1, 3) of the backbone from base to tip, evenly spaced within each arc."""
        return self.body.backbone(self.arcs, samples)

    def others(self, starts: Whole = 20, seed: Whole = 0) -> list["Equilibrium"]:
        """Look for other equilibria of the same drive and loads, from scattered shapes; nearest to this first.

        Unstable ones (`stable`) are where a body may stand for a moment before it snaps into a stable one. That none
        is found does not prove that there is none.
        """
        count = checks.integer("starts", starts, 0, 100_000)
        random = np.random.default_rng(checks.integer("seed", seed, 0, 2**63 - 1))
        known, size = [self], self.robot.mean_length
        for _ in range(count):
            states = self._begin.states.copy()
            turns = random.normal(size=(len(self.robot), 2)) * random.uniform(0.3, 2.0)
            own = body_of(self.robot)
            gives = np.isfinite(self._begin.arcs[:, t.BEND_STIFFNESS])
            states[gives, :2] = (turns / own.counts[:, None])[own.owners][gives]
            for descends in (True, False):
                found = run(self.robot, self._begin._replace(states=states, tensions=self._pulls), descends)
                if found.reached >= 1.0:
                    one = Equilibrium(self.question, self.q, self._begin, found)
                    if all(one.apart(other) > ALIKE * size for other in known):
                        known.append(one)
        return sorted(known[1:], key=self.apart)

    def derivative(self, wrt: LoadParameter | Iterable[LoadParameter] = ("loads",)) -> Response:
        """Derive it by what it depends on: loads, payload, gravity, stiffness, base, and its drive.

        Parameters
        ----------
        wrt : str or sequence of str
            Groups of parameters: `loads`, `payload`, `gravity`, `stiffness`, `base`, and what it was asked with: `q`,
            `actuators` or `tensions`; see `sinuous.statics.response`.

        Raises
        ------
        InputError
            When there is no such group, or it was not asked with that.
        """
        return Response(self, wrt)

    def beside(self, question: EquilibriumQuestion) -> "Equilibrium | None":
        """Return the equilibrium of another question that Newton's method finds from this one; `None` where none."""
        q, tables = driven(question)
        near = tables._replace(states=self.states, tensions=self._pulls)
        found = run(question.robot, near, descends=False)
        return None if found.reached < 1.0 else Equilibrium(question, q, near, found)

    def apart(self, other: "Equilibrium") -> float:
        """Largest distance between ends of arcs of two equilibria of one robot."""
        first, second = (each.body.forward(each.arcs)[:, :3, 3] for each in (self, other))
        return float(np.linalg.norm(first - second, axis=-1).max())


def body_robot(robot: "Robot", lengths: Floats, roll: float) -> "Robot":
    """Return the body of a robot as one of arcs of these lengths (N,), whose tip has rolled by so much (rad).

    Its joints stay.
    """
    own, before = body_of(robot).owners, robot.drive.before
    owners = own[own >= before] - before  # segments alone: joints are what they are
    alone: dict[str, Any] = {"tendons": None, "chambers": None, "stage": None, "stiffness": None, "name": None}
    alone |= {"plane": None, "locked": None, "rest": (0.0, 0.0)}
    most = [2.0 * np.pi if each.max_bend > 0.0 or each.stiffness is not None else 0.0 for each in robot.segments]
    segments = [
        robot.segments[k].changed(length=float(length), max_bend=most[k], arcs=1, mass=0.0, **alone)
        for k, length in zip(owners, lengths[before:], strict=True)
    ]
    away: Any = {
        key: tuple(each[k] for k in owners) if isinstance(each := getattr(robot, key), tuple) else each
        for key in ("clearance", "self_clearance")
    }
    uncertainty = robot.uncertainty
    if uncertainty is not None and isinstance(uncertainty.bound, tuple):
        away["uncertainty"] = type(uncertainty)(tuple(uncertainty.bound[k] for k in owners), uncertainty.level)
    tool = rolled(roll) @ robot.tool
    return robot.changed(segments=segments, tool=tool, actuators=None, gravity=None, payload=None, **away)


@lru_cache(maxsize=KEPT)
def longest_body(robot: "Robot") -> "Robot":
    """Return the body of a robot at its greatest lengths, straight: of its group, lengths and tool change."""
    own = body_of(robot)
    longest = np.array([segment.length[1] for segment in robot.rows]) / own.counts
    return body_robot(robot, longest[own.owners], 0.0)


def find_equilibrium(question: EquilibriumQuestion) -> Equilibrium:
    """Return the equilibrium of a robot under load.

    Raises
    ------
    InputError
        When nothing has a stiffness, or none was found.
    """
    robot = question.robot
    _refuse_rigid(robot)
    q, tables = driven(question)
    found = run(robot, tables)
    if found.reached < 1.0:
        problem = f"no equilibrium was found beyond {100.0 * found.reached:.0f} % of the load"
        loads = list(question.loads) or "gravity and payload"
        raise InputError("load", problem, loads, "a load that the robot can hold")
    return Equilibrium(question, q, tables, found)


def under_load(robot: "Robot", q: Floats) -> Equilibrium | None:
    """The body under gravity and payload; `None` where nothing bends the robot, or no equilibrium was found."""
    if not robot.has_external_load:
        return None
    try:
        return robot.shape(q)
    except InputError:
        return None


def driven(question: EquilibriumQuestion) -> tuple[Floats, Tables]:
    """Return the configuration (n, 3) that a drive makes without load, and the tables of the robot."""
    robot, loads, drive, values, initial = question
    if drive == "q":
        return values, tables_of(robot, values, loads)
    if drive == "tensions":
        return _pulled(robot, values, loads, initial)
    displacements = robot.drive.motors.displacements(values)
    q = robot.without_load(displacements, initial)
    return q, tables_of(robot, q, loads, displacements)


def _pulled(robot: "Robot", tensions: Floats, loads: Sequence[Load], initial: Floats | None) -> tuple[Floats, Tables]:
    """The same of a robot whose tendons and chambers have these tensions (m,).

    What they leave alone is as in `initial` (n, 3), by default straight and of its mean length.
    """
    body = body_of(robot)
    own, q = body.lines, initial
    if q is None:
        q = np.array(robot.straight)
    tables = tables_of(robot, q, loads)
    tables.lines[:, t.HELD], tables.lines[:, t.LINE_VALUE] = 0.0, tensions[own.actuators]
    through = (np.arange(len(q)) >= own.sections[:, :1]) & (np.arange(len(q)) <= own.sections[:, 1:])
    moments = through.T @ (tensions[own.actuators][:, None] * own.arms)
    bends = body.rest + moments * (q[:, 2] / body.stiffness[:, 0])[:, None]
    pulled = (body.pulled & np.isfinite(body.stiffness[:, 0]))[body.owners]
    tables.states[pulled, :2] = (bends / body.counts[:, None])[body.owners][pulled]
    return q, tables


def _refuse_rigid(robot: "Robot") -> None:
    if not body_of(robot).gives:
        raise InputError(
            "stiffness", "missing", None, "a stiffness of at least one segment; without, nothing gives way"
        )


def run(robot: "Robot", tables: Tables, descends: bool = True) -> FoundState:
    """Look for an equilibrium from where the tables begin.

    Where it `descends`, for a stable one if there is one near; else for any.
    """
    from sinuous.kernels.statics.equilibrium import EQUILIBRIUM_WIDTH, equilibrate  # noqa: PLC0415

    found = FoundState(tables.states.copy(), tables.tensions.copy(), np.zeros(EQUILIBRIUM_WIDTH))
    equilibrate(*tables.body(robot.base), *found[:2], descends, tables.buffer(), found.record)
    return found
