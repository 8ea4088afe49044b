"""What a method of inverse kinematics is: what it handles, its options, its place among all, and how it is prepared.

A method is chosen by its name, or by its options (`OptiPath(...)`). Options are a frozen dataclass whose fields say
what may stand in them, for Python, shell and kernels. A method is prepared once for a robot, a scene and tolerances;
its whole solve is then one compiled call, with a workspace for each thread.
"""

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache, partial
from importlib import import_module
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple, Self, cast

import numpy as np

from sinuous.base import checks
from sinuous.base.arguments import MethodName
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError, shown, suggested
from sinuous.base.frozen import ShortRepr
from sinuous.kernels.tables import (
    CODE,
    FAILED,
    GOAL,
    HAS_POSITION,
    ORIENTATION,
    RECORD_WIDTH,
    ROTATION,
    SOLVED,
    TARGET_SEGMENT,
    TARGET_WIDTH,
    Budget,
    Outcome,
    answer_size,
)
from sinuous.methods.search import check_size
from sinuous.model.robot import Robot, robot_group
from sinuous.problem.problem import Preferences, Problem, settings_group
from sinuous.problem.target import Tolerance
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot

LIMITS = ("length", "bend", "curvature", "actuators")
"""Limits that a robot may have."""


@dataclass(frozen=True)
class Capabilities:
    """What one method handles; by default that of a method which looks at the tip alone, and at no obstacles.

    Targets and tools that it does not handle are refused. Limits and obstacles that it does not handle are those that
    its answers may violate: such an answer is never solved, and `Solution.worst` says what it violates.

    Attributes
    ----------
    source : str
        Where the method is described.
    direction, rotation : bool
        Whether a target's position may come with a direction of the tangent, with a whole rotation.
    orientation_alone : bool
        Whether an orientation may be asked for without a position.
    several_targets : bool
        Whether targets may concern other segments than the last, and several be met at once.
    tool : bool
        Whether the robot may have a tool.
    limits : tuple of str
        Which limits it takes account of (see `LIMITS`).
    obstacles : bool
        Whether it avoids obstacles.
    preferences : bool
        Whether it minimises what is preferred among solutions.
    planes : bool
        Whether robots may have segments that bend in one plane only, or are locked bent.
    initial : bool
        Whether it begins from an initial configuration.
    routes : bool
        Whether routes through free space may serve it as initial configurations when its own starts fail. Published
        methods are shown as they are.
    """

    source: str
    direction: bool = True
    rotation: bool = False
    orientation_alone: bool = False
    several_targets: bool = False
    tool: bool = True
    limits: tuple[str, ...] = ("length", "bend", "curvature")
    obstacles: bool = False
    preferences: bool = False
    planes: bool = False
    initial: bool = True
    routes: bool = False

    @property
    def any_target(self) -> bool:
        """Whether there is no target that is refused."""
        return self.direction and self.rotation and self.orientation_alone and self.several_targets

    def refuse_robot(self, method: str, robot: Robot) -> None:
        """Refuse a robot that the method does not handle.

        Raises
        ------
        InputError
        """
        if not self.tool and not np.array_equal(robot.tool, np.eye(4)):
            raise InputError("robot.tool", f"not handled by the method {method}", robot.tool.tolist(), "no tool")
        if not self.planes and not robot.drive.coordinates.free:
            problem = f"locked bends, or bends in one plane, are not handled by the method {method}"
            raise InputError("method", problem, method, "newton, dls, monte_carlo or learned")

    def refuse_targets(self, method: str, rows: Floats, segments: int) -> None:
        """Refuse targets `rows` (t, 15) that the method does not handle, for a robot of so many segments.

        Raises
        ------
        InputError
        """
        if self.any_target:
            return
        problem = f"not handled by the method {method}"
        if len(rows) > 1 and not self.several_targets:
            raise InputError("targets", problem, f"{len(rows)} targets at once", "one target")
        for row in rows:
            segment, placed, orientation = int(row[TARGET_SEGMENT]), row[HAS_POSITION], int(row[ORIENTATION])
            if not self.several_targets and segment not in (-1, segments - 1):
                raise InputError("target.segment", problem, segment + 1, "a target of the last segment")
            if not self.orientation_alone and not placed:
                raise InputError("target.position", problem, None, "a target with a position")
            if orientation and not (self.rotation if orientation == ROTATION else self.direction):
                asked = "rotation" if orientation == ROTATION else "direction"
                raise InputError(f"target.{asked}", problem, row[GOAL:].tolist(), f"a target without {asked}")


NO_SCRATCH: tuple[int, Floats] = -1, np.empty(0)
"""Targets that the scratch of a new thread is enough for, and that scratch."""


