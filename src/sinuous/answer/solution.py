"""The answer to a solve: a status that says what was proved, the configuration, and what was worst."""

import math
import textwrap
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from sinuous.answer.binding import Binding, find_binding, in_words, rate_binding
from sinuous.answer.explanation import Explanation, explain
from sinuous.answer.route_class import RouteClass
from sinuous.answer.solve_again import SolveAgain, as_demanded, read_result
from sinuous.answer.status import Reason, Status, base_in, closed_in, status_of, target_in, unreachable
from sinuous.answer.trials import Case
from sinuous.answer.verification import Verification, verify
from sinuous.answer.worst import Worst, find_worst
from sinuous.base import checks
from sinuous.base.arguments import Number, Parameter, Rows, StartKind, Vector
from sinuous.base.checks import Floats
from sinuous.base.documents import plain, result_of
from sinuous.base.errors import NotSolvedError, answers_attributes, counted, duration, listed
from sinuous.base.frozen import NotebookMixin, call
from sinuous.base.progress import work_time
from sinuous.kernels.packing import read_only
from sinuous.kernels.tables import SOLVED, SOURCES, Outcome
from sinuous.model.rates import Changes
from sinuous.model.robot import Robot
from sinuous.problem.problem import Problem, ask_body

if TYPE_CHECKING:
    from sinuous.answer.derivatives.derivative import Derivative
    from sinuous.answer.derivatives.preferred import Wish
    from sinuous.statics.equilibrium import Equilibrium

CLEARANCES = "clearance self_clearance demanded_clearance demanded_self_clearance"
"""What results say of clearances."""

_OVERLAPS = (Status.BLOCKED, Status.UNPROVED, Status.BASE_BLOCKED, Status.TARGET_BLOCKED)
"""Statuses of which clearance is the reason."""


_OF_CLEARANCE = {
    **dict.fromkeys(_OVERLAPS, "or is nearer to one than is demanded"),
    Status.SOLVED: "by as much as is demanded",
    Status.NO_ROUTE: "with the clearance that is demanded",
    Status.UNPROVED: "as far as it is demanded",
}
"""What is added to the meaning of a status where a clearance is demanded."""


