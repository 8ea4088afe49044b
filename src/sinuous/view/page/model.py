"""The state of the page of `sinuous view`: how it changes, and is saved and read; no browser, and no threads."""

import time as clock
import warnings
from collections.abc import Hashable
from dataclasses import dataclass, replace
from pathlib import Path, PurePath
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

from sinuous.answer.explanation import Explanation
from sinuous.answer.remedies import Remedy
from sinuous.answer.solution import Solution
from sinuous.base import checks
from sinuous.base.arguments import MethodName
from sinuous.base.checks import Floats
from sinuous.base.documents import yaml_text
from sinuous.base.errors import InputError, SuspiciousInput
from sinuous.files.documents import join, parse
from sinuous.methods.method import name_of
from sinuous.model.poses import least_rotation
from sinuous.model.rates import Rates
from sinuous.model.robot import Robot
from sinuous.model.segment import Segment
from sinuous.motion.job import Job, job_of
from sinuous.motion.motion import Motion
from sinuous.motion.pace import pace_motion
from sinuous.motion.tables import write_motion
from sinuous.problem.target import Target, Tolerance
from sinuous.scene.obstacles import Obstacle
from sinuous.scene.scene import Scene
from sinuous.scene.snapshot import Snapshot
from sinuous.solver.options import TIME
from sinuous.statics.equilibrium import under_load
from sinuous.view.display.contents import middle_of
from sinuous.view.page import edits

ASKED = ("position", "direction", "rotation")
"""What a target may ask beside its position: nothing, a direction of the tangent, a whole rotation."""

MOST_SECONDS = 60.0
"""Longest budget that can be set on the page."""


TOGETHER_SECONDS = 1.0
"""Seconds within which changes of the same thing are one step: somebody drags it."""

MOST_STEPS = 1000
"""Steps that are kept."""

LONGEST_SECONDS, PLAYED_SECONDS = 30.0, 20.0
"""A motion that takes longer than the first is played in so many seconds as the second."""


def playing_speed(duration: float) -> float:
    """Return how much of a motion's time passes in a second of playing.

    Times are taken for seconds, unless the whole takes longer than people wait.
    """
    return 1.0 if duration <= LONGEST_SECONDS else duration / PLAYED_SECONDS


@dataclass(frozen=True)
class Settings:
    """How the page solves.

    Attributes
    ----------
    method : str
    beside : str or None
        A second method, whose answer stands beside that of the first.
    seed : int
    time : float
        Budget in seconds, when nothing is dragged.
    """

    method: MethodName = "newton"
    beside: MethodName | None = None
    seed: int = 0
    time: float = TIME


@dataclass(frozen=True)
class PageQuestion:
    """What is asked of a method at one moment.

    Attributes
    ----------
    job : Job
    scene : Snapshot
        Its obstacles as they are at that moment, standing still.
    targets : tuple of Target
        To be met at once.
    settings : Settings
    initial : ndarray (n, 3)
    number : int
        Of the state of the page that it is asked in; an answer to an older one is out of date.
    """

    job: Job
    scene: Snapshot
    targets: tuple[Target, ...]
    settings: Settings
    initial: Floats
    number: int


class Moment(NamedTuple):
    """What people decided on the page so far, and what was found for it: to come back to.

    Attributes
    ----------
    job : Job
    settings : Settings
    waypoint : int
    begin : float
    by_hand : bool
        Whether the shape was bent by hand.
    q : ndarray (n, 3)
        The shape.
    motion : Motion or None
    time : float
    """

    job: Job
    settings: Settings
    waypoint: int
    begin: float
    by_hand: bool
    q: Floats
    motion: Motion | None
    time: float

    def decided_like(self, other: "Moment") -> bool:
        """Whether people decided the same; what was found for it may differ."""
        same = self.job is other.job and self.motion is other.motion and self[1:5] == other[1:5]
        return same and (self.q is other.q or not self.by_hand)