class Compiled(NamedTuple):
    """The compiled search of a method, and what it needs besides the groups of robot and scene.

    Attributes
    ----------
    search : callable
        Takes groups of robot, scene and settings, then targets (m, t, 15), initial configurations (m, g, n, 3), budget,
        workspace, and the answers (m, 11 + 3 n) that it fills; see `sinuous.kernels.tables`.
    workspace : callable
        Returns how many numbers (float64) of workspace it needs for so many targets at once.
    options : ndarray
        Options of the method, as the kernel reads them from the end of the settings.
    """

    search: Callable[..., Any]
    workspace: Callable[[int], int]
    options: Floats | tuple[()] = ()


class Call(NamedTuple):
    """A compiled function and its arguments: a problem as it is built for a method, to be looked at or timed.

    Attributes
    ----------
    entry : callable
    arguments : tuple
        Groups of robot, scene and settings, targets, initial configurations, budget, workspace, and the array that is
        filled with the answer; layouts: see `sinuous.kernels.tables`.
    """

    entry: Callable[..., Any]
    arguments: tuple[Any, ...]


class Prepared:
    """A method, prepared for a robot in a scene.

    Parameters
    ----------
    name : str
    capabilities : Capabilities
    compiled : Compiled
    robot : Robot
    scene : Scene
    tolerance : Tolerance
    preferences : Preferences
    """

    def __init__(
        self,
        name: str,
        capabilities: Capabilities,
        compiled: Compiled,
        robot: Robot,
        scene: Scene,
        tolerance: Tolerance,
        preferences: Preferences,
    ) -> None:
        self._name, self._capabilities, self._compiled = name, capabilities, compiled
        self._robot, self._own_robot = robot_group(robot), robot
        self._bounded = robot.drive.elastic is not None and robot.drive.elastic.bounded
        self._settings = settings_group(robot, tolerance, preferences, compiled.options)
        self._preferences = preferences.beyond(robot._least_clearances[0]) or None  # to ask an object is a call
        self._segments = len(robot)
        self._local = threading.local()
        self._loads_with = scene, tolerance

    def load(self) -> None:
        """Compile the search, or load it; else the first problem does."""
        scene, tolerance = self._loads_with
        self._load(self._own_robot, scene.snapshot(), tolerance)

    def _load(self, robot: Robot, scene: Snapshot, tolerance: Tolerance) -> None:
        """Compile the search, or load it from the cache: it is called for no problem at all."""
        nothing = np.zeros((0, 1, TARGET_WIDTH)), np.empty((0, 0, self._segments, 3))
        self._search(scene, *nothing, (0, 0, 0, 0.0), np.empty((0, answer_size(self._segments))))

    def build(self, problem: Problem, initial: Floats, budget: Budget) -> Call:
        """Return what `run` would call."""
        self._capabilities.refuse_targets(self._name, problem._rows, self._segments)
        answers = np.empty((1, answer_size(self._segments)))
        return self._call(problem.scene, problem._rows[None], initial[None], budget, answers)

    def run(self, problem: Problem, initial: Floats, budget: Budget, reference: Floats | None = None) -> Outcome:
        """Solve a problem from the configurations `initial` (g, n, 3), then from own starts.

        `budget` holds the numbers of the own starts to try, from the first up to, without it, the last; a seed; and
        seconds. `reference` (n, 3) is what preferences mean by the initial configuration, where there is one. The run
        ends at the first start that is solved; `Outcome.starts` is 0 when the method has no starts
        of these numbers.
        """
        call = self.build(problem, initial, budget)
        call.entry(*call.arguments)
        return self._within_tensions(as_outcomes(call.arguments[-1])[0])

    def _within_tensions(self, outcome: Outcome) -> Outcome:
        """Take back what is solved where no tensions within their limits hold the shape: the search goes on."""
        if self._bounded and outcome.code == SOLVED and not self._own_robot.within_tensions(outcome.q):
            return outcome._replace(code=FAILED)
        return outcome

    def run_many(
        self,
        scene: Snapshot,
        rows: Floats,
        initial: Floats,
        budget: Budget,
        answers: Floats,
        references: Floats | None = None,
    ) -> None:
        """Solve m problems in one scene as `run` does one; may run in many threads at once.

        `rows` (m, t, 15) are the targets of each and `initial` (m, g, n, 3) its initial configurations, as kernels take
        them: writable, and in the order of C. `references` (m, n, 3) are what preferences mean by the initial
        configurations. Fills `answers` (m, 11 + 3 n).
        """
        if not self._capabilities.any_target:
            for each in rows:
                self._capabilities.refuse_targets(self._name, each, self._segments)
        self._search(scene, rows, initial, budget, answers)
        if self._bounded and len(answers):
            held = self._own_robot.within_tensions(answers[:, RECORD_WIDTH:].reshape(len(answers), -1, 3))
            answers[(answers[:, CODE] == SOLVED) & ~held, CODE] = FAILED

    def _search(self, scene: Snapshot, rows: Floats, initial: Floats, budget: Budget, answers: Floats) -> None:
        call = self._call(scene, rows, initial, budget, answers)
        call.entry(*call.arguments)

    def _call(self, scene: Snapshot, rows: Floats, initial: Floats, budget: Budget, answers: Floats) -> Call:
        groups = self._robot, self._scene_group(scene), self._settings
        workspace = self._workspace(rows.shape[1])
        return Call(self._compiled.search, (*groups, rows, initial, budget, workspace, answers))

    def _scene_group(self, scene: Snapshot) -> Floats | None:
        """Group of the scene, as the compiled search takes it."""
        return scene._kernel_group

    def _workspace(self, targets: int) -> Floats:
        """Scratch of this thread, for so many targets at once."""
        most, workspace = getattr(self._local, "scratch", NO_SCRATCH)
        if most < targets:
            workspace = np.empty(self._compiled.workspace(targets))
            self._local.scratch = targets, workspace
        return workspace


