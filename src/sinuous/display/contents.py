"""What a picture or a page shows: things of all kinds, sorted into robots, obstacles, targets and lines."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sinuous import checks
from sinuous.checks import Floats
from sinuous.errors import InputError
from sinuous.files.problem_file import ProblemFile
from sinuous.motion.motion import Motion
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.robot.robot import Robot
from sinuous.scene.moving import standing_at
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solution.solution import Solution
from sinuous.solution.solutions import Solutions
from sinuous.statics.equilibrium import Equilibrium
from sinuous.statics.rest import bodies_at

Thing = Robot | Scene | Snapshot | Obstacle | Target | Problem | ProblemFile | Solution | Motion | Floats
Things = Thing | Sequence[Thing | Sequence[Thing]]
"""What can be drawn."""

MOST_ARMS = 100
"""Robots in a picture."""

FORCE_LENGTH = 0.25
"""Length of the line of the largest force, in lengths of the robot."""

STRAIGHT = 0.03
"""How far a tip may be off a straight line that is drawn as its way, as a share of its length."""

EXPECTED = "a robot, scene, obstacle, target, problem, solution, equilibrium or motion, or a list of them"


class Arm(NamedTuple):
    """A robot in one configuration.

    Attributes
    ----------
    robot : Robot
    q : ndarray (n, 3)
    solved : bool
        Whether it meets what was asked.
    """

    robot: Robot
    q: Floats
    solved: bool = True


class MovingArm(NamedTuple):
    """A robot that moves.

    Attributes
    ----------
    robot : Robot
    q : ndarray (T, n, 3)
        Configurations, linear between neighbouring ones.
    times : ndarray (T,)
        Increasing.
    solved : bool
        Whether it meets what was asked.
    """

    robot: Robot
    q: Floats
    times: Floats
    solved: bool

    def at(self, share: float) -> Arm:
        """Where it is after this share of its time."""
        begin, end = self.times[0], self.times[-1]
        now = begin + share * (end - begin)
        i = int(np.clip(np.searchsorted(self.times, now, side="right") - 1, 0, len(self.times) - 2))
        part = (now - self.times[i]) / (self.times[i + 1] - self.times[i])
        return Arm(self.robot, (1.0 - part) * self.q[i] + part * self.q[i + 1], self.solved)


class PlacedTarget(NamedTuple):
    """A target and where it is drawn.

    Attributes
    ----------
    target : Target
    place : ndarray (3,)
        Its position; that of the robot's end where the target has none.
    """

    target: Target
    place: Floats


@dataclass
class Contents:
    """What a picture or a page shows.

    Attributes
    ----------
    arms : list of Arm
        Robots that stand still.
    moving : list of MovingArm
    obstacles : list of Obstacle
    targets : list of PlacedTarget
    routes, paths : list of ndarray (k, 3)
        Lines: routes that led to a solution, and the positions of waypoints.
    answers : list of Solution or Motion
        What the caption is about.
    """

    arms: list[Arm] = field(default_factory=list)
    moving: list[MovingArm] = field(default_factory=list)
    obstacles: list[Obstacle] = field(default_factory=list)
    targets: list[PlacedTarget] = field(default_factory=list)
    routes: list[Floats] = field(default_factory=list)
    paths: list[Floats] = field(default_factory=list)
    answers: list[Solution | Motion] = field(default_factory=list)

    def add_obstacles(self, obstacles: Iterable[Obstacle]) -> None:
        """Take obstacles that are not there yet."""
        known = {id(obstacle) for obstacle in self.obstacles}
        self.obstacles += [obstacle for obstacle in obstacles if id(obstacle) not in known]

    def add_target(self, target: Target, arm: Arm | None) -> None:
        """Take a target that is not there yet; one without a position is drawn at that end of the arm."""
        if any(target is other.target for other in self.targets):
            return
        place = target.position
        if place is None:
            if arm is None:
                raise InputError("things", "has no place", target, "a robot before a target without a position")
            last = target.segment is None or target.segment > len(arm.robot)
            place = (arm.robot.tip(arm.q) if last else arm.robot.forward(arm.q)[(target.segment or 1) - 1])[:3, 3]
        self.targets.append(PlacedTarget(target, place))

    def obstacles_at(self, share: float) -> list[Obstacle]:
        """All obstacles after this share of the time of the first motion; without one, where they begin to move."""
        if not self.moving:
            return standing_at(self.obstacles)
        begin, end = self.moving[0].times[0], self.moving[0].times[-1]
        return standing_at(self.obstacles, float(begin + share * (end - begin)))

    @property
    def all_arms(self) -> list[Arm]:
        """Robots that stand still, and those that move where they end."""
        return [*self.arms, *(moving.at(1.0) for moving in self.moving)]


def straight(robot: Robot) -> Floats:
    """Configuration (n, 3) of a straight robot, each segment at its mean length."""
    q = np.zeros((len(robot), 3))
    q[:, 2] = [0.5 * sum(segment.length) for segment in robot.segments]
    return q


def gather(things: Iterable[Any]) -> Contents:
    """Sort what was given.

    Raises
    ------
    InputError
        That names the thing that cannot be drawn, or when there is nothing.
    """
    contents = Contents()
    flat = list(_flat(things, "things"))
    targets: list[Target] = []
    for i, (key, thing) in enumerate(flat):
        if isinstance(thing, Target):
            targets.append(thing)
        elif isinstance(thing, Robot):
            if not (i + 1 < len(flat) and _is_array(flat[i + 1][1])):
                contents.arms.append(Arm(thing, straight(thing)))
        elif _is_array(thing):
            before = flat[i - 1][1] if i else None
            if not isinstance(before, Robot):
                raise InputError(key, "has no robot", thing, "an array of configurations right after its robot")
            q = before.configuration(key, thing).reshape(-1, len(before), 3)
            contents.arms += [Arm(before, each) for each in q]
        else:
            _add(contents, thing, key)
    for target in targets:
        contents.add_target(target, next(iter(contents.all_arms), None))
    checks.integer("len(robots)", len(contents.arms), 0, MOST_ARMS)
    if not (contents.arms or contents.moving or contents.obstacles or contents.targets):
        raise InputError("things", "", [thing for _, thing in flat], "something to draw: " + EXPECTED)
    return contents


def _is_array(thing: Any) -> bool:
    return isinstance(thing, np.ndarray)


def _flat(things: Any, key: str) -> Iterable[tuple[str, Any]]:
    """All that lists hold, each with the name of its place."""
    for i, thing in enumerate(things):
        if isinstance(thing, list | tuple | Solutions):
            checks.integer(f"len({key}[{i}])", len(thing), 0, 100_000)
            yield from _flat(thing, f"{key}[{i}]")
        else:
            yield f"{key}[{i}]", thing


def _add(contents: Contents, thing: Any, key: str) -> None:
    if isinstance(thing, Obstacle):
        contents.add_obstacles((thing,))
    elif isinstance(thing, Scene | Snapshot):
        contents.add_obstacles(thing.obstacles)
    elif isinstance(thing, Solution):
        _add_solution(contents, thing)
    elif isinstance(thing, Equilibrium):
        _add_shape(contents, thing)
    elif isinstance(thing, Motion):
        _add_motion(contents, thing)
    elif isinstance(thing, Problem):
        _add_question(contents, thing.robot, thing.scene, thing.targets)
    elif isinstance(thing, ProblemFile):
        targets = [target for together in thing.waypoints for target in together]
        _add_question(contents, thing.robot, thing.scene.snapshot(), () if thing.is_path else targets)
        if thing.is_path:
            _add_path(contents, targets)
    else:
        raise InputError(key, "", thing, EXPECTED)


def _add_question(contents: Contents, robot: Robot, scene: Snapshot, targets: Iterable[Target]) -> None:
    arm = Arm(robot, straight(robot))
    contents.arms.append(arm)
    contents.add_obstacles(scene.obstacles)
    for target in targets:
        contents.add_target(target, arm)


def _add_solution(contents: Contents, solution: Solution) -> None:
    arm = Arm(solution.problem.robot, solution.q, solution.solved)
    if arm.robot.hangs:
        _add_shape(contents, arm.robot.shape(arm.q), solution.solved)
    else:
        contents.arms.append(arm)
    contents.answers.append(solution)
    contents.add_obstacles(solution.problem.scene.obstacles)
    if solution.route is not None:
        contents.routes.append(solution.route)
    for target in solution.problem.targets:
        contents.add_target(target, arm)


def _add_shape(contents: Contents, shape: Equilibrium, solved: bool = True) -> None:
    """Take the body under load, the one without, and the forces as lines that end where they act."""
    contents.arms += [Arm(shape.body, shape.arcs, solved), Arm(shape.robot, shape.q, solved)]
    forces = list(shape.forces())
    largest = max((float(np.linalg.norm(force)) for _, force in forces), default=0.0)
    for place, force in forces:
        if largest > 0.0:
            contents.paths.append(np.stack([place - force * (FORCE_LENGTH * shape.robot.mean_length / largest), place]))


def _add_motion(contents: Contents, motion: Motion) -> None:
    """Take a motion; of one with a single knot the last shape that was found, of one with none a straight robot."""
    contents.answers.append(motion)
    contents.add_obstacles(motion.scene.obstacles)
    if len(motion.q) > 1:
        contents.moving.append(MovingArm(*bodies_at(motion.robot, motion.q), motion.times, motion.solved))
    elif motion.solutions:
        contents.arms.append(Arm(motion.robot, motion.solutions[-1].q, motion.solved))
    else:
        contents.arms.append(Arm(motion.robot, straight(motion.robot), motion.solved))
    targets = [target for solution in motion.solutions for target in solution.problem.targets]
    if _goes_straight(motion):
        _add_path(contents, targets)
    else:
        for target in targets:
            contents.add_target(target, contents.all_arms[-1])


def _goes_straight(motion: Motion) -> bool:
    """Whether the tip goes about straight from waypoint to waypoint, wherever there are knots between two."""
    tips = motion.tips[:, :3, 3]
    for number, (begin, end) in enumerate(pairwise(motion.waypoint_knots), 2):
        if begin is None or end is None or number in motion.reconfigured:
            continue
        leg, between = tips[end] - tips[begin], tips[begin:end] - tips[begin]
        aside = np.linalg.norm(np.cross(between, leg), axis=-1)  # times the length of the leg
        if (aside > STRAIGHT * (leg @ leg)).any():
            return False
    return True


def _add_path(contents: Contents, targets: list[Target]) -> None:
    """Take the positions of the waypoints as lines, one for each segment whose end is asked for; one is a target."""
    for segment in dict.fromkeys(target.segment for target in targets):
        places = [t.position for t in targets if t.segment == segment and t.position is not None]
        if len(places) > 1:
            contents.paths.append(np.stack(places))
        elif places:
            single = next(t for t in targets if t.segment == segment and t.position is not None)
            contents.add_target(single, next(iter(contents.all_arms)))
