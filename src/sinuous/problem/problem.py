"""The question: a robot, its targets, what stands around, and how exactly they must be met."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Self, TypedDict, Unpack

from sinuous.base import checks
from sinuous.base.arguments import Number
from sinuous.base.checks import Floats
from sinuous.base.frozen import Frozen, text
from sinuous.kernels import packing
from sinuous.kernels.packing import read_only
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Targets, Tolerance, as_tolerance, target_list, target_table
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.scene import Scene, SceneLike, as_snapshot
from sinuous.scene.snapshot import Snapshot


@dataclass(frozen=True, init=False, repr=False)
class Preferences(Frozen):
    """What to like better among all solutions; feasibility comes first, always.

    Parameters
    ----------
    start : float
        Weight of staying close to the start (bends in rad, lengths relative to their mean).
    bends : float
        Weight of small bends.
    clearance : float
        Clearance that is wished for, in the length unit; less than that is disliked.
    """

    start: float
    bends: float
    clearance: float

    def __init__(self, start: Number = 0.0, bends: Number = 0.0, clearance: Number = 0.0) -> None:
        for key, value in (("start", start), ("bends", bends), ("clearance", clearance)):
            self._set(**{key: checks.number(key, value, low=0.0)})

    def __bool__(self) -> bool:
        return self.start > 0.0 or self.bends > 0.0 or self.clearance > 0.0

    def beyond(self, demanded: float) -> Self:
        """Return the same where clearances count from the one that is demanded."""
        if demanded == 0.0 or self.clearance == 0.0:
            return self
        return type(self)(self.start, self.bends, max(0.0, self.clearance - demanded))

    def satisfied(self, clearance: float) -> bool:
        """Say whether a solution with this clearance cannot be better: there is enough, and nothing else is wished."""
        return self.start == self.bends == 0.0 and clearance >= self.clearance


class ProblemArguments(TypedDict, total=False):
    """Arguments of `Problem`."""

    robot: Robot
    targets: Targets
    scene: SceneLike | Snapshot | None
    tolerance: Tolerance | None


class _Open:
    """A problem while it is put together."""

    __slots__ = ("_rows", "robot", "scene", "targets", "tolerance")

    robot: Robot
    _rows: Floats
    scene: Snapshot
    targets: tuple[Target, ...]
    tolerance: Tolerance


class Problem(Frozen, _Open):
    """A robot, the targets to be met at once, a scene and tolerances; frozen.

    Parameters
    ----------
    robot : Robot
    targets : Target or list of Target
    scene : Scene, Snapshot or list of obstacles, optional
    tolerance : Tolerance, optional

    Attributes
    ----------
    robot : Robot
    targets : tuple of Target
    scene : Snapshot
        The obstacles as they were when the problem was made.
    tolerance : Tolerance
        With numbers for all that is not said.
    rows : ndarray (t, 15)
        The targets as kernels read them, read-only.

    Raises
    ------
    InputError
        When an argument is not what it should be.
    """

    __slots__ = ()

    _tables: ClassVar[frozenset[str]] = frozenset({"_rows"})

    def __init__(
        self,
        robot: Robot,
        targets: Targets,
        scene: SceneLike | Snapshot | None = None,
        tolerance: Tolerance | None = None,
    ) -> None:
        checks.instance("robot", robot, Robot, "a Robot")
        place = as_snapshot(scene)
        listed = target_list("targets", targets, robot)
        self._set(
            robot=robot,
            scene=place,
            tolerance=as_tolerance(tolerance).for_robot(robot),
            targets=listed,
            _rows=target_table(robot, listed),
        )
        check_sizes(robot, place)

    def _shown(self) -> Iterator[str]:
        yield f"{len(self.robot)} segments"
        yield text(self.targets[0]) if len(self.targets) == 1 else f"{len(self.targets)} targets"
        yield f"{len(self.scene)} obstacles"

    def changed(self, **values: Unpack[ProblemArguments]) -> "Problem":
        """Return the same problem with other values of some parameters."""
        return self._changed(values)

    def _content(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("robot", "targets", "scene", "tolerance")}

    @property
    def rows(self) -> Floats:
        """The targets as kernels read them (t, 15), read-only."""
        return read_only(self._rows)

    @classmethod
    def prepared(cls, robot: Robot, targets: tuple[Target, ...], scene: Snapshot, tolerance: Tolerance) -> "Problem":
        """Put together parts that are checked already: the quick way of a `Solver`."""
        problem: Any = _Open()
        problem.robot = robot
        problem.targets = targets
        problem.scene = scene
        problem.tolerance = tolerance
        problem._rows = target_table(robot, targets)
        problem.__class__ = cls  # closes it; five calls of `object.__setattr__` would cost 0.2 us
        return problem


def check_sizes(robot: Robot, scene: Scene | Snapshot) -> None:
    """Refuse a scene with a mesh that must be in another length unit than the robot, as `Mesh.check_size` says."""
    for i, obstacle in enumerate(scene.obstacles):
        if isinstance(obstacle, Mesh):
            with checks.inside(f"scene[{i}].mesh"):
                obstacle.check_size(robot.mean_length)


def settings_group(
    robot: Robot, tolerance: Tolerance, prefer: Preferences | None = None, options: Sequence[float] | Floats = ()
) -> Floats:
    """Return the settings of a solve as kernels read them, a new array; see `kernels.packing.settings_group`."""
    wishes = Preferences() if prefer is None else prefer.beyond(robot._least_clearances[0])
    return packing.settings_group(
        mount=robot.mount,
        unit=robot.mean_length,
        position_tolerance=tolerance.position,
        angle_tolerance=tolerance.angle,
        start_weight=wishes.start,
        bends_weight=wishes.bends,
        clearance_wish=wishes.clearance,
        options=options,
    )