class History:
    """The moments of a page before every step, and those that were taken back."""

    def __init__(self) -> None:
        self._past: list[Moment] = []
        self._taken_back: list[Moment] = []
        self._last: tuple[Hashable, float] = None, 0.0

    def note(self, key: Hashable, before: Moment) -> None:
        """Keep the moment before a change of what `key` stands for."""
        now = clock.monotonic()
        if key != self._last[0] or now - self._last[1] > TOGETHER_SECONDS:
            self._past = [*self._past[1 - MOST_STEPS :], before]
        self._last = key, now
        self._taken_back = []

    def undo(self, now: Moment) -> Moment:
        """Return the moment before the last step; that of now where there is none."""
        return self._step(self._past, self._taken_back, now)

    def redo(self, now: Moment) -> Moment:
        """Return the moment that was taken back last; that of now where there is none."""
        return self._step(self._taken_back, self._past, now)

    def _step(self, begin: list[Moment], end: list[Moment], now: Moment) -> Moment:
        if not begin:
            return now
        end.append(now)
        self._last = None, 0.0
        return begin.pop()


class PageModel:
    """The state of the page.

    Parameters
    ----------
    job : Job
    settings : Settings

    Attributes
    ----------
    job : Job
        The problem, exactly as on the page; replaced by every change of it.
    q : ndarray (n, 3)
        The shape on the page.
    answer, beside : Solution or None
        Of both methods to the question as it is now; None when there is none yet, or the shape was bent by hand.
    number : int
        Of this state: it grows with every change of the question.
    waypoint : int
        Which waypoint of a path is asked for, 0 = first.
    grasped : int or None
        The obstacle that is chosen.
    grip : ndarray (4, 4) or None
        Pose of the chosen obstacle; None when there is none, or it cannot be moved.
    ghosts : list of Solution
        Distinct solutions to choose from.
    explanation : Explanation or None
        Why the answer is no solution, and what would help, once that was looked for.
    motion : Motion or None
        Along the path, or to the goal, once it was found.
    time : float
        Which moment is on the page, of the motion or of obstacles that move.
    begin : float
        When motions begin.
    """

    def __init__(self, job: Job, settings: Settings | None = None) -> None:
        self.settings = settings or Settings()
        self.number = 0
        self.load(job)

    def load(self, job: Job) -> None:
        """Begin anew with another problem."""
        self.job = job
        self.q: Floats = middle_of(job.robot) if job.start is None else job.start
        self._q_beside = middle_of(job.robot)
        self.answer: Solution | None = None
        self.beside: Solution | None = None
        self.waypoint = 0
        self.by_hand = False
        self.grasped: int | None = None
        self.ghosts: list[Solution] = []
        self.explanation: Explanation | None = None
        self.grip: Floats | None = None
        self.motion: Motion | None = None
        self.time = self.begin = 0.0
        self._there: tuple[Snapshot, float, Snapshot] | None = None
        self._held: tuple[Obstacle, Floats] | None = None
        self._pulled: Floats | None = None
        self.number += 1

    @property
    def moment(self) -> Moment:
        """What was decided and found so far."""
        own = self.job, self.settings, self.waypoint, self.begin, self.by_hand
        return Moment(*own, self.q, self.motion, self.time)

    def come_back(self, moment: Moment) -> None:
        """Ask again what was asked at another moment."""
        self.job, self.settings, self.waypoint, self.begin, by_hand, self.q, motion, self.time = moment
        self._asked_anew()
        self.by_hand, self.motion = by_hand, motion
        self.grasp(self.grasped if self.grasped is not None and self.grasped < len(self.scene) else None)

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.job.robot

    @property
    def scene(self) -> Snapshot:
        """The obstacles, as they are described."""
        return self.job.scene.snapshot()

    @property
    def there(self) -> Snapshot:
        """The obstacles as they are at the time on the page, standing still."""
        scene = self.scene
        if not scene.moves:
            return scene
        if self._there is None or self._there[0] is not scene or self._there[1] != self.time:
            self._there = scene, self.time, scene.at(self.time)
        return self._there[2]

    @property
    def window(self) -> tuple[float, float]:
        """The first and the last time of a motion, or else of all obstacles that move and of the waypoints.

        They are the same where nothing moves. Motions begin at 0, unless somebody says otherwise: that is among them.
        """
        if self.motion is not None:
            return float(self.motion.times[0]), float(self.motion.times[-1])
        courses = self.scene.courses.values()
        if not courses:
            return 0.0, 0.0
        ends = [0.0, *(float(time) for course in courses for time in (course.times[0], course.times[-1]))]
        if self.job.is_path:
            ends += [self._time_of(0), self._time_of(len(self.job.waypoints) - 1)]
        return min(ends), max(ends)

    def _time_of(self, waypoint: int) -> float:
        """When a path is at a waypoint, 0 = first: at 0, 1, 2, ... with the start, unless they have times."""
        job = self.job
        return float(waypoint + (job.start is not None)) if job.times is None else float(job.times[waypoint])

    @property
    def targets(self) -> tuple[Target, ...]:
        """What is asked now; nothing where a configuration is the goal."""
        return self.job.waypoints[self.waypoint] if self.job.waypoints else ()

    @property
    def shown(self) -> Floats:
        """The configuration (n, 3) on the page: that of the motion at its time, where there is one."""
        return self.q if self.motion is None else self.motion.at(self.time)

    def question(self) -> PageQuestion:
        """What is asked of the method, from the shape on the page."""
        return PageQuestion(self.job, self.there, self.targets, self.settings, self.q, self.number)

    def question_beside(self) -> PageQuestion | None:
        """What is asked of the second method, from its own last shape; None without one."""
        if self.settings.beside is None:
            return None
        settings = replace(self.settings, method=self.settings.beside)
        return replace(self.question(), settings=settings, initial=self._q_beside)

    def accept(self, number: int, solution: Solution) -> bool:
        """Show the answer to a question; return whether it was still asked."""
        if number != self.number or self.by_hand:
            return False
        self.answer, self.q = solution, solution.configuration
        return True

    def accept_beside(self, number: int, solution: Solution | None) -> bool:
        """Show the answer of the second method; return whether it was still asked."""
        if number != self.number:
            return False
        self.beside = solution
        if solution is not None:
            self._q_beside = solution.configuration
        return True

    def _change(self, **parts: Any) -> None:
        """Ask another question: parts of the job that differ."""
        self.job = edits.change_job(self.job, **parts)
        self._asked_anew()

    def _asked_anew(self) -> None:
        self.answer = self.beside = self._pulled = None
        self.by_hand = False
        self.ghosts, self.motion, self.explanation = [], None, None
        self.number += 1

    # What is asked

    def place_target(self, index: int, position: Floats | None, rotation: Floats | None = None) -> None:
        """Move a target: to a position (3,), and to the direction or rotation of a frame (3, 3) if it asks for one."""
        target = self._target(index)
        parts: dict[str, Any] = {}
        if target.position is not None and position is not None:
            parts["position"] = position
        if rotation is not None and target.direction is not None:
            parts["direction"] = rotation[:, 2]
        if rotation is not None and target.rotation is not None:
            parts["rotation"] = rotation
        self._replace_target(index, target.changed(**parts))

    def point_target(self, index: int, direction: Floats) -> None:
        """Set the direction (3,) that a target asks for; any length but 0."""
        self._replace_target(index, self._target(index).changed(direction=direction))

    def ask(self, index: int, what: str) -> None:
        """Ask a target for its position alone, for a direction of the tangent too, or for a whole rotation."""
        checks.choice("asked", what, ASKED)
        target, frame = self._target(index), self.target_frame(index)
        asked: dict[str, Any] = {"direction": None, "rotation": None, "position": frame[:3, 3]}
        if what != "position":
            asked[what] = frame[:3, 2] if what == "direction" else frame[:3, :3]
        self._replace_target(index, target.changed(**asked))

    def target_frame(self, index: int) -> Floats:
        """Pose (4, 4) that stands for a target; what it does not ask for is that of the shape on the page."""
        target, robot = self._target(index), self.robot
        place, shape = None if target.segment == len(robot.segments) else target.segment, under_load(robot, self.q)
        if place is None:
            frame = np.array(robot.tip(self.q) if shape is None else shape.tip)
        else:
            frame = np.array((robot.forward(self.q) if shape is None else shape.poses)[robot.end_row(place) - 1])
        if target.position is not None:
            frame[:3, 3] = target.position
        if target.direction is not None:
            frame[:3, :3] = least_rotation(target.direction)
        if target.rotation is not None:
            frame[:3, :3] = target.rotation
        return frame

    def go_to_waypoint(self, index: int) -> None:
        """Ask for another waypoint of the path, 0 = first; where obstacles move, at its time."""
        self.waypoint = checks.integer("waypoint", index, 0, len(self.job.waypoints) - 1)
        if self.scene.moves:
            self.time = self._time_of(self.waypoint)
        self._asked_anew()

    def tolerate(self, position: float, angle: float) -> None:
        """Set both tolerances (length, rad)."""
        self._change(tolerance=Tolerance(position, angle))

    def set_method(self, method: str, beside: str | None, seed: int, time: float) -> None:
        """Choose how to solve."""
        seconds = checks.number("time", time, above=0.0, high=MOST_SECONDS)
        second = None if beside is None else name_of(beside)
        number = checks.integer("seed", seed, 0, 2**31 - 1)
        self.settings = Settings(name_of(method), second, number, seconds)
        self._asked_anew()

    def apply(self, remedy: Remedy) -> None:
        """Make a change that helps."""
        parts: dict[str, Any] = {}
        if remedy.change in ("method", "time"):
            self.settings = replace(self.settings, **{remedy.change: remedy.after})
        elif remedy.problem is None or self.answer is None:
            raise InputError("remedy", "is for calls from Python", remedy.change, "a change of what is on the page")
        else:
            before, after, scene = self.answer.problem, remedy.problem, self.scene
            gone = _names(before.scene) - _names(after.scene)
            given = {"robot": after.robot, "tolerance": after.tolerance, "targets": after.targets}
            parts = {key: value for key, value in given.items() if value is not getattr(before, key)}
            parts |= {"scene": Scene.of(scene.without(gone))} if gone else {}
        start = remedy.after if remedy.change == "start" else remedy.start
        if start is not None:
            self.q = np.array(start)
        if "targets" in parts:
            parts |= self._with_targets(parts.pop("targets"))
        self._change(**parts)

    def _target(self, index: int) -> Target:
        return self.targets[checks.integer("target", index, 0, len(self.targets) - 1)]

    def _replace_target(self, index: int, target: Target) -> None:
        self._change(**self._with_targets((*self.targets[:index], target, *self.targets[index + 1 :])))

    def _with_targets(self, targets: tuple[Target, ...]) -> dict[str, Any]:
        """Arguments of `Job` for other targets now."""
        path = self.job.waypoints
        if not self.job.is_path:
            return {"target": targets}
        return {"path": (*path[: self.waypoint], targets, *path[self.waypoint + 1 :])}

    # The robot

    def bend(self, segment: int, bend_x: float, bend_y: float, length: float) -> None:
        """Bend a segment (0 = first) by hand; the shape stays so until something else is asked."""
        k = checks.integer("segment", segment, 0, len(self.robot) - 1)
        q = np.array(self.shown)
        q[k] = [checks.number(*each) for each in (("bend_x", bend_x), ("bend_y", bend_y), ("length", length))]
        self._bent(q)

    @property
    def actuators(self) -> Floats:
        """Values (m,) of all actuators on the page; where they stretch, those that somebody gave them."""
        return self.robot.to_actuators(self.shown) if self._pulled is None else self._pulled

    def drive(self, index: int, value: float) -> None:
        """Give an actuator (0 = first) a value by hand; all others change as little as they can.

        Rigid ones follow: of three tendons around a segment two are paid out where one is pulled.
        """
        before, wanted, q = self.actuators, np.array(self.actuators), self.shown
        i = checks.integer("actuator", index, 0, len(before) - 1)
        wanted[i] = checks.number(self.robot.actuators[i].name, value)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SuspiciousInput)  # rigid ones contradict each other until all follow
            found = self.robot.from_actuators(wanted, q)
        if self.robot.drive.elastic is not None:
            self._bent(found)
            self._pulled = wanted
            return
        # Least squares of all values go a part of the way; as they are linear, that part is the same for each value.
        part = float(self.robot.to_actuators(found)[i] - before[i])
        self._bent(q + (found - q) * ((wanted[i] - before[i]) / part) if part else found)

    def _bent(self, q: Floats) -> None:
        """Show a shape (n, 3) that somebody made."""
        self.q = q
        self.answer = self.beside = self._pulled = None
        self.by_hand, self.motion = True, None
        self.number += 1

    def solve_from_here(self) -> None:
        """Ask again, from the shape on the page."""
        self._asked_anew()

    def limit(self, segment: int | None, **values: Any) -> None:
        """Change limits or the radius of a segment (0 = first; None: of all): arguments of `Segment`."""
        segments: list[Segment] = list(self.robot.segments)
        last = len(segments) - 1
        chosen = range(last + 1) if segment is None else [checks.integer("segment", segment, 0, last)]
        for k in chosen:
            with checks.inside(f"segments[{k}]"):
                segments[k] = segments[k].changed(**values)
        self._change(robot=self.robot.changed(segments=segments))

    def add_segment(self, segment: int | None) -> None:
        """Add a segment like this one (0 = first; None: the last) right after it."""
        count = len(self.robot.segments)
        k = count - 1 if segment is None else checks.integer("segment", segment, 0, count - 1)
        self._rebuild([*range(k + 1), *range(k, count)], new=k + 1)

    def remove_segment(self, segment: int | None) -> None:
        """Take a segment away (0 = first; None: the last)."""
        count = len(self.robot.segments)
        k = count - 1 if segment is None else checks.integer("segment", segment, 0, count - 1)
        if any(target.segment == k + 1 for targets in self.job.waypoints for target in targets):
            name = self.robot.segment_names[k]
            raise InputError("segment", "a target asks for its end", name, "another segment")
        self._rebuild([i for i in range(count) if i != k])

    def _rebuild(self, chosen: list[int], new: int | None = None) -> None:
        """Make the robot of these segments of before (0 = first); one that is `new` has no name of its own."""
        segments = [self.robot.segments[i] for i in chosen]
        if new is not None:
            segments[new] = segments[new].changed(name=None)
        before = len(self.robot.rows) - len(self.robot.segments)
        rows = [*range(before), *(before + i for i in chosen)]
        place = {old: i for i, old in reversed([*enumerate(chosen)])}

        def moved(target: Target) -> Target:
            return target if target.segment is None else target.changed(segment=place[target.segment - 1] + 1)

        parts: dict[str, Any] = {"robot": self.robot.changed(segments=segments)}
        if self.job.waypoints:
            path = [[moved(target) for target in targets] for targets in self.job.waypoints]
            parts |= {"path": path} if self.job.is_path else {"target": path[0]}
        parts |= {key: q[rows] for key in ("start", "goal") if (q := getattr(self.job, key)) is not None}
        self.job = edits.change_job(self.job, **parts)
        self.q, self._q_beside = self.q[rows], self._q_beside[rows]
        self._asked_anew()

    def set_rates(self, most: Floats, acceleration: Floats) -> None:
        """Set the largest speeds and accelerations of bends, lengths and actuators (3,); 0: no limit.

        Where there is one for each, it is the least of them, and all change by one factor.
        A motion among obstacles that stand still goes the same way as fast as they allow.
        """
        own = self.job.rates
        further = own.acceleration or Rates()
        gains = Rates(*edits.with_least(further, acceleration), joint=further.joint)
        rates = Rates(*edits.with_least(own, most), gains or None, own.joint)
        rates.check(self.robot)
        self.job = edits.change_job(self.job, rates=rates)
        if self.motion is not None and not self.motion.scene.moves:
            self.show_motion(pace_motion(self.motion, rates))

    def offer(self, solutions: list[Solution]) -> None:
        """Show distinct solutions to choose from, the first of them chosen."""
        self.ghosts = solutions
        self.choose(0)

    def choose(self, index: int) -> None:
        """Show one of the distinct solutions."""
        solution = self.ghosts[checks.integer("solution", index, 0, len(self.ghosts) - 1)]
        self.answer, self.q, self.by_hand = solution, solution.configuration, False

    def forget_ghosts(self) -> None:
        """Take the distinct solutions from the page."""
        self.ghosts = []

    def begin_here(self) -> None:
        """Let motions begin in the shape on the page; where obstacles move, at the time on the page."""
        self.begin = self.time if self.scene.moves else 0.0
        self._change(start=self.shown)

    def show_motion(self, motion: Motion) -> None:
        """Show a motion, from its beginning.

        Raises
        ------
        InputError
            When it goes nowhere.
        """
        if len(motion.configuration) < 2:
            raise InputError("motion", "goes nowhere", str(motion.status), "one with at least two knots")
        self.motion, self.time = motion, float(motion.times[0])

    def play(self, time: float) -> None:
        """Show the motion at one of its times; without one, obstacles that move: what is asked is asked then."""
        first, last = self.window
        if first == last:
            raise InputError("time", "nothing moves", time, "a motion that was found, or obstacles that move")
        self.time = checks.number("time", time, low=first, high=last)
        if self.motion is None and not self.by_hand:
            self._asked_anew()

    @property
    def step(self) -> int:
        """Number of the step of the motion that is on the page, 1 = first; 0 without a motion."""
        if self.motion is None:
            return 0
        step = int(np.searchsorted(self.motion.times, self.time, side="right"))
        return min(step, len(self.motion.steps.proved))

    @property
    def step_is_proved(self) -> bool:
        """Whether the step of the motion that is on the page is proved clear."""
        return self.motion is not None and bool(self.motion.steps.proved[self.step - 1])

    # The obstacles

    def grasp(self, index: int | None) -> None:
        """Choose an obstacle, or none."""
        self.grasped = None if index is None else checks.integer("obstacle", index, 0, len(self.scene) - 1)
        obstacle = self.chosen
        self.grip = None if obstacle is None else edits.pose_of(obstacle)
        self._held = None if obstacle is None or self.grip is None else (obstacle, self.grip)

    @property
    def chosen(self) -> Obstacle | None:
        """The obstacle that is chosen."""
        return None if self.grasped is None else self.scene.obstacles[self.grasped]

    def carry(self, place: Floats) -> None:
        """Move the chosen obstacle so that its pose, as it was grasped, becomes `place` (4, 4)."""
        self.put(place, self.carried(place))

    def carried(self, place: Floats) -> Obstacle:
        """Return the chosen obstacle as it is when its pose becomes `place`; see `edits.move_obstacle`."""
        if self._held is None:
            raise InputError("obstacle", "cannot be moved", self.chosen, "an obstacle that can")
        obstacle, before = self._held
        return edits.move_obstacle(obstacle, place @ np.linalg.inv(before))

    def put(self, place: Floats, obstacle: Obstacle) -> None:
        """Put an obstacle into the place of the chosen one, whose pose is `place` now."""
        self._replace_obstacle(obstacle)
        self.grip = place

    def resize(self, **sizes: float) -> None:
        """Change lengths of the chosen obstacle; see `edits.resize_obstacle`."""
        if self.chosen is None:
            raise InputError("obstacle", "", None, "one that is chosen")
        self._replace_obstacle(edits.resize_obstacle(self.chosen, **sizes))
        self.grasp(self.grasped)

    def add(self, kind: str) -> None:
        """Add an obstacle beside the robot, and choose it."""
        size = self.robot.mean_length / 6.0
        side = self.robot.base[:3, 3] + self.robot.base[:3, 2] * 0.5 * self.robot.mean_length
        center = side + self.robot.base[:3, 0] * 2.0 * size
        named = [each.named(self.scene.name(i)) for i, each in enumerate(self.scene.obstacles)]
        self._change(scene=Scene([*named, edits.make_obstacle(kind, center, size).named(self._free_name(kind))]))
        self.grasp(len(self.scene) - 1)

    def delete(self) -> None:
        """Take the chosen obstacle away; the others keep their names."""
        if self.grasped is None:
            raise InputError("obstacle", "", None, "one that is chosen")
        gone = self.grasped
        self.grasp(None)
        kept = [each.named(self.scene.name(i)) for i, each in enumerate(self.scene.obstacles) if i != gone]
        self._change(scene=Scene(kept))

    def _free_name(self, kind: str) -> str:
        names = _names(self.scene)
        return next(name for i in range(len(names) + 1) if (name := f"{kind}[{len(names) + i}]") not in names)

    def _replace_obstacle(self, obstacle: Obstacle) -> None:
        assert self.grasped is not None
        self._change(scene=Scene.of(self.scene.replaced(self.grasped, obstacle)))

    @property
    def folder(self) -> Path:
        """Where names of files in the problem begin."""
        return Path(self.job.file).parent


