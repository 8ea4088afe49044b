"""The question: a robot, its targets, what stands around, and how exactly they must be met."""

from dataclasses import dataclass
from typing import Any

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.problem.target import Target, target_list, target_table
from sinuous.robot.robot import Robot
from sinuous.scene.meshes.mesh import Mesh
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot

RELATIVE_POSITION = 1e-4
ANGLE = 1e-3


@dataclass(frozen=True, init=False)
class Tolerance:
    """How far an answer may be from its targets, inclusive.

    Parameters
    ----------
    position : float, optional
        In the length unit; default 1e-4 of the sum of the mean segment lengths.
    angle : float
        In rad.
    """

    position: float | None
    angle: float

    def __init__(self, position: Any = None, angle: Any = ANGLE) -> None:
        object.__setattr__(
            self, "position", None if position is None else checks.number("position", position, above=0.0)
        )
        object.__setattr__(self, "angle", checks.number("angle", angle, above=0.0))

    def for_robot(self, robot: Robot) -> "Tolerance":
        """Fill in the default position tolerance."""
        return Tolerance(RELATIVE_POSITION * robot.mean_length, self.angle) if self.position is None else self


@dataclass(frozen=True, init=False)
class Preferences:
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

    def __init__(self, start: Any = 0.0, bends: Any = 0.0, clearance: Any = 0.0) -> None:
        for key, value in (("start", start), ("bends", bends), ("clearance", clearance)):
            object.__setattr__(self, key, checks.number(key, value, low=0.0))

    def __bool__(self) -> bool:
        return self.start > 0.0 or self.bends > 0.0 or self.clearance > 0.0


class Problem:
    """A robot, the targets to be met at once, a scene and tolerances; frozen.

    `rows` (t, 15) is the table of targets that the methods read.
    """

    __slots__ = ("robot", "rows", "scene", "targets", "tolerance")

    def __init__(self, robot: Robot, targets: Any, scene: Any = None, tolerance: Tolerance | None = None) -> None:
        if not isinstance(robot, Robot):
            raise InputError("robot", "of the wrong kind", robot, "a Robot")
        self.robot = robot
        self.scene = as_snapshot(scene)
        self.tolerance = as_tolerance(tolerance).for_robot(robot)
        self.targets: tuple[Target, ...] = target_list("targets", targets)
        self.rows: Floats = target_table(robot, self.targets)
        check_sizes(robot, self.scene)

    @classmethod
    def prepared(cls, robot: Robot, targets: tuple[Target, ...], scene: Snapshot, tolerance: Tolerance) -> "Problem":
        """Put together parts that are checked already: the quick way of a `Solver`."""
        problem = cls.__new__(cls)
        problem.robot = robot
        problem.targets = targets
        problem.scene = scene
        problem.tolerance = tolerance
        problem.rows = target_table(robot, targets)
        return problem


def as_scene(scene: Any) -> Scene:
    """Check a scene; `None` is the empty one, a list of obstacles their union."""
    if scene is None:
        return Scene()
    return scene if isinstance(scene, Scene) else Scene(scene)


def as_snapshot(scene: Any) -> Snapshot:
    """Check a scene, and take its obstacles as they are now."""
    return scene if isinstance(scene, Snapshot) else as_scene(scene).snapshot()


def check_sizes(robot: Robot, scene: Scene | Snapshot) -> None:
    """Refuse a scene with a mesh that must be in another length unit than the robot, as `Mesh.check_size` says."""
    for i, obstacle in enumerate(scene.obstacles):
        if isinstance(obstacle, Mesh):
            with checks.inside(f"scene[{i}].mesh"):
                obstacle.check_size(robot.mean_length)


def as_tolerance(tolerance: Any) -> Tolerance:
    """Check tolerances; `None` stands for the defaults."""
    if tolerance is None:
        return Tolerance()
    if not isinstance(tolerance, Tolerance):
        raise InputError("tolerance", "of the wrong kind", tolerance, "a Tolerance")
    return tolerance
