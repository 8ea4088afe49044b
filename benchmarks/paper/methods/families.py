"""Random problems, each of which can be solved."""

from collections.abc import Callable
from typing import NamedTuple

from numpy.random import Generator

from benchmarks.judges.kinematics import tip_poses
from benchmarks.paper.scenes import FREE_BEND, PAPER_TOLERANCE
from benchmarks.problems import ProblemSet, among_spheres, arm, direction_targets, random_configurations
from sinuous.base.checks import Floats
from sinuous.model.robot import Robot
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.scene import Scene

SPHERES = 40


BEND = 2.4


class Family(NamedTuple):
    """Random problems of one kind.

    Attributes
    ----------
    short : str
        For figures; a line break where it is long.
    words : str
        For headings.
    draw : callable
        Takes how many, and random numbers.
    """

    short: str
    words: str
    draw: Callable[[int, Generator], ProblemSet]


def _free(robot: Robot, targets: list[Target], tolerance: Tolerance = PAPER_TOLERANCE) -> ProblemSet:
    return ProblemSet(robot, targets, Scene(), tolerance.for_robot(robot))


def _gentle(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(5, FREE_BEND), direction_targets(arm(5, 1.2), random_configurations(arm(5, 1.2), count, rng)))


def _directions(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(5, BEND), direction_targets(arm(5, BEND), random_configurations(arm(5, BEND), count, rng)))


def _exact(count: int, rng: Generator) -> ProblemSet:
    return _directions(count, rng).with_tolerance(Tolerance().for_robot(arm(5, BEND)))


def _positions(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(5, BEND), _position_targets(_tips(arm(5, BEND), count, rng)))


def _rotations(count: int, rng: Generator) -> ProblemSet:
    tips = _tips(arm(5, BEND), count, rng)
    return _free(arm(5, BEND), [Target(tip[:3, 3], rotation=tip[:3, :3]) for tip in tips])


def _inextensible(count: int, rng: Generator) -> ProblemSet:
    robot = Robot.uniform(5, 57.5, BEND, base=arm(5, BEND).base)
    return _free(robot, direction_targets(robot, random_configurations(robot, count, rng)))


def _spheres_directions(count: int, rng: Generator) -> ProblemSet:
    return among_spheres(arm(5, BEND, radius=4.0), SPHERES, count, rng).with_tolerance(PAPER_TOLERANCE)


def _spheres_positions(count: int, rng: Generator) -> ProblemSet:
    drawn = _spheres_directions(count, rng)
    return ProblemSet(drawn.robot, [Target(t.position) for t in drawn.targets], drawn.scene, drawn.tolerance)


def _long(count: int, rng: Generator) -> ProblemSet:
    return _free(arm(20, 1.2), direction_targets(arm(20, 1.2), random_configurations(arm(20, 1.2), count, rng)))


def _thicket(count: int, rng: Generator) -> ProblemSet:
    return among_spheres(arm(8, 1.5, radius=8.0), 3 * SPHERES, count, rng).with_tolerance(PAPER_TOLERANCE)


def _tips(robot: Robot, count: int, rng: Generator) -> Floats:
    return tip_poses(robot, random_configurations(robot, count, rng))


def _position_targets(tips: Floats) -> list[Target]:
    return [Target(tip[:3, 3]) for tip in tips]


FAMILIES = {
    "gentle": Family(
        "gentle poses,\nno bend limit", "Gentle poses: drawn with bends to 1.2, no limit on bends", _gentle
    ),
    "direction": Family("position and\ndirection", f"Position and direction, bends to {BEND}", _directions),
    "exact": Family("the same,\nexactly", "Position and direction, to 1e-4 of the length and 1e-3 rad", _exact),
    "position": Family("position", "Position alone", _positions),
    "rotation": Family("full pose", "Position and whole rotation", _rotations),
    "inextensible": Family("fixed lengths", "Position and direction, lengths fixed at 57.5 mm", _inextensible),
    "long": Family("20 segments", "Position and direction, 20 segments, bends to 1.2", _long),
    "spheres, direction": Family(
        "spheres,\ndirection", f"Position and direction among {SPHERES} spheres, 4 mm thick", _spheres_directions
    ),
    "spheres, position": Family(
        "spheres,\nposition", f"Position alone among {SPHERES} spheres, 4 mm thick", _spheres_positions
    ),
    "spheres, thicket": Family(
        "thicket",
        f"Position and direction, 8 segments with bends to 1.5, 8 mm thick, among {3 * SPHERES} spheres",
        _thicket,
    ),
}