def _names(scene: Snapshot) -> set[str]:
    return {scene.name(i) for i in range(len(scene))}


LARGEST_BYTES = 50_000_000
"""Bytes of a problem file that are read."""

FILE_KEYS = ("robot", "scene", "path", "start", "file")
"""Keys under which the name of another file may stand."""


def problem_text(model: PageModel) -> str:
    """Return a problem file in YAML that says what is on the page; where nothing moves, it starts with its shape.

    Its first line is the command that asks the same.

    Raises
    ------
    InputError
        When an obstacle is a function, which no file can hold.
    """
    job, own = model.job, model.settings
    moves = job.is_path or job.goal is not None or model.motion is not None or model.scene.moves
    kept = job if moves else edits.change_job(job, start=model.q)
    command = "track" if job.is_path else "plan" if moves else "solve"
    begin = f" --begin {model.begin:g}" if command == "plan" and model.begin else ""
    line = f"# sinuous {command} FILE --method {own.method} --seed {own.seed} --time {own.time:g}{begin}\n"
    return line + yaml_text(kept.to_dict(model.folder))


def motion_table(model: PageModel) -> str:
    """Return the motion on the page as CSV, or the shape as a single row; columns as of `Motion.to_csv`."""
    q, times = (
        (model.shown[None], np.array([model.time]))
        if model.motion is None
        else (model.motion.configuration, model.motion.times)
    )
    with TemporaryDirectory() as folder:
        file = Path(folder) / "motion.csv"
        write_motion(file, model.robot, times, q)
        return file.read_text(encoding="utf-8")