def as_outcomes(answers: Floats) -> list[Outcome]:
    """Outcomes of a batch of answers (m, 11 + 3 n)."""
    shapes = answers[:, RECORD_WIDTH:].reshape(len(answers), -1, 3).copy()
    return [
        Outcome.from_record(q, record) for q, record in zip(shapes, answers[:, :RECORD_WIDTH].tolist(), strict=True)
    ]


def _typed(text: str) -> Any:
    """Read what was typed as a problem file says it: a number, true or false, else a word."""
    from sinuous.files.documents import parse_yaml  # noqa: PLC0415

    try:
        return parse_yaml(text)
    except InputError:
        return text


@dataclass(frozen=True)
class OptionKind:
    """What a value may be: how to check it, to read it from text, and to hand it to a kernel as a number."""

    check: Callable[[str, Any], Any]
    encode: Callable[[Any], float] = float
    read: Callable[[str], Any] = _typed


def option(default: Any, kind: OptionKind) -> Any:
    """Field for a value of some kind."""
    return field(default=default, metadata={"kind": kind})


def number(default: float, *, low: float = -np.inf, above: float = -np.inf, high: float = np.inf) -> Any:
    """Field for a finite number in a range; `above` is excluded, the other ends are allowed."""
    return option(default, OptionKind(partial(checks.number, low=low, above=above, high=high)))


def count(default: int, low: int, high: int) -> Any:
    """Field for a whole number from `low` to `high`."""
    return option(default, OptionKind(partial(checks.integer, low=low, high=high)))


def choice(default: str, names: Sequence[str]) -> Any:
    """Field for one of several words; the kernel sees its place among them."""
    return option(default, OptionKind(partial(checks.choice, words=names), names.index, str))


def flag(default: bool) -> Any:
    """Field for yes or no."""
    return option(default, OptionKind(checks.truth))


