"""What a picture or a page shows: things of all kinds, sorted into robots, obstacles, targets and lines.

Robots are drawn where their body is, and as ghosts where it is not, or may be.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.solution import Solution
from sinuous.answer.solutions import Solutions
from sinuous.base import checks
from sinuous.base.checks import Floats
from sinuous.base.errors import InputError
from sinuous.measures.body import BodyPlace
from sinuous.model.robot import Robot
from sinuous.motion.job import Job
from sinuous.motion.motion import Motion
from sinuous.motion.trajectory import Trajectory
from sinuous.problem.problem import Problem
from sinuous.problem.target import Target
from sinuous.scene.moving import standing_at
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.polylines import interpolate
from sinuous.statics.body import body_of
from sinuous.statics.equilibrium import Equilibrium, under_load
from sinuous.statics.rest import bodies_at
from sinuous.view.display.style import arm_tones, rigid_tone

MOST_THICKENED = 16
"""Robots whose thicker bodies are kept."""

FORCE_SHARE = 0.25
"""Length of the line of the largest force, in lengths of the robot."""


class Arm(NamedTuple):
    """A body in one configuration.

    Attributes
    ----------
    robot : Robot
        The body: the robot, or under load one of arcs.
    q : ndarray (m, 3)
    solved : bool
        Whether it meets what was asked.
    ghost : bool
        Whether it is drawn see-through.
    number : int
        Of its robot in the picture, 0 = first: bodies of one robot have the same colours.
    owner : Robot or None
        Its robot, where the body is another one.
    """

    robot: Robot
    q: Floats
    solved: bool = True
    ghost: bool = False
    number: int = 0
    owner: Robot | None = None

    @property
    def segments(self) -> Sequence[int]:
        """Which segment of its robot each segment of the body belongs to, 0 = first."""
        if self.owner is None or len(self.owner) == len(self.robot):
            return range(len(self.robot))
        return body_of(self.owner).owners.tolist()

    @property
    def colours(self) -> list[str]:
        """Colours of the segments of the body; joints and links before them have those of their kind."""
        pair, before = arm_tones(self.solved, self.number), len(self.robot.rows) - len(self.robot.segments)
        rows = zip(self.segments, self.robot.rows, strict=True)
        return [rigid_tone(row) if row.rigid else pair[(k - before) % 2] for k, row in rows]

    def end(self, segment: int | None) -> Floats:
        """Where a segment of its robot ends (3,), 1 = first; the point of the tool for the last one, and for None."""
        own, row = self.segments, (self.owner or self.robot).end_row(segment)
        if row > own[-1]:
            return np.asarray(self.robot.tip(self.q)[:3, 3])
        return np.asarray(self.robot.forward(self.q)[np.searchsorted(own, row) - 1, :3, 3])


class MovingArm(NamedTuple):
    """A body that moves.

    Attributes
    ----------
    begin : Arm
        Where it begins.
    q : ndarray (T, m, 3)
        Configurations of the body, linear between neighbouring ones.
    times : ndarray (T,)
        Increasing.
    drives : ndarray (T, n, 3) or None
        Those of its robot that loads bend into these; of a body that shows the loads.
    """

    begin: Arm
    q: Floats
    times: Floats
    drives: Floats | None = None

    @property
    def ghost(self) -> bool:
        """Whether it is drawn see-through."""
        return self.begin.ghost

    def at(self, share: float) -> Arm:
        """Where it is after this share of its time."""
        return self.begin._replace(q=self._between(self.q, share))

    def forces_at(self, share: float) -> list[Floats]:
        """Lines of what pulls it after this share of its time; see `forces_of`."""
        if self.drives is None or self.begin.owner is None:
            return []
        return forces_of(self.begin.owner, self._between(self.drives, share))

    def _between(self, values: Floats, share: float) -> Floats:
        """Values (T, m, 3) after this share of the time."""
        begin, end = self.times[0], self.times[-1]
        return interpolate(self.times, values, begin + share * (end - begin))


Loaded = tuple[Robot, Floats]
"""A body of arcs, and its configurations (T, m, 3)."""


def bodies_of(robot: Robot, q: Floats, solved: bool, number: int, loaded: Loaded | None = None) -> Iterator[Arm]:
    """Yield the bodies that are drawn of a robot in configurations (T, n, 3): first its body, then ghosts.

    Each has configurations (T, m, 3) of its own. Ghosts are the body without its load, and around one that may be
    elsewhere the room in which it is. `loaded` is the body under other loads than gravity and payload. Tools are drawn
    without the torsion of arcs.
    """
    body = Arm(*(loaded or bodies_at(robot, q)), solved, False, number, robot)
    yield body
    if body.robot is not robot:
        yield body._replace(robot=robot, q=q, ghost=True)
    if robot.uncertainty is not None:
        yield body._replace(robot=_thicker(body.robot), ghost=True)


def arms_of(robot: Robot, q: Floats, solved: bool = True, number: int = 0, loaded: Loaded | None = None) -> list[Arm]:
    """Return the bodies of a robot in a single configuration (n, 3)."""
    return [arm._replace(q=arm.q[0]) for arm in bodies_of(robot, q[None], solved, number, loaded)]


def forces_of(robot: Robot, q: Floats, shape: Equilibrium | None = None) -> list[Floats]:
    """Lines (2, 3) of forces and payloads on a robot in a configuration (n, 3), as long as they are strong."""
    own = under_load(robot, q) if shape is None else shape
    forces = [] if own is None else list(own.forces())
    largest = max((float(np.linalg.norm(force)) for _, force in forces), default=0.0)
    if largest == 0.0:
        return []
    return [np.stack([place - force * (FORCE_SHARE * robot.mean_length / largest), place]) for place, force in forces]


@lru_cache(maxsize=MOST_THICKENED)
def _thicker(robot: Robot) -> Robot:
    """The robot with a body that has the room in which it may be."""
    assert robot.uncertainty is not None
    bounds = np.broadcast_to(robot.uncertainty.bound, len(robot.segments))
    pairs = zip(robot.segments, bounds.tolist(), strict=True)
    return robot.changed(segments=[each.changed(radius=each.radius + bound) for each, bound in pairs], uncertainty=None)


Thing = Robot | Scene | Snapshot | Obstacle | Target | Problem | Job | Solution | Motion | Trajectory | Floats
Things = Thing | Sequence[Thing | Sequence[Thing]]
"""What can be drawn."""

MOST_ARMS = 100
"""Robots in a picture."""

STRAIGHTNESS = 0.03
"""How far a tip may be off a straight line that is drawn as its way, as a share of its length."""

EXPECTED = "a robot, scene, obstacle, target, problem, solution, equilibrium, motion or trajectory, or a list of them"


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


TRAJECTORY_STEPS = 400
"""Even steps of time at which a trajectory is drawn."""


@dataclass
class Contents:
    """What a picture or a page shows.

    Attributes
    ----------
    robots : list of Robot
        They have numbers, 0 = first.
    arms : list of Arm
        Their bodies that stand still.
    moving : list of MovingArm
    obstacles : list of Obstacle
    targets : list of PlacedTarget
    routes, paths : list of ndarray (k, 3)
        Lines: routes that led to a solution, and the positions of waypoints.
    forces : list of ndarray (2, 3)
        Lines that end where forces and payloads act on bodies that stand still, along these.
    marks : list of ndarray (3,)
        Places that say why an answer is not solved.
    answers : list of Solution or Motion
        What the caption is about.
    """

    robots: list[Robot] = field(default_factory=list)
    arms: list[Arm] = field(default_factory=list)
    moving: list[MovingArm] = field(default_factory=list)
    obstacles: list[Obstacle] = field(default_factory=list)
    targets: list[PlacedTarget] = field(default_factory=list)
    routes: list[Floats] = field(default_factory=list)
    paths: list[Floats] = field(default_factory=list)
    forces: list[Floats] = field(default_factory=list)
    marks: list[Floats] = field(default_factory=list)
    answers: list[Solution | Motion] = field(default_factory=list)

    def add_obstacles(self, obstacles: Iterable[Obstacle]) -> None:
        """Take obstacles that are not there yet."""
        known = {id(obstacle) for obstacle in self.obstacles}
        self.obstacles += [obstacle for obstacle in obstacles if id(obstacle) not in known]

    def add_robot(self, robot: Robot, q: Floats, solved: bool = True, shape: Equilibrium | None = None) -> None:
        """Take a robot in a configuration (n, 3), with the forces on it.

        `shape` is its body under other loads than gravity and payload.
        """
        loaded = None if shape is None else (shape.body, shape.arcs[None])
        self.arms += arms_of(robot, q, solved, len(self.robots), loaded)
        self.robots.append(robot)
        self.forces += forces_of(robot, q, shape)

    def add_way(self, robot: Robot, q: Floats, times: Floats, solved: bool) -> None:
        """Take a robot that moves through configurations (T, n, 3)."""
        for body in bodies_of(robot, q, solved, len(self.robots)):
            drives = q if robot.has_external_load and not body.ghost else None
            self.moving.append(MovingArm(body._replace(q=body.q[0]), body.q, times, drives))
        self.robots.append(robot)

    def add_target(self, target: Target, arm: Arm | None = None) -> None:
        """Take a target that is not there yet; one without a position is drawn at that end of an arm."""
        if any(target is other.target for other in self.targets):
            return
        place = target.position
        if place is None:
            own = arm or next(self.bodies, None)
            if own is None:
                raise InputError("things", "has no place", target, "a robot before a target without a position")
            place = own.end(target.segment)
        self.targets.append(PlacedTarget(target, place))

    def add_answer(self, answer: Solution | Motion) -> None:
        """Take what the caption is about, and the place that says why it is not solved."""
        self.answers.append(answer)
        place = place_of(answer)
        self.marks += [] if place is None else [np.array(place.position)]

    def obstacles_at(self, share: float) -> list[Obstacle]:
        """All obstacles after this share of the time of the first motion; without one, where they begin to move."""
        if not self.moving:
            return standing_at(self.obstacles)
        begin, end = self.moving[0].times[0], self.moving[0].times[-1]
        return standing_at(self.obstacles, float(begin + share * (end - begin)))

    def forces_at(self, share: float) -> list[Floats]:
        """Lines of forces and payloads after this share of the time of each motion."""
        return [*self.forces, *(line for moving in self.moving for line in moving.forces_at(share))]

    def arms_at(self, *shares: float) -> list[Arm]:
        """Bodies that stand still, and each that moves after these shares of its time."""
        return [*self.arms, *(moving.at(share) for moving in self.moving for share in shares)]

    @property
    def bodies(self) -> Iterator[Arm]:
        """All bodies, those that move where they end, without ghosts."""
        return (arm for arm in self.arms_at(1.0) if not arm.ghost)


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
                contents.add_robot(thing, middle_of(thing))
        elif _is_array(thing):
            before = flat[i - 1][1] if i else None
            if not isinstance(before, Robot):
                raise InputError(key, "has no robot", thing, "an array of configurations right after its robot")
            for q in before.configuration(key, thing).reshape(-1, len(before), 3):
                contents.add_robot(before, q)
        else:
            _add(contents, thing, key)
    for target in targets:
        contents.add_target(target)
    checks.integer("len(robots)", len(contents.robots), 0, MOST_ARMS)
    if not (contents.robots or contents.obstacles or contents.targets):
        raise InputError("things", "", [thing for _, thing in flat], "something to draw: " + EXPECTED)
    return contents


def middle_of(robot: Robot) -> Floats:
    """Return the straight robot (n, 3), with its joints as near to 0 as they can be."""
    return np.array(robot.straight)


def _is_array(thing: Any) -> bool:
    """Whether it is an array, or lists that begin with a number or an array."""
    while isinstance(thing, list | tuple) and thing:
        thing = thing[0]
    return isinstance(thing, np.ndarray | int | float)


def _flat(things: Any, key: str) -> Iterable[tuple[str, Any]]:
    """All that lists hold, each with the name of its place."""
    for i, thing in enumerate(things):
        if isinstance(thing, list | tuple | Solutions) and not _is_array(thing):
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
        contents.add_robot(thing.robot, thing.q, shape=thing)
    elif isinstance(thing, Motion):
        _add_motion(contents, thing)
    elif isinstance(thing, Trajectory):
        times = np.linspace(0.0, thing.duration, TRAJECTORY_STEPS + 1)
        _add_motion(contents, thing.motion, (thing.at(times), times))
    elif isinstance(thing, Problem):
        _add_question(contents, thing.robot, thing.scene, thing.targets)
    elif isinstance(thing, Job):
        targets = [target for together in thing.waypoints for target in together]
        _add_question(contents, thing.robot, thing.scene.snapshot(), () if thing.is_path else targets)
        if thing.is_path:
            _add_path(contents, targets)
    else:
        raise InputError(key, "", thing, EXPECTED)


def _add_question(contents: Contents, robot: Robot, scene: Snapshot, targets: Iterable[Target]) -> None:
    _add_arm(contents, robot, middle_of(robot), True, targets)
    contents.add_obstacles(scene.obstacles)


def _add_solution(contents: Contents, solution: Solution) -> None:
    problem = solution.problem
    _add_arm(contents, problem.robot, solution.configuration, solution.solved, problem.targets)
    contents.add_answer(solution)
    contents.add_obstacles(problem.scene.obstacles)
    if solution.route is not None:
        contents.routes.append(solution.route)


def place_of(answer: Solution | Motion) -> BodyPlace | None:
    """Return the place that says why an answer is not solved: of what proves it, or else of what is worst."""
    if answer.solved:
        return None
    reason = answer.reason if isinstance(answer, Solution) else None
    if reason is not None and reason.place is not None:
        return reason.place
    return None if answer.worst is None else answer.worst.place


def _add_arm(contents: Contents, robot: Robot, q: Floats, solved: bool, targets: Iterable[Target]) -> None:
    """Take a robot and its targets."""
    count = len(contents.arms)
    contents.add_robot(robot, q, solved)
    for target in targets:
        contents.add_target(target, contents.arms[count])


def _add_motion(contents: Contents, motion: Motion, way: tuple[Floats, Floats] | None = None) -> None:
    """Take a motion; of one with a single knot the last shape that was found, of one with none a straight robot.

    `way`: how it is passed, configurations (T, n, 3) at times (T,), where that is not as it says itself.
    """
    contents.add_answer(motion)
    contents.add_obstacles(motion.scene.obstacles)
    if len(motion.configuration) > 1:
        q, times = (motion.configuration, motion.times) if way is None else way
        contents.add_way(motion.robot, q, times, motion.solved)
    else:
        q = motion.solutions[-1].configuration if motion.solutions else middle_of(motion.robot)
        contents.add_robot(motion.robot, q, motion.solved)
    targets = [target for solution in motion.solutions for target in solution.problem.targets]
    if _goes_straight(motion):
        _add_path(contents, targets)
    else:
        arm = [*contents.bodies][-1]
        for target in targets:
            contents.add_target(target, arm)


def _goes_straight(motion: Motion) -> bool:
    """Whether the tip goes about straight from waypoint to waypoint, wherever there are knots between two."""
    tips = motion.tips[:, :3, 3]
    for number, (begin, end) in enumerate(pairwise(motion.waypoint_knots), 2):
        if begin is None or end is None or number in motion.reconfigured:
            continue
        leg, between = tips[end] - tips[begin], tips[begin:end] - tips[begin]
        aside = np.linalg.norm(np.cross(between, leg), axis=-1)  # times the length of the leg
        if (aside > STRAIGHTNESS * (leg @ leg)).any():
            return False
    return True


def _add_path(contents: Contents, targets: list[Target]) -> None:
    """Take the positions of the waypoints as lines, one for each segment whose end is asked for; one is a target."""
    for segment in dict.fromkeys(target.segment for target in targets):
        placed = [(t, t.position) for t in targets if t.segment == segment and t.position is not None]
        if len(placed) > 1:
            contents.paths.append(np.stack([place for _, place in placed]))
        elif placed:
            contents.add_target(placed[0][0])