def read_problem(name: str, content: bytes, folder: Path) -> Job:
    """Read a problem file that was brought to the page.

    Names of other files in it begin at `folder`, where the problem of the page stands, and must lead to files within
    it: whoever can reach the page shall not read others.

    Raises
    ------
    InputError
        In one line, when it is no problem file.
    """
    title = PurePath(name.replace("\\", "/")).name or "file"
    try:
        if len(content) > LARGEST_BYTES:
            raise InputError("file", "too large", f"{len(content)} bytes", f"at most {LARGEST_BYTES} bytes")
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError("file", f"not UTF-8 at byte {error.start}", title, "a text file in UTF-8") from None
        values = parse(text, Path(title))
        _refuse_far_files(values, folder)
        job = job_of(values, str(folder / title))
        job.scene.prepare()
        return job
    except InputError as error:
        raise error.in_file(title) from None


def _refuse_far_files(values: Any, folder: Path, key: str = "") -> None:
    """Refuse names of files that lead out of a folder."""
    entries = values.items() if isinstance(values, dict) else enumerate(values) if isinstance(values, list) else ()
    for inner, entry in entries:
        if isinstance(entry, dict | list):
            _refuse_far_files(entry, folder, join(key, inner))
        elif (
            isinstance(entry, str)
            and inner in FILE_KEYS
            and not (folder / entry).resolve().is_relative_to(folder.resolve())
        ):
            wanted = "a file within that folder"
            raise InputError(join(key, inner), "leads out of the folder of the page", entry, wanted)
