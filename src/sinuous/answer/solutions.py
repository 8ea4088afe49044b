"""The answers to many questions: arrays over all of them, and a `Solution` of each that is asked for."""

import operator
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from sinuous.answer.solution import Solution
from sinuous.answer.solve_again import SolveAgain
from sinuous.answer.status import statuses_of
from sinuous.base import checks
from sinuous.base.arguments import Parameter
from sinuous.base.checks import Floats, closed, motor_columns
from sinuous.base.documents import write_table
from sinuous.base.errors import InputError, NotSolvedError
from sinuous.base.frozen import Frozen, NotebookMixin
from sinuous.kernels import tables as t
from sinuous.kernels.tables import Outcome
from sinuous.model.robot import Robot
from sinuous.model.segment import coordinate_names
from sinuous.problem.target_sets import ManyProblems

if TYPE_CHECKING:
    from sinuous.answer.derivatives.many import Derivatives

Whole = NDArray[np.int64]
Objects = NDArray[np.object_]


class Beyond(NamedTuple):
    """What few answers have besides numbers; see `Outcome`."""

    cell: float
    route: Floats | None


class Solutions(NotebookMixin, Frozen, Sequence[Solution]):
    """What solving many targets found, in their order; frozen.

    A sequence of `Solution`, each made when it is asked for. An index that is a slice, or an array of numbers or of
    truth values, gives `Solutions`: `many[~many.solved]`.

    Every attribute is an array over all answers, m of them, called as in `Solution`; where that has `None`, numbers are
    NaN.

    Attributes
    ----------
    q : ndarray (m, n, 3)
        Configurations, read-only.
    status : ndarray (m,) of Status
    solved : ndarray (m,) of bool
    position_error, angle_error : ndarray (m,)
    clearance, self_clearance : ndarray (m,)
    iterations, starts : ndarray (m,) of int
    start : ndarray (m,) of str
    seconds : ndarray (m,)
        Time of each solve alone.
    actuators : dict or None
        Values (m,) of every actuator, by its name.
    method : str
    seed : int
    """

    __slots__ = ("_answers", "_beyond", "_problems", "_resolver")

    _resolver: SolveAgain
    _answers: Floats
    _beyond: Mapping[int, Beyond]
    _problems: ManyProblems

    def __init__(
        self, problems: ManyProblems, answers: Floats, resolver: SolveAgain, beyond: Mapping[int, Beyond] | None = None
    ) -> None:
        self._set(_problems=problems, _answers=closed(answers), _resolver=resolver, _beyond=dict(beyond or {}))

    def __reduce__(self) -> tuple[Any, ...]:
        return Solutions, (self._problems, self._answers, self._resolver, self._beyond)

    def equals(self, other: object) -> bool:
        """Whether `other` holds the same answers, to the last digit, whatever time they took."""
        if not isinstance(other, Solutions) or self._answers.shape != other._answers.shape:
            return False
        own, others = (np.delete(each._answers, t.SECONDS, axis=1) for each in (self, other))
        return np.array_equal(own, others, equal_nan=True)

    def __len__(self) -> int:
        return len(self._answers)

    @overload
    def __getitem__(self, index: int | np.integer[Any]) -> Solution: ...
    @overload
    def __getitem__(self, index: slice | Sequence[int] | NDArray[Any]) -> "Solutions": ...
    def __getitem__(self, index: Any) -> "Solution | Solutions":
        if isinstance(index, slice):
            return self._some(index, np.arange(len(self))[index])
        if isinstance(index, (list, tuple, np.ndarray)):
            numbers = np.arange(len(self))[np.asarray(index, np.int64) if len(index) == 0 else np.asarray(index)]
            if numbers.ndim != 1:
                raise InputError("index", "", index, "a number, a slice, or an array with one axis")
            return self._some(numbers, numbers)
        i = operator.index(index)
        if not -len(self) <= i < len(self):
            raise IndexError(f"there are {len(self)} solutions, and none is number {i}")
        return self._one(i % len(self))

    def __iter__(self) -> Iterator[Solution]:
        return map(self._one, range(len(self)))

    def _some(self, index: Any, numbers: Whole) -> "Solutions":
        beyond = {
            place: self._beyond[number]
            for place, number in (enumerate(numbers.tolist()) if self._beyond else ())
            if number in self._beyond
        }
        return Solutions(self._problems.some(index), self._answers[index], self._resolver, beyond)

    def _one(self, i: int) -> Solution:
        answer = self._answers[i]
        outcome = Outcome.from_record(answer[t.RECORD_WIDTH :].reshape(-1, 3).copy(), answer[: t.RECORD_WIDTH].tolist())
        if i in self._beyond:
            outcome = outcome._replace(**self._beyond[i]._asdict())
        given = self._problems.initial[i]
        return Solution(self._problems.problem(i), outcome, outcome.seconds, self._resolver, given)

    @property
    def configuration(self) -> Floats:
        """Configurations (m, rows, 3) of joints and segments, read-only."""
        return self._answers[:, t.RECORD_WIDTH :].reshape(len(self), len(self._problems.robot), 3)

    @property
    def q(self) -> Floats:
        """Of the segments: (m, n, 3), read-only; `configuration` where there are no joints."""
        return self._problems.robot.segments_of(self.configuration)

    @property
    def joints(self) -> Floats:
        """Values (m, j) of the joints before the segments, in the order of `robot.joint_names`."""
        return self._problems.robot.joints_of(self.configuration)

    @property
    def status(self) -> Objects:
        """How each ended: `Status` (m,)."""
        return statuses_of(self._answers)

    @property
    def solved(self) -> NDArray[np.bool_]:
        """Whether each status is `solved` (m,)."""
        return np.asarray(self._answers[:, t.CODE] == t.SOLVED)

    @property
    def position_error(self) -> Floats:
        """Largest distance (m,) of an end to its target position; NaN where none is asked for."""
        return np.where(self._problems.target_sets.placed, self._answers[:, t.POSITION_ERROR], np.nan)

    @property
    def angle_error(self) -> Floats:
        """Largest angle (m,) of an end to its target orientation, rad; NaN where none is asked for."""
        return np.where(self._problems.target_sets.turned, self._answers[:, t.ANGLE_ERROR], np.nan)

    @property
    def clearance(self) -> Floats:
        """Proved lower bounds (m,) of the distance between body and obstacles; NaN without obstacles, or a proof."""
        return self._proved(t.CLEARANCE, len(self._problems.scene) > 0, self._problems.robot._least_clearances[0])

    @property
    def self_clearance(self) -> Floats:
        """Proved lower bounds (m,) of the distance of the body from itself; NaN where it may cross, or unproved."""
        robot = self._problems.robot
        return self._proved(t.SELF_CLEARANCE, robot.avoids_itself, robot._least_clearances[1])

    def _proved(self, column: int, matters: bool, demanded: float) -> Floats:
        return np.where(self.solved & matters, self._answers[:, column] + demanded, np.nan)

    @property
    def iterations(self) -> Whole:
        """Iterations (m,) of all starts together."""
        return self._answers[:, t.ITERATIONS].astype(np.int64)

    @property
    def starts(self) -> Whole:
        """How many starts were tried (m,)."""
        return self._answers[:, t.STARTS].astype(np.int64)

    @property
    def start(self) -> NDArray[np.str_]:
        """Which kind of start led to it (m,): given, arc, random or route."""
        return np.array(t.SOURCES)[self._answers[:, t.SOURCE].astype(np.int64)]

    @property
    def seconds(self) -> Floats:
        """Time (m,) of each solve alone."""
        return self._answers[:, t.SECONDS]

    @property
    def actuators(self) -> dict[str, Floats] | None:
        """Values (m,) of every actuator, by its name; `None` without any."""
        robot = self._problems.robot
        names = [actuator.name for actuator in robot.actuators]
        return dict(zip(names, robot.to_actuators(self.configuration).T, strict=True)) if names else None

    def to_csv(
        self, file: str | Path, actuators: Sequence[str] | None = None, *, columns: Sequence[str] | None = None
    ) -> None:
        """Write the values of the motors, in their units, as CSV: one row a target, in the order of the targets.

        Columns: `target` (1 = first), `status`, then every actuator by its name. Rows that are not `solved` have the
        values of the best configuration that was found.

        Parameters
        ----------
        file : path
        actuators : sequence of str, optional
            Names of actuators, in the order of the columns; by default all, in the order of the robot.
        columns : sequence of str, optional
            Instead, names of any columns that `Motion.to_csv` has, in this order.

        Raises
        ------
        InputError
            When the robot has no actuators and no columns are named, a name is not known or given twice, both are
            given, or the file cannot be written.
        """
        robot = self._problems.robot
        own = [actuator.name for actuator in robot.actuators]
        if columns is None:
            if not own:
                raise InputError("robot", "has no actuators", robot, "one that has some, or columns=")
            columns = motor_columns(checks.names_of("actuators", actuators, own), robot.joint_names)
        elif actuators is not None:
            raise InputError("columns", "cannot be combined with actuators", columns, "one of the two")
        names, values = chosen_columns(robot, self.configuration, columns)
        each = zip(self.status.tolist(), values, strict=True)
        rows = ([number, str(status), *row] for number, (status, row) in enumerate(each, 1))
        write_table(file, ["target", "status", *names], rows)

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._resolver.method

    @property
    def seed(self) -> int:
        """Of the scattered starts."""
        return self._resolver.seed

    def derivative(self, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "Derivatives":
        """Derive all answers that are solved, as `Solution.derivative` does one; derivatives of others are NaN.

        Parameters
        ----------
        wrt : str or sequence of str
            Groups of parameters.

        Returns
        -------
        Derivatives
            Arrays over all answers. Columns of what is not asked of a target are left out where that is so for all
            answers; otherwise they are zero.

        Raises
        ------
        InputError
            When there is no such group, or when it is `target` and not all answers have equally many targets.
        """
        from sinuous.answer.derivatives.many import derivatives_of  # noqa: PLC0415
        from sinuous.answer.derivatives.parameters import read_wrt  # noqa: PLC0415

        chooses, robot = self._resolver.chooses, self._problems.robot
        clear = self._answers[:, t.CLEARANCE].tolist()
        liked = {i: self._one(i)._wish() for i, each in enumerate(clear) if chooses(robot, each)}
        return derivatives_of(self._problems, self.configuration, self.solved, liked, read_wrt(wrt))

    def raise_for_status(self) -> "Solutions":
        """Return these solutions when all are solved.

        Raises
        ------
        NotSolvedError
            When one is not; its `solution` is the first of those.
        """
        failed = np.flatnonzero(~self.solved)
        if len(failed):
            first = int(failed[0])
            solution = self[first]
            raise NotSolvedError(f"{self!r}; the first is number {first}: {solution._in_a_line()}", solution)
        return self

    def __repr__(self) -> str:
        counts = Counter(map(str, self.status.tolist()))
        told = ", ".join(f"{count:,} {status}" for status, count in counts.most_common())
        return f"Solutions: {len(self):,} of {len(self._problems.robot.segments)} segments{': ' if told else ''}{told}"


def column_names(robot: Robot) -> list[str]:
    """Names of the numbers in tables: joints, `s1.bend_x`, `s1.bend_y`, `s1.length` of every segment, all actuators."""
    motors = motor_columns((actuator.name for actuator in robot.actuators), robot.joint_names)
    return [*robot.joint_names, *coordinate_names(robot.segment_names), *motors]


def chosen_columns(robot: Robot, q: Floats, chosen: Sequence[str] | None) -> tuple[list[str], list[list[float]]]:
    """Return the names of columns and their numbers (T, c) for configurations (T, n, 3), or of those that are chosen.

    Raises
    ------
    InputError
        When a name is not known, or given twice.
    """
    known = column_names(robot)
    names = checks.names_of("columns", chosen, known)
    own = robot.segments_of(q).reshape(len(q), 3 * len(robot.segments))
    numbers = np.concatenate([robot.joints_of(q), own, robot.to_actuators(q)], axis=-1)
    return names, numbers[:, [known.index(name) for name in names]].tolist()