@dataclass(frozen=True, repr=False)
class Options(ShortRepr):
    """Base of the options of every method: values are checked as they come in.

    A class of options says of its method what it is called (`method`), what it handles (`capabilities`), sets of values
    that have a name (`presets`), its `compiled_search`, and how many numbers of scratch
    that takes (`scratch`).

    Raises
    ------
    InputError
        That names the option, when a value is not what it should be.
    """

    method: ClassVar[str] = ""
    capabilities: ClassVar[Capabilities] = Capabilities("")
    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = MappingProxyType({})
    compiled_search: ClassVar[Callable[..., Any]]
    prepared: ClassVar[type[Prepared]] = Prepared

    def __post_init__(self) -> None:
        for each in fields(self):
            object.__setattr__(self, each.name, each.metadata["kind"].check(each.name, getattr(self, each.name)))

    @classmethod
    def parse(cls, pairs: Iterable[str]) -> Self:
        """Read options as they are typed: `KEY=VALUE` each; `preset=NAME` gives the others their values.

        Raises
        ------
        InputError
            When one is not of this form, not known, given twice, or refused.
        """
        kinds = {each.name: each.metadata["kind"] for each in fields(cls)}
        if cls.presets:
            kinds["preset"] = choice("", tuple(cls.presets)).metadata["kind"]
        values: dict[str, Any] = {}
        for pair in pairs:
            key, equals, text = pair.partition("=")
            if not equals:
                raise InputError("", "not an option", pair, "KEY=VALUE")
            if key not in kinds:
                known = suggested(key, kinds) if kinds else "none: this method has no options"
                raise InputError(key, "unknown option", text, known)
            if key in values:
                raise InputError(key, "given twice", text, "every option once")
            values[key] = kinds[key].read(text)
        chosen = values.pop("preset", None)
        if chosen is not None:
            values = {**cls.presets[kinds["preset"].check("preset", chosen)], **values}
        return cls(**values)

    def refuse(self, robot: Robot) -> None:
        """Refuse a robot that these options are not meant for; none by default.

        Raises
        ------
        InputError
        """

    def ready(self, robot: Robot, scene: Scene) -> Self:
        """Return the same with all that is found out once for a robot in a scene: by default there is no such thing."""
        return self

    def vector(self) -> Floats:
        """All values in the order of the fields, as the kernel of the method reads them."""
        return np.array([each.metadata["kind"].encode(getattr(self, each.name)) for each in fields(self)], np.float64)

    def told(self, robot: Robot, scene: Scene) -> Floats:
        """What the kernel of the method is told of them, a robot and a scene: by default all values."""
        return self.vector()

    def scratch(self, segments: int) -> int:
        """How many numbers (float64) of scratch the kernel of the method takes."""
        raise NotImplementedError

    def prepare(self, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> Prepared:
        """Prepare the method for a robot in a scene: compile or load its kernels."""
        compiled = self.compiled(robot, scene)
        return self.prepared(self.method, self.capabilities, compiled, robot, scene, tolerance, preferences)

    def compiled(self, robot: Robot, scene: Scene) -> Compiled:
        """Return the compiled search of the method, and what it needs for this robot and scene."""
        size = check_size(len(robot), len(scene)) + self.scratch(len(robot))
        return Compiled(self.compiled_search, lambda _: size, self.told(robot, scene))


Choice = MethodName | Options
"""How a method is chosen: its name, or its options."""

METHODS: dict[MethodName, str] = {
    "newton": "newton.Newton",
    "opti_path": "opti_path.options.OptiPath",
    "dls": "dls.Dls",
    "fabrikc": "fabrik.reaching.Fabrikc",
    "slinki": "slinki.Slinki",
    "fabrikx": "fabrik.reaching.Fabrikx",
    "fabrik_avoid": "fabrik.reaching.FabrikAvoid",
    "monte_carlo": "monte_carlo.MonteCarlo",
    "learned": "learned.Learned",
}
"""Where the options of every method are, within `sinuous.methods`; they are imported when they are asked for. Ours is
the first."""


def options_class(name: str) -> type[Options]:
    """Return the class of the options of the method called `name`.

    Raises
    ------
    InputError
        When there is no such method.
    """
    return _class_at(METHODS[_known(name)])


@cache
def _class_at(path: str) -> type[Options]:
    home, _, class_name = path.rpartition(".")
    return cast(type[Options], getattr(import_module(f"sinuous.methods.{home}"), class_name))


def with_options(name: str, pairs: Iterable[str]) -> Choice:
    """Choose the method called `name` with options as they are typed, `KEY=VALUE` each.

    Raises
    ------
    InputError
        When there is no such method, or an option is refused.
    """
    pairs = list(pairs)
    chosen = options_class(name)
    return chosen.parse(pairs) if pairs else name_of(name)


def name_of(method: Choice | str) -> MethodName:
    """Return the name of a chosen method.

    Raises
    ------
    InputError
        When it is none.
    """
    return _known(method.method if isinstance(method, Options) else method)


def _known(name: str) -> MethodName:
    if not isinstance(name, str) or name not in METHODS:
        raise InputError("method", f"unknown method {shown(name)}", name, suggested(name, METHODS))
    return name


def options_of(method: Choice) -> Options:
    """Return the options of a method, by default those of its name."""
    return method if isinstance(method, Options) else options_class(name_of(method))()


def capabilities(method: Choice) -> Capabilities:
    """What a method handles."""
    return options_class(name_of(method)).capabilities


def ready(method: Choice, robot: Robot, scene: Scene, preferences: Preferences) -> Choice:
    """Return the choice with all that is found out once for a robot in a scene: see `Options.ready`.

    Raises
    ------
    InputError
        When there is no such method, or it does not handle this robot or these preferences.
    """
    name, chosen = name_of(method), options_of(method)
    chosen.capabilities.refuse_robot(name, robot)
    if preferences and not chosen.capabilities.preferences:
        raise InputError("prefer", f"not handled by the method {name}", preferences, "no preferences")
    own = chosen.ready(robot, scene)
    return method if own is chosen else own


def prepare(method: Choice, robot: Robot, scene: Scene, tolerance: Tolerance, preferences: Preferences) -> Prepared:
    """Prepare a method that is ready."""
    return options_of(method).prepare(robot, scene, tolerance, preferences)