@answers_attributes(
    success="solution.solved",
    error="solution.position_error and solution.angle_error",
    position="solution.tip[:3, 3]",
    lengths="solution.q[:, 2]",
    plot="sn.plot(solution)",
    show="sn.show(solution)",
    save="solution.to_dict(), which json.dumps takes",
    to_csv="solution.q and solution.actuators; motions have to_csv",
)
class Solution(NotebookMixin):
    """What a solve found; frozen. On failure it holds the best configuration found.

    With the method `newton` that one keeps all limits; other methods may violate some, and `worst` says which.

    Attributes
    ----------
    status : Status
    q : ndarray (n, 3)
        Configuration: bend_x, bend_y (rad), length of every segment; read-only.
    position_error, angle_error : float or None
        Largest distance (length unit) and angle (rad) to a target; `None` where no target asks for it.
    clearance : float or None
        Proved lower bound of the distance between body and obstacles; `None` without obstacles, or without a proof.
    self_clearance : float or None
        Proved lower bound of the distance of the body from itself, over all places half a circle of its radius or more
        apart along it; infinite when it is shorter than that. `None` without a proof, for a body without thickness,
        and where it may run through itself.
    iterations, starts : int
        Newton iterations in all, and how many starts they came from.
    start : str
        Which kind of start led to it: given, arc, random, route or remembered.
    route : ndarray (k, 3) or None
        Where the start came from a route: its points, from the base to the target; read-only. To be drawn beside the
        body, which may leave it.
    route_class : RouteClass or None
        Of a solution of `solve_all`: which class of routes it belongs to, and which obstacles the body passes on which
        side. `None` where that was not asked for, or not found out in time.
    seconds : float
        Time of the solve alone.
    method : str
    seed : int
    problem : Problem
        What was asked, with the obstacles as they were then.
    """

    # Properties over private slots: setting attributes as `sinuous.base.frozen.Frozen` does would cost a solve 0.3 us.
    __slots__ = (
        "_binding",
        "_given",
        "_outcome",
        "_problem",
        "_reason",
        "_resolver",
        "_route_class",
        "_seconds",
        "_status",
        "_within",
        "_worst",
    )

    _binding: tuple[Binding, ...]
    _reason: Reason | None
    _worst: Worst | None

    def __init__(
        self,
        problem: Problem,
        outcome: Outcome,
        seconds: float,
        resolver: SolveAgain,
        given: Floats,
        route_class: RouteClass | None = None,
        within: Changes | None = None,
    ) -> None:
        self._problem = problem
        self._status = status_of(outcome)
        self._outcome = outcome
        self._seconds = seconds
        self._resolver = resolver
        self._given = given
        self._route_class = route_class
        self._within = within
        # By position: by its name, or by `flags`, it takes three times as long.
        outcome.q.setflags(False)  # type: ignore[call-arg]

    def __copy__(self) -> "Solution":
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> "Solution":
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        own = self.problem, self._outcome, self.seconds, self._resolver, self._given, self._route_class, self._within
        return Solution, own

    @property
    def problem(self) -> Problem:
        """What was asked, with the obstacles as they were then."""
        return self._problem

    @property
    def status(self) -> Status:
        """How it ended."""
        return self._status

    @property
    def configuration(self) -> Floats:
        """Configuration (rows, 3) of joints and segments, read-only; see `Robot.configuration`."""
        return self._outcome.q

    @property
    def q(self) -> Floats:
        """Of the segments: bend_x, bend_y, length (n, 3), read-only; `configuration` where there are no joints."""
        return self.problem.robot.segments_of(self.configuration)

    @property
    def joints(self) -> Floats:
        """Values (j,) of the joints before the segments, in the order of `robot.joint_names`."""
        return self.problem.robot.joints_of(self.configuration)

    @property
    def seconds(self) -> float:
        """Time of the solve alone."""
        return self._seconds

    @property
    def method(self) -> str:
        """Name of the method."""
        return self._resolver.method

    @property
    def seed(self) -> int:
        """Of the scattered starts."""
        return self._resolver.seed

    @property
    def iterations(self) -> int:
        """Iterations of all starts together."""
        return self._outcome.iterations

    @property
    def starts(self) -> int:
        """How many starts were tried."""
        return self._outcome.starts

    @property
    def start(self) -> StartKind:
        """Which kind of start led to it: given, arc, random, route or remembered."""
        return cast(StartKind, SOURCES[self._outcome.source])

    @property
    def route(self) -> Floats | None:
        """Points (k, 3) of the route that the start was fitted to; `None` unless a route led to the solution."""
        return self._outcome.route

    @property
    def route_class(self) -> RouteClass | None:
        """Which class of routes it belongs to, and what the body passes on which side; of `solve_all` alone."""
        return self._route_class

    @property
    def solved(self) -> bool:
        """Whether the status is `solved`."""
        return self.status is Status.SOLVED

    @property
    def position_error(self) -> float | None:
        """Largest distance of an end to its target position; `None` where none is asked for, or no body is at rest."""
        asked = any(t.position is not None for t in self.problem.targets)
        return finite_or_none(self._outcome.position_error) if asked else None

    @property
    def angle_error(self) -> float | None:
        """Largest angle (rad) of an end to its target orientation; `None` where none is asked for, or no body rests."""
        asked = any(t.direction is not None or t.rotation is not None for t in self.problem.targets)
        return finite_or_none(self._outcome.angle_error) if asked else None

    @property
    def clearance(self) -> float | None:
        """Proved lower bound of the distance between body and obstacles."""
        if not (self.solved and len(self.problem.scene)):
            return None
        return self._outcome.clearance + self.problem.robot._least_clearances[0]

    @property
    def self_clearance(self) -> float | None:
        """Proved lower bound of the distance of the body from itself."""
        if not (self.solved and self.problem.robot.avoids_itself):
            return None
        return self._outcome.self_clearance + self.problem.robot._least_clearances[1]

    @property
    def demanded_clearance(self) -> float | tuple[float, ...] | None:
        """Clearance that the body had to keep: of all segments, or one each; `None` where none was demanded."""
        return demanded(self.problem.robot.clearance)

    @property
    def demanded_self_clearance(self) -> float | tuple[float, ...] | None:
        """The same from itself."""
        return demanded(self.problem.robot.self_clearance)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.problem.robot

    @property
    def tip(self) -> Floats:
        """Pose (4, 4) of the tool (of the tip, without one) in the world."""
        shape = self.shape
        return read_only(self.problem.robot.tip(self.configuration) if shape is None else shape.tip)

    @property
    def base(self) -> Floats:
        """Pose (4, 4) of the robot's base."""
        return self.problem.robot.base

    @property
    def actuators(self) -> dict[str, float] | None:
        """Values of the motors by name, see `Robot.to_actuators`; `None` without any actuator."""
        robot = self.problem.robot
        names = [actuator.name for actuator in robot.actuators]
        return dict(zip(names, robot.to_actuators(self.configuration).tolist(), strict=True)) if names else None

    @property
    def tensions(self) -> dict[str, float] | None:
        """Tensions of the elastic actuators by name, positive where they pull; `None` without any.

        Of a robot that gravity bends, those of all tendons and chambers under load.
        """
        drive, shape = self.problem.robot.drive, self.shape
        if shape is not None:
            pairs = zip(drive.actuators, shape.tensions.tolist(), strict=True)
            return {each.name: tension for each, tension in pairs if not math.isnan(tension)} or None
        if drive.elastic is None:
            return None
        names = [drive.actuators[place].name for place in drive.elastic.places]
        return dict(zip(names, drive.elastic.balance(self.configuration).tensions.tolist(), strict=True))

    @property
    def reason(self) -> Reason | None:
        """What proves that there is no solution; `None` when nothing does."""
        if not hasattr(self, "_reason"):
            self._reason = self._find_reason()
        return self._reason

    @property
    def worst(self) -> Worst | None:
        """The constraint farthest from being met; `None` when solved, or when no stable equilibrium was found."""
        if not hasattr(self, "_worst"):
            self._worst = None if self.solved or self._falls else self._find_worst()
        return self._worst

    @property
    def _falls(self) -> bool:
        """Whether loads bend the robot, and no stable equilibrium was found."""
        return self.problem.robot.has_external_load and math.isinf(self._outcome.position_error)

    def _find_worst(self) -> Worst:
        """Of a robot under load what its body misses, by segments of the robot."""
        problem, robot = self.problem, self.problem.robot
        if not robot.has_external_load or self.shape is None:
            asked = ask_body(robot, self.configuration, ())
            return find_worst(problem, self.configuration, self.status in _OVERLAPS).on_robot(asked)
        asked = ask_body(problem.robot, self.configuration, problem.targets)
        body = Problem(asked.body, asked.targets, problem.scene, problem.tolerance)
        return find_worst(body, asked.arcs, self.status in _OVERLAPS).on_robot(asked)

    @property
    def shape(self) -> "Equilibrium | None":
        """The body under gravity and payload; `None` where nothing bends the robot, or no equilibrium was found."""
        from sinuous.statics.equilibrium import under_load  # noqa: PLC0415

        return under_load(self.problem.robot, self.configuration)

    @property
    def binding(self) -> tuple[Binding, ...]:
        """The limits, rates and obstacles that hold the best configuration back, strongest first; empty when solved."""
        if not hasattr(self, "_binding"):
            self._binding = () if self.solved else self._find_binding()
        return self._binding

    @property
    def sentence(self) -> str:
        """What the status means here; of `limit_bound` with the names of the limits."""
        if self._falls:
            return f"{self.status.sentence}: no stable equilibrium under its loads was found"
        if self.status in _OF_CLEARANCE and self.problem.robot._demands_clearance:
            return f"{self.status.sentence}, {_OF_CLEARANCE[self.status]}"
        held = self.binding if self.status is Status.LIMIT_BOUND else ()
        limits = [each for each in held if each.key is not None]
        if not limits:
            return self.status.sentence
        return f"{self.status.sentence}: {listed(in_words(limits, len(self.problem.robot.segments)))}"

    def explain(self, time: Number = 2.0) -> Explanation:
        """Say why it ended like this, and what would help.

        Every change that is told was tried: with it the problem is solved and proved. What is found is the same each
        time, unless the time runs out.

        Parameters
        ----------
        time : float
            Budget of all trials together, in seconds.

        Returns
        -------
        Explanation
            Prints itself. When solved: what is closest to its limit.

        Raises
        ------
        InputError
            When `time` is no number of at least 0.
        """
        seconds = checks.number("time", time, low=0.0)
        end = work_time() + seconds
        given = self._given.reshape(-1, *self.configuration.shape)
        own = self.problem, self.status, self.configuration, given[0] if len(given) else None
        case = Case(*own, self.binding, self.reason, self._resolver, self.starts, self._within)
        return explain(case, self.sentence, end, seconds)

    def _find_binding(self) -> tuple[Binding, ...]:
        """What the forces at the best configuration say; first the obstacle that proves that there is no solution."""
        if self.problem.robot.has_external_load:
            return ()
        if self._within is not None:
            return rate_binding(self.problem, self.configuration, self._given[0], self._within)
        found = find_binding(self.problem, self.configuration, any_limit=self.status is Status.LIMIT_BOUND)
        reason = self.reason
        if reason is None or reason.obstacle is None or self.status is Status.NO_ROUTE:
            return found
        spare = reason.available - reason.needed
        own = reason.obstacle, spare + reason.clearance, reason.clearance
        first = Binding("clearance", None, *own, inside=reason.inside, place=reason.place)
        return (first, *(each for each in found if each.obstacle != reason.obstacle))

    def _find_reason(self) -> Reason | None:
        if self.status is Status.OUT_OF_REACH:
            return unreachable(self.problem)
        if self.status is Status.TARGET_BLOCKED:
            return target_in(self.problem)
        if self.status is Status.BASE_BLOCKED:
            return base_in(self.problem)
        if self.status is Status.NO_ROUTE:
            return closed_in(self.problem, self._outcome.cell)
        return None

    def derivative(self, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "Derivative":
        """Derive the answer by what it depends on: targets, the robot, where it stands, obstacles.

        Of all configurations near this one that meet changed targets, within the limits and clear of obstacles, the
        nearest one is meant: what a solve from this answer finds; of an answer that preferences have chosen the minimum
        near it. An answer that was moved out of contact with an obstacle is not called regular.

        Parameters
        ----------
        wrt : str or sequence of str
            Groups of parameters: `target`, `base`, `tool`, `lengths`, `bends`, `curvatures`, `radii`, `tendons`,
            `actuators`, `obstacles`, `initial`; see `sinuous.answer.derivatives.parameters`.

        Returns
        -------
        Derivative

        Raises
        ------
        InputError
            When there is no such group.
        NotSolvedError
            When it is not solved.
        """
        if self._outcome.code != SOLVED:
            self.raise_for_status()
        liked = self._resolver.chooses(self._problem.robot, self._outcome.clearance)
        return _derive()(self._problem, self._outcome.q, wrt, liked, self._wish() if liked else None)

    def _wish(self) -> "Wish | None":
        """The preferences that chose it; `None` where none did."""
        from sinuous.answer.derivatives.preferred import Wish  # noqa: PLC0415

        robot, preferences = self._problem.robot, self._resolver.preferences
        if robot.has_external_load or not preferences:  # derivatives know nothing of the loaded body
            return None
        own = preferences.beyond(robot._least_clearances[0])
        given = self._given.reshape(-1, *self.configuration.shape)
        return Wish(own, given[0] if len(given) else None, self._outcome.clearance - own.clearance)

    def vjp(self, cotangent: Rows, wrt: Parameter | Sequence[Parameter] = ("target",)) -> "dict[Parameter, Floats]":
        """Derivatives (p,) of `sum(cotangent * q)` by each group of parameters, for a cotangent (n, 3).

        Raises
        ------
        InputError, NotSolvedError
            As for `derivative`, or when the cotangent has another shape.
        """
        return self.derivative(wrt).vjp(cotangent)

    def jvp(self, tangent: Vector | Mapping[Parameter, Vector]) -> Floats:
        """Motion (n, 3) of the configuration when parameters begin to move along `tangent`; see `Derivative.jvp`.

        Parameters
        ----------
        tangent : array_like (p,), or mapping of str to array_like (p,)
            Of the target, or of groups of parameters by their names.

        Raises
        ------
        InputError, NotSolvedError
            As for `derivative`, or when a tangent has another shape.
        """
        return self.derivative(tuple(tangent) if isinstance(tangent, Mapping) else ("target",)).jvp(tangent)

    def verify(self) -> Verification:
        """Recompute everything by an independent, slow path; see `sinuous.answer.verification`."""
        return verify(self.problem, self.configuration)

    def raise_for_status(self) -> "Solution":
        """Return this solution when it is solved.

        Raises
        ------
        NotSolvedError
            When it is not.
        """
        if not self.solved:
            raise NotSolvedError(self._in_a_line(), self)
        return self

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], problem: Problem) -> "Solution":
        """Make a solution of its result as plain values, and of the problem that it answers.

        It says what the result says; `verify` recomputes that.

        Raises
        ------
        InputError
            When `values` are no result, or one for another number of segments.
        """
        problem = as_demanded(problem, values)
        outcome, resolver, route_class = read_result(values, problem)
        return cls(problem, outcome, outcome.seconds, resolver, np.empty((0, len(problem.robot), 3)), route_class)

    def to_dict(self) -> dict[str, Any]:
        """Return the result as plain values, in the order of the file format."""
        shape = self.shape
        load = {} if shape is None else {"load": "gravity", "loaded": shape.arcs.tolist()}
        locked = {"locked": list(notes)} if (notes := self.problem.robot.held_notes) else {}
        return {
            **result_of(self, "status joints" if self.problem.robot.joints else "status"),
            **result_of(self, f"q base position_error angle_error {CLEARANCES}"),
            "uncertainty": plain(self.problem.robot.uncertainty),
            **result_of(self, "actuators tensions"),
            **load,
            **locked,
            **result_of(self, "worst reason binding iterations starts start route_class seconds method seed"),
        }

    def __repr__(self) -> str:
        numbers = {"position_error": self.position_error, "angle_error": self.angle_error, "clearance": self.clearance}
        parts = [f"{key}={value:.3g}" for key, value in numbers.items() if value is not None]
        return call("Solution", [str(self.status), *parts, duration(self.seconds)])

    def _in_a_line(self) -> str:
        """What errors say: how it ended, and why or what is farthest from being met."""
        why = self.reason or self.worst
        return f"{self.status} ({self.sentence})" + ("" if why is None else f": {why}")

    def __str__(self) -> str:
        parts = [f"Solution: {self.status} ({self.sentence})"]
        if self.reason is not None:
            parts.append(f"  because        {self.reason}")
        if self.worst is not None:
            parts.append(f"  worst          {self.worst}")
        for label, value in (
            ("position error", self.position_error),
            ("angle error", self.angle_error),
            ("clearance", self.clearance),
            ("self-clearance", self.self_clearance),
        ):
            if value is not None:
                unsure = self.problem.robot.uncertainty if label == "clearance" else None
                parts.append(f"  {label:<14} {value:.3g}" + ("" if unsure is None else f", {unsure.confidence}"))
        if self.route_class is not None:
            parts.append(f"  route          {self.route_class}")
        effort = f"{counted(self.iterations, 'iteration')} from {counted(self.starts, 'start')}"
        parts.append(f"  effort         {effort}, {duration(self.seconds)}")
        if self.problem.robot.joints:
            pairs = zip(self.problem.robot.joint_names, self.joints.tolist(), strict=True)
            parts.append("  joints         " + "  ".join(f"{name}={value:.4g}" for name, value in pairs))
        if len(self.q):
            parts.append(
                "  q              " + np.array2string(self.q, precision=4, suppress_small=True, prefix=" " * 17)
            )
        values = self.problem.robot.drive.in_words(self.actuators or {})
        lines = textwrap.wrap(values, 100, break_long_words=False, break_on_hyphens=False)
        parts += [f"  {'' if i else 'actuators':<14} {line}" for i, line in enumerate(lines)]
        return "\n".join(parts)


def demanded(value: float | tuple[float, ...]) -> float | tuple[float, ...] | None:
    """A clearance that a robot demands, of all segments or one each; `None` where it demands none."""
    return value if any(value if isinstance(value, tuple) else (value,)) else None


def finite_or_none(value: float | None) -> float | None:
    """What a file says of a number: nothing where it is infinite."""
    return None if value is None or np.isinf(value) else value


@cache
def _derive() -> "Callable[..., Derivative]":
    """What derives answers; it knows solutions, so it is imported when the first is derived."""
    from sinuous.answer.derivatives.derivative import derivative_of  # noqa: PLC0415

    return derivative_of
